"""`eha simulate`: drive the virtual actuator with a command and record it, far faster than real time."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from time import perf_counter

import numpy as np

from eha_core.cli._command import Samples, is_signal, read_command
from eha_core.errors import EhaError, ParameterError, RecordingError
from eha_core.plant import PAPER, Composition, load_plant
from eha_core.recording import read_recording
from eha_core.recording.recording import FloatArray
from eha_core.recording.simulated import Experiment, Simulated, simulate, simulate_sweep, write_simulated
from eha_core.recording.simulated_table import write_csv
from eha_core.signals import signals

MCAP, CSV = ".mcap", ".csv"
COMMAND_LIMIT = 10.0
"""V; default of the simulator node's parameter command_limit."""

MOST_IN_A_SWEEP = 1000
"""Most recordings that one command writes (assumed: a folder that can still be listed)."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb to the command line."""
    parser = subparsers.add_parser(
        "simulate",
        help="drive the virtual actuator with a command and record it",
        description="Simulates the actuator far faster than real time and records it with the simulator node's topics.",
    )
    parser.add_argument(
        "--command",
        required=True,
        metavar="RECORDING|FILE.csv|SIGNAL",
        help=f"voltages of a recording or a CSV file, or a signal such as sine:amplitude=8.4e-3,frequency=1"
        f" (signals: {', '.join(signals())}); under another source than the servo valve, that source's channels",
    )
    parser.add_argument(
        "--out", required=True, type=Path, metavar="FILE", help=f"the recording to write, {MCAP} or {CSV}"
    )
    parser.add_argument("--duration", type=float, metavar="S", help="simulated time (default: the command's, or 10 s)")
    parser.add_argument("--nominal", type=Path, metavar="FILE", help="parameters file in ROS 2's YAML form")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE[@S]",
        help="a parameter's value, from the start or from an instant on; may be given again",
    )
    parser.add_argument(
        "--sweep",
        metavar="NAME=A:B:N",
        help="simulate N plants whose parameter NAME runs from A to B, evenly (by equal factors with A:B:Nlog); --out"
        " FILE.mcap then writes FILE-1.mcap and so on",
    )
    parser.add_argument(
        "--topics", type=Path, metavar="FILE", help="topics file that says where the voltage is recorded"
    )
    parser.add_argument("--step", type=float, default=1e-4, metavar="S", help="the plant's step (default: %(default)s)")
    parser.add_argument("--rate", type=float, default=500.0, metavar="HZ", help="recorded rate (default: %(default)s)")
    parser.add_argument(
        "--noise", type=float, default=0.0, metavar="FACTOR", help="sensor noise; 1 is 10 um, 1 mm/s and 0.01 MPa"
    )
    parser.add_argument("--seed", type=int, default=1, help="seed of the noise (default: %(default)s)")
    parser.add_argument("--initial-position", type=float, default=0.0, metavar="M", help="where the piston starts")
    parser.add_argument(
        "--instruments-only", action="store_true", help="record only the channels of a rig's instruments"
    )


def run(arguments: argparse.Namespace) -> int:
    """Simulate and record; return the exit status."""
    started = perf_counter()
    _check(arguments)
    start, changes = _settings(arguments.set)
    composition, parameters = PAPER, start
    if arguments.nominal:
        nominal = load_plant(arguments.nominal)
        composition, parameters = nominal.composition, {**nominal.values, **start}
    times, voltages, duration, inputs = _driving(arguments, composition)
    experiment = Experiment(
        times, voltages, duration, parameters, changes, arguments.step, arguments.rate, arguments.noise,
        arguments.seed, arguments.initial_position, composition, inputs,
    )  # fmt: skip
    if arguments.sweep:
        return _sweep(experiment, arguments)
    record = simulate(experiment)
    written = _write(arguments.out, record, arguments.instruments_only)
    took = perf_counter() - started
    print(f"{arguments.out}: {duration:g} s in {written}, simulated and written in {took:.2f} s")
    return 0


def _write(path: Path, record: Simulated, instruments_only: bool) -> str:
    """Write in the form of the path's ending; return the amount in words."""
    if path.suffix.lower() == CSV:
        return f"{write_csv(path, record, instruments_only)} rows"
    return f"{write_simulated(path, record, instruments_only)} messages"


def _sweep(experiment: Experiment, arguments: argparse.Namespace) -> int:
    """Simulate and record one plant for each value of a parameter; print a line for each."""
    started = perf_counter()
    name, values = _swept(arguments.sweep)
    width = len(str(len(values)))
    out: Path = arguments.out
    paths = [out.with_name(f"{out.stem}-{k:0{width}d}{out.suffix}") for k in range(1, len(values) + 1)]
    for path in paths:
        if path.exists():
            raise RecordingError(f"{path}: the file exists already; choose another name, or remove it")
    records = simulate_sweep(experiment, name, values)
    print(f"{name:>24}  final position  largest pressure  recording")
    for value, path, record in zip(values, paths, records, strict=True):
        _write(path, record, arguments.instruments_only)
        position = 1e3 * record.column("position")[-1]
        pressure = 1e-6 * max(record.column("pressure_a").max(), record.column("pressure_b").max())
        print(f"{value:24.6g}  {position:11.3f} mm  {pressure:12.3f} MPa  {path}")
    print(f"{len(values)} x {experiment.duration:g} s simulated and written in {perf_counter() - started:.2f} s")
    return 0


def _swept(words: str) -> tuple[str, list[float]]:
    """The parameter and its values."""
    name, _, rest = words.partition("=")
    try:
        first, last, count = rest.split(":")
        logarithmic = count.endswith("log")
        number = int(count.removesuffix("log"))
        if not 2 <= number <= MOST_IN_A_SWEEP:
            raise ValueError
        spread = np.geomspace if logarithmic else np.linspace
        return name, spread(float(first), float(last), number).tolist()
    except ValueError:
        raise ParameterError(
            f"--sweep {words!r} is not NAME=A:B:N or NAME=A:B:Nlog with N from 2 to {MOST_IN_A_SWEEP}; "
            "equal factors (log) need A and B of one sign"
        ) from None


def _warn_of_limit(voltages: FloatArray) -> None:
    """Warn where the simulator node would clamp the command that is simulated here unclamped."""
    largest = float(np.max(np.abs(voltages), initial=0.0))
    if largest > COMMAND_LIMIT:
        print(
            f"eha simulate: the command reaches {largest:g} V; the simulator node would clamp it at {COMMAND_LIMIT:g} V"
            " (command_limit)",
            file=sys.stderr,
        )


def _check(arguments: argparse.Namespace) -> None:
    if arguments.out.suffix.lower() not in (MCAP, CSV):
        raise EhaError(f"--out {arguments.out}: a recording is written as {MCAP} or {CSV}; give one of these endings")
    for name, lower, upper in (("duration", 1e-3, 3600.0), ("rate", 0.1, 1e4), ("noise", 0.0, 1e6), ("seed", 0, 2**63)):
        value = getattr(arguments, name)
        if value is not None and not lower <= value <= upper:
            raise ParameterError(f"--{name} {value:g} is out of range; give {lower:g} to {upper:g}")


def _settings(words: list[str]) -> tuple[dict[str, float], list[tuple[float, str, float]]]:
    """Parameters in force from the start, and later changes as (instant [s], name, value)."""
    start: dict[str, float] = {}
    changes: list[tuple[float, str, float]] = []
    for word in words:
        name, equals, rest = word.partition("=")
        value, at, instant = rest.partition("@")
        try:
            if not equals:
                raise ValueError
            if at and not 0.0 <= float(instant) < float("inf"):
                raise ValueError
            if at:
                changes.append((float(instant), name, float(value)))
            else:
                start[name] = float(value)
        except ValueError:
            raise ParameterError(f"--set {word!r} is not NAME=VALUE or NAME=VALUE@SECONDS") from None
    return start, changes


def _driving(
    arguments: argparse.Namespace, composition: Composition
) -> tuple[FloatArray, FloatArray, float, dict[str, Samples]]:
    """Instants [s] and voltages [V] of the command, the duration [s], and the channels that drive another source."""
    if composition.source.valve == "coil":
        times, voltages, duration = read_command(arguments, "voltage_command")
        _warn_of_limit(voltages)
        return times, voltages, duration, {}
    if arguments.out.suffix.lower() != CSV:
        raise EhaError(f"--out {arguments.out}: a plant on {composition.source.id} is recorded as {CSV} alone")
    wanted = composition.source.inputs
    if is_signal(arguments.command) and len(wanted) > 1:
        raise EhaError(
            f"--command {arguments.command}: {composition.source.id} takes {' and '.join(wanted)}, a signal is one"
            " of them; give a file with these columns"
        )
    times, values, duration = read_command(arguments, wanted[0])
    inputs = {wanted[0]: (times, values)}
    for name in wanted[1:]:
        inputs[name] = read_command(arguments, name)[:2]
    if not is_signal(arguments.command):
        channels = read_recording(arguments.command, arguments.topics).channels
        inputs |= {name: (channels[name].time, channels[name].values) for name in composition.source.optional
                   if name in channels}  # fmt: skip
    none = np.empty(0)
    return none, none, duration, inputs
