"""The flow curve: null, flow gain each way, overlap, hysteresis, curvature and saturation, and the linearity error.

Law: x = I behind a play of +-h; o = x + offset; opening = e(o - d) - e(-o - d) with e(y) = max(y, 0), rounded within
+-r of the edge; Q = G+ opening or G- opening by its sign, with opening / (1 + c |opening|) where the flow bends, and no
more than S+ or S- where it saturates. These are the laws of the effects spool_hysteresis, valve_null_offset,
valve_deadband, flow_gain_asymmetry and flow_saturation. A negative d is underlap: both edges are open about null, where
the flow gain is doubled (H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 5).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import combinations

import numpy as np

from eha_core.errors import EhaError
from eha_core.valve_curves.regression import DECISIVE, Regression, criterion_gain, explained, regress
from eha_core.valve_curves.result import Array, Curve, CurveFit, Value
from eha_core.valve_curves.travel import AMMETER, Travel, behind_play, travel_of

FEWEST = 8
"""Fewest points of a curve: the straight law has five values (assumed)."""

FEWEST_A_SIDE = 3
"""Fewest points at which oil flows in each direction: a line with one point to spare."""

MOVING = 0.05
"""Share of the largest flow from which a point is outside of the dead zone (assumed; twice a flow meter's error)."""

MOST_FALL = 0.1
"""Share of the largest flow by which the flow may fall while the command rises; more is no valve's curve (assumed)."""

LEAST_EXPLAINED = 0.9
"""Least share of the variance that a law must explain; with less, the curve is no valve's (assumed)."""

BANDS = 20
"""Bands of the command over which points are averaged, so that noise does not count as a deviation (assumed)."""

FLAT = 0.2
"""Share of the flow gain below which the flow counts as saturated (assumed)."""

_BASE = ("gain_positive", "gain_negative", "offset", "overlap")
_EXTRA = {"rounding": (0.0, 0.5), "curvature": (0.0, 10.0), "limit_positive": (0.2, 1.0), "limit_negative": (0.2, 1.0)}
"""Terms that are taken where they are needed, with their bounds in parts of the largest command and flow."""


def fit_flow(curve: Curve) -> CurveFit:
    """The figures of a flow curve.

    Raises:
        EhaError: too few points, one direction only, no flow, or a flow that does not rise with the command.
    """
    require_points(curve)
    curve, remarks = _turned(curve)
    largest, full = _require_two_sides(curve)
    command, flow = curve.command / largest, curve.response / full
    _require_rising(curve, command, flow)
    travel = travel_of(command)
    names = [*_BASE, *(["half_width"] if travel.is_both_ways else [])]
    straight = _fit(names, command, travel, flow, _start(command, flow, travel.is_both_ways))
    names, fitted = _extended(names, straight, command, travel, flow)
    if explained(fitted, flow) < LEAST_EXPLAINED:
        raise EhaError(
            f"{curve.source}: the flow does not follow the command as a valve's would; check the columns and their rows"
        )
    values = _values(curve, names, fitted, largest, full)
    kept = _unsaturated(names, fitted, command, flow)
    part = Travel(travel.direction[kept], travel.turned[kept])
    lines = _fit(names[: len(straight.values)], command[kept], part, flow[kept], straight.values)
    values["linearity_error"] = Value("linearity_error", _deviation(command[kept], lines.residual), None, "-")
    values["noise"] = Value("noise", fitted.deviation * full, None, "m^3/s")
    if not travel.is_both_ways:
        remarks.append("hysteresis cannot be found: the command was measured in one direction of travel only")
    elif values["hysteresis"].is_sure:
        remarks.append("a flow meter that lags behind the sweep makes the same loop as hysteresis; sweep more slowly to"
                       " tell them apart")  # fmt: skip
    return CurveFit(curve, values, _drawn(names, fitted, command, travel, largest, full), tuple(remarks))


def require_points(curve: Curve) -> None:
    """Raise EhaError where a curve has too few points, or one command alone."""
    count = curve.command.size
    if count < FEWEST:
        raise EhaError(f"{curve.source}: has {count} points of a {curve.kind} curve; measure {FEWEST} at least")
    if float(np.ptp(curve.command)) == 0.0:
        raise EhaError(f"{curve.source}: the command is the same at every point; measure the curve over the command")


def _turned(curve: Curve) -> tuple[Curve, list[str]]:
    """The curve with a flow that rises with the command, and what was turned."""
    if float(np.cov(curve.command, curve.response)[0, 1]) >= 0.0:
        return curve, list(curve.remarks)
    turned = replace(curve, response=-curve.response)
    remark = "the flow falls while the command rises, so its sign was turned; check the polarity"
    return turned, [*curve.remarks, remark]


def _require_two_sides(curve: Curve) -> tuple[float, float]:
    """The largest command and flow of a curve that has enough points on both sides."""
    full = float(np.max(np.abs(curve.response)))
    if full == 0.0:
        raise EhaError(f"{curve.source}: the flow is zero at every point; check the column and the meter")
    for sign, name in ((1.0, "positive"), (-1.0, "negative")):
        if np.count_nonzero(sign * curve.response > MOVING * full) < FEWEST_A_SIDE:
            raise EhaError(
                f"{curve.source}: fewer than {FEWEST_A_SIDE} points have a {name} flow; measure both directions, and"
                " give a meter's flow without sign that of its direction"
            )
    return float(np.max(np.abs(curve.command))), full


def _bands(command: Array) -> Array:
    """The band of each point."""
    edges = np.linspace(command.min(), command.max(), BANDS + 1)[1:-1]
    return np.searchsorted(edges, command).astype(np.float64)


def _require_rising(curve: Curve, command: Array, flow: Array) -> None:
    bands = _bands(command)
    present = np.unique(bands)
    means = np.array([float(np.mean(flow[bands == band])) for band in present])
    falls = np.maximum.accumulate(means) - means
    worst = int(np.argmax(falls))
    if falls[worst] > MOST_FALL:
        place = float(np.mean(curve.command[bands == present[worst]]))
        raise EhaError(
            f"{curve.source}: the flow falls by {100.0 * falls[worst]:.0f} % of its largest while the command rises to"
            f" {place:.4g} {curve.unit}; a valve's flow does not, so check the rows there"
        )


def _start(command: Array, flow: Array, is_both_ways: bool) -> list[float]:
    """Initial values from a line through the lower half of each side, outside of the dead zone."""
    edges = []
    for sign in (1.0, -1.0):
        side = sign * flow
        chosen = (side > MOVING) & (side < 0.7)
        if np.count_nonzero(chosen) < 2 or np.ptp(command[chosen]) == 0.0:
            chosen = side > MOVING
        slope, height = np.polyfit(command[chosen], flow[chosen], 1)
        slope = slope if slope > 0.0 else 1.0
        edges.append((slope, -height / slope))
    (positive, right), (negative, left) = edges
    return [positive, negative, -0.5 * (right + left), 0.5 * (right - left), *([0.0] if is_both_ways else [])]


def _past_edge(overlap: Array, rounding: float) -> Array:
    if rounding <= 0.0:
        return np.maximum(overlap, 0.0)
    return np.where(overlap >= rounding, overlap, np.maximum(overlap + rounding, 0.0) ** 2 / (4.0 * rounding))


def flow_law(values: dict[str, float], command: Array, travel: Travel) -> Array:
    """The flow at each command; see above. Without a half width of the play the command moves the spool itself."""
    opening = behind_play(command, travel, values.get("half_width", 0.0)) + values["offset"]
    overlap, rounding = values["overlap"], values.get("rounding", 0.0)
    opening = _past_edge(opening - overlap, rounding) - _past_edge(-opening - overlap, rounding)
    opening = opening / (1.0 + values.get("curvature", 0.0) * np.abs(opening))
    flow = np.where(opening > 0.0, values["gain_positive"], values["gain_negative"]) * opening
    return np.clip(flow, -values.get("limit_negative", np.inf), values.get("limit_positive", np.inf))


def _fit(names: list[str], command: Array, travel: Travel, flow: Array, start: list[float] | Array) -> Regression:
    def law(values: Array) -> Array:
        return flow_law(dict(zip(names, values, strict=True)), command, travel)

    lower = [_EXTRA[name][0] if name in _EXTRA else -np.inf for name in names]
    upper = [_EXTRA[name][1] if name in _EXTRA else np.inf for name in names]
    return regress(law, flow, list(start), lower, upper)


def _extended(
    names: list[str], simple: Regression, command: Array, travel: Travel, flow: Array
) -> tuple[list[str], Regression]:
    """The law with the further terms that the curve decisively asks for, each of which must pay for itself."""
    best, chosen = 0.0, (names, simple)
    starts = {
        "rounding": 0.02, "curvature": 0.1, "limit_positive": 0.97 * float(flow.max()),
        "limit_negative": -0.97 * float(flow.min()),
    }  # fmt: skip
    for count in range(1, len(_EXTRA) + 1):
        for extra in combinations(_EXTRA, count):
            more = [*names, *extra]
            trial = _fit(more, command, travel, flow, [*simple.values, *(starts[name] for name in extra)])
            score = criterion_gain(simple, trial) - count * DECISIVE
            if score > best and _is_flat(dict(zip(more, trial.values, strict=True)), command, flow):
                best, chosen = score, (more, trial)
    return chosen


def _is_flat(values: dict[str, float], command: Array, flow: Array) -> bool:
    """Whether the flow is flat past each knee: a bend is no saturation."""
    for side, sign in (("positive", 1.0), ("negative", -1.0)):
        if f"limit_{side}" not in values:
            continue
        gain = values[f"gain_{side}"]
        knee = values[f"limit_{side}"] / gain + values["overlap"] - sign * values["offset"]
        past = sign * command > knee + abs(values.get("half_width", 0.0))
        # where a noisy ammeter reads too much at the end of a sweep, the flow seems flat as well
        if np.count_nonzero(past) < FEWEST_A_SIDE or np.ptp(command[past]) < AMMETER * np.ptp(command):
            return False
        if float(np.polyfit(command[past], flow[past], 1)[0]) > FLAT * gain:
            return False
    return True


def _unsaturated(names: list[str], fitted: Regression, command: Array, flow: Array) -> Array:
    """Which points are below each limit."""
    values = dict(zip(names, fitted.values, strict=True))
    room = 2.0 * fitted.deviation
    kept: Array = (flow < values.get("limit_positive", np.inf) - room) & (
        flow > room - values.get("limit_negative", np.inf)
    )
    return kept


def _deviation(command: Array, residual: Array) -> float:
    """The largest mean residual of a band, in parts of the largest flow."""
    bands = _bands(command)
    return max(abs(float(np.mean(residual[bands == band]))) for band in np.unique(bands))


def _values(curve: Curve, names: list[str], fitted: Regression, largest: float, full: float) -> dict[str, Value]:
    def value(name: str, quantity: Callable[[dict[str, float]], float], unit: str) -> Value:
        return Value(name, *fitted.of(lambda values: quantity(dict(zip(names, values, strict=True)))), unit)

    unit, gain = curve.unit, f"m^3/(s {curve.unit})"
    rows = [
        value("null_shift", lambda at: -at["offset"] * largest, unit),
        value("flow_gain_positive", lambda at: at["gain_positive"] * full / largest, gain),
        value("flow_gain_negative", lambda at: at["gain_negative"] * full / largest, gain),
        value("asymmetry", lambda at: 1.0 - at["gain_negative"] / at["gain_positive"], "-"),
        value("overlap", lambda at: at["overlap"] * largest, unit),
    ]
    if "half_width" in names:
        rows.append(value("hysteresis", lambda at: 2.0 * at["half_width"] * largest, unit))
    if "rounding" in names:
        rows.append(value("edge_rounding", lambda at: at["rounding"] * largest, unit))
    if "curvature" in names:
        rows.append(value("curvature", lambda at: at["curvature"] / largest, f"1/{unit}"))
    if "limit_positive" in names:
        rows.append(value("saturation_positive", lambda at: at["limit_positive"] * full, "m^3/s"))
    if "limit_negative" in names:
        rows.append(value("saturation_negative", lambda at: at["limit_negative"] * full, "m^3/s"))
    return {row.name: row for row in rows}


def _drawn(
    names: list[str], fitted: Regression, command: Array, travel: Travel, largest: float, full: float
) -> tuple[tuple[str, Array, Array], ...]:
    """The fitted law over the command, each way of travel where both were measured."""
    values = dict(zip(names, fitted.values, strict=True))
    grid = np.linspace(command.min(), command.max(), 400)
    ways = ((1.0, "fitted, rising"), (-1.0, "fitted, falling")) if "half_width" in names else ((1.0, "fitted"),)
    lines = []
    for sign, label in ways:
        way = Travel(np.full(grid.size, sign), np.full(grid.size, np.nan))
        lines.append((label, grid * largest, flow_law(values, grid, way) * full))
    return tuple(lines)
