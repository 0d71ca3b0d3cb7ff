"""Compressed chunks: what they unpack to, and how far they may."""

from __future__ import annotations

import lz4.frame
import pytest
import zstandard
from mcap.records import Chunk

from eha_core.errors import RecordingError
from eha_core.recording import unpacking
from eha_core.recording.unpacking import Ceiling, unpacked, unpacked_start

CONTENT = bytes(range(256)) * 40
PACKED = {"": CONTENT, "zstd": zstandard.compress(CONTENT), "lz4": lz4.frame.compress(CONTENT)}


def chunk(compression: str, data: bytes | None = None, size: int = len(CONTENT)) -> Chunk:
    data = PACKED[compression] if data is None else data
    return Chunk(
        compression=compression, data=data, message_start_time=0, message_end_time=0, uncompressed_crc=0,
        uncompressed_size=size,
    )  # fmt: skip


@pytest.mark.parametrize("compression", list(PACKED))
def test_a_chunk_gives_its_records_and_no_more_than_was_asked(compression: str) -> None:
    assert unpacked(chunk(compression), Ceiling("run", 0)) == CONTENT
    for most in (1, 255, len(CONTENT) - 1):
        assert unpacked_start(chunk(compression), most) == CONTENT[:most]


@pytest.mark.parametrize("compression", list(PACKED))
@pytest.mark.parametrize("wrong", [-1, 1])
def test_a_chunk_of_another_size_than_it_says_is_none(compression: str, wrong: int) -> None:
    with pytest.raises(ValueError, match="has another size than it says"):
        unpacked(chunk(compression, size=len(CONTENT) + wrong), Ceiling("run", 0))


def test_a_cut_chunk_gives_what_comes_before_the_cut() -> None:
    import random

    content = random.Random(1).randbytes(400_000)
    found = unpacked_start(chunk("zstd", zstandard.compress(content)[:300_000]), 10**6)
    assert 100_000 < len(found) < 400_000 and content.startswith(found)


def test_a_chunk_is_64_mib_at_most() -> None:
    with pytest.raises(ValueError, match="a chunk of that size is a damaged length"):
        unpacked(chunk("", b"", 64 * 2**20 + 1), Ceiling("run", 2**20))
    with pytest.raises(ValueError, match="has another size than it says"):
        unpacked(chunk("", b"", 64 * 2**20), Ceiling("run", 2**20))


def test_chunks_count_against_the_file_s_ceiling(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(unpacking, "ROOM", 2 * len(CONTENT))
    ceiling = Ceiling("run", 0)
    for _ in range(2):
        assert unpacked(chunk("zstd"), ceiling) == CONTENT
    with pytest.raises(RecordingError, match="run: unpacks to more than 0 MB"):
        unpacked(chunk("zstd"), ceiling)


def test_another_packing_is_said() -> None:
    with pytest.raises(ValueError, match="compression 'rar' is not known"):
        unpacked_start(chunk("rar", b"abc"), 10)
