"""The unit stated by a name or a message's type."""

from __future__ import annotations

import re

from eha_core.recording.column_names import names_a_side, without_reference
from eha_core.tables import unit_in
from eha_core.unit_names import UNITS, unit_named

_OF_TYPE = {
    ("sensor_msgs/msg/JointState", "position["): "m",
    ("sensor_msgs/msg/JointState", "velocity["): "m/s",
    ("sensor_msgs/msg/JointState", "effort["): "N",
    ("sensor_msgs/msg/FluidPressure", "fluid_pressure"): "Pa",
    ("geometry_msgs/msg/Wrench", "force."): "N",
    ("geometry_msgs/msg/WrenchStamped", "wrench.force."): "N",
}
"""Units that a message's definition states, by its type and the begin of the path."""
_NO_UNITS = frozenset(("in", "at", "d", "h", "t", "l", "min", "day", "k", "hz", "w", "g"))
"""Units, in small letters, that usually mean something else at the end of a name."""


def unit_of_name(name: str, names: tuple[str, ...] = ()) -> str:
    """The unit that a name states in brackets or at its end, as in `x_mm` and `p_A (bar)`; empty without one.

    Args:
        name: a column's name.
        names: all columns' names: neither `valve_A` nor `valve_B` ends in a unit.
    """
    if stated := unit_in(name):
        return stated
    bare = without_reference(name)
    if bare != name and (unit := unit_named(unit_of_name(bare, names))) is not None and unit.si == "Pa":
        return unit_of_name(bare, names)
    match = re.search(r"(?:[_/\s,;:|-]|\bin\s)\s*(%|[A-Za-z\u00b5\u03bc\u00b0]{1,8}(?:\^?\d)?(?:/(?:s|min|h))?)$", name)
    match = match or re.search(r"(?<=[a-z])(Bar|Psi|Mm|Mpa|MPa|Kpa|kPa|Pct|Deg|Rpm|kN|mA)$", name)
    if match is None or unit_named(match[1]) is None or match[1].lower() in _NO_UNITS:
        return ""
    if len(match[1]) > 1:
        return match[1]
    if re.search(r"\bin\s+$", name[: match.start(1)]) and match[1] in UNITS:
        return match[1]
    # A single letter may be part of the name, as in p_A and x_m; it is a unit after a word, or if it is the usual one.
    before = name[: match.start()].lower()
    usual = (match[1], before[:1]) in (("V", "u"), ("V", "v"), ("N", "f"), ("s", "t"), ("A", "i"))
    is_side = match[1] == "A" and (name[: match.start(1)] + "B" in names or names_a_side(before))
    if match[1] not in UNITS and match[1] != "%" or is_side:
        return ""
    return match[1] if usual or match[1] == "%" or re.search(r"[a-z]{3}$", before) else ""


def unit_of_type(type_name: str, path: str) -> str:
    """The unit of a message's number by its definition or by an interface's name; else empty."""
    for (of_type, start), unit in _OF_TYPE.items():
        if of_type == type_name and path.startswith(start):
            return unit
    # An interface of ros2_control is named by its joint and kind; the meaning of a command's effort depends on the rig.
    if "command_interface" in path:
        return ""
    return {"position": "m", "velocity": "m/s", "effort": "N"}.get(path.rpartition("/")[2].partition("]")[0], "")
