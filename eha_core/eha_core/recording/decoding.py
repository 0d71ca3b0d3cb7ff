"""Decodes the messages of a topic into one column of numbers for each channel that it carries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.serde import SerdeError
from scipy.ndimage import median_filter

from eha_core.recording.fields import field_getter
from eha_core.recording.message_types import Decoder
from eha_core.recording.raw import RawTopic
from eha_core.recording.recording import FloatArray
from eha_core.recording.samples import LONGEST_GAP

_CLOCKS_DIFFER = 1_000_000_000  # [ns]: longer than any transport takes
_LONE = 5  # messages of which less than half may be out of order without a leap of the clock
_LEAP_BACK = 100_000_000  # [ns]: further than messages overtake each other


@dataclass(frozen=True)
class DecodedTopic:
    """The numbers of one topic.

    Attributes:
        stamps: header stamps where the messages have them, else log times [ns].
        logged: when each message was recorded [ns].
        lead: median of log time minus stamp, which is how far the recorder's clock leads the stamps' clock [ns].
        columns: values by channel name, in the message's unit; NaN where a message lacks the element.
        remarks: what was left out.
    """

    name: str
    stamps: NDArray[np.int64]
    logged: NDArray[np.int64]
    lead: int
    columns: Mapping[str, FloatArray]
    remarks: tuple[str, ...]


def decode(topic: RawTopic, fields: Mapping[str, str]) -> DecodedTopic:
    """Decode a topic; `fields` maps channel names to paths inside the message.

    Raises:
        RecordingError: the type's definition is missing, or a field is not in the message.
    """
    decoder = Decoder(topic.type_name, topic.encoding, topic.definition)
    messages: list[Any] = []
    log_times: list[int] = []
    for log_time, data in zip(topic.log_times, topic.payloads, strict=True):
        try:
            messages.append(decoder(data))
        except SerdeError:
            continue
        log_times.append(log_time)
    lost = len(topic.payloads) - len(messages)
    remarks = [f"{topic.name}: {decoder.remark}"] if decoder.remark else []
    remarks += [f"{topic.name}: {lost} messages that do not decode were left out"] if lost else []
    logged = np.array(log_times, dtype=np.uint64).astype(np.int64)
    if not messages:
        return DecodedTopic(topic.name, logged, logged, 0, {name: np.empty(0) for name in fields}, tuple(remarks))
    getters = {name: field_getter(topic.name, path, messages[0]) for name, path in fields.items()}
    columns = {name: np.array([get(message) for message in messages]) for name, get in getters.items()}
    stamps = _header_stamps(messages)
    if stamps is None:
        return DecodedTopic(topic.name, logged, logged, 0, columns, tuple(remarks))
    return DecodedTopic(topic.name, stamps, logged, int(np.median(logged - stamps)), columns, tuple(remarks))


def _header_stamps(messages: Sequence[Any]) -> NDArray[np.int64] | None:
    """Stamps of the headers [ns]; None where the type has no header or its publisher never filled it in."""
    if not hasattr(getattr(messages[0], "header", None), "stamp"):
        return None
    stamps = [message.header.stamp for message in messages]
    nanoseconds = np.array([stamp.sec * 1_000_000_000 + stamp.nanosec for stamp in stamps], dtype=np.int64)
    return nanoseconds if nanoseconds.any() else None


def without_leaps(topics: Sequence[DecodedTopic]) -> tuple[list[DecodedTopic], tuple[str, ...]]:
    """Keep of all topics the stretch between two leaps of the stamps' clock that holds most, where it leapt.

    A clock that was set leaves every topic with samples of both sides; were each to choose for itself, position and
    pressure of different moments would meet.
    """
    edges = sorted({int(edge) for topic in topics if len(topic.logged) for edge in topic.logged[1:][_leaps(topic)]})
    if not edges:
        return list(topics), ()
    sides = [np.searchsorted(edges, topic.logged, side="right") for topic in topics]
    fullest = int(np.argmax(np.bincount(np.concatenate(sides), minlength=len(edges) + 1)))
    kept = []
    for topic, side in zip(topics, sides, strict=True):
        here = side == fullest
        columns = {name: values[here] for name, values in topic.columns.items()}
        stamps, logged = topic.stamps[here], topic.logged[here]
        lead = int(np.median(logged - stamps)) if len(stamps) else topic.lead
        kept.append(replace(topic, stamps=stamps, logged=logged, lead=lead, columns=columns))
    lost = sum(int(np.count_nonzero(side != fullest)) for side in sides)
    return kept, (f"the clock of the stamps leapt; {lost} messages before or after were left out",)


def _leaps(topic: DecodedTopic) -> NDArray[np.bool_]:
    """Before which messages, but the first, the stamps leap, and stay there, though the recorder's clock goes on."""
    steps, passed = np.diff(median_filter(topic.stamps, _LONE, mode="nearest")), np.diff(topic.logged)
    return np.asarray((passed >= 0) & ((steps < -_LEAP_BACK) | (steps - passed > LONGEST_GAP)))


def on_one_clock(topics: Sequence[DecodedTopic]) -> tuple[list[DecodedTopic], tuple[str, ...]]:
    """Shift every topic to the recorder's clock where their own clocks differ, as simulation and wall time do."""
    filled = [topic for topic in topics if len(topic.stamps)]
    leads = [topic.lead for topic in filled]
    if not leads or max(leads) - min(leads) <= _CLOCKS_DIFFER:
        return list(topics), ()
    apart = (max(leads) - min(leads)) / 1e9
    shifted = [replace(topic, stamps=topic.stamps + topic.lead, lead=0) for topic in topics]
    names = ", ".join(topic.name for topic in filled)
    return shifted, (f"the clocks of {names} lie up to {apart:.3g} s apart; their stamps were set by the log times",)
