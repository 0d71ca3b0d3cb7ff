"""Cases: drawn alike from the same seed, sound tests, sensors as stated, and an oracle of what can be identified."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eha_exam.case import Case
from eha_exam.cases import make_case
from eha_exam.concealed import DRAWS, SITES, draw_effect, scaled
from eha_exam.drawing import WORN_RIG, draw_case
from eha_exam.errors import ExamError
from eha_exam.excitation import SHAPES, draw_reference
from eha_exam.measuring import measure, simulate_case
from eha_exam.oracle import consult, seen_beside_the_others
from eha_exam.plants import FAMILIES, UNCERTAIN, draw_rig
from eha_exam.truth import effect_parameters


def short(tier: str, number: int, **changes: object) -> Case:
    """A case of 4 s at 500 Hz under the multisine, 1x noise, all sensors perfect but for it."""
    plain = {"duration": 4.0, "rate": 500.0, "noise": 1.0, "shape": "multisine", "loop": 1.0}
    perfect = {"position_step": 0.0, "pressure_step": 0.0, "jitter": 0.0, "dropout": 0.0}
    return replace(draw_case(tier, number, 3), **{**plain, **perfect, **changes})  # type: ignore[arg-type]


def test_a_case_depends_on_its_own_seed_tier_and_number_alone() -> None:
    assert draw_case("single", 7, 0) == draw_case("single", 7, 0)
    assert draw_case("single", 7, 0).seed != draw_case("single", 7, 1).seed != draw_case("small", 7, 1).seed
    with pytest.raises(ExamError, match="tier 'hard'"):
        draw_case("hard", 0, 0)


@pytest.mark.parametrize("effect", sorted(DRAWS))
def test_every_effect_can_be_drawn_with_the_truths_parameters(effect: str) -> None:
    generator = np.random.default_rng(1)
    for family in FAMILIES:
        setting = replace(draw_case("single", 0, 0).setting, rig=draw_rig(family, generator))
        values = draw_effect(effect, setting, generator)
        assert set(values) <= set(effect_parameters(effect))
        assert all(np.isfinite(float(value)) for value in values.values())
        assert effect in SITES
        assert scaled(effect, values, 1.0, setting.rig.area_ratio) == pytest.approx(values)


@pytest.mark.parametrize("shape", SHAPES)
def test_references_keep_to_stroke_and_speed_and_start_at_rest(shape: str) -> None:
    generator = np.random.default_rng(2)
    rig = draw_rig("light_servo", generator)
    time = np.arange(8001) / 1000.0
    reference = draw_reference(shape, rig, time, 0.03, 0.2, generator)
    assert np.max(np.abs(reference)) <= 0.03 * (1.0 + 1e-9)
    assert np.max(np.abs(np.gradient(reference, time))) <= 0.2 * (1.0 + 1e-9)
    assert reference[0] == 0.0
    assert np.ptp(reference) > 0.01


def test_nominal_parameters_are_as_far_off_as_the_tier_says() -> None:
    exact, off = draw_case("null", 4, 0), draw_case("null_parameters", 4, 0)
    assert all(exact.nominal[name] == exact.plant[name] for name in exact.nominal)
    errors = [off.nominal[name] / off.plant[name] - 1.0 for name in UNCERTAIN]
    assert 0.05 < max(np.abs(errors)) <= 0.3
    assert off.nominal["supply_pressure"] == off.plant["supply_pressure"]
    wrong = draw_case("wrong_rig", 4, 0)
    assert wrong.nominal["supply_pressure"] != wrong.plant["supply_pressure"]


def test_sensors_have_the_stated_noise_resolution_jitter_and_losses() -> None:
    case = short("null", 1, noise=3.0)
    truth = simulate_case(case)
    clean = measure(case, truth)
    for channel, level in (("position", 30e-6), ("pressure_a", 3e4), ("pressure_b", 3e4)):
        time, values = clean[channel]
        np.testing.assert_array_equal(time, truth["time"])
        assert np.std(values - truth[channel]) == pytest.approx(level, rel=0.06)
    rough = replace(case, position_step=5e-6, pressure_step=5e3, jitter=1e-4, dropout=0.02)
    time, values = measure(rough, truth)["pressure_a"]
    assert 0.97 < len(time) / len(truth["time"]) < 0.985
    assert np.all(np.diff(time) > 0.0)
    np.testing.assert_allclose(np.round(values / 5e3) * 5e3, values)
    assert np.std(time - np.round(time * 500.0) / 500.0) == pytest.approx(1e-4, rel=0.1)


def test_a_test_that_would_hit_an_end_is_run_with_a_centring_loop() -> None:
    case = short("single", 3, loop=0.0, effects=(("valve_null_offset", {"offset": 3e-4}),))
    truth = simulate_case(case)
    assert np.max(np.abs(truth["position"])) < 0.92 * case.plant["actuator_displacement"]
    assert 3e-4 * case.setting.rig.speed_per_ampere(1.0) * case.duration > case.plant["actuator_displacement"]


def test_the_oracle_sees_a_large_effect_and_not_one_lost_in_noise() -> None:
    case = short("single", 12, duration=1.5, effects=(("hardening_spring", {"coefficient": 3e8}),))
    assert consult(case, simulate_case(case)).decidable
    faint = replace(case, effects=(("hardening_spring", {"coefficient": 1e3}),))
    assert not consult(faint, simulate_case(faint)).decidable


def test_the_oracle_knows_that_a_parameter_imitates_its_own_change() -> None:
    """Damping that is lower from the start is no missing physics, though an effect may describe it."""
    case = short("single", 12, duration=2.5)
    drift = {"leakage_ratio": 0.0, "damping_ratio": 0.3, "time_constant": 1e-4}
    thin = replace(case, effects=(("thermal_drift", drift),))
    insight = consult(thin, simulate_case(thin))
    assert insight.imitation["damping_coefficient"] == pytest.approx(-0.3, rel=0.1)
    assert not insight.decidable


def test_what_the_oracle_sees_beside_another_effect_is_what_that_does_not_explain() -> None:
    spring, delay = ("hardening_spring", {"coefficient": 3e8}), ("command_delay", {"delay": 1e-7})
    case = short("single", 12, duration=1.5, effects=(spring, delay))
    truth = simulate_case(case)
    assert consult(case, truth, delay).beyond_rival > 1000.0
    assert consult(case, truth, spring).beyond_rival < 1.0


def test_the_oracle_lets_the_shape_of_another_law_imitate_a_sensors_scale() -> None:
    """A position that reads 8 % short moves a worn place, makes it narrower, and cannot be distinguished from that."""
    worn = ("bore_wear_leakage", {"coefficient": 4e-11, "centre": 0.01, "width": 0.008})
    case = short("single", 12, duration=3.0, effects=(worn, ("position_sensor_scale", {"ratio": -0.08})))
    truth = simulate_case(case)
    assert seen_beside_the_others(case, truth) == ("bore_wear_leakage",)


def test_a_made_case_is_kept_and_found_again(tmp_path: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EHA_CACHE_DIR", str(tmp_path))
    first = make_case("null", 0, 11)
    again = make_case("null", 0, 11)
    assert first[0] == again[0]
    np.testing.assert_array_equal(first[1]["position"][1], again[1]["position"][1])


def test_a_test_that_would_draw_a_vacuum_is_run_more_gently() -> None:
    # a load that outruns the oil of a single-rod cylinder, but in the gentlest test
    sticky = (("position_sensor_backlash", {"half_width": 1.8e-4}), ("coulomb_friction", {"force": 889.4}))
    test = {"shape": "chirp", "loop": 0.0, "rate": 500.0, "noise": 3.0, "effects": sticky}
    case = replace(draw_case("pair", 8, 2028), **test)  # type: ignore[arg-type]
    truth = simulate_case(case)
    assert min(truth["pressure_a"].min(), truth["pressure_b"].min()) > -0.5e5
    assert np.max(np.abs(truth["position"])) < 0.92 * case.plant["actuator_displacement"]


def test_a_worn_rig_has_four_to_six_effects_and_never_two_of_one_kind() -> None:
    for number in range(12):
        names = [name for name, _ in draw_case("rig", number, 5).effects]
        assert len(names) == 4 + number % 3
        assert all(len(set(group) & set(names)) <= 1 for group in WORN_RIG)
    assert len(draw_case("three", 0, 5).effects) == 3


def test_an_event_is_one_effect_for_a_while_beside_others_that_always_act() -> None:
    for number in range(16):
        case = draw_case("event", number, 5)
        ((passing, (begin, end)),) = case.windows.items()
        assert 0.0 < begin < end < case.duration
        assert passing == case.effects[0][0]
        assert len({name for name, _ in case.effects}) == len(case.effects) == 2 + number % 2


def test_of_several_effects_the_oracle_tells_which_show_beside_the_others() -> None:
    spring, delay = ("hardening_spring", {"coefficient": 3e8}), ("command_delay", {"delay": 1e-7})
    case = short("single", 12, duration=1.5, effects=(spring, delay))
    assert seen_beside_the_others(case, simulate_case(case)) == ("hardening_spring",)
