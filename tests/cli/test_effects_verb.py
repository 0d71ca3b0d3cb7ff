"""`eha effects`: the catalogue as a list, an effect in full, every parameter, and names that are none."""

from __future__ import annotations

import pytest

from eha_core.cli import main
from eha_core.effects import effects
from eha_core.parameters import ACTING, NOMINAL


def test_lists_every_named_effect_once(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["effects"]) == 0
    first_words = [line.split()[0] for line in capsys.readouterr().out.splitlines() if line.startswith("  ")]
    assert sorted(first_words) == sorted(effect.id for effect in effects() if effect.named)


def test_shows_one_effect_with_its_parameters(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["effects", "stribeck_friction"]) == 0
    text = capsys.readouterr().out
    for part in ("Signature:", "Equation:", "Sign:", "Validity:", "Source:"):
        assert part in text
    for name in ("force [N]", "static_force [N]", "stribeck_velocity [m/s]"):
        assert f"stribeck_friction.{name}" in text


def test_lists_parameters_with_unit_value_range_and_source(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["effects", "--parameters"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "moving_mass [kg] = 9, 0.01 to 100000: mass of piston and load (Table 1)" in lines
    assert "coulomb_friction.acts_from [s] = 0, 0 to 1e+09: time from which the effect acts (assumed)" in lines
    of_effects = sum(len(effect.parameters) + len(effect.acting_names()) for effect in effects() if effect.named)
    assert len(lines) == len(NOMINAL) + of_effects + len(ACTING)


def test_an_unknown_effect_is_answered_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["effects", "coulomb"]) == 2
    assert capsys.readouterr().err.count("\n") == 1
