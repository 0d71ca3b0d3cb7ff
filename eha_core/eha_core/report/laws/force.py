"""Laws in the piston's force balance: friction over velocity, a load or a spring over position."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from eha_core.diagnosis.result import NamedEffect
from eha_core.effects import effect_title
from eha_core.identification.numbers import Array
from eha_core.report.laws.law import NOTHING, Axis, Law, band, span_of
from eha_core.report.laws.models import Models, contribution, in_order, values_of
from eha_core.report.stage import SURE
from eha_core.report.wording import capital
from eha_core.weak_form.grid import Grid

STEP = 1e-4  # s
SETTLED = 4000
"""Most steps until an effect's own state has settled at a steady speed: 0.4 s."""


class Beside(NamedTuple):
    """Quantities that some effects depend on: the nominal damping [N s/m], and the pressure across the piston [Pa]."""

    damping: float
    pressure: float


VELOCITY = Axis("velocity", "m/s")
POSITION = Axis("position", "m")


def law(models: Models, effect: NamedEffect) -> Law | None:
    """The force against motion, together with the nominal model's viscous or spring force over the same axis."""
    velocity, position = models.state("velocity"), models.state("position")
    if not len(velocity):
        return None
    beside = _beside(models)
    over_velocity = _depends_on_velocity(effect, velocity, position, beside)
    name, axis = ("damping_coefficient", VELOCITY) if over_velocity else ("spring_stiffness", POSITION)
    x = span_of(velocity if over_velocity else position)

    def evaluate(values: Mapping[str, float]) -> Array:
        own = opposing(effect, values, *((0.0 * x, x) if over_velocity else (x, 0.0 * x)), beside)
        return own + models.fitted[name] * x

    y, low, high = band(effect, evaluate, SURE * models.deviation(name) * x)
    rubs = "friction" in effect.id or "damping" in effect.id
    what = "Friction force" if rubs else "Force against extension"
    points = _points(models, effect, over_velocity)
    title, nominal = capital(effect_title(effect.id)), models.nominal[name] * x
    return Law(title, axis, Axis(what, "N"), x, y, low, high, nominal, *points)


def _beside(models: Models) -> Beside:
    """The fitted damping, and the median pressure across the piston."""
    a, b = models.state("pressure_a"), models.state("pressure_b")
    pressure = float(np.median(np.abs(a - b))) if len(a) and len(a) == len(b) else 0.0
    return Beside(models.fitted["damping_coefficient"], pressure)


def _depends_on_velocity(effect: NamedEffect, velocity: Array, position: Array, beside: Beside) -> bool:
    """Whether the effect's force varies more over the visited speeds than over the visited positions."""
    values = values_of(effect)
    v, x = span_of(velocity), span_of(position)
    over_velocity = np.ptp(opposing(effect, values, 0.0 * v, v, beside))
    return bool(over_velocity >= np.ptp(opposing(effect, values, x, 0.0 * x, beside)))


def opposing(
    effect: NamedEffect, values: Mapping[str, float], position: Array, velocity: Array, beside: Beside
) -> Array:
    """The force of an effect against motion at steady speeds [N], beyond that of the nominal damping."""
    call, slots = contribution(effect)
    parameters = in_order(effect, values)
    found = np.empty(len(velocity))
    for place, (x, v) in enumerate(zip(position.tolist(), velocity.tolist(), strict=True)):
        memory, before = np.zeros(max(slots, 1)), np.inf
        for _ in range(SETTLED if slots else 1):
            force, damping, _, dry = call(
                0.0, beside.damping, 0.0, 0.0, x, v, beside.pressure, 0.0, memory, 0, STEP, *parameters
            )  # fmt: skip
            now = -force + (damping - beside.damping) * v + dry * np.sign(v)
            if abs(now - before) <= 1e-9 * abs(now):
                break
            before = now
        found[place] = now
    return found


def _points(models: Models, effect: NamedEffect, over_velocity: bool) -> tuple[Array, Array]:
    grid = models.grid
    if grid is None:
        return NOTHING, NOTHING
    x, v, a, b = models.modelled
    own = grid.average(_along(effect, values_of(effect), x, v, _beside(models)))
    beyond = missing_force(grid, models.fitted, *models.on_grid(models.diagnosis.pictures.measured))
    beyond = beyond - missing_force(grid, models.fitted, x, a, b)
    name, state = ("damping_coefficient", v) if over_velocity else ("spring_stiffness", x)
    across = grid.average(state)
    # if the piston stops or reverses under a test function, the mean mixes the friction of both directions
    kept = models.keeps_moving
    return across[kept], (own + beyond + models.fitted[name] * across)[kept]


def _along(effect: NamedEffect, values: Mapping[str, float], position: Array, velocity: Array, beside: Beside) -> Array:
    """The effect's force along a motion, from its steady curve; the lag of its own state stays in the residual."""
    if np.ptp(velocity) == 0.0 or not contribution(effect)[1]:
        return opposing(effect, values, position, velocity, beside)
    table = span_of(velocity)
    return np.interp(velocity, table, opposing(effect, values, 0.0 * table, table, beside))


def missing_force(grid: Grid, values: Mapping[str, float], x: Array, a: Array, b: Array) -> Array:
    """The force against motion [N] missing from the nominal terms, averaged with each test function."""
    pressures = grid.integrate(grid.weight, values["piston_area"] * a - values["piston_area_b"] * b)
    inertia = values["moving_mass"] * grid.integrate(grid.curvature, x)
    viscous = -values["damping_coefficient"] * grid.integrate(grid.slope, x)
    spring = values["spring_stiffness"] * grid.integrate(grid.weight, x)
    return np.asarray((pressures - inertia - viscous - spring) / grid.area)
