"""A rig with physics concealed in it is driven and recorded, diagnosed, and simulated again with what was found.

Simulator, reference and monitor run on DDS three times, each time under the same voltage: as the rig, with parameters
that nothing but the rig's own process reads; as the nominal model; and with the diagnosis's `fitted.yaml`. Between, the
command line diagnoses the rig's recording against the nominal model. Leaves the recordings, diagnosis/ and
before_after.json under out/demo/.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from conductor import DemoError, Processes, RigConductor, perform

from eha_core.parameters import load_parameters
from eha_core.recording import read_recording

ROOT = Path(__file__).resolve().parents[1]
CONFIG = ROOT / "eha_sim_node" / "config"
EXPERIMENT, NOMINAL, CONCEALED = (CONFIG / f"{name}.yaml" for name in ("identification", "nominal", "concealed_rig"))
SECONDS = 12.0
HALF_PERIOD = 1e-3  # s
PATIENCE = 180.0  # s for a run or the diagnosis, which take seconds on a machine that has nothing else to do
CHANNELS = {
    "position": ("position [um]", 1e6),
    "pressure_a": ("pressure of chamber 1 [kPa]", 1e-3),
    "pressure_b": ("pressure of chamber 2 [kPa]", 1e-3),
}
"""What is compared: the channel, how it is called, and its scale there."""


def drive_and_record(out: Path, name: str, parameters: Path) -> Path:
    """Run the experiment with the simulator's parameters from a file; return the recording."""
    began = time.monotonic()
    recording = out / f"{name}.mcap"
    recording.unlink(missing_ok=True)
    experiment = ("--params-file", str(EXPERIMENT))
    processes = Processes(out / "logs" / name)
    conductor = None
    try:
        processes.start("sim", *experiment, "--params-file", str(parameters))
        processes.start("monitor", *experiment, "-p", f"directory:={out}", "-p", f"name:={name}")
        processes.start("reference", *experiment)
        conductor = RigConductor(processes)
        conductor.await_nodes()
        conductor.run(SECONDS, 2 * HALF_PERIOD, PATIENCE)
    finally:
        processes.stop()
        if conductor:
            conductor.close()
    print(f"  {name:8s} {SECONDS:g} s of multisine recorded, {time.monotonic() - began:.0f} s", flush=True)
    return recording


def diagnose(recording: Path, folder: Path) -> Path:
    """Diagnose a recording against the nominal model as a user does; return the fitted parameters file."""
    words = ["diagnose", str(recording), "--nominal", str(NOMINAL), "--out", str(folder)]
    shown = [os.path.relpath(word) if word.startswith("/") else word for word in words]
    print(f"\n$ eha {' '.join(shown)}", flush=True)
    try:
        done = subprocess.run([sys.executable, "-m", "eha_core.cli", *words], timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        raise DemoError(f"the diagnosis took more than {PATIENCE:g} s") from None
    if done.returncode:
        raise DemoError(f"eha diagnose ended with status {done.returncode}")
    return folder / "fitted.yaml"


def departures(rig: Path, simulated: Path) -> dict[str, float]:
    """RMSE of each compared channel between two runs under the same command, sample by sample."""
    measured, model = read_recording(rig).channels, read_recording(simulated).channels
    errors = {}
    for name in CHANNELS:
        if name not in measured or name not in model:
            raise DemoError(f"{name} is missing in {rig if name not in measured else simulated}")
        one, other = measured[name], model[name]
        _, first, second = np.intersect1d(np.round(one.time / HALF_PERIOD), np.round(other.time / HALF_PERIOD),
                                          return_indices=True)  # fmt: skip
        if len(first) < 0.99 * SECONDS / (2 * HALF_PERIOD):
            raise DemoError(f"{rig} and {simulated} share only {len(first)} samples of {name}")
        errors[name] = float(np.sqrt(np.mean((one.values[first] - other.values[second]) ** 2)))
    return errors


def demonstrate(out: Path) -> None:
    """Conceal, record, diagnose, model, and compare."""
    began = time.monotonic()
    out.mkdir(parents=True, exist_ok=True)
    print("\nA rig that the model does not follow: driven, recorded over DDS, diagnosed, simulated again", flush=True)
    rig = drive_and_record(out, "rig", CONCEALED)
    fitted = diagnose(rig, out / "diagnosis")
    print("\nThe simulator again, under the same command:")
    before = departures(rig, drive_and_record(out, "nominal", NOMINAL))
    after = departures(rig, drive_and_record(out, "fitted", fitted))
    (out / "before_after.json").write_text(json.dumps({"nominal": before, "fitted": after}, indent=2) + "\n")
    print(f"\n  {'RMSE against the rig':28s} {'nominal':>10s} {'fitted':>10s} {'ratio':>8s}")
    for name, (title, scale) in CHANNELS.items():
        print(
            f"  {title:28s} {before[name] * scale:10.4g} {after[name] * scale:10.4g}"
            f" {before[name] / max(after[name], 1e-300):8.0f}"
        )
    concealed = ", ".join(f"{name} {value:g}" for name, value in load_parameters(CONCEALED).items())
    print(f"\nConcealed in the rig, and read by nothing but its simulator: {concealed}")
    print(f"{time.monotonic() - began:.0f} s; open {os.path.relpath(out / 'diagnosis' / 'report.html')}", flush=True)


def main() -> int:
    """Run the demonstration and return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "demo", help="folder for all that is written")
    arguments = parser.parse_args()
    return perform("concealed_demo", lambda: demonstrate(arguments.out))


if __name__ == "__main__":
    sys.exit(main())
