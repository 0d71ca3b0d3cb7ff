"""`eha export`: what it refuses in a line, before it compiles anything."""

from __future__ import annotations

from pathlib import Path

import pytest

from eha_core.cli import main
from eha_core.export import compiler, exported_model
from eha_core.export.units import base_unit
from eha_core.parameters import catalogue

PUMP = "plant: {source: switched_pump}\n/**/eha_sim: {ros__parameters: {}}\n"
VANE = "plant: {cylinder: rotary_vane}\n/**/eha_sim: {ros__parameters: {}}\n"
SOFT = "/**/eha_sim: {ros__parameters: {bulk_modulus: 1.0e+7, moving_mass: 1.0e+5, damping_coefficient: 0.0, "
SOFT += "internal_leakage: 0.0}}\n"


@pytest.fixture(autouse=True)
def compiler_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiler, "find_spec", lambda name: object())


@pytest.mark.parametrize(
    "words, said",
    [
        (["fmu", "--out", "rig.zip"], "the name of an FMU ends in .fmu"),
        (["fmu", "--out", "no/folder/rig.fmu"], "cannot be written"),
        (["fmu", "--out", "rig.fmu", "--from", "missing.json"], "missing.json: cannot be read"),
        (["fmu", "--out", "rig.fmu", "--from", "other.json"], "other.json: no diagnosis"),
        (["fmu", "--out", "rig.fmu", "--nominal", "pump.yaml"], "plant.source = switched_pump is not taken here"),
        (["fmu", "--out", "rig.fmu", "--nominal", "vane.yaml"], "plant.cylinder = rotary_vane is not taken here"),
        (["fmu", "--out", "rig.fmu", "--step", "1"], "step_size = 1 s is out of range"),
        (["fmu", "--out", "rig.fmu", "--fmi", "1"], "invalid choice"),
        (["fmu", "--out", "rig.fmu", "--from", "a", "--nominal", "b"], "not allowed with"),
        (["c", "--out", "rig", "--target", "thumb-freestanding"], "needs one of x86_64, aarch64, riscv64"),
        (["c", "--out", "other.json"], "cannot be written"),
        (["fmu", "--out", "rig.fmu", "--target", "x86_64-linux-gnu"], "an FMU is for 64-bit Linux and Windows"),
        (["c", "--out", "rig", "--fmi", "3"], "a library has no FMI"),
        (["fmu", "--out", "rig.fmu", "--rate", "500"], "leave it out, or give --step"),
        (["controller", "--out", "rig", "--step", "1e-4"], "leave it out, or give --rate"),
        (["controller", "--out", "rig", "--fmi", "2"], "a controller is source text"),
        (["controller", "--out", "rig", "--rate", "0"], "a controller's rate is 1 to 10000 Hz"),
        (["controller", "--out", "other.json"], "cannot be written"),
        (["controller", "--out", "rig", "--nominal", "pump.yaml"], "plant.source = switched_pump is not taken here"),
        (["controller", "--out", "rig", "--nominal", "soft.yaml"], "no position loop down to 0.62 rad/s is stable"),
        (["fmi", "--out", "rig.fmu"], "invalid choice"),
        ([], "required: form, --out"),
    ],
)
def test_what_cannot_be_done_is_one_line(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    files = {"other.json": "[]", "pump.yaml": PUMP, "vane.yaml": VANE, "soft.yaml": SOFT}
    for name, text in files.items():
        Path(name).write_text(text)
    try:
        status = main(["export", *words])
    except SystemExit as stopped:
        status = int(str(stopped.code))
    error = capsys.readouterr().err
    assert status == 2 and said in error and error.count("\n") == 1
    assert not list(tmp_path.glob("*.fmu"))


def test_without_the_compiler_it_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(compiler, "find_spec", lambda name: None)
    assert main(["export", "fmu", "--out", str(tmp_path / "rig.fmu")]) == 2
    assert capsys.readouterr().err == "eha export: the compiler is missing; install it: pip install ziglang\n"


def test_the_variables_are_the_catalogue_s_with_no_name_twice() -> None:
    variables = exported_model().variables
    names = [variable.name for variable in variables]
    assert len(set(names)) == len(names) and set(catalogue()) < set(names)
    assert all(variable.meaning for variable in variables)


@pytest.mark.parametrize(
    "unit, powers",
    [
        ("m^3/(s Pa)", {"m": 4, "s": 1, "kg": -1}),
        ("N s/m", {"kg": 1, "s": -1}),
        ("1/A", {"A": -1}),
        ("ohm", {"kg": 1, "m": 2, "s": -3, "A": -2}),
        ("m^(5/2) kg^(-1/2)", None),
        ("m^3/(s Pa^0.5)", None),
    ],
)
def test_units_are_powers_of_si_s_where_they_can_be(unit: str, powers: dict[str, int] | None) -> None:
    assert base_unit(unit) == powers
