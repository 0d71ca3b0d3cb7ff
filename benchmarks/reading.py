"""A recording read into channels against the mcap library's plain reader, which hands the same messages on unread."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from time import process_time

import numpy as np
from mcap.reader import make_reader

from benchmarks.row import Row
from eha_core.recording import read_recording
from eha_core.recording.simulated import Experiment, simulate, write_simulated

SECONDS, RATE = 30.0, 1000.0
ROUNDS = 5
TARGET = 15.0
"""MB of the file in a second."""


def measure() -> list[Row]:
    """Time both in turns on a recording whose every topic is a channel's; the shortest CPU time counts."""
    times = np.arange(round(SECONDS * RATE)) / RATE
    voltages = 0.05 * np.sin(2.0 * np.pi * times)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rig.mcap"
        write_simulated(
            path, simulate(Experiment(times, voltages, SECONDS, rate=RATE, noise=1.0)), instruments_only=True
        )
        size = path.stat().st_size / 1e6
        ours, plain = np.min([[_time(_channels, path), _time(_plain, path)] for _ in range(ROUNDS)], axis=0)
    return [
        Row(
            f"reading a recording of {SECONDS:g} s at {RATE:g} Hz, {size:.1f} MB, into channels",
            f"{size / ours:.1f} MB/s",
            f"mcap's reader, messages not decoded: {size / plain:.1f} MB/s",
            f"{plain / ours:.1f} x faster",
            f">= 1 x and >= {TARGET:g} MB/s",
            bool(ours <= plain and size / ours >= TARGET),
        )
    ]


def _channels(path: Path) -> None:
    read_recording(path)


def _plain(path: Path) -> None:
    with path.open("rb") as stream:
        for _ in make_reader(stream).iter_messages():
            pass


def _time(read: Callable[[Path], None], path: Path) -> float:
    start = process_time()
    read(path)
    return process_time() - start
