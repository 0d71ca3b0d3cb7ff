"""The voltages that a diagnosis may prescribe as a test, from their names and parameters.

They are the reference generator's sine, chirp, square wave, pseudo-random binary sequence and multisine.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf, isfinite
from random import Random
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eha_exam.errors import ExamError, remedy

Array = NDArray[np.float64]

EARLY = 1e-9
"""Share of a dwell or period by which a change comes early, so that rounded times of samples meet it."""
PEAK_POINTS = 64
"""Points in each cycle of a multisine's highest frequency at which its peak is looked for."""

TAPS = {
    3: (3, 2), 4: (4, 3), 5: (5, 3), 6: (6, 5), 7: (7, 6), 8: (8, 6, 5, 4), 9: (9, 5), 10: (10, 7), 11: (11, 9),
    12: (12, 11, 10, 4), 13: (13, 12, 11, 8), 14: (14, 13, 12, 2), 15: (15, 14), 16: (16, 15, 13, 4),
}  # fmt: skip
"""Exponents of primitive polynomials over GF(2), by their degree."""


def sine(time: Array, p: Mapping[str, Any]) -> Array:
    """amplitude sin(2 pi frequency t + phase)."""
    return np.asarray(p["amplitude"] * np.sin(2.0 * np.pi * p["frequency"] * time + p["phase"]))


def chirp(time: Array, p: Mapping[str, Any]) -> Array:
    """A sine whose frequency goes from one end to the other within `duration` and stays there."""
    first, last, duration = p["start_frequency"], p["end_frequency"], p["duration"]
    if p["logarithmic"] and first == last:
        raise ExamError("chirp: start_frequency equals end_frequency; give two, or logarithmic=false")
    swept = np.minimum(time, duration)
    share = np.minimum(swept / duration, 1.0)
    if p["logarithmic"]:
        cycles = (first * (last / first) ** share - first) / (np.log(last / first) / duration)
    else:
        cycles = 0.5 * (first + (first + (last - first) * share)) * swept
    return np.asarray(p["amplitude"] * np.sin(2.0 * np.pi * (cycles + last * (time - swept))))


def square(time: Array, p: Mapping[str, Any]) -> Array:
    """+amplitude in the first part of each period, -amplitude in the rest."""
    phase = np.mod(time * p["frequency"] + EARLY, 1.0)
    return np.where(phase < p["duty"], p["amplitude"], -p["amplitude"])


def prbs(time: Array, p: Mapping[str, Any]) -> Array:
    """+amplitude or -amplitude for each dwell: b[k] is the exclusive or of the b[k - tap], from 1, 0, 0, ..."""
    order = p["order"]
    length = 2**order - 1
    bits = [1] + [0] * (order - 1)
    for k in range(order, length):
        bits.append(sum(bits[k - tap] for tap in TAPS[order]) % 2)
    place = np.floor(time / p["dwell"] + EARLY).astype(np.int64) + p["seed"]
    return np.asarray(np.where(np.array(bits)[place % length] == 1, p["amplitude"], -p["amplitude"]))


def multisine(time: Array, p: Mapping[str, Any]) -> Array:
    """Sines of equal height at multiples of 1 / period, of seeded phases; `amplitude` is the largest magnitude."""
    lowest, highest, period = p["lowest"], p["highest"], p["period"]
    if not 1.0 / period <= lowest * (1.0 + 1e-9) <= highest * (1.0 + 1e-9) or highest * period > 1e5:
        raise ExamError(
            f"multisine: period {period:g} s, lowest {lowest:g} Hz and highest {highest:g} Hz do not fit; give"
            " 1 / period <= lowest <= highest, and at most 1e5 cycles in a period"
        )
    multiples = np.unique(np.round(np.geomspace(lowest, highest, p["count"]) * period))
    phases = Random(p["seed"])
    sines = [(2.0 * np.pi * multiple / period, 2.0 * np.pi * phases.random()) for multiple in multiples.tolist()]

    def total(times: Array) -> Array:
        return np.asarray(sum(np.sin(rate * times + phase) for rate, phase in sines))

    peak = np.max(np.abs(total(np.linspace(0.0, period, int(PEAK_POINTS * multiples[-1]) + 1))))
    return np.asarray(p["amplitude"] / float(peak) * total(time))


@dataclass(frozen=True)
class Row:
    """One parameter: its default, whose type is the parameter's, and its bounds."""

    default: float | int | bool
    lower: float = -inf
    upper: float = inf


_FREQUENCY = (1e-6, 1e4)

SIGNALS: dict[str, tuple[Callable[[Array, Mapping[str, Any]], Array], dict[str, Row]]] = {
    "sine": (sine, {"amplitude": Row(8.4e-3), "frequency": Row(1.0, 0.0, 1e4), "phase": Row(0.0)}),
    "chirp": (
        chirp,
        {
            "amplitude": Row(0.01),
            "start_frequency": Row(0.1, *_FREQUENCY),
            "end_frequency": Row(10.0, *_FREQUENCY),
            "duration": Row(20.0, 1e-3),
            "logarithmic": Row(True),
        },
    ),
    "square": (square, {"amplitude": Row(0.01), "frequency": Row(1.0, *_FREQUENCY), "duty": Row(0.5, 0.0, 1.0)}),
    "prbs": (
        prbs,
        {"amplitude": Row(0.01), "dwell": Row(0.05, 1e-4), "order": Row(9, 3, 16), "seed": Row(1, 0, 2**31)},
    ),
    "multisine": (
        multisine,
        {
            "amplitude": Row(0.01),
            "lowest": Row(0.1, 1e-4, 1e4),
            "highest": Row(10.0, 1e-4, 1e4),
            "count": Row(20, 1, 1000),
            "period": Row(20.0, 1e-3, 1e5),
            "seed": Row(1, 0, 2**31),
        },
    ),
}
"""Each signal's law, and its parameters with their defaults. All have `offset` [V], too."""


def voltage_of(reference: Mapping[str, Any], time: Array) -> Array:
    """The voltage [V] at `time` (n,) [s], from 0 on, of a test given as the reference generator's parameters.

    `signal` is its name, `<signal>.<parameter>` a parameter of it (amplitude and offset V, frequencies Hz, phase rad,
    times s); those of other signals count for nothing. ExamError where the signal or a parameter of it is unknown, or a
    value is out of its bounds.
    """
    name = str(reference.get("signal"))
    if name not in SIGNALS:
        raise ExamError(f"the prescribed test has the signal {name!r}; {remedy(name, SIGNALS)}")
    law, rows = SIGNALS[name]
    rows = rows | {"offset": Row(0.0)}
    values: dict[str, float | int | bool] = {parameter: row.default for parameter, row in rows.items()}
    for key, value in reference.items():
        start, dot, parameter = key.partition(".")
        if not dot or start != name:
            continue
        if parameter not in rows:
            raise ExamError(f"the signal {name} has no parameter {parameter!r}; {remedy(parameter, rows)}")
        values[parameter] = _checked(key, rows[parameter], value)
    return np.asarray(values["offset"] + law(time, values), dtype=np.float64)


def _checked(key: str, row: Row, value: Any) -> float | int | bool:
    if isinstance(row.default, bool):
        if str(value).lower() not in ("true", "false"):
            raise ExamError(f"{key} = {value!r} is no truth value; give true or false")
        return str(value).lower() == "true"
    try:
        number = type(row.default)(value)
    except (TypeError, ValueError, OverflowError):
        raise ExamError(f"{key} = {value!r} is no number; give one") from None
    if not isfinite(number) or not row.lower <= number <= row.upper:
        raise ExamError(f"{key} = {number:g} is out of range; give {row.lower:g} to {row.upper:g}")
    return number
