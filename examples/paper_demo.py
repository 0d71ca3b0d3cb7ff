"""The paper's experiment on a living system: three processes on DDS, internal leakage turned up while they run.

Starts the simulator, the reference generator and the monitor, takes internal_leakage through the paper's four levels
with the parameter service, 10 s of simulated time each, and leaves under out/demo/ one recording, rmse.json and the
figures drawn from the recording. In lockstep, so two runs give the same figures; `--realtime` runs against the wall
clock instead and states what the transport changes.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from conductor import SIMULATOR_TOPICS, LeakageConductor, Processes, perform
from rosbags.highlevel import AnyReader

from eha_core.paper import LEVELS, PRINTED_RMSE, Level, as_json, measure, reproduce
from eha_core.plant import Plant
from eha_core.report.paper_figures import draw_paper_figures

ROOT = Path(__file__).resolve().parents[1]
CONFIG = ROOT / "eha_sim_node" / "config"
LEVEL_SECONDS = 10.0
HALF_PERIOD = 1e-3  # s


class Progress:
    """Tells on the terminal how far the experiment is: a line that changes, then one line for each level."""

    def __init__(self) -> None:
        self._live = sys.stdout.isatty()
        self._shown = 0.0

    def show(self, number: int, leakage: float, seconds: float, rmse: float) -> None:
        """Show the level's progress, a few times a second."""
        if self._live and time.monotonic() - self._shown > 0.2:
            self._shown = time.monotonic()
            print(
                f"\r  level {number}  {leakage:7.0e}  {seconds:4.1f} of {LEVEL_SECONDS:g} s  {rmse * 1e3:8.4f} mm",
                end="",
            )
            sys.stdout.flush()

    def done(self, number: int, leakage: float, rmse: float) -> None:
        """Show the level's result beside the paper's."""
        printed = PRINTED_RMSE[number - 1]
        start = "\r" if self._live else ""
        print(
            f"{start}  level {number}  {leakage:7.0e}  RMSE {rmse * 1e3:7.4f} mm   Table 3 {printed * 1e3:7.4f} mm"
            f"   ratio {rmse / printed:.3f}",
            flush=True,
        )


@dataclass(frozen=True)
class Passed:
    """One level as the monitor saw it: from and to which stamp [s], and the RMSE [m]."""

    internal_leakage: float
    start: float
    end: float
    rmse: float


def run_levels(conductor: LeakageConductor, realtime: bool, progress: Progress) -> list[Passed]:
    """Take the leakage through the paper's levels, one after the other without a restart."""
    if realtime:
        conductor.wait(lambda: conductor.stamp > 0, 20, "the first tracking error")
    passed = []
    for number, leakage in enumerate(LEVELS, 1):
        conductor.turn_leakage(leakage)
        start = conductor.stamp

        def show(number: int = number, leakage: float = leakage, start: float = start) -> None:
            progress.show(number, leakage, conductor.stamp - start, conductor.error.rmse)

        if realtime:
            conductor.follow(start + LEVEL_SECONDS, show)
        else:
            conductor.run(LEVEL_SECONDS, show)
        passed.append(Passed(leakage, start, conductor.stamp, conductor.error.rmse))
        progress.done(number, leakage, conductor.error.rmse)
    return passed


def start_nodes(processes: Processes, out: Path, realtime: bool) -> None:
    """Start simulator, monitor and reference with the experiment's parameters file."""
    file = str(CONFIG / ("realtime.yaml" if realtime else "paper.yaml"))
    processes.start("sim", "--params-file", file)
    processes.start("monitor", "--params-file", file, "-p", f"directory:={out}", "-p", "name:=demo")
    processes.start("reference", "--params-file", file)


def recorded_levels(recording: Path, passed: list[Passed]) -> list[Level]:
    """Read the levels back from the recording: displacement and reference, paired by stamp."""
    curves: dict[str, list[tuple[float, float]]] = {"/joint_states": [], "/reference": []}
    with AnyReader([recording]) as bag:
        chosen = [connection for connection in bag.connections if connection.topic in curves]
        for connection, _, data in bag.messages(connections=chosen):
            message: Any = bag.deserialize(data, connection.msgtype)
            stamp = message.header.stamp
            curves[connection.topic].append((stamp.sec + stamp.nanosec * 1e-9, float(message.position[0])))
    time_measured, position = np.array(curves["/joint_states"]).T
    reference = np.interp(time_measured, *np.array(curves["/reference"]).T)
    levels = []
    for level in passed:
        inside = (time_measured > level.start + HALF_PERIOD) & (time_measured < level.end + HALF_PERIOD)
        if level is passed[0]:
            inside |= time_measured == level.start
        times = time_measured[inside] - level.start
        levels.append(measure(level.internal_leakage, times, position[inside], reference[inside]))
    return levels


def without_transport() -> list[float]:
    """Return the RMSE of each level [m] when the library alone goes through the same sequence, no process between."""
    command = 8.4e-3 * np.sin(2 * np.pi * np.repeat(np.arange(round(LEVEL_SECONDS / 0.002)) * 0.002, 20))
    leaking, tight = Plant(), Plant({"internal_leakage": 0.0})
    rmse = []
    for leakage in LEVELS:
        leaking.set_parameters({"internal_leakage": leakage})
        error = leaking.run(command, every=20).position - tight.run(command, every=20).position
        samples = error if rmse else np.append(0.0, error)  # the first level counts the start as well
        rmse.append(float(np.sqrt(np.mean(samples**2))))
    return rmse


def demonstrate(out: Path, realtime: bool) -> None:
    """Run the experiment and write the recording, rmse.json and the figures to a folder."""
    out.mkdir(parents=True, exist_ok=True)
    for former in out.glob("demo*.mcap"):
        former.unlink()
    began = time.monotonic()
    processes = Processes(out / "logs")
    conductor = None
    print(
        f"sim, reference and monitor on DDS domain {os.environ['ROS_DOMAIN_ID']}, "
        f"{'against the wall clock' if realtime else 'in lockstep'}; internal leakage is turned while they run",
        flush=True,
    )
    try:
        start_nodes(processes, out, realtime)
        conductor = LeakageConductor(processes)
        conductor.await_nodes((*SIMULATOR_TOPICS, "reference"))
        passed = run_levels(conductor, realtime, Progress())
    finally:
        processes.stop()
        if conductor:
            conductor.close()
    levels = recorded_levels(out / "demo.mcap", passed)
    (out / "rmse.json").write_text(json.dumps(as_json(levels), indent=2) + "\n")
    draw_paper_figures(levels, out / "figures", reproduce().sweep)
    account(passed, levels)
    if realtime:
        print("What comes late by transport or on a busy machine makes the difference; /diagnostics was recorded.")
    print(f"{time.monotonic() - began:.0f} s; recording, rmse.json and figures are in {out}", flush=True)


def account(passed: list[Passed], levels: list[Level]) -> None:
    """Say how live, recorded and computed errors agree, and with the paper."""
    print("\n  level   live [mm]  recorded [mm]  without transport [mm]  difference [um]   Table 3 [mm]")
    for number, (live, recorded, alone) in enumerate(zip(passed, levels, without_transport(), strict=True), 1):
        print(
            f"  {number:5d}  {live.rmse * 1e3:10.5f}  {recorded.rmse * 1e3:13.5f}  {alone * 1e3:22.5f}"
            f"  {(live.rmse - alone) * 1e6:15.1e}  {recorded.printed * 1e3:13.4f}"
        )
    print(
        "\nThe levels follow one another without a restart. The paper leaves its sine open; amplitude and frequency"
        "\nare read off its errors; without transport level 4 is 7 to 9 % low (`eha paper` says what else is assumed).",
    )


def main() -> int:
    """Run the demonstration and return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--realtime", action="store_true", help="run against the wall clock instead of in lockstep")
    parser.add_argument("--out", type=Path, help="folder for the recording, rmse.json and figures/")
    arguments = parser.parse_args()
    out = arguments.out or ROOT / "out" / ("demo-realtime" if arguments.realtime else "demo")
    return perform("paper_demo", lambda: demonstrate(out, arguments.realtime))


if __name__ == "__main__":
    sys.exit(main())
