"""The model that was found, judged by the whole record; and the way in and out of a diagnosis."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made import recorded

import eha_core as eha
from eha_core.identification.observation import observe
from eha_core.long_record import limits
from eha_core.long_record.admission import admitted
from eha_core.long_record.judge import Judge, errors_held, long_record
from eha_core.parameters import nominal_values
from eha_core.plant import PAPER
from eha_core.recording import Recording
from eha_core.recording.blocks import BlocksInMemory
from eha_core.report.account import account
from eha_core.report.document import document

FRICTION = {"coulomb_friction.force": 250.0}


def judge_of(recording: Recording, found: dict[str, float], fitted: set[int]) -> Judge:
    judge = Judge(nominal_values(), nominal_values() | found, PAPER, fitted)
    BlocksInMemory(recording, 2.0).each(judge.take)
    return judge


def test_the_right_model_errs_alike_all_over_the_record() -> None:
    recording = recorded(FRICTION, duration=12.0, rate=250.0)
    judge = judge_of(recording, FRICTION, {0, 5})
    judged = long_record("rig.mcap", 12.0, [(0.0, 2.0), (10.0, 12.0)], judge)
    assert [(one.start, one.end, one.fitted) for one in judged.blocks] == [
        (2.0 * number, 2.0 * number + 2.0, number in (0, 5)) for number in range(6)
    ]
    assert judged.departs == ()
    assert judged.passed_over == 0.0
    for one in judged.blocks:
        assert one.after["position"] < 0.3 * one.before["position"]
    assert judged.statement.startswith("Of 12 s, 2 stretches of 2 s were fitted.")
    assert "over the 8 s that were not fitted" in judged.statement


def test_what_acts_for_a_while_is_told_with_its_span() -> None:
    acting = {"effects_from": 6.0, "effects_until": 10.0}
    recording = recorded({"coulomb_friction.force": 400.0} | acting, duration=14.0, rate=250.0)
    judged = long_record("rig.mcap", 14.0, [(0.0, 2.0), (12.0, 14.0)], judge_of(recording, {}, {0, 6}))
    assert judged.departs == ((6.0, 10.0),)
    assert "from 6 to 10 s it errs by more than 1.5 times" in judged.statement


def test_what_cannot_be_compared_is_passed_over() -> None:
    recording = recorded(FRICTION, duration=8.0, rate=250.0)
    command = recording.channels["voltage_command"]
    still = np.where((command.time >= 2.0) & (command.time < 4.1), 0.0, command.values)
    channels = {**recording.channels, "voltage_command": replace(command, values=still)}
    judge = judge_of(replace(recording, channels=channels), FRICTION, {0})
    assert [one.start for one in judge.blocks] == [0.0, 4.0, 6.0]
    assert judge.passed_over == 2.0


def test_of_the_right_model_the_noise_is_left() -> None:
    observation = observe(recorded(FRICTION, duration=3.0))
    left = errors_held(observation, nominal_values() | FRICTION)
    assert left == pytest.approx({"position": 1e-5, "pressure_a": 1e4, "pressure_b": 1e4}, rel=0.1)
    without = errors_held(observation, nominal_values())
    assert all(without[name] > 3.0 * left[name] for name in left)


def test_a_short_record_goes_in_as_it_is() -> None:
    recording = recorded({}, duration=3.0, rate=250.0)
    record = admitted(recording)
    assert record.recordings == (recording,)
    assert record.blocks is None


def test_a_long_record_of_which_nothing_moves_goes_in_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """The diagnosis then says what is wrong with it."""
    monkeypatch.setattr(limits, "LONGEST_WHOLE", 5.0)
    monkeypatch.setattr(limits, "STRETCH", 2.0)
    recording = recorded({}, duration=8.0, rate=250.0, amplitude=1e-9)
    assert admitted(recording).recordings == (recording,)


def test_a_long_record_is_fitted_in_stretches_and_told_in_its_own_time(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(limits, "LONGEST_WHOLE", 10.0)
    monkeypatch.setattr(limits, "STRETCH", 3.0)
    monkeypatch.setattr(limits, "STRETCHES", 2)
    recording = recorded(FRICTION, duration=21.0, rate=250.0)
    found = eha.diagnose(recording)
    diagnosis = found.diagnosis
    assert [one.id for one in diagnosis.effects] == ["coulomb_friction"]
    assert diagnosis.effects[0].parameters["force"].value == pytest.approx(250.0, abs=2.0)
    (judged,) = diagnosis.long_records
    assert judged.stretches == ((0.0, 3.0), (18.0, 21.0))
    assert len(judged.blocks) == 7
    assert judged.departs == ()
    assert (diagnosis.path, diagnosis.duration, diagnosis.start_stamp) == (str(recording.path), 21.0, 0)
    # what is drawn is one of the stretches, at its place in the record
    begin, end = diagnosis.drawn
    assert (begin, end) in ((0.0, pytest.approx(3.0, abs=0.01)), (18.0, pytest.approx(21.0, abs=0.01)))
    time, measured = diagnosis.pictures.time["position"], diagnosis.pictures.measured["position"]
    whole = recording.channels["position"]
    assert begin <= time[0] < time[-1] <= end
    np.testing.assert_array_equal(measured, whole.values[np.searchsorted(whole.time, time - 1e-6)])
    assert all(begin <= start < stop <= end + 0.01 for one in diagnosis.location for start, stop in one.when)
    said = account(diagnosis)
    assert f"{Path(diagnosis.path).name}: 21.0 s" in said
    assert "Of 21 s, 2 stretches of 3 s were fitted." in said
    assert len(json.loads(json.dumps(document(diagnosis)))["long_records"][0]["blocks"]) == 7
    found.save(tmp_path / "report")
    page = (tmp_path / "report" / "report.html").read_text(encoding="utf-8").replace("\N{NO-BREAK SPACE}", " ")
    assert "Of 21 s, 2 stretches of 3 s were fitted." in page
    assert "The whole record: RMSE with parameters held" in page
