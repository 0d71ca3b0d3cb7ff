"""The composite: its hooks, the cache that must not outlive a source, and the same numbers without a compiler."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import eha_core
from eha_core.effects import effects
from eha_core.plant import Plant
from eha_core.plant.composite import write_hooks

RUN = """
import numpy as np
from eha_core.plant import Plant
from eha_core.parameters import catalogue
names = ("constant_load.force", "coulomb_friction.force")
plant = Plant({name: 300.0 for name in names if name in catalogue()})
rows = plant.run(0.05 * np.sin(2.0 * np.pi * 10.0 * 1e-4 * np.arange(300)), every=50)
print(rows.values.tobytes().hex())
"""


def simulate(folder: Path | None, cache: Path, **environment: str) -> tuple[np.ndarray, str]:
    """What another interpreter simulates, with the library in that folder or the one in use here, and its stderr."""
    variables = os.environ | {"EHA_CACHE_DIR": str(cache)} | environment
    if folder is not None:
        variables["PYTHONPATH"] = str(folder)
    done = subprocess.run(
        [sys.executable, "-c", RUN], env=variables, capture_output=True, text=True, timeout=200, check=False
    )
    assert done.returncode == 0, done.stderr
    return np.frombuffer(bytes.fromhex(done.stdout.strip())).reshape(6, -1), done.stderr


def test_hooks_call_every_effect_once() -> None:
    text = write_hooks()
    for effect in effects():
        assert text.count(f"= {effect.id}(") == 1


def test_an_edited_effect_is_compiled_anew_and_that_is_said(tmp_path: Path) -> None:
    package = tmp_path / "eha_core"
    shutil.copytree(Path(eha_core.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    for effect in effects():
        if effect.id != "constant_load":
            (package / "effects" / f"{effect.id}.py").unlink()
    pushed, said = simulate(tmp_path, tmp_path / "cache")
    assert said.count("compiling the plant") == 1
    source = package / "effects" / "constant_load.py"
    source.write_text(source.read_text().replace("return force - load", "return force + load"))
    pulled, said = simulate(tmp_path, tmp_path / "cache")
    assert said.count("compiling the plant") == 1
    assert pushed[0, 4] < 0.0 < pulled[0, 4]
    again, said = simulate(tmp_path, tmp_path / "cache")
    assert said == ""
    assert np.array_equal(again, pulled)


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="there is no compiler to compare with")
def test_the_interpreter_finds_the_same_numbers(tmp_path: Path) -> None:
    interpreted, said = simulate(None, tmp_path, NUMBA_DISABLE_JIT="1")
    assert said == ""
    plant = Plant({"constant_load.force": 300.0, "coulomb_friction.force": 300.0})
    compiled = plant.run(0.05 * np.sin(2.0 * np.pi * 10.0 * 1e-4 * np.arange(300)), every=50)
    assert interpreted == pytest.approx(compiled.values, rel=1e-12, abs=1e-15)
