"""CDR codecs compiled per type: fields of known size are packed and unpacked in one struct call.

XCDR1 with its 4-byte encapsulation header, alignment counted from behind it. Each run of neighbouring primitives
becomes eight precompiled structs, one per position modulo 8, with the padding inside the format.
"""

from __future__ import annotations

import array
import struct
import sys
from collections.abc import Callable
from functools import cache
from typing import Any, Literal

import numpy

from rclpy_dds.interfaces import store
from rclpy_dds.interfaces.definition import Definition, FieldType
from rclpy_dds.interfaces.message import NUMPY_TYPES, TYPE_CODES, checks_wanted, message_class

HEADER = b"\x00\x01\x00\x00"
_FORMATS = {**TYPE_CODES, "bool": "?", "byte": "c"}
_SIZES = {base: struct.calcsize(f"={code}") for base, code in _FORMATS.items()}
_PADDING = (b"", b"\0\0\0", b"\0\0", b"\0")
_SWAPPED = sys.byteorder == "big"


class MalformedSample(ValueError):
    """Serialised bytes that are not a message of the expected type."""


@cache
def encoder(name: str) -> Callable[[Any], bytes]:
    """Return a function from a message of type `name` to CDR bytes, header included, padded to four bytes."""
    source = _Source("<")
    source.line("def encode(m):")
    source.line(f" b = bytearray({HEADER!r})")
    _write_fields(source, store.message(name), "m", 1)
    source.flush_write(1)
    source.line(" b += _padding[len(b) & 3]")
    source.line(" return bytes(b)")
    return source.function("encode")


@cache
def decoder(name: str) -> Callable[[bytes], Any]:
    """Return a function from CDR bytes, header included, to a message of type `name`.

    The function raises MalformedSample when the bytes are too short or are no such message.
    """
    by_order = {}
    orders: tuple[Literal["<"], Literal[">"]] = ("<", ">")
    for order in orders:
        source = _Source(order)
        source.line("def decode(d, p=4):")
        _read_fields(source, store.message(name), "m", 1)
        source.flush_read(1)
        source.line(" return m")
        by_order[order] = source.function("decode")
    little, big = by_order["<"], by_order[">"]

    def decode(data: bytes) -> Any:
        try:
            return little(data) if data[1] & 1 else big(data)
        except (struct.error, ValueError, IndexError, OverflowError) as error:
            raise MalformedSample(f"{len(data)} bytes are no {name}: {error}") from error

    return decode


class _Source:
    """Python source under construction, with the run of primitives that is not yet written out."""

    def __init__(self, order: Literal["<", ">"]) -> None:
        self.order = order
        self.lines: list[str] = []
        self.run: list[tuple[str, str, int]] = []  # base, expression, count
        self.scope: dict[str, Any] = {
            "_padding": _PADDING, "array": array.array,
            "frombuffer": numpy.frombuffer, "asarray": numpy.ascontiguousarray,
            "MalformedSample": MalformedSample, "_checks": checks_wanted(), "_text": _text,
        }  # fmt: skip
        self.names = 0

    def name(self, prefix: str) -> str:
        self.names += 1
        return f"{prefix}{self.names}"

    def line(self, text: str) -> None:
        self.lines.append(text)

    def add(self, base: str, expression: str, count: int = 1) -> None:
        self.run.append((base, expression, count))

    def function(self, name: str) -> Any:
        exec("\n".join(self.lines), self.scope)
        return self.scope[name]

    def structs(self) -> list[struct.Struct]:
        """Return the current run as eight structs, index = absolute position modulo 8 (data begins at 4)."""
        made = []
        for start in range(8):
            position = start + 4
            codes: list[str] = [self.order]
            for base, _, count in self.run:
                size = _SIZES[base]
                pad = -position % size
                codes.append("x" * pad + (f"{count}{_FORMATS[base]}" if count > 1 else _FORMATS[base]))
                position += pad + size * count
            made.append(struct.Struct("".join(codes)))
        return made

    def flush_write(self, depth: int) -> None:
        if not self.run:
            return
        table = self.name("_w")
        self.scope[table] = tuple(item.pack for item in self.structs())
        values = ", ".join(f"*{e}" if count > 1 else e for _, e, count in self.run)
        self.line(f"{' ' * depth}b += {table}[len(b) & 7]({values})")
        self.run.clear()

    def flush_read(self, depth: int) -> None:
        if not self.run:
            return
        table, indent = self.name("_r"), " " * depth
        self.scope[table] = tuple((item.unpack_from, item.size) for item in self.structs())
        self.line(f"{indent}u, n = {table}[p & 7]")
        targets = ", ".join(expression for _, expression, _ in self.run)
        self.line(f"{indent}{targets}{',' if len(self.run) == 1 else ''} = u(d, p)")
        self.line(f"{indent}p += n")
        self.run.clear()

    def align(self, size: int, depth: int, *, write: bool) -> None:
        if size == 1:
            return
        if write:
            self.line(f"{' ' * depth}b += bytes(-(len(b) + 4) & {size - 1})")
        else:
            self.line(f"{' ' * depth}p += -(p + 4) & {size - 1}")


def _text(data: bytes) -> str:
    return data.decode("utf-8", "surrogateescape")


def _write_fields(source: _Source, definition: Definition, value: str, depth: int) -> None:
    if not definition.fields:
        source.add("uint8", "0")
    for field in definition.fields:
        expression = f"{value}._{field.name}"
        if not field.type.container:
            _write_one(source, field.type, expression, depth)
        elif field.type.base in TYPE_CODES:
            _write_numbers(source, field.type, expression, depth)
        else:
            _write_items(source, field.type, expression, depth)


def _write_one(source: _Source, kind: FieldType, expression: str, depth: int) -> None:
    indent = " " * depth
    if kind.is_message:
        inner = source.name("m")
        source.line(f"{indent}{inner} = {expression}")
        _write_fields(source, store.message(kind.base), inner, depth)
    elif kind.base == "string":
        text = source.name("s")
        source.line(f"{indent}{text} = {expression}.encode('utf-8', 'surrogateescape')")
        source.add("uint32", f"len({text}) + 1")
        source.flush_write(depth)
        source.line(f"{indent}b += {text}; b += b'\\0'")
    elif kind.base == "wstring":
        text = source.name("s")
        encoding = "utf-32-le"
        source.line(f"{indent}{text} = {expression}.encode({encoding!r})")
        source.add("uint32", f"len({text}) // 4")
        source.flush_write(depth)
        source.line(f"{indent}b += {text}")
    else:
        source.add(kind.base, expression)


def _write_numbers(source: _Source, kind: FieldType, expression: str, depth: int) -> None:
    indent = " " * depth
    if kind.container == "array":
        source.flush_write(depth)
        source.align(_SIZES[kind.base], depth, write=True)
        dtype = f"<{numpy.dtype(NUMPY_TYPES[kind.base]).str[1:]}"
        values = source.name("a")
        source.line(f"{indent}{values} = asarray({expression}, {dtype!r})")
        source.line(f"{indent}if {values}.size != {kind.size}:")
        problem = f"field {expression.rpartition('._')[2]} has {kind.size} elements, not %d"
        source.line(f"{indent} raise ValueError({problem!r} % {values}.size)")
        source.line(f"{indent}b += {values}.tobytes()")
        return
    source.add("uint32", f"len({expression})")
    source.flush_write(depth)
    source.line(f"{indent}if {expression}:")
    source.align(_SIZES[kind.base], depth + 1, write=True)
    source.line(f"{indent} b += {expression}.tobytes()")


def _write_items(source: _Source, kind: FieldType, expression: str, depth: int) -> None:
    indent, item = " " * depth, source.name("i")
    if kind.container == "sequence":
        source.add("uint32", f"len({expression})")
    source.flush_write(depth)
    source.line(f"{indent}for {item} in {expression}:")
    _write_one(source, FieldType(kind.base), item, depth + 1)
    source.flush_write(depth + 1)


def _read_fields(source: _Source, definition: Definition, target: str, depth: int) -> None:
    cls = source.name("_c")
    source.scope[cls] = message_class(definition.name)
    source.line(f"{' ' * depth}{target} = {cls}.__new__({cls}); {target}._check_fields = _checks")
    if not definition.fields:
        source.add("uint8", "_")
    for field in definition.fields:
        expression = f"{target}._{field.name}"
        if not field.type.container:
            _read_one(source, field.type, expression, depth)
        elif field.type.base in TYPE_CODES:
            _read_numbers(source, field.type, expression, depth)
        else:
            _read_items(source, field.type, expression, depth)


def _read_one(source: _Source, kind: FieldType, target: str, depth: int) -> None:
    indent = " " * depth
    if kind.is_message:
        inner = source.name("m")
        # The nested object is bound first: a run may go on across its fields.
        _read_fields(source, store.message(kind.base), inner, depth)
        source.line(f"{indent}{target} = {inner}")
    elif kind.base in ("string", "wstring"):
        source.add("uint32", "k")
        source.flush_read(depth)
        source.line(f"{indent}e = p + k{' * 4' if kind.base == 'wstring' else ''}")
        source.line(f"{indent}if e > len(d): raise MalformedSample('a string reaches past the end')")
        if kind.base == "string":
            source.line(f"{indent}{target} = _text(d[p:e - 1]) if k else ''")
        else:
            source.line(f"{indent}{target} = d[p:e].decode('utf-32-{'le' if source.order == '<' else 'be'}')")
        source.line(f"{indent}p = e")
    else:
        source.add(kind.base, target)


def _read_numbers(source: _Source, kind: FieldType, target: str, depth: int) -> None:
    indent, size = " " * depth, _SIZES[kind.base]
    if kind.container == "array":
        source.flush_read(depth)
        source.align(size, depth, write=False)
        dtype = numpy.dtype(NUMPY_TYPES[kind.base])
        wire = dtype.newbyteorder(source.order).str
        convert = ".copy()" if wire in (dtype.str, dtype.newbyteorder("=").str) else f".astype({dtype.name!r})"
        source.line(f"{indent}{target} = frombuffer(d, {wire!r}, {kind.size}, p){convert}")
        source.line(f"{indent}p += {kind.size * size}")
        return
    source.add("uint32", "k")
    source.flush_read(depth)
    source.line(f"{indent}{target} = a = array({TYPE_CODES[kind.base]!r})")
    source.line(f"{indent}if k:")
    source.align(size, depth + 1, write=False)
    source.line(f"{indent} e = p + k * {size}")
    source.line(f"{indent} if e > len(d): raise MalformedSample('a sequence reaches past the end')")
    source.line(f"{indent} a.frombytes(d[p:e]); p = e")
    if size > 1 and (source.order == ">") != _SWAPPED:
        source.line(f"{indent} a.byteswap()")


def _read_items(source: _Source, kind: FieldType, target: str, depth: int) -> None:
    indent, items, count = " " * depth, source.name("l"), source.name("k")
    if kind.container == "sequence":
        source.add("uint32", count)
        source.flush_read(depth)
    else:
        source.flush_read(depth)
        source.line(f"{indent}{count} = {kind.size}")
    # Every element takes at least a byte, so a count beyond the data is malformed and must not allocate.
    source.line(f"{indent}if {count} > len(d): raise MalformedSample('a sequence reaches past the end')")
    source.line(f"{indent}{target} = {items} = []")
    source.line(f"{indent}for _ in range({count}):")
    _read_one(source, FieldType(kind.base), "v", depth + 1)
    source.flush_read(depth + 1)
    source.line(f"{indent} {items}.append(v)")
