"""A small exam that is made already: recordings in a folder, and their answers sealed beside them.

The folder holds recordings and, where there are some, nominal files as `recordings/<name>.xz`, the answers as
`answers.bin`, and `seal.json` with the SHA-256 of every recording and of every answer's text. The answers
are compressed and combined with a keystream whose key is below: nobody reads them by accident, and whoever wants to
read them can.
"""

from __future__ import annotations

import hashlib
import json
import lzma
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from eha_exam.errors import ExamError
from eha_exam.exam_folder import Exam, write_whole
from eha_exam.files import digest_of, read_answer, recording_name

SCHEMA = "eha.exam_set/1"
ANSWERS = "answers.bin"
KEY = b"eha_exam: answers of a sealed set, to be opened by the scorer"
REMEDY = "take the set anew from where it came"


@dataclass(frozen=True)
class Seal:
    """What `seal.json` says: the seed that the cases were drawn from, and SHA-256 of the files in `recordings/`,
    unpacked, and of the answers' texts by the name of the first recording."""

    seed: int
    recordings: Mapping[str, str]
    answers: Mapping[str, str]


def write_set(folder: Path, seed: int, files: Sequence[Path], texts: Sequence[str]) -> None:
    """Write a sealed set of recordings with their nominal files, and of answers as `answer_text` makes them."""
    (folder / "recordings").mkdir(parents=True)
    for path in files:
        _packed(folder, path.name).write_bytes(lzma.compress(path.read_bytes(), preset=9))
    (folder / ANSWERS).write_bytes(_combined(zlib.compress(json.dumps(list(texts)).encode(), 9)))
    recordings = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files}
    answers = {recording_name(read_answer(text)): digest_of(text) for text in texts}
    seal = {"schema": SCHEMA, "seed": seed, "recordings": recordings, "answers": answers}
    write_whole(folder / "seal.json", json.dumps(seal, indent=1) + "\n")


def read_seal(folder: Path) -> Seal:
    """The seal of a set. ExamError where the folder holds none."""
    path = folder / "seal.json"
    try:
        fields = json.loads(path.read_text(encoding="utf-8"))
        if fields.pop("schema") == SCHEMA:
            return Seal(**fields)
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        pass
    raise ExamError(f"{path}: is not the seal of a set; give the folder of one, or leave --set out")


def exam_of(folder: Path, out: Path) -> Exam:
    """The exam, in the folder `out`, of the set in another. ExamError where there is none."""
    seal = read_seal(folder)
    return Exam(out, len(seal.answers), seal.seed, source=folder)


def take_set(folder: Path, exam: Exam) -> None:
    """Put the recordings of a set and the seal of its answers into an exam's folder.

    ExamError where a recording or an answer is not as it was sealed.
    """
    seal = read_seal(folder)
    _answers(folder, seal)
    _unpack(folder, seal, exam)
    write_whole(exam.folder / "seal.json", json.dumps(seal.answers, indent=1))


def open_set(folder: Path, exam: Exam) -> None:
    """Put the answers of a set into an exam's folder, which is the time to look at them."""
    for text in _answers(folder, read_seal(folder)):
        write_whole(exam.folder / "sealed" / f"{read_answer(text).name}.json", text)


def _packed(folder: Path, name: str) -> Path:
    return folder / "recordings" / f"{Path(name).name}.xz"


def _unpack(folder: Path, seal: Seal, exam: Exam) -> None:
    exam.recordings.mkdir(parents=True, exist_ok=True)
    for name, digest in seal.recordings.items():
        path = _packed(folder, name)
        try:
            content = lzma.decompress(path.read_bytes())
        except (OSError, lzma.LZMAError) as error:
            raise ExamError(f"{path}: cannot be unpacked ({error}); {REMEDY}") from None
        if hashlib.sha256(content).hexdigest() != digest:
            raise ExamError(f"{path}: is not the recording that was sealed; {REMEDY}")
        (exam.recordings / Path(name).name).write_bytes(content)


def _answers(folder: Path, seal: Seal) -> list[str]:
    path = folder / ANSWERS
    try:
        texts = json.loads(zlib.decompress(_combined(path.read_bytes())))
        answers = {recording_name(read_answer(text)): digest_of(text) for text in texts}
    except (OSError, zlib.error, ValueError, TypeError, KeyError) as error:
        raise ExamError(f"{path}: cannot be opened ({error}); {REMEDY}") from None
    for name, digest in seal.answers.items():
        if answers.get(name) != digest:
            raise ExamError(f"{path}: has another answer to {name} than the sealed one; {REMEDY}")
    return [str(text) for text in texts]


def _combined(content: bytes) -> bytes:
    """The bytes, exclusive or those of the keystream SHA-256(KEY, 0), SHA-256(KEY, 1), ...; twice is as before."""
    blocks = (hashlib.sha256(KEY + number.to_bytes(8, "big")).digest() for number in range(len(content) // 32 + 1))
    return bytes(one ^ other for one, other in zip(content, b"".join(blocks), strict=False))
