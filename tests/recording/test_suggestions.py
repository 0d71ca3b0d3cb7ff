"""Which channel a field is suggested to be, by its topic, its name and what else the file holds."""

from __future__ import annotations

from math import nan
from pathlib import Path

import pytest
from inspections import a_column, a_field, certain_of, of_table, ways

from eha_core.recording.inspection import Field, Inspection
from eha_core.recording.suggestions import suggest, used


def test_a_joint_that_is_alone_is_the_piston_whatever_it_is_called() -> None:
    topic = "/rig/joint_states"
    fields = tuple(a_field(f"{kind}[boom]", 0.05, topic) for kind in ("position", "velocity"))
    found = suggest(Inspection(Path("bag"), "bag", fields, {topic: "sensor_msgs/msg/JointState"}, ()))
    certain = {one.channel: one.field.path for one in found.certain}
    assert certain == {"position": "position[boom]", "velocity": "velocity[boom]"}


def test_a_message_s_word_on_its_reference_is_taken() -> None:
    field = Field("/rig/p_head", "fluid_pressure", 9, 1e5, 6e6, 500.0, "Pa", reference="absolute")
    found = suggest(Inspection(Path("bag"), "bag", (field,), {"/rig/p_head": "sensor_msgs/msg/FluidPressure"}, ()))
    assert certain_of(found) == {"pressure_a": ("fluid_pressure", "Pa", "absolute")}


def test_a_field_that_may_be_two_channels_is_asked_with_both() -> None:
    """Nothing in `stuff [bar]` tells the ports apart."""
    found = of_table(a_column("stuff", 1.0, 60.0, "barg"))
    assert certain_of(found) == {}
    assert [question.text.partition(": ")[2].partition("?")[0] for question in found.questions] == [
        "is it pressure_a or pressure_b or supply_pressure",
        "is it pressure_b or pressure_a or supply_pressure",
        "is it supply_pressure or pressure_a or pressure_b",
    ]


def test_of_two_columns_of_one_name_it_is_asked_which() -> None:
    found = of_table(a_column("weg", 0.0, 80.0, "mm"), a_column("laser", 0.0, 81.0, "mm"))
    (question,) = found.questions
    assert question.text == '"weg", "laser": which of these is position?'
    assert [one and one.field.path for one in question.readings] == ["weg", "laser", None]


def test_a_force_beside_both_pressures_is_asked_and_beside_one_certain() -> None:
    force, one, other = (
        a_column("kraft", -9.0, 9.0, "kN"), a_column("p_head", 1.0, 60.0, "barg"), a_column("p_rod", 1.0, 60.0, "barg")
    )  # fmt: skip
    assert certain_of(of_table(force, one))["force"] == ("kraft", "kN", None)
    found = of_table(force, one, other)
    assert set(certain_of(found)) == {"pressure_a", "pressure_b"}
    (question,) = found.questions
    assert question.text.startswith(
        '"kraft": is this to be the force of the oil on the piston, in place of both pressures?'
    )


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
    assert bool(found.questions or certain_of(found)) and (not found.questions or not is_certain)


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
    assert [question.is_open for question in found.questions] == [True] * 4
    for question in found.questions:
        assert list(dict.fromkeys(one.field.path for one in question.readings if one)) == [
            f"column {k}" for k in range(1, 13)
        ]
        assert question.readings[-1] is None
    asked = {question.channel: ways(question) for question in found.questions}
    assert asked["voltage_command"][:2] == [("voltage_command", "V", None), ("voltage_command", "mV", None)]
    assert asked["pressure_b"][:2] == [("pressure_b", "bar", "gauge"), ("pressure_b", "MPa", "gauge")]


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
    assert not any(one and one.field == gain for question in found.questions for one in question.readings)
    other = Field("/model", "position[piston]", 9, 0.0, 0.07, 500.0, "m")
    beside = suggest(Inspection(Path("bag"), "bag", (other, *two), {**topics, "/model": "custom_msgs/msg/Model"}, ()))
    assert [one.field for one in beside.certain] == [two[1]]
    alone = suggest(Inspection(Path("bag"), "bag", (gain,), {"/gain": "std_msgs/msg/Float64"}, ()))
    assert {question.is_open for question in alone.questions} == {True}


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
    assert found.certain == () and question.text.endswith(": which of these is position?")
    assert [one and one.field for one in question.readings] == [*fields, None]
