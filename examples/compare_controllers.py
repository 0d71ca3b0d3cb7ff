"""Every controller on every rig, over DDS in lockstep: four levels of internal leakage, and concealed friction.

Starts simulator and reference once and each controller in turn, turns the rig's parameters with the parameter service,
and scores what the topics said. The feedforward is run with the data sheet's values and, on the rig with friction, with
what a diagnosis of that rig's recording found: by the library, and as `eha export controller` writes it. Leaves under
out/controllers/ scores.json, table.md and controllers.png.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from conductor import PIECE, Conductor, DemoError, Processes, perform
from controller_figures import draw
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from eha_core.control.scoring import Score, score
from eha_core.paper import LEVELS
from eha_interfaces.msg import ActuatorState

ROOT = Path(__file__).resolve().parents[1]
RECORDING = ROOT / "bags" / "rig_coulomb_friction.mcap"
EXPORTED = ROOT / "examples" / "exported_controller.py"
SECONDS, SKIP, PERIOD = 4.0, 1.0, 0.002  # s of each run, s until it is scored, s between commands
AMPLITUDE, FREQUENCY = 0.01, 1.0  # m, Hz of the reference
_HALF = PERIOD / 2
_FOUND = 0.5  # s until nodes that see each other in the graph are surely matched
PATIENCE = 1200.0  # s for a controller to start, or a piece of a run: a busy machine is no failure
SOUND: Mapping[str, float] = {"moving_mass": 9.0, "coulomb_friction.force": 0.0, "internal_leakage": 1e-12}
FRICTION = "friction 250 N"
DIAGNOSED = "feedforward, diagnosis"
RIGS: Mapping[str, Mapping[str, float]] = {
    **{f"leakage {level:g}": {**SOUND, "internal_leakage": level} for level in LEVELS},
    FRICTION: {**SOUND, "moving_mass": 11.0, "coulomb_friction.force": 250.0},  # as recorded in RECORDING
}


@dataclass(frozen=True)
class Contender:
    """A controller, how its node is started, and the rigs it runs on."""

    title: str
    words: tuple[str, ...]
    rigs: tuple[str, ...] = tuple(RIGS)


def contenders(diagnosis: Path) -> list[Contender]:
    """Every controller with nominal values, and the feedforward that knows the diagnosis in a folder, in two forms."""
    node = ("-m", "eha_sim_node.controller", "--ros-args", "-p")
    nominal = [
        Contender(law.replace("_", " "), (*node, f"controller:={law}"))
        for law in ("pid", "cascade", "lqr", "sliding_mode")
    ]
    feedforward = (*node, "controller:=feedforward")
    exported = (str(EXPORTED), "--ros-args", "-p", f"folder:={diagnosis / 'controller'}")
    return [
        *nominal,
        Contender("feedforward, data sheet", feedforward),
        Contender(DIAGNOSED, (*feedforward, "-p", f"model:={diagnosis / 'fitted.yaml'}"), (FRICTION,)),
        Contender("feedforward, exported from the diagnosis", exported, (FRICTION,)),
    ]


class Comparison(Conductor):
    """Steps the rig and keeps what its topics say."""

    def __init__(self, processes: Processes) -> None:
        super().__init__(processes)
        self._states: dict[int, Any] = {}
        self._targets: dict[int, float] = {}
        self._node.create_subscription(ActuatorState, "state", self._on_state, 5000)
        self._node.create_subscription(JointState, "reference", self._on_reference, 5000)
        self._parameters = self._node.create_client(SetParameters, "eha_sim/set_parameters")
        self._resets = [self._node.create_client(Trigger, f"{name}/reset") for name in ("eha_sim", "eha_reference")]
        self._clients = [self._step, self._parameters, *self._resets]

    def _on_state(self, message: Any) -> None:
        self._states[_tick(message.header.stamp)] = message

    def _on_reference(self, message: Any) -> None:
        self._targets[_tick(message.header.stamp)] = message.position[0]

    def meet(self) -> None:
        """Wait until a controller that has just been started hears the rig and is heard."""
        listening = ("joint_states", "reference")
        self.wait(lambda: all(map(self._controller_hears, listening)), PATIENCE, "the controller")
        matched = time.monotonic() + _FOUND
        self.wait(lambda: time.monotonic() > matched, PATIENCE, "the controller")

    def _controller_hears(self, topic: str) -> bool:
        return any(info.node_name == "eha_controller" for info in self._node.get_subscriptions_info_by_topic(topic))

    def run(self, rig: Mapping[str, float]) -> tuple[Score, list[tuple[float, float]]]:
        """Run from rest on a rig; return the score, and time [s] and error [m] of each sample scored."""
        values = [Parameter(name, value=value).to_parameter_msg() for name, value in rig.items()]
        for result in self._call(self._parameters, SetParameters.Request(parameters=values)).results:
            if not result.successful:
                raise DemoError(f"the simulator refused a parameter: {result.reason}")
        for client in self._resets:
            self._call(client, Trigger.Request())
        start = max(self._states, default=0)
        self._targets.clear()
        for piece in range(1, round(SECONDS / PIECE) + 1):
            self.step(PIECE)
            last = start + round(piece * PIECE / PERIOD)
            self.wait(lambda last=last: last in self._states and last in self._targets, PATIENCE, f"tick {last}")
        return self._scored(start)

    def _scored(self, start: int) -> tuple[Score, list[tuple[float, float]]]:
        ticks = range(start + round(SKIP / PERIOD), start + round(SECONDS / PERIOD) + 1)
        states = [self._states[tick] for tick in ticks]
        error = np.array([self._states[tick].measured_position - self._targets[tick] for tick in ticks])
        names = ("voltage", "flow_a", "flow_b", "supply_pressure")
        columns = [np.array([getattr(state, name) for state in states]) for name in names]
        times = [(tick - start) * PERIOD for tick in ticks]
        return score(error, *columns, period=PERIOD), list(zip(times, error.tolist(), strict=True))


def _tick(stamp: Any) -> int:
    return round((stamp.sec + stamp.nanosec * 1e-9) / PERIOD)


def compare(diagnosis: Path, logs: Path) -> list[dict[str, Any]]:
    """Run every contender on its rigs; return one row each."""
    processes, conductor, rows = Processes(logs), None, []
    signal = ("mode:=position", "lockstep:=true", f"sine.amplitude:={AMPLITUDE}", f"sine.frequency:={FREQUENCY}")
    try:
        processes.start("sim", "-p", "time_mode:=lockstep", "-p", "lockstep_patience:=0.0", "-p", "start_paused:=true")
        processes.start("reference", *(word for given in signal for word in ("-p", given)))
        conductor = Comparison(processes)
        conductor.await_nodes(())
        for contender in contenders(diagnosis):
            processes.start_program("controller", *contender.words)
            conductor.meet()
            for rig in contender.rigs:
                made, errors = conductor.run(RIGS[rig])
                rows.append({"controller": contender.title, "rig": rig, **asdict(made), "errors": errors})
                print(f"  {contender.title:40s} {rig:16s} {1e6 * made.rmse:9.1f} um", flush=True)
            processes.stop("controller")
    finally:
        processes.stop()
        if conductor:
            conductor.close()
    return rows


def diagnose(folder: Path) -> Path:
    """Diagnose the recording of the rig with friction and export a controller from it; return the diagnosis' folder."""
    _eha("diagnose", str(RECORDING), "--out", str(folder))
    _eha("export", "controller", "--from", str(folder / "diagnosis.json"), "--out", str(folder / "controller"))
    return folder


def _eha(*words: str) -> None:
    """Run a command of `eha`, and show what it found."""
    print(f"$ eha {' '.join(word.removeprefix(f'{ROOT}/') for word in words)}", flush=True)
    done = subprocess.run([sys.executable, "-m", "eha_core.cli", *words], capture_output=True, text=True, check=False)
    if done.returncode:
        raise DemoError(f"eha {words[0]} ended with status {done.returncode}: {done.stderr.strip()}")
    shown = ("Verdict", "Named", "effects compensated")
    print("\n".join(line for line in done.stdout.splitlines() if line.startswith(shown)), flush=True)


def table(rows: list[dict[str, Any]]) -> str:
    """The rows as a Markdown table."""
    lines = ["| controller | rig | RMSE [um] | largest error [um] | energy [J] | chattering [V/s] |", "|" + "---|" * 6]
    lines += [
        f"| {row['controller']} | {row['rig']} | {1e6 * row['rmse']:.1f} | {1e6 * row['largest_error']:.1f}"
        f" | {row['energy']:.0f} | {row['chattering']:.2f} |"
        for row in rows
    ]
    return "\n".join(lines) + "\n"


def demonstrate(out: Path) -> None:
    """Diagnose, run, score, and write what came of it."""
    began = time.monotonic()
    out.mkdir(parents=True, exist_ok=True)
    rows = compare(diagnose(out / "diagnosis"), out / "logs")
    draw(rows, out / "controllers.png")
    for row in rows:
        del row["errors"]
    (out / "scores.json").write_text(json.dumps(rows, indent=2) + "\n")
    (out / "table.md").write_text(table(rows))
    found = {row["controller"]: row["rmse"] for row in rows if row["rig"] == FRICTION}
    ratio = found["pid"] / found[DIAGNOSED]
    print(f"\n{table(rows)}\nOn the rig with friction the PID's RMSE is {ratio:.0f} times that of the feedforward made")
    print(f"from the diagnosis. {time.monotonic() - began:.0f} s; all of it is in {out}", flush=True)


def main() -> int:
    """Run the comparison and return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "controllers", help="folder for all that is written")
    arguments = parser.parse_args()
    return perform("compare_controllers", lambda: demonstrate(arguments.out))


if __name__ == "__main__":
    sys.exit(main())
