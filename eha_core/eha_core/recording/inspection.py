"""Lists the contents of a file: every number that could be a channel, with its rate, range and unit."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import islice
from math import inf, nan
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import RecordingError, printable
from eha_core.recording.bag import bag_topics, read_bag
from eha_core.recording.cdr_layout import Layout, layout_of
from eha_core.recording.channel_rules import ABSOLUTE
from eha_core.recording.fields import Tables
from eha_core.recording.introspection import value_names
from eha_core.recording.message_types import recorded_types
from eha_core.recording.outline import Outline, Pairs
from eha_core.recording.raw import RawTopic
from eha_core.recording.stated_units import unit_of_name, unit_of_type
from eha_core.recording.time_units import repeats, unwrapped, usual_step
from eha_core.recording.topic_columns import BLOCK, TopicColumns
from eha_core.tables import Table, is_table, read_table

MOST_TOPICS = 1000
"""Most topics of a recording that are listed; a robot has some hundred (assumed)."""
MOST_FIELDS = 200
"""Most numbers of a topic, or columns of a table, that are listed."""
LONGEST_ARRAY = 12
"""Longest unnamed array that is listed; longer ones are images, scans or covariances."""
KINDS = {
    "csv": "text table", "lvm": "LabVIEW measurement file", "mat": "MAT file", "parquet": "Parquet file",
    "json": "JSON records", "xlsx": "workbook", "tdms": "TDMS file", "mdf": "MDF file",
    "bag": "recording of ROS 2 messages",
}  # fmt: skip
"""The name of each kind of file."""
_HEADS = ("header.", "layout.")
"""Parts of messages without a rig's numbers."""
_NO_CHANNEL = (".sec", ".nanosec", "variance", "names_version")
_ABSOLUTE = "sensor_msgs/msg/FluidPressure"
"""The message that defines its pressure as absolute."""


@dataclass(frozen=True)
class Field:
    """One number of a file over time.

    Attributes:
        topic: its topic; empty in a table.
        path: the path inside the message, or the column.
        count: finite values.
        low: lowest value, as recorded.
        high: highest value.
        rate: values per second of the topic's stamps; NaN in a table, which has one time for all.
        unit: stated by the file, the message's type or the name; else empty.
        first: the first value; NaN without one.
        step: the usual step from one value to the next; zero where they do not always increase.
        reference: "absolute" for a pressure whose message defines it so; else None.
        repeated: rows per second, by its first and last value, of a column that often repeats and never decreases.
        time: the column of its own times; empty for the table's time.
        problem: why it cannot be used; empty where it can.
        day_first: of ambiguous dates, the order of day and month that makes the shorter record; else None.
        outline: lowest and highest value of each of some hundred stretches, as recorded.
    """

    topic: str
    path: str
    count: int
    low: float
    high: float
    rate: float
    unit: str
    first: float = nan
    step: float = 0.0
    reference: str | None = None
    repeated: float = 0.0
    time: str = ""
    problem: str = ""
    day_first: bool | None = None
    outline: Pairs = field(default=(), compare=False, repr=False)


@dataclass(frozen=True)
class Inspection:
    """The contents of a file.

    Attributes:
        path: the file.
        kind: "csv", "lvm", "mat", "parquet" or "bag".
        fields: its numbers.
        topics: message types by topic; empty for a table.
        remarks: what was excluded.
        damaged: the part of a bag that could not be read; None where it is sound.
        rate: rows per second that a table states [Hz]; None where it states none.
    """

    path: Path
    kind: str
    fields: tuple[Field, ...]
    topics: Mapping[str, str]
    remarks: tuple[str, ...]
    damaged: str | None = None
    rate: float | None = None


def inspect_file(path: str | Path) -> Inspection:
    """List the contents of a file or a rosbag2 folder.

    Raises:
        RecordingError: nothing in it can be read.
    """
    path = Path(path)
    if not path.exists():
        raise RecordingError(f"{path}: there is no such file or folder")
    if not (path.is_file() or path.is_dir()):
        raise RecordingError(f"{path}: is neither a file nor a folder; name a recording")
    return _of_table(path, read_table(path)) if is_table(path) else _of_bag(path)


def _of_table(path: Path, table: Table) -> Inspection:
    fields = [_column(name, np.asarray(values), table) for name, values in table.columns.items()]
    remarks = list(table.remarks)
    wordy = {field.path for field in fields if not field.count}
    remarks += [f"{name!r}: {loss}" for name, loss in table.losses.items() if name not in wordy]
    remarks += [f"without numbers: {', '.join(field.path for field in fields if field.path in wordy)}"] if wordy else []
    if len(fields) > MOST_FIELDS:
        remarks.append(f"{len(fields) - MOST_FIELDS} columns more are not listed")
    said = tuple(map(printable, remarks))
    return Inspection(path, table.kind, tuple(fields[:MOST_FIELDS]), {}, said, rate=table.rate)


def _column(name: str, values: NDArray[np.generic], table: Table) -> Field:
    outline = Outline()
    outline.add(values)
    numbers = values.astype(np.float64)
    numbers = numbers[np.isfinite(numbers)]
    if not len(numbers):
        return Field("", name, 0, nan, nan, nan, "")
    whole = values if values.dtype.kind == "i" else numbers
    times, _ = unwrapped(whole)
    unit = table.units.get(name) or unit_of_name(name, tuple(table.columns))
    loss = table.losses.get(name)
    return Field(
        "", name, len(numbers), float(numbers.min()), float(numbers.max()), nan, unit, float(numbers[0]),
        usual_step(times), repeated=(len(times) - 1) / float(times[-1] - times[0]) if repeats(times) else 0.0,
        time=table.times.get(name, ""),
        problem=str(loss) if loss is not None and loss.by_value else "",
        day_first=table.other_orders[name].day_first if name in table.other_orders else None,
        outline=outline.pairs(),
    )  # fmt: skip


def _of_bag(path: Path) -> Inspection:
    found = bag_topics(path)
    topics = dict(islice(found.items(), MOST_TOPICS))
    watches = {name: _Watch(topic, value_names(path, topics, name)) for name, topic in topics.items()}
    raw = read_bag(path, watches)
    remarks = [remark for watch in watches.values() for remark in watch.remarks]
    if len(found) > MOST_TOPICS:
        remarks.append(f"{len(found) - MOST_TOPICS} topics more are not listed; a topics file can name them")
    damaged = printable("; ".join(raw.damage)) if raw.damage else None
    types = {name: topic.type_name for name, topic in topics.items()}
    fields = [field for watch in watches.values() for field in watch.fields()]
    return Inspection(path, "bag", tuple(fields), types, tuple(map(printable, remarks)), damaged)


class _Watch:
    """Takes the messages of one topic and keeps the range of each of their numbers."""

    def __init__(self, topic: RawTopic, tables: Tables) -> None:
        self.remarks: list[str] = []
        self._topic = topic
        self._tables = tables
        self._columns: TopicColumns | None = None
        self._ranges: dict[str, tuple[int, float, float]] = {}
        self._outlines: dict[str, Outline] = {}
        self._span: tuple[int, int] | None = None
        self._count = 0
        self._unread = False

    def add(self, log_time: int, payload: bytes) -> None:
        if self._opened(payload):
            assert self._columns is not None
            self._columns.add(log_time, payload)
            self._count += 1
            if self._count % BLOCK == 0:
                self._reduce()

    def add_block(
        self, content: bytes, starts: NDArray[np.int64], lengths: NDArray[np.int64], log_times: NDArray[np.int64]
    ) -> None:
        if self._opened(content[int(starts[0]) : int(starts[0] + lengths[0])]):
            assert self._columns is not None
            for first in range(0, len(starts), BLOCK):
                part = slice(first, first + BLOCK)
                self._columns.add_block(content, starts[part], lengths[part], log_times[part])
                self._reduce()

    def _opened(self, payload: bytes) -> bool:
        """Whether the topic's numbers are known, from its first message that can be read."""
        if self._columns is None and not self._unread:
            topic = self._topic
            try:
                store, _ = recorded_types(topic.type_name, topic.encoding, topic.definition)
                layout = layout_of(store, topic.type_name, payload)
                paths = _paths(layout, topic.type_name, self._tables)
            except RecordingError as error:
                self.remarks.append(str(error))
                self._unread = True
                return False
            except ValueError:
                return False
            if long := long_arrays(layout):
                self.remarks.append(
                    f"{topic.name}: {', '.join(long)} of more than {LONGEST_ARRAY} numbers not listed; a topics file"
                    f" can name an element, as {long[0]}[0]"
                )
            if len(paths) > MOST_FIELDS:
                self.remarks.append(f"{topic.name}: {len(paths) - MOST_FIELDS} numbers more are not listed")
            self._columns = TopicColumns(topic, {path: path for path in paths[:MOST_FIELDS]}, self._tables)
        return self._columns is not None

    def _reduce(self) -> None:
        if self._columns is None:
            return
        decoded = self._columns.finish()
        if len(decoded.stamps):
            ends = (int(decoded.stamps.min()), int(decoded.stamps.max()))
            self._span = ends if self._span is None else (min(self._span[0], ends[0]), max(self._span[1], ends[1]))
        for path, values in decoded.columns.items():
            self._outlines.setdefault(path, Outline()).add(values)
            finite = values[np.isfinite(values)]
            count, low, high = self._ranges.get(path, (0, inf, -inf))
            if len(finite):
                low, high = min(low, float(finite.min())), max(high, float(finite.max()))
            self._ranges[path] = (count + len(finite), low, high)

    def fields(self) -> list[Field]:
        """The topic's numbers; empty where it has none, or no message of it can be read."""
        try:
            self._reduce()
        except RecordingError as error:
            self.remarks.append(str(error))
            return []
        found = []
        for path, (count, low, high) in self._ranges.items():
            seconds = (self._span[1] - self._span[0]) * 1e-9 if self._span else 0.0
            rate = (count - 1) / seconds if seconds > 0.0 and count > 1 else nan
            unit = unit_of_type(self._topic.type_name, path)
            reference = ABSOLUTE if self._topic.type_name == _ABSOLUTE and path == "fluid_pressure" else None
            outline = self._outlines[path].pairs()
            found.append(
                Field(self._topic.name, path, count, low, high, rate, unit, reference=reference, outline=outline)
            )
        return found


def _paths(layout: Layout, type_name: str, tables: Tables) -> list[str]:
    """Paths of a message's numbers that could be channels; elements by their names, where they have names."""
    paths = []
    for path, run in layout.runs.items():
        if path.startswith(_HEADS) or path.endswith(_NO_CHANNEL):
            continue
        named = _by_names(path, layout)
        if run.count is None:
            paths.append(named)
            continue
        names = _element_names(path, run.count, layout, tables if type_name.endswith("StatisticsValues") else {})
        if names or run.count <= LONGEST_ARRAY:
            paths += [f"{named}[{names[k] if names else k}]" for k in range(run.count)]
    return paths


def long_arrays(layout: Layout) -> list[str]:
    """The paths of a message's unnamed arrays that are too long to be listed but may be a rig's signals."""
    return [
        path for path, run in layout.runs.items()
        if run.count is not None and LONGEST_ARRAY < run.count <= MOST_FIELDS and run.size >= 4
        and not path.startswith(_HEADS) and not path.endswith("covariance")
        and not _element_names(path, run.count, layout, {})
    ]  # fmt: skip


def _by_names(path: str, layout: Layout) -> str:
    """The path with the indices of named parts replaced by their names, as in `statistics[3].value`."""

    def name(match: re.Match[str]) -> str:
        text = layout.texts.get(f"{match[1]}.name", "")
        return f"{match[1].rpartition('[')[0]}[{text}]." if _fits(text) else match[0]

    return re.sub(r"^([^.]*\[\d+\])\.", name, path)


def _element_names(path: str, count: int, layout: Layout, tables: Tables) -> list[str]:
    names = [layout.texts.get(f"name[{k}]", "") for k in range(count)]
    for listed in tables.values() if path == "values" else ():
        if len(listed) == count:
            names = list(listed)
            break
    return names if names and all(map(_fits, names)) and len(set(names)) == len(names) else []


def _fits(name: str) -> bool:
    """Whether a name can be used in a path."""
    return bool(name) and not name.isdigit() and not re.search(r"[\[\]\n]", name)
