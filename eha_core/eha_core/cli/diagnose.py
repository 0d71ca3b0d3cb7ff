"""`eha diagnose`: say where a model departs from a recording, which physics it leaves out, and show the fit improve."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from eha_core.api import known_model, takes_motion_as_given
from eha_core.errors import EhaError
from eha_core.recording import Recording, read_recording
from eha_core.workers import Workers

UNUSABLE = 2
DAMAGED = 3
"""Exit status where the recording was damaged and the diagnosis rests on the part that could be read."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "diagnose",
        help="say which physics a model leaves out of a recording",
        description=__doc__,
        epilog="Several recordings are one rig, fitted with one set of parameters and effects; what a nominal file"
        " lists as per_recording has a value in each. Without --nominal the model is the one whose"
        " parameters the recording carries, effects left out, or else the catalogue's nominal actuator. Where"
        " position and force are all that was recorded and no model is given, the force's law is found from"
        " the motion.",
    )
    add = parser.add_argument
    add("recordings", nargs="+", type=Path, metavar="RECORDING", help="a bag or a table: .mcap, .csv, .mat ...")
    add("--nominal", type=Path, metavar="FILE", help="the model: a parameters file in ROS 2's YAML form")
    add("--topics", type=Path, metavar="FILE", help="which topics, fields and units are which channels")
    add("--test", action="append", default=[], type=Path, metavar="FILE", help="a recording that is only predicted")
    add("--motion-given", action="store_true", help="find the force's law from the motion, whatever else was recorded")
    add("--as-recorded", action="store_true", help="go on where a recording cannot be right, and warn of it")
    add("--out", type=Path, metavar="DIR", help="folder for the report (default out/diagnosis/<recording>)")
    add("--json", metavar="FILE|-", help="write diagnosis.json there (- is standard output) and no report")
    add("--jobs", type=int, default=2, metavar="N", help="threads, with --each processes, side by side (default 2)")
    add("--each", action="store_true", help="diagnose every recording on its own, and print a line for each")
    add("--dask", metavar="ADDRESS", help="with --each: a Dask scheduler whose workers see the same folders")
    add("--seed", type=int, default=0, metavar="N", help="kept with the result; no stage draws at random")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    if arguments.jobs < 1:
        raise EhaError(f"--jobs {arguments.jobs} is no number of threads; give 1 or more")
    if arguments.each:
        return _run_each(arguments)
    if arguments.dask is not None:
        raise EhaError("--dask spreads recordings that are diagnosed on their own; give --each too")
    from eha_core.plausibility import admit

    recordings = [read_recording(path, arguments.topics) for path in arguments.recordings]
    if arguments.motion_given or takes_motion_as_given(recordings, arguments.nominal):
        return _run_motion_given(arguments, recordings)
    model = known_model(arguments.nominal, recordings[0])
    recordings, tests = (
        [admit(one, model.values, arguments.as_recorded, model.composition) for one in several]
        for several in (recordings, [read_recording(path, arguments.topics) for path in arguments.test])
    )
    for warning in (
        remark for recording in (*recordings, *tests) for remark in recording.remarks if remark.startswith("warning")
    ):
        print(f"eha diagnose: {warning}", file=sys.stderr)
    # compilers and plotting load slowly; bad input should be told at once
    from eha_core.diagnosis import diagnose_together
    from eha_core.diagnosis.document import as_json
    from eha_core.report.account import account
    from eha_core.report.files import write_report
    from eha_core.report.provenance import with_provenance

    diagnosis = diagnose_together(recordings, model, progress=_progress(), jobs=arguments.jobs, tests=tests)
    diagnosis = with_provenance(diagnosis, recordings, arguments.nominal)
    written: tuple[Path, ...] = ()
    if arguments.json is None or arguments.out is not None:
        folder = arguments.out or Path("out") / "diagnosis" / arguments.recordings[0].stem
        written = write_report(diagnosis, folder)
    if arguments.json == "-":
        print(as_json(diagnosis))
    else:
        if arguments.json is not None:
            written = (*written, _write(Path(arguments.json), as_json(diagnosis)))
        print(account(diagnosis, written))
    return DAMAGED if any(recording.damaged for recording in (*recordings, *tests)) else 0


def _run_motion_given(arguments: argparse.Namespace, recordings: Sequence[Recording]) -> int:
    """A test bench or a damper: nothing drives the plant, so the law of its force is found from the motion."""
    from eha_core.diagnosis.document import as_json
    from eha_core.motion_given import diagnose_motion
    from eha_core.report.account import account
    from eha_core.report.motion_given import write_motion_given
    from eha_core.report.provenance import with_provenance

    tests = [read_recording(path, arguments.topics) for path in arguments.test]
    values = known_model(arguments.nominal, recordings[0]).values
    areas = (values["piston_area"], values["piston_area_b"])
    found = diagnose_motion(recordings, _progress(), tests, areas)
    found = replace(found, diagnosis=with_provenance(found.diagnosis, recordings, "none: the motion is given"))
    written: tuple[Path, ...] = ()
    if arguments.json is None or arguments.out is not None:
        written = write_motion_given(found, arguments.out or Path("out") / "diagnosis" / arguments.recordings[0].stem)
    if arguments.json == "-":
        print(as_json(found.diagnosis))
    else:
        if arguments.json is not None:
            written = (*written, _write(Path(arguments.json), as_json(found.diagnosis)))
        print(account(found.diagnosis, written))
    return DAMAGED if any(recording.damaged for recording in recordings) else 0


def _run_each(arguments: argparse.Namespace) -> int:
    """Every recording on its own: what one cannot be used for stops none of the others."""
    if arguments.test:
        raise EhaError("--test is predicted by one model; with --each there is one for every recording")
    if arguments.json is not None:
        raise EhaError("--json takes one diagnosis; with --each, every recording's is in its own folder below --out")
    folders = [(arguments.out or Path("out") / "diagnosis") / path.stem for path in arguments.recordings]
    doubled = next((folder for folder in folders if folders.count(folder) > 1), None)
    if doubled is not None:
        raise EhaError(f"two recordings would both write to {doubled}; rename one, or diagnose them apart")
    calls = [
        (path.absolute(), arguments.nominal, arguments.topics, folder.absolute(), arguments.as_recorded)
        for path, folder in zip(arguments.recordings, folders, strict=True)
    ]
    statuses = set()
    for path, status, line in Workers(arguments.jobs, arguments.dask).run(diagnose_alone, calls):
        print(f"{path.name}: {line}", file=sys.stderr if status == UNUSABLE else sys.stdout, flush=True)
        statuses.add(status)
    return next((status for status in (UNUSABLE, DAMAGED) if status in statuses), 0)


def diagnose_alone(
    path: Path, nominal: Path | None, topics: Path | None, folder: Path, as_recorded: bool = False
) -> tuple[Path, int, str]:
    """Diagnose one recording into `folder`: its path, its exit status, and the verdict or what is wrong, in a line."""
    from eha_core.diagnosis import diagnose_together
    from eha_core.plausibility import admit
    from eha_core.report.files import write_report
    from eha_core.report.provenance import with_provenance

    try:
        recording = read_recording(path, topics)
        model = known_model(nominal, recording)
        recording = admit(recording, model.values, as_recorded, model.composition)
        diagnosis = with_provenance(diagnose_together([recording], model, jobs=1), [recording], nominal)
        write_report(diagnosis, folder)
    except EhaError as error:
        return path, UNUSABLE, str(error)
    return path, DAMAGED if recording.damaged else 0, diagnosis.summary


def _write(path: Path, text: str) -> Path:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise EhaError(f"{path}: cannot be written ({error.strerror}); choose another --json") from error
    return path


def _progress() -> Callable[[str], None]:
    """Tell each stage on standard error: over one line on a terminal, not at all elsewhere."""
    if not sys.stderr.isatty():
        return lambda _: None

    def show(message: str) -> None:
        print(f"\r\x1b[K  {message} ...", end="", file=sys.stderr, flush=True)

    return show
