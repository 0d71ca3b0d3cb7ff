"""In which unit a field is suggested to be, by how far it goes and how it counts."""

from __future__ import annotations

from math import isnan, nan
from pathlib import Path

import numpy as np
import pytest
from inspections import a_column, a_field, a_time, certain_of, of_table, ways

from eha_core.recording.inspection import Field, Inspection
from eha_core.recording.suggestions import rate_of, suggest
from eha_core.unit_names import UNITS

USUAL = [
    ("speed", "m/s", 0.5, "mm/s", 1e3), ("stroke", "m", 0.08, "mm", 1e3),
    ("load_cell", "N", 5e3, "kN", 1e-3), ("voltage", "V", 0.5, "mV", 1e3),
]  # fmt: skip
"""Names of columns, SI units, how far a bench goes in them, and another unit with how many of it make one of SI."""


@pytest.mark.parametrize(("name", "unit", "largest", "other", "factor"), USUAL)
@pytest.mark.parametrize("is_other", [False, True])
def test_a_unit_is_suggested_where_it_makes_a_rig_of_what_was_recorded(
    name: str, unit: str, largest: float, other: str, factor: float, is_other: bool
) -> None:
    factor, right = (factor, other) if is_other else (1.0, unit)
    fields = (a_field("time", 4.0), a_field(name, factor * largest))
    found = suggest(Inspection(Path("run.csv"), "csv", fields, {}, ()))
    readings = [one for question in found.questions for one in question.readings if one.field.path == name]
    readings = [one for one in (*readings, *found.certain) if one.field.path == name and one.unit]
    sizes = {str(one.unit): factor * largest * UNITS[str(one.unit)].scale for one in readings}
    assert all(UNITS[of].si == unit for of in sizes)
    assert right in sizes
    assert all(2e-3 < size / largest < 2e3 for size in sizes.values()), sizes


def test_the_only_unit_that_is_usual_is_asked_after_and_not_certain() -> None:
    """A valve's coil takes no 50 A and no 50 uA."""
    found = of_table(a_column("strom", -50.0, 50.0))
    (question,) = found.questions
    assert certain_of(found) == {}
    assert ways(question) == [("current", "mA", None)] and not question.is_open
    assert question.text == '"strom": is current in mA? it goes from -50 to 50'
    assert certain_of(of_table(a_column("strom", -50.0, 50.0, "mA"))) == {"current": ("strom", "mA", None)}


def test_where_no_unit_is_usual_a_name_is_asked_after_in_all_and_a_nameless_column_in_none() -> None:
    (named,) = of_table(a_column("strom", 0.0, 1e12)).questions
    assert ways(named) == [("current", unit, None) for unit in ("A", "mA", "uA")]
    assert named.text == '"strom": in which unit is current? it goes from 0 to 1e+12'
    assert of_table(a_column("column 7", 0.0, 1e12)).questions == ()
    nameless = of_table(a_column("column 7", 0.0, 10.0)).questions[0]
    assert nameless.is_open and nameless.text == "which number is voltage_command, if any?"


@pytest.mark.parametrize(
    ("largest", "units"),
    [(10.0, ["A", "mA"]), (10.1, ["mA"]), (99.0, ["mA"]), (101.0, ["mA", "uA"]), (1e-4, ["A"])],
)
@pytest.mark.parametrize("is_below_zero", [False, True])
def test_what_is_usual_has_its_ends(largest: float, units: list[str], is_below_zero: bool) -> None:
    """Of a coil 0.1 mA to 10 A, of whichever sign."""
    low, high = (-largest, 1e-6) if is_below_zero else (-1e-6, largest)
    (question,) = of_table(a_column("strom", low, high)).questions
    assert [unit for _, unit, _ in ways(question)] == units


@pytest.mark.parametrize(
    ("low", "unit", "references"),
    [
        (-0.21, "bar", ["gauge"]),
        (-0.2, "bar", ["gauge"]),
        (1.0, "bar", ["gauge"]),
        (-0.5, "barg", ["gauge"]),
        (0.5, "bara", ["absolute"]),
        (-0.5, "bara", ["absolute"]),
    ],
)
def test_a_pressure_is_gauge_where_it_says_so_or_none_can_be_so_low(
    low: float, unit: str, references: list[str]
) -> None:
    found = of_table(a_column("druck_kolben", low, 60.0, unit))
    pressures = [(one.unit, one.reference) for one in found.certain if one.channel == "pressure_a"]
    assert pressures == [("bar", reference) for reference in references]
    assert found.questions == ()
    is_word = unit != "bar" or low < -0.2
    assert [one.assumed for one in found.certain if one.channel == "pressure_a"] == [
        "" if is_word else "gauge, for want of a word on it"
    ]


@pytest.mark.parametrize(("high", "is_asked"), [(19.9, True), (20.0, False)])
def test_a_pressure_in_which_an_atmosphere_matters_is_asked_after(high: float, is_asked: bool) -> None:
    """Below 20 bar the atmosphere is more than 5 % of the largest pressure."""
    found = of_table(a_column("druck_kolben", 1.0, high, "bar"))
    assert bool(found.questions) == is_asked
    if is_asked:
        (question,) = found.questions
        assert ways(question) == [("pressure_a", "bar", reference) for reference in ("gauge", "absolute")]
        assert question.text == f'"druck_kolben": is pressure_a absolute or gauge? it goes from 1 to {high:.4g} bar'


@pytest.mark.parametrize(
    ("first", "step", "units"),
    [
        (0.0, 2e-3, ["s"]), (0.0, 0.999, ["s"]), (0.0, 1.0, ["ms", None]), (0.0, 25.0, ["ms", "us", None]),
        (0.0, 2e4, ["us", "100ns", "ns", None]), (0.0, 2e6, ["ns"]), (0.0, 2.5, ["ms"]),
        (0.0, 1e-5, ["min", "h", "day"]),
        (1e12, 2.0, ["ms"]), (3.99e12, 2.0, ["ms"]), (4e12, 2.0, ["ms", None]), (0.99e12, 2.0, ["ms", None]),
        (1.7e15, 2e3, ["us"]), (1.7e18, 2e6, ["ns"]), (46352.5, 2.3e-8, ["day"]), (739000.5, 2.3e-8, ["day"]),
        (46352.5, 2e-3, ["s"]), (1.34e17, 2e4, ["100ns"]), (6.4e17, 2e4, ["100ns"]), (1.4e9, 2e-3, ["s"]),
    ],
)  # fmt: skip
def test_a_time_without_a_unit_is_told_by_how_it_counts_or_asked(
    first: float, step: float, units: list[str | None]
) -> None:
    found = suggest(Inspection(Path("run.csv"), "csv", (a_time("", first, step),), {}, ()))
    readings = [*found.certain, *(one for question in found.questions for one in question.readings)]
    assert [(one.channel, one.unit) for one in readings] == [("time", unit) for unit in units]
    assert bool(found.certain) == (len(units) == 1 and units != ["ms"] or first > 0.0 and len(units) == 1)
    if found.questions:
        assert found.questions[0].text.startswith('"time": in which unit is time?')


def test_a_column_that_does_not_increase_is_no_time_and_one_that_does_may_be() -> None:
    back = Field("", "time", 100, 0.0, 1.0, nan, "s", 0.0, 0.0)
    clock = Field("", "ticks", 100, 0.0, 1.0, nan, "s", 0.0, 0.01)
    for fields in ((back, clock), (clock,)):
        found = suggest(Inspection(Path("run.csv"), "csv", fields, {}, ()))
        assert [(one.channel, one.field.path) for one in found.certain] == [("time", "ticks")]


@pytest.mark.parametrize(
    ("unit", "step", "rate"), [("s", 2e-3, 500.0), ("ms", 2.0, 500.0), ("us", 50.0, 2e4), ("", 4e-3, 250.0)]
)
def test_the_rows_in_a_second_of_a_table(unit: str, step: float, rate: float) -> None:
    inspection = Inspection(Path("run.csv"), "csv", (a_time(unit, 0.0, step),), {}, ())
    assert rate_of(inspection, suggest(inspection)) == pytest.approx(rate)


def test_a_rate_is_not_told_without_a_time() -> None:
    inspection = Inspection(Path("run.csv"), "csv", (a_column("weg", 0.0, 80.0, "mm"),), {}, ())
    assert isnan(rate_of(inspection, suggest(inspection)))


LIMITS = [
    ("druck_kolben", "Pa", 2e5, 7e7), ("weg", "m", 1e-3, 5.0), ("geschwindigkeit", "m/s", 1e-3, 10.0),
    ("ventil", "V", 1e-3, 50.0), ("strom", "A", 1e-4, 10.0), ("kraft", "N", 10.0, 1e7),
    ("flow_in", "m^3/s", 1e-6, 2e-2), ("drehzahl", "rad/s", 1.0, 2e3),
]  # fmt: skip
"""Names, SI units, and from where to where the largest magnitudes of rigs go in them."""


@pytest.mark.parametrize(("name", "unit", "least", "most"), LIMITS)
def test_a_unit_is_usual_from_the_least_to_the_most_of_rigs(name: str, unit: str, least: float, most: float) -> None:
    rare = {"mbar", "kgf/cm^2", "daN", "kgf", "m^3/h", "Hz", "deg/s", "GPa"}  # taken where stated, and not offered
    kinds = {
        kind: one.scale for kind, one in UNITS.items() if one.si == unit and one.reference is None and kind not in rare
    }
    for largest in (least, np.nextafter(least, 0.0), most, np.nextafter(most, np.inf)):
        found = of_table(a_column(name, 0.0, largest))
        readings = [one for question in found.questions for one in question.readings if one is not None]
        readings += [one for one in found.certain if one.channel != "time"]
        usual = {kind for kind, scale in kinds.items() if least <= scale * largest <= most}
        assert {one.unit for one in readings} == (usual or set(kinds))  # where none is usual, all are asked


@pytest.mark.parametrize(
    ("name", "reference"),
    [
        ("pA abs [bar]", "absolute"), ("Pressure A (absolute) [bar]", "absolute"),
        ("Druck_A_absolut [bar]", "absolute"),
        ("pA_rel [bar]", "gauge"), ("Pressure A gauge [bar]", "gauge"),
    ],
)  # fmt: skip
def test_a_name_may_say_against_what_its_pressure_is_measured(name: str, reference: str) -> None:
    found = of_table(a_column(name, 1.0, 60.0, "bar"))
    assert certain_of(found) == {"pressure_a": (name, "bar", reference)}
    assert not any(one.assumed for one in found.certain)
