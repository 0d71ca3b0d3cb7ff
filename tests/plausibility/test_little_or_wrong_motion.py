"""What little motion allows to be found, and a command that did not bring it about."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eha_core.parameters import nominal_values
from eha_core.plausibility import check
from eha_core.plausibility.relations import OPPOSED, relations
from eha_exam.drawing import draw_case
from eha_exam.measuring import measure, simulate_case

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from tools.hostile import wrong_recordings as wrong
from tools.hostile.plant_tests import run_on_plant
from tools.hostile.sound_recordings import KINDS

SEED = 301


def rig(tier: str, number: int, kind: str = "as drawn", seed: int = SEED, **changes: object) -> wrong.Rig:
    """A rig's test of 8 s on the simulated plant."""
    case = replace(draw_case(tier, number, seed), duration=8.0, **changes)
    case = KINDS[kind](case, np.random.default_rng([case.seed, 12]))
    truth = run_on_plant(case)
    arrays = wrong.with_velocity(case, measure(case, truth), truth)
    return wrong.Rig(case, arrays, {**nominal_values(), **case.nominal})


def made(name: str) -> wrong.Mistake:
    return next(one for one in wrong.MISTAKES if one.name == name)


@pytest.mark.parametrize("lacking", wrong.SUBSETS, ids=lambda names: "without " + "+".join(names))
@pytest.mark.parametrize("share", [1.0, 0.1])
def test_a_small_command_cannot_have_moved_the_piston_far(lacking: tuple[str, ...], share: float) -> None:
    """A tenth of another run's command hardly opens the valve: wear may hide it, but then the piston would stand."""
    driven, other = rig("null_parameters", 1), rig("null_parameters", 3)
    time, command = other.arrays["voltage_command"]
    other = replace(other, arrays={**other.arrays, "voltage_command": (time, share * command)})
    finding = check(wrong.make_wrong(made("another run's command"), driven, other, lacking), driven.nominal)
    assert finding is not None and "voltage_command is unrelated to the motion" in finding.mistake


def friction_behind(overlap: float) -> tuple:
    return (("valve_deadband", {"half_width": overlap}), ("coulomb_friction", {"force": 500.0}))


WORN = {
    "an overlap of 5 %": friction_behind(0.001),
    "an overlap of 15 %": friction_behind(0.003),
    "an overlap of 25 %": friction_behind(0.005),
    "a crooked valve": (("flow_gain_asymmetry", {"ratio": 0.5}), ("valve_null_offset", {"offset": 0.002})),
}


@pytest.mark.parametrize("effects", WORN.values(), ids=WORN)
@pytest.mark.parametrize("loop", [0.0, 12.0])
@pytest.mark.parametrize("number", [1, 3, 4])
def test_a_worn_rigs_own_command_is_never_another_runs(effects: tuple, loop: float, number: int) -> None:
    """The command may be large while the piston creeps: that is overlap, and no mistake."""
    worn = rig("null_parameters", number, effects=effects, loop=loop)
    assert check(wrong.as_recording(worn.arrays), worn.nominal) is None


def test_a_command_that_feeds_a_leak_while_friction_holds_the_piston_has_no_wrong_scale() -> None:
    """Steps under a slow loop move the piston by 0.3 mm against 884 N: volts for each m/s are 60 times the nominal."""
    case = replace(draw_case("rig", 66, 70219), duration=8.0)
    assert case.effect_ids[0] == "presliding_friction"
    held, nominal = wrong.as_recording(measure(case, simulate_case(case))), {**nominal_values(), **case.nominal}
    found = relations(held, nominal)["command_scale"]
    assert found.value > 25.0 and not found.broken and not found.sound
    assert check(held, nominal) is None
    command = held.channels["voltage_command"]
    against = replace(held, channels={**held.channels, "voltage_command": replace(command, values=-command.values)})
    assert relations(against, nominal)["command_scale"].broken


def test_a_creep_one_way_says_nothing_of_the_sensors_order() -> None:
    """Friction is the same all along; what changes in the force is a late sensor and air in the oil."""
    creeping = rig("rig", 9, "small")
    assert creeping.case.effect_ids == ("coulomb_friction", "constant_load", "pressure_sensor_lag", "entrained_air")
    assert check(wrong.as_recording(creeping.arrays), creeping.nominal) is None


@pytest.mark.parametrize("noise", [0.0, 1e5])
def test_a_force_speaks_for_a_sign_only_where_it_is_more_than_noise(noise: float) -> None:
    """A slow piston's damping takes some newtons; noise of 0.1 MPa hides them, with either order of the chambers."""
    nominal, rng = nominal_values(), np.random.default_rng(11)
    time = np.arange(0.0, 8.0, 2e-3)
    turns = 2.0 * np.pi * 0.7
    speed = 2e-3 * turns * np.cos(turns * time)
    position = 2e-3 * np.sin(turns * time) + 1e-6 * rng.standard_normal(len(time))
    for order in (1.0, -1.0):
        arrays = {"position": (time, position)}
        for name, side in (("pressure_a", 0.5), ("pressure_b", -0.5)):
            values = 8e6 + side * order * 500.0 * speed / nominal["piston_area"]
            arrays[name] = (time, values + noise * rng.standard_normal(len(time)))
        found = relations(wrong.as_recording(arrays), nominal)["force"]
        assert (found.sound, found.broken) == ((False, False) if noise else (order > 0.0, order < 0.0))


def test_a_force_from_outside_may_drive_the_piston_against_its_oil() -> None:
    """244 N at 3.3 Hz shake a light piston behind a leak: the oil's force goes against the motion, as if the chambers
    were swapped, but at a given command it falls as the speed rises."""
    case = replace(draw_case("named_and_unknown", 8, 70219), duration=8.0)
    assert case.effect_ids == ("turbulent_leakage", "periodic_force")
    shaken, nominal = wrong.as_recording(measure(case, simulate_case(case))), {**nominal_values(), **case.nominal}
    found = relations(shaken, nominal)["force"]
    assert found.value < OPPOSED and not found.broken and not found.sound
    assert check(shaken, nominal) is None
    calm = rig("null_parameters", 1)
    swapped = wrong.make_wrong(made("chambers swapped"), calm, calm)
    assert relations(swapped, calm.nominal)["force"].broken


def test_chambers_that_a_leak_empties_while_a_single_rod_creeps_are_no_mistake() -> None:
    """Two empty chambers of unequal areas lie further from half the supply one way than the other."""
    creeping = rig("single", 32, "small", seed=303)
    recording = wrong.as_recording(creeping.arrays)
    assert relations(recording, creeping.nominal)["level"].value < -1.0
    assert check(recording, creeping.nominal) is None
    tenth = wrong.make_wrong(made("pressures times 10"), creeping, creeping)
    finding = check(tenth, creeping.nominal)
    assert finding is None or "pressure" in finding.mistake


def test_a_velocity_that_is_mostly_noise_is_of_this_run() -> None:
    noisy = rig("small", 15, "small", seed=303)
    assert noisy.case.noise == 10.0
    assert check(wrong.as_recording(noisy.arrays), noisy.nominal) is None
    silent = replace(noisy.case, noise=0.0)
    quiet = replace(noisy, arrays=wrong.with_velocity(silent, noisy.arrays, run_on_plant(noisy.case)))
    other = rig("null_parameters", 1)
    finding = check(wrong.make_wrong(made("another run's velocity"), quiet, other), quiet.nominal)
    assert finding is not None and "velocity is unrelated to the motion" in finding.mistake


@pytest.mark.parametrize(("unit", "expected"), [("cm", "position is in cm"), ("inches", "position is in inches")])
def test_cm_and_inches_are_both_named_where_the_valve_gives_half_its_flow(unit: str, expected: str) -> None:
    weak = rig("null_parameters", 1)
    nominal = {**weak.nominal, "valve_gain": 2.0 * weak.nominal["valve_gain"]}
    wrong_unit = wrong.make_wrong(made(f"position in {unit}"), weak, weak, ("velocity", "pressure_a", "pressure_b"))
    finding = check(wrong_unit, nominal)
    assert finding is not None and expected in str(finding)


@pytest.mark.parametrize("factor", [1e2, 1e3, 1e6])
def test_a_piston_that_stands_still_has_no_unit(factor: float) -> None:
    time = np.arange(0.0, 8.0, 2e-3)
    noise = 1e-5 * np.random.default_rng(6).standard_normal(len(time))
    still = {"position": (time, factor * (0.03 + noise)), "voltage_command": (time, 0.1 * np.sin(time))}
    finding = check(wrong.as_recording(still), nominal_values())
    assert finding is None


@pytest.mark.parametrize(("half_strokes", "expected"), [(-3.0, True), (1.5, True), (4.5, True), (40.0, False)])
def test_a_zero_lies_near_the_cylinder(half_strokes: float, expected: bool) -> None:
    driven = rig("null_parameters", 1)
    time, position = driven.arrays["position"]
    shift = half_strokes * driven.nominal["actuator_displacement"]
    finding = check(wrong.as_recording({**driven.arrays, "position": (time, position + shift)}), driven.nominal)
    assert (finding is not None and "mid-stroke" in finding.mistake) == expected
