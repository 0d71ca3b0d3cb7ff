"""What is claimed is what the recording bears: real fits to recordings whose answer is known."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made import LAWS, recorded
from scipy.signal import lfilter

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.conclude import polish
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.diagnosis.explained import root_mean_square
from eha_core.diagnosis.fitted_values import named_effects
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.comparison import Entry, ModelComparison
from eha_core.diagnosis.supported import one_sided, supported
from eha_core.diagnosis.verdict import Decision
from eha_core.identification.fit import fit
from eha_core.identification.intervals import with_residual
from eha_core.identification.observation import observe
from eha_core.identification.problem import whole
from eha_core.identification.together import cut_together
from eha_core.identification.validate import Judged
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values
from eha_core.plant import PAPER
from eha_core.quantities import quantity


@pytest.fixture(scope="module")
def sound():
    """The evidence of a rig that lacks nothing."""
    return evidence_of(recorded({}, duration=4.0))


def entry(evidence, start):
    """A set of effects fitted from these values."""
    chosen = [LAWS[name] for name in sorted({name.partition(".")[0] for name in start})]
    calibrated = evidence.calibration.fitted
    begun = {**calibrated.values, **start}
    free = with_effects(calibrated.free, chosen, begun)
    found = fit(evidence.calibration.problem, begun, free, calibrated.states, iterations=10)
    return Entry(NOTHING.with_effects(chosen), found, 30.0)


def evidence_of(recording):
    """What is known of a recording before anything is compared."""
    observation = observe(recording)
    calibration = calibrate([observation], NominalModel(nominal_values()), 2e-4)
    return SimpleNamespace(
        observation=observation,
        observations=(observation,),
        nominal=nominal_values(),
        calibration=calibration,
        comparison=ModelComparison(Entry(NOTHING, calibration.fitted, 0.0), (), 1.0),
    )


def test_an_effect_whose_interval_holds_nothing_is_not_named(sound):
    winner = entry(sound, {"constant_load.force": 3.0})
    found = supported(sound, Decision("missing_physics", winner, (), None, None))
    assert (found.verdict, found.winner.ids) == ("consistent", ())


def test_what_predicts_worse_than_the_nominal_model_is_never_given(sound):
    winner = Entry(NOTHING, sound.calibration.fitted, 0.0)
    bad = Judged(1e6, 1000, {}, {})
    found = supported(sound, Decision("parameters", winner, (), None, bad))
    assert found.as_given and found.winner.fit is sound.calibration.nominal
    assert found.verdict == "consistent"
    assert found.judged_winner is found.judged_nominal and found.judged_winner.chi_square < 1e5
    fine = Decision("parameters", winner, (), None, replace(found.judged_winner))
    assert supported(sound, fine) is fine


def test_where_the_nominal_model_is_far_off_too_something_is_missing_that_has_no_name(sound):
    off = replace(sound.calibration.nominal, residuals=tuple(9.0 * one for one in sound.calibration.nominal.residuals))
    evidence = SimpleNamespace(**{**vars(sound), "calibration": replace(sound.calibration, nominal=off)})
    found = supported(evidence, Decision("parameters", Entry(NOTHING, off, 0.0), (), None, Judged(1e6, 1000, {}, {})))
    assert (found.verdict, found.as_given) == ("unknown_physics", True)


@pytest.fixture(scope="module", params=[2e3, 3e4], ids=["from below", "from above"])
def stuck(request):
    """A piston that 40 kN of friction hold; what the oil pushes with is some kilonewtons. The fit ends at 12 kN, where
    the piston just rests and chi^2 has no curvature any more, or where it begins."""
    given = nominal_values() | {"coulomb_friction.force": request.param}
    observation = observe(recorded({"coulomb_friction.force": 4e4}, duration=2.0))
    problem = whole(cut_together([observation], given, 2e-4))
    free = with_effects((), [LAWS["coulomb_friction"]], given)
    found = fit(problem, given, free, iterations=8)
    return SimpleNamespace(observation=observation, calibration=SimpleNamespace(problem=problem)), found


def test_friction_that_holds_a_piston_is_so_much_at_least(stuck):
    evidence, found = stuck
    winner = Entry(NOTHING.with_effects([LAWS["coulomb_friction"]]), found, 1e4)
    final = with_residual(evidence.calibration.problem, found)
    ends = one_sided(evidence, final, winner)
    low, high = ends["coulomb_friction.force"]
    pushed = max(evidence.observation.channel(f"pressure_{one}").values.max() for one in "ab") * 645e-6
    assert high is None
    assert 500.0 < low < pushed
    (named,) = named_effects(winner, final, PAPER, (), ends)
    assert named.parameters["force"].interval == (low, None)
    assert f"at least {quantity(low, 'N')} of dry friction" in named.statement


def with_channel(recording, name, change):
    """The recording with one channel's times and values changed."""
    channel = recording.channels[name]
    time, values = change(channel.time, channel.values)
    return replace(recording, channels={**recording.channels, name: replace(channel, time=time, values=values)})


def test_the_lag_of_a_filter_lies_in_its_interval_and_leaves_noise():
    """25 Hz at 1 kHz: k / (1 - k) samples late, with k = exp(-2 pi 25 / 1000); the noise is behind the filter, too."""
    kept = float(np.exp(-2.0 * np.pi * 25.0 / 1000.0))

    def filtered(time, values):
        passed, _ = lfilter([1.0 - kept], [1.0, -kept], values, zi=[kept * values[0]])
        return time, passed

    evidence = evidence_of(with_channel(recorded({}, duration=5.0, rate=1000.0), "pressure_a", filtered))
    assert [fault.fault for fault in evidence.observation.health] == ["low_passed"]
    lag = "pressure_sensor_lag.time_constant"
    winner = entry(evidence, {f"{lag}_a": 5e-3, f"{lag}_b": 1e-3})
    found = supported(evidence, Decision("missing_physics", winner, (), None, None))
    assert found.winner.ids == ("pressure_sensor_lag",)
    final = polish(evidence, found.winner)
    for name, true in ((f"{lag}_a", 1e-3 * kept / (1.0 - kept)), (f"{lag}_b", 0.0)):
        assert abs(final.values[name] - true) < 2.0 * final.deviation(name) < 2e-3
    times = dict(zip(evidence.calibration.shooting.names, map(root_mean_square, final.residuals), strict=True))
    assert times["pressure_a"] < 1.0 and times["pressure_b"] == pytest.approx(1.0, abs=0.05)


def test_a_late_command_names_late_sensors_as_its_rival():
    """All sensors stamped 25 ms late: a delay that no recording tells from the valve's."""
    recording = recorded({}, duration=3.0)
    for name in ("position", "pressure_a", "pressure_b"):
        recording = with_channel(recording, name, lambda time, values: (time + 0.025, values))
    given = nominal_values() | {"command_delay.delay": 0.015}
    problem = whole(cut_together([observe(recording)], given, 2e-4))
    found = fit(problem, given, with_effects((), [LAWS["command_delay"]], given), iterations=12)
    assert found.values["command_delay.delay"] == pytest.approx(0.025, abs=3e-4)
    (named,) = named_effects(Entry(NOTHING.with_effects([LAWS["command_delay"]]), found, 1e3), found, PAPER, ())
    assert "the valve acts late, or all sensors are stamped late alike" in named.statement
