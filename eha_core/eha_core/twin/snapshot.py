"""Recordings of the seconds about an alarm, as `ros2 bag record --snapshot-mode` keeps those before a trigger."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from heapq import merge
from math import inf
from pathlib import Path

import numpy as np

from eha_core.recording import RecordingWriter, free_path
from eha_core.recording.simulated import FLOAT, JOINTS, PRESSURE, Message, topic_messages
from eha_core.twin.comparison import Comparison
from eha_core.twin.excerpt import Excerpt, joined
from eha_core.twin.samples import nanoseconds


@dataclass
class Snapshots:
    """Gathers the windows before and after each alarm.

    Attributes:
        before: how much is kept of what came before the end of the window that raised the alarm [s].
        after: how much of what comes then [s].
    """

    before: float
    after: float

    def __post_init__(self) -> None:
        self._windows: list[Excerpt] = []  # of the snapshot under way
        self._alarm = 0
        self._was_departing = False

    def take(self, comparison: Comparison, kept: Sequence[Excerpt]) -> Excerpt | None:
        """Take a comparison and the windows that the twin keeps; return a snapshot if one is complete with it.

        A snapshot ends early where the next window does not follow, and lasts on through alarms that come meanwhile.
        """
        newest, finished = kept[-1], None
        if self._windows and self._windows[-1].end == newest.start:
            self._windows.append(newest)
        else:
            finished = self.finish()
        departing = bool(comparison.departs)
        if departing and not self._was_departing and not self._windows:
            self._windows, self._alarm = list(kept), newest.end
        self._was_departing = departing
        if self._windows and newest.end >= self._alarm + nanoseconds(self.after):
            finished = self.finish()
        return finished

    def finish(self) -> Excerpt | None:
        """The snapshot under way as it is, or None."""
        if not self._windows:
            return None
        whole = joined(self._windows)
        self._windows = []
        return whole.part(self._alarm - nanoseconds(self.before), self._alarm + nanoseconds(self.after))


def write_snapshot(folder: str | Path, excerpt: Excerpt, parameters: Mapping[str, float]) -> Path:
    """Write an excerpt as a recording of the rig's topics, named by date and time; return its path.

    The parameters are the twin's, which `eha diagnose` takes for nominal. Raises RecordingError where it cannot be
    written.
    """
    with RecordingWriter(free_path(Path(folder), "twin"), parameters, flush_period=inf) as writer:
        for stamp, _, topic, type_name, data in merge(*_topics(excerpt, parameters["atmospheric_pressure"])):
            writer.write(topic, type_name, data, stamp)
        return writer.path


def _topics(excerpt: Excerpt, atmosphere: float) -> Iterable[Iterable[Message]]:
    for order, chamber in enumerate("ab"):
        if f"pressure_{chamber}" in excerpt.channels:
            stamps, values = excerpt.channels[f"pressure_{chamber}"]
            pressure = {"fluid_pressure": values + atmosphere}
            yield topic_messages(order, f"/chamber_{chamber}/pressure", PRESSURE, stamps, pressure)
    stamps, values = excerpt.channels["position"]
    yield topic_messages(2, "/joint_states", JOINTS, stamps, {"position": values}, name=["piston"])
    # with every position, for a command that is not repeated may be one that was not recorded
    stamps = np.union1d(stamps, excerpt.voltage[0])
    voltages = excerpt.voltage[1][np.searchsorted(excerpt.voltage[0], stamps, side="right") - 1]
    yield topic_messages(3, "/voltage_command", FLOAT, stamps, {"data": voltages}, has_header=False)
