"""A simulated record as a recording in memory, and as a CSV table."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from eha_core.errors import RecordingError
from eha_core.recording.channel_rules import GAUGE, ChannelRule
from eha_core.recording.raw import RawRecording
from eha_core.recording.reader import assemble
from eha_core.recording.recording import Recording
from eha_core.recording.samples import Samples
from eha_core.recording.simulated import Simulated
from eha_core.recording.writer import PARAMETERS_RECORD

SENSORS = {
    "position": "measured_position",
    "velocity": "measured_velocity",
    "pressure_a": "measured_pressure_a",
    "pressure_b": "measured_pressure_b",
}
STATES = {
    "current": "current",
    "spool": "spool_position",
    "flow_a": "flow_a",
    "flow_b": "flow_b",
    "supply_pressure": "supply_pressure",
}
"""The plant's column of each channel: those of usual instruments, and those that these do not measure."""


def as_recording(record: Simulated, states: bool = False) -> Recording:
    """A simulated record as after `write_simulated` and reading; with `states`, also the channels of STATES."""
    hidden, driving = record.composition.source.hides, record.inputs
    columns = {name: column for name, column in (SENSORS | (STATES if states else {})).items() if column not in hidden}
    samples = {name: Samples(record.stamps, record.column(column)) for name, column in columns.items()}
    samples |= {name: Samples(*given) for name, given in (driving or {"voltage_command": record.commands}).items()}
    rules = {name: ChannelRule(name, reference=GAUGE) for name in samples}
    stored = {name: repr(float(value)) for name, value in record.parameters.items()}
    raw = RawRecording(metadata={PARAMETERS_RECORD: stored})
    return assemble(Path("simulated"), samples, rules, dict.fromkeys(rules, "simulated"), raw, [])


def write_csv(path: str | Path, record: Simulated, instruments_only: bool = False) -> int:
    """Write a simulated record as a table with a header row: absolute pressures, SI; returns the number of rows.

    Without `instruments_only` it also has the channels that usual instruments do not measure.

    Raises:
        RecordingError: the file exists already or cannot be written.
    """
    table = as_recording(record, not instruments_only).to_dict()
    atmosphere = record.atmosphere
    columns = {name: values + atmosphere if "pressure" in name else values for name, values in table.items()}
    try:
        with Path(path).open("x", encoding="utf-8") as file:
            rows = np.stack(list(columns.values()), axis=1)
            np.savetxt(file, rows, "%.12g", ",", header=",".join(columns), comments="")
    except FileExistsError:
        raise RecordingError(f"{path}: exists already; choose another name") from None
    except OSError as error:
        raise RecordingError(f"{path}: cannot be written ({error.strerror})") from error
    return len(record.stamps)
