"""The kinds of files that cannot be read, recognised by their begin, and what to do with them."""

from __future__ import annotations

import re
from pathlib import Path

from eha_core.errors import RecordingError

READABLE = (
    ".mcap, .db3 and rosbag2 folders; text tables (.csv, .tsv, .txt, .dat, .asc, .lvm); .mat; .h5; .parquet; .xlsx;"
    " .tdms; .mf4 and .mdf; .jsonl and .json"
)
"""The readable kinds of files, as messages list them."""
_HEAD = 4096
_DECODE = (
    "export its decoded signals as CSV, or its frames as MDF (.mf4), which is read with the network's database (.dbc)"
    " beside it"
)
_BY_BYTES: tuple[tuple[bytes, str, str], ...] = (
    (b"LOGG", "a Vector CAN log (BLF) of raw frames", _DECODE),
    (b"#ROSBAG V", "a bag of ROS 1", "convert it with `rosbags-convert --src FILE --dst FOLDER`"),
    (b"\xd0\xcf\x11\xe0", "an old workbook (.xls)", "save it as .xlsx or .csv"),
    (b"7z\xbc\xaf\x27\x1c", "an archive", "unpack it"),
    (b"Rar!", "an archive", "unpack it"),
    (b"\x1f\x8b", "a packed file (gzip)", "unpack it"),
    (b"\x28\xb5\x2f\xfd", "a packed file (zstd)", "unpack it, or name its folder if it is a rosbag2"),
    (b"ULog", "a flight log of PX4", "convert it with `ulog2csv`"),
    (b"%PDF", "a document", "export the numbers as CSV"),
)
_BY_TEXT: tuple[tuple[re.Pattern[str], str, str], ...] = (
    (
        re.compile(r"^\s*base\s+(hex|dec)\s+timestamps\s+(absolute|relative)", re.MULTILINE | re.IGNORECASE),
        "a Vector CAN log (ASC) of raw frames",
        _DECODE,
    ),
    (re.compile(r"^;\$FILEVERSION=|^;.*PCAN", re.MULTILINE), "a PCAN trace of raw frames", _DECODE),
    (re.compile(r"^\(\d+\.\d+\)\s+v?can\w*\s+[0-9A-Fa-f]+#", re.MULTILINE), "a candump log of raw frames", _DECODE),
    (re.compile(r"^\s*v?can\d+\s+[0-9A-Fa-f]{3,8}\s+\[\d\]", re.MULTILINE), "a candump log of raw frames", _DECODE),
    (re.compile(r"\bID\b.*\bDLC\b|\bArbitration ?ID\b|\bCAN ?ID\b", re.IGNORECASE), "a log of raw CAN frames", _DECODE),
    (
        re.compile(r"^\s*(VERSION\s+\"|BO_ \d+ )", re.MULTILINE),
        "a data base of CAN signals (DBC)",
        "name the recording",
    ),
    (re.compile(r"^\s*<(\?xml|html|!doctype)", re.IGNORECASE), "markup (XML or HTML)", "export the numbers as CSV"),
    (
        re.compile(r"^channels:|^rosbag2_bagfile_information:", re.MULTILINE),
        "a YAML file",
        "name the recording it belongs to",
    ),
)


def refuse_other_kinds(path: Path) -> None:
    """Raise RecordingError for a known kind of file without columns of numbers, with its kind and the remedy."""
    with path.open("rb") as file:
        head = file.read(_HEAD)
    for start, what, remedy in _BY_BYTES:
        if head.startswith(start):
            raise RecordingError(f"{path}: is {what}; {remedy}. Can be read: {READABLE}")
    text = head.decode("latin-1")
    for pattern, what, remedy in _BY_TEXT:
        if pattern.search(text):
            raise RecordingError(f"{path}: is {what}; {remedy}. Can be read: {READABLE}")


def refuse_unknown(path: Path) -> None:
    """Raise RecordingError for a file with an unknown ending that is not text."""
    with path.open("rb") as file:
        head = file.read(_HEAD)
    if b"\0" in head and head[:2] not in (b"\xff\xfe", b"\xfe\xff"):
        raise RecordingError(f"{path}: is of no kind that is known here. Can be read: {READABLE}")
