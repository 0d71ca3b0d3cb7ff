"""The byte offsets of a CDR message's numbers: read from one message, valid for all others of the same structure."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.typesys.store import Typestore

ENCAPSULATION = 4
"""Bytes before the fields; alignment counts from their end, and the second is the byte order."""
MOST_PARTS = 2**14
"""Most numbers, sequences and texts of a message; a robot's whole introspection has 1,000."""
_KINDS = {
    "bool": "u1", "byte": "u1", "octet": "u1", "char": "u1", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2",
    "int32": "i4", "uint32": "u4", "int64": "i8", "uint64": "u8", "float32": "f4", "float64": "f8",
}  # fmt: skip


@dataclass(frozen=True)
class Run:
    """Adjacent numbers of one kind; `count` is None for a field that is one number."""

    offset: int
    kind: str
    count: int | None

    @property
    def size(self) -> int:
        """Bytes of one number."""
        return int(self.kind[-1])


@dataclass
class Layout:
    """The structure of a message.

    Attributes:
        length: bytes of the message.
        runs: its numbers by path, such as `header.stamp.sec`, `position` or `statistics[3].value`.
        texts: its texts by path, such as `name[0]`.
        elements: how many elements each sequence of parts has, by path.
        marks: places of the bytes with the lengths of texts and sequences: if two messages agree in these, and in their
            own length, the layout is valid for both.
        spans: first and last byte of each text by path.
    """

    length: int
    runs: dict[str, Run] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)
    elements: dict[str, int] = field(default_factory=dict)
    marks: list[int] = field(default_factory=lambda: [1])
    spans: dict[str, tuple[int, int]] = field(default_factory=dict)


def layout_of(store: Typestore, type_name: str, data: bytes) -> Layout:
    """The layout of a message of a type that `store` knows.

    Raises:
        ValueError: the bytes are not such a message, or it has too many parts.
    """
    walk = _Walk(store.fielddefs, data)
    try:
        walk.fields(type_name, "")
    except (struct.error, LookupError, UnicodeDecodeError, TypeError) as error:
        raise ValueError(f"no {type_name} ({error})") from error
    # A message may be padded to four bytes; anything longer is of another type.
    if not walk.position <= len(data) < walk.position + 4:
        raise ValueError(f"no {type_name}: {len(data)} bytes, of which it takes {walk.position}")
    return walk.layout


class _Walk:
    """One pass through a message, field by field."""

    def __init__(self, definitions: Mapping[str, Any], data: bytes) -> None:
        self.layout = Layout(len(data))
        self.position = ENCAPSULATION
        self._definitions = definitions
        self._data = data
        self._order = "<" if data[1:2] != b"\0" else ">"

    def fields(self, type_name: str, prefix: str) -> None:
        for name, description in self._definitions[type_name][1]:
            self._field(description, f"{prefix}{name}")

    def _field(self, description: Any, path: str) -> None:
        kind, detail = description
        if kind == Nodetype.NAME:
            self.fields(detail, f"{path}.")
        elif kind == Nodetype.BASE:
            self._base(detail[0], path, None)
        else:
            element, count = detail
            self._many(element, self._length_word() if kind == Nodetype.SEQUENCE else count, path)

    def _many(self, element: Any, count: int, path: str) -> None:
        if element[0] == Nodetype.BASE and element[1][0] not in ("string", "wstring"):
            self._base(element[1][0], path, count)
            return
        if count > MOST_PARTS:
            raise ValueError(f"{path} has {count} elements")
        self.layout.elements[path] = count
        for index in range(count):
            self._field(element, f"{path}[{index}]")

    def _base(self, name: str, path: str, count: int | None) -> None:
        if len(self.layout.runs) + len(self.layout.texts) >= MOST_PARTS:
            raise ValueError(f"more than {MOST_PARTS} parts")
        if name == "string":
            self._text(path)
            return
        kind = _KINDS[name]
        size = int(kind[-1])
        if count != 0:
            self._align(size)
        run = Run(self.position, self._order + kind, count)
        self._take(size * (1 if count is None else count))
        self.layout.runs[path] = run

    def _text(self, path: str) -> None:
        length = self._length_word()
        start = self.position
        self._take(length)
        self.layout.texts[path] = self._data[start : start + max(length - 1, 0)].decode("utf-8")
        self.layout.spans[path] = (start, self.position)

    def _length_word(self) -> int:
        self._align(4)
        word = self.position
        self._take(4)
        self.layout.marks += range(word, word + 4)
        return int(struct.unpack_from(f"{self._order}I", self._data, word)[0])

    def _align(self, size: int) -> None:
        self.position += -(self.position - ENCAPSULATION) % size

    def _take(self, count: int) -> None:
        self.position += count
        if self.position > len(self._data):
            raise ValueError("the message ends early")
