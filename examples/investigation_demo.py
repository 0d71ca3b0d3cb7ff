"""A rig with concealed physics interrogates itself, and what was found is charged with the tracking error it costs.

The rig is the exam's second plant, as in concealed_demo.py. What it conceals is small and sealed in a file. The
investigate node drives it over DDS with a first test, which leaves more than one explanation, diagnoses, and goes on
with the tests that the diagnoses propose until one is left. Then the sealed file is opened, and the error budget of
what was found is printed. Leaves investigation/ and budget/ under out/demo/.
"""

from __future__ import annotations

import os
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from shutil import rmtree

from concealment import conceal, draw_small, reveal
from conductor import INSTRUMENTS, Conductor, DemoError, Processes, perform_on_a_rig

from eha_core.report.budget import account, write_budget
from eha_core.studies import budget

HERE = Path(__file__).resolve().parent
LIMITS = HERE / "limits.yaml"
FIRST = ("square:amplitude=0.03,frequency=1.0", 4.0)
"""The first test, and its length [s]."""

TASK = "sine:amplitude=8.4e-3,frequency=1"
"""The motion whose error is accounted for: the paper's voltage, in open loop."""

FREE = 10**9  # samples that the rig may take: more than any investigation needs
PATIENCE = 1200.0  # s for the whole investigation: a minute on an idle machine, and a busy one is no failure


class RigStarter(Conductor):
    """Lets a rig answer every voltage, once the investigate node listens."""

    recorder = "eha_investigate"

    def __init__(self, processes: Processes) -> None:
        super().__init__(processes, "eha_rig", step_size=1.0)
        self._clients = [self._step]

    def start(self) -> None:
        """Let it run."""
        self.await_nodes(INSTRUMENTS)
        self.step(FREE)


def investigate(out: Path, sealed: Path) -> Path:
    """Let the node interrogate the rig of a sealed answer; return its diagnosis of all tests."""
    folder = out / "investigation"
    rmtree(folder, ignore_errors=True)
    processes = Processes(out / "logs" / "investigation")
    command, seconds = FIRST
    parameters = {"lockstep": "true", "limits": LIMITS, "directory": folder, "command": command,
                  "command_duration": seconds, "feedback_timeout": 60.0}  # fmt: skip
    words = [word for name, value in parameters.items() for word in ("-p", f"{name}:={value}")]
    shown = f"-p lockstep:=true -p limits:={os.path.relpath(LIMITS)} -p command:={command} ..."
    print(f"\n$ ros2 run eha_sim_node investigate --ros-args {shown}", flush=True)
    starter = None
    with (out / "logs" / "investigation" / "investigate.log").open("wb") as log:
        node = subprocess.Popen([sys.executable, "-m", "eha_sim_node.investigate", "--ros-args", *words],
                                stdin=subprocess.DEVNULL, stderr=log)  # fmt: skip
        try:
            processes.start_program("concealed_rig", str(HERE / "concealed_rig.py"), str(sealed))
            starter = RigStarter(processes)
            starter.start()
            starter.wait(lambda: node.poll() is not None, PATIENCE, "the end of the investigation")
        finally:
            node.terminate()
            with suppress(subprocess.TimeoutExpired):
                node.wait(timeout=60.0)
            processes.stop()
            if starter:
                starter.close()
    if node.returncode:
        raise DemoError(f"the investigate node ended with status {node.returncode}; see {log.name}")
    return folder / "diagnosis" / "diagnosis.json"


def demonstrate(out: Path, seed: int | None) -> Path:
    """Conceal, interrogate, open the answer, and say what the findings cost; return the investigation's page."""
    sealed = out / "small_answer.sealed"
    print("\nA rig that interrogates itself: each test is chosen by what those before left open")
    digest = conceal(draw_small(seed), sealed)
    found = investigate(out, sealed)
    for effect, values in reveal(sealed, digest).effects.items():
        print(f"  {effect}: " + ", ".join(f"{name} {value:.4g}" for name, value in values.items()))
    print(f"\n$ eha budget {os.path.relpath(found)} --command {TASK}")
    made = budget(found, TASK, controller="")
    write_budget(made, out / "budget")
    print(account(made))
    return out / "investigation" / "investigation.html"


def main() -> int:
    """Run the demonstration and return the exit status."""
    return perform_on_a_rig("investigation_demo", __doc__.splitlines()[0], demonstrate)


if __name__ == "__main__":
    sys.exit(main())
