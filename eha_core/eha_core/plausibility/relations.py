"""How the channels of a recording stand to each other and to the nominal actuator, whatever physics is missing.

The bounds are wide: they were set on 150 simulated recordings of the exam's kind (up to two effects, loads, leaks,
stops, single rods and closed loops, parameters up to 30 % off); docs/reliability.md counts on others what they pass.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eha_core.plant import PAPER, Composition
from eha_core.plausibility.signals import Signals, on_grid
from eha_core.recording import Recording
from eha_core.recording.recording import FloatArray

Values = Mapping[str, float]

LATEST_MOTION = 0.1
"""s by which the piston may follow the command: coil, spool, delays and sensors' lags."""
MOVING = 0.1
"""Share of the largest speed above which the valve, and no leak, sets the pressures."""
BLOCK = 2.0
"""s; the force is compared with the speed block by block, so that a stop that is hit or a load that comes and goes
spoils only its own."""


@dataclass(frozen=True)
class Relation:
    """One thing that must hold: its name, the value that was found, whether that is certainly wrong or certainly right
    (it may be neither), and how far it lies from the ideal, as a logarithm or in units of its own bound."""

    name: str
    value: float
    broken: bool
    sound: bool
    distance: float


OF_A_VALVE = ("command", "command_scale", "level")
"""Relations that hold because a valve throttles what a constant supply gives."""


def relations(recording: Recording, nominal: Values, composition: Composition = PAPER) -> dict[str, Relation]:
    """Every relation that can be looked at in a recording, by name; none where the piston does not move."""
    signals = on_grid(recording)
    if signals is None or not np.ptp(signals.speed) > 0.0:
        return {}
    found = [
        _reach(signals, nominal),
        *_velocity(signals),
        *_command(signals, nominal),
        *_force(signals, nominal),
        *_levels(signals, nominal),
    ]
    left_out = () if composition.source.valve else OF_A_VALVE
    return {relation.name: relation for relation in found if relation.name not in left_out}


def _correlation(one: FloatArray, other: FloatArray) -> float:
    one, other = one - one.mean(), other - other.mean()
    return float(one @ other / np.sqrt((one @ one) * (other @ other) + 1e-300))


def _regression(values: FloatArray, *columns: FloatArray) -> tuple[FloatArray, float]:
    """Coefficients of the columns, and the share of the variance that they and a constant explain."""
    table = np.stack([*columns, np.ones(len(values))], axis=1)
    scale = np.max(np.abs(table), axis=0) + 1e-300
    solution = np.linalg.lstsq(table / scale, values, rcond=None)[0]
    rest = values - (table / scale) @ solution
    variance = float(np.sum((values - values.mean()) ** 2)) + 1e-300
    return solution / scale, 1.0 - float(rest @ rest) / variance


def explained_by(values: FloatArray, signal: FloatArray) -> float:
    """The share of the variance of `values` that a signal explains; none of it where the signal never changes."""
    return _regression(values, signal)[1] if np.ptp(signal) > 0.0 else 0.0


def _within(ratio: float, bound: float) -> bool:
    return 1.0 / bound < ratio < bound


def _log(ratio: float) -> float:
    return abs(float(np.log(abs(ratio) + 1e-12)))


def _reach(signals: Signals, nominal: Values) -> Relation:
    """Where the piston was, in shares of the stroke to either side of its middle."""
    lowest, highest = (float(bound(signals.channels["position"])) for bound in (np.min, np.max))
    stroke = nominal["actuator_displacement"]
    reach = max(-lowest, highest) / stroke
    one_sided = min(-lowest, highest) < 0.25 * max(-lowest, highest)
    wide = highest - lowest > 4.0 * stroke
    return Relation("reach", reach, reach > 1.05 and (one_sided or wide), 2e-3 < reach <= 1.05, max(0.0, reach - 1.0))


def _velocity(signals: Signals) -> list[Relation]:
    """The velocity against the position's derivative."""
    velocity = signals.channels.get("velocity")
    if velocity is None:
        return []
    correlation = _correlation(signals.speed, velocity)
    slope = float(_regression(velocity, signals.speed)[0][0])
    unrelated = abs(correlation) < 0.6 and not _within(slope, 1.25)  # a noisy sensor's slope is still 1
    wrong = unrelated or (abs(correlation) > 0.5 and not _within(slope, 2.5))
    return [Relation("velocity", slope, wrong, correlation > 0.7 and _within(slope, 1.5), _log(slope))]


def _force_of(signals: Signals, nominal: Values) -> FloatArray | None:
    """The oil's force on the piston [N], of the pressures where both were measured."""
    channels = signals.channels
    if "pressure_a" in channels and "pressure_b" in channels:
        return np.asarray(
            nominal["piston_area"] * channels["pressure_a"] - nominal["piston_area_b"] * channels["pressure_b"]
        )
    return channels.get("force")


def gain(nominal: Values) -> float:
    """Steady speed of the unloaded nominal piston per volt, the mean of both directions [m/(s V)]."""
    ratio = nominal["piston_area_b"] / nominal["piston_area"]
    roots = [np.sqrt(share / (1.0 + ratio**3) * nominal["supply_pressure"]) for share in (1.0, ratio)]
    return float(np.mean(roots)) * nominal["valve_gain"] / nominal["piston_area"] / nominal["coil_resistance"]


def _command(signals: Signals, nominal: Values) -> list[Relation]:
    """The command against what it must be made of: the flow that moves the piston, and leakage under the force."""
    command, force = signals.channels.get("voltage_command"), _force_of(signals, nominal)
    if command is None or not np.ptp(command) > 0.0:
        return []
    others = (force,) if force is not None else (signals.channels["position"], signals.acceleration)
    fits = []
    for delay in range(0, round(LATEST_MOTION / signals.step) + 1, max(1, round(0.01 / signals.step))):
        earlier, speed = command[: len(command) - delay], signals.speed[delay:]
        explained = _regression(earlier, speed, *(other[delay:] for other in others))[1]
        # The slope on the speed alone: beside a force that goes with it, its own share is any.
        fits.append((explained, _correlation(earlier, speed), float(_regression(earlier, speed)[0][0])))
    explained, correlation, slope = max(fits)
    ratio = slope * gain(nominal)  # command per speed, over the nominal
    related = explained > 0.3 and abs(correlation) > 0.3
    return [
        Relation("command", explained, explained < 0.18, explained > 0.3, 0.0),
        Relation("command_scale", ratio, related and not _within(ratio, 25.0), related and _within(ratio, 12.0),
                 _log(ratio) if related else 0.0),
    ]  # fmt: skip


def _force(signals: Signals, nominal: Values) -> list[Relation]:
    """What of the force goes with the speed, beside inertia and spring: the load dissipates."""
    force = _force_of(signals, nominal)
    if force is None:
        return []
    count = max(1, round(len(force) * signals.step / BLOCK))
    columns = (force, signals.speed, signals.acceleration, signals.channels["position"])
    parts, slopes = [], []
    for block in zip(*(np.array_split(column, count) for column in columns), strict=True):
        rest = [values - _fit(values, *block[2:]) for values in block[:2]]
        parts.append(_correlation(*rest))
        slopes.append(float(rest[0] @ rest[1] / (rest[1] @ rest[1] + 1e-300)))
    part = float(np.median(parts))
    found = [Relation("force", part, part < -0.2, part > 0.1, 0.0)]
    if "force" in signals.channels and force is signals.channels["force"] and nominal["damping_coefficient"] > 0.0:
        ratio = float(np.median(slopes)) / nominal["damping_coefficient"]
        found.append(Relation("force_scale", ratio, 0.0 < ratio < 0.02, ratio > 0.1, _log(ratio)))
    return found


def _fit(values: FloatArray, *columns: FloatArray) -> FloatArray:
    coefficients, _ = _regression(values, *columns)
    return np.asarray(np.stack([*columns, np.ones(len(values))], axis=1) @ coefficients)


def _levels(signals: Signals, nominal: Values) -> list[Relation]:
    """The pressures against the supply's: in a valve that feeds one chamber as it drains the other, one pressure gives
    the other, whatever its gain."""
    pressures = [signals.channels[name] for name in ("pressure_a", "pressure_b") if name in signals.channels]
    if not pressures:
        return []
    supply = nominal["supply_pressure"]
    if len(pressures) < 2:
        highest = float(np.max(pressures[0])) / supply
        return [Relation("level", highest, highest > 3.0, highest < 2.0, _log(highest / 0.6))]
    a, b = pressures
    extending = signals.speed > MOVING * np.max(signals.speed)
    retracting = signals.speed < MOVING * np.min(signals.speed)
    ratio = (nominal["piston_area_b"] / nominal["piston_area"]) ** 2
    over = [(ratio * (a - supply) + b)[extending] / (1.0 + ratio), (ratio * a + b - supply)[retracting] / (1.0 + ratio)]
    excess = 2.0 * float(np.mean(np.concatenate(over))) / supply
    load = float(np.mean(nominal["piston_area"] * a - nominal["piston_area_b"] * b)) / (nominal["piston_area"] * supply)
    lopsided = min(abs(excess), abs(load)) > 0.12 and abs(excess * load) > 0.04
    broken = lopsided or not -0.75 < excess < 0.6
    distance = 3.0 * (abs(excess) + abs(load))  # a pressure ten times too large or small is then one of 1 or more
    return [Relation("level", excess, broken, not broken and -0.55 < excess < 0.4, distance)]
