"""Collects the messages of a topic into columns of numbers, many at a time, without decoding each."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import RecordingError
from eha_core.recording.cdr_layout import Layout, Run, layout_of
from eha_core.recording.channel_kinds import FloatArray
from eha_core.recording.fields import Steps, Tables, check_path, find, is_named_by_version, parse_path, uses_names
from eha_core.recording.message_types import recorded_types
from eha_core.recording.raw import RawTopic

Integers = NDArray[np.int64]
Bytes = NDArray[np.uint8]

_ALL_BITS = 2**64 - 1
BLOCK = 4096
"""Single messages that are collected before they are read together."""
MOST_LAYOUTS = 32
"""Most layouts of a topic that are tried on a block of messages; with more, each message is read by itself."""


MOST_COMPARED = 2**20
"""Bytes that are compared at once; their indices take eight times as much memory."""


@dataclass(frozen=True)
class DecodedTopic:
    """The numbers of one topic.

    Attributes:
        stamps: header stamps where the messages have them, else log times [ns].
        logged: log time of each message [ns].
        lead: median of log time minus stamp: the lead of the recorder's clock over the stamps' clock [ns].
        columns: values by channel name, in the message's unit; NaN where a message lacks the element.
        remarks: what was excluded.
    """

    name: str
    stamps: Integers
    logged: Integers
    lead: int
    columns: Mapping[str, FloatArray]
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class _Template:
    """A layout, the bytes by which it is recognised, and the places of the wanted numbers in it."""

    layout: Layout
    marks: Integers
    marked: Bytes
    runs: Mapping[str, Run | None]
    stamp: tuple[Run, Run] | None


_Block = tuple[Integers, Integers, dict[str, FloatArray]]


class TopicColumns:
    """Takes the messages of one topic as they are read from a file, and keeps only the wanted numbers.

    Args:
        topic: the topic.
        fields: paths inside the message by channel name.
        tables: the names of its values by version, for ros2_control's introspection.
        optional: channels that are omitted, with a remark, where it is not clear which element they are.

    Raises:
        RecordingError: the type's definition is missing, or a field is not in the message.
    """

    def __init__(
        self,
        topic: RawTopic,
        fields: Mapping[str, str],
        tables: Tables | None = None,
        optional: Collection[str] = (),
    ) -> None:
        self._topic = topic
        self._store, remark = recorded_types(topic.type_name, topic.encoding, topic.definition)
        self._steps: dict[str, Steps] = {name: parse_path(topic.name, path) for name, path in fields.items()}
        for name, steps in self._steps.items():
            check_path(topic.name, fields[name], steps, self._store, topic.type_name)
        self._named = any(uses_names(steps) for steps in self._steps.values())
        self._tables = tables or {}
        self._optional = optional
        self._remarks = [f"{topic.name}: {remark}"] if remark else []
        self._templates: list[_Template] = []
        self._pending: list[tuple[int, bytes]] = []
        self._blocks: list[_Block] = []
        self._lost = 0
        self._problem: RecordingError | None = None

    def add(self, log_time: int, payload: bytes) -> None:
        """Take one message."""
        self._pending.append((log_time, payload))
        if len(self._pending) >= BLOCK:
            self._flush()

    def add_block(self, content: bytes, starts: Integers, lengths: Integers, log_times: Integers) -> None:
        """Take many messages, each some bytes of `content`."""
        self._flush()
        whole = np.frombuffer(content, np.uint8)
        for first in range(0, len(starts), BLOCK):
            part = slice(first, first + BLOCK)
            self._read(whole, starts[part], lengths[part], log_times[part])

    def finish(self) -> DecodedTopic:
        """The messages since the last call as columns; they are not kept.

        Raises:
            RecordingError: it is not clear which element of a message is meant.
        """
        self._flush()
        if self._problem is not None:
            raise self._problem
        name, remarks = self._topic.name, list(self._remarks)
        if self._lost:
            remarks.append(f"{name}: {self._lost} messages that do not decode were left out")
        blocks, self._blocks = self._blocks or [_no_messages(self._steps)], []
        logged = np.concatenate([block[0] for block in blocks])
        stamps = np.concatenate([block[1] for block in blocks])
        columns = {channel: np.concatenate([block[2][channel] for block in blocks]) for channel in self._steps}
        # A header that its publisher never filled in does not count.
        if not stamps.any():
            return DecodedTopic(name, logged, logged, 0, columns, tuple(remarks))
        return DecodedTopic(name, stamps, logged, int(np.median(logged - stamps)), columns, tuple(remarks))

    def _flush(self) -> None:
        if not self._pending:
            return
        times, payloads = zip(*self._pending, strict=True)
        self._pending = []
        lengths = np.array([len(payload) for payload in payloads], dtype=np.int64)
        # SQLite's times are signed, MCAP's are not; damaged ones may have any value.
        logged = np.array([time & _ALL_BITS for time in times], dtype=np.uint64).astype(np.int64)
        content = np.frombuffer(b"".join(payloads), np.uint8)
        self._read(content, np.cumsum(lengths) - lengths, lengths, logged)

    def _read(self, content: Bytes, starts: Integers, lengths: Integers, logged: Integers) -> None:
        if self._problem is not None:
            return
        stamps = np.zeros(len(starts), dtype=np.int64)
        columns = {channel: np.full(len(starts), np.nan) for channel in self._steps}
        left: Integers = np.arange(len(starts), dtype=np.int64)
        sound = np.ones(len(starts), dtype=bool)
        for template in list(self._templates):
            left = self._take(template, content, starts, lengths, left, stamps, columns)
        while len(left):
            first = int(left[0])
            start = int(starts[first])
            try:
                template = self._template(content[start : start + int(lengths[first])].tobytes())
            except RecordingError as problem:
                self._problem = problem
                return
            except ValueError:
                sound[first] = False
                left = left[1:]
                continue
            crowded = len(self._templates) >= MOST_LAYOUTS
            rest = self._take(template, content, starts, lengths, left[:1] if crowded else left, stamps, columns)
            left = left[1:] if crowded else rest
            if not crowded:
                self._templates.append(template)
        self._lost += int(np.count_nonzero(~sound))
        kept = {channel: values[sound] for channel, values in columns.items()}
        self._blocks.append((logged[sound], stamps[sound], kept))

    def _take(
        self, template: _Template, content: Bytes, starts: Integers, lengths: Integers, left: Integers,
        stamps: Integers, columns: Mapping[str, FloatArray],
    ) -> Integers:  # fmt: skip
        """Read the messages among `left` that have the template's layout; return the others."""
        alike = lengths[left] == template.layout.length
        rows = left[alike]
        if not len(rows):
            return left
        same = _agree(content, starts[rows], template)
        rows = rows[same]
        for channel, run in template.runs.items():
            if run is not None:
                columns[channel][rows] = _numbers(content, starts[rows], run)
        if template.stamp:
            seconds, nanoseconds = (_numbers(content, starts[rows], run).astype(np.int64) for run in template.stamp)
            stamps[rows] = seconds * 1_000_000_000 + nanoseconds
        alike[alike] = same
        others: Integers = left[~alike]
        return others

    def _template(self, data: bytes) -> _Template:
        """The template of a message's layout. Raises ValueError for bytes that are not a message of the type."""
        layout = layout_of(self._store, self._topic.type_name, data)
        marks = list(layout.marks)
        version = None
        if self._named:
            marks += [place for path, span in layout.spans.items() if _is_name(path) for place in range(*span)]
            if is_named_by_version(self._topic.type_name):
                word = layout.runs["names_version"]
                marks += range(word.offset, word.offset + word.size)
                version = int(np.frombuffer(data, word.kind, 1, word.offset)[0])
        runs: dict[str, Run | None] = {}
        for channel, steps in self._steps.items():
            try:
                runs[channel] = find(self._topic.name, steps, layout, self._tables, version)
            except RecordingError as problem:
                # An element of the first message that a later one lacks is missing there, which is no error.
                if not self._templates and channel not in self._optional:
                    raise
                if not self._templates:
                    self._remarks.append(f"{channel} left out: {problem}")
                runs[channel] = None
        seconds, nanoseconds = (layout.runs.get(f"header.stamp.{part}") for part in ("sec", "nanosec"))
        places = np.array(sorted(marks), dtype=np.int64)
        stamp = (seconds, nanoseconds) if seconds and nanoseconds else None
        return _Template(layout, places, np.frombuffer(data, np.uint8)[places], runs, stamp)


def _no_messages(channels: Iterable[str]) -> _Block:
    return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64), {channel: np.empty(0) for channel in channels}


def _agree(content: Bytes, starts: Integers, template: _Template) -> NDArray[np.bool_]:
    """Flags of the messages with the bytes by which the template is recognised."""
    step = max(1, MOST_COMPARED // len(template.marks))
    parts = [
        np.all(content[starts[first : first + step, None] + template.marks] == template.marked, axis=1)
        for first in range(0, len(starts), step)
    ]
    return np.concatenate(parts)


def _is_name(path: str) -> bool:
    return path.endswith(".name") or path.startswith("name[") or ".name[" in path


def _numbers(content: Bytes, starts: Integers, run: Run) -> NDArray[Any]:
    found = content[(starts + run.offset)[:, None] + np.arange(run.size)]
    return found.view(run.kind)[:, 0]
