"""Records simulated offline: the same states as the plant gives step by step, the same topics as the node's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from eha_core.api import known_model
from eha_core.cli import main
from eha_core.errors import ParameterError
from eha_core.plant import COLUMNS, Plant
from eha_core.recording import encode, read_recording, simulated
from eha_core.recording.message_rows import encode_rows
from eha_core.recording.simulated import Experiment, _driving, simulate, simulate_sweep, write_simulated

TIMES = np.arange(200) / 500.0
VOLTAGES = 0.05 * np.sin(2 * np.pi * 5.0 * TIMES)


def test_rows_are_the_bytes_of_single_messages() -> None:
    generator = np.random.default_rng(3)
    stamps = np.array([0, 1, 1_999_999_999, 1_700_000_000_123_456_789])
    columns = {name: generator.normal(size=4) for name in ("position", "velocity", "effort")}
    rows = encode_rows("sensor_msgs/msg/JointState", columns, stamps, name=["piston"])
    for k, stamp in enumerate(stamps.tolist()):
        fields = {
            "header": {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}},
            "name": ["piston"],
            **{name: [float(values[k])] for name, values in columns.items()},
        }
        assert rows[k] == encode("sensor_msgs/msg/JointState", fields)
    floats = np.array([1.5, -0.0, 1e-300])
    assert encode_rows("std_msgs/msg/Float64", {"data": floats}) == [
        encode("std_msgs/msg/Float64", {"data": float(value)}) for value in floats
    ]


def test_states_are_those_of_the_plant_stepped_by_hand() -> None:
    changes = [(0.1, "internal_leakage", 1e-10)]
    record = simulate(Experiment(TIMES, VOLTAGES, 0.4, {"moving_mass": 12.0}, changes))
    plant = Plant({"moving_mass": 12.0}, 1e-4)
    states = [plant.state]
    for k, voltage in enumerate(VOLTAGES):
        if k == 50:
            plant.set_parameters({"internal_leakage": 1e-10})
        plant.advance(float(voltage), 20)
        states.append(plant.state)
    np.testing.assert_array_equal(record.states, np.array(states))
    np.testing.assert_array_equal(record.stamps, np.arange(201) * 2_000_000)
    assert record.changes == [(100_000_000, "internal_leakage", 1e-10)]


def test_a_sweep_is_one_run_for_each_value() -> None:
    values = [1e-12, 2e-11, 5e-10]
    records = simulate_sweep(Experiment(TIMES, VOLTAGES, 0.4, {"moving_mass": 12.0}), "internal_leakage", values)
    for record, value in zip(records, values, strict=True):
        alone = simulate(Experiment(TIMES, VOLTAGES, 0.4, {"moving_mass": 12.0, "internal_leakage": value}))
        np.testing.assert_allclose(record.states, alone.states, rtol=1e-9, atol=1e-15)
        assert record.parameters == alone.parameters


def test_a_sweep_refuses_changes_on_its_way() -> None:
    with pytest.raises(ParameterError, match="a sweep changes nothing on its way"):
        simulate_sweep(Experiment(TIMES, VOLTAGES, 0.4, {}, [(0.1, "internal_leakage", 1e-10)]), "moving_mass", [9.0])


def test_a_command_holds_from_its_instant_even_between_periods() -> None:
    record = simulate(Experiment(np.array([0.0031, 0.0055]), np.array([0.1, -0.1]), 0.01))
    plant = Plant({}, 1e-4)
    states = [plant.state]
    for step in range(100):
        plant.advance(0.0 if step < 31 else 0.1 if step < 55 else -0.1, 1)
        if step % 20 == 19:
            states.append(plant.state)
    np.testing.assert_array_equal(record.states, np.array(states))
    assert record.commands[0].tolist() == [3_100_000, 5_500_000]


def test_the_file_has_the_nodes_topics_and_reads_back(tmp_path: Path) -> None:
    record = simulate(Experiment(TIMES, VOLTAGES, 0.4, {}, [(0.2, "internal_leakage", 1e-9)]))
    path = tmp_path / "run.mcap"
    write_simulated(path, record)
    with AnyReader([path]) as reader:
        assert {connection.topic: connection.msgcount for connection in reader.connections} == {
            "/voltage_command": 200, "/joint_states": 201, "/chamber_a/pressure": 201, "/chamber_b/pressure": 201,
            "/state": 201, "/internal_leakage": 2, "/parameter_events": 1,
        }  # fmt: skip
        log_times = [log_time for _, log_time, _ in reader.messages()]
        (state,) = [connection for connection in reader.connections if connection.topic == "/state"]
        last = [reader.deserialize(data, state.msgtype) for _, _, data in reader.messages([state])][-1]
    assert log_times == sorted(log_times)
    np.testing.assert_array_equal([getattr(last, name) for name in COLUMNS], record.states[-1])
    recording = read_recording(path)
    for channel, column in (("position", "measured_position"), ("velocity", "measured_velocity")):
        np.testing.assert_array_equal(recording.channels[channel].values, record.column(column))
    pressure = recording.channels["pressure_b"].values
    np.testing.assert_allclose(pressure, record.column("measured_pressure_b"), rtol=0, atol=1e-8)
    np.testing.assert_array_equal(recording.channels["voltage_command"].values, VOLTAGES)
    assert recording.leakage_changes == ((0.0, 1e-12), (0.2, 1e-9))
    assert recording.parameters == record.parameters


def test_a_changed_parameter_is_an_event_as_ros2_has_it(tmp_path: Path) -> None:
    """rcl_interfaces/msg/ParameterType: a double is 3."""
    record = simulate(Experiment(TIMES, VOLTAGES, 0.4, {}, [(0.2, "moving_mass", 12.0)]))
    path = tmp_path / "run.mcap"
    write_simulated(path, record)
    with AnyReader([path]) as reader:
        (topic,) = [one for one in reader.connections if one.topic == "/parameter_events"]
        ((_, logged, data),) = reader.messages([topic])
        event = reader.deserialize(data, topic.msgtype)
    (changed,) = event.changed_parameters
    assert (changed.name, changed.value.type, changed.value.double_value) == ("moving_mass", 3, 12.0)
    assert event.stamp.sec * 10**9 + event.stamp.nanosec == logged == record.stamps[0] + 200_000_000


def test_messages_of_one_instant_come_in_one_order(tmp_path: Path) -> None:
    """What was set, then what the rig gives, then the command that holds from there on."""
    record = simulate(Experiment(TIMES, VOLTAGES, 0.4, {}, [(0.2, "internal_leakage", 1e-9)]))
    path = tmp_path / "run.mcap"
    write_simulated(path, record)
    with path.open("rb") as file:
        read = [
            (message.log_time, channel.topic)
            for _, channel, message in make_reader(file).iter_messages(log_time_order=False)
        ]
    always = ["/chamber_a/pressure", "/chamber_b/pressure", "/state", "/joint_states", "/voltage_command"]
    assert [topic for time, topic in read if time == 2_000_000] == always
    assert [topic for time, topic in read if time == 0] == ["/internal_leakage", *always]
    assert [topic for time, topic in read if time == 200_000_000] == [
        "/parameter_events", "/internal_leakage", *always
    ]  # fmt: skip


@pytest.mark.parametrize("period", [1, 2, 100])
def test_the_leakage_is_told_from_the_start_and_from_where_it_was_set(tmp_path: Path, period: int) -> None:
    """Also where it is set at the first instant after the start, and again at the next."""
    changes = [(period / 500.0, "internal_leakage", 1e-9), ((period + 1) / 500.0, "internal_leakage", 2e-9)]
    record = simulate(Experiment(TIMES, VOLTAGES, 0.4, {"internal_leakage": 5e-12}, changes))
    path = tmp_path / "run.mcap"
    write_simulated(path, record)
    changes = read_recording(path).leakage_changes
    assert changes == ((0.0, 5e-12), (period / 500.0, 1e-9), ((period + 1) / 500.0, 2e-9))


def test_a_change_counts_from_the_first_instant_of_publishing_that_has_come() -> None:
    """At 500 Hz: 3.9 ms is noted at 4 ms, 4 ms at 4 ms; at the record's end and beyond nothing changes."""
    changes = [(0.004, "damping_coefficient", 9.0), (0.0039, "moving_mass", 12.0), (0.02, "damping_coefficient", 1.0)]
    record = simulate(Experiment(TIMES, VOLTAGES, 0.02, {}, [*changes, (1.0, "moving_mass", 1.0)]))
    assert record.changes == [(4_000_000, "moving_mass", 12.0), (4_000_000, "damping_coefficient", 9.0)]
    plant = Plant({}, 1e-4)
    states = [plant.state]
    for k in range(10):
        if k == 2:
            plant.set_parameters({"moving_mass": 12.0, "damping_coefficient": 9.0})
        plant.advance(float(VOLTAGES[k]), 20)
        states.append(plant.state)
    np.testing.assert_array_equal(record.states, np.array(states))


def test_commands_after_the_end_are_not_told() -> None:
    record = simulate(Experiment(np.array([0.0, 0.0199, 0.02, 0.05]), np.arange(1.0, 5.0) * 1e-2, 0.02))
    assert record.commands[0].tolist() == [0, 19_900_000]
    assert record.commands[1].tolist() == [1e-2, 2e-2]


def test_measured_inputs_are_those_of_mid_step_and_a_command_holds() -> None:
    times = np.array([0.0, 0.01])
    inputs = {
        "flow_a": (times, np.array([0.0, 1e-4])),
        "voltage_command": (np.array([0.002, 0.005, 0.03]), np.array([1.0, 2.0, 3.0])),
    }
    driving = _driving(Experiment(np.empty(0), np.empty(0), 0.01, step_size=1e-3, inputs=inputs))
    np.testing.assert_allclose(driving[:, 0], (np.arange(10) + 0.5) * 1e-5, rtol=1e-12)
    assert driving[:, 1].tolist() == [0.0] * 2 + [1.0] * 3 + [2.0] * 5


@pytest.mark.parametrize(("rate", "steps"), [(500.0, 20), (10_000.0, 1), (400.0, 25)])
def test_a_period_is_a_whole_number_of_steps(rate: float, steps: int) -> None:
    experiment = Experiment(TIMES, VOLTAGES, 0.4, rate=rate)
    assert (experiment.steps_per_period, experiment.periods) == (steps, round(0.4 * rate))
    assert simulate(Experiment(TIMES, VOLTAGES, 3 / rate, rate=rate)).stamps.tolist() == [
        round(k * 1e9 / rate) for k in range(4)
    ]


@pytest.mark.parametrize("rate", [20_001.0, 30_000.0, 15_000.0])
def test_a_rate_above_the_steps_is_refused(rate: float) -> None:
    with pytest.raises(ParameterError, match="choose a whole number"):
        simulate(Experiment(TIMES, VOLTAGES, 0.4, rate=rate))


def test_more_messages_than_are_serialised_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    record = simulate(Experiment(TIMES, VOLTAGES, 0.04))
    write_simulated(tmp_path / "whole.mcap", record)
    monkeypatch.setattr(simulated, "_BLOCK", 7)
    write_simulated(tmp_path / "parts.mcap", record)
    assert (tmp_path / "whole.mcap").read_bytes() == (tmp_path / "parts.mcap").read_bytes()


def test_instruments_tell_nothing_of_the_model(tmp_path: Path) -> None:
    path = tmp_path / "rig.mcap"
    write_simulated(path, simulate(Experiment(TIMES, VOLTAGES, 0.4)), instruments_only=True)
    recording = read_recording(path)
    assert list(recording.channels) == ["voltage_command", "pressure_a", "pressure_b", "position", "velocity"]
    assert (recording.parameters, recording.leakage_changes) == ({}, ())
    with AnyReader([path]) as reader:
        assert "/state" not in reader.topics and "/internal_leakage" not in reader.topics


def test_noise_has_its_size_and_its_seed() -> None:
    times = np.arange(10_000) / 500.0
    quiet = simulate(Experiment(times, 0 * times, 20.0))
    noisy = simulate(Experiment(times, 0 * times, 20.0, noise=3.0, seed=5))
    again = simulate(Experiment(times, 0 * times, 20.0, noise=3.0, seed=5))
    other = simulate(Experiment(times, 0 * times, 20.0, noise=3.0, seed=6))
    np.testing.assert_array_equal(noisy.states, again.states)
    assert not np.array_equal(noisy.states, other.states)
    for name, size in (("measured_position", 3e-5), ("measured_pressure_a", 3e4), ("measured_velocity", 3e-3)):
        assert np.std(noisy.column(name) - quiet.column(name)) == pytest.approx(size, rel=0.03)
    np.testing.assert_array_equal(noisy.column("position"), quiet.column("position"))


def test_a_rate_that_splits_steps_is_refused() -> None:
    with pytest.raises(ParameterError, match="rate 300 Hz: its period is 33.3333 steps of 0.0001 s"):
        simulate(Experiment(TIMES, VOLTAGES, 0.4, rate=300.0))


def test_the_parts_that_were_recorded_are_those_that_are_diagnosed(tmp_path: Path) -> None:
    """A single rod's recording carries its parts and both areas, and its default model is that cylinder."""
    parts = tmp_path / "rod.yaml"
    parts.write_text("/**/eha_sim:\n  ros__parameters:\n    plant: {cylinder: single_rod}\n    piston_area: 1.2e-3\n")
    out = tmp_path / "rod.mcap"
    words = ["--command", "sine:amplitude=0.01,frequency=1", "--duration", "1", "--nominal", str(parts)]
    assert main(["simulate", *words, "--out", str(out)]) == 0
    recording = read_recording(out)
    assert recording.parts == {"source": "servo_valve", "cylinder": "single_rod", "load": "sprung_mass"}
    model = known_model(None, recording)
    assert model.composition.names == recording.parts
    assert (model.values["piston_area"], model.values["piston_area_b"]) == (1.2e-3, 430e-6)
    assert known_model({"moving_mass": 20.0}, recording).composition == model.composition
    named = known_model({"plant": {"source": "measured_flow"}, "moving_mass": 20.0}, recording)
    assert named.composition.names["source"] == "measured_flow"
    with pytest.raises(ParameterError, match="plant = 'pump' names no parts; write for example"):
        known_model({"plant": "pump"}, recording)
