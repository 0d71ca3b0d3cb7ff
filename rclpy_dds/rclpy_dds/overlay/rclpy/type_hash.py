"""Hashes of types."""

from __future__ import annotations


class TypeHash:
    """The hash of a type: version and 32 bytes."""

    __slots__ = ("version", "value")

    def __init__(self, version: int = -1, value: bytes = bytes(32)) -> None:
        self.version = version
        self.value = value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TypeHash) and (self.version, self.value) == (other.version, other.value)

    def __hash__(self) -> int:
        return hash((self.version, self.value))

    def __str__(self) -> str:
        return "INVALID" if self.version <= 0 else f"RIHS{self.version:02d}_{self.value.hex()}"

    def __repr__(self) -> str:
        return f"TypeHash(version={self.version}, value={self.value!r})"
