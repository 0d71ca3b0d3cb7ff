"""The wall: the truth shares no code with the model that is examined with it, and yet knows the whole catalogue."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import eha_exam.truth as truth_package
from eha_core.effects import effects
from eha_exam.concealed import SITES
from eha_exam.truth.record import CATALOGUE

FOLDER = Path(truth_package.__file__).parent
ALLOWED = ("numpy", "numba", "sksundae", "eha_exam.errors", "eha_exam.truth")
STANDARD = sys.stdlib_module_names - {"importlib"}


def imports(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path.name}: a relative import hides where it leads"
            found.add(node.module or "")
    return found


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.py")), ids=lambda path: path.name)
def test_the_truth_imports_nothing_of_the_model_under_test(path: Path) -> None:
    for name in imports(path):
        assert name.split(".")[0] in STANDARD or any(name == a or name.startswith(f"{a}.") for a in ALLOWED), name


def test_the_exam_imports_nothing_of_the_library_that_is_examined() -> None:
    for path in FOLDER.parent.rglob("*.py"):
        assert not {name.split(".")[0] for name in imports(path)} & {"eha_core", "eha_sim_node", "rclpy"}, path.name


def test_the_exam_s_command_runs_without_the_library_that_is_examined() -> None:
    code = (
        "import sys; sys.modules['eha_core'] = None\n"
        "import eha_exam.command, eha_exam.run_exam, eha_exam.page, eha_exam.sittings, eha_exam.peers.__main__\n"
        "eha_exam.command.main(['--pool', 'none.json'])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stderr == "eha-exam: none.json: is not a table.json that eha exam wrote; give the paths of such files\n"


def test_the_truth_knows_every_effect_of_the_catalogue_under_its_names() -> None:
    for effect in effects():
        if not effect.named:
            continue
        assert effect.id in CATALOGUE, f"the exam has no truth for {effect.id}"
        assert {row.name for row in effect.parameters} <= set(CATALOGUE[effect.id]), effect.id
        assert SITES[effect.id] == effect.site
