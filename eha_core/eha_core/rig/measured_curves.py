"""What `eha curves` found of a valve, as entries of a nominal file."""

from __future__ import annotations

import json
from math import isfinite
from pathlib import Path

from eha_core.errors import ParameterError
from eha_core.quantities import with_deviation
from eha_core.rig.parameters import Entry

SCHEMA = "eha.curves/1"
"""The schema of curves.json."""


def measured_entries(path: Path, rated_current: float | None) -> list[Entry]:
    """The parameters whose interval does not include zero.

    Args:
        path: a curves.json.
        rated_current: of the rig's data sheet [A]; None where it is not given.

    Raises:
        ParameterError: the file is none of `eha curves`, or its amperes are others than the rig's.
    """
    try:
        made = json.loads(path.read_text(encoding="utf-8"))
        if made["schema"] != SCHEMA:
            raise ValueError
        rows = [(str(row["name"]), float(row["value"]), float(row["reach"]), str(row["unit"]), str(row["how"]))
                for row in made["parameters"] if row["sure"]]  # fmt: skip
        current = made["conditions"]["rated_current"]
        is_of_current = any(curve["command_unit"] == "A" for curve in made["curves"])
    except OSError as error:
        raise ParameterError(f"{path}: cannot be read ({error.strerror})") from error
    except (ValueError, KeyError, TypeError, AttributeError):
        raise ParameterError(f"{path}: is no curves.json of this version; make it with `eha curves`") from None
    if not all(isfinite(value) for _, value, *_ in rows):
        raise ParameterError(f"{path}: has a value that is not finite; make it anew with `eha curves`")
    if is_of_current and rated_current is None:
        raise ParameterError(f"{path}: its curves are over a current; give the full one, as in --rated-current 40mA")
    if not is_of_current and current != rated_current:
        raise ParameterError(
            f"{path}: its amperes are of another full command; give --rated-current alike to `eha curves` and here"
        )
    return [
        Entry(name, value, f"measured: {how}, {with_deviation(value, reach, unit)} (95 %)")
        for name, value, reach, unit, how in rows
    ]
