"""The command line around its verbs: what it refuses, and how it ends."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import eha_core
import eha_exam.version
from eha_core.cli import main, verbs
from eha_exam.tiers import MEANINGS

ROOT = Path(__file__).resolve().parents[2]


def test_says_which_version_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert (ended.value.code, capsys.readouterr().out) == (0, f"eha {eha_core.__version__}\n")


def test_the_actuator_s_packages_bear_one_version() -> None:
    here = eha_core.__version__
    assert eha_exam.version.__version__ == here
    for path in ROOT.glob("*/package.xml"):
        assert f"<version>{here}</version>" in path.read_text(), path
    for path in ("eha_sim_node/setup.py", "eha_interfaces/setup.py"):  # rclpy_dds is released on its own
        assert re.search(rf'^\s*version ?= ?"{re.escape(here)}"', (ROOT / path).read_text(), re.MULTILINE), path
    assert f"\nversion: {here}\n" in (ROOT / "CITATION.cff").read_text()
    assert re.findall(r"^## (\S+?),? ", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[0] == here


def test_the_exam_s_help_has_each_tier_as_a_word(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["exam", "--help"])
    lines = capsys.readouterr().out.split("tiers:\n")[1].splitlines()
    assert [line.split()[0] for line in lines] == list(MEANINGS)


HEAVY = {"numpy", "numba", "scipy", "matplotlib", "plotly"}


def run_and_list_heavy_modules(words: list[str]) -> str:
    """What a command prints, then which heavy modules it has imported, as a list."""
    code = (
        "import sys; from eha_core.cli import main\n"
        f"try: sys.exit(main({words}))\n"
        f"finally: print(sorted({HEAVY} & set(sys.modules)))"
    )
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False).stdout


@pytest.mark.parametrize("words", [["diagnose", "--help"], ["diagnose", "missing.mcap"]])
def test_the_help_and_a_missing_recording_wait_for_no_compiler(words: list[str]) -> None:
    assert run_and_list_heavy_modules(words).rstrip().endswith("[]")


def test_help_names_every_verb_and_imports_nothing_heavy() -> None:
    out = run_and_list_heavy_modules(["--help"])
    assert out.rstrip().endswith("[]")
    for verb in verbs():
        assert re.search(rf"^ +{verb} +[a-z]+ ", out, re.MULTILINE), verb


def test_what_is_neither_verb_nor_option_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    for word in ("--nonsense", "-x", "--"):
        with pytest.raises(SystemExit) as ended:
            main([word])
        assert ended.value.code == 2
        assert "see `eha --help`" in capsys.readouterr().err


def test_a_word_that_is_nearly_a_verb_is_answered_with_it(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["diagnos"])
    assert "did you mean diagnose?" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("typed", "offered"),
    [("eha ", set(verbs())), ("eha diagn", {"diagnose"}), ("eha simulate --instr", {"--instruments-only"})],
)
def test_a_shell_completes_verbs_and_options(typed: str, offered: set[str], tmp_path: Path) -> None:
    answer = tmp_path / "completions"
    environment = {
        **os.environ,
        "_ARGCOMPLETE": "1",
        "_ARGCOMPLETE_IFS": "\n",
        "_ARGCOMPLETE_STDOUT_FILENAME": str(answer),
        "COMP_LINE": typed,
        "COMP_POINT": str(len(typed)),
    }
    subprocess.run([sys.executable, "-m", "eha_core.cli"], env=environment, timeout=60, check=False)
    words = {word.strip() for word in answer.read_text().splitlines()}
    assert offered <= words
    assert typed == "eha " or words == offered


@pytest.mark.parametrize("words", [[], ["paint"]])
def test_no_verb_is_answered_in_one_line_that_names_them_all(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert all(verb in message for verb in verbs())


@pytest.mark.parametrize("buffering", [[], ["-u"]])
def test_a_reader_that_has_seen_enough_ends_it_quietly(buffering: list[str]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    try:
        command = [sys.executable, *buffering, "-m", "eha_core.cli", "effects"]
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
        ended = subprocess.run(
            command, stdout=writer, stderr=subprocess.PIPE, text=True, env=environment, timeout=60, check=False
        )
    finally:
        os.close(writer)
    assert (ended.returncode, ended.stderr) == (141, "")
