"""Plants in lock-step against the scalar step, in turns on one core, and what that makes of a fit and of a study."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from time import process_time

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.row import Row
from eha_core.effects import Effect, effects
from eha_core.identification.free_parameters import free_nominal_parameters
from eha_core.identification.observation import observe
from eha_core.identification.problem import STATE_STEP, Point, changes, whole
from eha_core.identification.segments import cut
from eha_core.identification.shooting import Shooting
from eha_core.parameters import changed, nominal_values
from eha_core.plant import SEEN, simulate_many
from eha_core.plant.composite import compiled_step
from eha_core.plant.lockstep import LockStep
from eha_core.plant.packing import pack
from eha_core.plant.ring import LONGEST_DELAY
from eha_core.recording import read_recording

STEP, EVERY, STEPS = 5e-4, 4, 5_000  # as a fit takes derivatives: rows of four columns at 500 Hz
ROUNDS = 40
TARGET = 3.5
DIVISIONS, ROOTS = 15, 4
"""In a step of the nominal plant, about: what it cannot be faster than."""
RECORDING = Path(__file__).parent.parent / "bags" / "rig_deadband_and_friction.mcap"
RIGS, SECONDS, STUDY_STEP = 1000, 10.0, 2e-4
STUDY_TARGET = 10_000.0
"""Times real time on one core: half of what two are asked for."""

Array = NDArray[np.float64]


def measure() -> list[Row]:
    """Time nominal plants, plants with one effect, a Jacobian and a study. The shortest run of each counts, and CPU
    time is taken, so that what else the machine does counts as little as it can."""
    rows = [_step_row(f"{sets} nominal plants", _step_times({}, sets), TARGET) for sets in (8, 16)]
    found = {effect.id: _step_times(_typical(effect), 8) for effect in effects() if effect.named}
    ranked = sorted(found, key=lambda name: found[name][1] / found[name][0])
    for what, name in (("least", ranked[0]), ("median", ranked[len(ranked) // 2]), ("most", ranked[-1])):
        rows.append(_step_row(f"8 plants with the effect of the {what} gain, {name}", found[name], None))
    return [*rows, _limit_row(_step_times({}, 8)[0]), _jacobian_row(), _study_row()]


def _typical(effect: Effect) -> dict[str, float]:
    return {name: row.typical for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)}


def _step_times(parameters: Mapping[str, float], count: int) -> tuple[float, float]:
    """Seconds a step and plant, in lock-step and alone."""
    nominal = changed(nominal_values(), parameters)
    sets = [{**nominal, "moving_mass": float(mass)} for mass in np.linspace(8.0, 12.0, count)]
    voltages = 0.1 * np.sin(2.0 * np.pi * 3.0 * STEP * np.arange(STEPS))
    lanes = LockStep(sets, STEP)
    lanes.place(np.array([[0.0, 0.0, 1.05e7, 1.05e7]] * count))
    lanes.start_memory()
    seen = np.empty((STEPS // EVERY, 4, lanes.lanes))
    packed = [pack(values, STEP) for values in sets]
    memory, history = np.zeros(64), np.zeros(round(LONGEST_DELAY / STEP) + 3)
    state = np.array([0.0, 0.0, 2.1e7, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.05e7, 1.05e7])
    rows = np.empty((STEPS // EVERY, 4))
    advance = compiled_step().advance

    def one_by_one() -> None:
        for vector, active, valve in packed:
            advance(state.copy(), memory, history, vector, active, valve, voltages, STEP, EVERY, rows)

    together, alone = _shortest(lambda: lanes.advance(0, voltages[None], EVERY, seen), one_by_one)
    return together / STEPS / count, alone / STEPS / count


def _shortest(*actions: Callable[[], object]) -> list[float]:
    """The shortest CPU time of each action [s], taken in turns."""
    times = [[_seconds(action) for action in actions] for _ in range(ROUNDS)]
    return [min(column) for column in zip(*times, strict=True)]


def _seconds(action: Callable[[], object]) -> float:
    start = process_time()
    action()
    return process_time() - start


def _step_row(what: str, times: tuple[float, float], target: float | None) -> Row:
    together, alone = times
    return Row(
        f"lock-step: {what}",
        f"{together * 1e9:.1f} ns a step and plant",
        f"the scalar step: {alone * 1e9:.1f} ns",
        f"{alone / together:.2f} x faster",
        "stated" if target is None else f">= {target:g} x",
        target is None or alone / together >= target,
    )


def _limit_row(step: float) -> Row:
    """The lock-step beside what its divisions and roots alone take, in vectors as wide as this core has them."""
    above, below, out = np.full(512, 3.0), np.full(512, 1.7), np.zeros(512)  # they stay in the nearest cache
    times = _shortest(lambda: _divide(above, below, out, 200), lambda: _take_roots(below, out, 200))
    division, root = (taken / 200 / len(out) for taken in times)
    limit = DIVISIONS * division + ROOTS * root
    return Row(
        "lock-step beside the machine's limit",
        f"{step * 1e9:.1f} ns a step and plant",
        f"{DIVISIONS} divisions of {division * 1e9:.2f} ns and {ROOTS} roots of {root * 1e9:.2f} ns and nothing else:"
        f" {limit * 1e9:.1f} ns",
        f"{step / limit:.2f} x the limit",
        "stated",
        True,
    )


@numba.njit(error_model="numpy")
def _divide(above: Array, below: Array, out: Array, rounds: int) -> None:
    for turn in range(rounds):
        for k in range(len(out)):
            out[k] += above[k] / (below[k] + turn)


@numba.njit(error_model="numpy")
def _take_roots(of: Array, out: Array, rounds: int) -> None:
    for turn in range(rounds):
        for k in range(len(out)):
            out[k] += np.sqrt(of[k] + turn)


def _jacobian_row() -> Row:
    """A fit's derivatives on a recording of bags/, sampling included, against one simulation after another."""
    observation = observe(read_recording(RECORDING))
    problem = whole(cut(observation, nominal_values()))
    coarse, states = problem.slopes, problem.shooting.initial_states
    values = nominal_values()
    moved: list[Point] = [
        ({**values, parameter.name: 1.001 * values[parameter.name]}, states)
        for parameter in free_nominal_parameters(values, "voltage", 0.05)
    ]
    moved += [(values, states + step) for step in np.diag(STATE_STEP)]

    def one_by_one() -> None:
        before, _ = coarse.simulate(values, states)
        for point in moved:
            problem.flat(coarse.sample(coarse.simulate(*point)[0] - before))

    together, alone = _shortest(partial(changes, problem, (values, states), moved), one_by_one)
    return Row(
        f"a Jacobian of {len(moved)} columns on {RECORDING.name}, {_length(coarse):g} s",
        f"{together * 1e3:.1f} ms",
        f"one simulation after another: {alone * 1e3:.1f} ms",
        f"{alone / together:.2f} x faster",
        "stated",
        True,
    )


def _length(shooting: Shooting) -> float:
    return float(shooting.edges[-1]) * shooting.step_size


def _study_row() -> Row:
    generator = np.random.default_rng(1)
    drawn = zip(generator.uniform(5.0, 20.0, RIGS), generator.uniform(8e8, 1.6e9, RIGS), strict=True)
    sets = [{"moving_mass": float(mass), "bulk_modulus": float(bulk)} for mass, bulk in drawn]
    steps = round(SECONDS / STUDY_STEP)
    voltages = 0.1 * np.sin(2.0 * np.pi * 3.0 * STUDY_STEP * np.arange(steps))
    study = partial(simulate_many, sets, voltages, step_size=STUDY_STEP, every=10, columns=SEEN)
    taken = min(_seconds(study) for _ in range(3))
    factor = RIGS * SECONDS / taken
    return Row(
        f"{RIGS:,} plants, {SECONDS:g} s each at a step of {STUDY_STEP:g} s, on one core",
        f"{taken:.2f} s, {taken / RIGS / steps * 1e9:.1f} ns a step and plant",
        "the wall clock",
        f"{factor:,.0f} x real time",
        f">= {STUDY_TARGET:,.0f} x",
        factor >= STUDY_TARGET,
    )
