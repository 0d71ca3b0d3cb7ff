"""The plant as an actuator in MuJoCo against the plant that moves its own mass."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported import FIVE, voltages
from numpy.typing import NDArray

from eha_core.errors import EhaError, ParameterError
from eha_core.export import ExportedModel
from eha_core.plant import PAPER, Plant

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")

from eha_core.export.mujoco_actuator import EhaActuator  # noqa: E402 - needs MuJoCo

Array = NDArray[np.float64]

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "mujoco_actuator.py"

MODEL = """
<mujoco>
  <option timestep="0.0001" integrator="Euler" gravity="0 0 0"/>
  <worldbody>
    <body name="load">
      <joint name="piston" type="slide" axis="1 0 0" limited="true" range="-0.1 0.1"/>
      <geom type="box" size="0.06 0.06 0.06" mass="11"/>
    </body>
  </worldbody>
  <actuator><general name="valve" joint="piston" ctrllimited="true" ctrlrange="-0.1 0.1"/></actuator>
</mujoco>
"""

WHEEL = """
      <body name="wheel" pos="0.2 0 0">
        <joint name="hub" type="hinge" axis="0 0 1"/>
        <geom type="cylinder" size="0.05 0.01" mass="4" contype="0" conaffinity="0"/>
      </body>
    </body>"""


def changed(*pairs: tuple[str, str]) -> str:
    """MODEL with pieces of its text replaced."""
    text = MODEL
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    return text


def loaded(text: str) -> tuple[Any, Any]:
    model = mujoco.MjModel.from_xml_string(text)
    return model, mujoco.MjData(model)


def plant_of(changes: dict[str, float]) -> ExportedModel:
    return ExportedModel(PAPER, {**PAPER.nominal_values(), **changes})


def positions(actuator: EhaActuator, commands: Array) -> Array:
    """Where the joint of the model's first actuator is after each step."""
    found = np.empty(len(commands))
    for index, command in enumerate(commands):
        actuator.data.ctrl[0] = command
        actuator.step()
        found[index] = actuator.data.qpos[0]
    return found


def rms(found: Array, expected: Array) -> float:
    return float(np.sqrt(np.mean((found - expected) ** 2)))


COMMANDS = np.repeat(voltages(1.0), 10)
FOLLOWED = 1e-7
"""m RMS; a tenth of what is promised, so that a missing term of the second order in the step is noticed."""


@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast"])
def test_the_joint_follows_the_plant_with_five_effects(integrator: str) -> None:
    actuator = EhaActuator(*loaded(changed(('"Euler"', f'"{integrator}"'))), "valve", plant_of(FIVE))
    expected = Plant(FIVE).run(COMMANDS)
    found = positions(actuator, COMMANDS)
    assert np.ptp(expected.position) > 5e-3
    assert rms(found, expected.position) < FOLLOWED
    assert actuator.state.pressure_a == pytest.approx(expected.pressure_a[-1], rel=1e-4)


def test_a_load_that_carries_a_turning_wheel_is_all_of_the_mass() -> None:
    model, data = loaded(changed(("    </body>", WHEEL), ('mass="11"', 'mass="7"')))
    data.qvel[1] = 10.0
    found = positions(EhaActuator(model, data, "valve", plant_of(FIVE)), COMMANDS)
    assert rms(found, Plant(FIVE).run(COMMANDS).position) < FOLLOWED


@pytest.mark.parametrize("wheel", ["    </body>", WHEEL.replace('mass="4"', 'mass="0.1"')], ids=["alone", "wheel"])
def test_a_light_load_on_stiff_oil_is_stable_at_a_long_step(wheel: str) -> None:
    # an explicit step of 1 ms diverges above 2000 rad/s; the oil's frequency is 9000 rad/s
    mass = 0.1 if "wheel" in wheel else 0.2
    model, data = loaded(changed(("    </body>", wheel), ('mass="11"', f'mass="{mass}"'), ("0.0001", "0.001")))
    expected = Plant({"moving_mass": 0.2}).run(np.repeat(COMMANDS[::10], 10), every=10)
    assert rms(positions(EhaActuator(model, data, "valve"), COMMANDS[::10]), expected.position) < 1e-5


def test_a_timestep_of_several_steps_of_the_plant() -> None:
    actuator = EhaActuator(*loaded(changed(("0.0001", "0.0005"))), "valve", plant_of(FIVE))
    expected = Plant(FIVE).run(np.repeat(COMMANDS[::5], 5), every=5)
    assert rms(positions(actuator, COMMANDS[::5]), expected.position) < 1e-6


def test_mid_stroke_may_be_anywhere_on_the_joint() -> None:
    middle = 0.5
    model, data = loaded(changed((' range="-0.1 0.1"', ' range="0.4 0.6" ref="0.5"')))
    found = positions(EhaActuator(model, data, "valve", plant_of(FIVE), middle), COMMANDS)
    assert rms(found - middle, Plant(FIVE).run(COMMANDS).position) < FOLLOWED


def test_two_actuators_of_one_model_each_follow_their_own_plant() -> None:
    second = re.search(r"    <body.*?</body>\n", MODEL, re.DOTALL).group()
    second = second.replace("piston", "other").replace('"load"', '"second" pos="0 1 0"')
    model, data = loaded(
        changed(
            ("  </worldbody>", f"{second}  </worldbody>"),
            ("</actuator>", '<general name="another" joint="other"/></actuator>'),
        )
    )
    pair = [EhaActuator(model, data, "valve", plant_of(FIVE)), EhaActuator(model, data, "another", plant_of({}))]
    found = np.empty((2000, 2))
    for index in range(len(found)):
        data.ctrl[:] = COMMANDS[index], -COMMANDS[index]
        for actuator in pair:
            actuator.apply()
        mujoco.mj_step(model, data)
        for actuator in pair:
            actuator.follow()
        found[index] = data.qpos
    assert rms(found[:, 0], Plant(FIVE).run(COMMANDS[:2000]).position) < FOLLOWED
    assert rms(found[:, 1], Plant({"moving_mass": 11.0}).run(-COMMANDS[:2000]).position) < FOLLOWED


def test_a_hanging_load_rests_on_the_oil_and_sinks_by_the_leakage() -> None:
    actuator = EhaActuator(
        *loaded(changed(('"1 0 0"', '"0 0 1"'), ('gravity="0 0 0"', 'gravity="0 0 -9.81"'))), "valve"
    )
    positions(actuator, np.zeros(5000))
    of, state = actuator.plant.parameters, actuator.state
    sinking = of["internal_leakage"] * (state.pressure_a - state.pressure_b) / of["piston_area"]
    assert actuator.data.qvel[0] == pytest.approx(-sinking, rel=1e-3)
    carried = state.hydraulic_force - of["spring_stiffness"] * state.position + of["damping_coefficient"] * sinking
    assert carried == pytest.approx(11.0 * 9.81, rel=1e-5)


def test_dry_friction_holds_a_load_at_rest() -> None:
    held = {"coulomb_friction.force": 250.0, "constant_load.force": 200.0}
    actuator = EhaActuator(*loaded(MODEL), "valve", plant_of(held))
    assert np.max(np.abs(positions(actuator, np.zeros(5000)))) < 1e-8


def test_the_control_is_clamped_to_its_range() -> None:
    actuator = EhaActuator(*loaded(MODEL), "valve")
    positions(actuator, np.full(10, 7.0))
    assert actuator.state.voltage == 0.1


def test_the_joint_follows_the_plant_to_the_end_of_the_stroke_and_back() -> None:
    light = {**FIVE, "moving_mass": 0.5}
    commands = np.repeat([0.1, -0.1], [12_000, 5000])
    expected = Plant(light).run(commands)
    assert expected.position[11_999] == 0.1 > expected.position[-1] + 0.01
    actuator = EhaActuator(*loaded(changed(('mass="11"', 'mass="0.5"'))), "valve", plant_of(light))
    assert rms(positions(actuator, commands), expected.position) < FOLLOWED
    assert actuator.state.pressure_b == pytest.approx(expected.pressure_b[-1], rel=1e-4)


@pytest.mark.parametrize(
    ("given", "middle", "range_of_joint"),
    [
        ("", 0.0, [-0.1, 0.1]),
        (' range="-0.2 0.3"', 0.0, [-0.1, 0.1]),
        (' range="-0.02 0.03"', 0.0, [-0.02, 0.03]),
        (' range="0 0.15"', 0.1, [0.0, 0.15]),
    ],
)
def test_the_joint_ends_with_the_stroke_or_before(given: str, middle: float, range_of_joint: list[float]) -> None:
    limits = f'limited="true"{given}' if given else ""
    model, data = loaded(changed(('limited="true" range="-0.1 0.1"/>\n      <geom', f"{limits}/>\n      <geom")))
    EhaActuator(model, data, "valve", middle=middle)
    assert model.jnt_limited[0] and model.jnt_range[0].tolist() == pytest.approx(range_of_joint)


def test_after_a_reset_it_begins_anew() -> None:
    actuator = EhaActuator(*loaded(MODEL), "valve", plant_of(FIVE))
    first = positions(actuator, COMMANDS[:1000])
    mujoco.mj_resetData(actuator.model, actuator.data)
    actuator.reset()
    assert np.array_equal(positions(actuator, COMMANDS[:1000]), first)


@pytest.mark.parametrize(
    ("pairs", "complaint"),
    [
        ([('name="valve"', 'name="pump"')], "the model has no actuator valve; its actuators: pump"),
        ([('"slide"', '"hinge"')], "actuator valve: it does not act on a slide joint"),
        ([("ctrllimited", 'gear="2" ctrllimited')], "actuator valve: gear = 2"),
        ([("ctrllimited", 'dyntype="filter" dynprm="1" ctrllimited')], "actuator valve: it has dynamics of its own"),
        ([('"Euler"', '"RK4"')], "integrator RK4"),
        (
            [('gravity="0 0 0"/>', 'gravity="0 0 0"><flag frictionloss="disable"/></option>')],
            "option flag frictionloss is",
        ),
        ([("0.0001", "0.00015")], "timestep = 0.00015 s is no multiple of the plant's step of 0.0001 s"),
    ],
)
def test_a_model_that_it_cannot_act_on_is_refused_in_a_line(pairs: list[tuple[str, str]], complaint: str) -> None:
    with pytest.raises(EhaError, match=complaint) as caught:
        EhaActuator(*loaded(changed(*pairs)), "valve")
    assert "\n" not in str(caught.value)


def test_a_load_that_starts_beyond_the_stroke_is_refused() -> None:
    with pytest.raises(ParameterError, match="initial_position = -0.3 m is outside the stroke"):
        EhaActuator(*loaded(MODEL), "valve", middle=0.3)


def test_the_example_prints_how_far_it_deviates() -> None:
    done = subprocess.run([sys.executable, str(EXAMPLE), "2"], capture_output=True, text=True, check=True)
    deviation = float(re.search(r"2 s at 0.1 ms, .* plant by ([\d.]+) um RMS", done.stdout).group(1))
    assert deviation < 1e6 * FOLLOWED
