"""A rig's limits from a YAML file; limits that the file does not give are the model's."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite
from pathlib import Path

from eha_core.diagnosis.experiment.limits import REACHED, Limits, limits_of
from eha_core.errors import ParameterError, remedy
from eha_core.nominal import NominalModel
from eha_core.yaml_file import load_yaml


def read_limits(path: str | Path | None, model: NominalModel) -> Limits:
    """The limits of a file such as `{position: 0.06, speed: 0.3, pressure: 18.0e6}` [SI]; without one, the model's own.

    Raises ParameterError naming the file, where it cannot be read, and the first name or value that does not fit.
    """
    own = limits_of(model.values)
    if path is None:
        return own
    where = f"limits file {path}"
    content = load_yaml(path, ParameterError, where)
    if not isinstance(content, dict):
        raise ParameterError(f"{where}: needs a line `name: value` for each limit; there are {', '.join(REACHED)}")
    given: dict[str, float] = {}
    for name, value in content.items():
        if name not in REACHED:
            raise ParameterError(f"{where}: there is no limit {name!r}; {remedy(str(name), REACHED)}")
        number = _positive(value)
        if number is None:
            raise ParameterError(f"{where}: {name} = {value!r} is not a positive number; give it in SI units")
        given[name] = number
    return replace(own, **given)


def _positive(value: object) -> float | None:
    """A value as a positive number; YAML reads 25e6, without a point, as text."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if isfinite(number) and number > 0.0 else None
