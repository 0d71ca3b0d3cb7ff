"""The terms that a law of given motion can have: friction, spring and inertia."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from eha_core.motion_given.motion import Array, Indices, Motion
from eha_core.motion_given.states import bouc_wen, direction

Columns = Callable[[Motion, Array, tuple[float, ...]], list[Array]]


@dataclass(frozen=True)
class Shape:
    """A parameter inside a term. It is searched from each of `starts`, between `lower` and `upper`, by factors."""

    name: str
    unit: str
    starts: tuple[float, ...]
    lower: float
    upper: float
    by_speed: bool = False
    """Whether starts and bounds are shares of the motion's largest speed, and not in `unit`."""


@dataclass(frozen=True)
class Term:
    """One part of a law: force = sum of sizes times columns.

    Attributes:
        id: the effect's, where the catalogue has it.
        kind: terms of one kind are forms of one law, of which a set has one at most.
        statement: what it says, with the parameters by name.
        equation: the force that it adds.
        sizes: (name, unit) of each linear parameter.
        shapes: what is searched inside.
        columns: (motion, dry friction's direction or state, shape values) to one column for each size.
        signed: whether sizes may be negative: friction, springs and masses of a rig are not.
        needs_pressure: whether a chamber's pressure must have been recorded.
        levels: values of the schedule at which each size has a value of its own; empty where it does not depend on it.
        schedule: the schedule's name, with its unit.
    """

    id: str
    kind: str
    statement: str
    equation: str
    sizes: tuple[tuple[str, str], ...]
    columns: Columns
    shapes: tuple[Shape, ...] = ()
    needs_pressure: bool = False
    signed: bool = False
    levels: tuple[float, ...] = ()
    schedule: str = ""


DISTANCE = Shape("distance", "m", (3e-5, 3e-4, 2e-3), 1e-6, 0.05)
CREEP = Shape("creep_speed", "m/s", (0.03, 0.1), 0.003, 2.0, by_speed=True)


def _pressed(motion: Motion) -> Array:
    assert motion.pressure is not None
    return np.abs(motion.pressure)


BAR = 1e5

ELASTIC = 2.0 / 3.0
"""Power of the load with which friction of smooth elastic contact grows (Hertz; J. F. Archard, "Elastic deformation and
the laws of friction", Proceedings of the Royal Society A 243, 1957)."""


def _stribeck(motion: Motion, dry: Array, shape: tuple[float, ...]) -> list[Array]:
    falling = np.exp(-((motion.velocity / shape[0]) ** 2))
    return [dry, dry * falling]


TERMS = (
    Term("viscous_friction", "viscous friction", "viscous friction of {damping} opposes motion", "damping v",
         (("damping", "N s/m"),), lambda motion, dry, shape: [motion.velocity]),
    Term("directional_damping", "viscous friction",
         "viscous friction differs by direction: {forward} at positive and {backward} at negative speed",
         "forward v for v > 0, backward v for v < 0", (("forward", "N s/m"), ("backward", "N s/m")),
         lambda motion, dry, shape: [np.maximum(motion.velocity, 0.0), np.minimum(motion.velocity, 0.0)]),
    Term("quadratic_damping", "quadratic damping", "fast motion is braked by {coefficient}", "coefficient v |v|",
         (("coefficient", "N s^2/m^2"),), lambda motion, dry, shape: [motion.velocity * np.abs(motion.velocity)]),
    Term("coulomb_friction", "dry friction", "{force} of dry friction opposes motion", "force sign(v)",
         (("force", "N"),), lambda motion, dry, shape: [dry]),
    Term("stribeck_friction", "dry friction",
         "dry friction of {force} is {excess} higher at rest, and falls over {stribeck_velocity}",
         "(force + excess exp(-(v / stribeck_velocity)^2)) sign(v)",
         (("force", "N"), ("excess", "N")), _stribeck,
         (Shape("stribeck_velocity", "m/s", (0.05, 0.2), 0.02, 2.0, by_speed=True),)),
    Term("bouc_wen_friction", "dry friction",
         "dry friction of {force} is hysteretic and rises with the speed: it turns over within {distance} after each"
         " reversal, and has risen to 71 % of its height at {creep_speed} (Bouc-Wen with creep)",
         "force z, z' = |v| (v / sqrt(v^2 + creep_speed^2) - z) / distance", (("force", "N"),),
         lambda motion, dry, shape: [dry], (DISTANCE, CREEP)),
    Term("load_friction", "friction under pressure", "dry friction grows with the chamber's pressure by {coefficient}",
         "coefficient |P| sign(v), or z where dry friction is hysteretic", (("coefficient", "m^2"),),
         lambda motion, dry, shape: [_pressed(motion) * dry], needs_pressure=True),
    Term("contact_friction", "friction under pressure",
         "dry friction grows with the chamber's pressure to the power 2/3, as of an elastic seal: {force} at 1 bar",
         "force (|P| / 1 bar)^(2/3) sign(v), or z where dry friction is hysteretic", (("force", "N"),),
         lambda motion, dry, shape: [(_pressed(motion) / BAR) ** ELASTIC * dry], needs_pressure=True),
    Term("constant_load", "load", "a steady force of {force} pushes against positive motion", "force",
         (("force", "N"),), lambda motion, dry, shape: [np.ones_like(motion.time)], signed=True),
    Term("pressure_load", "pressed area",
         "a force goes with the pressure and not with the motion: the area that it acts on is off by {area}", "area P",
         (("area", "m^2"),), lambda motion, dry, shape: [_pressed(motion)], needs_pressure=True, signed=True),
    Term("spring", "spring", "a spring of {stiffness} pushes back", "stiffness x", (("stiffness", "N/m"),),
         lambda motion, dry, shape: [motion.position]),
    Term("moving_mass", "inertia", "a mass of {mass} is accelerated", "mass dv/dt", (("mass", "kg"),),
         lambda motion, dry, shape: [motion.acceleration]),
)  # fmt: skip
"""Every term. The force is that which moves the rig: positive along positive position."""


def dry_state(term: Term | None, motion: Motion, shape: tuple[float, ...]) -> Array:
    """What dry friction of one unit is over the motion: the direction, or the state of a hysteretic law."""
    if term is not None and term.id == "bouc_wen_friction":
        return np.asarray(bouc_wen(motion.velocity, motion.step, *shape))
    return np.asarray(direction(motion.velocity, motion.moving))


def moving_average(values: Array, samples: float, rows: Indices | None = None) -> Array:
    """The centred mean over a window of so many samples, which need not be whole; shorter at the ends.

    `rows`: where it is wanted; everywhere by default.
    """
    running = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]))])
    place = np.arange(len(values)) if rows is None else rows
    last = len(values) - 1.0
    low, high = np.clip(place - 0.5 * samples, 0.0, last), np.clip(place + 0.5 * samples, 0.0, last)
    return np.asarray((_between(running, high) - _between(running, low)) / (high - low))


def _between(values: Array, place: Array) -> Array:
    """Linear interpolation between the samples of an even axis."""
    before = np.minimum(place.astype(np.int64), len(values) - 2)
    share = place - before
    return np.asarray(values[before] * (1.0 - share) + values[before + 1] * share)
