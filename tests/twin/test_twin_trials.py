"""Trials of false alarms: a rig as modelled raises none, another rig's model does, and the summary counts them."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from eha_core.recording.simulated import Experiment, Simulated

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from tools import twin_trials


@pytest.fixture(autouse=True)
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(twin_trials, "PIECES", 2)
    monkeypatch.setattr(twin_trials, "SECONDS", 5.0)


def test_a_rig_as_modelled_raises_no_alarm_over_its_motions() -> None:
    row = twin_trials.try_rig(3, 20)
    assert row["windows"] == 8 and row["alarms"] == 0
    assert row["evidence"] < 3.0 < row["needed"]


def test_a_rig_that_is_not_as_modelled_raises_one(monkeypatch: pytest.MonkeyPatch) -> None:
    simulate = twin_trials.simulate

    def heavier(made: Experiment) -> Simulated:
        return simulate(replace(made, parameters={**made.parameters, "moving_mass": 40.0}))

    monkeypatch.setattr(twin_trials, "simulate", heavier)
    assert twin_trials.try_rig(3, 20)["alarms"] >= 1


def test_the_summary_counts_hours_and_alarms() -> None:
    rows = [
        {"noise": 3.0, "windows": 3600, "alarms": 1, "evidence": 18.8, "needed": 18.8},
        {"noise": 1.0, "windows": 1800, "alarms": 0, "evidence": -0.5, "needed": 18.8},
    ]
    first, quiet, loud = twin_trials.summed_up(rows)
    assert first == "2 rigs followed for 1.5 h, 1 alarms"
    assert "noise 1x, 1 rigs: evidence of -0.50" in quiet and "noise 3x" in loud
