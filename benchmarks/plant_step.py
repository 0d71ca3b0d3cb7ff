"""The plant's step against RK4 of the same equations in C, and against the wall clock."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from benchmarks.row import Row, skipped
from eha_core.plant import Plant

STEP = 1e-4
EVERY = 20  # rows at 500 Hz, as the simulator publishes
STEPS = 20_000  # a run shorter than a scheduler's time slice, so that some runs meet no other work
ROUNDS = 400
TICK, TICKS = 10, 200  # steps of a period at 1 kHz, and how many are timed at once
STEP_TARGET = 1.3
REAL_TIME_TARGET = 1000.0

Array = NDArray[np.float64]
_WHAT = "nominal step"
_TARGET = f"<= {STEP_TARGET:g} x C"


def measure() -> list[Row]:
    """Time the plant, and the C program where a compiler is there, in turns so that both meet the same machine.

    The shortest run of each counts: what else the machine does only ever adds time.
    """
    voltages = 8.4e-3 * np.sin(2.0 * np.pi * STEP * np.arange(STEPS))
    reference = compiled_reference()
    plant_times, reference_times = [], []
    plant = Plant(step_size=STEP)
    plant.run(voltages[:EVERY], EVERY)
    for _ in range(ROUNDS):
        plant.reset()
        plant_times.append(_seconds(lambda: plant.run(voltages, EVERY)))
        if reference is not None:
            reference_times.append(_seconds(lambda: reference(voltages)))
    return [_step_row(plant_times, reference_times), _real_time_row(plant_times), _tick_row(min(plant_times) / STEPS)]


def _seconds(action: Callable[[], object]) -> float:
    start = perf_counter()
    action()
    return perf_counter() - start


@cache
def compiled_reference() -> Callable[..., Array] | None:
    """Compile rk4.c and return its run over voltages, or None without a C compiler."""
    compiler = shutil.which("cc")
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "rk4.so"
        source = Path(__file__).with_name("rk4.c")
        options = ["-O3", "-march=native", "-std=c11", "-shared", "-fPIC"]
        subprocess.run([compiler, *options, source, "-o", library, "-lm"], check=True)
        simulate = ctypes.CDLL(str(library)).simulate
    vector = np.ctypeslib.ndpointer(dtype=np.float64, flags="C_CONTIGUOUS")
    simulate.argtypes = [vector, ctypes.c_long, ctypes.c_double, ctypes.c_long, vector]
    simulate.restype = None

    def run(voltages: Array, step: float = STEP, every: int = EVERY) -> Array:
        rows = np.empty((len(voltages) // every, 7))
        simulate(voltages, len(voltages), step, every, rows)
        return rows

    return run


def _step_row(plant_times: list[float], reference_times: list[float]) -> Row:
    if not reference_times:
        return skipped(_WHAT, _TARGET, "there is no C compiler (cc) on PATH")
    ratio = min(plant_times) / min(reference_times)
    return Row(
        _WHAT,
        f"{min(plant_times) / STEPS * 1e9:.1f} ns",
        f"RK4 in C, -O3 -march=native: {min(reference_times) / STEPS * 1e9:.1f} ns",
        f"{ratio:.2f} x",
        _TARGET,
        ratio <= STEP_TARGET,
    )


def _tick_row(step: float) -> Row:
    """What a tick of the simulator node costs, beside the steps that it takes."""
    plant = Plant(step_size=STEP)
    plant.advance(8.4e-3, TICK)

    def tick() -> None:
        for _ in range(TICKS):
            plant.advance(8.4e-3, TICK)

    taken = min(_seconds(tick) for _ in range(ROUNDS)) / TICKS
    return Row(
        f"a tick of {TICK} steps, by Plant.advance",
        f"{taken * 1e6:.2f} us",
        f"the same steps within a long run: {TICK * step * 1e6:.2f} us",
        f"{(taken - TICK * step) * 1e6:.2f} us more",
        "stated",
        True,
    )


def _real_time_row(plant_times: list[float]) -> Row:
    simulated = STEPS * STEP
    factor = simulated / min(plant_times)
    return Row(
        "simulated time on one core",
        f"{simulated:g} s in {min(plant_times) * 1e3:.2f} ms, rows at 500 Hz",
        "the wall clock",
        f"{factor:,.0f} x real time",
        f">= {REAL_TIME_TARGET:,.0f} x",
        factor >= REAL_TIME_TARGET,
    )
