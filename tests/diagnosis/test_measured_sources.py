"""Friction found where the valve's current, its spool or the flows were recorded in place of a voltage.

The recordings are the exam's truth, which shares no code with the plant; the nominal mass is a tenth too large.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eha_core as eha
from eha_core.errors import RecordingError
from eha_core.identification.observation import observe
from eha_core.identification.segments import cut
from eha_core.nominal import nominal_of
from eha_core.plant import Plant, compose, dump_plant, load_plant
from eha_exam.truth import simulate_truth

ROD = {"piston_area": 1.2e-3, "piston_area_b": 7.8e-4, "moving_mass": 30.0, "internal_leakage": 2e-12}
FRICTION = 150.0
CHANNELS = {"measured_current": ("current",), "measured_spool": ("spool",), "measured_flow": ("flow_a", "flow_b")}
SECONDS = 4.0


@pytest.fixture(scope="module")
def truth() -> dict[str, np.ndarray]:
    time = np.arange(round(1000 * SECONDS) + 1) / 1000.0
    voltage = sum(size * np.sin(2.0 * np.pi * hertz * time) for size, hertz in ((0.05, 0.7), (0.04, 2.3), (0.02, 7.1)))
    return simulate_truth(ROD, [("coulomb_friction", {"force": FRICTION})], voltage, SECONDS)


def recorded(truth: dict[str, np.ndarray], names: tuple[str, ...]) -> eha.Recording:
    """Those channels as they were; position and pressures with the noise of usual sensors."""
    noise = np.random.default_rng(3).standard_normal((3, len(truth["time"])))
    return eha.Recording.from_arrays(
        time=truth["time"], pressures="gauge", **{name: truth[name] for name in names},
        position=truth["measured_position"] + 1e-5 * noise[0],
        pressure_a=truth["measured_pressure_a"] + 1e4 * noise[1],
        pressure_b=truth["measured_pressure_b"] + 1e4 * noise[2],
    )  # fmt: skip


@pytest.mark.parametrize("source", ["measured_current", "measured_flow"])
def test_friction_is_named_whatever_was_recorded_in_place_of_a_voltage(
    source: str, truth: dict[str, np.ndarray], tmp_path: Path
) -> None:
    nominal = nominal_of(ROD | {"moving_mass": 33.0}, composition=compose(source, "single_rod"))
    found = eha.diagnose(recorded(truth, CHANNELS[source]), nominal, jobs=1)
    assert found.diagnosis.verdict == "missing_physics"
    assert [effect.id for effect in found.effects] == ["coulomb_friction"]
    assert found.effects[0].parameters["force"].value == pytest.approx(FRICTION, rel=0.01)
    assert found.fitted_values["moving_mass"] == pytest.approx(30.0, rel=0.01)
    assert not any(name.startswith(("coil_", "saturation")) for name in found.fitted_values)
    path = tmp_path / "fitted.yaml"
    path.write_text(dump_plant(found.fitted_values, found.diagnosis.composition))
    fitted = load_plant(path)
    assert fitted.composition == nominal.composition
    assert fitted.values["coulomb_friction.force"] == found.effects[0].parameters["force"].value


@pytest.mark.parametrize("source", CHANNELS)
def test_a_recording_is_simulated_through_as_the_plant_would(source: str, truth: dict[str, np.ndarray]) -> None:
    rig = compose(source, "single_rod")
    observation = observe(recorded(truth, CHANNELS[source]), rig)
    assert (observation.drive, observation.driving) == ("measured", CHANNELS[source])
    assert [one.name for one in observation.measured] == ["position", "pressure_a", "pressure_b"]
    values = rig.places(rig.changed(rig.nominal_values(), ROD))
    shooting = cut(observation, values, window=SECONDS)
    rows, ends = shooting.simulate(values, shooting.initial_states, full=True)
    many, many_ends = shooting.simulate_many([(values, shooting.initial_states)] * 2)
    assert np.array_equal(rows[:, -4:], many[:, :, 1])
    assert np.array_equal(ends, many_ends[:, :, 0])
    plant = Plant(ROD, shooting.step_size, composition=rig)
    plant.place(*shooting.initial_states[0])
    alone = plant.run(shooting.inputs.T, shooting.every)
    # the valve starts at rest here, and settled there: the rest of that after the record's settling
    assert np.max(np.abs(alone.flow_a - rows[:, 8])[600:]) < 1e-2 * np.ptp(rows[:, 8])


def test_a_recording_without_the_sources_channel_is_refused(truth: dict[str, np.ndarray]) -> None:
    with pytest.raises(RecordingError, match="no flow_b was recorded, and plant.source = measured_flow is driven by"):
        observe(recorded(truth, ("flow_a",)), compose("measured_flow"))


def test_friction_on_a_vane_is_found_within_its_interval() -> None:
    """The truth's piston of 50 ml per radian is a vane of that displacement; its inertia is given a tenth too large."""
    time = np.arange(round(1000 * SECONDS) + 1) / 1000.0
    voltage = sum(size * np.sin(2.0 * np.pi * hertz * time) for size, hertz in ((0.05, 0.7), (0.04, 2.3), (0.02, 7.1)))
    vane = {"piston_area": 5e-5, "piston_area_b": 5e-5, "actuator_displacement": 1.5, "moving_mass": 0.5,
            "damping_coefficient": 40.0, "spring_stiffness": 0.0}  # fmt: skip
    torque = 60.0
    truth = simulate_truth(vane, [("coulomb_friction", {"force": torque})], voltage, SECONDS)
    rig = compose(cylinder="rotary_vane")
    given = {"vane_displacement": 5e-5, "half_travel": 1.5, "moment_of_inertia": 0.55, "rotational_damping": 40.0}
    found = eha.diagnose(recorded(truth | {"voltage_command": voltage}, ("voltage_command",)),
                         nominal_of(given, composition=rig), jobs=1)  # fmt: skip
    assert [effect.id for effect in found.effects] == ["coulomb_friction"]
    value = found.effects[0].parameters["force"]
    assert value.unit == "N m" and "N m" in found.effects[0].statement
    assert abs(value.value - torque) < 2.0 * value.std < 0.05 * torque
    units = {one.name: one.unit for one in found.parameters}
    assert units["moving_mass"] == "kg m^2"
    assert "moment_of_inertia" in dump_plant(found.fitted_values, rig)
    assert any("the actuator is rotary" in remark for remark in found.diagnosis.remarks)
