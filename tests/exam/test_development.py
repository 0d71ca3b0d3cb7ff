"""Development cases: made without the oracle, answered in turn, and paired with what was answered before."""

import numpy as np

from eha_core.recording import read_recording
from eha_exam.drawing import draw_case
from eha_exam.files import read_answer, recording_name
from eha_exam.measuring import measure, simulate_case
from tools.development import answer, brought, in_turn, make_development_case, paired


def test_a_case_is_the_exams_own_and_nothing_is_missing_in_it(tmp_path):
    known = {"decidable": True, "seen": []}
    assert make_development_case("null-0001", 70219, known, str(tmp_path)) == "null-0001"
    case = read_answer((tmp_path / "sealed" / "null-0001.json").read_text())
    assert case.plant == draw_case("null", 1, 70219).plant
    read = read_recording(tmp_path / "recordings" / recording_name(case)).channels["position"]
    _, values = measure(case, simulate_case(case))["position"]
    assert np.allclose(read.values, values)
    row = answer(case, tmp_path / "recordings")
    assert (row["outcome"], row["named"], row["message"]) == ("right", (), "")
    assert row["cpu_s"] > 0.0 and row["trace"]


def test_every_tier_comes_early():
    names = [f"rig-{k:04d}" for k in range(16)] + [f"null-{k:04d}" for k in range(3)]
    ordered = in_turn(names)
    assert sorted(ordered) == sorted(names)
    assert {name.partition("-")[0] for name in ordered[:3]} == {"null", "rig"}


def test_answers_are_paired_case_by_case():
    before = {"rig-0000": {"outcome": "right"}, "rig-0001": {"outcome": "wrong"}, "null-0000": {"outcome": "right"}}
    after = {
        name: {"outcome": "right", "cpu_s": seconds, "named": [], "verdict": "consistent", "concealed": ["a"]}
        for name, seconds in (("rig-0000", 4.0), ("rig-0001", 6.0))
    }
    lines = list(paired(before, after))
    assert "| all | 2 | 1 | 2 | 6.0 | 6 |" in lines
    assert lines[-1] == "rig-0001: wrong before, right after (a: consistent)"


def test_a_right_answer_counts_for_the_step_that_fitted_its_set_first():
    fits = [
        ("nominal", [], 1.0),
        ("expansion 1", ["a"], 3.0),
        ("expansion 2", ["b", "a"], 4.0),
        ("rival", ["a", "b"], 9.0),
    ]
    trace = [{"step": step, "set": chosen, "cpu_s": at} for step, chosen, at in fits]
    right = {"outcome": "right", "named": ["a", "b"], "trace": trace}
    lines = list(brought({"pair-0000": right, "pair-0001": {**right, "outcome": "wrong"}}))
    assert lines[1:] == ["| expansion | 2 | 4 | 6 | 1 |", "| nominal | 2 | 2 | 2 | 0 |", "| rival | 2 | 2 | 10 | 0 |"]
