"""What imitates a concealed effect: its derivatives, and an imitation that is known in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eha_exam.drawing import draw_case
from eha_exam.imitation import SHIFTS, Doubted, as_soft, left_by_the_best, length
from eha_exam.measuring import simulate_case
from eha_exam.oracle import NAMES, consult, seen_beside_the_others

READS_SHORT = ("position_sensor_scale", {"ratio": -0.09})
FIRST = 500


@pytest.fixture(scope="module")
def doubted() -> Doubted:
    case = replace(draw_case("single", 7, 11), duration=3.0, effects=(READS_SHORT,))
    return Doubted(case, simulate_case(case), NAMES, ())


def of_a_rig_that_reads_right(model: Doubted, scale: float) -> np.ndarray:
    """Changes with which the equations hold for a position `scale` times as large: the flows and volumes of a piston
    that moves so much further, and the mass, damping and spring of one that the same forces move so."""
    plant = model.case.plant
    oil_and_ports = plant["actuator_displacement"] + plant["line_volume"] / plant["piston_area"]
    longer = scale * oil_and_ports - plant["line_volume"] / plant["piston_area"]
    known = {
        "valve_gain": scale - 1.0,
        "internal_leakage": scale - 1.0,
        "moving_mass": 1.0 / scale - 1.0,
        "damping_coefficient": 1.0 / scale - 1.0,
        "spring_stiffness": 1.0 / scale - 1.0,
        "actuator_displacement": longer / plant["actuator_displacement"] - 1.0,
    }
    return np.array([known.get(name, 0.0) for name in NAMES])


def test_a_sensors_scale_is_imitated_by_gain_leakage_volumes_mass_damping_and_spring(doubted: Doubted) -> None:
    scale = 1.0 + READS_SHORT[1]["ratio"]
    start = {name: doubted.truth[name][FIRST] for name in SHIFTS}
    shift = np.array([(scale - 1.0) * start["position"], (scale - 1.0) * start["velocity"], 0.0, 0.0])
    imitated = doubted.simulated(FIRST, of_a_rig_that_reads_right(doubted, scale), shift / list(SHIFTS.values()))
    far = doubted.simulated(FIRST, np.zeros(doubted.size), np.zeros(4)) - doubted.recorded(FIRST)
    assert np.max(np.abs(far)) > 50.0
    np.testing.assert_allclose(imitated, doubted.recorded(FIRST), atol=0.02)


def test_the_best_imitation_is_found_where_one_linearisation_does_not_reach(doubted: Doubted) -> None:
    starts = [FIRST, FIRST + length(doubted.case)]
    assert left_by_the_best(doubted, starts, np.zeros(doubted.size), 1.0) < 1.0


def test_an_effect_that_nothing_imitates_is_left() -> None:
    spring = ("hardening_spring", {"coefficient": 3e8})
    case = replace(draw_case("single", 7, 11), duration=3.0, effects=(spring,))
    model = Doubted(case, simulate_case(case), NAMES, ())
    assert left_by_the_best(model, [FIRST], np.zeros(model.size), 1.0) > 1000.0


def test_derivatives_by_a_kept_effects_parameter_and_by_the_start(doubted: Doubted) -> None:
    play = ("position_sensor_backlash", {"half_width": 2e-4})
    case = replace(doubted.case, effects=(play, READS_SHORT))
    model = Doubted(case, simulate_case(case), NAMES, (play,))
    assert model.size == len(NAMES) + 1
    window = model.linearised(FIRST, np.zeros(model.size), np.zeros(4))
    samples = length(case) + 1
    # play that is wider by all of itself, and a piston a step further on, whose play goes with it
    assert np.max(np.abs(window.by_change[:samples, -1])) == pytest.approx(2e-4 / (case.noise * 1e-5), rel=0.01)
    assert window.by_shift[0, 0] == pytest.approx(SHIFTS["position"] / (case.noise * 1e-5), rel=1e-6)


def test_a_scale_of_the_position_sensor_does_not_show_where_nothing_holds_the_piston(doubted: Doubted) -> None:
    case, truth = doubted.case, doubted.truth
    assert not consult(case, truth).decidable
    play = ("position_sensor_backlash", {"half_width": 2e-4})
    both = replace(case, effects=(play, READS_SHORT))
    assert "position_sensor_scale" not in seen_beside_the_others(both, simulate_case(both))


def test_oil_as_soft_as_one_with_air(doubted: Doubted) -> None:
    case = replace(doubted.case, effects=(("entrained_air", {"air_fraction": 0.03}),))
    model = Doubted(case, doubted.truth, NAMES, ())
    modulus, below = case.plant["bulk_modulus"], 101325.0
    gauge = np.mean([doubted.truth["pressure_a"], doubted.truth["pressure_b"]])

    def volume(gauge: float) -> float:
        return 0.97 * np.exp(-gauge / modulus) + 0.03 * (below / (gauge + below)) ** (1.0 / 1.4)

    mixture = -volume(gauge) * 2e3 / (volume(gauge + 1e3) - volume(gauge - 1e3))
    changes = as_soft(model)
    assert changes[NAMES.index("bulk_modulus")] == pytest.approx(mixture / modulus - 1.0, rel=1e-5)
    assert np.count_nonzero(changes) == 1
    assert not as_soft(replace(model, kept=case.effects)).any()
    assert not as_soft(doubted).any()


def test_a_little_air_does_not_show_where_the_oil_rings(doubted: Doubted) -> None:
    friction = ("stribeck_friction", {"force": 300.0, "static_force": 500.0, "stribeck_velocity": 0.02})
    case = replace(doubted.case, effects=(friction, ("entrained_air", {"air_fraction": 0.005})))
    assert seen_beside_the_others(case, simulate_case(case)) == ("stribeck_friction",)
