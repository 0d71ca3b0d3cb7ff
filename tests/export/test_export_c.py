"""`eha export c`: a C program with the exported header and library gives the plant's own numbers."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from exported import FIVE, STEPS, advanced, voltages

from eha_core.cli import main
from eha_core.export.compiler import LINUX
from eha_core.parameters import dump_parameters
from eha_core.plant import COLUMNS, Plant

pytest.importorskip("ziglang", reason="the compiler is not installed: pip install ziglang")

PROGRAM = """
#include <stdio.h>
#include "eha_plant.h"

static eha_plant plant, other;

int main(void) {
    double voltage;
    if (eha_start(&plant) || eha_start(&other)) return 1;
    if (eha_set(&plant, EHA_PARAMETER_MOVING_MASS, -1.0) != EHA_OUT_OF_RANGE) return 2;
    if (eha_get(&plant, EHA_PARAMETER_COULOMB_FRICTION_FORCE) != 250.0) return 3;
    eha_set(&other, EHA_PARAMETER_COULOMB_FRICTION_FORCE, 0.0);
    fwrite(plant.outputs, sizeof plant.outputs, 1, stdout);
    while (fread(&voltage, sizeof voltage, 1, stdin)) {
        if (eha_advance(&plant, voltage, STEPS) || eha_advance(&other, voltage, STEPS)) return 4;
        fwrite(plant.outputs, sizeof plant.outputs, 1, stdout);
    }
    return plant.outputs[EHA_OUTPUT_POSITION] == other.outputs[EHA_OUTPUT_POSITION] ? 5 : 0;
}
"""
ZIG = [sys.executable, "-m", "ziglang"]


def export(folder: Path, *words: str) -> Path:
    (folder / "rig.yaml").write_text(dump_parameters(FIVE))
    assert main(["export", "c", "--nominal", str(folder / "rig.yaml"), "--out", str(folder / "out"), *words]) == 0
    return folder / "out"


def test_a_minute_in_a_c_program_is_the_plant_to_the_last_bit(tmp_path: Path) -> None:
    library = export(tmp_path, "--target", LINUX)
    (tmp_path / "run.c").write_text(PROGRAM)
    words = ["cc", "-target", LINUX, "-O2", f"-DSTEPS={STEPS}", f"-I{library}", "run.c"]
    words += [f"{library}/libeha_plant.a", "-lm", "-o", "run"]
    subprocess.run([*ZIG, *words], cwd=tmp_path, check=True)
    commands = voltages(60.0)
    done = subprocess.run([tmp_path / "run"], input=commands.tobytes(), capture_output=True, check=True)
    rows = np.frombuffer(done.stdout).reshape(-1, len(COLUMNS))
    np.testing.assert_array_equal(rows, advanced(Plant(FIVE), commands))


@pytest.mark.parametrize("target, header", [("aarch64-linux-gnu", b"\x7fELF"), ("x86_64-windows-gnu", b"d\x86")])
def test_other_targets_are_compiled_and_need_only_c(target: str, header: bytes, tmp_path: Path) -> None:
    library = export(tmp_path, "--target", target)
    subprocess.run([*ZIG, "ar", "x", library / "libeha_plant.a"], cwd=tmp_path, check=True)
    assert (tmp_path / "eha_kernel.ll.o").read_bytes().startswith(header)
    content = (library / "libeha_plant.a").read_bytes()
    assert b"eha_advance" in content and b"NRT_" not in content and b"Py" not in content
    # the sources beside it make the same
    source = library / "source"
    words = ["cc", "-target", target, "-O2", "-w", "-c", f"-I{library}", "-o", tmp_path / "again.o"]
    subprocess.run([*ZIG, *words, source / "eha_plant.c"], check=True)
