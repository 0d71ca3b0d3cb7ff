"""A simulated record in memory and as a table: what a file of messages would have given."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eha_core.errors import RecordingError
from eha_core.recording import read_recording
from eha_core.recording.simulated import Experiment, simulate, write_simulated
from eha_core.recording.simulated_table import as_recording, write_csv

TIMES = np.arange(20) / 500.0
RECORD = simulate(Experiment(TIMES, 0.05 * np.sin(200 * TIMES), 0.04, {"moving_mass": 12.0}))
USUAL = ["voltage_command", "pressure_a", "pressure_b", "position", "velocity"]


def test_in_memory_it_is_what_a_file_of_it_gives(tmp_path: Path) -> None:
    write_simulated(tmp_path / "run.mcap", RECORD)
    ours, read = as_recording(RECORD), read_recording(tmp_path / "run.mcap")
    assert list(ours.channels) == USUAL and ours.parameters == read.parameters == RECORD.parameters
    for name in USUAL:
        np.testing.assert_array_equal(ours.channels[name].time, read.channels[name].time)
        np.testing.assert_allclose(ours.channels[name].values, read.channels[name].values, rtol=0, atol=1e-8)


def test_with_states_it_has_what_instruments_do_not_show() -> None:
    found = as_recording(RECORD, states=True)
    assert set(found.channels) == {*USUAL, "current", "spool", "flow_a", "flow_b", "supply_pressure"}
    np.testing.assert_array_equal(found.channels["spool"].values, RECORD.column("spool_position"))


@pytest.mark.parametrize("instruments_only", [True, False])
def test_as_a_table_it_has_absolute_pressures_and_reads_back(tmp_path: Path, instruments_only: bool) -> None:
    path = tmp_path / "run.csv"
    assert write_csv(path, RECORD, instruments_only) == 21
    head, *rows = path.read_text().splitlines()
    assert len(rows) == 21 and ("spool" in head.split(",")) == (not instruments_only)
    table = dict(zip(head.split(","), np.loadtxt(rows, delimiter=",", unpack=True), strict=True))
    expected = RECORD.column("measured_pressure_a") + RECORD.atmosphere
    np.testing.assert_allclose(table["pressure_a"], expected, rtol=1e-11)
    np.testing.assert_allclose(table["position"], RECORD.column("measured_position"), rtol=1e-11)
    np.testing.assert_allclose(read_recording(path).channels["position"].values, table["position"], rtol=1e-11)
    with pytest.raises(RecordingError, match="exists already; choose another name"):
        write_csv(path, RECORD)
    with pytest.raises(RecordingError, match="cannot be written"):
        write_csv(tmp_path / "none" / "run.csv", RECORD)
