"""The state of a rig at an instant, from the samples about it and a simulation that goes through it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.plant import Row
from eha_core.twin.samples import Array, Samples

State = tuple[float, float, float, float]
"""Position [m], velocity [m/s] and both pressures [Pa]."""


def measured_state(channels: Mapping[str, Samples], stamp: int, reach: int, state: Row) -> State:
    """The state at a stamp, as lines through the samples within `reach` of it [ns] have it; a pressure that is not
    measured is that of `state`."""
    lines = {name: line for name, samples in channels.items() if (line := _line(*samples.near(stamp, reach)))}
    position = lines.get("position", (state.position, state.velocity))
    pressures = (lines.get(name, (getattr(state, name), 0.0))[0] for name in ("pressure_a", "pressure_b"))
    return (*position, *pressures)


def corrected_state(
    channels: Mapping[str, Samples], stamp: int, reach: int, state: Row, times: Array, simulated: Mapping[str, Array]
) -> State:
    """The state of a simulation at a stamp, plus its error: a line through measured minus simulated of the samples
    about it. The error is far smoother than the motion, which may turn within `reach`.

    Args:
        channels: what was measured.
        stamp: the instant [ns]; reach: how far to either side samples count [ns].
        state: the simulation's at the stamp.
        times: of its rows, relative to the stamp [s], at least `reach` to either side.
        simulated: what the sensors of the simulated rig show at these times, by channel.
    """
    errors = {}
    for name, samples in channels.items():
        at, values = samples.near(stamp, reach)
        errors[name] = _line(at, values - np.interp(at, times, simulated[name])) or (0.0, 0.0)
    position, velocity = errors["position"]
    return (
        state.position + position,
        state.velocity + velocity,
        state.pressure_a + errors["pressure_a"][0],
        state.pressure_b + errors["pressure_b"][0],
    )


def _line(times: Array, values: Array) -> tuple[float, float] | None:
    """Value and slope at time 0 of the line through some samples; None of fewer than two."""
    if len(times) < 2:
        return None
    line = np.polynomial.Polynomial.fit(times, values, 1)
    return float(line(0.0)), float(line.deriv()(0.0))
