"""Laws of the valve: how far its ports open over the spool's position."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.diagnosis.result import NamedEffect
from eha_core.effects import effect_title
from eha_core.identification.numbers import Array
from eha_core.report.laws.chamber import lost_flows
from eha_core.report.laws.law import NOTHING, Axis, Law, band, span_of
from eha_core.report.laws.models import Models, contribution, in_order
from eha_core.report.wording import capital

SPOOL = Axis("spool position", "A")
LEAST_DROP = 0.05
"""Share of the supply pressure; a smaller pressure drop hardly determines an orifice's opening."""


def law(models: Models, effect: NamedEffect) -> Law | None:
    """The effective opening of a port; None for a leakage that opens nothing."""
    spool = models.state("spool_position")
    if not len(spool):
        return None
    x = span_of(spool)

    def evaluate(values: Mapping[str, float]) -> Array:
        return opening(effect, values, x)

    y, low, high = band(effect, evaluate)
    if np.allclose(y, x, rtol=1e-9, atol=0.0):
        return None
    points = _points(models, x, y)
    title = capital(effect_title(effect.id))
    return Law(title, SPOOL, Axis("Opening of the ports", "A"), x, y, low, high, x, *points)


def opening(effect: NamedEffect, values: Mapping[str, float], spool: Array) -> Array:
    """The opening with the effect [A]; a change of gain counts as a change of opening."""
    call, parameters = contribution(effect)[0], in_order(effect, values)
    rows = [call(place, 1.0, 0.0, place, *parameters) for place in spool.tolist()]
    return np.array([opened * gain for opened, gain, _ in rows], dtype=np.float64)


def _points(models: Models, x: Array, y: Array) -> tuple[Array, Array]:
    """The mean of the openings that both chambers' flows give, where both pressure drops are large enough."""
    grid, spool = models.grid, models.spool
    if grid is None or spool is None:
        return NOTHING, NOTHING
    p = models.fitted
    _, _, a, b = models.modelled
    lost = lost_flows(models, grid)
    openings = []
    for side, own, flow in ((1.0, a, lost[0]), (-1.0, b, lost[1])):
        filling = np.where(side * spool >= 0.0, p["supply_pressure"] - own, own - p["return_pressure"])
        drop = grid.average(filling)
        enough = drop > LEAST_DROP * p["supply_pressure"]
        root = np.sqrt(np.where(enough, drop, np.nan))
        openings.append(-side * flow / (p["valve_gain"] * root))
    across = grid.average(spool)
    points = grid.average(np.interp(spool, x, y)) + 0.5 * (openings[0] + openings[1])
    kept = np.isfinite(points)
    return across[kept], points[kept]
