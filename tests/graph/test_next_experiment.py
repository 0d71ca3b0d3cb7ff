"""The test that a diagnosis proposes, from its file through the launch file to a recording."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from types import SimpleNamespace

import numpy as np

import eha_core
from eha_core.diagnosis.result import Experiment
from eha_core.recording import read_recording
from eha_core.report.experiment_file import experiment_file
from eha_core.signals import make_signal

SIGNAL = {"amplitude": 0.05, "lowest": 0.5, "highest": 4.0, "count": 6, "period": 2.0, "seed": 3}


def test_the_launch_file_plays_records_and_ends(tmp_path: Path) -> None:
    reference = {"mode": "voltage", "signal": "multisine", **{f"multisine.{name}": one for name, one in SIGNAL.items()}}
    experiment = Experiment("A multisine tells them apart", ("one", "other"), reference, (), 2.0)
    file = tmp_path / "next_experiment.yaml"
    diagnosis = SimpleNamespace(channels=("voltage_command", "position"))
    file.write_text(experiment_file(diagnosis, experiment))
    words = ["eha_sim_node", "next_experiment.launch.yaml", f"file:={file}", "simulate:=true", f"directory:={tmp_path}"]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(int(os.environ["ROS_DOMAIN_ID"]) - 1)}
    done = subprocess.run(
        ["ros2", "launch", *words], capture_output=True, text=True, timeout=110, env=environment, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    channels = read_recording(tmp_path / "next_experiment.mcap").channels
    command, position = channels["voltage_command"], channels["position"]
    # every sample was recorded, on the simulator's clock and none late, however busy the machine is
    period = 2e-3
    assert np.allclose(command.time, period * np.arange(1001), atol=1e-9)
    played = np.asarray(make_signal("multisine", SIGNAL).value(command.time))
    assert np.allclose(command.values[:-1], played[:-1], atol=1e-12)
    assert command.values[-1] == 0.0
    simulated = eha_core.simulate(command.values[:-1], rate=1.0 / period, step_size=1e-4).channels["position"]
    same = np.isin(np.round(position.time / period), np.round(simulated.time / period))
    assert same.mean() > 0.99
    expected = np.interp(position.time[same], simulated.time, simulated.values)
    assert np.allclose(position.values[same], expected, atol=1e-9)
    assert np.ptp(position.values) > 1e-3
