"""Every rig's questions, one after the other; rigs whose data are not there are skipped."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from eha_core.known_answers.real import emps, mr_damper, pneumatic_seal
from eha_core.known_answers.real.question import Question

Ask = Callable[[Path, Path], list[Question]]

RIGS: dict[str, Ask] = {"emps": emps.ask, "mr_damper": mr_damper.ask, "pneumatic_seal": pneumatic_seal.ask}
"""By the folder that holds a rig's data: what asks its questions, given that folder and one for its own files."""


def hold(data: Path, out: Path, tell: Callable[[str], None]) -> list[Question]:
    """Ask every rig whose data are below `data`; what is skipped is reported in one line each."""
    questions = []
    for name, ask in RIGS.items():
        if not (data / name).is_dir():
            tell(f"skipped: {data / name} is not there (docs/real.md says where the data come from)")
            continue
        (out / name / "sealed.txt").unlink(missing_ok=True)
        tell(f"{name} ...")
        questions += ask(data / name, out / name)
    return questions
