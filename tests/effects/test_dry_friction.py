"""Coulomb and Stribeck friction: braking, sticking and breaking away, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eha_core.parameters import nominal_values
from eha_core.plant import Plant
from eha_core.plant.composite import compiled_step
from eha_core.plant.packing import pack


def coast(friction: dict[str, float], speed: float, step_size: float, steps: int, force: float = 0.0) -> np.ndarray:
    """Speeds of a 9 kg piston, free but for the friction, under a steady pressure force."""
    free = {"damping_coefficient": 0.0, "spring_stiffness": 0.0}
    vector, active, _ = pack(nominal_values() | free | friction, step_size)
    memory, speeds, position = np.zeros(64), [], 0.0
    for _ in range(steps):
        speed, _, _ = compiled_step().piston_step(
            step_size, position, speed, force / 645e-6, 0.0, 645e-6, 0.0, 0.0, memory, vector, active
        )
        position += step_size * speed
        speeds.append(speed)
    return np.array(speeds)


@pytest.mark.parametrize("step_size", [1e-5, 1e-4, 1e-3])
def test_coulomb_friction_brakes_evenly_and_then_holds(step_size: float) -> None:
    steps = round(0.03 / step_size)
    speeds = coast({"coulomb_friction.force": 180.0}, -0.4, step_size, steps)
    time = step_size * np.arange(1, steps + 1)
    assert speeds == pytest.approx(np.minimum(0.0, -0.4 + 20.0 * time), abs=1e-12)
    assert np.all(speeds[time > 0.02 + step_size] == 0.0)


def test_coulomb_friction_lets_go_of_what_exceeds_it() -> None:
    assert np.all(coast({"coulomb_friction.force": 180.0}, 0.0, 1e-4, 100, force=179.9) == 0.0)
    assert coast({"coulomb_friction.force": 180.0}, 0.0, 1e-4, 100, force=198.0)[-1] == pytest.approx(18.0 / 9.0 * 0.01)


def test_friction_under_load_takes_its_share_of_the_pressure() -> None:
    share = {"load_friction.coefficient": 0.2 * 645e-6}
    assert coast(share, 0.0, 1e-4, 100, force=300.0)[-1] == pytest.approx(0.8 * 300.0 / 9.0 * 0.01)
    braking = coast(share, -0.4, 1e-4, 100, force=300.0)[-1]
    assert braking == pytest.approx(-0.4 + 1.2 * 300.0 / 9.0 * 0.01)
    assert np.all(coast({"load_friction.coefficient": 1.01 * 645e-6}, 0.0, 1e-4, 100, force=300.0) == 0.0)


STRIBECK = {
    "stribeck_friction.force": 100.0, "stribeck_friction.static_force": 250.0,
    "stribeck_friction.stribeck_velocity": 0.05,
}  # fmt: skip


@pytest.mark.parametrize("shape", [1.0, 2.0, 3.5])
def test_stribeck_friction_brakes_the_more_the_slower(shape: float) -> None:
    def braking(_: float, speed: np.ndarray) -> np.ndarray:
        return -(100.0 + 150.0 * np.exp(-((speed / 0.05) ** shape))) / 9.0

    speeds = coast(STRIBECK | {"stribeck_friction.shape": shape}, 0.3, 1e-5, 1800)
    expected = solve_ivp(braking, (0.0, 0.02), [0.3], rtol=1e-10, atol=1e-12, t_eval=1e-5 * np.arange(1, 1801)).y[0]
    assert speeds == pytest.approx(expected, abs=2e-4)


def test_stribeck_friction_holds_its_static_force_and_then_falls() -> None:
    assert np.all(coast(STRIBECK, 0.0, 1e-4, 100, force=249.0) == 0.0)
    # at 0.5 m/s nothing of the static force is left: 255 N - 100 N accelerate 9 kg
    speeds = coast(STRIBECK, 0.5, 1e-4, 100, force=255.0)
    assert speeds[-1] - 0.5 == pytest.approx(155.0 / 9.0 * 0.01, rel=1e-6)


def test_slow_motion_sticks_and_slips_with_stribeck_friction_and_not_with_coulomb_friction() -> None:
    soft = {"moving_mass": 150.0, "bulk_modulus": 2e8, "damping_coefficient": 200.0, "internal_leakage": 0.0}

    def stops(friction: dict[str, float]) -> int:
        rests = Plant(friction | soft).run(np.full(20000, 1.5e-3)).velocity[3000:] == 0.0
        return int(np.count_nonzero(np.diff(rests.astype(int)) == 1))

    sticky = {
        "stribeck_friction.force": 200.0, "stribeck_friction.static_force": 600.0,
        "stribeck_friction.stribeck_velocity": 0.02,
    }  # fmt: skip
    assert stops(sticky) > 10
    assert stops({"coulomb_friction.force": 200.0}) == 0


def level(speed: float) -> float:
    return 100.0 + 300.0 * np.exp(-((speed / 0.05) ** 2))


def sliding(_: float, state: np.ndarray) -> list[float]:
    """The rate of a 9 kg piston's speed under 350 N, through friction that falls over the speed."""
    return [(350.0 - level(state[0])) / 9.0]


def from_rest(_: float, state: np.ndarray) -> list[float]:
    """The same under 450 N, with a bristle that bends first."""
    speed, bend = state
    bending = speed - 1e7 * abs(speed) / level(speed) * bend
    return [(450.0 - 1e7 * bend - 2e3 * bending) / 9.0, bending]


FALLING = {"force": 100.0, "static_force": 400.0, "stribeck_velocity": 0.05}
BRISTLE = FALLING | {"stiffness": 1e7, "damping": 2e3}


@pytest.mark.parametrize(
    ("effect", "parameters", "rates", "begun", "force", "within"),
    [
        ("stribeck_friction", FALLING, sliding, [0.03], 350.0, 5e-5),
        ("presliding_friction", BRISTLE, from_rest, [0.0, 0.0], 450.0, 4e-4),
    ],
)
def test_friction_that_falls_over_the_speed_is_of_second_order(effect, parameters, rates, begun, force, within) -> None:
    values = {f"{effect}.{name}": value for name, value in parameters.items()}
    errors = []
    for step_size in (2e-4, 1e-4, 5e-5):
        steps = round(0.012 / step_size)
        found = coast(values, begun[0], step_size, steps, force=force)
        times = step_size * np.arange(1, steps + 1)
        expected = solve_ivp(rates, (0.0, 0.0121), begun, "Radau", times, rtol=1e-10, atol=1e-14).y[0]
        errors.append(np.max(np.abs(found - expected)))
    assert errors[1] < within
    assert np.all(np.log2(np.array(errors[:-1]) / errors[1:]) > 1.7)


@pytest.mark.parametrize("shape", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("step_size", [1e-4, 1e-3])
def test_a_fall_too_steep_for_the_step_only_brakes(shape: float, step_size: float) -> None:
    steep = STRIBECK | {"stribeck_friction.stribeck_velocity": 1e-5, "stribeck_friction.shape": shape}
    for speed in (1e-6, 1e-5, 3e-5, 1e-3):
        speeds = np.abs(coast(steep, speed, step_size, 200))
        assert np.all(np.diff(np.append(speed, speeds)) <= 0.0)
        assert speeds[-1] == 0.0
