"""The test that a diagnosis proposes, from its file through the launch file to a recording."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from types import SimpleNamespace

import numpy as np

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
    command = channels["voltage_command"]
    played = np.asarray(make_signal("multisine", SIGNAL).value(command.time - command.time[0]))
    # all of it was recorded, at stamps of a clock that jitters
    assert command.time[-1] - command.time[0] > 1.95
    assert np.corrcoef(played[:-1], command.values[:-1])[0, 1] > 0.95
    assert command.values[-1] == 0.0
    assert np.ptp(channels["position"].values) > 1e-3
