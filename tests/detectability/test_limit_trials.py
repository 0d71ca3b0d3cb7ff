"""Trials of limits: what the truth reaches is measured on its states, and the watch stops what goes too far."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eha_core.diagnosis.experiment.limits import Limits
from eha_exam.drawing import draw_case

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from tools import limit_trials

CASE = replace(draw_case("null", 0, 20), noise=1.0)
FAR = Limits(position=1.0, speed=10.0, pressure=1e9, voltage=10.0)


def test_a_piston_at_constant_speed_reaches_what_its_speed_and_time_give() -> None:
    voltages = np.full(500, 0.05)
    stopped, rows = limit_trials.driven(CASE, FAR, voltages, np.random.default_rng(1))
    shares = limit_trials.reached(rows, FAR, CASE)
    assert stopped == "" and len(rows) == 500
    travelled = shares["position"] * FAR.position
    assert travelled == pytest.approx(0.998 * shares["speed"] * FAR.speed, rel=0.05)
    assert shares["stroke"] == pytest.approx(travelled / CASE.plant["actuator_displacement"])


def test_the_watch_stops_a_motion_before_its_limit_and_the_piston_rests_inside() -> None:
    limits = replace(FAR, position=0.03)
    stopped, rows = limit_trials.driven(CASE, limits, np.full(3000, 0.2), np.random.default_rng(1))
    assert "position" in stopped and len(rows) < 3000
    assert 0.6 < limit_trials.reached(rows, limits, CASE)["position"] < 1.0


def test_a_drawn_rig_is_moved_within_its_limits_and_the_summary_says_so() -> None:
    row = limit_trials.try_rig(2, 20)
    assert row == limit_trials.try_rig(2, 20)
    assert max(row["shares"].values()) < 1.0 and row["stopped"] == ""
    past = {**row, "number": 7, "shares": {**row["shares"], "speed": 1.25}, "stopped": "speed 1 m/s"}
    told = list(limit_trials.summed_up([row, past, {"number": 8, "why": "no amplitude stays within the limits"}]))
    assert told[0].startswith("3 rigs, 2 moved") and told[1] == "1 stopped by the watch"
    assert "speed: 1 past the limit, 1 of them stopped; 1.250 of it at most" in told
    assert told[-1].startswith("7: {'speed': 1.25}")
