"""Recordings of simulated rigs, sound ones and ones in which a mistake was made on purpose."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from eha_core.parameters import nominal_values
from eha_core.recording import CHANNEL_KINDS, Channel, Recording
from eha_core.recording.channel_rules import DEFAULT_RULES
from eha_core.recording.reader import STANDARD_ATMOSPHERE
from eha_core.recording.recording import FloatArray
from eha_exam.case import Case
from eha_exam.drawing import draw_case
from eha_exam.measuring import measure, simulate_case
from eha_exam.tiers import plan

VELOCITY_NOISE = 1e-3
"""m/s, standard deviation at noise 1x, as `eha simulate --noise 1` adds."""

Arrays = Mapping[str, tuple[FloatArray, FloatArray]]


@dataclass(frozen=True)
class Rig:
    """A simulated rig: what was recorded of it, and the nominal values that a diagnosis of it is given."""

    case: Case
    arrays: Arrays
    nominal: Mapping[str, float]


def rigs(seed: int, count: int) -> Iterator[Rig]:
    """Rigs of the exam's independent truth, every tier in turn, with a velocity sensor."""
    for tier, number in plan(count):
        yield make_rig(draw_case(tier, number, seed))


def make_rig(case: Case) -> Rig:
    """Run a case's test on the truth and record it."""
    truth = simulate_case(case)
    return Rig(case, with_velocity(case, measure(case, truth), truth), {**nominal_values(), **case.nominal})


def with_velocity(case: Case, arrays: Arrays, truth: Mapping[str, FloatArray]) -> Arrays:
    """What was measured of a truth, and what a noisy velocity sensor tells beside it."""
    noise = case.noise * VELOCITY_NOISE * np.random.default_rng([case.seed, 3]).standard_normal(len(truth["time"]))
    return {**arrays, "velocity": (truth["time"], truth["velocity"] + noise)}


def as_recording(arrays: Arrays) -> Recording:
    """The recording that reading these channels from the contract's topics gives."""
    channels = {}
    for name, kind in CHANNEL_KINDS.items():
        if name in arrays:
            rule = replace(DEFAULT_RULES[name], topic=f"/{DEFAULT_RULES[name].topic}")
            channels[name] = Channel(name, *arrays[name], kind.unit, f"/{DEFAULT_RULES[name].topic}", "", rule)
    duration = max(float(channel.time[-1]) for channel in channels.values())
    return Recording(Path("rig.mcap"), channels, 0, duration, {}, (), None, ())


@dataclass(frozen=True)
class Mistake:
    """A mistake: what it is, the words by which it is reported, and what it makes of a rig's channels."""

    name: str
    expected: str
    make: Callable[[Rig, Rig], Arrays]


def _scaled(factor: float, *names: str) -> Callable[[Rig, Rig], Arrays]:
    def make(rig: Rig, _: Rig) -> Arrays:
        changed = dict(rig.arrays)
        for name in names:
            time, values = changed[name]
            zero = STANDARD_ATMOSPHERE if name.startswith("pressure") else 0.0  # a message has absolute pressures
            changed[name] = (time, factor * (values + zero) - zero)
        return changed

    return make


def _swapped(rig: Rig, _: Rig) -> Arrays:
    return {**rig.arrays, "pressure_a": rig.arrays["pressure_b"], "pressure_b": rig.arrays["pressure_a"]}


def _copied(source: str, target: str) -> Callable[[Rig, Rig], Arrays]:
    return lambda rig, _: {**rig.arrays, target: rig.arrays[source]}


def _of_another_run(name: str) -> Callable[[Rig, Rig], Arrays]:
    def make(rig: Rig, other: Rig) -> Arrays:
        time = rig.arrays[name][0]
        return {**rig.arrays, name: (time, np.interp(time, *other.arrays[name]))}

    return make


def _moved(share: float) -> Callable[[Rig, Rig], Arrays]:
    def make(rig: Rig, _: Rig) -> Arrays:
        time, values = rig.arrays["position"]
        return {**rig.arrays, "position": (time, values + share * rig.case.plant["actuator_displacement"])}

    return make


def _in_mm_from_one_end(rig: Rig, _: Rig) -> Arrays:
    time, values = _moved(1.0)(rig, rig)["position"]
    return {**rig.arrays, "position": (time, 1e3 * values)}


MISTAKES = (
    Mistake("command reversed", "voltage_command", _scaled(-1.0, "voltage_command")),
    Mistake("position reversed", "position has the opposite", _scaled(-1.0, "position")),
    Mistake("velocity reversed", "velocity has the opposite", _scaled(-1.0, "velocity")),
    Mistake("position and velocity reversed", "position and velocity", _scaled(-1.0, "position", "velocity")),
    Mistake("chambers swapped", "swapped", _swapped),
    Mistake("position in mm", "position is in mm", _scaled(1e3, "position")),
    Mistake("position in cm", "position is in cm", _scaled(1e2, "position")),
    Mistake("position in inches", "position is in inches", _scaled(1.0 / 0.0254, "position")),
    Mistake("velocity in mm/s", "velocity is in mm/s", _scaled(1e3, "velocity")),
    Mistake("position in mm, velocity in mm/s", "mm and velocity in mm/s", _scaled(1e3, "position", "velocity")),
    Mistake("velocity in inches/s", "velocity is in inches/s", _scaled(1.0 / 0.0254, "velocity")),
    Mistake("position in mm from one end", "mm and is not measured", _in_mm_from_one_end),
    Mistake("command in mV", "mV", _scaled(1e3, "voltage_command")),
    Mistake("pressures in kPa", "in kPa", _scaled(1e-3, "pressure_a", "pressure_b")),
    Mistake("pressures times 10", "are in a tenth of Pa", _scaled(10.0, "pressure_a", "pressure_b")),
    Mistake("pressures times 0.1", "are in tens of Pa", _scaled(0.1, "pressure_a", "pressure_b")),
    Mistake("one pressure times 10", "pressure_a is in a tenth of Pa", _scaled(10.0, "pressure_a")),
    Mistake("one pressure times 0.1", "pressure_b is in tens of Pa", _scaled(0.1, "pressure_b")),
    Mistake("chamber A recorded twice", "recorded twice", _copied("pressure_a", "pressure_b")),
    Mistake("chamber B recorded twice", "recorded twice", _copied("pressure_b", "pressure_a")),
    Mistake("another run's command", "voltage_command is unrelated", _of_another_run("voltage_command")),
    Mistake("another run's velocity", "velocity is unrelated", _of_another_run("velocity")),
    Mistake("position from one end", "mid-stroke", _moved(1.0)),
    Mistake("position from the other end", "mid-stroke", _moved(-1.0)),
)
"""Mistakes of wiring, mapping and units, as first recordings have them."""

SUBSETS: tuple[tuple[str, ...], ...] = (
    (), ("velocity",), ("velocity", "pressure_a"), ("velocity", "pressure_a", "pressure_b"),
)  # fmt: skip
"""Channels that a rig may lack."""


def kinds() -> Iterator[tuple[Mistake, tuple[str, ...]]]:
    """Every mistake with every subset of channels that leaves what it is made in, and the way to tell it."""
    for lacking in SUBSETS:
        for mistake in MISTAKES:
            if not any(_concerns(mistake, name) for name in lacking):
                yield mistake, lacking


def _concerns(mistake: Mistake, lacking: str) -> bool:
    kind = lacking.partition("_")[0]
    return kind in mistake.name or (kind == "pressure" and "chamber" in mistake.name)


def make_wrong(mistake: Mistake, rig: Rig, other: Rig, lacking: tuple[str, ...] = ()) -> Recording:
    """A rig's recording with a mistake; `other` is the rig whose run is taken for it where that is the mistake."""
    return as_recording({name: pair for name, pair in mistake.make(rig, other).items() if name not in lacking})
