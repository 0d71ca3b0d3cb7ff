"""`eha-exam` on the command line; and `eha exam`, the same with a tool of its own, also where the exam is missing."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from eha_core.cli import main as eha
from eha_exam.command import main
from eha_exam.tiers import MEANINGS
from eha_exam.version import __version__

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "eha_exam" / "examples" / "dry_friction.py"


def test_a_toy_method_sits_an_exam(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = f"dry friction={{python}} {EXAMPLE} {{recordings}} {{answers}}"
    words = ["--cases", "2", "--tier", "null", "--seed", "3", "--out", str(tmp_path), "--method", command]
    assert main([*words, "--require", "1"]) == 0
    printed = capsys.readouterr()
    assert "dry friction\n  all " in printed.out and "dry friction: 2 of 2" in printed.err
    table = json.loads((tmp_path / "table.json").read_text())
    assert list(table["tools"]) == ["dry friction"]
    assert table["about"]["command"].startswith("eha-exam --cases 2 --tier null")
    assert main(["--pool", str(tmp_path / "table.json"), "--out", str(tmp_path / "pooled"), "--require", "1"]) == 0


def test_reports_of_lost_cases_are_what_a_command_writes(tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.py"
    wrong.write_text(
        "import json, sys\neffect = {'id': 'end_stop', 'site': 'force'}\n"
        "json.dump({'verdict': 'missing_physics', 'effects': [effect]}, open(sys.argv[2], 'w'))\n"
    )
    report = tmp_path / "report.py"
    report.write_text("import pathlib, sys\n(pathlib.Path(sys.argv[2]) / 'report.html').write_text(sys.argv[1])\n")
    words = ["--cases", "1", "--tier", "null", "--out", str(tmp_path / "exam"), "--lost", "1", "--require", "1"]
    tool = ["--tool", f"wrong={{python}} {wrong} {{recording}} {{answer}}"]
    assert main([*words, *tool, "--report", f"{{python}} {report} {{recording}} {{folder}}"]) == 1
    assert (tmp_path / "exam/lost/null-0000/report.html").read_text().endswith(".mcap")
    assert 'href="lost/null-0000/report.html"' in (tmp_path / "exam/table.html").read_text()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "nothing to score; give --tool NAME=COMMAND, --method NAME=COMMAND or --peers"),
        (["--tool", "mine=run {recording}"], "give NAME=COMMAND with {recording} and {answer} in the command"),
        (["--method", "run {recordings} {answers}"], "give NAME=COMMAND with {recordings} and {answers}"),
        (["--tool", "a=b {recording} {answer}", "--method", "a=b {recordings} {answers}"], "--method a: is the name"),
        (["--cases", "0", "--peers"], "give 1 or more of each"),
        (["--lost", "2", "--peers"], "give --report COMMAND"),
        (["--tier", "singel", "--peers"], "did you mean single?"),
    ],
    ids=str,
)
def test_what_cannot_be_used_is_said_in_one_line(
    words: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*words, "--out", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr().err
    assert printed.startswith("eha-exam: ") and message in printed and printed.count("\n") == 1


def test_its_help_has_the_tiers_and_its_version_is_the_project_s(capsys: pytest.CaptureFixture[str]) -> None:
    for word, wanted in (("--help", list(MEANINGS)), ("--version", [f"eha-exam {__version__}\n"])):
        with pytest.raises(SystemExit) as ended:
            main([word])
        assert ended.value.code == 0
        out = capsys.readouterr().out
        assert all(text in out for text in wanted)


def test_the_verb_passes_the_exam_s_errors_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert eha(["exam", "--tier", "singel", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err == "eha exam: tier 'singel' is none of the exam's; did you mean single?\n"


MISSING = "eha exam: the exam is a package of its own, which is not installed; run `pip install eha_exam`\n"


@pytest.mark.parametrize(
    ("words", "status", "out", "err"),
    [
        (["exam", "--cases", "10", "--seed", "2026"], 2, "", MISSING),
        (["exam", "--bags", "bags"], 2, "", MISSING),
        (["exam"], 2, "", MISSING),
        (["exam", "--help"], 0, "pip install eha_exam", ""),
        (["--help"], 0, "make recordings with concealed effects", ""),
        (["effects", "coulomb_friction"], 0, "Dry friction", ""),
    ],
    ids=str,
)
def test_without_the_package_the_verb_says_what_to_install(words: list[str], status: int, out: str, err: str) -> None:
    code = f"import sys; sys.modules['eha_exam'] = None; from eha_core.cli import main; sys.exit(main({words}))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (status, err)
    assert " ".join(out.split()) in " ".join(done.stdout.split())
