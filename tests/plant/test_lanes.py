"""Plants in lock-step are the plants that each of them is alone, to the last bit."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from eha_core.effects import Effect, effects
from eha_core.parameters import changed, nominal_values
from eha_core.plant import COLUMNS, Plant
from eha_core.plant.composite import compiled_step, write_lane_hooks
from eha_core.plant.lane_rows import LANES
from eha_core.plant.lockstep import LockStep
from eha_core.plant.packing import pack
from eha_core.plant.state import PISTON

STEP = 2e-4
STEPS = 1500
EVERY = [pytest.param(effect, id=effect.id) for effect in effects()]


def command(amplitude: float) -> np.ndarray:
    """Two sines, and jumps that wake what delays and sticks."""
    time = STEP * np.arange(STEPS)
    wave = np.sin(2 * np.pi * 5 * time) + 0.5 * np.sin(2 * np.pi * 23 * time)
    return amplitude * (wave + 0.3 * np.sign(np.sin(2 * np.pi * 11 * time)))


def together(sets: list[dict[str, float]], voltages: np.ndarray, every: int, columns: int) -> np.ndarray:
    """The sets' rows (sets, rows, columns), in lock-step from rest."""
    complete = [changed(nominal_values(), one) for one in sets]
    lanes = LockStep(complete, STEP)
    rows = np.full((len(voltages) // every, columns, lanes.lanes), np.nan)
    middle = [0.5 * (one["supply_pressure"] + one["return_pressure"]) for one in complete]
    lanes.place(np.array([[0.0, 0.0, pressure, pressure] for pressure in middle]))
    lanes.start_memory()
    lanes.advance(0, voltages[None], every, rows)
    return rows.transpose(2, 0, 1)[: len(sets)]


def alone(sets: list[dict[str, float]], voltages: np.ndarray, every: int) -> np.ndarray:
    """The sets' rows (sets, rows, COLUMNS), each by a plant of its own."""
    return np.array([Plant(one, STEP).run(voltages, every).values for one in sets])


def sizes(effect: Effect) -> list[dict[str, float]]:
    """The effect at its typical size and at others; a curve, which has none, rising over what it sees."""
    names = effect.parameter_names()
    if effect.named:
        typical = {name: row.typical for name, row in zip(names, effect.parameters, strict=True)}
    else:
        size = {"force": 20.0, "chamber": 1e-7, "orifice": 1e-6}[effect.site]
        typical = {name: size * (k - 12) for k, name in enumerate(name for name in names if ".knot_" in name)}
        typical |= {f"{effect.id}.lower": -0.02, f"{effect.id}.upper": 0.02}
    return [{name: factor * value for name, value in typical.items()} for factor in (1.0, 0.6, 1.3)]


@pytest.mark.parametrize("effect", EVERY)
def test_an_effect_acts_in_its_lanes_and_in_no_other(effect: Effect) -> None:
    sets = [{}, *sizes(effect), {"moving_mass": 30.0, "coulomb_friction.force": 250.0}]
    voltages = command(0.15)
    expected = alone(sets, voltages, 3)
    assert together(sets, voltages, 3, len(COLUMNS)).tobytes() == expected.tobytes()
    seen = np.ascontiguousarray(expected[:, :, -4:])
    assert together(sets, voltages, 3, 4).tobytes() == seen.tobytes()


def test_every_effect_over_a_few_steps() -> None:
    """The whole catalogue, some effects a lane, in few enough steps for the interpreter."""
    every = effects()
    sets = [{}]
    for first in range(0, len(every), 8):
        sets.append({name: value for one in every[first : first + 8] for name, value in sizes(one)[0].items()})
    voltages = np.where(np.arange(160) < 100, 8.0, -3.0)
    expected = alone(sets, voltages, 5)
    assert together(sets, voltages, 5, len(COLUMNS)).tobytes() == expected.tobytes()


@pytest.mark.parametrize("count", [1, 4, 5, LANES])
def test_any_number_of_sets(count: int) -> None:
    generator = np.random.default_rng(count)
    names = ("moving_mass", "bulk_modulus", "valve_gain", "valve_damping_ratio", "supply_pressure", "coil_resistance")
    nominal = nominal_values()
    sets = [{name: nominal[name] * generator.uniform(0.7, 1.4) for name in names} for _ in range(count)]
    voltages = command(8.0)  # saturates the coil and runs the piston into both ends
    expected = alone(sets, voltages, 1)
    assert np.max(expected[:, :, COLUMNS.index("position")]) == 0.1
    assert together(sets, voltages, 1, len(COLUMNS)).tobytes() == expected.tobytes()


def test_every_lane_has_a_span_of_its_own() -> None:
    friction = {"coulomb_friction.force": 300.0, "position_sensor_lag.time_constant": 0.02}
    spans = [(0.0, 1e9), (0.0503, 0.1201), (0.1, 0.2), (0.1201, 1e9)]
    sets = [{**friction, "effects_from": start, "effects_until": stop} for start, stop in spans]
    sets += [{**friction, "coulomb_friction.acts_from": start, "position_sensor_lag.acts_until": stop}
             for start, stop in spans]  # fmt: skip
    voltages = command(0.15)
    assert together(sets, voltages, 7, len(COLUMNS)).tobytes() == alone(sets, voltages, 7).tobytes()


def test_pistons_driven_by_pressures() -> None:
    sets = [{}, {"coulomb_friction.force": 200.0, "moving_mass": 20.0}, {"unequal_piston_area.ratio": 0.8},
            {"thermal_drift.damping_ratio": 0.5, "position_sensor_backlash.half_width": 1e-4}]  # fmt: skip
    complete = [changed(nominal_values(), one) for one in sets]
    pressures = np.array([1e7 + 4e7 * command(0.02), 1e7 - 4e7 * command(0.02)])
    start = [0.01, 0.0, 0.0, 0.0]
    lanes = LockStep(complete, STEP)
    rows = np.empty((STEPS // 2, 4, lanes.lanes))
    lanes.place(np.array([start] * len(sets)))
    lanes.start_memory()
    lanes.advance(0, pressures, 2, rows)
    memory_starts = [kind for effect in effects() for kind in effect.memory]
    for lane, values in enumerate(complete):
        vector, active, _ = pack(values, STEP)
        state = np.array([0.0, 0.0, 2.1e7, 0.0, 0.0, 0.0, 0.0, *start])
        memory = np.array([0.01 if kind == "position" else 0.0 for kind in memory_starts])
        expected = np.empty((STEPS // 2, 4))
        compiled_step().advance_driven(state, memory, vector, active, pressures[0], pressures[1], STEP, 2, expected)
        assert np.ascontiguousarray(rows[:, :, lane]).tobytes() == expected.tobytes()
        assert lanes.states()[lane].tobytes() == state[PISTON].tobytes()


def test_a_given_difference_of_pressures_accelerates_each_piston_to_its_own_speed() -> None:
    """m dv/dt = A (P1 - P2) - B v from rest: v = A (P1 - P2) / B (1 - exp(-B t / m))."""
    area, difference, steps = nominal_values()["piston_area"], 4e5, 100
    pairs = [(9.0, 2000.0), (18.0, 2000.0), (9.0, 500.0)]
    springless = {"spring_stiffness": 0.0}
    sets = [{**springless, "moving_mass": mass, "damping_coefficient": damping} for mass, damping in pairs]
    lanes = LockStep([changed(nominal_values(), one) for one in sets], STEP)
    lanes.place(np.tile([0.0, 0.0, 1e7, 1e7], (len(sets), 1)))
    lanes.start_memory()
    rows = np.full((steps // 10, 4, lanes.lanes), np.nan)
    pressures = np.full((2, steps), 1e7)
    pressures[0] += difference
    lanes.advance(0, pressures, 10, rows)
    time = 10.0 * STEP * np.arange(1, steps // 10 + 1)
    for lane, (mass, damping) in enumerate(pairs):
        rate, final = damping / mass, area * difference / damping
        speed = final * (1.0 - np.exp(-rate * time))
        position = final * time - speed / rate
        assert rows[:, 1, lane] == pytest.approx(speed, abs=2e-3 * final)
        assert rows[:, 0, lane] == pytest.approx(position, abs=2e-3 * final / rate)
        assert rows[:, 2, lane].tolist() == [1e7 + difference] * len(time)


def test_lane_hooks_call_every_effect_once() -> None:
    text = write_lane_hooks()
    for effect in effects():
        assert text.count(f"= {effect.id}(") == 1


INTERPRETED = """
import numpy as np
from tests.plant.test_lanes import command, together
sets = [{"constant_load.force": 300.0, "coulomb_friction.force": 300.0}, {}, {"spool_hysteresis.half_width": 1e-4}]
print(together(sets, command(0.15)[:200], 50, 22).tobytes().hex())
"""


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="there is no compiler to compare with")
def test_the_interpreter_finds_the_same_numbers() -> None:
    printed = [
        subprocess.run(
            [sys.executable, "-c", INTERPRETED], env=os.environ | {"NUMBA_DISABLE_JIT": switch}, text=True,
            capture_output=True, timeout=100, check=True, cwd=Path(__file__).parents[2],
        ).stdout
        for switch in ("0", "1")
    ]  # fmt: skip
    compiled, interpreted = (np.frombuffer(bytes.fromhex(text.strip())) for text in printed)
    assert interpreted == pytest.approx(compiled, rel=1e-12, abs=1e-15)


def test_blocks_begin_where_a_cache_line_does() -> None:
    blocks = [LockStep([nominal_values()], 1e-4)._block for _ in range(8)]
    assert [block.ctypes.data % 64 for block in blocks] == [0] * 8


@pytest.mark.parametrize("columns", [4, len(COLUMNS)])
def test_every_lane_follows_a_command_of_its_own(columns: int) -> None:
    """What a delay reads back is its own lane's command, and the row has the voltage as it was commanded."""
    sets = [{}, {"command_delay.delay": 0.0123}, {"command_delay.delay": 0.003, "coulomb_friction.force": 200.0},
            {"command_delay.delay": 0.01, "command_delay.acts_from": 0.1011}]  # fmt: skip
    period = 10
    held = np.repeat(np.array([[0.03], [0.05], [-0.04], [0.08]]) * command(1.0)[::period], period, axis=1)
    lanes = LockStep([changed(nominal_values(), one) for one in sets], STEP, own_commands=True)
    lanes.place(np.array([[0.0, 0.0, 1.05e7, 1.05e7]] * len(sets)))
    lanes.start_memory()
    rows = np.empty((STEPS // period, columns, lanes.lanes))
    for tick in range(STEPS // period):
        lanes.advance_each(tick * period, held[:, tick * period], period, rows[tick : tick + 1])
    for lane, (one, voltages) in enumerate(zip(sets, held, strict=True)):
        expected = Plant(one, STEP).run(voltages, period).values[:, -columns:]
        assert rows[:, :, lane].tobytes() == np.ascontiguousarray(expected).tobytes()
