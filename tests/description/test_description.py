"""The robot's description and ros2_control's files against the plant and the nodes they are for."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest
import xacro
import yaml

from eha_core.parameters import NODE_ONLY, nominal_values
from eha_sim_node.joints import JOINT
from eha_sim_node.sim import OWN_ROWS

ROOT = Path(__file__).resolve().parents[2] / "eha_description"
ROWS = {row.name: row for row in OWN_ROWS}


def urdf(**mappings: str) -> ElementTree.Element:
    text = xacro.process_file(str(ROOT / "urdf" / "actuator.urdf.xacro"), mappings=mappings).toxml()
    return ElementTree.fromstring(text)


def test_the_joint_is_the_plant_s_piston() -> None:
    robot, plant = urdf(), nominal_values()
    (joint,) = [joint for joint in robot.iter("joint") if joint.get("type") == "prismatic"]
    limit = {name: float(value) for name, value in joint.find("limit").attrib.items()}
    assert joint.get("name") == JOINT
    assert (limit["lower"], limit["upper"]) == (-plant["actuator_displacement"], plant["actuator_displacement"])
    assert limit["effort"] == ROWS["command_limit"].default  # volts: the command interface's unit
    assert float(robot.find("link[@name='rod']/inertial/mass").get("value")) == plant["moving_mass"]


def test_every_link_hangs_on_one_parent_and_the_base_on_none() -> None:
    robot = urdf()
    links = {link.get("name") for link in robot.findall("link")}
    children = [joint.find("child").get("link") for joint in robot.findall("joint")]
    parents = {joint.find("parent").get("link") for joint in robot.findall("joint")}
    assert len(children) == len(set(children)) and parents | set(children) == links
    assert links - set(children) == {"base_link"}


@pytest.mark.parametrize(
    ("hardware", "plugin"),
    [
        ("joint_state", "joint_state_topic_hardware_interface/JointStateTopicSystem"),
        ("joint_command", "joint_command_topic_hardware_interface/JointCommandTopicSystem"),
    ],
)
def test_the_hardware_block_never_holds_a_command_back(hardware: str, plugin: str) -> None:
    (block,) = urdf(hardware=hardware, joint_commands_topic="/rig/joint_command").findall("ros2_control")
    given = {item.get("name"): item.text for item in block.findall("hardware/param")}
    assert block.findtext("hardware/plugin") == plugin
    assert float(given["trigger_joint_command_threshold"]) < 0
    assert (given["joint_commands_topic"], given["joint_states_topic"]) == ("/rig/joint_command", "joint_states")
    (joint,) = block.findall("joint")
    assert joint.get("name") == JOINT
    assert [item.get("name") for item in joint.findall("command_interface")] == ["effort"]
    assert [item.get("name") for item in joint.findall("state_interface")] == ["position", "velocity", "effort"]


def test_without_ros2_control_the_picture_remains() -> None:
    robot = urdf(hardware="none", stroke="0.25")
    assert robot.find("ros2_control") is None
    assert robot.find(f"joint[@name='{JOINT}']/limit").get("upper") == "0.25"


@pytest.mark.parametrize("hardware", ["joint_state", "none"])
def test_mujoco_loads_the_description(hardware: str) -> None:
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")
    model = mujoco.MjModel.from_xml_string(ElementTree.tostring(urdf(hardware=hardware), "unicode"))
    data, plant = mujoco.MjData(model), nominal_values()
    joint = model.joint(JOINT)
    assert (model.njnt, joint.type[0]) == (1, mujoco.mjtJoint.mjJNT_SLIDE)
    assert joint.axis.tolist() == [1.0, 0.0, 0.0]
    assert joint.range.tolist() == [-plant["actuator_displacement"], plant["actuator_displacement"]]
    for position in joint.range:  # the load meets the cylinder nowhere in the stroke
        data.qpos[0] = position
        mujoco.mj_forward(model, data)
        assert data.ncon == 0
    assert model.dof_M0[0] == pytest.approx(plant["moving_mass"])


def test_the_manager_asks_as_often_as_the_simulator_answers() -> None:
    controllers = yaml.safe_load((ROOT / "config" / "controllers.yaml").read_text())
    simulator = yaml.safe_load((ROOT / "config" / "simulator.yaml").read_text())
    given = simulator["/**/eha_sim"]["ros__parameters"]
    manager = controllers["/**/controller_manager"]["ros__parameters"]
    assert manager["update_rate"] == given["publish_rate"] == ROWS["publish_rate"].default
    for name, value in given.items():
        ROWS[name].convert(value)
    configured = {key.rpartition("/")[2] for key in controllers} - {"controller_manager"}
    assert configured == {name for name, value in manager.items() if isinstance(value, dict)}


def test_a_parameters_file_may_carry_every_setting_of_the_node() -> None:
    parts = {f"plant.{kind}" for kind in ("source", "cylinder", "load")}  # which a nominal file says, too
    assert set(ROWS) - parts <= NODE_ONLY


@pytest.mark.parametrize(
    "path", sorted((ROOT.parent / "eha_sim_node" / "config").glob("*.yaml")), ids=lambda path: path.stem
)
def test_the_files_shipped_act_in_any_namespace(path: Path) -> None:
    assert all(key.startswith("/**/eha_") for key in yaml.safe_load(path.read_text()))
