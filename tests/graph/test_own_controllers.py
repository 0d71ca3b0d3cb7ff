"""Controllers as a beginner writes them, of docs/your_own_controller.md: each arrives in every time mode."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from conftest import NodeProcess, Rig
from rosgraph_msgs.msg import Clock

from eha_interfaces.msg import ActuatorState

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "your_own_controller.md"
SIM_TIME = ("-p", "use_sim_time:=true")


def start(rig: Rig, name: str, *arguments: str) -> NodeProcess:
    """One of the examples in the test's namespace, and nobody else who commands."""
    rig.node.destroy_publisher(rig.commands)
    command = [sys.executable, str(ROOT / "examples" / f"{name}.py"), "--ros-args", "-r", f"__ns:={rig.namespace}"]
    process = NodeProcess(rig.folder / f"{name}.log", [*command, *arguments])
    rig.processes.append(process)
    return process


@pytest.mark.parametrize(
    ("name", "mode", "arguments"),
    [
        ("controller_callback", "realtime", ()),
        ("controller_callback", "scaled", SIM_TIME),
        ("controller_callback", "lockstep", ()),
        ("controller_timer", "realtime", ()),
        ("controller_timer", "scaled", SIM_TIME),
        ("controller_timer", "lockstep", ()),
        ("controller_timer", "lockstep", SIM_TIME),
    ],
)
def test_a_beginner_s_controller_runs_at_first_try(rig: Rig, name: str, mode: str, arguments: tuple[str, ...]) -> None:
    rig.start_sim(f"time_mode:={mode}", "diagnostics_rate:=5.0")
    states, reports = rig.hear(ActuatorState, "state"), rig.diagnostics("eha_sim")
    controller = start(rig, name, *arguments)
    rig.wait(lambda: states and abs(states[-1].position - 0.01) < 0.001, "the piston at 10 mm")
    rig.wait(lambda: any(float(report["real_time_factor"]) > 0.0 for report in reports), "the pace")
    if mode == "lockstep" and arguments:
        assert rig.processes[0].output.count("answer each joint_states with one command") == 1
        assert rig.processes[0].output.count("time now moves without commands, a period of 0.002 s every 0.01 s") == 1
    assert controller.end() == 0 and "Traceback" not in controller.output


def test_a_long_wait_is_said_once_in_the_log_and_in_diagnostics_with_the_remedy(rig: Rig) -> None:
    sim = rig.start_sim("time_mode:=lockstep", "lockstep_patience:=0.0", "diagnostics_rate:=5.0")
    reports, clocks = rig.diagnostics("eha_sim"), rig.hear(Clock, "/clock")
    told = "answer each joint_states with one command, or set lockstep_patience above 0"
    report = rig.wait(lambda: next((one for one in reports if told in one["message"]), None), "the warning", 20)
    assert report["level"] != reports[0]["level"] and report["real_time_factor"] == "0"
    rig.spin(1.0)
    assert sim.output.count(told) == 1
    assert {clock.clock.nanosec for clock in clocks} == {0}


@pytest.mark.parametrize("name", ["controller_callback", "controller_timer"])
def test_the_page_shows_what_runs_here(name: str) -> None:
    text = (ROOT / "examples" / f"{name}.py").read_text()
    assert f"```python\n{text}```" in PAGE.read_text()
    assert len(text.splitlines()) <= 35
