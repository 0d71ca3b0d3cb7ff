"""Each effect that is a plain differential equation, in the whole actuator, against SciPy on a model of its own."""

from __future__ import annotations

import numpy as np
import pytest
from augmented_model import POSITION, PRESSURE_A, PRESSURE_B, Laws, solve

from eha_core.plant import Plant

PIECE = 2e-3
PIECES = 0.08 * np.sin(2.0 * np.pi * 4.0 * (np.arange(150) + 0.5) * PIECE)

CASES = {
    "valve_null_offset": ({"offset": 3e-5}, Laws(offset=3e-5)),
    "valve_deadband": ({"half_width": 1e-4}, Laws(overlap=1e-4)),
    "valve_deadband, worn": ({"half_width": 1e-4, "rounding": 6e-5}, Laws(overlap=1e-4, rounding=6e-5)),
    "flow_saturation": ({"curvature": 800.0}, Laws(saturation=800.0)),
    "flow_gain_asymmetry": ({"ratio": 0.2}, Laws(asymmetry=0.2)),
    "valve_null_leakage": ({"conductance": 3e-11, "width": 3e-4}, Laws(null_conductance=3e-11, null_width=3e-4)),
    "supply_pressure_droop": ({"resistance": 5e10, "time_constant": 0.05}, Laws(droop=5e10, line_time=0.05)),
    "return_back_pressure": ({"resistance": 3e10, "time_constant": 0.05}, Laws(back=3e10, line_time=0.05)),
    "turbulent_leakage": ({"coefficient": 3e-8}, Laws(turbulent=3e-8)),
    "bore_wear_leakage": (
        {"coefficient": 3e-10, "centre": 0.002, "width": 0.0015}, Laws(worn=(3e-10, 0.002, 0.0015))
    ),
    "external_leakage": ({"coefficient_a": 1e-12, "coefficient_b": 3e-12}, Laws(outside_a=1e-12, outside_b=3e-12)),
    "entrained_air": ({"air_fraction": 0.2}, Laws(air=0.2)),
    "unequal_piston_area": ({"ratio": 0.8}, Laws(area_ratio=0.8)),
    "quadratic_damping": ({"coefficient": 5e4}, Laws(quadratic=5e4)),
    "directional_damping": ({"ratio": 0.6}, Laws(one_way=0.6)),
    "constant_load": ({"force": 400.0}, Laws(load=400.0)),
    "hardening_spring": ({"coefficient": 2e9}, Laws(cubic=2e9)),
    "end_stop": (
        {"lower": -0.001, "upper": 0.004, "stiffness": 1e6, "damping": 1e3}, Laws(stop=(-0.001, 0.004, 1e6, 1e3))
    ),
    "presliding_friction": (
        {"force": 200.0, "static_force": 260.0, "stribeck_velocity": 0.02, "stiffness": 3e6, "damping": 1e3},
        Laws(bristle=(200.0, 260.0, 0.02, 3e6, 1e3)),
    ),
    "leakage_onset": ({"time": 0.15, "internal_leakage": 1e-10}, Laws(onset=0.15, leak_after=1e-10)),
    "thermal_drift": (
        {"damping_ratio": 0.5, "leakage_ratio": 50.0, "time_constant": 0.2},
        Laws(damping_lost=0.5, leak_gained=50.0, warming=0.2),
    ),
}  # fmt: skip
"""The effect's parameters here, and the same sizes in the reference; after a comma, a form of the effect."""

WRONG = {"presliding_friction": 2e-3}
"""Share of the effect that may be wrong, where it is not 1e-3."""


@pytest.fixture(scope="module")
def nominal() -> np.ndarray:
    return solve(PIECES, PIECE, Laws())


@pytest.mark.parametrize("case", CASES)
def test_actuator_with_the_effect_moves_as_the_reference(case: str, nominal: np.ndarray) -> None:
    parameters, laws = CASES[case]
    effect = case.split(",")[0]
    expected = solve(PIECES, PIECE, laws)
    plant = Plant({f"{effect}.{name}": value for name, value in parameters.items()}, 5e-5)
    found = plant.run(np.repeat(PIECES, 40), every=40)
    for name, column in (("position", POSITION), ("pressure_a", PRESSURE_A), ("pressure_b", PRESSURE_B)):
        shown = np.max(np.abs(expected[:, column] - nominal[:, column]))
        wrong = np.max(np.abs(getattr(found, name) - expected[:, column]))
        assert wrong < WRONG.get(effect, 1e-3) * shown, name
