"""A data sheet's values as parameters, against closed forms and against the plant that they make."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from eha_core.errors import ParameterError
from eha_core.plant import Plant
from eha_core.rig import DATA, parameters_of, quantity

SHEET = {
    "rated_flow": "40 l/min", "rated_pressure_drop": "70 bar", "rated_voltage": "10 V", "rated_current": "40 mA",
    "valve_frequency": "90 Hz", "bore": "40 mm", "rod": "25 mm", "rod_a": "25 mm", "stroke": "2 m",
    "hose_bore": "8 mm", "hose_length_a": "0.4 m", "hose_length_b": "0.6 m", "dead_volume": "5 cm^3",
    "supply_pressure": "70 bar", "leakage_flow": "60 ml/min", "leakage_pressure": "100 bar",
}  # fmt: skip


def given(**changes: str | None) -> dict[str, float]:
    texts = {**SHEET, **changes}
    return {one.name: quantity(one, text) for one in DATA if (text := texts.get(one.name)) is not None}


def values(**changes: str | None) -> dict[str, float | None]:
    return {entry.name: entry.value for entry in parameters_of(given(**changes))}


def test_each_value_is_its_closed_form() -> None:
    found = values()
    assert found["piston_area"] == pytest.approx(pi * (0.02**2 - 0.0125**2), rel=1e-12)
    assert found["piston_area_b"] == found["piston_area"]
    # Q = K I sqrt(dp) over one edge, which takes 35 bar of the 70
    assert found["valve_gain"] == pytest.approx((0.04 / 60) / (0.04 * 3.5e6**0.5), rel=1e-12)
    assert found["coil_resistance"] == pytest.approx(250.0)
    assert found["saturation_current"] == pytest.approx(0.04)
    assert found["valve_natural_frequency"] == pytest.approx(180.0 * pi)
    assert found["actuator_displacement"] == 1.0
    assert found["line_volume"] == pytest.approx(pi * 0.004**2 * 0.5 + 5e-6, rel=1e-12)
    assert found["internal_leakage"] == pytest.approx(1e-6 / 1e7, rel=1e-12)


def test_one_rod_leaves_the_whole_bore_to_chamber_a() -> None:
    found = values(rod_a=None)
    assert found["piston_area"] == pytest.approx(pi * 0.02**2, rel=1e-12)
    assert found["piston_area_b"] == pytest.approx(pi * (0.02**2 - 0.0125**2), rel=1e-12)


def test_the_plant_that_is_made_runs_at_the_rated_flow_over_the_rated_drop() -> None:
    # With no load the supply's 70 bar lie over the valve's two edges, and the piston takes the rated flow.
    made = {
        name: value for name, value in values(leakage_flow=None, leakage_pressure=None).items() if value is not None
    }
    settings = {**made, "damping_coefficient": 0.0, "moving_mass": 1.0, "internal_leakage": 0.0, "bulk_modulus": 1e9}
    run = Plant(settings, 1e-5, initial_position=-0.5).run(np.full(20_000, 10.0), 100)
    speed = float(np.mean(run.velocity[-50:]))
    area = pi * (0.02**2 - 0.0125**2)
    assert speed * area == pytest.approx(40e-3 / 60, rel=2e-3)


def test_what_is_not_given_is_unknown_or_said_to_be_assumed() -> None:
    entries = {entry.name: entry for entry in parameters_of({})}
    unknown = {name for name, entry in entries.items() if entry.value is None}
    assert {"bulk_modulus", "moving_mass", "piston_area", "valve_gain", "supply_pressure", "line_volume"} <= unknown
    assert all("assumed" in entry.how for entry in entries.values() if entry.value is not None)
    assert all(entry.how == "not given" for entry in entries.values() if entry.value is None)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"rated_flow": None}, "--rated-flow and --rated-pressure-drop belong together"),
        ({"leakage_flow": None}, "--leakage-flow and --leakage-pressure belong together"),
        ({"hose_bore": None}, "give --hose-bore too"),
        ({"rod": "50 mm"}, "--rod 50 mm is not thinner than the bore of 40 mm"),
        ({"rod_a": "40 mm"}, "--rod-a 40 mm is not thinner"),
        ({"return_pressure": "80 bar"}, "supply_pressure = 7e.06 Pa must exceed"),
        ({"stroke": "50 m"}, "actuator_displacement = 25 m is out of range"),
    ],
)
def test_lines_that_contradict_each_other_are_refused(changes: dict[str, str | None], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        values(**changes)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("bore", "40", "--bore 40: in which unit"),
        ("bore", "forty mm", "is not a number with a unit; write for example '40 mm'"),
        ("bore", "40 bar", "bar is not a unit of it"),
        ("bore", "40 mmm", "did you mean mm"),
        ("bore", "-40 mm", "is less than any rig's"),
        ("bore", "0 mm", "is less than any rig's"),
        ("valve_damping", "0.7 bar", "has no unit"),
        ("moving_mass", "1e999 kg", "is less than any rig's|no value"),
    ],
)
def test_a_value_that_is_none_is_refused_in_one_line(name: str, text: str, message: str) -> None:
    datum = next(one for one in DATA if one.name == name)
    with pytest.raises(ParameterError, match=message):
        quantity(datum, text)


@pytest.mark.parametrize("datum", DATA, ids=lambda one: one.name)
def test_every_example_is_a_value(datum: object) -> None:
    assert quantity(datum, datum.example) >= datum.least  # type: ignore[arg-type, attr-defined]
