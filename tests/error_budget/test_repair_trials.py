"""Trials of repairs: the truth in the loop is the model's where nothing is concealed, and errors are counted."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from eha_core.error_budget import rig_from_changes
from eha_core.nominal import nominal_of
from eha_exam.drawing import draw_case

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from tools import repair_trials


@pytest.mark.parametrize("effects", [(), (("coulomb_friction", {"force": 300.0}),)])
def test_the_truth_and_the_model_track_alike(effects: tuple[tuple[str, dict[str, float]], ...]) -> None:
    case = draw_case("null", 1, 20)
    modelled = nominal_of(dict(case.nominal)).values
    task = repair_trials.task_of(case)
    changes = {f"{name}.{key}": value for name, values in effects for key, value in values.items()}
    rig = rig_from_changes(changes or {"coulomb_friction.force": 300.0}, modelled)
    sets = [rig.values(rig.departures if effects else ())]
    expected = float(task.rmse(sets, modelled, rig.composition)[0])
    assert repair_trials.true_rmse(case, effects, rig, task) == pytest.approx(expected, rel=0.01)


def test_repairs_are_counted_apart_where_an_effect_was_not_named() -> None:
    rows = [
        {"number": 0, "named": ["a", "b"], "repairs": {"a": [1e-4, 1.01e-4], "b": [1e-4, 1.2e-4]}},
        {"number": 1, "named": ["b"], "repairs": {"b": [2e-4, 2e-4]}},
        {"number": 2, "why": "nothing is named"},
    ]
    rows = [{"concealed": ["a", "b"], **row} for row in rows]
    told = list(repair_trials.summed_up(rows))
    assert told[0] == "1 rigs of which both effects were named: all repairs within 5 % on 0"
    assert told[1].startswith("  2 repairs: 1 within 5 %, median error 10 %")
    assert told[2] == "1 rigs of which one was: all repairs within 5 % on 1"
    assert told[-1] == "0, a + b, named a + b: without b 100 um predicted, 120 um true"
    assert np.isclose(repair_trials.WITHIN, 0.05)
