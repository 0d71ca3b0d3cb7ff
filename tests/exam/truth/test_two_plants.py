"""Two plants written apart, the truth and the model under test, agree on every effect whose law they share."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.plant import Plant
from eha_exam.case import PRESSURE_NOISE
from eha_exam.concealed import Setting, draw_effect
from eha_exam.plants import Rig
from eha_exam.truth import simulate_truth
from eha_exam.truth.record import CATALOGUE, PLANT

TIME = np.arange(801) / 1000.0
COMMAND = 0.1 * np.sin(2.0 * np.pi * TIME) + 0.03 * np.sin(2.0 * np.pi * 4.3 * TIME)
SETTING = Setting(Rig("light_servo", PLANT), amplitude=0.03, speed=0.15, duration=0.8)
STEPS = 50

CLOSE = 2.5e-7
"""m RMS, a fortieth of the noise of a good sensor; the model's step is the larger part of it."""
WHERE_LAMINAR = {"turbulent_leakage": {"transition_pressure": CATALOGUE["turbulent_leakage"]["transition_pressure"]}}
"""The two assume different transitions unless one is given."""
UNTIL_REVERSAL = ("stribeck_friction", "presliding_friction")
"""Stick-slip at a reversal amplifies whatever differs, SciPy's Radau and the truth included; compared before it."""


@pytest.mark.parametrize("effect", ["", *(name for name in CATALOGUE if name != "unequal_piston_area")])
def test_truth_and_model_agree(effect: str) -> None:
    """Unequal areas are left out: the two start from other pressures there."""
    values = draw_effect(effect, SETTING, np.random.default_rng(4)) if effect else {}
    truth = simulate_truth({}, [(effect, values)] if effect else [], COMMAND, 0.8)
    given = {**values, **WHERE_LAMINAR.get(effect, {})}
    model = Plant({f"{effect}.{name}": float(value) for name, value in given.items()}, step_size=1e-3 / STEPS)
    rows = model.run(np.repeat(COMMAND[:-1], STEPS), every=STEPS)
    samples = slice(50, 420 if effect in UNTIL_REVERSAL else None)
    position = (truth["measured_position"][1:] - rows.measured_position)[samples]
    assert np.sqrt(np.mean(position**2)) < CLOSE
    for pressure in ("measured_pressure_a", "measured_pressure_b"):
        apart = (truth[pressure][1:] - getattr(rows, pressure))[samples]
        assert np.sqrt(np.mean(apart**2)) < PRESSURE_NOISE


def test_a_load_that_draws_a_vacuum_takes_neither_below_absolute_zero() -> None:
    """The valve is shut, both chambers leak, and the load pulls the piston away from the oil of one."""
    effects = [
        ("constant_load", {"force": -150.0}),
        ("external_leakage", {"coefficient_a": 1e-12, "coefficient_b": 1e-12}),
        ("valve_deadband", {"half_width": 3e-4}),
    ]
    truth = simulate_truth({}, effects, np.zeros(2001), 2.0)
    sizes = {f"{effect}.{name}": value for effect, values in effects for name, value in values.items()}
    model = Plant(sizes, step_size=1e-4).run(np.zeros(20000), every=10)
    assert truth["pressure_a"][-1] == pytest.approx(-101325.0, abs=10.0)
    for pressure in ("pressure_a", "pressure_b"):
        assert np.max(np.abs(truth[pressure][1:] - getattr(model, pressure))) < 0.1 * PRESSURE_NOISE
    assert np.max(np.abs(truth["position"][1:] - model.position)) < CLOSE
