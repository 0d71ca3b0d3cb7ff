"""Which channel and unit a field is suggested to be, by its topic, its name and how far it goes."""

from __future__ import annotations

from pathlib import Path

import pytest

from eha_core.recording.inspection import Field, Inspection
from eha_core.recording.suggestions import suggest
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
