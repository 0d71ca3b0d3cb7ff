"""The plant's parameters as ROS sees them, on the simulator node and in parameters files.

Two things differ from the catalogue's names. A ROS name cannot be a parameter and a group of parameters at once, as
`ros2 param dump` nests groups: the effect external_leakage is the group `external_leakage_effect` there, beside the
nominal parameter external_leakage. And a recovered law is one list, `<effect id>.knots`, in place of its knots' names.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from eha_core.curve import KNOTS

GROUPS = {"external_leakage": "external_leakage_effect"}
"""Group of an effect's parameters by effect id, where it is not the id."""

_EFFECTS = {group: effect for effect, group in GROUPS.items()}
_KNOT = re.compile(r"(.+)\.knot_(\d+)")


def node_name(name: str) -> str:
    """Return a catalogue parameter's name on the node; that of a knot is its law's list."""
    knot = _KNOT.fullmatch(name)
    if knot:
        return f"{knot[1]}.knots"
    group, dot, rest = name.partition(".")
    return f"{GROUPS[group]}.{rest}" if dot and group in GROUPS else name


def to_node(values: Mapping[str, float]) -> dict[str, float | list[float]]:
    """Return catalogue values under the node's names; knots that are not given are zero."""
    named: dict[str, float | list[float]] = {}
    for name, value in values.items():
        knot = _KNOT.fullmatch(name)
        if knot:
            law = named.setdefault(node_name(name), [0.0] * KNOTS)
            assert isinstance(law, list)
            law[int(knot[2])] = float(value)
        else:
            named[node_name(name)] = float(value)
    return named


def from_node(found: Mapping[str, object]) -> dict[str, object]:
    """Return parameters under the catalogue's names, from the node's names or the catalogue's own.

    Names that are neither stay as they are. A list that is not one value a knot stays whole, for its check to refuse.
    """
    flat: dict[str, object] = {}
    for name, value in found.items():
        group, dot, rest = name.partition(".")
        law = _law(value) if rest == "knots" else None
        if law is not None:
            flat.update({f"{group}.knot_{k:02d}": item for k, item in enumerate(law)})
        elif dot and group in _EFFECTS:
            flat[f"{_EFFECTS[group]}.{rest}"] = value
        else:
            flat[name] = value
    return flat


def _law(value: object) -> list[object] | None:
    """The values of a list with one value a knot; None where it is none."""
    listed = list(value) if isinstance(value, Iterable) and not isinstance(value, str) else []
    return listed if len(listed) == KNOTS else None
