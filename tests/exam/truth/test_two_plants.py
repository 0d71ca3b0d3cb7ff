"""Two plants written apart, the truth and the model under test, agree on every effect whose law they share."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.exam.case import PRESSURE_NOISE
from eha_core.exam.concealed import Setting, draw_effect
from eha_core.exam.plants import Rig
from eha_core.exam.truth import simulate_truth
from eha_core.exam.truth.record import CATALOGUE, PLANT
from eha_core.plant import Plant

TIME = np.arange(801) / 1000.0
COMMAND = 0.1 * np.sin(2.0 * np.pi * TIME) + 0.03 * np.sin(2.0 * np.pi * 4.3 * TIME)
SETTING = Setting(Rig("light_servo", PLANT), amplitude=0.03, speed=0.15, duration=0.8)
STEPS = 50

CLOSE = 2.5e-7
"""m RMS, a fortieth of the noise of a good sensor; the model's step is the larger part of it."""
FARTHER = {"turbulent_leakage": 5e-5, "stribeck_friction": 5e-6, "presliding_friction": 3e-6}
"""m RMS. The two round the root of a leakage path off differently; a break-away comes a step later in the model."""
UNTIL_REVERSAL = ("stribeck_friction", "presliding_friction")
"""Stick-slip at a reversal amplifies whatever differs, SciPy's Radau and the truth included; compared before it."""


@pytest.mark.parametrize("effect", ["", *(name for name in CATALOGUE if name != "unequal_piston_area")])
def test_truth_and_model_agree(effect: str) -> None:
    """Unequal areas are left out: the two start from other pressures there."""
    values = draw_effect(effect, SETTING, np.random.default_rng(4)) if effect else {}
    truth = simulate_truth({}, [(effect, values)] if effect else [], COMMAND, 0.8)
    model = Plant({f"{effect}.{name}": float(value) for name, value in values.items()}, step_size=1e-3 / STEPS)
    rows = model.run(np.repeat(COMMAND[:-1], STEPS), every=STEPS)
    samples = slice(50, 420 if effect in UNTIL_REVERSAL else None)
    position = (truth["measured_position"][1:] - rows.measured_position)[samples]
    assert np.sqrt(np.mean(position**2)) < FARTHER.get(effect, CLOSE)
    for pressure in ("measured_pressure_a", "measured_pressure_b"):
        apart = (truth[pressure][1:] - getattr(rows, pressure))[samples]
        assert np.sqrt(np.mean(apart**2)) < PRESSURE_NOISE
