"""What is run, and the folder in which an exam keeps its recordings, sealed answers and the tools' answers."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import asdict, dataclass
from itertools import count, takewhile
from pathlib import Path

from eha_exam.files import further_name
from eha_exam.scoring import Answer
from eha_exam.tiers import plan

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how many are finished, and how many there are."""


@dataclass(frozen=True)
class Exam:
    """What is run: how many cases, from which seed, of one tier or (None) of all, in which folder; after the `opened`
    first of that seed, whose outcome is known. Or (`source`) a set that is made already, in a folder of its own."""

    folder: Path
    cases: int
    seed: int
    tier: str | None = None
    opened: int = 0
    source: Path | None = None

    @property
    def members(self) -> list[tuple[str, int]]:
        """(tier, number) of each case."""
        return plan(self.opened + self.cases, self.tier)[self.opened :]

    @property
    def recordings(self) -> Path:
        """Folder of the recordings."""
        return self.folder / "recordings"

    def sealed(self, tier: str, number: int) -> Path:
        """The sealed answer of a case."""
        return self.folder / "sealed" / f"{tier}-{number:04d}.json"

    def sealed_files(self) -> list[Path]:
        """The sealed answers of all cases; those of a set that is made already are here when all is answered."""
        if self.source is not None:
            return sorted((self.folder / "sealed").glob("*.json"))
        return [self.sealed(tier, number) for tier, number in self.members]

    def answers(self, tool: str) -> Path:
        """Folder of a tool's or a method's answers."""
        return self.folder / "answers" / tool

    def names(self) -> list[str]:
        """The names of the cases' recordings, the first where there are several of a rig."""
        return list(json.loads((self.folder / "seal.json").read_text(encoding="utf-8")))

    def unanswered(self, tool: str) -> list[str]:
        """The recordings' names that a tool has not answered."""
        answers = self.answers(tool)
        return [name for name in self.names() if not (answers / f"{Path(name).stem}.json").is_file()]


def recordings_of(first: Path) -> tuple[Path, ...]:
    """A case's recordings: one, or those of a rig that was recorded several times."""
    numbered = (first.with_name(further_name(first.name, number)) for number in count(2))
    return (first, *takewhile(Path.is_file, numbered))


def write_whole(path: Path, text: str) -> None:
    """Write a file whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_suffix(f".{os.getpid()}")
    draft.write_text(text, encoding="utf-8")
    draft.rename(path)


def keep_answer(answers: Path, stem: str, answer: Answer) -> None:
    """Keep the answer to a recording; `stem` is the name of its file without the ending."""
    write_whole(answers / f"{stem}.json", json.dumps(asdict(answer)))


def read_kept(path: Path) -> Answer:
    """The answer that `keep_answer` wrote."""
    return Answer(**json.loads(path.read_text(encoding="utf-8")))
