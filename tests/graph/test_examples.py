"""The examples as a user runs them: the demonstrations in lockstep, and a position controller of one's own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import NodeProcess, Rig
from headlines import hold_against
from mcap.reader import make_reader
from sensor_msgs.msg import JointState

from eha_core.cli import main
from eha_core.plant import Plant
from eha_core.recording import read_recording
from eha_exam.truth import simulate_truth

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
sys.path.insert(0, str(EXAMPLES))
import concealment  # noqa: E402 - beside the examples, which are no package

LEVELS = (1e-12, 1e-11, 1e-10, 1e-9)


def test_the_demonstration_equals_the_plant_to_rounding(tmp_path: Path) -> None:
    # Another domain than the session's: the demonstration's nodes bear no namespace.
    environment = {**os.environ, "ROS_DOMAIN_ID": str(int(os.environ["ROS_DOMAIN_ID"]) - 1)}
    command = [sys.executable, str(EXAMPLES / "paper_demo.py"), "--out", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=180, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    levels = json.loads((tmp_path / "rmse.json").read_text())["levels"]
    assert [level["internal_leakage"] for level in levels] == list(LEVELS)
    command_voltage = np.repeat(8.4e-3 * np.sin(2 * np.pi * np.arange(5000) * 0.002), 20)
    leaking, tight = Plant(), Plant({"internal_leakage": 0.0})
    for number, level in enumerate(levels):
        leaking.set_parameters({"internal_leakage": LEVELS[number]})
        error = leaking.run(command_voltage, every=20).position - tight.run(command_voltage, every=20).position
        samples = np.append(0.0, error) if number == 0 else error
        assert level["rmse"] == pytest.approx(np.sqrt(np.mean(samples**2)), rel=1e-9)
    assert [level["ratio"] for level in levels[:3]] == pytest.approx([1.0, 1.0, 1.0], abs=0.01)
    with (tmp_path / "demo.mcap").open("rb") as stream:
        leakage = [
            (message.log_time, np.frombuffer(message.data[4:], "<f8")[0])
            for _, _, message in make_reader(stream).iter_messages(topics=["/internal_leakage"])
        ]
    assert leakage == [(number * 10_000_000_000, value) for number, value in enumerate(LEVELS)]
    assert len(list((tmp_path / "figures").glob("*.png"))) == 3


@pytest.mark.timeout(1200)
def test_what_is_concealed_in_a_rig_is_named_and_simulated(tmp_path: Path) -> None:
    environment = {**os.environ, "ROS_DOMAIN_ID": str(int(os.environ["ROS_DOMAIN_ID"]) - 1)}
    command = [sys.executable, str(EXAMPLES / "concealed_demo.py"), "--seed", "1", "--out", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1190, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    answer, digest = concealment.unseal(tmp_path / "answer.sealed")
    assert done.stdout.count(f"SHA-256 {digest[:16]}...") == 2
    assert answer == concealment.draw(1)
    document = json.loads((tmp_path / "diagnosis" / "diagnosis.json").read_text())
    assert document["verdict"] == "missing_physics"
    hold_against((tmp_path / "diagnosis" / "report.html").read_text(encoding="utf-8"), document)
    assert {effect["id"] for effect in document["effects"]} == set(answer.effects)
    for effect in document["effects"]:
        for name, true in answer.effects[effect["id"]].items():
            found = effect["parameters"][name]
            assert abs(found["value"] - true) < 4.0 * found["std"] < 0.05 * true
    # The claim ends at the noise: the simulator with what was found is as near the rig as its sensors can tell.
    errors = json.loads((tmp_path / "before_after.json").read_text())
    for name in ("position", "pressure_a", "pressure_b"):
        assert errors["nominal"][name] > 10.0 * answer.noises[name]
        assert 0.95 < errors["fitted"][name] / answer.noises[name] < 1.15
    rig = tmp_path / "rig.mcap"
    with rig.open("rb") as stream:
        reader = make_reader(stream)
        topics = {channel.topic for channel in reader.get_summary().channels.values()}
        text = repr([record for record in reader.iter_metadata() if record.name != "eha_coverage"]).encode()
        assert text == b"[]"
        stream.seek(0)
        text = b"".join(message.data for _, _, message in make_reader(stream).iter_messages())
    assert not topics & {"/state", "/internal_leakage"}
    assert not any(effect.encode() in text for effect in answer.effects)
    # What the nominal error is measured between is what the two plants do.
    volts = read_recording(rig).channels["voltage_command"].values[:6000]
    truth = simulate_truth(answer.plant, tuple(answer.effects.items()), np.append(volts, 0.0), 12.0, 500.0)
    nominal = Plant().run(np.repeat(volts, 20), every=20)
    expected = np.sqrt(np.mean((truth["position"][1:] - nominal.position) ** 2) + answer.noises["position"] ** 2)
    assert errors["nominal"]["position"] == pytest.approx(expected, rel=1e-3)


def test_a_seal_holds_and_no_effect_can_be_read_through_it(tmp_path: Path) -> None:
    answer = concealment.draw(7)
    digest = concealment.seal(answer, tmp_path / "answer.sealed")
    assert concealment.unseal(tmp_path / "answer.sealed") == (answer, digest)
    assert not any(effect.encode() in (tmp_path / "answer.sealed").read_bytes() for effect in answer.effects)
    assert concealment.draw().seed != concealment.draw().seed


@pytest.mark.timeout(1200)
def test_a_rig_that_interrogates_itself_finds_what_a_first_test_left_open(tmp_path: Path) -> None:
    environment = {**os.environ, "ROS_DOMAIN_ID": str(int(os.environ["ROS_DOMAIN_ID"]) - 1)}
    command = [sys.executable, str(EXAMPLES / "investigation_demo.py"), "--seed", "1", "--out", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1190, env=environment, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    answer, _ = concealment.unseal(tmp_path / "small_answer.sealed")
    found = json.loads((tmp_path / "investigation" / "investigation.json").read_text())
    first, *further = found["steps"]
    assert len(first["sets"]) > 1 and further
    assert found["ending"]["kind"] == "resolved"
    assert [one["effects"] for one in further[-1]["sets"]] == [list(answer.effects)]
    budget = json.loads((tmp_path / "budget" / "budget.json").read_text())
    shares = sum(row["share"]["value"] for row in budget["shares"]) + budget["modelled"]["value"]
    assert shares == pytest.approx(budget["today"]["value"], rel=1e-9)
    assert set(answer.effects) <= {row["name"] for row in budget["shares"]}


@pytest.mark.parametrize("name", ["concealed_demo", "investigation_demo"])
def test_a_demonstration_that_fails_says_so_in_one_line(tmp_path: Path, name: str) -> None:
    (tmp_path / "out").write_text("in the way")
    command = [sys.executable, str(EXAMPLES / f"{name}.py"), "--out", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith(f"{name}: ") and done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["concealed_rig.py"], "usage: "),
        (["concealed_rig.py", "nowhere"], "concealed_rig: nowhere: is no sealed file"),
        (["log_files.py", "nowhere", "out"], "log_files: nowhere: "),
    ],
)
def test_an_example_that_was_given_no_file_says_so_in_one_line(tmp_path: Path, words: list[str], text: str) -> None:
    command = [sys.executable, str(EXAMPLES / words[0]), *words[1:]]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr.startswith(text) and done.stderr.count("\n") == 1


def largest_error(rig: Rig, example: str, *parameters: str) -> float:
    """Of the position [m], from the third second on, where an example leads the rig along a sine of 10 mm."""
    rig.node.destroy_publisher(rig.commands)
    rig.start_sim("time_mode:=lockstep")
    rig.start("reference", "mode:=position", "lockstep:=true", "signal:=sine", "sine.amplitude:=0.01")
    given = [word for parameter in parameters for word in ("-p", parameter)]
    command = [str(EXAMPLES / example), "--ros-args", "-r", f"__ns:={rig.namespace}", *given]
    rig.processes.append(NodeProcess(rig.folder / "controller.log", [sys.executable, *command]))
    measured, references = rig.hear(JointState, "joint_states"), rig.hear(JointState, "reference")
    rig.wait(lambda: len(measured) > 2000 and len(references) > 2000, "four seconds of simulated time")
    by_stamp = {(item.header.stamp.sec, item.header.stamp.nanosec): item.position[0] for item in references}
    errors = [
        item.position[0] - by_stamp[(item.header.stamp.sec, item.header.stamp.nanosec)]
        for item in measured[1000:2000]
        if (item.header.stamp.sec, item.header.stamp.nanosec) in by_stamp
    ]
    assert len(errors) > 900
    return float(np.abs(errors).max())


def test_a_controller_of_ones_own_follows_a_position(rig: Rig) -> None:
    found = largest_error(rig, "position_controller.py", "gain:=10.0", "feedforward:=0.8")
    assert found < 0.001  # a tenth of the amplitude


def test_an_exported_controller_follows_a_position(rig: Rig) -> None:
    assert main(["export", "controller", "--out", str(rig.folder / "exported")]) == 0
    assert largest_error(rig, "exported_controller.py", f"folder:={rig.folder / 'exported'}") < 2e-6
