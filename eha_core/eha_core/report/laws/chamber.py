"""Laws in the chambers' continuity: leakage between the chambers or to the outside, and the oil's stiffness."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.diagnosis.result import NamedEffect
from eha_core.effects import effect_title
from eha_core.identification.numbers import Array
from eha_core.report.laws.law import NOTHING, Axis, Law, band, span_of
from eha_core.report.laws.models import Models, contribution, in_order, values_of
from eha_core.report.stage import SURE
from eha_core.report.wording import capital
from eha_core.weak_form.grid import Grid

DIFFERENCE = Axis("pressure difference A − B", "Pa")
PRESSURE = Axis("chamber pressure", "Pa")
POSITION = Axis("piston position", "m")
BULK_A, CROSS, CONDUCTANCE, LEAK_A = 1, 5, 6, 7
"""Places of these among the values that a contribution returns; see `eha_core.plant.hooks`."""


def law(models: Models, effect: NamedEffect) -> Law | None:
    """The flow over the pressure that drives it, the bulk modulus over the pressure, or the leakage over the
    position."""
    a, b = models.state("pressure_a"), models.state("pressure_b")
    if not len(a):
        return None
    values = values_of(effect)
    title = capital(effect_title(effect.id))
    without = [column[0] for column in quantities(models, None, {}, a[:1], b[:1])]
    changed = [float(column[0]) for column in quantities(models, effect, values, a[:1] + 1e5, b[:1])]
    middle = 0.5 * float(np.median(a + b))
    if changed[BULK_A] != without[BULK_A]:
        return _bulk(models, effect, title, span_of(np.append(a, b), False))
    if changed[LEAK_A] != without[LEAK_A]:
        return _outside(models, effect, title, span_of(a, False), middle)
    places = span_of(models.state("position"), False)
    there = quantities(models, effect, values, 0.0 * places, 0.0 * places, places)[CONDUCTANCE]
    if np.ptp(there) > 0.0:
        return _along(models, effect, title, places)
    return _across(models, effect, title, span_of(a - b), middle)


def quantities(
    models: Models,
    effect: NamedEffect | None,
    values: Mapping[str, float],
    a: Array,
    b: Array,
    places: Array | None = None,
) -> list[Array]:
    """The quantities in the continuity equations at these pressures, with one effect or none, in the middle of the
    stroke or at `places`."""
    p = models.fitted
    rows = []
    places = 0.0 * a if places is None else places
    for pressure_a, pressure_b, place in zip(a.tolist(), b.tolist(), places.tolist(), strict=True):
        flow = p["internal_leakage"] * (pressure_a - pressure_b)
        head = [
            p["piston_area_b"], p["bulk_modulus"], 0.0, p["bulk_modulus"], 0.0, flow, p["internal_leakage"],
            p["external_leakage"], p["external_leakage"],
        ]  # fmt: skip
        if effect is not None:
            call = contribution(effect)[0]
            head = list(
                call(*head, place, pressure_a, pressure_b, p["atmospheric_pressure"], *in_order(effect, values))
            )
        rows.append(head)
    return list(np.array(rows, dtype=np.float64).T)


def _across(models: Models, effect: NamedEffect, title: str, x: Array, middle: float) -> Law | None:
    def evaluate(values: Mapping[str, float]) -> Array:
        return quantities(models, effect, values, middle + 0.5 * x, middle - 0.5 * x)[CROSS]

    y, low, high = band(effect, evaluate, SURE * models.deviation("internal_leakage") * x)
    nominal = models.nominal["internal_leakage"] * x
    if np.array_equal(y, quantities(models, None, {}, middle + 0.5 * x, middle - 0.5 * x)[CROSS]):
        return None  # the effect changes no flow, but for example an area
    points_x, points_y = NOTHING, NOTHING
    if models.grid is not None and models.spool is not None:
        _, _, a, b = models.modelled
        points_x = models.grid.average(a - b)
        lost = lost_flows(models, models.grid)
        points_y = np.interp(points_x, x, y) + 0.5 * (lost[0] - lost[1])
    return Law(title, DIFFERENCE, Axis("Flow from A to B", "m^3/s"), x, y, low, high, nominal, points_x, points_y)


def _along(models: Models, effect: NamedEffect, title: str, x: Array) -> Law:
    def evaluate(values: Mapping[str, float]) -> Array:
        return quantities(models, effect, values, 0.0 * x, 0.0 * x, x)[CONDUCTANCE]

    y, low, high = band(effect, evaluate, SURE * models.deviation("internal_leakage"))
    points_x, points_y = NOTHING, NOTHING
    if models.grid is not None and models.spool is not None:
        place, _, a, b = models.modelled
        flow = models.grid.average(np.interp(place, x, y) * (a - b))
        lost = lost_flows(models, models.grid)
        place, a, b = models.on_grid(models.diagnosis.pictures.measured)
        driving = models.grid.average(a - b)
        strong = np.abs(driving) > np.median(np.abs(driving))  # a small pressure difference hardly determines the flow
        points_x = models.grid.average(place)[strong]
        points_y = ((flow + 0.5 * (lost[0] - lost[1])) / driving)[strong]
    nominal = 0.0 * x + models.nominal["internal_leakage"]
    up = Axis("Leakage from A to B", "m^3/(s Pa)")
    return Law(title, POSITION, up, x, y, low, high, nominal, points_x, points_y)


def _outside(models: Models, effect: NamedEffect, title: str, x: Array, middle: float) -> Law:
    def evaluate(values: Mapping[str, float]) -> Array:
        return quantities(models, effect, values, x, 0.0 * x + middle)[LEAK_A] * x

    y, low, high = band(effect, evaluate)
    points_x, points_y = NOTHING, NOTHING
    if models.grid is not None and models.spool is not None:
        points_x = models.grid.average(models.modelled[2])
        points_y = np.interp(points_x, x, y) + lost_flows(models, models.grid)[0]
    nominal = models.nominal["external_leakage"] * x
    return Law(title, PRESSURE, Axis("Flow out of chamber A", "m^3/s"), x, y, low, high, nominal, points_x, points_y)


def _bulk(models: Models, effect: NamedEffect, title: str, x: Array) -> Law:
    def evaluate(values: Mapping[str, float]) -> Array:
        return quantities(models, effect, values, x, x)[BULK_A]

    y, low, high = band(effect, evaluate, SURE * models.deviation("bulk_modulus"))
    nominal = 0.0 * x + models.nominal["bulk_modulus"]
    return Law(title, PRESSURE, Axis("Bulk modulus", "Pa"), x, y, low, high, nominal)


def lost_flows(models: Models, grid: Grid) -> tuple[Array, Array]:
    """The flow out of each chamber beyond that of the final model, averaged with each test function [m^3/s]."""
    measured = models.on_grid(models.diagnosis.pictures.measured)
    x, _, a, b = models.modelled
    assert models.spool is not None
    return tuple(  # type: ignore[return-value]
        (_lost_volume(grid, models, side, *measured) - _lost_volume(grid, models, side, x, a, b)) / grid.area
        for side in (1.0, -1.0)
    )


def _lost_volume(grid: Grid, models: Models, side: float, x: Array, a: Array, b: Array) -> Array:
    """The nominal valve's flow into a chamber (A: side 1, B: -1) minus the flow that its motion and the compression of
    its oil take up, integrated with each test function [m^3]."""
    p, spool = models.fitted, models.spool
    assert spool is not None
    own, area = (a, p["piston_area"]) if side > 0.0 else (b, p["piston_area_b"])
    filling = np.where(side * spool >= 0.0, p["supply_pressure"] - own, own - p["return_pressure"])
    inflow = side * p["valve_gain"] * spool * np.sqrt(np.maximum(filling, 0.0))
    volume = p["line_volume"] + area * (p["actuator_displacement"] + side * x)
    speed = np.gradient(x, grid.step)
    # V dP/dt integrates by parts to -(slope V + weight dV/dt) P
    squeezed = -(grid.integrate(grid.slope, volume * own) + grid.integrate(grid.weight, side * area * speed * own))
    swept = -side * area * grid.integrate(grid.slope, x)
    return np.asarray(grid.integrate(grid.weight, inflow) - swept - squeezed / p["bulk_modulus"])
