"""A rig with physics concealed in it is driven and recorded, diagnosed, and simulated again with what was found.

The rig is the exam's second plant, written apart from the simulator and integrated by another method, with noise on its
instruments. What it conceals is drawn at random and sealed in a file. Rig, reference and monitor run on DDS and leave
rig.mcap, which holds measured channels alone. The command line diagnoses it against the nominal model. The simulator
then runs twice under the same voltage, as the nominal model and with the diagnosis's `fitted.yaml`. At the end the
sealed file is opened. Leaves the recordings, diagnosis/ and before_after.json under out/demo/.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from concealment import NOISES, Answer, conceal, draw, reveal
from conductor import INSTRUMENTS, SIMULATOR_TOPICS, DemoError, Processes, RigConductor, perform_on_a_rig

from eha_core.recording import read_recording

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
CONFIG = ROOT / "eha_sim_node" / "config"
EXPERIMENT, NOMINAL = CONFIG / "identification.yaml", CONFIG / "nominal.yaml"
SECONDS = 12.0
PERIOD = 2e-3  # s between two samples
PATIENCE = 1200.0  # s for a run or the diagnosis: a minute each on an idle machine, and a busy one is no failure
SURE = 1.96  # standard deviations to either side that make a 95 % interval
CHANNELS = {
    "position": ("position [um]", 1e6),
    "pressure_a": ("pressure of chamber A [kPa]", 1e-3),
    "pressure_b": ("pressure of chamber B [kPa]", 1e-3),
}
"""What is compared: the channel, how it is called, and its scale there."""


def record_rig(out: Path, answer: Path) -> Path:
    """Drive the rig of a sealed answer and record its instruments; return the recording."""
    with recorded(out, "rig", "eha_rig", PERIOD, INSTRUMENTS) as processes:
        processes.start_program("concealed_rig", str(HERE / "concealed_rig.py"), str(answer))
    return out / "rig.mcap"


def record_simulator(out: Path, name: str, parameters: Path) -> Path:
    """Drive the simulator with the parameters of a file and record it; return the recording."""
    with recorded(out, name, "eha_sim", 1e-4, SIMULATOR_TOPICS) as processes:
        processes.start("sim", "--params-file", str(EXPERIMENT), "--params-file", str(parameters))
    return out / f"{name}.mcap"


@contextmanager
def recorded(out: Path, name: str, plant: str, step: float, topics: tuple[str, ...]) -> Iterator[Processes]:
    """Run monitor and reference beside the plant that the body starts, until SECONDS are recorded."""
    began = time.monotonic()
    (out / f"{name}.mcap").unlink(missing_ok=True)
    processes = Processes(out / "logs" / name)
    conductor = None
    experiment = ("--params-file", str(EXPERIMENT))
    try:
        yield processes
        processes.start("monitor", *experiment, "-p", f"directory:={out}", "-p", f"name:={name}")
        processes.start("reference", *experiment)
        conductor = RigConductor(processes, plant, step, topics)
        conductor.await_nodes(topics)
        conductor.run(SECONDS, PERIOD, PATIENCE)
    finally:
        processes.stop()
        if conductor:
            conductor.close()
    print(f"  {name:8s} {SECONDS:g} s of multisine recorded, {time.monotonic() - began:.0f} s", flush=True)


def diagnose(recording: Path, folder: Path) -> dict:
    """Diagnose a recording against the nominal model as a user does; return diagnosis.json."""
    words = ["diagnose", str(recording), "--nominal", str(NOMINAL), "--out", str(folder)]
    shown = [os.path.relpath(word) if word.startswith("/") else word for word in words]
    print(f"\n$ eha {' '.join(shown)}", flush=True)
    try:
        done = subprocess.run([sys.executable, "-m", "eha_core.cli", *words], timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        raise DemoError(f"the diagnosis took more than {PATIENCE:g} s") from None
    if done.returncode:
        raise DemoError(f"eha diagnose ended with status {done.returncode}")
    return json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))


def departures(rig: Path, simulated: Path) -> dict[str, float]:
    """RMSE of each compared channel between two runs under the same command, sample by sample."""
    measured, model = read_recording(rig).channels, read_recording(simulated).channels
    errors = {}
    for name in CHANNELS:
        if name not in measured or name not in model:
            raise DemoError(f"{name} is missing in {rig if name not in measured else simulated}")
        one, other = measured[name], model[name]
        _, first, second = np.intersect1d(np.round(one.time / PERIOD), np.round(other.time / PERIOD),
                                          return_indices=True)  # fmt: skip
        if len(first) < 0.99 * SECONDS / PERIOD:
            raise DemoError(f"{rig} and {simulated} share only {len(first)} samples of {name}")
        errors[name] = float(np.sqrt(np.mean((one.values[first] - other.values[second]) ** 2)))
    return errors


def show_departures(before: dict[str, float], after: dict[str, float], noises: dict[str, float]) -> None:
    """How far each simulator is from the rig over the whole run, never corrected on the way."""
    headings = ("nominal", "fitted", "noise", "fitted/noise")
    print(f"\n  {'RMSE against the rig, free run':32s}" + "".join(f" {one:>13s}" for one in headings))
    for name, (title, scale) in CHANNELS.items():
        figures = (scale * before[name], scale * after[name], scale * noises[name], after[name] / noises[name])
        print(f"  {title:32s}" + "".join(f" {one:13.3g}" for one in figures))


def compare(answer: Answer, document: dict) -> dict[str, object]:
    """What was concealed beside what was named, and which of its values lie in their 95 % intervals."""
    named = {effect["id"]: effect["parameters"] for effect in document["effects"]}
    inside = {}
    print(f"\n  {'concealed':32s} {'true':>12s} {'found':>12s}   95 % interval")
    for effect, values in answer.effects.items():
        for name, value in values.items():
            title, row = f"{effect}.{name}", named.get(effect, {}).get(name)
            if row is None:
                print(f"  {title:32s} {value:12.5g} {'not named':>12s}")
                continue
            low, high = row["value"] - SURE * row["std"], row["value"] + SURE * row["std"]
            inside[title] = low <= value <= high
            within = "" if inside[title] else ": outside, as one in twenty is"
            print(f"  {title:32s} {value:12.5g} {row['value']:12.5g}   {low:.5g} to {high:.5g} {row['unit']}{within}")
    missed, extra = set(answer.effects) - set(named), set(named) - set(answer.effects)
    score = f"{len(set(answer.effects) & set(named))} of {len(answer.effects)} concealed effects were named"
    print(f"\n  {score}" + (f"; also named: {', '.join(sorted(extra))}" if extra else ", and nothing else"))
    return {"missed": sorted(missed), "extra": sorted(extra), "inside": inside}


def demonstrate(out: Path, seed: int | None) -> Path:
    """Conceal, record, diagnose, simulate again, and only then open the answer; return the report."""
    sealed = out / "answer.sealed"
    print("\nA rig that the model does not follow: driven, recorded over DDS, diagnosed, simulated again")
    digest = conceal(draw(seed), sealed)
    rig = record_rig(out, sealed)
    document = diagnose(rig, out / "diagnosis")
    print("\nThe simulator under the same command:")
    before = departures(rig, record_simulator(out, "nominal", NOMINAL))
    after = departures(rig, record_simulator(out, "fitted", out / "diagnosis" / "fitted.yaml"))
    show_departures(before, after, NOISES)
    answer = reveal(sealed, digest)
    errors = {"nominal": before, "fitted": after, "noise": answer.noises}
    account = {**errors, "seed": answer.seed, **compare(answer, document)}
    (out / "before_after.json").write_text(json.dumps(account, indent=2) + "\n")
    return out / "diagnosis" / "report.html"


def main() -> int:
    """Run the demonstration and return the exit status."""
    return perform_on_a_rig("concealed_demo", __doc__.splitlines()[0], demonstrate)


if __name__ == "__main__":
    sys.exit(main())
