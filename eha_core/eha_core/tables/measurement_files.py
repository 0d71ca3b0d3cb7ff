"""Reads measurement files whose signals have times of their own: TDMS with npTDMS, MDF with asammdf."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from eha_core.errors import RecordingError
from eha_core.tables.optional import required
from eha_core.tables.own_times import columns_with_times
from eha_core.tables.table import LARGEST, Column, Table, as_column, refuse_large

Signal = tuple[str, str, Column, "Column | None", str]
"""A signal's name, unit, values, times (None without any), and the times' unit."""


def read_tdms(path: Path) -> Table:
    """Read the channels of a TDMS file; those with a waveform increment have their own times [s].

    Raises:
        RecordingError: the file is damaged, of another kind, or too large.
    """
    nptdms = required("nptdms", path, "TDMS files")
    return _table(path, "tdms", lambda: _of_tdms(nptdms, path))


_FRAMES = "CAN_DataFrame"
"""MDF's name of the frames that a bus logger wrote without decoding."""
_DATABASE = ".dbc"
LARGEST_DATABASE = 10 * 2**20
"""Most bytes of a CAN database; a vehicle's have one or two million."""


def read_mdf(path: Path) -> Table:
    """Read the signals of an MDF file, each with its own times [s]; CAN frames with the .dbc of its name beside it.

    Raises:
        RecordingError: as `read_tdms`.
    """
    asammdf = required("asammdf", path, "MDF files")
    with path.open("rb") as file:
        head = file.read(68)
    # A file that does not begin like one is not passed to the library, which would not close it.
    if not (head.startswith(b"MDF") and head[64:] in (b"##HD", b"HD\xa4\x00", b"HD\xd0\x00")):
        raise RecordingError(f"{path}: is not an MDF file (it starts with other bytes)")
    return _table(path, "mdf", lambda: _of_mdf(asammdf, path))


def _of_tdms(nptdms: Any, path: Path) -> Iterator[Signal]:
    with path.open("rb") as stream, nptdms.TdmsFile.open(stream) as file:
        for group in file.groups():
            for channel in group.channels():
                values = as_column(channel[:]) if len(channel) else None
                if values is None:
                    continue
                unit = str(channel.properties.get("unit_string", "") or channel.properties.get("unit", ""))
                increment = float(channel.properties.get("wf_increment", 0.0) or 0.0)
                time = None
                if increment > 0.0:
                    offset = float(channel.properties.get("wf_start_offset", 0.0) or 0.0)
                    time = offset + increment * np.arange(len(values))
                if channel[:1].dtype.kind == "M":
                    unit = "ns"
                yield f"{group.name}/{channel.name}", unit, values, time, "s"


def _of_mdf(asammdf: Any, path: Path) -> Iterator[Signal]:
    with asammdf.MDF(path) as file:
        if _FRAMES in file.channels_db:
            with _decoded(file, path) as decoded:
                yield from _signals(decoded)
        yield from _signals(file)


def _signals(file: Any) -> Iterator[Signal]:
    for signal in file.iter_channels(skip_master=True):
        is_plain = np.ndim(signal.samples) == 1 and not signal.name.startswith(_FRAMES)
        values = as_column(signal.samples) if is_plain else None
        if values is not None and len(values):
            yield signal.name, str(signal.unit or ""), values, np.asarray(signal.timestamps, dtype=np.float64), "s"


def _decoded(file: Any, path: Path) -> Any:
    """The signals in the CAN frames of an MDF file, decoded with the database of the same name beside it.

    Raises:
        RecordingError: there is none, it cannot be read, or it has none of the frames.
    """
    database = path.with_suffix(_DATABASE)
    if not database.is_file() or database.stat().st_size > LARGEST_DATABASE:
        raise RecordingError(
            f"{path}: holds raw CAN frames; put their database beside it as {database.name} (10 MB at most), or export"
            " the decoded signals as CSV or MDF"
        )
    try:
        decoded = file.extract_bus_logging(database_files={"CAN": [(str(database), 0)]})
    except Exception as error:  # the library may raise anything for a damaged database
        raise RecordingError(f"{database}: cannot be read as a CAN database ({error})") from error
    if not decoded.groups:
        raise RecordingError(f"{path}: {database.name} describes none of its CAN frames; take the network's own")
    return decoded


def _table(path: Path, kind: str, signals: Any) -> Table:
    try:
        if path.stat().st_size > LARGEST:
            raise RecordingError(f"{path}: is larger than {LARGEST / 1e9:.1f} GB; cut it, or convert it to MCAP")
        found: list[Signal] = []
        cells = longest = 0
        for signal in signals():
            cells, longest = cells + len(signal[2]), max(longest, len(signal[2]))
            found.append(signal)
            refuse_large(path, cells, len(found), longest)
    except RecordingError:
        raise
    except Exception as error:  # the libraries may raise anything for damaged bytes
        raise RecordingError(f"{path}: cannot be read as a {kind.upper()} file ({error})") from error
    if not found:
        raise RecordingError(f"{path}: holds no signal with numbers")
    return columns_with_times(kind, found)
