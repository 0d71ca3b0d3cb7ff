"""Laws planted as closed forms come back as formulas; noise gives none."""

import re

import numpy as np
import pytest
from made import recorded

from eha_core.curve import KNOTS
from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.law import express, weak_law
from eha_core.identification.observation import Measured, observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values
from eha_core.weak_form.equation_residuals import (
    EquationResidual,
    continuity_residual,
    equation_residuals,
    force_residual,
)
from eha_core.weak_form.grid import make_grid

AREA, MASS, DAMPING = 645e-6, 9.0, 2000.0
DURATION, STEP = 16.0, 1e-3
FREQUENCIES, SIZES, PHASES = (0.31, 0.83, 1.7, 2.9), (0.02, 0.012, 0.006, 0.003), (0.4, 1.9, 3.3, 5.1)
VALUES = nominal_values()


def numbers(text: str) -> list[float]:
    """The numbers in a formula, units and exponents of terms left aside."""
    formula = re.sub(r"2π·?|\^\d|P1 - P2", "", text.split(" [")[0])
    return [float(one.replace(" ", "")) for one in re.findall(r"(?:[-+] )?-?\d[\d.]*(?:e-?\d+)?", formula)]


def motion(times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position, velocity and acceleration of a multisine, exactly."""
    turns = 2.0 * np.pi * np.array(FREQUENCIES)[:, None]
    angle = turns * times + np.array(PHASES)[:, None]
    sizes = np.array(SIZES)[:, None]
    x, v, a = sizes * np.sin(angle), sizes * turns * np.cos(angle), -sizes * turns**2 * np.sin(angle)
    return x.sum(axis=0), v.sum(axis=0), a.sum(axis=0)


def force_lacking(law, noise: float = 1.0, seed: int = 3) -> EquationResidual:
    """The force balance of a piston that moves so under a law (t, x, v) -> N; noise 1 is 10 um and 0.01 MPa."""
    random = np.random.default_rng(seed)
    times = np.arange(0.0, DURATION, STEP)
    x, v, acceleration = motion(times)
    difference = (MASS * acceleration + DAMPING * v - law(times, x, v)) / AREA
    noises = (noise * 1e-5, noise * 1e4, noise * 1e4)
    a, b = (1e7 + side * 0.5 * difference + noises[1] * random.standard_normal(len(x)) for side in (1.0, -1.0))
    measured = x + noises[0] * random.standard_normal(len(x))
    states = {"position": measured, "velocity": v, "pressure difference": a - b, "time": times}
    channel = Measured("position", 0, times, measured, noises[0])
    return force_residual(make_grid(DURATION, STEP, (channel,)), states, a, b, noises, VALUES)


def test_a_ripple_over_position_is_found_with_its_pitch():
    law = weak_law([(force_lacking(lambda t, x, v: 120.0 * np.sin(2.0 * np.pi * x / 0.0093 + 0.7), noise=3.0),)])
    assert (law.site, law.function_of) == ("force", "position")
    assert numbers(law.expression) == pytest.approx([120.0, 0.0093, 0.7], rel=0.02)
    assert law.expression.endswith("[N], x in m")
    assert law.r_squared > 0.98
    x, force = np.array(law.samples).T
    assert np.max(np.abs(force - 120.0 * np.sin(2.0 * np.pi * x / 0.0093 + 0.7))) < 5.0


@pytest.mark.parametrize("frequency", [0.57, 3.41, 9.6])
def test_a_force_that_comes_back_in_time_is_found_with_its_frequency(frequency):
    law = weak_law([(force_lacking(lambda t, x, v: 80.0 * np.sin(2.0 * np.pi * frequency * t + 1.1)),)])
    assert law.function_of == "time"
    assert numbers(law.expression) == pytest.approx([80.0, frequency, 1.1], rel=0.02)
    assert law.expression.endswith("[N], t in s")


def test_a_damping_that_depends_on_position_is_a_product():
    law = weak_law([(force_lacking(lambda t, x, v: -9e5 * x**2 * v),)])
    assert law.function_of == "position, times velocity"
    assert "x^2 v [N], x in m, v in m/s" in law.expression
    assert numbers(law.expression) == pytest.approx([-9e5], rel=0.02)


def test_a_hardening_spring_is_a_cube():
    law = weak_law([(force_lacking(lambda t, x, v: -8e6 * x**3),)])
    assert "x^3 [N], x in m" in law.expression
    assert numbers(law.expression) == pytest.approx([-8e6], rel=0.02)


def test_a_balance_that_holds_gives_no_law():
    holding = force_lacking(lambda t, x, v: 0.0 * x)
    assert 0.8 < holding.chi_square < 1.2
    assert weak_law([(holding,)]) is None
    assert weak_law([()]) is None


def test_a_test_function_that_spans_a_gap_is_left_out():
    times = np.arange(0.0, DURATION, STEP)
    kept = (times < 4.0) | (times > 4.05)
    whole = make_grid(DURATION, STEP, (Measured("position", 0, times, times, 1.0),))
    torn = make_grid(DURATION, STEP, (Measured("position", 0, times[kept], times[kept], 1.0),))
    missing = set(whole.centres()) - set(torn.centres())
    assert missing
    assert all(3.9 < one < 4.15 for one in missing)
    # a straight line is its own average
    assert np.allclose(torn.average(torn.time), torn.centres())


def test_a_leak_that_depends_on_position_is_found_in_the_chamber():
    random = np.random.default_rng(5)
    times = np.arange(0.0, DURATION, STEP)
    x, v, _ = motion(times)
    turns = 2.0 * np.pi * np.array([0.9, 2.3])
    a = 1e7 + 2e6 * np.sin(turns[0] * times) + 1e6 * np.sin(turns[1] * times)
    rate = 2e6 * turns[0] * np.cos(turns[0] * times) + 1e6 * turns[1] * np.cos(turns[1] * times)
    b = 1e7 - 1.5e6 * np.sin(2.0 * np.pi * 0.47 * times)
    leak = 2e-11 * np.exp(-(((x - 0.008) / 0.01) ** 2)) * (a - b)
    volume = VALUES["line_volume"] + AREA * (VALUES["actuator_displacement"] + x)
    flow = AREA * v + volume / VALUES["bulk_modulus"] * rate + VALUES["internal_leakage"] * (a - b) + leak
    spool = flow / VALUES["valve_gain"] / np.sqrt(np.where(flow > 0.0, VALUES["supply_pressure"] - a, a))
    noises = (1e-5, 1e4, 1e4)
    x, a, b = (one + size * random.standard_normal(len(x)) for one, size in zip((x, a, b), noises, strict=True))
    states = {"position": x, "velocity": v, "pressure difference": a - b, "spool position": spool, "time": times}
    grid = make_grid(DURATION, STEP, (Measured("position", 0, times, x, 1e-5),))
    held = force_lacking(lambda t, x, v: 0.0 * x)
    law = weak_law([(held, continuity_residual(grid, states, "a", a, b, noises, VALUES))])
    assert (law.site, law.function_of) == ("chamber", "position, times pressure difference")
    assert numbers(law.expression) == pytest.approx([2e-11, -0.008, 0.01], rel=0.05)


def test_a_ripple_in_the_plant_itself_is_found_behind_wrong_parameters():
    reach, pitch = 0.024, 0.016
    places = np.linspace(-reach, reach, KNOTS)
    heights = 300.0 * np.sin(2.0 * np.pi * places / pitch)
    curve = {f"recovered_force.knot_{k:02d}": float(height) for k, height in enumerate(heights)}
    recording = recorded(
        {"recovered_force.lower": -reach, "recovered_force.upper": reach, "moving_mass": 11.0, **curve}
    )
    observation = observe(recording)
    calibration = calibrate([observation], NominalModel(nominal_values()), 2e-4)
    models = (calibration.fitted, calibration.nominal)
    alternatives = [equation_residuals(observation, calibration.shooting, model) for model in models]
    law = weak_law(alternatives)
    assert (law.site, law.function_of) == ("force", "position")
    assert law.r_squared > 0.98
    size, found, _ = numbers(law.expression)[-3:]
    # straight lines between eight knots a wave leave that much of its fundamental
    assert size == pytest.approx(300.0 * np.sinc(1.0 / 8.0) ** 2, rel=0.01)
    assert found == pytest.approx(pitch, rel=0.01)


CURVES = {
    "ripple": ("position", 0.05, lambda x: 40.0 * np.sin(2.0 * np.pi * x / 0.017 + 0.5), [40.0, 0.017, 0.5]),
    "cubic": ("position", 0.05, lambda x: -3e6 * x**3, [-3e6]),
    "drag": ("velocity", 0.3, lambda v: -5e3 * v * np.abs(v), [-5e3]),
    "dry friction": ("velocity", 0.3, lambda v: -250.0 * np.tanh(v / 0.02), [-250.0, 0.02]),
    "contact": ("position", 0.05, lambda x: -2e4 * np.maximum(x - 0.011, 0.0), [-2e4, -0.011]),
    "gust": ("time", 6.0, lambda t: 90.0 * np.sin(2.0 * np.pi * 0.43 * t - 0.8), [90.0, 0.43, -0.8]),
}


@pytest.mark.parametrize("kind", CURVES)
def test_a_curve_is_written_as_the_law_that_made_it(kind):
    name, reach, law, planted = CURVES[kind]
    x = np.linspace(0.0 if name == "time" else -reach, reach, KNOTS)
    y = law(x)
    y = y + 0.02 * np.std(y) * np.random.default_rng(7).standard_normal(KNOTS)
    found = express(x, y, name, "N")
    assert found.r_squared > 0.99
    assert [one for one in numbers(found.text) if one != 0.0] == pytest.approx(planted, rel=0.06)


def test_a_curve_of_noise_is_no_law():
    for seed in range(5):
        noise = np.random.default_rng(seed).standard_normal(KNOTS)
        assert express(np.linspace(-0.05, 0.05, KNOTS), noise, "position", "N").text == ""


def test_too_few_points_or_a_flat_curve_are_no_law():
    assert express(np.arange(5.0), np.arange(5.0), "position", "N").text == ""
    assert express(np.arange(9.0), np.ones(9), "position", "N").text == ""
