"""What a user can get wrong at the start: one line that names what, where and the remedy, and exit status 2."""

from __future__ import annotations

import signal

import pytest
from conftest import Rig
from rcl_interfaces.srv import GetParameters

from eha_interfaces.msg import ActuatorState

FILES = {
    "unknown name": ("eha_sim: {ros__parameters: {moving_maas: 9.0}}", "moving_maas"),
    "out of range": ("eha_sim: {ros__parameters: {bulk_modulus: -1.0}}", "bulk_modulus"),
    "no number": ("eha_sim: {ros__parameters: {moving_mass: heavy}}", "moving_mass"),
    "not finite": ("eha_sim: {ros__parameters: {moving_mass: .nan}}", "moving_mass"),
    "unknown mode": ("eha_sim: {ros__parameters: {time_mode: warp}}", "warp"),
    "rate and step": ("eha_sim: {ros__parameters: {publish_rate: 333.0}}", "publish_rate"),
    "a source of no volts": ("eha_sim: {ros__parameters: {plant: {source: measured_flow}}}", "flow_a and flow_b"),
    "another's parameter": (
        "eha_sim: {ros__parameters: {plant: {cylinder: rotary_vane}, piston_area: 1.0e-3}}",
        "piston_area",
    ),
    "an effect's": ("eha_sim: {ros__parameters: {coulomb_friction: {force: -5.0}}}", "coulomb_friction.force"),
}


@pytest.mark.parametrize(("text", "named"), FILES.values(), ids=FILES.keys())
def test_a_parameters_file_that_is_refused(rig: Rig, text: str, named: str) -> None:
    path = rig.folder / "bad.yaml"
    path.write_text(text.replace("eha_sim:", "/**:"))
    process = rig.start("sim", "--params-file", str(path))
    assert process.wait() == 2
    lines = [line for line in process.output.splitlines() if line.startswith("eha_sim:")]
    assert len(lines) == 1
    assert named in lines[0]
    assert "Traceback" not in process.output


ALIASES = "/**:\n  ros__parameters:\n    a: &a {x: 1.0, y: 2.0}\n" + "".join(
    f"    {new}: &{new} {{{', '.join(f'k{k}: *{old}' for k in range(9))}}}\n"
    for old, new in zip("abcdefgh", "bcdefghi", strict=True)
)
"""Nine to the eighth values in less than a kilobyte."""
TWICE = "/**:\n  ros__parameters:\n    moving_mass: 9.0\n    moving_mass: 90.0\n"


@pytest.mark.parametrize(
    ("content", "named"),
    [
        (None, "No such file"),
        ("eha_sim: [unclosed", "this is not YAML"),
        (ALIASES, "line 4: aliases are not read"),
        (TWICE, "line 4: moving_mass is already in line 3"),
        ("/**: {ros__parameters: {moving_mass: 1:30:00}}", "moving_mass"),
    ],
    ids=["missing", "no YAML", "aliases", "a key twice", "sixties"],
)
def test_a_parameters_file_that_cannot_be_read(rig: Rig, content: str | None, named: str) -> None:
    path = rig.folder / "bad.yaml"
    if content is not None:
        path.write_text(content)
    process = rig.start("sim", "--params-file", str(path))
    assert process.wait() == 2
    lines = [line for line in process.output.splitlines() if line.startswith("eha_sim:")]
    assert len(lines) == 1 and named in lines[0]
    assert "Traceback" not in process.output


@pytest.mark.parametrize(
    ("executable", "parameters", "named"),
    [
        ("reference", ("signal:=spiral",), "spiral"),
        ("reference", ("sine.frequency:=-1.0",), "frequency"),
        ("monitor", ("window:=-2.0",), "window"),
        ("monitor", ("directroy:=bags",), "directroy"),
    ],
)
def test_the_other_nodes_refuse_alike(rig: Rig, executable: str, parameters: tuple[str, ...], named: str) -> None:
    process = rig.start(executable, *parameters)
    assert process.wait() == 2
    assert named in process.output
    assert "Traceback" not in process.output


def test_a_second_node_of_the_same_name_is_refused(rig: Rig) -> None:
    first = rig.start_sim()
    rig.call(GetParameters, "eha_sim/get_parameters", names=["use_sim_time"])  # it runs; it was in the graph before
    second = rig.start("sim")
    assert second.wait() == 2
    lines = [line for line in second.output.splitlines() if line.startswith("eha_sim:")]
    assert len(lines) == 1 and f"{rig.namespace}/eha_sim" in lines[0]
    assert first.process.poll() is None


def test_of_three_nodes_of_one_name_that_start_at_once_one_stays(rig: Rig) -> None:
    started = [rig.start("sim") for _ in range(3)]
    rig.wait(lambda: sum(one.process.poll() is not None for one in started) >= 2, "the end of two")
    rig.spin(6.0)  # longer than any of them listens for others
    assert sorted(one.process.poll() or 0 for one in started) == [0, 2, 2]
    [stays] = [one for one in started if one.process.poll() is None]
    assert "running already" not in stays.output
    assert rig.call(GetParameters, "eha_sim/get_parameters", names=["use_sim_time"]).values


def test_a_killed_node_does_not_keep_its_successor_out(rig: Rig) -> None:
    rig.start_sim().end(signal.SIGKILL)
    successor = rig.start("sim")
    states = rig.hear(ActuatorState, "state")
    rig.wait(lambda: states, "a state of the second simulator")
    assert successor.process.poll() is None


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_node_cleanly(rig: Rig, number: int) -> None:
    sim = rig.start_sim()
    rig.spin(1.5)
    assert sim.end(number) == 0
    assert "Traceback" not in sim.output


def test_more_signals_do_not_break_off_the_end(rig: Rig) -> None:
    sim = rig.start_sim()
    rig.spin(1.5)
    for _ in range(50):  # ros2 launch sends one beside the terminal's
        sim.process.send_signal(signal.SIGINT)
        rig.spin(0.002)
    assert sim.wait(15.0) == 0
    assert "Traceback" not in sim.output
