"""Fits from other instants, of which no derivative tells anything."""

import pytest
from made import bench

from eha_core.diagnosis.search.instants import shift_instants


def test_an_instant_that_derivatives_do_not_reach_is_found_by_trying_others():
    planted = {"leakage_onset.time": 2.37, "leakage_onset.internal_leakage": 3e-11}
    rig = bench(planted, length=1.0, duration=5.0)
    begun = {**planted, "leakage_onset.time": 3.0}
    stuck = rig.fitted(begun)
    assert stuck.data > 1.5 * stuck.count
    onset = rig.set_of("leakage_onset")
    shift_instants(rig.pool, onset)
    found = rig.pool.found[onset]
    assert found.data < 1.1 * found.count
    for name, value in planted.items():
        assert found.values[name] == pytest.approx(value, abs=max(4.0 * found.deviation(name), 0.01 * value))


@pytest.mark.parametrize("late", [-0.35, 0.35])
def test_other_instants_are_compared_once_all_else_has_adapted_to_them(late):
    """Over 30 ms the windows' states have adapted to the instant that was there, and hold it."""
    planted = {"leakage_onset.time": 4.0, "leakage_onset.internal_leakage": 2e-11}
    rig = bench(planted, length=0.03, duration=8.0)
    stuck = rig.fitted({**planted, "leakage_onset.time": 4.0 + late}, 25)
    assert abs(stuck.values["leakage_onset.time"] - 4.0) > 0.2
    onset = rig.set_of("leakage_onset")
    shift_instants(rig.pool, onset)
    found = rig.pool.found[onset]
    assert found.objective < stuck.objective - 500.0
    assert found.values["leakage_onset.time"] == pytest.approx(4.0, abs=0.02)
