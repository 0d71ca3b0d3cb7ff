"""An effect that acts over an interval is named with when it acts."""

from dataclasses import replace

import numpy as np
import pytest
from made import recorded

from eha_core.diagnosis import diagnose
from eha_core.parameters import nominal_values
from eha_core.plant import Plant


def test_friction_that_acts_for_a_while_is_named_with_its_span() -> None:
    result = diagnose(
        recorded({"coulomb_friction.force": 200.0, "moving_mass": 10.5, "effects_from": 2.37, "effects_until": 6.71}),
        nominal_values(),
    )
    assert result.verdict == "missing_physics"
    assert [effect.id for effect in result.effects] == ["coulomb_friction"]
    assert result.effects[0].parameters["force"].value == pytest.approx(200.0, rel=0.02)
    located = result.location[0]
    (when,) = located.when
    assert when == pytest.approx((2.37, 6.71), abs=0.02)
    assert located.share > 0.9  # what friction that always acts would take away is a tenth of that
    assert "from 2.37 s to 6.71 s only" in result.effects[0].statement
    # what is handed to the simulator has the effect in that span alone
    friction = Plant(result.fitted_values, 1e-4)
    rows = friction.run(0.2 * np.sin(2 * np.pi * np.arange(80_000) * 1e-4))
    quiet = (rows.time < 2.3) | (rows.time > 6.8)
    assert np.max(np.abs(rows.friction_force[quiet])) < 1.0
    assert np.max(np.abs(rows.friction_force[~quiet])) > 150.0
    for fit in result.held_out.values():
        assert fit.rmse_after < 1.1 * fit.noise
    # one of the windows that judge the model lies where the friction acts
    assert result.held_out["position"].rmse_before > 1.5 * result.held_out["position"].rmse_after


def test_an_effect_that_acts_for_a_while_is_a_member_like_any_other() -> None:
    """Beside a valve that overlaps always, which is found first."""
    result = diagnose(
        recorded(
            {"valve_deadband.half_width": 5e-5, "coulomb_friction.force": 200.0, "coulomb_friction.acts_from": 2.37,
             "coulomb_friction.acts_until": 6.71}
        ),
        nominal_values(),
    )  # fmt: skip
    assert result.verdict == "missing_physics"
    found = {effect.id: effect for effect in result.effects}
    assert set(found) == {"valve_deadband", "coulomb_friction"}
    assert found["valve_deadband"].active is None
    assert found["valve_deadband"].parameters["half_width"].value == pytest.approx(5e-5, rel=0.02)
    assert found["coulomb_friction"].active == pytest.approx((2.37, 6.71), abs=0.02)
    assert found["coulomb_friction"].parameters["force"].value == pytest.approx(200.0, rel=0.02)
    assert result.explained.complete
    instants = [result.fitted_values[f"coulomb_friction.{name}"] for name in ("acts_from", "acts_until")]
    assert instants == pytest.approx(found["coulomb_friction"].active)
    assert not any(name.startswith("valve_deadband.acts") for name in result.fitted_values)


def test_a_recording_that_ends_while_nodes_go_down_lacks_no_physics() -> None:
    whole = recorded({})
    command = whole.channels["voltage_command"]
    gone = command.time > 9.85  # commands that were recorded but that the rig no longer followed
    values = np.where(gone, command.values + 0.05, command.values)
    channels = {**whole.channels, "voltage_command": replace(command, values=values)}
    result = diagnose(replace(whole, channels=channels), nominal_values())
    assert result.verdict in {"consistent", "parameters"}
    assert any(remark.startswith("the last 1 s were excluded") for remark in result.remarks)
