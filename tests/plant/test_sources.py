"""Actuators whose source is measured or a pump: closed forms, and SciPy on equations written out here."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eha_core.errors import ParameterError
from eha_core.plant import Plant, Trajectory, compose

STEP = 1e-4
ROD = {"piston_area": 1.2e-3, "piston_area_b": 7.8e-4, "moving_mass": 30.0}
TIME = STEP * np.arange(5000)
MIDDLE = TIME + 0.5 * STEP
BETA, LINE, STROKE, LEAK, DAMPING, MASS, SPRING = 1.4e9, 1e-5, 0.1, 1e-12, 2000.0, 30.0, 10.0
AREA_A, AREA_B, GAIN, SUPPLY = 1.2e-3, 7.8e-4, 2.38e-5, 2.1e7


def rig(source: str, position: float = 0.0, step_size: float = STEP, **more: float) -> Plant:
    return Plant(ROD | more, step_size, position, compose(source=source, cylinder="single_rod"))


def root(pressure: float) -> float:
    """sign(p) sqrt|p|, without the plant's rounding about zero."""
    return float(np.sign(pressure) * np.sqrt(abs(pressure)))


def solve(
    flows: Callable[[float, float, float, float], tuple[float, float]], plant: Plant, spool: float | None = None
) -> np.ndarray:
    """Position, velocity and both pressures (4, 5000), `flows` of time, spool and both pressures into A and out of B.

    With a `spool`, its position and rate follow a current of `spool` sin(6 pi t) by equation (2).
    """

    def rates(time: float, state: np.ndarray) -> list[float]:
        position, velocity, a, b, opening, rate = state
        into_a, out_of_b = flows(time, opening, a, b)
        past = LEAK * (a - b)
        force = AREA_A * a - AREA_B * b - DAMPING * velocity - SPRING * position
        current = 0.0 if spool is None else spool * np.sin(6.0 * np.pi * time)
        return [
            velocity,
            force / MASS,
            BETA / (LINE + AREA_A * (STROKE + position)) * (into_a - past - AREA_A * velocity),
            BETA / (LINE + AREA_B * (STROKE - position)) * (AREA_B * velocity - out_of_b + past),
            rate,
            543.0**2 * (current - opening) - 2.0 * 0.48 * 543.0 * rate,
        ]

    row = plant.state
    start = [row.position, 0.0, row.pressure_a, row.pressure_b, 0.0, 0.0]
    ends = STEP * np.arange(1, len(TIME) + 1)
    solution = solve_ivp(rates, (0.0, ends[-1] + STEP), start, "LSODA", ends, rtol=1e-9, atol=1e-12, max_step=1e-3)
    return np.asarray(solution.y[:4])


def apart(found: Trajectory, expected: np.ndarray) -> tuple[float, float]:
    """The largest difference in position [m] and in pressure [Pa]."""
    pressures = np.abs(np.stack([found.pressure_a, found.pressure_b]) - expected[2:])
    return float(np.max(np.abs(found.position - expected[0]))), float(np.max(pressures))


def valve_flow(opening: float, a: float, b: float) -> tuple[float, float]:
    if opening >= 0.0:
        return GAIN * opening * root(SUPPLY - a), GAIN * opening * root(b)
    return GAIN * opening * root(a), GAIN * opening * root(SUPPLY - b)


def test_a_measured_spool_agrees_with_scipy() -> None:
    plant = rig("measured_spool")
    expected = solve(lambda t, _, a, b: valve_flow(3e-4 * np.sin(6.0 * np.pi * t), a, b), plant)
    metres, pascals = apart(plant.run(3e-4 * np.sin(6.0 * np.pi * MIDDLE)), expected)
    assert metres < 1e-8
    assert pascals < 300.0


def test_a_measured_current_agrees_with_scipy() -> None:
    plant = rig("measured_current")
    expected = solve(lambda _, opening, a, b: valve_flow(opening, a, b), plant, spool=3e-4)
    metres, pascals = apart(plant.run(3e-4 * np.sin(6.0 * np.pi * MIDDLE)), expected)
    assert metres < 1e-8
    assert pascals < 300.0


def test_measured_flows_agree_with_scipy() -> None:
    plant = rig("measured_flow")
    speed = 0.05 * np.sin(6.0 * np.pi * MIDDLE)
    expected = solve(
        lambda t, *_: (0.05 * AREA_A * np.sin(6.0 * np.pi * t), 0.05 * AREA_B * np.sin(6.0 * np.pi * t)), plant
    )
    metres, pascals = apart(plant.run(np.stack([AREA_A * speed, AREA_B * speed], axis=1)), expected)
    assert metres < 1e-8
    assert pascals < 300.0


TANK, DISPLACEMENT, PORT, OVERLAP, FREQUENCY = 2e6, 2e-6, 2e-7, 0.2, 90.0


@pytest.mark.parametrize("bypass", [0.0, 1e-7])
@pytest.mark.parametrize("volume", [1e-4, 1e-5])
def test_a_pump_agrees_with_scipy_through_a_reversal(volume: float, bypass: float) -> None:
    """From tank pressure, extending for 0.25 s and then retracting, with the pump's line and the valve as states."""
    plant = rig(
        "switched_pump", pump_displacement=DISPLACEMENT, pump_leakage=1e-12, tank_gain=PORT, return_pressure=TANK,
        pump_line_volume=volume, bypass_gain=bypass, valve_overlap=OVERLAP, switching_frequency=FREQUENCY,
        switching_damping=0.8,
    )  # fmt: skip

    def rates(time: float, state: np.ndarray) -> list[float]:
        position, velocity, a, b, line, spool, rate = state
        share = np.sign(spool) * max(abs(spool) - OVERLAP, 0.0) / (1.0 - OVERLAP)
        given = DISPLACEMENT * (10.0 + 60.0 * np.sin(4.0 * np.pi * time) ** 2)
        lost = 1e-12 * (line - TANK) + 1e-9 * max(line - SUPPLY, 0.0)
        lost += bypass * max(1.0 - abs(spool) / OVERLAP, 0.0) * root(line - TANK)
        into_a = PORT * share * root(line - a if share > 0.0 else a - TANK)
        out_of_b = PORT * share * root(b - TANK if share > 0.0 else line - b)
        drawn = into_a if share > 0.0 else -out_of_b
        past, force = LEAK * (a - b), AREA_A * a - AREA_B * b - DAMPING * velocity - SPRING * position
        return [
            velocity,
            force / MASS,
            BETA / (LINE + AREA_A * (STROKE + position)) * (into_a - past - AREA_A * velocity),
            BETA / (LINE + AREA_B * (STROKE - position)) * (AREA_B * velocity - out_of_b + past),
            BETA / volume * (given - lost - drawn),
            rate,
            FREQUENCY**2 * ((1.0 if time < 0.25 else -1.0) - spool) - 1.6 * FREQUENCY * rate,
        ]

    ends = STEP * np.arange(1, len(TIME) + 1)
    start = [0.0, 0.0, plant.state.pressure_a, plant.state.pressure_b, TANK, 0.0, 0.0]
    options = {"rtol": 1e-8, "atol": 1e-10, "max_step": 5e-4}
    expected = solve_ivp(rates, (0.0, ends[-1] + STEP), start, "LSODA", ends, **options).y
    speed = 10.0 + 60.0 * np.sin(4.0 * np.pi * MIDDLE) ** 2
    found = plant.run(np.stack([speed, np.where(TIME < 0.25 - 1e-9, 1.0, -1.0)], axis=1))
    metres, pascals = apart(found, expected[:4])
    assert metres < 1e-6
    assert pascals < 6e3
    assert np.sqrt(np.mean((found.supply_pressure - expected[4]) ** 2)) < 5e3
    assert np.ptp(found.supply_pressure) > 4e6


@pytest.mark.parametrize(("valve", "area"), [(1.0, AREA_A), (-1.0, AREA_B)])
def test_a_pump_moves_the_piston_at_its_flow_over_the_area_it_fills(valve: float, area: float) -> None:
    still = {"pump_leakage": 0.0, "internal_leakage": 0.0, "spring_stiffness": 0.0}
    plant = rig("switched_pump", -0.05 * valve, pump_displacement=1e-6, **still)
    plant.advance((40.0, valve), 8000)
    assert plant.state.velocity == pytest.approx(valve * 40e-6 / area, rel=1e-6)
    assert plant.state.flow_a / AREA_A == pytest.approx(plant.state.flow_b / AREA_B, rel=1e-6)


def test_without_a_valve_signal_the_pumps_sign_switches() -> None:
    turned, switched = rig("switched_pump"), rig("switched_pump")
    speed = np.repeat([30.0, -30.0, 0.0, 30.0], 500)
    one = turned.run(speed, 10)
    two = switched.run(np.stack([np.abs(speed), np.sign(speed)], axis=1), 10)
    assert one.values.tobytes() == two.values.tobytes()


def test_a_pump_against_the_end_of_the_stroke_stands_at_its_relief_valve() -> None:
    """D n = C_p P + G_r (P - P_s): what the pump gives goes through its leakage and the relief valve."""
    plant = rig("switched_pump", 0.099, supply_pressure=1e7, pump_displacement=2e-6, internal_leakage=0.0)
    plant.advance((50.0, 1.0), 20000)
    assert plant.state.position == 0.1
    assert plant.state.pressure_a == pytest.approx((100e-6 + 1e-9 * 1e7) / (1e-13 + 1e-9), rel=1e-9)


def test_a_valve_in_the_middle_holds_the_piston() -> None:
    plant = rig("switched_pump", internal_leakage=0.0, spring_stiffness=0.0)
    plant.advance((40.0, 1.0), 3000)
    plant.advance((40.0, 0.0), 5000)
    held = plant.state
    plant.advance((40.0, 0.0), 5000)
    assert held.flow_a == held.flow_b == 0.0
    assert plant.state.position == pytest.approx(held.position, abs=1e-9)


def test_the_pumps_line_loses_and_makes_no_oil() -> None:
    """What a pump without leakage gives is what its line, chamber A and the leakage past the piston take up."""
    volume = 3e-5
    more = {"tank_gain": PORT, "return_pressure": TANK}  # so much that no chamber boils
    plant = rig("switched_pump", pump_leakage=0.0, pump_line_volume=volume, **more)
    speed = 40.0 * (1.2 + np.sin(6.0 * np.pi * MIDDLE))
    start, found = plant.state, plant.run(np.stack([speed, np.ones(len(speed))], axis=1))
    space = LINE + AREA_A * (STROKE + np.concatenate([[start.position], found.position]))
    pressure = np.concatenate([[start.pressure_a], found.pressure_a])
    compressed = np.sum(0.5 * (space[1:] + space[:-1]) * np.diff(pressure)) / BETA
    held = volume * (found.supply_pressure[-1] - start.supply_pressure) / BETA
    past = STEP * np.sum(found.internal_leakage_flow)
    assert np.max(found.supply_pressure) < SUPPLY and min(np.min(found.pressure_a), np.min(found.pressure_b)) > 0.0
    given = STEP * np.sum(1e-6 * speed)
    assert space[-1] - space[0] + compressed + held + past == pytest.approx(given, rel=1e-4)


@pytest.mark.parametrize("source", ["measured_flow", "measured_spool"])
def test_no_oil_is_lost_or_made(source: str) -> None:
    """What flows in is what the chambers' volumes and their compressed oil take up: V dP / beta over each chamber."""
    plant = rig(source)
    wave = np.sin(6.0 * np.pi * MIDDLE)
    flows = np.stack([6e-5 * wave, 3.9e-5 * wave], axis=1)
    given = {"measured_flow": flows, "measured_spool": 3e-4 * wave}[source]
    start, found = plant.state, plant.run(given)
    volume = LINE + AREA_A * (STROKE + np.concatenate([[start.position], found.position]))
    pressure = np.concatenate([[start.pressure_a], found.pressure_a])
    compressed = np.sum(0.5 * (volume[1:] + volume[:-1]) * np.diff(pressure)) / BETA
    moved = volume[-1] - volume[0]
    given_in = given[:, 0] if source == "measured_flow" else np.concatenate([[0.0], found.flow_a])
    middle = given_in if source == "measured_flow" else 0.5 * (given_in[1:] + given_in[:-1])
    entered = STEP * np.sum(middle - found.internal_leakage_flow)
    assert moved + compressed == pytest.approx(entered, abs=3e-4 * STEP * np.sum(np.abs(middle)))


def test_pressures_and_a_force_given_move_the_load_alike() -> None:
    """M x'' + B x' + K x = F under a constant force, from rest: the closed form of a strongly damped load."""
    pressed = rig("measured_pressures", damping_coefficient=400.0, spring_stiffness=900.0)
    pushed = Plant(
        {"moving_mass": 30.0, "damping_coefficient": 400.0, "spring_stiffness": 900.0}, STEP, 0.0,
        compose(source="measured_force", cylinder="single_rod"),
    )  # fmt: skip
    force = AREA_A * 1e6 - AREA_B * 1.5e6
    one = pressed.run(np.tile([1e6, 1.5e6], (5000, 1)), 10)
    two = pushed.run(np.full(5000, force), 10)
    slow, fast = np.roots([30.0, 400.0, 900.0])[::-1]
    time = one.time
    closed = force / 900.0 * (1.0 + (fast * np.exp(slow * time) - slow * np.exp(fast * time)) / (slow - fast))
    assert one.position == pytest.approx(closed, rel=1e-4, abs=1e-8)
    assert two.position == pytest.approx(one.position, rel=1e-12, abs=1e-15)
    assert np.all(np.isnan(one.flow_a)) and np.all(np.isnan(two.pressure_a))
    assert two.hydraulic_force == pytest.approx(np.full(500, force), rel=1e-12)


@pytest.mark.parametrize("source", ["measured_spool", "measured_current", "measured_flow", "switched_pump"])
def test_steps_may_be_taken_in_any_pieces(source: str) -> None:
    given = 1e-4 * np.sin(30.0 * MIDDLE[:900])
    given = np.stack([given, given], axis=1) if source == "measured_flow" else given * 1e5
    whole, plant = rig(source).run(given), rig(source)
    parts = np.concatenate([plant.run(part).values for part in np.split(given, [1, 7, 300])])
    assert whole.values.tobytes() == parts.tobytes()


def test_inputs_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ParameterError, match="measured_flow takes flow_a and flow_b for each step; 1 columns were giv"):
        rig("measured_flow").run(np.zeros(10))
    with pytest.raises(ParameterError, match="spool is not finite in some step"):
        rig("measured_spool").run(np.full(10, np.nan))
