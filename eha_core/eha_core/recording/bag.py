"""Opens files of recorded messages: an .mcap file, a rosbag2 folder with one or more files, or a .db3 file."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import quote

import apsw
from rosbags.rosbag2 import Reader
from rosbags.rosbag2.errors import ReaderError

from eha_core.errors import RecordingError
from eha_core.recording.compressed import ENDING, plain_file, unpacking
from eha_core.recording.mcap_file import mcap_topics, read_mcap
from eha_core.recording.mcap_summary import mcap_extent, mcap_metadata
from eha_core.recording.raw import RawRecording, RawTopic, Sinks
from eha_core.recording.unpacking import Ceiling
from eha_core.yaml_file import load_yaml

_READ_ONLY = apsw.SQLITE_OPEN_READONLY | apsw.SQLITE_OPEN_URI
_COMPUTED = re.compile(r"generated\s+always|\bas\s*\(|\bvirtual\s+table\b", re.IGNORECASE)
_ENDINGS = ("*.mcap", "*.db3", f"*.mcap{ENDING}", f"*.db3{ENDING}")
_Read = TypeVar("_Read")
_ROW = 32  # bytes of a row in addition to its message


def bag_topics(path: Path) -> dict[str, RawTopic]:
    """The topics of a file or a folder by name.

    Raises:
        RecordingError: there is nothing that can be read.
    """
    if not path.is_dir():
        return _topics_of_file(path)
    files = _files_of(path)
    topics: dict[str, RawTopic] = {}
    for file in files:
        try:
            topics = {**_topics_of_file(file), **topics}
        except RecordingError:
            if len(files) == 1:
                raise
    return topics


def read_bag(path: Path, sinks: Sinks) -> RawRecording:
    """Read the messages of the topics that `sinks` names from a file or a folder.

    Raises:
        RecordingError: there is nothing that can be read.
    """
    plain = unpacking(sinks, str(path), bag_size(path))
    if path.is_dir():
        return _read_files(path, _files_of(path), plain)
    return _read_file(path, plain)


def bag_extent(path: Path) -> float | None:
    """Time from the first to the last message [s], where the files state it without being read."""
    extents = []
    for file in _files_of(path) if path.is_dir() else [path]:
        if file.suffix in (".db3", ENDING) or not file.is_file():
            return None
        extents.append(mcap_extent(file))
    known = [extent for extent in extents if extent is not None]
    if len(known) < len(extents) or not known:
        return None
    return (max(last for _, last in known) - min(first for first, _ in known)) / 1e9


def bag_size(path: Path) -> int:
    """Bytes of a file, or of all files of a folder."""
    return sum(file.stat().st_size for file in (_files_of(path) if path.is_dir() else [path]) if file.is_file())


def bag_metadata(path: Path) -> dict[str, dict[str, str]]:
    """The metadata records of a file or a folder that are accessible without reading the messages."""
    found: dict[str, dict[str, str]] = {}
    for file in _files_of(path) if path.is_dir() else [path]:
        if file.suffix not in (".db3", ENDING) and file.is_file():
            for name, values in mcap_metadata(file).items():
                found.setdefault(name, {}).update(values)
    return found


def _topics_of_file(path: Path) -> dict[str, RawTopic]:
    return _of_file(path, lambda file: _read_sqlite(file, {}).topics if file.suffix == ".db3" else mcap_topics(file))


def _read_file(path: Path, sinks: Sinks) -> RawRecording:
    return _of_file(path, lambda file: _read_sqlite(file, sinks) if file.suffix == ".db3" else read_mcap(file, sinks))


def _of_file(path: Path, read: Callable[[Path], _Read]) -> _Read:
    """What `read` returns of a file, or of its uncompressed copy; messages name the file that was given."""
    plain = plain_file(path)
    try:
        return read(plain)
    except RecordingError as error:
        if plain == path:
            raise
        raise RecordingError(str(error).replace(str(plain), str(path))) from error


def _files_of(folder: Path) -> list[Path]:
    """The files of a rosbag2 folder in order: those in metadata.yaml; without it, those that differ by number."""
    description = folder / "metadata.yaml"
    if description.is_file():
        try:
            content: Any = load_yaml(description, RecordingError, str(description))
            listed = [str(name) for name in content["rosbag2_bagfile_information"]["relative_file_paths"]]
        except (KeyError, TypeError, RecordingError) as error:
            what = str(error) if isinstance(error, RecordingError) else f"{description}: lists no files"
            raise RecordingError(f"{what}; remove it to read the folder's .mcap files by their names") from None
        outside = next((name for name in listed if Path(name).is_absolute() or ".." in Path(name).parts), None)
        if outside is not None:
            raise RecordingError(f"{description}: lists {outside}, which is not in its folder; name the file itself")
        return [folder / name for name in listed]
    files = sorted((file for ending in _ENDINGS for file in folder.glob(ending)), key=_numbered)
    if len({re.sub(r"_\d+$", "", _stem(file)) for file in files}) > 1:
        names = ", ".join(file.name for file in files)
        raise RecordingError(f"{folder}: holds several recordings ({names}); name one of them")
    if not files:
        raise RecordingError(f"{folder}: holds no recording (.mcap, .db3); name a file or a rosbag2 folder")
    return files


def _stem(file: Path) -> str:
    return file.name.partition(".")[0]


def _numbered(file: Path) -> tuple[int, str]:
    match = re.search(r"_(\d+)$", _stem(file))
    return (int(match[1]) if match else -1, file.name)


def _read_files(folder: Path, files: list[Path], sinks: Sinks) -> RawRecording:
    whole = RawRecording()
    for file in files:
        try:
            part = _read_file(file, sinks)
        except RecordingError as error:
            if len(files) == 1:
                raise
            whole.damage.append(str(error).removeprefix(f"{folder}/"))
            continue
        whole.damage += [f"{file.name}: {damage}" for damage in part.damage]
        for name, values in part.metadata.items():
            whole.metadata.setdefault(name, {}).update(values)
        for name, topic in part.topics.items():
            whole.topics.setdefault(name, topic)
        for name, count in part.counts.items():
            whole.counts[name] = whole.counts.get(name, 0) + count
    return whole


def _read_sqlite(path: Path, sinks: Sinks) -> RawRecording:
    recording = RawRecording()
    read = 0
    try:
        ceiling = Ceiling(str(path), path.stat().st_size)
        _refuse_programs(path)
        with Reader(path) as reader:
            for connection in reader.connections:
                definition = connection.msgdef
                if not all(isinstance(text, str) for text in (connection.topic, connection.msgtype, definition.data)):
                    raise ValueError("a topic has no name or no type")
                encoding = f"ros2{definition.format.name.lower()}"
                recording.topics[connection.topic] = RawTopic(
                    connection.topic, connection.msgtype, encoding, definition.data
                )
                recording.counts[connection.topic] = connection.msgcount
            connections = [connection for connection in reader.connections if connection.topic in sinks]
            for connection, log_time, data in reader.messages(connections) if connections else ():
                if not isinstance(log_time, int):
                    raise ValueError(f"a message on {connection.topic} has no stamp")
                ceiling.take(len(data) + _ROW)
                sinks[connection.topic].add(log_time, bytes(data))
                read += 1
    except FileNotFoundError:
        raise RecordingError(f"{path}: there is no such file") from None
    except (ReaderError, apsw.Error, OSError, ValueError, TypeError, LookupError, AttributeError) as error:
        if not read:
            raise RecordingError(f"{path}: cannot be read as a rosbag2 file ({error})") from error
        recording.damage.append(f"reading stopped at a damaged place ({error})")
    return recording


def _refuse_programs(path: Path) -> None:
    """Raise RecordingError for a database that computes values (views, triggers and the like), perhaps without end."""
    connection = apsw.Connection(f"file:{quote(str(path))}?immutable=1", flags=_READ_ONLY)
    try:
        for name, kind, definition in connection.execute("SELECT name, type, sql FROM sqlite_master"):
            if kind in ("view", "trigger") or _COMPUTED.search(str(definition)):
                raise RecordingError(f"{path}: its {kind} {name} computes values, which no recording does")
    finally:
        connection.close()
