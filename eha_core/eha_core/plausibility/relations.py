"""Relations between a recording's channels and to the nominal actuator that hold whatever physics is missing.

The bounds are wide: they were set on 150 simulated recordings of the exam's kind (up to two effects, loads, leaks,
stops, single rods and closed loops, parameters up to 30 % off); docs/reliability.md counts on others what they pass.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eha_core.plant import PAPER, Composition
from eha_core.plausibility.command import command, gain, rated
from eha_core.plausibility.regression import correlation, fitted, regression
from eha_core.plausibility.relation import Relation, Values, off_by, within
from eha_core.plausibility.signals import BLOCK, LARGEST_NOISE, Signals, on_grid
from eha_core.recording import Recording
from eha_core.recording.recording import FloatArray

MOVING = 0.1
"""Share of the largest speed above which the valve, not a leak, determines the pressures."""
SLOW = 0.006
"""RMS speed, as a share of the rated one, below which a leak may lower both pressures as much as a wrong unit. With an
external leak of q times the piston's flow at half the supply, both are at the share p of the supply where
(1 + 2 q p) / (1 - 2 q p) = sqrt((1 - p) / p): an eighth at q = 1.8. A worn rig's leak takes 1 % of the rated flow
(assumed)."""
NOTHING_LEFT = -0.98
"""Excess of both pressures, over half the supply, that no leak explains while the piston moves (assumed). With unequal
areas it is this share of the excess of empty chambers, where that is larger."""
OPPOSED = -0.2
"""Correlation of the oil's force with the speed below which the force opposes the motion."""
DRIVEN = -0.95
"""Correlation of speed and oil's force at a given command below which an external force drives the piston against the
pressures. In 295 recordings of the exam's kind it was -0.99 in the one that was driven so, and +0.95 in two, in which
swapped chambers would not be found."""
LOW = -0.55
"""Excess of both pressures, over half the supply, above which their levels may be certainly right."""


OF_A_VALVE = ("command", "command_scale", "level")
"""Relations that hold only for a valve fed by a constant supply."""


def relations(recording: Recording, nominal: Values, composition: Composition = PAPER) -> dict[str, Relation]:
    """Every relation that a recording's channels allow to check, by name; none where the piston does not move."""
    signals = on_grid(recording)
    if signals is None or not np.ptp(signals.speed) > 0.0:
        return {}
    found = [
        _reach(signals, nominal),
        *_velocity(signals),
        *command(signals, nominal, _force_of(signals, nominal)),
        *_force(signals, nominal),
        *_levels(signals, nominal),
    ]
    left_out = () if composition.source.valve else OF_A_VALVE
    return {relation.name: relation for relation in found if relation.name not in left_out}


def _reach(signals: Signals, nominal: Values) -> Relation:
    """The piston's farthest position from mid-stroke, as a share of the stroke to either side."""
    lowest, highest = (float(bound(signals.channels["position"])) for bound in (np.min, np.max))
    stroke = nominal["actuator_displacement"]
    reach = max(-lowest, highest) / stroke
    one_sided = min(-lowest, highest) < 0.25 * max(-lowest, highest)
    wide = highest - lowest > 4.0 * stroke
    return Relation("reach", reach, reach > 1.05 and (one_sided or wide), 2e-3 < reach <= 1.05, max(0.0, reach - 1.0))


def _velocity(signals: Signals) -> list[Relation]:
    """The velocity compared with the position's derivative."""
    velocity = signals.channels.get("velocity")
    if velocity is None or not signals.is_motion_seen:
        return []
    together = correlation(signals.speed, velocity)
    slope = float(regression(velocity, signals.speed)[0][0])
    seen = signals.noise["velocity"] < LARGEST_NOISE * float(np.std(velocity))
    unrelated = seen and abs(together) < 0.6 and not within(slope, 1.25)
    wrong = unrelated or (abs(together) > 0.5 and not within(slope, 2.5))
    return [Relation("velocity", slope, wrong, together > 0.7 and within(slope, 1.5), off_by(slope))]


def _force_of(signals: Signals, nominal: Values) -> FloatArray | None:
    """The oil's force on the piston [N], from both pressures or else from the force; None without these."""
    channels = signals.channels
    if "pressure_a" in channels and "pressure_b" in channels:
        return np.asarray(
            nominal["piston_area"] * channels["pressure_a"] - nominal["piston_area_b"] * channels["pressure_b"]
        )
    return channels.get("force")


def _noise_of_force(signals: Signals, nominal: Values) -> float:
    """Standard deviation of the noise in what `_force_of` gives [N]."""
    if "pressure_a" in signals.channels and "pressure_b" in signals.channels:
        a, b = (signals.noise[name] for name in ("pressure_a", "pressure_b"))
        return float(np.hypot(nominal["piston_area"] * a, nominal["piston_area_b"] * b))
    return signals.noise["force"]


def _force(signals: Signals, nominal: Values) -> list[Relation]:
    """The part of the force that is proportional to the speed, apart from inertia and spring: the load dissipates,
    unless it drives the piston.

    Only blocks in which the piston reverses count: in one direction friction is constant and other changes dominate.
    A block in which that force is noise supports neither sign.
    """
    force = _force_of(signals, nominal)
    if force is None or not signals.is_motion_seen:
        return []
    count = max(1, round(len(force) * signals.step / BLOCK))
    noise = _noise_of_force(signals, nominal)
    columns = (force, signals.speed, signals.acceleration, signals.channels["position"], *_command_and_rate(signals))
    parts, slopes, at_a_command = [], [], []
    for block in zip(*(np.array_split(column, count) for column in columns), strict=True):
        if not _reverses(block[1], MOVING * float(np.max(np.abs(signals.speed)))):
            continue
        rest = _rest(block[:2], block[2:4])
        seen = noise < LARGEST_NOISE * np.std(rest[0])
        parts.append(correlation(*rest) if seen else 0.0)
        slopes.append(float(rest[0] @ rest[1] / (rest[1] @ rest[1] + 1e-300)))
        at_a_command.append(correlation(*_rest(block[:2], block[4:])) if block[4:] else 0.0)
    if not parts:
        return []
    part = float(np.median(parts))
    opposed = part < OPPOSED and float(np.median(at_a_command)) > DRIVEN
    found = [Relation("force", part, opposed, part > 0.05, 0.0)]
    if "force" in signals.channels and force is signals.channels["force"] and nominal["damping_coefficient"] > 0.0:
        ratio = float(np.median(slopes)) / nominal["damping_coefficient"]
        found.append(Relation("force_scale", ratio, 0.0 < ratio < 0.02, ratio > 0.1, off_by(ratio)))
    return found


def _command_and_rate(signals: Signals) -> tuple[FloatArray, ...]:
    """The command and its derivative, which represents a valve's lag; empty where it was not recorded."""
    voltage = signals.channels.get("voltage_command")
    return () if voltage is None else (voltage, np.gradient(voltage, signals.step))


def _rest(columns: Sequence[FloatArray], others: Sequence[FloatArray]) -> list[FloatArray]:
    """The residual of each column after a fit by the others."""
    return [values - fitted(values, *others) for values in columns]


def _reverses(speed: FloatArray, least: float) -> bool:
    """Whether the piston moves in both directions faster than `least`."""
    return bool(np.min(speed) < -least and np.max(speed) > least)


def _levels(signals: Signals, nominal: Values) -> list[Relation]:
    """The pressures compared with the supply's: in a valve that feeds one chamber as it drains the other, one pressure
    determines the other, whatever the gain."""
    pressures = [signals.channels[name] for name in ("pressure_a", "pressure_b") if name in signals.channels]
    if not pressures:
        return []
    supply = nominal["supply_pressure"]
    if len(pressures) < 2:
        highest = float(np.max(pressures[0])) / supply
        return [Relation("level", highest, highest > 3.0, highest < 2.0, off_by(highest / 0.6))]
    a, b = pressures
    extending = signals.speed > MOVING * np.max(signals.speed)
    retracting = signals.speed < MOVING * np.min(signals.speed)
    ratio = (nominal["piston_area_b"] / nominal["piston_area"]) ** 2
    over = [(ratio * (a - supply) + b)[extending] / (1.0 + ratio), (ratio * a + b - supply)[retracting] / (1.0 + ratio)]
    excess = 2.0 * float(np.mean(np.concatenate(over))) / supply
    empty = 2.0 * float(np.average([ratio, 1.0], weights=[np.sum(extending), np.sum(retracting)])) / (1.0 + ratio)
    load = float(np.mean(nominal["piston_area"] * a - nominal["piston_area_b"] * b)) / (nominal["piston_area"] * supply)
    lopsided = min(abs(excess), abs(load)) > 0.12 and abs(excess * load) > 0.04
    drawn_down = excess < 0.0 and _is_slow(signals, nominal)
    lowest = NOTHING_LEFT * max(1.0, empty) if drawn_down else -0.75
    broken = (lopsided and not drawn_down) or not lowest < excess < 0.6
    sound = not broken and not lopsided and LOW < excess < 0.4
    distance = 3.0 * (abs(excess) + abs(load))  # 1 or more for a pressure ten times too large or too small
    return [Relation("level", excess, broken, sound, distance)]


def _is_slow(signals: Signals, nominal: Values) -> bool:
    """Whether the piston takes so little flow that a leak may take more; the noise's share of the speed is removed."""
    squared = float(np.var(signals.speed)) - signals.speed_noise**2
    return squared < (SLOW * gain(nominal) * rated(nominal)) ** 2
