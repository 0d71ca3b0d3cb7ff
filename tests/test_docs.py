"""The documentation: links lead somewhere, every effect has its page, and the notebooks run."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import nbformat
import pytest
from matplotlib.image import imread
from nbclient import NotebookClient

from eha_core.cli import main, verbs
from eha_core.effects import effects
from eha_exam.command import main as exam

ROOT = Path(__file__).resolve().parent.parent
PAGES = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").glob("*.md"))]
MADE = re.compile(r"catalogue/\w+\.md")
"""Pages that are made when the site is."""

COMMAND = re.compile(
    r"^(?:    |\$ )?(?:\.venv/bin/)?((?:eha|eha-exam|make|ros2 (?:run|launch) eha_\w+) [^|\n]*)", re.MULTILINE
)
"""A command that a page tells to type: in a block, or after a console's prompt."""

OPTION = re.compile(r"--[a-z][a-z-]*")

NUMBER = r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?"

sys.path.insert(0, str(ROOT / "tools"))
import effect_pages  # noqa: E402 - a tool, which no package holds


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_leads_to_a_file(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)", page.read_text()):
        if not target.startswith("http") and not MADE.fullmatch(target):
            assert (page.parent / target).exists(), target


def commands_of(page: Path) -> list[list[str]]:
    """The words of each command of a page, without comments."""
    text = page.read_text().replace("\\\n", " ")
    blocks = re.findall(r"```(?:sh|console)\n(.*?)```|((?:^    [^\n]*\n)+)", text, re.DOTALL | re.MULTILINE)
    found = (line for pair in blocks for line in COMMAND.findall("".join(pair)))
    return [shlex.split(line, comments=True) for line in found]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_command_has_a_verb_and_options_that_there_are(page: Path, capsys: pytest.CaptureFixture[str]) -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    for words in commands_of(page):
        if words[0] == "make":
            assert {word for word in words[1:] if "=" not in word} <= targets, words
        elif words[0] == "eha-exam":
            with pytest.raises(SystemExit):
                exam(["--help"])
            offered = set(OPTION.findall(capsys.readouterr().out))
            assert {word for word in words[1:] if OPTION.fullmatch(word)} <= offered, words
        elif words[0] == "ros2":
            package, name = ROOT / words[2], words[3]
            there = [*package.glob("launch/*"), *(path.with_suffix("") for path in package.glob(f"{words[2]}/*.py"))]
            assert name in {path.name for path in there}, words
        elif words[1] in verbs():
            with pytest.raises(SystemExit):
                main([words[1], "--help"])
            offered = set(OPTION.findall(capsys.readouterr().out))
            assert {word for word in words[2:] if OPTION.fullmatch(word)} <= offered, words
        else:
            assert words[1] == "--version", words


def test_commands_are_found_on_the_pages() -> None:
    found = [words for page in PAGES for words in commands_of(page)]
    assert {words[0] for words in found} == {"eha", "eha-exam", "make", "ros2"}
    assert {words[1] for words in found if words[0] == "eha"} >= {"diagnose", "exam", "inspect", "paper", "simulate"}


@pytest.mark.parametrize("effect", effect_pages.named_effects(), ids=lambda effect: effect.id)
def test_every_effect_has_a_page_with_all_that_its_docstring_says(effect: object) -> None:
    page = effect_pages.page_of(effect)
    assert effect.equation in page
    for part in ("Signature", "Equation", "Sign", "Validity", "Source"):
        assert f"**{part}.** " in page
    for name in effect.parameter_names():
        assert f"`{name}`" in page
    assert f"({effect.id}.md)" in effect_pages.table_of_all()


def test_the_front_page_counts_the_effects() -> None:
    (count,) = re.findall(r"internal leakage and (\d+) other\s+effects", (ROOT / "README.md").read_text())
    assert int(count) == len(effect_pages.named_effects())


def test_the_picture_shows_what_the_effect_changes(tmp_path: Path) -> None:
    (friction,) = (effect for effect in effects() if effect.id == "coulomb_friction")
    (tmp_path / "page.png").write_bytes(effect_pages.picture_of(friction))
    assert imread(tmp_path / "page.png")[..., :3].std() > 0.05
    assert effect_pages.typical(friction) == {"coulomb_friction.force": 200.0}


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.parametrize("name", ["diagnosis", "paper"])
def test_a_notebook_runs_to_what_it_shows(name: str) -> None:
    path = ROOT / "docs" / "notebooks" / f"{name}.ipynb"
    shown = nbformat.read(path, as_version=4)
    assert path.stat().st_size < 300_000
    executed = nbformat.read(path, as_version=4)
    NotebookClient(executed, timeout=100, resources={"metadata": {"path": str(path.parent)}}).execute()
    for one, other in zip(shown.cells, executed.cells, strict=True):
        words, numbers = text_of(one)
        words_again, numbers_again = text_of(other)
        assert words == words_again, one.source
        assert numbers == pytest.approx(numbers_again, rel=0.1), one.source


def text_of(cell: nbformat.NotebookNode) -> tuple[str, list[float]]:
    """What a cell prints: its words, and its numbers, whose last digits are another machine's or another fit's."""
    outputs = cell.get("outputs", [])
    text = "".join(output.get("text") or output.get("data", {}).get("text/plain", "") for output in outputs)
    found = re.findall(NUMBER, text)
    return " ".join(re.sub(NUMBER, "#", text).split()), [float(one) for one in found]
