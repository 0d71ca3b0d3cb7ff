"""Since when and until when an effect acts, from the quadratic model alone."""

import numpy as np
import pytest
from made import bench

from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search import intervals
from eha_core.diagnosis.search.best_sets import best_sets
from eha_core.diagnosis.search.quadratic import quadratic_model

WINDOW = 0.25


def options_in_time(rig):
    return quadratic_model(
        rig.pool.problem, rig.pool.found[NOTHING], NOTHING, rig.pool.plant, rig.columns, in_time=True
    )


def test_an_effect_that_acts_for_a_while_is_an_option_with_its_interval():
    acts = (1.7, 4.4)
    limits = dict(zip(("acts_from", "acts_until"), acts, strict=True))
    planted = {"constant_load.force": 100.0, **{f"constant_load.{name}": at for name, at in limits.items()}}
    rig = bench(planted, length=WINDOW, duration=6.0)
    model = options_in_time(rig)
    (load,) = [option for option in model.options if option.member.limited and option.member.id == "constant_load"]
    values, _ = model.start((load,))
    found = [values[f"constant_load.{name}"] for name in limits]
    assert found == pytest.approx(acts, abs=2.0 * WINDOW)
    assert values["constant_load.force"] == pytest.approx(100.0, rel=0.2)
    # and it is the best set, though its interval counts as a member more
    (best,) = best_sets(model, 2)[2][0].options
    assert best.member == load.member


@pytest.mark.parametrize(
    "planted", [{"constant_load.force": 100.0}, {"coulomb_friction.force": 60.0}, {"valve_deadband.half_width": 2e-5}],
    ids=lambda planted: next(iter(planted)),
)  # fmt: skip
def test_where_effects_always_act_none_has_an_interval(planted):
    model = options_in_time(bench(planted, length=WINDOW, duration=4.0))
    assert not any(option.member.limited for option in model.options)


def test_what_sets_in_has_its_instant():
    rig = bench({"leakage_onset.time": 3.6, "leakage_onset.internal_leakage": 1e-11}, length=WINDOW, duration=6.0)
    model = options_in_time(rig)
    (best,) = best_sets(model, 1)[1][0].options
    assert best.member.id == "leakage_onset" and not best.member.limited
    values, _ = model.start((best,))
    assert values["leakage_onset.time"] == pytest.approx(3.6, abs=2.0 * WINDOW)


def test_spans_taken_together_tell_the_same(monkeypatch):
    planted = {"constant_load.force": 100.0, "constant_load.acts_from": 2.0, "constant_load.acts_until": 4.0}
    rig = bench(planted, length=WINDOW, duration=6.0)
    monkeypatch.setattr(intervals, "MOST_SPANS", 6)  # of four windows each
    model = options_in_time(rig)
    (load,) = [option for option in model.options if option.member.limited and option.member.id == "constant_load"]
    values = load.columns[0].values
    assert [values[f"constant_load.acts_{end}"] for end in ("from", "until")] == pytest.approx([2.0, 4.0], abs=0.01)


def test_a_column_in_an_interval_is_the_whole_one_with_zeros_elsewhere():
    rig = bench({"constant_load.force": 100.0}, length=WINDOW, duration=3.0)
    problem = rig.pool.problem
    generator = np.random.default_rng(1)
    moved = generator.standard_normal((problem.count(), 1))
    shifts = generator.standard_normal((problem.shooting.windows, 4, 1))
    inside, ends = intervals.restricted(problem, moved, shifts, (3, 5))
    window = problem.order[1]
    assert np.array_equal(inside[(window == 3) | (window == 4)], moved[(window == 3) | (window == 4)])
    assert not np.any(inside[(window != 3) & (window != 4)])
    assert np.array_equal(ends[3:5], shifts[3:5]) and not np.any(ends[:3]) and not np.any(ends[5:])


def test_spans_keep_to_their_recordings_and_are_few():
    assert np.array_equal(intervals._spans([range(40)], 100), np.arange(41))
    spans = intervals._spans([range(3), range(3, 703), range(703, 2003)], 100)
    assert {0, 3, 703, 2003} <= set(spans.tolist())
    assert len(spans) - 1 <= 101
    assert np.max(np.diff(spans)) <= 21
