"""Sets that are made already: they hold what was sealed, refuse what was changed, and are scored as they are."""

from __future__ import annotations

import hashlib
import json
import lzma
import shutil
from pathlib import Path

import pytest

from eha_exam.command import main
from eha_exam.drawing import draw_case
from eha_exam.files import answer_text, digest_of, read_answer, recording_name
from eha_exam.recordings import read_recording
from eha_exam.sealed_set import KEY, exam_of, open_set, read_seal, take_set
from eha_exam.ship import CASES, MOST_SAMPLES, members_of
from eha_exam.tiers import SHARES

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "eha_exam" / "shipped"
EXAMPLE = ROOT / "eha_exam" / "examples" / "dry_friction.py"
SILENT = """
import json, sys
json.dump({"verdict": "ambiguous", "effects": [], "next_experiment": {"reference": {}}}, open(sys.argv[2], "w"))
"""


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    return Path(shutil.copytree(SHIPPED, tmp_path / "set"))


def test_the_shipped_set_is_small_whole_and_of_every_tier(tmp_path: Path) -> None:
    sizes = [path.stat().st_size for path in SHIPPED.rglob("*") if path.is_file()]
    assert sum(sizes) < 20e6 and max(sizes) < 0.6e6
    seal = read_seal(SHIPPED)
    exam = exam_of(SHIPPED, tmp_path)
    take_set(SHIPPED, exam)
    for name, digest in seal.recordings.items():
        assert hashlib.sha256((exam.recordings / name).read_bytes()).hexdigest() == digest
    open_set(SHIPPED, exam)
    cases = [read_answer(path.read_text()) for path in exam.sealed_files()]
    assert {case.tier for case in cases} == set(SHARES)
    assert sorted((case.tier, case.name) for case in cases) == sorted(
        (tier, f"{tier}-{number:04d}") for tier, number in members_of(seal.seed)
    )
    for case in cases:
        assert case.seed == draw_case(case.tier, int(case.name[-4:]), seal.seed).seed
        assert digest_of(answer_text(case)) == seal.answers[recording_name(case)]
        recording = read_recording(exam.recordings / recording_name(case))
        assert tuple(recording.channels) == case.channels
        assert dict(recording.parameters) == pytest.approx(dict(case.nominal))


def test_a_set_has_each_tier_by_its_share_and_only_short_recordings() -> None:
    members = list(members_of(11))
    tiers = [tier for tier, _ in members]
    assert all(tiers.count(tier) == max(1, round(CASES * share)) for tier, share in SHARES.items())
    assert all(case.duration * case.rate <= MOST_SAMPLES for case in (draw_case(*one, 11) for one in members))


def test_answers_are_not_read_by_accident_but_by_the_stated_keystream() -> None:
    sealed = (SHIPPED / "answers.bin").read_bytes()
    assert b"coulomb" not in sealed
    first = hashlib.sha256(KEY + bytes(8)).digest()
    assert bytes(one ^ other for one, other in zip(sealed[:2], first, strict=False)) == b"\x78\xda"  # zlib's header


@pytest.mark.parametrize("changed", ["recording", "answers", "digest", "seal"])
def test_a_changed_byte_is_refused_in_one_line(
    changed: str, copy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first = min((copy / "recordings").glob("*.xz"))
    if changed == "recording":
        content = bytearray(lzma.decompress(first.read_bytes()))
        content[1000] ^= 1
        first.write_bytes(lzma.compress(bytes(content)))
        message = f"{first}: is not the recording that was sealed; take the set anew"
    elif changed == "answers":
        content = bytearray((copy / "answers.bin").read_bytes())
        content[1000] ^= 1
        (copy / "answers.bin").write_bytes(content)
        message = f"{copy / 'answers.bin'}: cannot be opened"
    elif changed == "digest":
        seal = json.loads((copy / "seal.json").read_text())
        name = min(seal["answers"])
        seal["answers"][name] = digest_of("another")
        (copy / "seal.json").write_text(json.dumps(seal))
        message = f"{copy / 'answers.bin'}: has another answer to {name} than the sealed one"
    else:
        (copy / "seal.json").write_text("{}")
        message = f"{copy / 'seal.json'}: is not the seal of a set"
    words = ["--set", str(copy), "--out", str(tmp_path / "out"), "--tool", "none=true {recording} {answer}"]
    assert main(words) == 2
    printed = capsys.readouterr().err
    assert message in printed and printed.count("\n") == 1
    assert not (tmp_path / "out" / "answers").exists()


def test_a_toy_method_gets_its_table_without_a_simulation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def none(*_: object) -> None:
        raise AssertionError("a set is not simulated")

    monkeypatch.setattr("eha_exam.run_exam.make_case", none)
    monkeypatch.setattr("eha_exam.by_recording.second_recording", none)
    script = tmp_path / "unsure.py"
    script.write_text(SILENT, encoding="utf-8")
    method = f"dry friction={{python}} {EXAMPLE} {{recordings}} {{answers}}"
    tool = f"unsure={{python}} {script} {{recording}} {{answer}}"
    words = ["--set", str(SHIPPED), "--out", str(tmp_path / "out"), "--method", method, "--tool", tool]
    assert main(words) == 0
    table = json.loads((tmp_path / "out" / "table.json").read_text())
    marks = table["tools"]["dry friction"]["marks"]
    assert len(marks) == len(read_seal(SHIPPED).answers) == table["about"]["cases"]
    assert {mark["outcome"] for mark in marks} >= {"right", "wrong"}
    assert {mark["resolved"] for mark in table["tools"]["unsure"]["marks"]} == {None}
    assert main([*words, "--tier", "single"]) == 2
    assert "leave --tier and --opened out" in capsys.readouterr().err
