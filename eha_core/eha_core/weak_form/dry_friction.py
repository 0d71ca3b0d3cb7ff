"""Dry friction from the force balance of the measured channels: its form, and its values.

The balance M x'' + B x' + K x + load = A_a P_a - A_b P_b - friction is averaged with test functions between two
reversals, where friction's sign is known and a sensor's play and lag hardly matter. The form, and the terms together
with it, are chosen by the Bayesian information criterion over all small subsets. Errors of the valve's flow do not
matter. Values are accurate to a few per cent if the motion covers the speeds that they need.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import exp, inf, log

import numpy as np
from numpy.typing import NDArray

from eha_core.identification.numbers import Array
from eha_core.identification.observation import Measured, Observation
from eha_core.identification.segments import smooth
from eha_core.weak_form.grid import HOPS, Grid, make_grid

HALF_WIDTH = 0.03
"""s; half width of the test functions, short enough to fit between two reversals."""

SPANS, LESS = (HALF_WIDTH, 0.5 * HALF_WIDTH), 0.8
"""s over which the speed is smoothed; the second if its residual variance is less than this share of the first's (on
development rigs 0.14 to 0.78 where the piston sticks and slips within a test function, 0.9 to 1.2 elsewhere, where the
shorter span only adds noise to the speed)."""

MOVING = 0.02
NOISE_TIMES = 4.0
"""The piston moves where its speed exceeds MOVING of its standard deviation, and this multiple of its noise."""

FEWEST = 60
"""Fewest test functions between reversals for an estimate."""

MOST_TERMS = 3
"""Most terms besides the balance's own that are tried together (assumed)."""

CLEAR = 10.0
"""Reduction of the information criterion required of dry friction: very strong evidence by the usual scale."""

STRIBECK_SPEEDS: tuple[float, ...] = tuple(np.geomspace(0.02, 1.5, 20).tolist())
"""Stribeck velocities that are tried, in standard deviations of the speed."""

MOST_OF_LOAD = 0.5
"""Share of the piston's area up to which friction may follow the load; beyond it the term is the pressures' force."""


@dataclass(frozen=True)
class DryFriction:
    """The form (an effect's id, "" for none) and values by short parameter name [SI]; `clear`: by how much the
    criterion is below the next form's."""

    form: str
    values: Mapping[str, float]
    clear: float


@dataclass(frozen=True)
class _Form:
    effect: str
    columns: tuple[Array, ...]
    stribeck_velocity: float = 0.0

    def values(self, found: Array, area: float) -> dict[str, float] | None:
        """The effect's parameters; None where they have the wrong sign."""
        if self.effect == "coulomb_friction" and found[0] > 0.0:
            return {"force": float(found[0])}
        if self.effect == "load_friction" and 0.0 < found[0] < MOST_OF_LOAD * area:
            return {"coefficient": float(found[0])}
        if self.effect == "stribeck_friction" and found[0] > 0.0 and 0.0 < found[1] < 3.0 * found[0]:
            return {
                "force": float(found[0]),
                "static_force": float(found[0] + found[1]),
                "stribeck_velocity": self.stribeck_velocity,
            }
        return {} if not self.effect else None


def dry_friction(
    observation: Observation,
    values: Mapping[str, float],
    within: tuple[float, float] = (0.0, inf),
    speeds: Sequence[float] = STRIBECK_SPEEDS,
) -> tuple[DryFriction, ...]:
    """The forms of dry friction compatible with the force balance of a recording between two times [s], the most
    probable first; one of them is no friction. Empty without position or a pressure, or where there are too few test
    functions between reversals. `speeds`: the Stribeck velocities to try, in standard deviations of the speed; without
    any, that form is not tried.
    """
    measured = [observation.channel(name) for name in ("position", "pressure_a", "pressure_b")]
    if any(channel is None for channel in measured):
        return ()
    channels = [channel for channel in measured if channel is not None]
    usual, shorter = (_over_a_span(span, observation.duration, channels, values, within, speeds) for span in SPANS)
    return shorter[0] if shorter[1] < LESS * usual[1] else usual[0]


def _over_a_span(
    span: float,
    duration: float,
    channels: Sequence[Measured],
    values: Mapping[str, float],
    within: tuple[float, float],
    speeds: Sequence[float],
) -> tuple[tuple[DryFriction, ...], float]:
    """The forms compatible with the force balance, with speeds smoothed over a span [s], and the residual variance of
    the most probable one [N^2], including the cost of its terms; empty and infinity with too few test functions."""
    spacing = max(float(np.median(np.diff(channel.time))) for channel in channels)
    grid = make_grid(duration, spacing, channels, HALF_WIDTH)
    x, a, b = (np.interp(grid.time, channel.time, channel.values) for channel in channels)
    velocity = np.interp(grid.time, channels[0].time, smooth(channels[0], 1, span))
    centres = grid.centres()
    between = _between_reversals(grid, velocity, channels[0].noise, spacing, span)
    between &= (centres >= within[0]) & (centres < within[1])
    if np.count_nonzero(between) < FEWEST:
        return (), inf
    area = values["piston_area"]
    left = grid.average(area * a - values["piston_area_b"] * b)[between]
    own = [
        grid.integrate(grid.curvature, x),
        -grid.integrate(grid.slope, x),
        grid.average(x),
        grid.average(np.ones_like(x)),
    ]
    extra = [
        grid.average(velocity * np.abs(velocity)), grid.average(np.abs(velocity)), grid.average(x**3), grid.average(b),
        grid.integrate(grid.slope, a), grid.integrate(grid.slope, b), grid.average(velocity * (x - x.mean()) ** 2),
        grid.average(grid.time), grid.average(velocity * grid.time),
    ]  # fmt: skip
    fixed = np.column_stack([*own, *extra])[between]
    best: dict[str, tuple[float, DryFriction]] = {}
    for form in _forms(grid, velocity, a - b, speeds):
        columns = np.column_stack([fixed, *(column[between, None] for column in form.columns)])
        criterion, found = _regressed(columns, left, len(own), len(extra), form, area)
        if found is not None and (form.effect not in best or criterion < best[form.effect][0]):
            best[form.effect] = criterion, DryFriction(form.effect, found, 0.0)
    ranked = sorted(best.values(), key=lambda item: item[0])
    least = ranked[0][0]
    forms = tuple(DryFriction(found.form, found.values, criterion - least) for criterion, found in ranked)
    return forms, exp(least / (len(left) / HOPS))


def _between_reversals(grid: Grid, velocity: Array, noise: float, spacing: float, span: float) -> NDArray[np.bool_]:
    """Flags of the test functions under which the piston moves in one direction; the speed is smoothed over `span`."""
    samples = max(5, round(span / spacing))
    of_speed = noise / spacing * np.sqrt(12.0 / samples**3)  # noise of a slope fitted to these samples
    threshold = max(NOISE_TIMES * of_speed, MOVING * float(np.std(velocity)))
    windows = np.lib.stride_tricks.sliding_window_view(velocity, len(grid.weight))[:: len(grid.weight) // HOPS]
    moving = (windows.min(axis=1) > threshold) | (windows.max(axis=1) < -threshold)
    return np.asarray(moving[grid.gap_free])


def _forms(grid: Grid, velocity: Array, difference: Array, speeds: Sequence[float]) -> Iterator[_Form]:
    """No friction, and each form with the regression columns of its values."""
    sign = np.sign(velocity)
    steady = grid.average(sign)
    yield _Form("", ())
    yield _Form("coulomb_friction", (steady,))
    yield _Form("load_friction", (grid.average(np.abs(difference) * sign),))
    for share in speeds:
        speed = float(share * np.std(velocity))
        yield _Form("stribeck_friction", (steady, grid.average(sign * np.exp(-((velocity / speed) ** 2)))), speed)


def _regressed(
    columns: Array, left: Array, own: int, extra: int, form: _Form, area: float
) -> tuple[float, dict[str, float] | None]:
    """The lowest criterion of a form over all subsets of the extra terms, and the form's values there."""
    lengths = np.linalg.norm(columns, axis=0)
    lengths = np.where(lengths > 0.0, lengths, 1.0)
    unit = columns / lengths
    gram, towards, total = unit.T @ unit, unit.T @ left, float(left @ left)
    independent = len(left) / HOPS
    ends = list(range(own + extra, columns.shape[1]))
    best: tuple[float, dict[str, float] | None] = (np.inf, None)
    for count in range(MOST_TERMS + 1):
        for chosen in combinations(range(own, own + extra), count):
            places = [*range(own), *chosen, *ends]
            try:
                found = np.linalg.solve(gram[np.ix_(places, places)] + 1e-12 * np.eye(len(places)), towards[places])
            except np.linalg.LinAlgError:
                continue
            left_over = max(total - float(found @ towards[places]), 1e-12 * total)
            numbers = len(places) + (form.stribeck_velocity > 0.0)
            criterion = independent * log(left_over / len(left)) + numbers * log(independent)
            if criterion < best[0]:
                values = form.values(found[len(places) - len(ends) :] / lengths[ends], area)
                if values is not None:
                    best = criterion, values
    return best
