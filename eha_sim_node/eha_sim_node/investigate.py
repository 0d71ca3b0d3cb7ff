"""The investigate node: a rig that interrogates itself, test after test, until one explanation remains.

Drives voltage_command, records every test, diagnoses all tests together and runs the test that the diagnosis proposes
next. It ends when one set of effects remains, when no test would tell more, or at a limit of tests or time. Any key, a
feedback topic that falls silent and a limit in sight stop the motion first.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import rclpy
import rclpy.node

from eha_core.api import given_model
from eha_core.detectability import read_limits
from eha_core.errors import EhaError, ParameterError
from eha_core.investigation import Bounds, Investigation, Watch, first_test, investigate
from eha_core.nominal import nominal_of
from eha_core.report.files import write_report
from eha_core.report.investigation import ending_account, step_account, write_investigation
from eha_sim_node.keyboard import Keyboard
from eha_sim_node.parameters import ParameterSet, Row, Value
from eha_sim_node.running import compile_plant, run
from eha_sim_node.topic_rig import TOPICS, Settings, TopicRig

NAME = "eha_investigate"
_NOW_AND_THEN = 10.0  # s between two lines about a diagnosis
_LEAVES = 60.0  # s that a diagnosis may take to notice that it is not wanted any more
OWN_ROWS = (
    Row("nominal", "", "parameters file of the rig as modelled, as eha diagnose takes it; empty: nominal", fixed=True),
    Row("limits", "", "file of what the rig bears, as eha detect --within takes it; empty: the model's", fixed=True),
    Row("command", "", "first test, as multisine:amplitude=0.05; empty: a multisine well within the limits",
        fixed=True),
    Row("command_duration", 0.0, "length of the first test [s]; 0: 10", 0.0, 120.0, fixed=True),
    Row("channels", "position,pressure_a,pressure_b", "what the rig measures", fixed=True),
    Row("directory", "out/investigation", "folder for recordings, diagnoses and the page", fixed=True),
    Row("tests", 5, "after how many tests the investigation ends", 1, 100, fixed=True),
    Row("time", 3600.0, "after how long no further test begins, in wall-clock time [s]", 1.0, 1e6, fixed=True),
    Row("lockstep", False, "whether each joint_states is answered with one voltage, instead of a timer", fixed=True),
    Row("rate", 500.0, "rate of the voltage where a timer drives it [Hz]", 0.1, 10_000.0, fixed=True),
    Row("feedback_timeout", 0.2, "age of a feedback at which the motion is stopped, in wall-clock time [s]",
        1e-3, 3600.0, fixed=True),
    Row("jobs", 2, "threads of a diagnosis", 1, 64, fixed=True),
)  # fmt: skip


class InvestigateNode(rclpy.node.Node):
    """Parameters -> rig over topics and model -> investigation, in a thread of its own -> page."""

    def __init__(self) -> None:
        super().__init__(NAME, automatically_declare_parameters_from_overrides=True)
        self._settings = ParameterSet(self, OWN_ROWS)
        own = self._settings.values
        self.status = 1  # until the investigation has come to an end of its own
        self._folder = Path(own["directory"])
        self._model = given_model(own["nominal"] or None) or nominal_of({})
        self._limits = read_limits(own["limits"] or None, self._model)
        self._first = first_test(own["command"], own["command_duration"], self._model, self._limits)
        settings = Settings(
            _channels(own["channels"]), own["lockstep"], own["rate"], own["feedback_timeout"],
            self._model.values["atmospheric_pressure"],
        )  # fmt: skip
        self._settings.declare(_refuse_changes)
        self._keyboard = Keyboard()
        self._rig = TopicRig(self, self._folder, settings, partial(Watch, self._limits), self._keyboard.pressed)
        self._logged = 0.0
        self._thread = threading.Thread(target=self._investigate, name="investigation")
        self._thread.start()
        if self._keyboard.is_there:
            self.get_logger().info("any key stops the rig")

    def close(self) -> None:
        """Stop the rig, and wait until the investigation has noticed."""
        self._rig.close()
        self._thread.join(_LEAVES)
        self._keyboard.close()

    def _investigate(self) -> None:
        """The whole investigation; ends the node."""
        own = self._settings.values
        bounds = Bounds(own["tests"], own["time"])
        try:
            state = investigate(
                self._rig, self._model, self._limits, self._first, bounds, self._tell, self._progress, own["jobs"]
            )
            self._conclude(state)
        except EhaError as error:
            print(f"{NAME}: {error}", file=sys.stderr, flush=True)
            self.status = 2
        finally:
            rclpy.try_shutdown()

    def _conclude(self, state: Investigation) -> None:
        """Write the whole diagnosis, say how it ended, and set the exit status."""
        if state.found is not None:
            write_report(state.found, self._folder / "diagnosis")
        print(ending_account(state, self._folder), flush=True)
        if state.ending is not None and state.ending.kind == "stopped":
            print(f"{NAME}: {state.ending.statement}", file=sys.stderr, flush=True)
        else:
            self.status = 0

    def _tell(self, state: Investigation) -> None:
        write_investigation(state, self._folder)
        if state.ending is None or state.ending.kind not in ("stopped", "failed"):
            print(step_account(state), flush=True)

    def _progress(self, message: str) -> None:
        """Log what begins, and now and then what a diagnosis is at."""
        if time.monotonic() - self._logged > _NOW_AND_THEN:
            self._logged = time.monotonic()
            self.get_logger().info(message)


def _channels(text: str) -> tuple[str, ...]:
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    for name in names:
        if name not in TOPICS:
            raise ParameterError(f"channels: there is no channel {name!r}; give some of {', '.join(TOPICS)}")
    if "position" not in names:
        raise ParameterError("channels: position is missing, and nothing moves without it; add it")
    return names


def _refuse_changes(changes: Mapping[str, Value]) -> None:
    raise EhaError(f"{', '.join(changes)} cannot change while the rig is investigated")


def main() -> int:
    """Run the investigate node."""
    return run(InvestigateNode, NAME, OWN_ROWS, compile_plant)


if __name__ == "__main__":
    sys.exit(main())
