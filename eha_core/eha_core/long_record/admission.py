"""The way into a diagnosis for records of any length: what of each is fitted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from eha_core.errors import RecordingError
from eha_core.long_record import limits
from eha_core.plant import Composition, composition_of
from eha_core.recording import Recording, TopicsFile, read_recording, topics_of
from eha_core.recording.bag import bag_extent, bag_size
from eha_core.recording.blocks import Block, Blocks, BlocksInMemory, BlocksOfFile
from eha_core.tables import is_table

Progress = Callable[[str], None]

READ_AT_ONCE = 2**26
"""Bytes of a file that does not say how long it is, up to which it is read to find out: its numbers take about as much
memory again (assumed)."""


@dataclass(frozen=True)
class Admitted:
    """A record as it goes into a diagnosis.

    Attributes:
        path: the record's.
        recordings: what is fitted: the record itself, or stretches of it.
        blocks: the whole record, where stretches are fitted.
        chosen: the numbers of their blocks.
        spans: when they begin and end [s].
    """

    path: Path
    recordings: tuple[Recording, ...]
    blocks: Blocks | None = None
    chosen: tuple[int, ...] = ()
    spans: tuple[tuple[float, float], ...] = ()

    @property
    def damaged(self) -> bool:
        """Whether only a part of the record could be read."""
        if self.blocks is not None:
            return self.blocks.damaged is not None
        return any(recording.damaged for recording in self.recordings)


def admitted(
    given: Recording | str | Path,
    topics: str | Path | TopicsFile | None = None,
    composition: Composition | None = None,
    progress: Progress = lambda _: None,
) -> Admitted:
    """Read a recording; of one longer than LONGEST_WHOLE the stretches that show most of it, and no more.

    Args:
        given: a recording, or the path of one.
        topics: a topics file.
        composition: the actuator's parts; None: those that the recording carries, else the paper's.
        progress: receives how far a long record was read.

    Raises:
        RecordingError: as `read_recording`.
        ParameterError: a long recording carries parts that there are not.
    """
    if isinstance(given, Recording):
        return _of_recording(given, composition, progress)
    path = Path(given)
    if _is_long_file(path):
        file = BlocksOfFile(path, topics_of(topics), limits.STRETCH)
        found = _stretches(file, composition, progress)
        if found is not None:
            return found
    return _of_recording(read_recording(path, topics), composition, progress)


def _is_long_file(path: Path) -> bool:
    """Whether a file of messages is known to hold a long record, or might and is too large to be read at once."""
    if not path.exists() or not (path.is_file() or path.is_dir()) or is_table(path):
        return False
    extent = bag_extent(path)
    return bag_size(path) > READ_AT_ONCE if extent is None else extent > limits.LONGEST_WHOLE


def _of_recording(recording: Recording, composition: Composition | None, progress: Progress) -> Admitted:
    if recording.duration > limits.LONGEST_WHOLE:
        found = _stretches(BlocksInMemory(recording, limits.STRETCH), composition, progress)
        if found is not None:
            return found
    return Admitted(recording.path, (recording,))


def _stretches(blocks: Blocks, composition: Composition | None, progress: Progress) -> Admitted | None:
    """The stretches to fit; None where the record is short after all, or nothing in it can be used."""
    # the fits' room loads slowly, and most records are short
    from eha_core.long_record.choose import choose
    from eha_core.long_record.survey import Shown, shown

    seen: list[Shown] = []

    def survey(block: Block) -> None:
        if block.recording is None or block.end - block.start <= 0.99 * limits.STRETCH:
            return
        parts = composition or composition_of(block.recording.parts)
        if (found := shown(block, parts)) is not None:
            seen.append(found)

    blocks.each(survey, progress=progress)
    if blocks.duration <= limits.LONGEST_WHOLE or not seen:
        return None
    chosen = choose(seen, limits.STRETCHES)
    cut: list[Recording] = []

    def keep(block: Block) -> None:
        if block.recording is None:
            raise RecordingError(block.problem)
        cut.append(block.recording)

    blocks.each(keep, frozenset(chosen), progress)
    spans = tuple((block.start, block.end) for block in seen if block.number in chosen)
    return Admitted(blocks.path, tuple(cut), blocks, tuple(chosen), spans)
