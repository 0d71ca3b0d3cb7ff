"""Cases drawn from a seed: which rig, which test, what is concealed in it and what the diagnosis is given."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import numpy as np

from eha_exam.case import Case
from eha_exam.concealed import OTHER_LAWS, Setting, draw_effect
from eha_exam.excitation import SHAPES
from eha_exam.plants import FAMILIES, draw_nominal, draw_rig
from eha_exam.tiers import check_tier
from eha_exam.truth.record import CATALOGUE, OUTSIDE, Effect

WINDOWED = (
    "coulomb_friction",
    "constant_load",
    "external_leakage",
    "turbulent_leakage",
    "valve_null_offset",
    "supply_pressure_droop",
    "quadratic_damping",
    "pressure_sensor_bias",
)
"""Effects that a rig can have over an interval: a seal that drags, a load that hangs, a valve that a relief opens."""

TWINS = (
    ("constant_load", "flow_gain_asymmetry"),
    ("flow_gain_asymmetry", "constant_load"),
    ("external_leakage", "valve_null_offset"),
)
"""What command and position alone hardly tell apart: (concealed, rival). A load takes pressure from one direction's
orifices, and one chamber's leak feeds the piston a flow as a valve off its null does."""

WORN_RIG = (
    ("coulomb_friction", "stribeck_friction", "presliding_friction"),
    ("valve_deadband", "valve_null_offset", "flow_gain_asymmetry", "valve_null_leakage", "spool_hysteresis"),
    ("supply_pressure_droop", "return_back_pressure"),
    ("constant_load", "hardening_spring", "quadratic_damping"),
    (
        "position_sensor_lag",
        "position_sensor_backlash",
        "position_sensor_scale",
        "pressure_sensor_bias",
        "pressure_sensor_lag",
    ),
    ("turbulent_leakage", "external_leakage", "entrained_air", "bore_wear_leakage"),
)
"""What a worn rig has at once: at most one of each of these."""

LOAD = "constant_load"
"""What differs between several recordings of a rig."""

NOISES = (1.0, 3.0, 10.0)
FRICTION = {"coulomb_friction", "stribeck_friction", "presliding_friction"}


def draw_case(tier: str, number: int, seed: int) -> Case:
    """Case `number` of a tier; the same for the same seed, whatever else is drawn."""
    check_tier(tier)
    own_seed = int.from_bytes(hashlib.sha256(f"{seed} {tier} {number}".encode()).digest()[:6], "little")
    g = np.random.default_rng(own_seed)
    rig = draw_rig(str(g.choice(list(FAMILIES))), g)
    duration = float(g.choice((12.0, 16.0, 20.0)))
    amplitude = float(g.uniform(0.2, 0.5)) * rig.values["actuator_displacement"]
    speed = min(float(g.uniform(0.06, 0.25)) * rig.top_speed, 6.0 * amplitude)
    setting = Setting(rig, amplitude, speed, duration)
    effects, windows = _conceal(tier, number, setting, g)
    loop = float(g.uniform(6.0, 15.0)) if tier == "tracking" else float(g.choice((0.0, 1.0, 1.0)))
    rough = g.random() < 0.4
    loads = (float(draw_effect(LOAD, setting, g)["force"]),) if tier == "recordings" else ()
    case = Case(
        name=f"{tier}-{number:04d}",
        tier=tier,
        family=rig.family,
        seed=own_seed,
        plant=rig.values,
        nominal=draw_nominal(rig, g, 0.0 if tier == "null" else 0.3, tier == "wrong_rig"),
        effects=effects,
        windows=windows,
        shape=str(g.choice(SHAPES)),
        amplitude=amplitude,
        speed=speed,
        loop=loop,
        loop_integral=0.2 * loop * loop if tier == "tracking" else 0.0,
        duration=duration,
        rate=float(g.choice((500.0, 1000.0, 1000.0))),
        noise=float(g.choice(NOISES)),
        position_step=5e-6 if rough else 0.0,
        pressure_step=5e3 if rough else 0.0,
        jitter=1e-4 if rough else 0.0,
        dropout=0.01 if rough else 0.0,
        channels=("voltage_command", "position") if tier == "position_only" else Case.channels,
        loads=loads,
    )
    return _weakly_tested(case, TWINS[number % len(TWINS)][1]) if tier == "twins" else case


def _weakly_tested(case: Case, rival: str) -> Case:
    """The case with a noisy position sensor alone, where the rival looks the same once the effect is small."""
    return replace(
        case,
        rivals=(rival,),
        noise=3.0,
        position_step=0.0,
        jitter=0.0,
        dropout=0.0,
        channels=("voltage_command", "position"),
    )


def _conceal(
    tier: str, number: int, setting: Setting, g: np.random.Generator
) -> tuple[tuple[Effect, ...], dict[str, tuple[float, float]]]:
    equal = setting.rig.area_ratio == 1.0
    catalogue = [name for name in CATALOGUE if equal or name != "unequal_piston_area"]
    if tier in ("null", "null_parameters"):
        return (), {}
    if tier in ("pair", "three"):
        while True:
            names = [str(name) for name in g.choice(catalogue, 2 if tier == "pair" else 3, replace=False)]
            if len(FRICTION.intersection(names)) < 2:
                return tuple((name, draw_effect(name, setting, g)) for name in names), {}
    if tier == "recordings":
        while True:
            names = [str(name) for name in g.choice([name for name in catalogue if name != LOAD], 2, replace=False)]
            if len(FRICTION.intersection(names)) < 2:
                return tuple((name, draw_effect(name, setting, g)) for name in (LOAD, *names)), {}
    if tier == "rig":
        groups = sorted(g.choice(len(WORN_RIG), 4 + number % 3, replace=False).tolist())
        names = [str(g.choice(WORN_RIG[group])) for group in groups]
        return tuple((name, draw_effect(name, setting, g)) for name in names), {}
    if tier == "named_and_unknown":
        names = [catalogue[number % len(catalogue)], str(g.choice(list(OUTSIDE)))]
        return tuple((name, draw_effect(name, setting, g)) for name in names), {}
    if tier == "event":
        passing = WINDOWED[number % len(WINDOWED)]
        while True:
            names = [passing, *map(str, g.choice(catalogue, 1 + number % 2, replace=False))]
            if len(set(names)) == len(names) and len(FRICTION.intersection(names)) < 2:
                return tuple((name, draw_effect(name, setting, g)) for name in names), _for_a_while(passing, setting, g)
    pools = {
        "outside": list(OUTSIDE),
        "other_law": list(OTHER_LAWS),
        "window": list(WINDOWED),
        "twins": [concealed for concealed, _ in TWINS],
    }
    pool = pools.get(tier, catalogue)
    name = pool[number % len(pool)]
    share = 0.15 if tier == "small" else 1.0
    effect = (name, draw_effect(name, setting, g, share, other_law=tier == "other_law"))
    if tier == "window":
        return (effect,), _for_a_while(name, setting, g)
    return (effect,), {}


def _for_a_while(name: str, setting: Setting, g: np.random.Generator) -> dict[str, tuple[float, float]]:
    """From when until when an effect acts [s], by its name."""
    start = float(g.uniform(0.2, 0.45)) * setting.duration
    return {name: (start, start + float(g.uniform(0.25, 0.4)) * setting.duration)}
