"""Units by name, against their definitions."""

from __future__ import annotations

from pathlib import Path

import pytest

from eha_core.errors import RecordingError
from eha_core.recording import load_topics_file
from eha_core.unit_names import UNITS, name_of, unit_named


@pytest.mark.parametrize(
    ("text", "si", "scale"),
    [
        ("psi", "Pa", 0.45359237 * 9.80665 / 0.0254**2),
        ("gpm", "m^3/s", 231 * 0.0254**3 / 60),
        ("lbf", "N", 0.45359237 * 9.80665),
        ("L/min", "m^3/s", 1e-3 / 60),
        ("MPa", "Pa", 1e6),
        ("Mpa", "Pa", 1e6),
        ("mV", "V", 1e-3),
        ("µm", "m", 1e-6),
        ("cm³/s", "m^3/s", 1e-6),
        ("Bar", "Pa", 1e5),
        ("mbar", "Pa", 100.0),
        ("ms", "s", 1e-3),
        ("rpm", "rad/s", 0.10471975511965977),
        ("Hz", "rad/s", 6.283185307179586),
        ("seconds", "s", 1.0),
    ],
)
def test_a_unit_is_what_its_definition_says(text: str, si: str, scale: float) -> None:
    unit = unit_named(text)
    assert unit is not None
    assert (unit.si, unit.scale) == (si, pytest.approx(scale, rel=1e-9))


@pytest.mark.parametrize("text", ["", "mPa", "MPA", "MV", "MA", "furlong", "nm"])
def test_what_is_no_unit_here_is_none(text: str) -> None:
    assert unit_named(text) is None


def test_every_unit_is_found_by_the_name_that_it_is_given() -> None:
    for unit in UNITS.values():
        assert (UNITS[name_of(unit)].si, UNITS[name_of(unit)].scale) == (unit.si, unit.scale)


def test_a_topics_file_takes_units_and_gauge_from_them(tmp_path: Path) -> None:
    path = tmp_path / "topics.yaml"
    path.write_text("channels: {pressure_a: {topic: /a, unit: barg}, position: {topic: /x, unit: mm}}")
    channels = load_topics_file(path).channels
    pressure, position = channels["pressure_a"], channels["position"]
    assert pressure is not None and (pressure.scale, pressure.reference) == (1e5, "gauge")
    assert position is not None and position.scale == 1e-3


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("{topic: /x, unit: bar}", "bar is not a unit of it, which is in m; choose m, mm, cm, um, in"),
        ("{topic: /x, unit: mmm}", "unit 'mmm' is not known; did you mean mm"),
        ("{topic: /x, unit: mm, scale: 1e-3}", "unit and scale say the same thing; keep one"),
    ],
)
def test_a_unit_that_cannot_be_is_refused_in_one_line(tmp_path: Path, entry: str, message: str) -> None:
    path = tmp_path / "topics.yaml"
    path.write_text(f"channels: {{position: {entry}}}")
    with pytest.raises(RecordingError, match=message):
        load_topics_file(path)
