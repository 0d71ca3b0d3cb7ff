"""`eha simulate` as a user runs it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from eha_core.cli import main
from eha_core.cli.simulate import COMMAND_LIMIT
from eha_core.recording import read_recording

SINE = "sine:amplitude=8.4e-3,frequency=1"


def simulate(out: Path, command: str, *words: str) -> int:
    return main(["simulate", "--command", command, "--out", str(out), *words])


def test_a_signal_is_simulated_and_recorded(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert simulate(tmp_path / "run.mcap", SINE, "--duration", "2", "--rate", "1000") == 0
    assert "2 s in 10005 messages" in capsys.readouterr().out
    recording = read_recording(tmp_path / "run.mcap")
    assert recording.duration == pytest.approx(2.0)
    voltage = recording.channels["voltage_command"]
    np.testing.assert_allclose(voltage.values, 8.4e-3 * np.sin(2 * np.pi * voltage.time), rtol=0, atol=1e-15)
    # About 1.2 m/s per volt: the sine's displacement has the amplitude gain * 8.4 mV / (2 pi), half its range.
    assert np.ptp(recording.channels["position"].values) / 2 == pytest.approx(1.6e-3, rel=0.1)


def test_a_recording_replays_to_the_same_motion(tmp_path: Path) -> None:
    first, second = tmp_path / "first.mcap", tmp_path / "second.mcap"
    simulate(first, "prbs:amplitude=0.02,dwell=0.05", "--duration", "3")
    simulate(second, str(first))
    one, two = read_recording(first), read_recording(second)
    count = len(two.channels["position"].values)
    assert count >= 1500
    for name in ("position", "pressure_a", "voltage_command"):
        values = one.channels[name].values[: len(two.channels[name].values)]
        np.testing.assert_array_equal(two.channels[name].values, values)


def test_a_csv_file_commands(tmp_path: Path) -> None:
    csv_file = tmp_path / "volts.csv"
    csv_file.write_text("time,voltage_command\n0,0.0\n0.5,0.02\n1.0,0.0\n")
    assert simulate(tmp_path / "run.mcap", str(csv_file), "--duration", "1.5") == 0
    position = read_recording(tmp_path / "run.mcap").channels["position"]
    assert position.values[position.time < 0.5].max() < 1e-6
    assert position.values[-1] > 5e-3


def test_parameters_come_from_file_words_and_instants(tmp_path: Path) -> None:
    nominal = tmp_path / "rig.yaml"
    nominal.write_text("eha_sim:\n  ros__parameters:\n    moving_mass: 20.0\n    coulomb_friction.force: 100.0\n")
    words = ("--nominal", str(nominal), "--set", "moving_mass=30", "--set", "internal_leakage=1e-10@0.5")
    simulate(tmp_path / "run.mcap", SINE, "--duration", "1", *words)
    recording = read_recording(tmp_path / "run.mcap")
    stored = {
        name: recording.parameters[name] for name in ("moving_mass", "coulomb_friction.force", "internal_leakage")
    }
    assert stored == {"moving_mass": 30.0, "coulomb_friction.force": 100.0, "internal_leakage": 1e-12}
    assert [value for _, value in recording.leakage_changes] == [1e-12, 1e-10]


def test_the_same_words_give_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a.mcap", "b.mcap"):
        simulate(tmp_path / name, SINE, "--duration", "1", "--noise", "1", "--seed", "4")
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--command", "sinus:amplitude=1"], "neither a file nor a signal; did you mean sine?"),
        (["--command", "sine:height=1"], "signal sine has no parameter 'height'; it has amplitude"),
        (["--command", "sine:amplitud=1"], "signal sine has no parameter 'amplitud'; did you mean amplitude?"),
        (["--command", "absent.mcap"], "--command absent.mcap: neither a file nor a signal; choose chirp"),
        (["--command", SINE, "--set", "moving_mas=1"], "no parameter named moving_mas; did you mean moving_mass?"),
        (["--command", SINE, "--set", "moving_mass=nan"], "moving_mass = nan is not finite"),
        (["--command", SINE, "--set", "moving_mass"], "--set 'moving_mass' is not NAME=VALUE"),
        (["--command", SINE, "--set", "moving_mass=1@soon"], "--set 'moving_mass=1@soon' is not NAME=VALUE"),
        (["--command", SINE, "--set", "moving_mass=-1@3"], "moving_mass = -1 kg is out of range"),
        (["--command", SINE, "--rate", "333"], "rate 333 Hz: its period is"),
        (["--command", SINE, "--rate", "nan"], "--rate nan is out of range"),
        (["--command", SINE, "--step", "1"], "step_size = 1 s is out of range"),
        (["--command", SINE, "--duration", "-1"], "--duration -1 is out of range"),
        (["--command", SINE, "--nominal", "absent.yaml"], "absent.yaml: cannot be read"),
        (["--command", SINE, "--initial-position", "5"], "initial_position = 5 m is outside the stroke"),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], message: str
) -> None:
    assert main(["simulate", "--out", str(tmp_path / "run.mcap"), *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith("eha simulate: ") and message in error and error.count("\n") == 1
    assert not (tmp_path / "run.mcap").exists()


def test_a_recording_without_a_command_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "motion.csv").write_text("time,position\n0,0\n1,0\n")
    assert simulate(tmp_path / "run.mcap", str(tmp_path / "motion.csv")) == 2
    assert "no voltage_command was recorded" in capsys.readouterr().err


def test_a_table_reads_back_as_the_recording(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for ending in ("mcap", "csv"):
        assert simulate(tmp_path / f"run.{ending}", SINE, "--duration", "1", "--noise", "1") == 0
    assert "1 s in 501 rows" in capsys.readouterr().out
    bag, table = (read_recording(tmp_path / f"run.{ending}").channels for ending in ("mcap", "csv"))
    for name in ("position", "velocity", "pressure_a", "pressure_b"):
        np.testing.assert_allclose(table[name].values, bag[name].values, rtol=1e-9, atol=1e-4)
    assert {"spool", "flow_a"} <= set(table)
    words = ("--duration", "0.1", "--instruments-only")
    assert simulate(tmp_path / "rig.csv", SINE, *words) == 0
    header = (tmp_path / "rig.csv").read_text().partition("\n")[0]
    assert set(header.split(",")) == {"time", "voltage_command", "position", "velocity", "pressure_a", "pressure_b"}
    assert simulate(tmp_path / "run.csv", SINE, "--duration", "0.1") == 2
    assert "exists already" in capsys.readouterr().err


def test_a_command_that_the_node_would_clamp_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert simulate(tmp_path / "run.mcap", "sine:amplitude=12,frequency=5", "--duration", "0.2") == 0
    assert "reaches 12 V; the simulator node would clamp it" in capsys.readouterr().err
    source = (Path(__file__).parents[2] / "eha_sim_node" / "eha_sim_node" / "sim.py").read_text()
    assert f'Row("command_limit", {COMMAND_LIMIT},' in source
    assert simulate(tmp_path / "mild.mcap", SINE, "--duration", "0.2") == 0
    assert capsys.readouterr().err == ""


def test_another_ending_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert simulate(tmp_path / "run.bag", SINE, "--duration", "0.1") == 2
    assert "run.bag: a recording is written as .mcap or .csv" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_an_existing_file_is_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "run.mcap").write_text("mine")
    assert simulate(tmp_path / "run.mcap", SINE, "--duration", "0.1") == 2
    assert "exists already" in capsys.readouterr().err
    assert (tmp_path / "run.mcap").read_text() == "mine"


def test_arguments_that_do_not_parse_take_one_line() -> None:
    for words in (["simulate"], ["stimulate"], [], ["simulate", "--command", SINE, "--out", "x", "--rate", "fast"]):
        result = subprocess.run(
            [sys.executable, "-m", "eha_core.cli", *words], capture_output=True, text=True, timeout=60
        )
        assert result.returncode == 2
        assert result.stderr.startswith("eha") and result.stderr.count("\n") == 1, result.stderr


def test_a_sweep_is_the_simulations_one_by_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--duration", "1", "--noise", "1", "--set", "coulomb_friction.force=100")
    assert simulate(tmp_path / "rig.mcap", SINE, *words, "--sweep", "internal_leakage=1e-12:1e-10:3log") == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[1:4]] == ["1e-12", "1e-11", "1e-10"]
    for number, value in enumerate((1e-12, 1e-11, 1e-10), start=1):
        alone = tmp_path / f"alone-{number}.mcap"
        assert simulate(alone, SINE, *words, "--set", f"internal_leakage={value!r}") == 0
        one, other = (read_recording(path) for path in (alone, tmp_path / f"rig-{number}.mcap"))
        assert one.parameters == other.parameters
        for name, channel in one.channels.items():
            np.testing.assert_array_equal(channel.values, other.channels[name].values)


@pytest.mark.parametrize(
    ("sweep", "said"),
    [
        ("moving_mass=1:2", "NAME=A:B:N"),
        ("moving_mass=0:2:3log", "of one sign"),
        ("moving_mass=1:2:100000", "N from 2 to 1000"),
        ("mass=1:2:3", "no parameter named mass"),
        ("moving_mass=1:9e9:3", "moving_mass = 4.5e+09 kg is out of range"),
    ],
)
def test_a_sweep_that_makes_no_plants_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], sweep: str, said: str
) -> None:
    assert simulate(tmp_path / "rig.mcap", SINE, "--sweep", sweep) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert said in message
    assert not list(tmp_path.iterdir())


def test_a_sweep_overwrites_nothing_and_changes_nothing_on_its_way(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "rig-2.mcap").write_text("mine")
    assert simulate(tmp_path / "rig.mcap", SINE, "--sweep", "moving_mass=5:9:2") == 2
    assert "rig-2.mcap: the file exists already" in capsys.readouterr().err
    assert (tmp_path / "rig-2.mcap").read_text() == "mine"
    assert not (tmp_path / "rig-1.mcap").exists()
    assert simulate(tmp_path / "new.mcap", SINE, "--sweep", "moving_mass=5:9:2", "--set", "moving_mass=7@0.5") == 2
    assert "without @S" in capsys.readouterr().err
