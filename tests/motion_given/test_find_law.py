"""A law is found where it is there, with its values, and none is found where there is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from benches import TIME, bouc_wen, motion, position, recording, velocity

from eha_core.errors import RecordingError
from eha_core.motion_given import Law, find_law, fit_law, is_motion_given, motion_of, predict
from eha_core.motion_given.terms import moving_average

V, X = velocity(TIME), position(TIME)
ACCELERATION = np.gradient(V, TIME)
PRESSURE = 4e5 + 2e5 * np.sin(2.0 * np.pi * 0.31 * TIME)


def held(law: Law, term: str, name: str, truth: float, least: float = 0.01) -> bool:
    """Whether four deviations, or `least` of the truth, hold it: what differentiating the position costs."""
    found = law.values[term][name]
    return abs(found.value - truth) < max(4.0 * found.std, least * abs(truth))


def test_dry_and_viscous_friction_are_told_apart() -> None:
    law = find_law([motion(150.0 * np.sign(V) + 900.0 * V)])
    assert law.ids == ("viscous_friction", "coulomb_friction")
    assert held(law, "coulomb_friction", "force", 150.0)
    assert held(law, "viscous_friction", "damping", 900.0)
    assert law.share_left < 0.06


def test_friction_that_differs_by_direction_is_not_a_load() -> None:
    law = find_law([motion(np.where(V > 0.0, 1200.0, 700.0) * V + 60.0 * np.sign(V))])
    assert law.ids == ("directional_damping", "coulomb_friction")
    assert held(law, "directional_damping", "forward", 1200.0)
    assert held(law, "directional_damping", "backward", 700.0)


def test_hysteretic_friction_keeps_its_distance_and_creep() -> None:
    law = find_law([motion(bouc_wen(400.0, 4e-4, 0.01) + 800.0 * V)])
    assert set(law.ids) == {"bouc_wen_friction", "viscous_friction"}
    assert held(law, "bouc_wen_friction", "force", 400.0, 0.02)
    assert held(law, "bouc_wen_friction", "distance", 4e-4, 0.05)
    assert held(law, "bouc_wen_friction", "creep_speed", 0.01, 0.05)


def test_friction_grows_with_the_pressure() -> None:
    force = (40.0 + 3e-4 * PRESSURE) * np.sign(V)
    law = find_law([motion_of(recording(force, pressure_a=PRESSURE))])
    assert law.ids == ("coulomb_friction", "load_friction")
    assert held(law, "load_friction", "coefficient", 3e-4)
    assert held(law, "coulomb_friction", "force", 40.0, 0.03)


def test_both_pressures_stand_in_for_the_force() -> None:
    force = 150.0 * np.sign(V) + 900.0 * V
    areas = (2e-3, 1.5e-3)
    back = 2e6 + 3e5 * np.sin(2.0 * np.pi * 0.31 * TIME)
    bench = recording(force, pressure_a=(force + areas[1] * back) / areas[0], pressure_b=back)
    pushed = replace(bench, channels={name: one for name, one in bench.channels.items() if name != "force"})
    np.testing.assert_allclose(motion_of(pushed, areas).force, force, atol=1e-6)
    assert find_law([motion_of(pushed, areas)]).ids == ("viscous_friction", "coulomb_friction")
    with pytest.raises(RecordingError, match="force or both pressures"):
        motion_of(pushed)


def test_mass_spring_and_load_are_told_from_friction() -> None:
    law = find_law([motion(12.0 * ACCELERATION + 4000.0 * X + 90.0 + 500.0 * V)])
    assert set(law.ids) == {"moving_mass", "spring", "constant_load", "viscous_friction"}
    assert held(law, "moving_mass", "mass", 12.0)
    assert held(law, "spring", "stiffness", 4000.0)


def test_a_force_that_is_noise_has_no_law() -> None:
    assert find_law([motion(np.zeros_like(TIME), noise=5.0)]).ids == ()


def test_a_detail_is_not_named_and_what_matters_is() -> None:
    force = 150.0 * np.sign(V) + 900.0 * V
    amplitude = np.std(X)
    for share, expected in ((0.005, False), (0.05, True)):
        law = find_law([motion(force + share * np.std(force) / amplitude * X)])
        assert ("spring" in law.ids) == expected


def test_a_law_predicts_a_motion_whose_force_it_has_not_seen() -> None:
    law = fit_law([motion(150.0 * np.sign(V) + 900.0 * V)], ["viscous_friction", "coulomb_friction"])
    unseen = motion(np.zeros_like(TIME), seed=8)
    error = predict(law, unseen) - (150.0 * np.sign(V) + 900.0 * V)
    moves = np.abs(V) > 2.0 * unseen.moving
    assert np.max(np.abs(error[moves])) < 0.02 * 150.0


def test_intervals_hold_the_truth_where_the_residual_is_coloured() -> None:
    """Twenty recordings, each with a slow disturbance that no term explains: white intervals would be far too short."""
    inside = []
    for seed in range(20):
        generator = np.random.default_rng(seed)
        slow = moving_average(generator.standard_normal(len(TIME)), 0.3 * 500.0)
        force = 150.0 * np.sign(V) + 900.0 * V + 20.0 * slow / np.std(slow)
        law = fit_law([motion(force, seed=seed)], ["viscous_friction", "coulomb_friction"])
        found = law.values["coulomb_friction"]["force"]
        inside.append(abs(found.value - 150.0) < 2.0 * found.std + 0.5)
    assert sum(inside) >= 16


def test_a_window_need_not_be_whole_samples() -> None:
    ramp = np.arange(50.0)
    np.testing.assert_allclose(moving_average(ramp, 4.5)[5:-5], ramp[5:-5])
    wave = np.sin(2.0 * np.pi * np.arange(400) / 40.0)
    inner = moving_average(wave, 12.5)[20:-20]
    assert np.max(inner) == pytest.approx(np.sinc(12.5 / 40.0), rel=0.01)


def test_motion_is_given_where_nothing_drives() -> None:
    bench = recording(900.0 * V)
    assert is_motion_given(bench)
    assert not is_motion_given(recording(900.0 * V, voltage_command=np.sin(TIME)))
    with pytest.raises(RecordingError, match="no force channel"):
        motion_of(type(bench).from_arrays(time=TIME, position=X))
    with pytest.raises(RecordingError, match="nothing moves"):
        motion_of(
            type(bench).from_arrays(
                time=TIME, position=1e-6 * np.random.default_rng(1).standard_normal(len(TIME)), force=V
            )
        )
