"""The page and the document of an investigation: each test, what was known before and after it, and the end."""

from __future__ import annotations

import json
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from eha_core.diagnosis.experiment.command_signal import CommandSignal
from eha_core.diagnosis.experiment.limits import Limits
from eha_core.diagnosis.result import Alternative, FittedValue, NamedEffect, ProbableSet
from eha_core.errors import EhaError
from eha_core.investigation import Ending, Investigation, Step, VoltageTest
from eha_core.recording import Recording
from eha_core.report.investigation import ending_account, step_account, write_investigation

FRICTION = NamedEffect("coulomb_friction", "force", "", {"force": FittedValue(20.0, 0.5, "N")}, 100.0, "the seals rub")


def found(*rivals: str) -> SimpleNamespace:
    share = 0.9 if rivals else 1.0
    return SimpleNamespace(
        verdict="ambiguous" if rivals else "missing_physics",
        summary="Physics is missing.",
        effects=(FRICTION,),
        sets=(ProbableSet(("coulomb_friction",), share),),
        alternatives=tuple(Alternative((rival,), 2.0) for rival in rivals),
    )


@pytest.fixture
def state() -> Investigation:
    time = np.arange(2000) * 2e-3
    recordings = [
        Recording.from_arrays(time=time, voltage_command=0.1 * np.sin(time), position=1e-3 * np.cos(time), name=name)
        for name in ("test_1.mcap", "test_2.mcap")
    ]
    tests = [
        VoltageTest(CommandSignal("sine", {"amplitude": 0.1, "frequency": 3.0}), 4.0, "a first look"),
        VoltageTest(CommandSignal("square", {"amplitude": 0.2, "frequency": 0.25}), 10.0, "a & b differ <here>"),
    ]
    diagnoses = [found("stribeck_friction", "presliding_friction"), found()]
    steps = tuple(map(Step, tests, recordings, diagnoses, (12.0, 34.0)))
    limits = Limits(position=0.06, speed=0.3, voltage=1.0)
    return Investigation(limits, steps, Ending("resolved", "Physics is missing."))


def rows(page: str, number: int) -> dict[str, tuple[str, str]]:
    section = page.partition(f'<section id="test_{number}">')[2].partition("</section>")[0]
    cells = re.findall(r'<tr class="(?:out)?">(.*?)</tr>', section)
    texts = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in cells]
    return {name: (before, after) for name, before, after in texts}


def test_each_step_says_what_was_known_before_and_after(state: Investigation, tmp_path: Path) -> None:
    page = write_investigation(state, tmp_path)[0].read_text()
    assert rows(page, 1) == {
        "Coulomb friction": ("not known", "90 %"),
        "Stribeck friction": ("not known", "a rival"),
        "presliding friction": ("not known", "a rival"),
    }
    assert rows(page, 2) == {
        "Coulomb friction": ("90 %", "over 99 %"),
        "Stribeck friction": ("a rival", "excluded"),
        "presliding friction": ("a rival", "excluded"),
    }
    assert page.count("<polyline") == 4 and "voltage, -75.5 to 100 mV in 4.0 s" in page
    assert "one set remains" in page and "position 60.0 mm, speed 300 mm/s, voltage 1.00 V" in page
    assert "a &amp; b differ &lt;here&gt;." in page and 'href="test_2.mcap"' in page
    assert 'href="diagnosis/report.html"' in page


def test_a_page_while_it_goes_on_has_no_files_yet(state: Investigation, tmp_path: Path) -> None:
    going = Investigation(state.limits, state.steps[:1])
    page = write_investigation(going, tmp_path)[0].read_text()
    assert "the investigation goes on" in page and "report.html" not in page
    assert "1 test;" in page


def test_the_document_has_every_step_in_si_units(state: Investigation, tmp_path: Path) -> None:
    document = json.loads(write_investigation(state, tmp_path)[1].read_text())
    assert document["schema"] == "eha.investigation/1"
    assert document["limits"] == {"position": 0.06, "speed": 0.3, "pressure": None, "energy": None, "voltage": 1.0}
    assert document["ending"] == {"kind": "resolved", "statement": "Physics is missing."}
    first, second = document["steps"]
    assert first["sets"][0] == {"effects": ["coulomb_friction"], "probability": 0.9}
    assert first["sets"][1]["probability"] is None and len(second["sets"]) == 1
    assert second["test"]["parameters"] == {"amplitude": 0.2, "frequency": 0.25}


def test_the_terminal_says_the_same(state: Investigation) -> None:
    lines = step_account(state).splitlines()
    assert lines[0] == "Test 2: a square of voltage (amplitude 200 mV, frequency 0.250 Hz) for 10 s"
    assert lines[-1] == "  possible: Coulomb friction (over 99 %)"
    account = ending_account(state, Path("out"))
    assert account.startswith("Ended: one set remains. Physics is missing.")
    assert "Named: Coulomb friction (force 20.00 ± 0.98 N), 95 %" in account
    assert account.endswith("Page: out/investigation.html")


def test_a_folder_that_cannot_be_written_to_is_named(state: Investigation, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(EhaError, match="file: cannot be written"):
        write_investigation(state, tmp_path / "file")
