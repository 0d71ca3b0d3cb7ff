"""The test that detects the smallest sizes of given effects, among a few kinds of signals within the rig's limits."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from threadpoolctl import threadpool_limits

from eha_core.detectability.margins import Margins
from eha_core.detectability.planned import Array, PlannedTest, RigAsModelled, linearised
from eha_core.detectability.refit import confirmed
from eha_core.diagnosis.calibrate import STEPS
from eha_core.diagnosis.detection.rows import effect_rows, middle_shapes, parameter_rows
from eha_core.diagnosis.detection.sizes import smallest, trials
from eha_core.diagnosis.experiment.command_signal import CommandSignal
from eha_core.diagnosis.experiment.limits import Limits
from eha_core.diagnosis.result import Detectable, Noticeable
from eha_core.errors import EhaError, ParameterError, remedy
from eha_core.nominal import NominalModel

SHARES = (1.0, 0.5, 0.2)
"""Shares of the largest amplitude within the limits at which each signal is tried: slow motion shows dry friction
best."""

DIGITS = 3
"""Significant digits of an amplitude, for a readable file."""

Row = Detectable | Noticeable
Named = Mapping[str, tuple[Row, ...]]
"""Rows by the requested name: an effect's sizes, or a nominal parameter's change."""


@dataclass(frozen=True)
class Candidate:
    """A signal that was tried; `ratio`: geometric mean of the requested sizes over those that the usual test finds."""

    kind: str
    signal: CommandSignal
    ratio: float


@dataclass(frozen=True)
class DesignedTest:
    """The best test for some effects, compared with a usual one.

    Attributes:
        names: the requested effects and nominal parameters.
        kind: of the signal: multisine, steps with dwell, hold, slow triangle. signal: as the reference node's.
        test: the command, and what is recorded.
        found: the sizes that it detects. usual: those of the usual test.
        margins: the limits, and the shares of them that the sampled rigs reach. usual_most: the largest share of each
            limit that any of them reaches in the usual test, which need not stay within the limits.
        tried: every signal, the best first.
    """

    names: tuple[str, ...]
    kind: str
    signal: CommandSignal
    test: PlannedTest
    found: Named
    usual: Named
    margins: Margins
    usual_most: Mapping[str, float]
    tried: tuple[Candidate, ...]


def design(model: NominalModel, names: Sequence[str], limits: Limits, usual: PlannedTest) -> DesignedTest:
    """The best test as long as `usual` is, with the same channels, noise and rate.

    Args:
        model: the rig as modelled.
        names: effects of the catalogue, or nominal parameters.
        limits: those of the rig.
        usual: the test that it is compared with.

    Raises:
        ParameterError: a name that is neither, or an actuator that no voltage drives.
        EhaError: no signal stays within these limits.
    """
    with threadpool_limits(1):
        before = linearised(model, usual)
        _check(names, before)
        reference = {name: _sizes(rows) for name, rows in _found(before, names).items()}
        margins = Margins.of(model, limits)
        times = np.arange(round(usual.duration * usual.rate)) / usual.rate
        candidates = []
        for kind, signal in _signals(margins, times):
            test = _test(usual, times, signal)
            sizes = {name: _sizes(rows) for name, rows in _found(linearised(model, test), names).items()}
            candidates.append(Candidate(kind, signal, _ratio(sizes, reference)))
        if not candidates:
            raise EhaError("no signal was found that stays within the limits; give wider ones, or a shorter test")
        tried = tuple(sorted(candidates, key=lambda candidate: candidate.ratio))
        best = tried[0]
        test = _test(usual, times, best.signal)
        return DesignedTest(
            tuple(names), best.kind, best.signal, test, _found(linearised(model, test), names, sure=True),
            _found(before, names, sure=True), margins.reached(best.signal.voltage(times), times),
            margins.reached(before.motion.voltage[:: round(1.0 / (usual.rate * STEPS[0]))], times).most, tried,
        )  # fmt: skip


def _check(names: Sequence[str], at: RigAsModelled) -> None:
    known = {trial.column.effect.id for trial in trials(at)} | {one.name for one in at.pool.plant}
    for name in names:
        if name not in known:
            what = remedy(name, sorted(known), "give effects that these channels can show, or nominal parameters")
            raise ParameterError(f"--for {name}: this test cannot show it; {what}")


def _test(usual: PlannedTest, times: Array, signal: CommandSignal) -> PlannedTest:
    return PlannedTest(times, signal.voltage(times), usual.duration, usual.channels, usual.noise, usual.rate)


def _found(at: RigAsModelled, names: Sequence[str], sure: bool = False) -> dict[str, tuple[Row, ...]]:
    """The detectable sizes of each name; `sure`: with the sizes of effects confirmed by fits."""
    tried = [trial for trial in trials(at) if trial.column.effect.id in names]
    chosen, factors = middle_shapes(tried, smallest(at, tried).tolist())
    effects = effect_rows(at, chosen, confirmed(at, chosen, factors) if sure else factors) if tried else ()
    parameters = [row for row in parameter_rows(at) if row.name in names]
    found: dict[str, tuple[Row, ...]] = {}
    for name in names:
        of_effect = tuple(row for row in effects if row.effect == name)
        found[name] = of_effect or tuple(row for row in parameters if row.name == name)
    return found


def _ratio(sizes: Mapping[str, Sequence[float]], usual: Mapping[str, Sequence[float]]) -> float:
    """The geometric mean of the ratios over all requested names, each with its largest independent size: half the size
    counts the same for a leak and for friction. A size that the usual test does not find counts as a gain of any test.
    """
    ratios = [max(sizes[name]) / max(usual[name]) if np.isfinite(max(usual[name])) else max(sizes[name])
              for name in sizes]  # fmt: skip
    return float(np.exp(np.mean(np.log(ratios))))


def _sizes(rows: Sequence[Row]) -> list[float]:
    """The sizes of one effect, or a parameter's change; for a leak its coefficient, as its flow depends on the test."""
    return [row.change if isinstance(row, Noticeable) else row.size if row.size is not None else inf for row in rows]


def _signals(margins: Margins, times: Array) -> Iterator[tuple[str, CommandSignal]]:
    """The signals within the limits, at a few shares of the largest amplitude within them."""
    for kind, made in kinds().items():
        for make in made:
            amplitude = margins.largest_amplitude(make, times)
            for share in SHARES if amplitude > 0.0 else ():
                # rounded down: rounding up would exceed a limit
                digits = 10.0 ** (np.floor(np.log10(share * amplitude)) - DIGITS + 1)
                yield kind, make(float(f"{np.floor(share * amplitude / digits) * digits:.{DIGITS}g}"))


def kinds() -> Mapping[str, Sequence[Callable[[float], CommandSignal]]]:
    """The signals that are tried, each a function of its amplitude [V], by their kind."""

    def band(lowest: float, highest: float) -> Callable[[float], CommandSignal]:
        return lambda volts: CommandSignal(
            "multisine", {"amplitude": volts, "lowest": lowest, "highest": highest, "count": 16, "period": 10.0}
        )

    def pulses(rise: float, hold: float, rest: float) -> Callable[[float], CommandSignal]:
        return lambda volts: CommandSignal("trapezoid", {"amplitude": volts, "rise": rise, "hold": hold, "rest": rest})

    return {
        "multisine": [band(0.2, 2.0), band(0.5, 8.0), band(2.0, 20.0)],
        "steps with dwell": [pulses(0.02, 0.5, 0.5), pulses(0.02, 2.0, 2.0)],
        "hold": [pulses(0.02, 0.2, 2.0), pulses(0.02, 0.2, 4.5)],
        "slow triangle": [pulses(0.5, 0.0, 0.0), pulses(2.5, 0.0, 0.0)],
    }
