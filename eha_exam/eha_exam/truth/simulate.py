"""Run the truth over a recording: what the states were, and what noise-free sensors said."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from eha_exam.errors import ExamError
from eha_exam.truth.automaton import Automaton
from eha_exam.truth.control import PositionController
from eha_exam.truth.laws import (
    BRISTLE,
    POSITION,
    PRESSURE_A,
    PRESSURE_B,
    RETURN_RISE,
    SENSED_POSITION,
    SENSED_PRESSURE,
    STATES,
    SUPPLY_LOSS,
    VELOCITY,
    valve_flows,
)
from eha_exam.truth.record import Effect, schedule
from eha_exam.truth.valve import Valve

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
    "pump_speed",
    "sensed_pressure_a",
    "following_pressure_a",
    "sensed_pressure_b",
    "following_pressure_b",
)
CHAMBERS = (("a", PRESSURE_A, SENSED_PRESSURE), ("b", PRESSURE_B, SENSED_PRESSURE + 2))


def simulate_truth(
    plant: Mapping[str, float],
    effects: Sequence[Effect],
    voltage: Voltage,
    duration: float,
    rate: float = 1000.0,
    *,
    initial_position: float = 0.0,
    windows: Mapping[str, tuple[float, float]] | None = None,
    pump_speed: Array | None = None,
) -> dict[str, Array]:
    """Simulate a plant with effects and return its columns by name, SI, pressures gauge.

    Args:
        plant: values that differ from Table 1, under its names.
        effects: (id, parameters) pairs; see record.CATALOGUE and record.OUTSIDE, and record.LAWS for the key `law`.
        voltage: the command [V], held between samples: one value a sample, a function of time, or a controller.
        duration: length [s]; rate: samples a second.
        initial_position: where the piston rests at the start [m]; the pressures there balance each other.
        windows: time span [s] in which an effect acts, by its id; everywhere when absent.
        pump_speed: [rad/s], one value a sample, held, of a plant with a pump_displacement; see record.PUMP.

    Returns:
        Arrays of duration * rate + 1 samples; sample k is at k / rate. flow_a is into chamber A, flow_b out of B.

    Raises:
        ExamError: an unknown parameter or effect, or a truth that cannot be integrated.
    """
    samples = round(duration * rate) + 1
    command = _commands(voltage, samples, rate)
    stepped = SteppedTruth(plant, effects, rate, samples, initial_position=initial_position, windows=windows)
    return _run(stepped, command, samples, pump_speed)


class SteppedTruth:
    """The truth one sample at a time, for a rig whose command comes while it runs.

    Each sample is `sense`d first; then `hold` puts the voltage on until the next one. Arguments as `simulate_truth`;
    `samples` is about how many there will be.
    """

    def __init__(
        self,
        plant: Mapping[str, float],
        effects: Sequence[Effect],
        rate: float,
        samples: int = 10_000,
        *,
        initial_position: float = 0.0,
        windows: Mapping[str, tuple[float, float]] | None = None,
    ) -> None:
        plan = schedule(plant, effects, windows or {})
        records = plan[0][1]
        valve = Valve(samples)
        delay = float(records[0]["command_delay_delay"])
        if delay > 0.0:
            valve.command(0.0, delay, 0.0, records)
        state = _initial_state(records[0], initial_position)
        if _any_lags(plan):
            state = np.append(state, np.repeat(state[[PRESSURE_A, PRESSURE_B]], 2))
        automaton = Automaton(valve, records, state)
        self._begin(automaton, plan, rate, 0, initial_position)

    @classmethod
    def resumed(
        cls,
        automaton: Automaton,
        plan: Sequence[tuple[float, NDArray[np.void]]],
        rate: float,
        first: int,
        sensed: float,
    ) -> SteppedTruth:
        """Go on from sample `first` of an earlier run."""
        made = cls.__new__(cls)
        made._begin(automaton, plan, rate, first, sensed)
        return made

    def _begin(
        self,
        automaton: Automaton,
        plan: Sequence[tuple[float, NDArray[np.void]]],
        rate: float,
        first: int,
        sensed: float,
    ) -> None:
        self.rate = rate
        self._automaton, self._plan, self._sample, self._sensed = automaton, plan, first, sensed
        self._delay = float(automaton.record["command_delay_delay"])

    def sense(self) -> tuple[float, float, float, float]:
        """Measured position [m], velocity [m/s] and pressures [Pa, gauge] of this sample, without noise."""
        _advance(self._automaton, self._plan, self._sample / self.rate)
        record, state = self._automaton.record, self._automaton.state
        self._sensed = _sensed_position(state, record, self._sensed)
        position = _read_position(self._sensed, record)
        pressure_a, pressure_b = (_read_pressure(state, record, *chamber) for chamber in CHAMBERS)
        return float(position), float(state[VELOCITY]), pressure_a, pressure_b

    def hold(self, voltage: float, pump_speed: float = 0.0) -> tuple[float, ...]:
        """Hold a voltage [V], and the pump's speed [rad/s], until the next sample; returns the row of this one, in the
        order of COLUMNS."""
        automaton, time = self._automaton, self._sample / self.rate
        if pump_speed != automaton.record["pump_speed"]:
            for _, records in self._plan:
                records["pump_speed"] = pump_speed
            automaton.change_record(automaton.records)
        until = (self._sample + 1) / self.rate
        automaton.valve.command(time + self._delay, until + self._delay, voltage, automaton.records)
        self._sample += 1
        measured = _read_position(self._sensed, automaton.record)
        return _row(automaton, time, voltage, self._sensed, measured)


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
        if name == "position":
            row["sensed_position"] += step  # what trails the piston goes with it
    valve = Valve(last - first + 8)
    play = float(record["spool_hysteresis_half_width"])
    target = min(max(row["spool_target"], row["current"] - play), row["current"] + play)
    valve.start(row["current"], target, row["spool"], row["spool_rate"])
    delay = float(record["command_delay_delay"])
    for k in range(max(0, first - int(np.ceil(delay * rate)) - 1), first):
        begin, end = k / rate + delay, (k + 1) / rate + delay
        if end > start:
            valve.command(max(begin, start), end, float(truth["voltage"][k]), records)
    state = _resumed_state(record, row)
    if _any_lags(plan):
        state = np.append(state, [row[name] for name in COLUMNS[-4:]])
    automaton = Automaton(valve, records, state, start)
    resumed = SteppedTruth.resumed(automaton, plan, rate, first, row["sensed_position"])
    return _run(resumed, truth["voltage"][first:], last + 1 - first, truth["pump_speed"][first:])


def _run(
    stepped: SteppedTruth, command: Array | PositionController, samples: int, pump_speed: Array | None
) -> dict[str, Array]:
    integral = 0.0
    rows = np.empty((samples, len(COLUMNS)))
    for k in range(samples):
        measured = stepped.sense()[0]
        if isinstance(command, PositionController):
            volts, error = command.command(k, measured, integral)
            integral += error / stepped.rate
        else:
            volts = float(command[k])
        rows[k] = stepped.hold(volts, 0.0 if pump_speed is None else float(pump_speed[k]))
    return dict(zip(COLUMNS, rows.T.copy(), strict=True))


def _commands(voltage: Voltage, samples: int, rate: float) -> Array | PositionController:
    if isinstance(voltage, PositionController):
        given = len(voltage.reference)
    elif callable(voltage):
        return np.array([float(voltage(k / rate)) for k in range(samples)])
    else:
        given = len(voltage)
    if given < samples:
        raise ExamError(f"the command has {given} samples and the recording {samples}; give one value a sample")
    return voltage


def _initial_state(record: np.void, position: float) -> Array:
    """At rest, with pressures that balance on the piston and sum to the supply's; under a pump all are the tank's."""
    state = np.zeros(STATES)
    state[POSITION] = state[SENSED_POSITION] = position
    share = record["piston_area_b"] / (record["piston_area"] + record["piston_area_b"])
    pumped = record["pump_displacement"] > 0.0
    total = 2.0 * record["return_pressure"] if pumped else record["supply_pressure"]
    state[PRESSURE_A] = share * total
    state[PRESSURE_B] = (1.0 - share) * total
    state[SUPPLY_LOSS] = record["supply_pressure"] - record["return_pressure"] if pumped else 0.0
    return state


def _resumed_state(record: np.void, row: Mapping[str, float]) -> Array:
    """The states of a row; those of effects that the record does not have are at rest."""
    state = np.zeros(STATES)
    state[POSITION], state[VELOCITY] = row["position"], row["velocity"]
    state[PRESSURE_A], state[PRESSURE_B] = row["pressure_a"], row["pressure_b"]
    lags = record["position_sensor_lag_time_constant"] > 0.0
    state[SENSED_POSITION] = row["sensed_position"] if lags else row["position"]
    if record["supply_pressure_droop_resistance"] > 0.0 or record["pump_displacement"] > 0.0:
        state[SUPPLY_LOSS] = record["supply_pressure"] - row["supply_pressure"]
    if record["return_back_pressure_resistance"] > 0.0:
        state[RETURN_RISE] = row["return_pressure"] - record["return_pressure"]
    if record["presliding_friction_stiffness"] > 0.0:
        state[BRISTLE:STATES] = [row[f"bristle_{i}"] for i in (1, 2, 3, 4)]
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


def _read_position(sensed: float, record: np.void) -> float:
    """What a position sensor shows of a pick-off's position [m]: its gain, and where its zero lies."""
    return float(sensed * (1.0 + record["position_sensor_scale_ratio"]) + record["position_sensor_offset_offset"])


def _any_lags(plan: Sequence[tuple[float, NDArray[np.void]]]) -> bool:
    """Whether a pressure sensor lags at any time, so that the truth needs states for them."""
    constants = ("pressure_sensor_lag_time_constant_a", "pressure_sensor_lag_time_constant_b")
    return any(records[0][name] > 0.0 for _, records in plan for name in constants)


def _read_pressure(state: Array, record: np.void, chamber: str, place: int, sensed: int) -> float:
    """What a chamber's sensor shows [Pa]: its lag, its gain, then its zero."""
    pressure = state[place]
    if record[f"pressure_sensor_lag_time_constant_{chamber}"] > 0.0:
        pressure = state[sensed + int(record["pressure_sensor_lag_law"])]
    gain = 1.0 + record[f"pressure_sensor_scale_ratio_{chamber}"]
    return float(gain * pressure + record[f"pressure_sensor_bias_bias_{chamber}"])


def _sensed_pressures(y: Array, record: np.void) -> Array:
    """Both stages of both pressure sensors [Pa]: the pressures themselves where a sensor does not lag."""
    stages = np.repeat(y[[PRESSURE_A, PRESSURE_B]], 2)
    for chamber, _, sensed in CHAMBERS:
        if record[f"pressure_sensor_lag_time_constant_{chamber}"] > 0.0:
            stages[sensed - SENSED_PRESSURE : sensed - SENSED_PRESSURE + 2] = y[sensed : sensed + 2]
    return np.asarray(stages)


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
        *(_read_pressure(y, record, *chamber) for chamber in CHAMBERS),
        spool_rate,
        target,
        sensed,
        *y[BRISTLE:STATES],
        record["pump_speed"],
        *_sensed_pressures(y, record),
    )
