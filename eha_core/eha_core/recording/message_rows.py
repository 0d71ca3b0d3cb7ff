"""Serialises many messages of one layout at once: a byte pattern in which only some numbers change."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype

from eha_core.recording.message_types import encode, require_type

_STAMP_FIELDS = ("sec", "nanosec")
# No byte of these numbers is zero, so a field shows where its bytes lie by what differs from zero.
_MARK = {"<f8": float(np.frombuffer(b"\x01" * 8, "<f8")[0]), "<u4": 0x01010101}


def encode_rows(
    type_name: str, columns: Mapping[str, NDArray[np.float64]], stamps: NDArray[np.int64] | None = None, **fixed: Any
) -> list[bytes]:
    """Serialise one message for each row of `columns`.

    Args:
        type_name: "package/msg/Name".
        columns: numbers by field; a field that is a sequence of floats gets them as its only element.
        stamps: header stamps [ns], for a type with a header.
        fixed: fields that are the same in every message.
    """
    single = {name for name in columns if _is_sequence(type_name, name)}
    zero: dict[str, Any] = {**fixed, **{name: [0.0] if name in single else 0.0 for name in columns}}
    pattern = encode(type_name, zero)
    count = len(next(iter(columns.values())))
    rows = np.tile(np.frombuffer(pattern, np.uint8), (count, 1))

    def fill(kind: str, marked: Mapping[str, Any], numbers: NDArray[Any]) -> None:
        place = _first_difference(pattern, encode(type_name, marked))
        encoded = np.ascontiguousarray(numbers.astype(kind)).view(np.uint8).reshape(count, -1)
        rows[:, place : place + encoded.shape[1]] = encoded

    for name, numbers in columns.items():
        fill("<f8", {**zero, name: [_MARK["<f8"]] if name in single else _MARK["<f8"]}, numbers)
    if stamps is not None:
        header = dict(fixed.get("header", {}))
        for name, numbers in zip(_STAMP_FIELDS, np.divmod(stamps, 1_000_000_000), strict=True):
            fill("<u4", {**zero, "header": {**header, "stamp": {name: _MARK["<u4"]}}}, numbers)
    data, length = rows.tobytes(), rows.shape[1]
    return [data[start : start + length] for start in range(0, len(data), length)]


def _is_sequence(type_name: str, field: str) -> bool:
    kinds = dict(require_type(type_name).fielddefs[type_name][1])
    return kinds[field][0] == Nodetype.SEQUENCE


def _first_difference(pattern: bytes, other: bytes) -> int:
    return int(np.flatnonzero(np.frombuffer(pattern, np.uint8) != np.frombuffer(other, np.uint8))[0])
