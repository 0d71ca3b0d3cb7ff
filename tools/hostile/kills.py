"""Recorders killed at random moments: every file must open, to others too, and lack one second at most."""

from __future__ import annotations

import mmap
import os
import random
import signal
import struct
import tempfile
import time
from pathlib import Path

from mcap.reader import make_reader

from eha_core.recording import RecordingWriter, definition_of, read_recording
from tools.hostile.extent import Extent
from tools.hostile.row import Row

AT_ONCE = 8
LONGEST_LIFE = 1.5
"""s until a recorder is killed at the latest; it flushes twice a second."""
MOST_LOST = 1.0
"""s of messages that may be missing."""
_TYPE = "std_msgs/msg/Float64"
_STAMP = struct.Struct("<q")


def try_kills(extent: Extent, seed: int) -> list[Row]:
    """Kill recorders, some at once."""
    chance = random.Random(seed)
    row = Row("recorder killed while it writes 500 messages a second", seed)
    worst = 0.0
    definition_of(_TYPE)  # made once for all recorders: their time is for writing
    with tempfile.TemporaryDirectory() as temporary:
        course = extent.begin()
        round_number = 0
        while not course.over(row.times):
            paths = [Path(temporary) / f"{round_number}-{k}.mcap" for k in range(AT_ONCE)]
            recorders = [(_start(path), path) for path in paths]
            moments = sorted((chance.uniform(0.0, LONGEST_LIFE), k) for k in range(AT_ONCE))
            begun = time.monotonic()
            for moment, k in moments:
                time.sleep(max(0.0, begun + moment - time.monotonic()))
                (process, last), path = recorders[k]
                os.kill(process, signal.SIGKILL)
                os.waitpid(process, 0)
                worst = max(worst, _judge(row, path, _STAMP.unpack(last[:8])[0]))
                path.unlink(missing_ok=True)
            round_number += 1
    row.tried += f"; at most {worst:.2f} s lost"
    return [row]


def _start(path: Path) -> tuple[int, mmap.mmap]:
    """Start a recorder; its process id, and memory that holds the stamp of the last message it was given [ns]."""
    last = mmap.mmap(-1, 8)
    process = os.fork()
    if process:
        return process, last
    try:
        writer = RecordingWriter(path)
        count = 0
        while True:
            stamp = time.monotonic_ns()  # the wall clock may be set while a trial runs
            writer.write_fields("/voltage_command", _TYPE, {"data": 1e-3 * count}, stamp)
            last[:8] = _STAMP.pack(stamp)
            count += 1
            time.sleep(0.002)
    finally:
        os._exit(1)


def _judge(row: Row, path: Path, given: int) -> float:
    """Read what a killed recorder left; the time that is missing at its end [s]."""
    if not given and not path.exists():
        row.count("before the file was there")
        return 0.0
    try:
        with path.open("rb") as stream:
            stamps = [message.log_time for _, _, message in make_reader(stream).iter_messages()]
        if stamps and len(read_recording(path).channels["voltage_command"].time) < len(stamps):
            row.fail(f"{path.name}: read in part only")
            return 0.0
    except Exception as error:
        row.fail(f"{path.name}: {error!r}")
        return 0.0
    lost = (given - stamps[-1]) / 1e9 if stamps else 0.0
    row.fail(f"{path.name}: {lost:.2f} s lost") if lost > MOST_LOST else row.count("opened")
    return lost
