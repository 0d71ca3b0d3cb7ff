"""Screening a long record: neighbours are taken together, and nothing else changes."""

import numpy as np
import pytest
from made import recorded

from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.search import screening
from eha_core.diagnosis.search.initial_guesses import applicable_effects, initial_guesses
from eha_core.identification.fit import fit
from eha_core.identification.free_parameters import free_nominal_parameters
from eha_core.identification.observation import observe
from eha_core.identification.problem import whole
from eha_core.identification.segments import cut
from eha_core.parameters import nominal_values


def test_windows_taken_together_predict_the_same_and_tell_since_when(monkeypatch):
    friction = {"coulomb_friction.force": 200.0, "effects_from": 3.0, "effects_until": 6.0}
    observation, values = observe(recorded(friction, duration=12.0)), nominal_values()
    problem = whole(cut(observation, values))
    calibrated = fit(problem, values, free_nominal_parameters(values, "voltage", 0.0), iterations=3)
    scales = characteristic_scales([observation], problem.shooting, calibrated)
    of_force = [effect for effect in applicable_effects([observation]) if effect.site == "force"]
    begin = [guess for effect in of_force for guess in initial_guesses(effect, scales)]
    alone = screening.screen_in_time(problem, calibrated, begin)
    monkeypatch.setattr(screening, "MOST_SPANS", 4)
    monkeypatch.setattr(screening, "LANES", 3)  # so that the guesses are simulated in several turns
    together = screening.screen_in_time(problem, calibrated, begin)
    always = [{repr(one.guess): one.gain for one in found if one.windows is None} for found in (alone, together)]
    assert len(always[0]) == len(begin)
    assert [always[1][guess] for guess in always[0]] == pytest.approx(list(always[0].values()), rel=1e-8)
    assert alone[0].guess.effect.id == together[0].guess.effect.id == "coulomb_friction"
    assert alone[0].windows == together[0].windows == (3, 6)
    assert {edge for one in together if one.windows for edge in one.windows} <= {0, 3, 6, 9, 12}


def test_spans_keep_to_their_recordings_and_are_few():
    assert np.array_equal(screening._spans([range(40)]), np.arange(41))
    spans = screening._spans([range(3), range(3, 703), range(703, 2003)])
    assert {0, 3, 703, 2003} <= set(spans.tolist())
    assert len(spans) - 1 <= screening.MOST_SPANS + 1
    assert np.max(np.diff(spans)) <= 21
