"""A long record, block by block: each block is a short recording, and only a few are in memory at a time."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import RecordingError
from eha_core.recording.bag import bag_metadata, read_bag
from eha_core.recording.cutting import HELD, cut_out, leakage_within, named_stretch
from eha_core.recording.discovery import LEAKAGE_TOPIC
from eha_core.recording.raw import RawRecording, Sink
from eha_core.recording.reader import MessageFile, assemble, open_messages
from eha_core.recording.recording import CHANNEL_KINDS, FloatArray, Recording
from eha_core.recording.samples import Samples, put_in_order
from eha_core.recording.topics_file import TopicsFile

PIECE = 30.0
"""s of a file that are collected before they are cut into blocks (assumed; blocks are of 10 s)."""
MOST_HELD = 1_000_000
"""Most messages that are collected, whatever their times: 16 MB of numbers (assumed)."""


@dataclass(frozen=True)
class Block:
    """One block of a record.

    Attributes:
        number: counted from 0.
        start, end: [s] of the record.
        recording: its channels, in its own time; None where nothing in it is usable.
        problem: the reason in that case.
    """

    number: int
    start: float
    end: float
    recording: Recording | None
    problem: str = ""


Take = Callable[[Block], None]
Progress = Callable[[str], None]


class Blocks(Protocol):
    """A record that can be read block by block, repeatedly.

    `duration` [s], `remarks` and `damaged` are known after the first pass.
    """

    path: Path
    duration: float
    remarks: tuple[str, ...]
    damaged: str | None

    def each(self, take: Take, wanted: Container[int] | None = None, progress: Progress = lambda _: None) -> None:
        """Pass every block, or those that are wanted, to `take`, in the order of time."""


class BlocksInMemory:
    """The blocks of a recording that is in memory."""

    def __init__(self, recording: Recording, length: float) -> None:
        self.path, self.duration = recording.path, recording.duration
        self.remarks, self.damaged = recording.remarks, recording.damaged
        self._recording, self._length = recording, length

    def each(self, take: Take, wanted: Container[int] | None = None, progress: Progress = lambda _: None) -> None:
        """Hand every block, or those that are wanted, to `take`."""
        for number in range(int(np.ceil(self.duration / self._length))):
            if wanted is None or number in wanted:
                start, end = number * self._length, min((number + 1) * self._length, self.duration)
                # the record's last sample belongs to it
                last = np.inf if end == self.duration else end
                found = cut_out(self._recording, start, last)
                if found is not None:
                    found = replace(found, path=named_stretch(self.path, start, end))
                take(Block(number, start, end, found, "" if found else f"{self.path}: no samples there"))


class BlocksOfFile:
    """The blocks of a file or folder of messages, read again at each pass; only a few are in memory at a time.

    Raises RecordingError as `read_recording` does.
    """

    def __init__(self, path: Path, topics: TopicsFile | None, length: float) -> None:
        self.path, self.duration = path, 0.0
        self.remarks: tuple[str, ...] = ()
        self.damaged: str | None = None
        self._topics, self._length = topics, length

    def each(self, take: Take, wanted: Container[int] | None = None, progress: Progress = lambda _: None) -> None:
        """Hand every block, or those that are wanted, to `take`."""
        file = open_messages(self.path, self._topics)
        cutter = _Cutter(file, bag_metadata(self.path), self._length, take, wanted)
        known = f" of {self.duration:.0f}" if self.duration else ""

        def gather() -> None:
            cutter.add(*file.collect())
            progress(f"reading {self.path.name}: {cutter.seen:.0f}{known} s")

        gate = _Gate(gather)
        raw = read_bag(self.path, {topic: _Watched(sink, gate) for topic, sink in file.sinks.items()})
        gather()
        cutter.finish()
        if cutter.start is None:
            raise RecordingError(f"{self.path}: no usable channel; map what there is to channels in a topics file")
        self.duration = cutter.seen
        self.remarks = tuple(dict.fromkeys((*file.remarks, *cutter.remarks())))
        self.damaged = "; ".join(raw.damage) + f"; what was read covers {self.duration:.4g} s" if raw.damage else None


class _Gate:
    """Calls `gather` whenever a piece of the file was read."""

    def __init__(self, gather: Callable[[], None]) -> None:
        self._gather = gather
        self._until: int | None = None
        self._count = 0

    def passes(self, log_time: int, count: int) -> None:
        self._count += count
        if self._until is None:
            self._until = log_time + round(PIECE * 1e9)
        elif log_time >= self._until or self._count > MOST_HELD:
            self._gather()
            self._until, self._count = log_time + round(PIECE * 1e9), count


class _Watched:
    """A topic's sink that reports its messages to the gate."""

    def __init__(self, sink: Sink, gate: _Gate) -> None:
        self._sink, self._gate = sink, gate

    def add(self, log_time: int, payload: bytes) -> None:
        self._gate.passes(log_time, 1)
        self._sink.add(log_time, payload)

    def add_block(
        self, content: bytes, starts: NDArray[np.int64], lengths: NDArray[np.int64], log_times: NDArray[np.int64]
    ) -> None:
        if len(log_times):
            self._gate.passes(int(log_times[0]), len(log_times))
        self._sink.add_block(content, starts, lengths, log_times)


class _Cutter:
    """Cuts pieces of a file, as they arrive, into blocks of equal length, counted from the record's first stamp."""

    def __init__(
        self,
        file: MessageFile,
        metadata: Mapping[str, Mapping[str, str]],
        length: float,
        take: Take,
        wanted: Container[int] | None,
    ) -> None:
        self.start: int | None = None
        self._file, self._take, self._wanted = file, take, wanted
        self._raw = RawRecording(metadata={name: dict(values) for name, values in metadata.items()})
        self._length = round(length * 1e9)
        self._pending: dict[str, Samples] = {}
        self._held: dict[str, float] = {}
        self._last: dict[str, int] = {}
        self._leakage: list[tuple[float, float]] = []
        self._next = 0
        self._before = self._latest = 0
        self._remarks: dict[str, list[str]] = {}

    @property
    def seen(self) -> float:
        """Duration of the record so far [s]."""
        return (self._latest - self.start) / 1e9 if self.start is not None else 0.0

    def add(self, samples: Mapping[str, Samples], remarks: Sequence[str]) -> None:
        """Take a piece; blocks that end before the piece are complete."""
        self._note(remarks)
        changes = samples.get(LEAKAGE_TOPIC)
        for name in (name for name in CHANNEL_KINDS if name in samples):
            ordered, notes = put_in_order(samples[name])
            self._note([f"{name} ({self._file.rules[name].topic}): {note}" for note in notes])
            self._append(name, ordered)
        filled = [series.stamps for series in self._pending.values() if len(series.stamps)]
        if not filled:
            return
        if self.start is None:
            self.start = min(int(stamps[0]) for stamps in filled)
        if changes is not None:
            finite = np.isfinite(changes.values)
            seconds = (changes.stamps[finite] - self.start) / 1e9
            self._leakage += zip(seconds.tolist(), changes.values[finite].tolist(), strict=True)
            self._leakage.sort()
        self._before, self._latest = self._latest, max(int(stamps[-1]) for stamps in filled)
        while self._before and self.start + (self._next + 1) * self._length <= self._before:
            self._emit()

    def finish(self) -> None:
        """Cut the rest into blocks."""
        while self.start is not None and self.start + self._next * self._length < self._latest:
            self._emit()

    def remarks(self) -> Iterator[str]:
        """What was excluded while reading, each kind once."""
        for alike in self._remarks.values():
            yield alike[0] + (f" (and so in {len(alike) - 1} more places)" if len(alike) > 1 else "")

    def _note(self, remarks: Sequence[str]) -> None:
        for remark in remarks:
            alike = self._remarks.setdefault(re.sub(r"\d+", "#", remark), [])
            if remark not in alike or "left out" in remark:
                alike.append(remark)

    def _append(self, name: str, series: Samples) -> None:
        before = self._pending.get(name, Samples(np.empty(0, dtype=np.int64), np.empty(0)))
        later = series.stamps > self._last.get(name, -(2**62))
        if not later.all():
            self._note([f"{name}: {np.count_nonzero(~later)} samples were left out because time runs backwards there"])
        stamps, values = series.stamps[later], series.values[later]
        if len(stamps):
            self._last[name] = int(stamps[-1])
        self._pending[name] = Samples(np.concatenate([before.stamps, stamps]), np.concatenate([before.values, values]))

    def _emit(self) -> None:
        assert self.start is not None
        number, self._next = self._next, self._next + 1
        begin, end = self.start + number * self._length, self.start + (number + 1) * self._length
        if self._latest <= end:  # the record's last block holds its last sample
            end = self._latest + 1
        wanted = self._wanted is None or number in self._wanted
        inside: dict[str, Samples] = {}
        for name, series in self._pending.items():
            place = int(np.searchsorted(series.stamps, end))
            part = Samples(series.stamps[:place], series.values[:place])
            if wanted and (samples := self._with_held(name, part, begin)) is not None:
                inside[name] = samples
            if place:
                self._held[name] = float(part.values[-1])
            self._pending[name] = Samples(series.stamps[place:].copy(), series.values[place:].copy())
        if wanted:
            self._take(self._block(number, inside, begin, end))

    def _with_held(self, name: str, part: Samples, begin: int) -> Samples | None:
        if name in HELD and name in self._held and not (len(part.stamps) and part.stamps[0] == begin):
            stamps: NDArray[np.int64] = np.concatenate([[begin], part.stamps]).astype(np.int64)
            values: FloatArray = np.concatenate([[self._held[name]], part.values])
            return Samples(stamps, values)
        return part if len(part.stamps) else None

    def _block(self, number: int, samples: Mapping[str, Samples], begin: int, end: int) -> Block:
        assert self.start is not None
        first, last = ((instant - self.start) / 1e9 for instant in (begin, min(end, self._latest)))
        path = named_stretch(self._file.path, first, last)
        if not any(name not in HELD for name in samples):
            return Block(number, first, last, None, f"{path}: no samples there")
        try:
            found = assemble(path, samples, self._file.rules, self._file.types, self._raw, [])
        except RecordingError as error:
            return Block(number, first, last, None, str(error))
        self._note([remark for remark in found.remarks if "left out" not in remark])
        leakage = leakage_within(self._leakage, (found.start_stamp - self.start) / 1e9, last)
        return Block(number, first, last, replace(found, remarks=(), leakage_changes=leakage))
