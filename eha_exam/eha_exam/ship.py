"""`python -m eha_exam.ship FOLDER SEED`: make the cases of a small exam and seal them in a folder."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from itertools import count, islice
from pathlib import Path

from eha_exam.command import UNUSABLE, show_progress
from eha_exam.drawing import draw_case
from eha_exam.run_exam import prepare_case
from eha_exam.sealed_set import write_set
from eha_exam.tiers import SHARES

CASES = 40
"""Each tier has its share of these, and one at least."""
MOST_SAMPLES = 8000.0
"""Of one channel, which keeps a packed recording below 0.6 MB: 500 Hz for at most 16 s."""


def members_of(seed: int) -> Iterator[tuple[str, int]]:
    """(tier, number) of each case: of each tier the first of a seed that have at most MOST_SAMPLES samples."""
    for tier, share in SHARES.items():
        drawn = (draw_case(tier, number, seed) for number in count())
        short = (number for number, case in enumerate(drawn) if case.duration * case.rate <= MOST_SAMPLES)
        yield from ((tier, number) for number in islice(short, max(1, round(CASES * share))))


def main(words: list[str]) -> int:
    """Make a set; its cases stay in a folder that is removed."""
    if len(words) != 2 or not words[1].isdecimal() or Path(words[0]).exists():
        print("usage: python -m eha_exam.ship FOLDER SEED, where FOLDER is not there yet", file=sys.stderr)
        return UNUSABLE
    folder, seed = Path(words[0]), int(words[1])
    members = list(members_of(seed))
    with tempfile.TemporaryDirectory() as scratch:
        for done, (tier, number) in enumerate(members, 1):
            prepare_case(tier, number, seed, scratch, compressed=False)
            show_progress("recordings", done, len(members))
        texts = [path.read_text(encoding="utf-8") for path in sorted(Path(scratch).glob("sealed/*.json"))]
        write_set(folder, seed, sorted(Path(scratch).glob("recordings/*")), texts)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
