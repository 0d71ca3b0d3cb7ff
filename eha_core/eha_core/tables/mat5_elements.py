"""Checks the elements of a version 5 MAT file before SciPy reads them, because SciPy trusts the sizes that they state.

The format is public (MathWorks, "MAT-File Format"): each element is a type, a size and that many bytes; a matrix is an
element of elements, and cells and structures contain matrices.
"""

from __future__ import annotations

import struct
import zlib
from math import prod

HEAD = 128
ROOM = 2**25
"""Bytes that any file may decompress to ..."""
LARGEST_RATIO = 100
"""... and bytes for each byte of a larger one: a rig at rest, every sample the same, compresses to 1/100 with zlib."""
DEEPEST = 20
"""Most levels of nested cells and structures; a logged Simulink data set has six."""
MOST_DIMENSIONS = 8
"""Most dimensions of a matrix; the fewest are two, because SciPy reads past the end of one without any."""
_MATRIX, _COMPRESSED = 14, 15
_CELL, _STRUCTURE, _OBJECT, _CHARACTERS, _SPARSE = 1, 2, 3, 4, 5
_LAST_NUMERIC = 15
_BYTES, _WORDS, _COUNTS = (1, 2, 16), (6,), (5,)
_NUMBERS, _TEXTS = (1, 2, 3, 4, 5, 6, 7, 9, 12, 13), (1, 2, 3, 4, 16, 17, 18)
"""Types of elements that names, flags, sizes, numbers and texts may have; SciPy takes others for a memory address."""
_IS_COMPLEX = 0x800


class NoNumbers(ValueError):
    """A variable is an object, a table or a function handle, from which SciPy reads no numbers."""


def unpacked(content: bytes) -> tuple[bytes, int]:
    """A file's content with its variables decompressed and every stated size verified.

    Variables without numbers are omitted; their count is the second value.

    Raises:
        ValueError: an element states more than it has, or the file decompresses to more than its size allows.
    """
    if len(content) < HEAD:
        raise ValueError("its header is cut")
    order = ">" if content[126:128] == b"MI" else "<"
    left = ROOM + LARGEST_RATIO * len(content)
    parts, position, left_out = [content[:HEAD]], HEAD, 0
    while position + 8 <= len(content):
        kind, start, size, after = _element(order, content, position, len(content))
        part = content[position:after]
        if kind == _COMPRESSED:
            # Compressed elements are not padded.
            after = start + size
            part = _inflated(content[start:after], left)
            left -= len(part)
        if len(part) >= 8:
            inner, first, length, _ = _element(order, part, 0, len(part))
            try:
                if inner == _MATRIX:
                    _check(order, part[first : first + length], DEEPEST)
                parts.append(part)
            except NoNumbers:
                left_out += 1
        position = after
    return b"".join(parts), left_out


def _inflated(data: bytes, most: int) -> bytes:
    unpacker = zlib.decompressobj()
    found = unpacker.decompress(data, max(most, 1))
    if unpacker.unconsumed_tail:
        raise ValueError("it unpacks to more than a file of its size may; keep fewer variables")
    return found


def _element(order: str, data: bytes, position: int, end: int) -> tuple[int, int, int, int]:
    """An element's type, first byte, size, and the byte after it. Raises ValueError where it exceeds the end."""
    if position + 8 > end:
        raise ValueError("an element is cut")
    word, size = struct.unpack_from(f"{order}II", data, position)
    if word >> 16:
        # A small element has its type and size in one word, and its data in the other.
        kind, size, start, after = word & 0xFFFF, word >> 16, position + 4, position + 8
        if size > 4:
            raise ValueError("a small element is too large")
        return kind, start, size, after
    start = position + 8
    if start + size > end:
        raise ValueError("an element claims more than the file holds")
    return word, start, size, min(start + size + (-size % 8), end)


def _check(order: str, data: bytes, levels: int) -> None:
    """Raise ValueError where a matrix states more elements than it has bytes for."""
    if not data:
        return
    if not levels:
        raise ValueError("cells and structures are nested too deep")
    start, size, position = _typed(order, data, 0, _WORDS)
    if size != 8:
        raise ValueError("a matrix has no flags")
    flags = struct.unpack_from(f"{order}I", data, start)[0]
    kind = flags & 0xFF
    if not (_CELL <= kind <= _LAST_NUMERIC) or kind == _SPARSE:
        raise NoNumbers("an object, a table, a function handle or a sparse matrix")
    start, size, position = _typed(order, data, position, _COUNTS)
    shape = struct.unpack_from(f"{order}{size // 4}i", data, start)
    if not 2 <= len(shape) <= MOST_DIMENSIONS or min(shape) < 0:
        raise ValueError("a matrix has no shape")
    count = prod(shape)
    _, _, position = _typed(order, data, position, _BYTES)  # its name
    if kind in (_CELL, _STRUCTURE, _OBJECT):
        fields, position = _fields(order, data, position, kind)
        _check_parts(order, data, position, count * fields, levels)
        return
    for _ in range(2 if flags & _IS_COMPLEX else 1):
        _, size, position = _typed(order, data, position, _TEXTS if kind == _CHARACTERS else _NUMBERS)
        if count > size:
            raise ValueError("a matrix claims more numbers than it holds")


def _typed(order: str, data: bytes, position: int, kinds: tuple[int, ...]) -> tuple[int, int, int]:
    """First byte and size of an element of one of these types, and the byte after it."""
    kind, start, size, after = _element(order, data, position, len(data))
    if kind not in kinds:
        raise ValueError(f"an element of type {kind} stands where none can")
    return start, size, after


def _fields(order: str, data: bytes, position: int, kind: int) -> tuple[int, int]:
    """The number of matrices in each element, and the place of the first."""
    if kind == _CELL:
        return 1, position
    if kind == _OBJECT:
        _, _, position = _typed(order, data, position, _BYTES)  # the name of its class
    start, size, position = _typed(order, data, position, _COUNTS)
    length = struct.unpack_from(f"{order}i", data, start)[0] if size >= 4 else 0
    start, size, position = _typed(order, data, position, _BYTES)
    names = [data[first : first + length] for first in range(start, start + size, length)] if length > 0 else []
    # Each name has `length` bytes, the last a zero: reading would not stop otherwise.
    if (size and length <= 0) or not all(len(name) == length and name[-1] == 0 for name in names):
        raise ValueError("a structure's fields have no names")
    return len(names), position


def _check_parts(order: str, data: bytes, position: int, count: int, levels: int) -> None:
    if 8 * count > len(data) - position:
        raise ValueError("an array claims more elements than it holds")
    for _ in range(count):
        kind, start, size, position = _element(order, data, position, len(data))
        if kind != _MATRIX:
            raise ValueError("an array holds what is no matrix")
        _check(order, data[start : start + size], levels - 1)
