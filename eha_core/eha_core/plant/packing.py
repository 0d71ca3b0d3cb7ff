"""A plant's parameters as the compiled step takes them, with the exact solution of its valve over one step."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, lru_cache
from math import expm1
from operator import itemgetter

import numpy as np
from scipy.linalg import expm

from eha_core.effects import effects
from eha_core.parameters import step_rows
from eha_core.plant.composite import given_names, given_sources
from eha_core.plant.composition import PAPER, Composition
from eha_core.plant.given import VALVES


@lru_cache(maxsize=4096)
def propagator(
    resistance: float, inductance: float, damping_ratio: float, frequency: float, step_size: float
) -> tuple[float, ...]:
    """Exact solution of equations (1) and (2) over one step, as `eha_core.plant.step.advance` takes it.

    Under a held voltage the current moves from one target to the next as (1 - exp(-a t)) / (1 - exp(-a h)) with
    a = R_c / L_c; the spool's response to a constant and to exp(-a t) comes from one matrix exponential.
    """
    rate = resistance / inductance
    square = frequency * frequency
    system = np.zeros((4, 4))
    system[0, 1] = 1.0
    system[1] = [-square, -2.0 * damping_ratio * frequency, square, square]
    system[3, 3] = -rate
    response = expm(system * step_size)
    decayed = -expm1(-rate * step_size)
    constant, fading = response[:2, 2], response[:2, 3]
    from_old = (fading - (1.0 - decayed) * constant) / decayed
    from_new = (constant - fading) / decayed
    rows = [[response[i, 0], response[i, 1], from_old[i], from_new[i]] for i in range(2)]
    return (1.0 - decayed, 1.0 / resistance, *map(float, rows[0]), *map(float, rows[1]))


@lru_cache(maxsize=4096)
def held_propagator(damping_ratio: float, frequency: float, step_size: float) -> tuple[float, ...]:
    """Exact solution of equation (2) over one step under a held current, in the places of `propagator`."""
    square = frequency * frequency
    system = np.zeros((3, 3))
    system[0, 1] = 1.0
    system[1] = [-square, -2.0 * damping_ratio * frequency, square]
    response = expm(system * step_size)
    rows = [[response[i, 0], response[i, 1], 0.0, response[i, 2]] for i in range(2)]
    return (0.0, 0.0, *map(float, rows[0]), *map(float, rows[1]))


Reader = Callable[[Mapping[str, float]], tuple[float, ...]]
"""Takes some of a plant's parameters, as a tuple."""


@cache
def _vector_of() -> Reader:
    """Takes what the compiled step takes out of a plant's parameters, as a tuple."""
    return itemgetter(*step_rows())


@cache
def _switches() -> tuple[tuple[str, float, int], ...]:
    """Every parameter that switches an effect, its neutral value, and the effect's number in the catalogue."""
    return tuple(
        (f"{effect.id}.{row.name}", row.nominal, number)
        for number, effect in enumerate(effects())
        for row in effect.parameters
        if row.switches
    )


def active_effects(values: Mapping[str, float]) -> tuple[bool, ...]:
    """Which effects of the catalogue act, as `Effect.is_active` says of each: a fit asks for this in each column of
    each Jacobian."""
    acting = {number for name, neutral, number in _switches() if values[name] != neutral}
    return tuple(number in acting for number in range(len(effects())))


Packed = tuple[tuple[float, ...], tuple[bool, ...], tuple[float, ...]]


def pack(values: Mapping[str, float], step_size: float, composition: Composition = PAPER) -> Packed:
    """Parameters (catalogue order), which effects act (catalogue order), and the valve's propagator.

    Tuples, for the compiled step holds them in registers and does no reference counting on them. `values` are those of
    the equations, `Composition.places`. Where the source's input is measured, its own parameters and what `given` reads
    follow those of the catalogue.
    """
    active = active_effects(values)
    vector = _vector_of()(values)
    source = composition.source
    if source.valve == "coil" or source.given:
        valve = propagator(
            values["coil_resistance"], values["coil_inductance"], values["valve_damping_ratio"],
            values["valve_natural_frequency"], step_size,
        )  # fmt: skip
        return vector, active, valve
    spool = source.switched or ("valve_damping_ratio", "valve_natural_frequency")
    valve = held_propagator(values[spool[0]], values[spool[1]], step_size)
    own = [values.get(name.partition(".")[2], 0.0) for name in given_names()[:-3]]
    number = [given.id for given in given_sources()].index(source.id)
    last = (float(source.line), VALVES["sign" if source.switched else source.valve], float(number))
    return (*vector, *own, *last), active, valve
