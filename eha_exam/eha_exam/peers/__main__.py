"""`python -m eha_exam.peers METHOD RECORDING... ANSWER`: diagnose with one of the other methods.

`python -m eha_exam.peers train FILE --cases N --seed S` trains the network of `neural_screen` and writes its weights.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from eha_exam.errors import ExamError
from eha_exam.peers import METHODS
from eha_exam.peers.methods import diagnose
from eha_exam.peers.neural_screen import CASES, SEED, recorded, train

UNUSABLE = 2


def main(words: list[str]) -> int:
    """Run one method; recordings after the first are not looked at, for none of the methods can join two."""
    if words[:1] == ["train"]:
        return _train(words[1:])
    if len(words) < 3 or words[0] not in METHODS:
        print(f"usage: python -m eha_exam.peers {{{','.join(METHODS)}}} RECORDING... ANSWER", file=sys.stderr)
        return UNUSABLE
    try:
        answer = diagnose(words[0], Path(words[1]))
    except ExamError as error:
        print(f"{words[0]}: {error}", file=sys.stderr)
        return UNUSABLE
    Path(words[-1]).write_text(json.dumps(answer), encoding="utf-8")
    return 0


def _train(words: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m eha_exam.peers train")
    parser.add_argument("file", type=Path, metavar="FILE", help="where the weights are written, .npz")
    parser.add_argument("--cases", type=int, default=CASES, metavar="N", help=f"recordings (default {CASES})")
    parser.add_argument(
        "--seed", type=int, default=SEED, metavar="S", help=f"that they are drawn from (default {SEED})"
    )
    arguments = parser.parse_args(words)
    train(recorded(arguments.cases, arguments.seed)).save(arguments.file)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
