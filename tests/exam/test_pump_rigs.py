"""Pump-driven rigs that are drawn: with the truth's own values the plant, which shares no code with it, gives what was
recorded."""

from __future__ import annotations

import pytest

from eha_core.identification.observation import observe
from eha_core.long_record.judge import errors_held
from eha_core.nominal import nominal_of
from tools.pump_rigs import AMPERES, NOISE, RIG, PumpRig, draw

SAME = (
    "moving_mass", "damping_coefficient", "bulk_modulus", "internal_leakage", "supply_pressure", "pump_displacement",
    "pump_leakage", "pump_line_volume",
)  # fmt: skip


def own_values(rig: PumpRig) -> dict[str, float]:
    """The truth's values in the names of the plant's parts."""
    truth = rig.truth
    assert rig.concealed is not None
    effect, concealed = rig.concealed
    return rig.given | {name: truth[name] for name in SAME} | {
        "tank_gain": truth["valve_gain"] * (AMPERES - truth["overlap"]),
        "valve_overlap": truth["overlap"] / AMPERES,
        "relief_gain": truth["pump_relief_gain"],
        "switching_frequency": truth["valve_natural_frequency"],
        "switching_damping": truth["valve_damping_ratio"],
        "bypass_gain": truth["pump_bypass_gain"],
        **{f"{effect}.{name}": value for name, value in concealed.items()},
    }  # fmt: skip


def test_the_plant_with_the_truth_s_values_errs_by_the_noise() -> None:
    """A closed centre; of a tandem one the two write the bypass' edge differently. A pump's speed that is given half a
    sample late costs 1.4 times the noise in position."""
    rig = draw(1, 1)
    assert rig.truth["pump_bypass_gain"] == 0.0
    observation = observe(rig.recording, RIG)
    found = errors_held(observation, nominal_of(own_values(rig), composition=RIG).values)
    assert found == pytest.approx(NOISE, rel=0.1)
    without = errors_held(observation, nominal_of(rig.given, composition=RIG).values)
    assert all(without[name] > 50.0 * found[name] for name in found)
