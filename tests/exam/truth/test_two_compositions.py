"""Truth and plant, written apart, agree on actuators that are put together otherwise than the paper's."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.plant import Plant, compose
from eha_exam.case import PRESSURE_NOISE
from eha_exam.errors import ExamError
from eha_exam.truth import resume_truth, simulate_truth

ROD = {"piston_area": 1.2e-3, "piston_area_b": 7.8e-4, "moving_mass": 30.0, "internal_leakage": 2e-12}
FRICTION = {"force": 150.0}
STEPS = 20

PUMP = {"pump_displacement": 1e-6, "pump_leakage": 2e-12, "supply_pressure": 1.2e7, "return_pressure": 3e5}
LANDS = {
    "valve_gain": 2.5e-5, "valve_natural_frequency": 5e3, "valve_damping_ratio": 0.7, "coil_inductance": 0.02,
    "pump_relief_gain": 1e-9, "pump_bypass_gain": 5e-7, "pump_bypass_spool": 1e-3,
}  # fmt: skip
"""A valve that takes a millisecond to switch, and bypasses the pump over a twentieth of its way in the middle."""
SWITCHED = {
    "tank_gain": LANDS["valve_gain"] * 0.02, "switching_frequency": LANDS["valve_natural_frequency"],
    "switching_damping": LANDS["valve_damping_ratio"], "bypass_gain": LANDS["pump_bypass_gain"],
    "valve_overlap": LANDS["pump_bypass_spool"] / 0.02,
}  # fmt: skip
"""The same in the plant's terms, whose valve has its ports shut where it bypasses the pump; 0.02 A is the full way."""
SWITCHING = 1e-3
"""s. Each switching may leave the two apart by what the pump moves the piston by in that time."""


def effects(friction: bool) -> list[tuple[str, dict[str, float]]]:
    return [("coulomb_friction", FRICTION)] if friction else []


def named(friction: bool) -> dict[str, float]:
    return {"coulomb_friction.force": FRICTION["force"]} if friction else {}


@pytest.mark.parametrize(
    "effects",
    [[], [("coulomb_friction", FRICTION)], [("load_friction", {"coefficient": 1e-4})]],
    ids=["smooth", "dry friction", "friction in proportion to the pressure"],
)
def test_a_single_rod_on_a_servo_valve(effects: list[tuple[str, dict[str, float]]]) -> None:
    time = np.arange(1001) / 1000.0
    command = 0.08 * np.sin(2.0 * np.pi * time) + 0.03 * np.sin(2.0 * np.pi * 4.3 * time)
    truth = simulate_truth(ROD, effects, command, 1.0)
    named = {f"{effect}.{name}": value for effect, values in effects for name, value in values.items()}
    model = Plant(ROD | named, 1e-3 / STEPS, composition=compose(cylinder="single_rod"))
    rows = model.run(np.repeat(command[:-1], STEPS), every=STEPS)
    assert np.sqrt(np.mean((truth["position"][1:] - rows.position) ** 2)) < 1e-8
    for pressure in ("pressure_a", "pressure_b"):
        assert np.sqrt(np.mean((truth[pressure][1:] - getattr(rows, pressure)) ** 2)) < 10.0


def driven() -> tuple[np.ndarray, np.ndarray]:
    """The pump's speed and the valve's sign at 1 kHz for 3 s: it extends, retracts and extends."""
    time = np.arange(3001) / 1000.0
    speed = 30.0 + 50.0 * np.sin(2.0 * np.pi * 0.5 * time) ** 2
    return speed, np.where(np.sin(2.0 * np.pi * 0.5 * time) >= 0.0, 1.0, -1.0)


@pytest.mark.parametrize("friction", [False, True])
def test_a_switched_pump_on_a_single_rod(friction: bool) -> None:
    """The truth has four lands in its valve; the plant has one share of open ports."""
    speed, valve = driven()
    truth = simulate_truth(
        ROD | PUMP | LANDS, effects(friction), 2.0 * valve, 3.0, pump_speed=speed, initial_position=-0.02
    )
    rig = compose(source="switched_pump", cylinder="single_rod")
    model = Plant(ROD | PUMP | SWITCHED | named(friction), 1e-3 / STEPS, -0.02, rig)
    rows = model.run(np.repeat(np.stack([speed, valve], axis=1)[:-1], STEPS, axis=0), every=STEPS)
    fastest = PUMP["pump_displacement"] * speed.max() / ROD["piston_area_b"]
    assert np.ptp(rows.position) > 0.05
    assert np.max(np.abs(truth["position"][1:] - rows.position)) < 3 * SWITCHING * fastest
    for pressure in ("pressure_a", "pressure_b"):
        assert np.median(np.abs(truth[pressure][1:] - getattr(rows, pressure))) < 0.1 * PRESSURE_NOISE


def test_the_truths_pump_stands_at_its_relief_valve_at_the_end_of_the_stroke() -> None:
    truth = simulate_truth(
        ROD | PUMP | LANDS, [], np.full(1501, 2.0), 1.5, pump_speed=np.full(1501, 80.0), initial_position=0.09
    )
    given = PUMP["pump_displacement"] * 80.0
    balance = (given + 2e-12 * 3e5 + 1e-9 * 1.2e7) / (2e-12 + 1e-9)
    past = ROD["internal_leakage"] * (balance - 3e5)
    # chamber A, its valve open, is at the line's pressure less what the seal's leakage drops over the land
    assert truth["position"][-1] == pytest.approx(0.1, abs=1e-9)
    assert truth["pressure_a"][-1] == pytest.approx(balance - past / 1e-9, rel=1e-3)


def test_a_pumped_truth_goes_on_from_any_sample() -> None:
    speed, valve = driven()
    whole = simulate_truth(ROD | PUMP | LANDS, [], 2.0 * valve, 0.6, pump_speed=speed, initial_position=-0.02)
    rest = resume_truth(ROD | PUMP | LANDS, [], whole, 300, 600)
    assert rest["position"] == pytest.approx(whole["position"][300:], abs=1e-8)
    assert rest["supply_pressure"] == pytest.approx(whole["supply_pressure"][300:], rel=1e-4)


def test_a_parameter_that_the_truth_does_not_have_is_named() -> None:
    with pytest.raises(ExamError, match="'tank_gain' is not one the truth knows"):
        simulate_truth({"tank_gain": 1.0}, [], np.zeros(11), 0.01)
