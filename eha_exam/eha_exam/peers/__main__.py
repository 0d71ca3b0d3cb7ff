"""`python -m eha_exam.peers METHOD RECORDING... ANSWER`: diagnose with one of the other methods."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from eha_exam.errors import ExamError
from eha_exam.peers import METHODS
from eha_exam.peers.methods import diagnose

UNUSABLE = 2


def main(words: list[str]) -> int:
    """Run one method; recordings after the first are not looked at, for none of the methods can join two."""
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


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
