"""The plant against integrators of other houses at equal accuracy, in four tasks; all judged by one tight integration.

An integrator of ordinary differential equations needs a slope everywhere, so dry friction and the stroke's ends are
smoothed for it, by as much as serves it best. The judge is CVODE at 1e-9, with friction and ends smoothed by a
hundredth of the least that its competitors use.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, partial
from math import pi
from time import perf_counter
from typing import Any

import numpy as np
from scipy.integrate import odeint, solve_ivp

from benchmarks.actuator import SCALES, Array, Setting, odeint_rate, rk4, start
from benchmarks.cvode import Cvode
from benchmarks.plant_step import compiled_reference
from benchmarks.row import Row
from eha_core.plant import Plant

DURATION = 2.0
HOLD = 2e-3  # s; a controller at 500 Hz, and the spacing of the compared instants
TIMES = HOLD * np.arange(round(DURATION / HOLD))
OBSERVED = [3, 5, 6]
"""Where piston position and pressures stand in the state."""

STEP_SIZES = (1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5)
RK4_STEPS = (1, 2, 4, 10, 20, 40, 100)  # in each hold
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
ROUNDS = 5
TARGET = 100.0
PATIENCE = 0.5  # s; a setting that takes longer is not the cheapest

Run = Callable[[], Array]


@dataclass(frozen=True)
class Task:
    """What is integrated, and how near it must come.

    Attributes:
        name: as the table has it.
        rhs: the right-hand side's setting; the plant has `effects` for it.
        voltages: (n,) [V] held for HOLD each; None where `rhs` has a sine.
        within: error allowed in position [m] and in a pressure [Pa]; the largest, or of `squares` the root mean square.
        smoothed: what smooths friction and ends, each alternative less; the last one the judge's.
    """

    name: str
    rhs: Setting
    voltages: Array | None = None
    effects: Mapping[str, float] | None = None
    position: float = 0.0
    within: tuple[float, float] = (1e-6, 100.0)
    squares: bool = False
    smoothed: tuple[Mapping[str, float], ...] = ({},)

    @property
    def accuracy(self) -> str:
        """`within`, in words."""
        kind = "root mean square within" if self.squares else "within"
        return f"{kind} {self.within[0]:g} m and {self.within[1]:g} Pa"

    def near(self, found: Array, judge: Array) -> bool:
        """Whether states (n, 7) are near enough to the judge's."""
        apart = (found - judge)[:, OBSERVED]
        size = np.sqrt(np.mean(apart**2, axis=0)) if self.squares else np.max(np.abs(apart), axis=0)
        return bool(size[0] <= self.within[0] and max(size[1:]) <= self.within[1])


@dataclass(frozen=True)
class Sufficient:
    """The cheapest setting of a method that comes near enough, and the time of one run [s]."""

    setting: str
    seconds: float


def _sum_of_sines() -> Array:
    """Three sines, none a multiple of another, sampled as a controller would."""
    parts = ((12e-3, 1.3), (8e-3, 7.1), (4e-3, 23.7))  # V, Hz
    return np.asarray(sum(amplitude * np.sin(2.0 * pi * frequency * TIMES) for amplitude, frequency in parts))


STRIBECK = {"force": 250.0, "static_force": 450.0, "stribeck_velocity": 0.002}  # N, N, m/s
TASKS = (
    Task("a smooth 1 Hz sine", Setting(amplitude=8.4e-3, frequency=1.0)),
    Task("a controller's command, held for 2 ms each", Setting(), _sum_of_sines()),
    Task(
        "stick-slip (Stribeck friction, a slow command held for 2 ms each)",
        Setting(sliding=STRIBECK["force"], static=STRIBECK["static_force"], stribeck_velocity=0.002),
        2e-3 * np.sin(2.0 * pi * TIMES),
        {f"stribeck_friction.{name}": value for name, value in STRIBECK.items()},
        within=(5e-6, 5e4),  # half the sensors' noise in position; pressures jump by 6e5 Pa at each break-away
        squares=True,
        smoothed=({"width": 1e-4}, {"width": 1e-5}, {"width": 1e-7}),
    ),
    Task(
        "the stroke's end (a command held for 2 ms each drives into it)",
        Setting(),
        0.03 * np.sin(2.0 * pi * TIMES),
        position=0.096,
        within=(5e-6, 5e4),
        squares=True,
        smoothed=(
            {"stiffness": 1e9, "damping": 1e5}, {"stiffness": 1e10, "damping": 3e5}, {"stiffness": 1e12, "damping": 3e6}
        ),
    ),
)  # fmt: skip


def measure() -> list[Row]:
    """Find each method's cheapest sufficient setting for each task and compare their times."""
    return [row for task in TASKS for row in _rows(task)]


def _rows(task: Task) -> Iterator[Row]:
    judge = _cvode(task, task.smoothed[-1], 1e-9)()
    plant = _cheapest(task, judge, {f"a step of {step:g} s": partial(_plant, task, step) for step in STEP_SIZES})
    assert plant is not None, "the plant comes near enough at its shortest step"
    for peer, runs, target in _peers(task):
        yield _row(task, plant, peer, _cheapest(task, judge, runs), target)


def _peers(task: Task) -> Iterator[tuple[str, dict[str, Run], float | None]]:
    """Each peer's name, what it can be set to, and the target against it, if there is one."""
    smoothings = task.smoothed[:-1] or task.smoothed
    words = {_words(smoothed): smoothed for smoothed in smoothings}
    pairs = [(text, smoothed, tolerance) for text, smoothed in words.items() for tolerance in TOLERANCES]
    in_c = compiled_reference()
    if in_c is not None and not task.squares:  # it knows neither friction nor ends
        runs = {f"a step of {HOLD / steps:g} s": partial(_rk4_in_c, in_c, task, steps) for steps in RK4_STEPS}
        yield "RK4 in C, -O3 -march=native", runs, None
    yield (
        "RK4 compiled by numba",
        {
            f"a step of {HOLD / steps:g} s{text}": partial(_rk4, task, smoothed, steps)
            for text, smoothed in words.items()
            for steps in RK4_STEPS
        },
        None,
    )
    yield (
        "SUNDIALS CVODE, compiled right-hand side",
        {f"rtol {tolerance:g}{text}": _cvode(task, smoothed, tolerance) for text, smoothed, tolerance in pairs},
        None,
    )
    scipy: dict[str, Callable[..., Array]] = {"odeint": _odeint}
    if not task.squares:
        scipy["solve_ivp(method='LSODA')"] = _solve_ivp
    for name, integrate in scipy.items():
        yield (
            f"SciPy's {name}, compiled right-hand side",
            {
                f"rtol {tolerance:g}{text}": partial(_scipy, integrate, task, smoothed, tolerance)
                for text, smoothed, tolerance in pairs
            },
            None if task.squares else TARGET,
        )


def _words(smoothed: Mapping[str, float]) -> str:
    return "".join(f", {name} {value:g}" for name, value in smoothed.items())


def _cheapest(task: Task, judge: Array, runs: Mapping[str, Run]) -> Sufficient | None:
    """The fastest of the settings that come near enough; looser ones are not always faster."""
    best: tuple[float, str] | None = None
    for setting, run in runs.items():
        try:
            near = task.near(run(), judge)
        except ArithmeticError:
            continue
        taken = _seconds(run) if near else np.inf
        if near and (best is None or taken < best[0]):
            best = taken, setting
    if best is None:
        return None
    again = [_seconds(runs[best[1]]) for _ in range(ROUNDS if best[0] < PATIENCE else 0)]
    return Sufficient(best[1], min([best[0], *again]))


def _seconds(run: Run) -> float:
    begun = perf_counter()
    run()
    return perf_counter() - begun


def _row(task: Task, plant: Sufficient, peer: str, found: Sufficient | None, target: float | None) -> Row:
    what = f"{DURATION:g} s of {task.name}, {task.accuracy}"
    measured = f"{plant.seconds * 1e3:.2f} ms at {plant.setting}"
    goal = "stated" if target is None else f">= {target:g} x"
    if found is None:
        return Row(what, measured, f"{peer}: at no setting tried", "only the plant comes near", goal, True)
    factor = found.seconds / plant.seconds
    said = f"{factor:,.3g} x faster" if factor >= 1.0 else f"the peer is ahead, {1.0 / factor:.2f} x faster"
    against = f"{peer}: {found.seconds * 1e3:.2f} ms at {found.setting}"
    return Row(what, measured, against, said, goal, target is None or factor >= target)


def _voltages(task: Task) -> Array:
    return np.zeros(len(TIMES)) if task.voltages is None else task.voltages


def _plant(task: Task, step: float) -> Array:
    every = round(HOLD / step)
    plant = _at_rest(task.name, step)
    plant.reset()
    rows = plant.run(_steps(task, every), every)
    states = np.zeros((len(TIMES), 7))
    states[:, OBSERVED] = np.stack([rows.position, rows.pressure_a, rows.pressure_b], axis=1)
    return states


def _steps(task: Task, every: int) -> Array:
    """The voltage of each step, so many in each hold; of a sine, the one in the middle of the step."""
    if task.voltages is not None:
        return np.repeat(task.voltages, every)
    middles = HOLD / every * (np.arange(len(TIMES) * every) + 0.5)
    return np.asarray(task.rhs.amplitude * np.sin(2.0 * pi * task.rhs.frequency * middles))


@cache
def _at_rest(name: str, step: float) -> Plant:
    """The plant of a task and a step size; setting it up is not part of a run."""
    task = next(task for task in TASKS if task.name == name)
    return Plant(task.effects, step, task.position)


def _told(task: Task, smoothed: Mapping[str, float]) -> Array:
    return np.array(task.rhs._replace(**smoothed))


def _rk4_in_c(run: Callable[..., Array], task: Task, steps: int) -> Array:
    return run(_steps(task, steps), HOLD / steps, steps)


def _rk4(task: Task, smoothed: Mapping[str, float], steps: int) -> Array:
    return np.asarray(rk4(start(task.position), _voltages(task), HOLD, steps, _told(task, smoothed)))


def _cvode(task: Task, smoothed: Mapping[str, float], tolerance: float) -> Run:
    """CVODE set up; that is not part of a run."""
    solver = Cvode(tolerance, _told(task, smoothed))
    return partial(solver.run, start(task.position), _voltages(task), HOLD, task.voltages is not None)


def _scipy(integrate: Callable[..., Array], task: Task, smoothed: Mapping[str, float], tolerance: float) -> Array:
    """Start anew at each jump of the voltage, as LSODA's manual advises."""
    rhs, state = _told(task, smoothed), start(task.position)
    if task.voltages is None:
        return integrate(state, np.append(TIMES, DURATION), tolerance, rhs)[1:]
    rows, ends = [], np.array([0.0, HOLD])
    for voltage in task.voltages:
        rhs[0] = voltage
        state = integrate(state, ends, tolerance, rhs)[-1]
        rows.append(state)
    return np.array(rows)


def _odeint(state: Array, times: Array, tolerance: float, rhs: Array) -> Array:
    options: dict[str, Any] = {"rtol": tolerance, "atol": tolerance * SCALES, "mxstep": 100_000, "tfirst": True}
    return np.asarray(odeint(odeint_rate, state, times, args=(rhs,), **options))


def _solve_ivp(state: Array, times: Array, tolerance: float, rhs: Array) -> Array:
    options: dict[str, Any] = {"rtol": tolerance, "atol": tolerance * SCALES, "t_eval": times, "args": (rhs,)}
    return np.asarray(solve_ivp(odeint_rate, (0.0, times[-1]), state, method="LSODA", **options).y.T)
