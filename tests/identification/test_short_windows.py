"""Short windows, on a rig that sticks, made by the exam's own truth with another form of the law."""

from pathlib import Path

import numpy as np
import pytest
from made import recorded

from eha_core.diagnosis.calibrate import SAMPLES_A_WINDOW, Calibration, calibrate
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.effects import effects
from eha_core.identification.fit import Ending, fit
from eha_core.identification.observation import observe
from eha_core.identification.short_windows import HELD, SHORT, held
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values
from eha_core.recording import Channel, Recording
from eha_exam.drawing import draw_case
from eha_exam.measuring import measure, simulate_case

LAW = next(effect for effect in effects() if effect.id == "stribeck_friction")
UNITS = {"voltage_command": "V", "position": "m", "pressure_a": "Pa", "pressure_b": "Pa"}


@pytest.fixture(scope="module")
def rig() -> tuple[Calibration, dict[str, float]]:
    case = draw_case("other_law", 0, 2026)
    assert case.effect_ids == ("stribeck_friction",)
    arrays = measure(case, simulate_case(case))
    channels = {name: Channel(name, *arrays[name], unit, name, "made") for name, unit in UNITS.items()}
    recording = Recording(Path("made.mcap"), channels, 0, case.duration, {}, (), None, ())
    nominal = {**nominal_values(), **case.nominal}
    return calibrate([observe(recording)], NominalModel(nominal), 2e-4), nominal


def test_the_recordings_are_the_same_in_windows_of_the_lengths_stated(rig):
    calibration, _ = rig
    assert SHORT == (0.03, 0.2)
    rate = calibration.problem.count() / (calibration.shooting.edges[-1] * calibration.shooting.step_size)
    for shooting, length in zip(calibration.shorter, SHORT, strict=True):
        spans = np.diff(shooting.edges) * shooting.step_size
        assert np.median(spans) == pytest.approx(max(length, SAMPLES_A_WINDOW / rate), rel=0.21)
        assert sum(len(one.values) for one in shooting.samplings) >= 0.99 * calibration.problem.count()


def test_a_window_holds_several_samples_for_each_state_at_its_start():
    alone = observe(recorded({}, duration=4.0, rate=200.0, channels=("voltage_command", "position")))
    shortest = calibrate([alone], NominalModel(nominal_values()), 2e-4).shorter[0]
    (position,) = shortest.samplings
    assert np.median(np.bincount(position.window)) >= 0.9 * SAMPLES_A_WINDOW


def test_what_is_held_is_the_plants_own_and_where_its_nominal_value_is(rig):
    calibration, nominal = rig
    values = {**nominal, f"{LAW.id}.force": 500.0, "moving_mass": 2.0 * nominal["moving_mass"]}
    free = with_effects(calibration.fitted.free, [LAW], values)
    for before, after in zip(free, held(free, values), strict=True):
        ours = before.name != "moving_mass" and not before.name.startswith(LAW.id)
        assert after.prior_deviation == pytest.approx((HELD if ours else 1.0) * before.prior_deviation)


def test_one_iteration_along_a_ridge_does_not_end_the_fit(rig):
    """The same fit until two iterations in a row gain too little goes further, and never less far."""
    calibration, nominal = rig
    begun = {"force": 200.0, "static_force": 400.0, "stribeck_velocity": 0.03}
    values = {**nominal, **{f"{LAW.id}.{name}": at for name, at in begun.items()}}
    free = with_effects(calibration.fitted.free, [LAW], values)
    once, twice = (fit(calibration.problem, values, free, iterations=40, in_a_row=times) for times in (1, 2))
    assert once.ending is Ending.CONVERGED
    assert twice.iterations > once.iterations and twice.objective < once.objective
