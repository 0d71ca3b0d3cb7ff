"""Which channel and unit a field is suggested to be, by its topic, its name and how far it goes."""

from __future__ import annotations

from math import isnan, nan
from pathlib import Path

import numpy as np
import pytest

from eha_core.recording.inspection import Field, Inspection
from eha_core.recording.suggestions import Question, Suggestions, rate_of, suggest, used
from eha_core.unit_names import UNITS


def a_field(path: str, largest: float, topic: str = "") -> Field:
    return Field(topic, path, 100, -largest, largest, 500.0, "", 0.0, 2e-3 if path == "time" else 0.0)


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


def test_a_joint_that_is_alone_is_the_piston_whatever_it_is_called() -> None:
    topic = "/rig/joint_states"
    fields = tuple(a_field(f"{kind}[boom]", 0.05, topic) for kind in ("position", "velocity"))
    found = suggest(Inspection(Path("bag"), "bag", fields, {topic: "sensor_msgs/msg/JointState"}, ()))
    certain = {one.channel: one.field.path for one in found.certain}
    assert certain == {"position": "position[boom]", "velocity": "velocity[boom]"}


def of_table(*fields: Field) -> Suggestions:
    return suggest(Inspection(Path("run.csv"), "csv", (a_time(), *fields), {}, ()))


def a_time(unit: str = "s", first: float = 0.0, step: float = 2e-3) -> Field:
    return Field("", "time", 100, first, first + 99 * step, nan, unit, first, step)


def a_column(name: str, low: float, high: float, unit: str = "") -> Field:
    return Field("", name, 100, low, high, nan, unit, low, 0.0)


def certain_of(found: Suggestions) -> dict[str, tuple[str, str | None, str | None]]:
    return {one.channel: (one.field.path, one.unit, one.reference) for one in found.certain if one.channel != "time"}


def ways(question: Question) -> list[tuple[str, str | None, str | None]]:
    return [(one.channel, one.unit, one.reference) for one in question.readings]


def test_the_only_unit_that_is_usual_is_asked_after_and_not_certain() -> None:
    """A valve's coil takes no 50 A and no 50 uA."""
    found = of_table(a_column("strom", -50.0, 50.0))
    (question,) = found.questions
    assert certain_of(found) == {}
    assert ways(question) == [("current", "mA", None)] and not question.is_open
    assert question.text == "is current in mA? it goes from -50 to 50"
    assert certain_of(of_table(a_column("strom", -50.0, 50.0, "mA"))) == {"current": ("strom", "mA", None)}


def test_where_no_unit_is_usual_a_name_is_asked_after_in_all_and_a_nameless_column_in_none() -> None:
    (named,) = of_table(a_column("strom", 0.0, 1e12)).questions
    assert ways(named) == [("current", unit, None) for unit in ("A", "mA", "uA")]
    assert named.text == "in which unit is current? it goes from 0 to 1e+12"
    (nameless,) = of_table(a_column("column 7", 0.0, 1e12)).questions
    assert (nameless.readings, nameless.is_open) == ((), True)
    assert nameless.text == "which channel is it, if any? it goes from 0 to 1e+12"


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
        (-0.2, "bar", ["absolute", "gauge"]),
        (1.0, "bar", ["absolute", "gauge"]),
        (-0.5, "barg", ["gauge"]),
        (0.5, "bara", ["absolute"]),
        (-0.5, "bara", ["absolute"]),
    ],
)
def test_a_pressure_is_gauge_where_it_says_so_or_none_can_be_so_low(
    low: float, unit: str, references: list[str]
) -> None:
    found = of_table(a_column("druck_kolben", low, 60.0, unit))
    readings = [*found.certain, *(one for question in found.questions for one in question.readings)]
    told = [(one.unit, one.reference) for one in readings if one.channel == "pressure_a"]
    assert told == [("bar", reference) for reference in references]
    assert len(found.questions) == (len(references) > 1)
    if found.questions:
        span = f"it goes from {low:.4g} to 60 bar"
        assert found.questions[0].text == f"is pressure_a absolute or gauge? {span}"


def test_a_message_s_word_on_its_reference_is_taken() -> None:
    field = Field("/rig/p_head", "fluid_pressure", 9, 1e5, 6e6, 500.0, "Pa", reference="absolute")
    found = suggest(Inspection(Path("bag"), "bag", (field,), {"/rig/p_head": "sensor_msgs/msg/FluidPressure"}, ()))
    assert certain_of(found) == {"pressure_a": ("fluid_pressure", "Pa", "absolute")}


def test_a_field_that_may_be_two_channels_is_asked_with_both() -> None:
    """Nothing in `stuff [bar]` tells the ports apart."""
    found = of_table(a_column("stuff", 1.0, 60.0, "barg"))
    assert certain_of(found) == {}
    assert [question.text.partition("?")[0] for question in found.questions] == [
        "is it pressure_a or pressure_b or supply_pressure",
        "is it pressure_b or pressure_a or supply_pressure",
        "is it supply_pressure or pressure_a or pressure_b",
    ]


def test_of_two_columns_of_one_name_it_is_asked_which() -> None:
    found = of_table(a_column("weg", 0.0, 80.0, "mm"), a_column("laser", 0.0, 81.0, "mm"))
    (question,) = found.questions
    assert question.text == "which of these is position?"
    assert [one.field.path for one in question.readings] == ["weg", "laser"]


def test_a_force_beside_both_pressures_is_asked_and_beside_one_certain() -> None:
    force, one, other = (
        a_column("kraft", -9.0, 9.0, "kN"), a_column("p_head", 1.0, 60.0, "barg"), a_column("p_rod", 1.0, 60.0, "barg")
    )  # fmt: skip
    assert certain_of(of_table(force, one))["force"] == ("kraft", "kN", None)
    found = of_table(force, one, other)
    assert set(certain_of(found)) == {"pressure_a", "pressure_b"}
    (question,) = found.questions
    assert question.text.startswith("is this to be the force of the oil on the piston, in place of both pressures?")


def test_no_force_is_asked_after_where_the_contract_has_both_pressures() -> None:
    columns = [a_column("pressure_a", 1e5, 6e6), a_column("pressure_b", 1e5, 6e6), a_column("kraft", -9.0, 9.0, "kN")]
    found = of_table(*columns)
    assert certain_of(found) == {name: (name, None, None) for name in ("pressure_a", "pressure_b")}
    assert found.questions == ()


@pytest.mark.parametrize(
    ("name", "low", "high", "unit", "is_certain"),
    [
        ("position", 0.0, 50.0, "", True),
        ("position", -50.0, 0.0, "m", True),
        ("position", 0.0, 50.1, "", False),  # in metres no rig's
        ("position", -50.1, 0.0, "", False),
        ("pressure_a", -1.9e4, 6e6, "", True),
        ("pressure_a", -2e4, 6e6, "", False),  # gauge
        ("velocity", -3e4, 1.0, "", False),
        ("force", -3e4, 3e4, "", True),
    ],
)
def test_a_column_named_like_a_channel_is_it_where_si_units_fit(
    name: str, low: float, high: float, unit: str, is_certain: bool
) -> None:
    found = of_table(a_column(name, low, high, unit))
    assert (certain_of(found) == {name: (name, None, None)}) == is_certain
    assert bool(found.questions) == (not is_certain)


def test_a_column_in_another_unit_is_taken_in_it() -> None:
    assert certain_of(of_table(a_column("position", 0.0, 80.0, "mm"))) == {"position": ("position", "mm", None)}


def test_what_nobody_filled_in_is_no_channel() -> None:
    nothing = a_column("weg", 0.0, 0.0, "mm")
    assert of_table(nothing) == of_table()
    found = of_table(nothing, a_column("laser", -1.0, 0.0, "mm"))
    assert certain_of(found) == {"position": ("laser", "mm", None)}
    assert certain_of(of_table(nothing, a_column("laser", 0.0, 1.0, "mm")))["position"][0] == "laser"
    empty = Field("", "weg", 0, nan, nan, nan, "mm")
    assert of_table(empty) == of_table()


def test_at_most_a_dozen_nameless_columns_that_move_are_asked_after() -> None:
    still = a_column("column 0", 3.0, 3.0)
    moving = [a_column(f"column {k}", 0.0, 3.0) for k in range(1, 15)]
    found = of_table(still, *moving)
    assert [question.is_open for question in found.questions] == [True] * 12
    assert [question.readings[0].field.path for question in found.questions] == [f"column {k}" for k in range(1, 13)]
    asked = ways(found.questions[0])
    assert [unit for channel, unit, _ in asked if channel == "voltage_command"] == ["V", "mV"]
    assert [unit for channel, unit, _ in asked if channel == "force"] == ["kN", "lbf"]
    assert [how[1:] for how in asked if how[0] == "pressure_b"] == [
        (unit, reference) for unit in ("bar", "MPa") for reference in ("absolute", "gauge")
    ]


@pytest.mark.parametrize(
    ("first", "step", "units"),
    [
        (0.0, 2e-3, ["s"]), (0.0, 0.999, ["s"]), (0.0, 1.0, ["ms", "us", "ns"]), (0.0, 2e6, ["ms", "us", "ns"]),
        (1e12, 2.0, ["ms"]), (3.99e12, 2.0, ["ms"]), (4e12, 2.0, ["ms", "us", "ns"]),
        (0.99e12, 2.0, ["ms", "us", "ns"]),
        (1.7e15, 2e3, ["us"]), (1.7e18, 2e6, ["ns"]),
    ],
)  # fmt: skip
def test_a_time_without_a_unit_is_told_by_how_it_counts_or_asked(first: float, step: float, units: list[str]) -> None:
    found = suggest(Inspection(Path("run.csv"), "csv", (a_time("", first, step),), {}, ()))
    readings = [*found.certain, *(one for question in found.questions for one in question.readings)]
    assert [(one.channel, one.unit) for one in readings] == [("time", unit) for unit in units]
    assert bool(found.certain) == (len(units) == 1)
    if len(units) > 1:
        assert found.questions[0].text.startswith("in which unit is time?")


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


def test_each_field_is_told_with_the_channels_that_it_may_be() -> None:
    found = of_table(a_column("stuff", 1.0, 60.0, "bar"), a_column("weg", 0.0, 80.0, "mm"))
    assert used(found) == {
        ("", "time"): ["time"],
        ("", "weg"): ["position"],
        ("", "stuff"): ["pressure_a", "pressure_b", "supply_pressure"],
    }


NAMES = [
    ("rig.cylinder.weg", "mm", "position"), ("weg.channel_3", "mm", "position"), ("p.head", "barg", "pressure_a"),
    ("bench.p.rod", "barg", "pressure_b"), ("xPiston", "mm", "position"), ("PistonX_mm", "mm", None),
    ("x_mm", "mm", "position"), ("weg_mm", "mm", "position"), ("weg (mm)", "mm", "position"),
    ("weg [mm]", "mm", "position"),
    ("mm", "mm", None), ("drehzahl", "rpm", "pump_speed"), ("weg", "rpm", None), ("x_ref", "mm", None),
    ("x_soll", "mm", None), ("reflex.weg", "mm", "position"), ("ventil", "V", "voltage_command"),
]  # fmt: skip
"""Columns, their units and the channel that they are called, if any."""


@pytest.mark.parametrize(("name", "unit", "channel"), NAMES)
def test_a_column_is_called_by_its_last_telling_level(name: str, unit: str, channel: str | None) -> None:
    filler = [a_column("laser", 0.0, 7.0, "mm"), a_column("pump_speed", 0.0, 700.0, "rpm")]
    beside = [one for one in filler if channel != ("position" if one.unit == "mm" else "pump_speed")]
    found = of_table(a_column(name, 0.0, 10.0, unit), *beside)
    claimed = [one for one, fields in ((one.channel, one.field.path) for one in found.certain) if fields == name]
    assert claimed == ([channel] if channel else [])


def test_a_message_s_only_number_is_called_by_its_topic() -> None:
    topics = {"/valve/cmd": "std_msgs/msg/Float64", "/cyl/weg/value": "custom_msgs/msg/Reading"}
    fields = (
        Field("/valve/cmd", "data", 9, -0.5, 0.5, 500.0, "V"),
        Field("/cyl/weg", "value", 9, 0.0, 80.0, 500.0, "mm"),
        Field("/cyl/weg_ref", "data", 9, 0.0, 80.0, 500.0, "mm"),
    )
    found = suggest(Inspection(Path("bag"), "bag", fields, topics, ()))
    assert {one.channel: one.field.topic for one in found.certain} == {
        "voltage_command": "/valve/cmd",
        "position": "/cyl/weg",
    }


@pytest.mark.parametrize(("is_told", "topic"), [(True, "/rig/values"), (False, "/rig/full")])
def test_an_introspection_s_second_copy_is_passed_over_where_the_first_is_named(is_told: bool, topic: str) -> None:
    name = "state_interface.piston/position"
    full = Field("/rig/full", f"statistics[{name}].value", 9, 0.0, 0.08, 500.0, "m")
    values = Field("/rig/values", f"values[{name}]" if is_told else "values[0]", 9, 0.0, 0.08, 500.0, "m" * is_told)
    topics = {
        "/rig/full": "pal_statistics_msgs/msg/Statistics",
        "/rig/values": "pal_statistics_msgs/msg/StatisticsValues",
    }
    found = suggest(Inspection(Path("bag"), "bag", (full, values), topics, ()))
    assert {one.channel: one.field.topic for one in found.certain} == {"position": topic}


def test_the_contract_s_topics_are_certain_and_others_are_not_asked_after() -> None:
    topics = {"/joint_states": "sensor_msgs/msg/JointState", "/gain": "std_msgs/msg/Float64"}
    two = tuple(Field("/joint_states", f"position[{name}]", 9, 0.0, 0.08, 500.0, "m") for name in ("boom", "piston"))
    gain = Field("/gain", "data", 9, 0.0, 3.0, 500.0, "")
    found = suggest(Inspection(Path("bag"), "bag", (*two, gain), topics, ()))
    assert certain_of(found) == {"position": ("position[piston]", None, None)}
    assert not any(one.field == gain for question in found.questions for one in question.readings)
    other = Field("/model", "position[piston]", 9, 0.0, 0.07, 500.0, "m")
    beside = suggest(Inspection(Path("bag"), "bag", (other, *two), {**topics, "/model": "custom_msgs/msg/Model"}, ()))
    assert [one.field for one in beside.certain] == [two[1]]
    alone = suggest(Inspection(Path("bag"), "bag", (gain,), {"/gain": "std_msgs/msg/Float64"}, ()))
    assert [question.is_open for question in alone.questions] == [True]


LIMITS = [
    ("druck_kolben", "Pa", 2e5, 7e7), ("weg", "m", 1e-3, 5.0), ("geschwindigkeit", "m/s", 1e-3, 10.0),
    ("ventil", "V", 1e-3, 50.0), ("strom", "A", 1e-4, 10.0), ("kraft", "N", 10.0, 1e7),
    ("flow_in", "m^3/s", 1e-6, 2e-2), ("drehzahl", "rad/s", 1.0, 2e3),
]  # fmt: skip
"""Names, SI units, and from where to where the largest magnitudes of rigs go in them."""


@pytest.mark.parametrize(("name", "unit", "least", "most"), LIMITS)
def test_a_unit_is_usual_from_the_least_to_the_most_of_rigs(name: str, unit: str, least: float, most: float) -> None:
    kinds = {kind: one.scale for kind, one in UNITS.items() if one.si == unit and one.reference is None}
    for largest in (least, np.nextafter(least, 0.0), most, np.nextafter(most, np.inf)):
        readings = [one for question in of_table(a_column(name, 0.0, largest)).questions for one in question.readings]
        usual = {kind for kind, scale in kinds.items() if least <= scale * largest <= most}
        assert {one.unit for one in readings} == (usual or set(kinds))  # where none is usual, all are asked


def test_columns_of_a_unit_or_a_name_are_not_asked_after_as_nameless() -> None:
    """A mass is no channel; another way beside the one of the contract, and what is wanted, are not asked after."""
    columns = [
        a_column("beam", 0.0, 3.0, "kg"), a_column("position", 0.0, 0.08), a_column("weg", 0.0, 0.08),
        a_column("column 7 soll", 0.0, 3.0), a_column("strom", 0.0, 3.0, "mA"),
    ]  # fmt: skip
    found = of_table(*columns)
    assert found.questions == ()
    assert certain_of(found) == {"current": ("strom", "mA", None), "position": ("position", None, None)}


def test_a_message_s_number_of_its_own_name_is_not_called_by_its_topic() -> None:
    field = Field("/supply", "pressure", 9, 1.0, 60.0, 500.0, "barg")
    found = suggest(Inspection(Path("bag"), "bag", (field,), {"/supply": "custom_msgs/msg/Reading"}, ()))
    assert found.certain == () and len(found.questions) == 3


def test_an_interface_is_called_by_what_is_in_its_brackets() -> None:
    fields = tuple(
        Field("/rig/values", f"values[rod/{name}]", 9, 0.0, 0.08, 500.0, "m") for name in ("offset", "position")
    )
    topics = {"/rig/values": "pal_statistics_msgs/msg/StatisticsValues"}
    found = suggest(Inspection(Path("bag"), "bag", fields, topics, ()))
    assert certain_of(found) == {"position": ("values[rod/position]", "m", None)}
    valve = Field("/rig/values", "values[command_interface.valve/effort]", 9, -0.5, 0.5, 500.0, "V")
    found = suggest(Inspection(Path("bag"), "bag", (valve,), topics, ()))
    assert certain_of(found) == {"voltage_command": (valve.path, "V", None)}


def test_a_column_s_bracket_is_no_part_of_its_name() -> None:
    assert certain_of(of_table(a_column("weg [velocity]", 0.0, 3.0, "mm"))) == {
        "position": ("weg [velocity]", "mm", None)
    }
    found = of_table(a_column("druck_a (p_b)", 0.0, 3.0, "barg"))
    assert certain_of(found) == {"pressure_a": ("druck_a (p_b)", "bar", "gauge")}


def test_of_two_pistons_it_is_asked_which() -> None:
    topics = {f"/{name}/joint_states": "sensor_msgs/msg/JointState" for name in ("left", "right")}
    fields = tuple(Field(topic, "position[piston]", 9, 0.0, 0.08, 500.0, "m") for topic in topics)
    found = suggest(Inspection(Path("bag"), "bag", fields, topics, ()))
    (question,) = found.questions
    assert (found.certain, question.text) == ((), "which of these is position?")
    assert [one.field for one in question.readings] == list(fields)
