"""Run the truth over a recording: what the states were, and what noise-free sensors said."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import EhaError
from eha_core.exam.truth.automaton import Automaton
from eha_core.exam.truth.control import PositionController
from eha_core.exam.truth.laws import (
    BRISTLE,
    POSITION,
    PRESSURE_A,
    PRESSURE_B,
    RETURN_RISE,
    SENSED_POSITION,
    STATES,
    SUPPLY_LOSS,
    VELOCITY,
    valve_flows,
)
from eha_core.exam.truth.record import Effect, schedule
from eha_core.exam.truth.valve import Valve

Array = NDArray[np.float64]
Voltage = Callable[[float], float] | Array | PositionController

COLUMNS = (
    "time",
    "voltage",
    "current",
    "spool",
    "position",
    "velocity",
    "pressure_a",
    "pressure_b",
    "flow_a",
    "flow_b",
    "supply_pressure",
    "return_pressure",
    "measured_position",
    "measured_pressure_a",
    "measured_pressure_b",
    "spool_rate",
    "spool_target",
    "sensed_position",
    "bristle_1",
    "bristle_2",
    "bristle_3",
    "bristle_4",
)


def simulate_truth(
    plant: Mapping[str, float],
    effects: Sequence[Effect],
    voltage: Voltage,
    duration: float,
    rate: float = 1000.0,
    *,
    initial_position: float = 0.0,
    windows: Mapping[str, tuple[float, float]] | None = None,
) -> dict[str, Array]:
    """Simulate a plant with effects and return its columns by name, SI, pressures gauge.

    Args:
        plant: values that differ from Table 1, under its names.
        effects: (id, parameters) pairs; see record.CATALOGUE and record.OUTSIDE, and record.LAWS for the key `law`.
        voltage: the command [V], held between samples: one value a sample, a function of time, or a controller.
        duration: length [s]; rate: samples a second.
        initial_position: where the piston rests at the start [m]; the pressures there balance each other.
        windows: time span [s] in which an effect acts, by its id; everywhere when absent.

    Returns:
        Arrays of duration * rate + 1 samples; sample k is at k / rate. flow_a is into chamber A, flow_b out of B.

    Raises:
        EhaError: an unknown parameter or effect, or a truth that cannot be integrated.
    """
    samples = round(duration * rate) + 1
    plan = schedule(plant, effects, windows or {})
    records = plan[0][1]
    record = records[0]
    command = _commands(voltage, samples, rate)
    valve = Valve(samples)
    delay = float(record["command_delay_delay"])
    if delay > 0.0:
        valve.command(0.0, delay, 0.0, records)
    automaton = Automaton(valve, records, _initial_state(record, initial_position))
    return _run(automaton, plan, command, rate, range(samples), initial_position)


def resume_truth(
    plant: Mapping[str, float],
    effects: Sequence[Effect],
    truth: Mapping[str, Array],
    first: int,
    last: int,
    *,
    windows: Mapping[str, tuple[float, float]] | None = None,
    shift: Mapping[str, float] | None = None,
) -> dict[str, Array]:
    """Simulate samples `first` to `last` again from the states of an earlier run, with other values or effects.

    The command is that of the run; `shift` adds to position, velocity, pressure_a or pressure_b at the start.
    """
    rate = 1.0 / (truth["time"][1] - truth["time"][0])
    start = first / rate
    plan = schedule(plant, effects, windows or {})
    records = [entry for change, entry in plan if change <= start][-1]
    record = records[0]
    row = {name: float(truth[name][first]) for name in COLUMNS}
    for name, step in (shift or {}).items():
        row[name] += step
    valve = Valve(last - first + 8)
    play = float(record["spool_hysteresis_half_width"])
    target = min(max(row["spool_target"], row["current"] - play), row["current"] + play)
    valve.start(row["current"], target, row["spool"], row["spool_rate"])
    delay = float(record["command_delay_delay"])
    for k in range(max(0, first - int(np.ceil(delay * rate)) - 1), first):
        begin, end = k / rate + delay, (k + 1) / rate + delay
        if end > start:
            valve.command(max(begin, start), end, float(truth["voltage"][k]), records)
    automaton = Automaton(valve, records, _resumed_state(record, row), start)
    return _run(automaton, plan, truth["voltage"], rate, range(first, last + 1), row["sensed_position"])


def _run(
    automaton: Automaton,
    plan: Sequence[tuple[float, NDArray[np.void]]],
    command: Array | PositionController,
    rate: float,
    samples: range,
    sensed: float,
) -> dict[str, Array]:
    integral = 0.0
    delay = float(automaton.record["command_delay_delay"])
    rows = np.empty((len(samples), len(COLUMNS)))
    for place, k in enumerate(samples):
        time = k / rate
        _advance(automaton, plan, time)
        record = automaton.record
        sensed = _sensed_position(automaton.state, record, sensed)
        measured = sensed * (1.0 + record["position_sensor_scale_ratio"])
        if isinstance(command, PositionController):
            volts, error = command.command(k, measured, integral)
            integral += error / rate
        else:
            volts = float(command[k])
        automaton.valve.command(time + delay, (k + 1) / rate + delay, volts, automaton.records)
        rows[place] = _row(automaton, time, volts, sensed, measured)
    return dict(zip(COLUMNS, rows.T.copy(), strict=True))


def _commands(voltage: Voltage, samples: int, rate: float) -> Array | PositionController:
    if isinstance(voltage, PositionController):
        given = len(voltage.reference)
    elif callable(voltage):
        return np.array([float(voltage(k / rate)) for k in range(samples)])
    else:
        given = len(voltage)
    if given < samples:
        raise EhaError(f"the command has {given} samples and the recording {samples}; give one value a sample")
    return voltage


def _initial_state(record: np.void, position: float) -> Array:
    """At rest, with pressures that balance on the piston and sum to the supply's."""
    state = np.zeros(STATES)
    state[POSITION] = state[SENSED_POSITION] = position
    share = record["piston_area_b"] / (record["piston_area"] + record["piston_area_b"])
    state[PRESSURE_A] = share * record["supply_pressure"]
    state[PRESSURE_B] = (1.0 - share) * record["supply_pressure"]
    return state


def _resumed_state(record: np.void, row: Mapping[str, float]) -> Array:
    """The states of a row; those of effects that the record does not have are at rest."""
    state = np.zeros(STATES)
    state[POSITION], state[VELOCITY] = row["position"], row["velocity"]
    state[PRESSURE_A], state[PRESSURE_B] = row["pressure_a"], row["pressure_b"]
    lags = record["position_sensor_lag_time_constant"] > 0.0
    state[SENSED_POSITION] = row["sensed_position"] if lags else row["position"]
    if record["supply_pressure_droop_resistance"] > 0.0:
        state[SUPPLY_LOSS] = record["supply_pressure"] - row["supply_pressure"]
    if record["return_back_pressure_resistance"] > 0.0:
        state[RETURN_RISE] = row["return_pressure"] - record["return_pressure"]
    if record["presliding_friction_stiffness"] > 0.0:
        state[BRISTLE:] = [row[f"bristle_{i}"] for i in (1, 2, 3, 4)]
    return state


def _advance(automaton: Automaton, plan: Sequence[tuple[float, NDArray[np.void]]], time: float) -> None:
    """Move to `time`, putting each record of the plan in force when its moment comes."""
    for change, records in plan[1:]:
        if automaton.time < change <= time:
            automaton.advance(change)
            automaton.change_record(records)
    if automaton.time < time:
        automaton.advance(time)


def _sensed_position(state: Array, record: np.void, previous: float) -> float:
    """What a lagging pick-off with play reports before its gain [m]."""
    seen = float(state[SENSED_POSITION] if record["position_sensor_lag_time_constant"] > 0.0 else state[POSITION])
    play = float(record["position_sensor_backlash_half_width"])
    return min(max(previous, seen - play), seen + play)


def _row(automaton: Automaton, time: float, voltage: float, sensed: float, measured: float) -> tuple[float, ...]:
    y, record = automaton.state, automaton.record
    current, target, spool, spool_rate = automaton.valve_state()
    supply = record["supply_pressure"] - y[SUPPLY_LOSS]
    back = record["return_pressure"] + y[RETURN_RISE]
    flow_a, flow_b, _, _ = valve_flows(spool, y[PRESSURE_A], y[PRESSURE_B], supply, back, record)
    return (
        time,
        voltage,
        current,
        spool,
        y[POSITION],
        y[VELOCITY],
        y[PRESSURE_A],
        y[PRESSURE_B],
        flow_a,
        flow_b,
        supply,
        back,
        measured,
        y[PRESSURE_A] + record["pressure_sensor_bias_bias_a"],
        y[PRESSURE_B] + record["pressure_sensor_bias_bias_b"],
        spool_rate,
        target,
        sensed,
        *y[BRISTLE:],
    )
