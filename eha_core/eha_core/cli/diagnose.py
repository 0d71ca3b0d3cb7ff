"""`eha diagnose`: find where a model departs from a recording and which physics it is missing, and refit it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from eha_core.cli._paths import require_file, require_folder, require_recordings, write_json
from eha_core.cli._progress import Progress
from eha_core.errors import EhaError

# modules that read, simulate or plot are imported where they are used: help and errors do not need them
if TYPE_CHECKING:
    from eha_core.diagnosis import Diagnosis
    from eha_core.nominal import NominalModel
    from eha_core.recording import Recording, TopicsFile

UNUSABLE = 2
DAMAGED = 3
"""Exit status where the recording was damaged and the diagnosis rests on the part that could be read."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "diagnose",
        help="find from a recording which physics a model is missing",
        description=__doc__,
        epilog="Several recordings are taken as one rig, fitted with one set of parameters and effects; parameters that"
        " a nominal file lists as per_recording have a value in each. Without --nominal, the model has the parameters"
        " stored in the recording, without effects, or else those of the catalogue's nominal actuator. If only position"
        " and force were recorded and no model is given, the force's law is found from the motion.",
    )
    add = parser.add_argument
    add("recordings", nargs="+", type=Path, metavar="RECORDING", help="a bag or a table: .mcap, .csv, .mat ...")
    add("--nominal", type=Path, metavar="FILE", help="the model: a parameters file in ROS 2's YAML form, or an FMU")
    add("--topics", type=Path, metavar="FILE", help="which topics, fields and units are which channels")
    add(
        "--assume",
        action="store_true",
        help="take the likely answers to the topics file's open questions, and list them",
    )
    add("--test", action="append", default=[], type=Path, metavar="FILE", help="a recording that is only predicted")
    add("--motion-given", action="store_true", help="find the force's law from the motion, whatever else was recorded")
    add("--as-recorded", action="store_true", help="diagnose a recording that cannot be right, with a warning")
    add("--out", type=Path, metavar="DIR", help="folder for the report (default out/diagnosis/<recording>)")
    add("--json", metavar="FILE|-", help="write diagnosis.json there (- is standard output) and no report")
    add("--no-report", action="store_true", help="write diagnosis.json alone in place of the whole report")
    add("--log", type=Path, metavar="FILE", help="write each step and its residual, with times, to a file")
    add("--jobs", type=int, default=2, metavar="N", help="parallel threads, with --each processes (default 2)")
    add("--each", action="store_true", help="diagnose every recording on its own, and print a line for each")
    add("--dask", metavar="ADDRESS", help="with --each: a Dask scheduler whose workers see the same folders")
    add("--seed", type=int, default=0, metavar="N", help="without effect: no stage uses random numbers")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    if arguments.jobs < 1:
        raise EhaError(f"--jobs {arguments.jobs} is not a number of threads; give 1 or more")
    _check_paths(arguments)
    if arguments.each:
        return _run_each(arguments)
    if arguments.dask is not None:
        raise EhaError("--dask spreads recordings that are diagnosed on their own; give --each too")
    progress = Progress(log=arguments.log)
    try:
        return _run_together(arguments, progress)
    finally:
        progress.end()


def _run_together(arguments: argparse.Namespace, progress: Progress) -> int:
    """Diagnose all recordings as one rig."""
    from eha_core.api import given_model, known_model, takes_motion_as_given
    from eha_core.long_record.admission import admitted
    from eha_core.plausibility import admit

    if arguments.motion_given:
        return _run_motion_given(arguments, _read(arguments.recordings, arguments), progress)
    given = given_model(arguments.nominal)
    composition = given.composition if given else None
    records, unseen = (
        [admitted(path, arguments.topics, composition, progress) for path in paths]
        for paths in (arguments.recordings, arguments.test)
    )
    recordings, tests = (
        [recording for record in several for recording in record.recordings] for several in (records, unseen)
    )
    if takes_motion_as_given(recordings, given):
        is_long = any(record.blocks for record in records)
        whole = _read(arguments.recordings, arguments) if is_long else recordings
        return _run_motion_given(arguments, whole, progress)
    model = known_model(given, recordings[0])
    recordings, tests = (
        [admit(recording, model.values, arguments.as_recorded, model.composition) for recording in several]
        for several in (recordings, tests)
    )
    for recording in () if arguments.as_recorded else (*recordings, *tests):
        require_travel(recording, model, given is not None)
    if cylinder := assumed_cylinder(given is not None, recordings[0], model):
        line = f"no --nominal: the catalogue's cylinder is assumed, {cylinder}; `eha init-rig` makes the file of a rig"
        print(f"eha diagnose: {line}", file=sys.stderr)
        recordings[0] = with_assumed(recordings[0], cylinder)
    for warning in (
        remark for recording in (*recordings, *tests) for remark in recording.remarks if remark.startswith("warning")
    ):
        print(f"eha diagnose: {warning}", file=sys.stderr)
    # compilers and plotting load slowly; bad input should be reported at once
    from eha_core.diagnosis import diagnose_together
    from eha_core.long_record.judging import judged
    from eha_core.report.provenance import with_provenance

    progress.long = any(record.blocks for record in records)
    diagnosis = diagnose_together(recordings, model, progress, arguments.jobs, tests)
    diagnosis = judged(diagnosis, records, model, progress)
    diagnosis = with_provenance(diagnosis, records, arguments.nominal)
    _present(arguments, diagnosis, progress)
    return DAMAGED if any(record.damaged for record in (*records, *unseen)) else 0


def _present(arguments: argparse.Namespace, diagnosis: Diagnosis, progress: Progress) -> None:
    """Write the requested files, and print the findings."""
    from eha_core.report.account import account
    from eha_core.report.document import as_json

    written: tuple[Path, ...] = ()
    if arguments.json is None or arguments.out is not None:
        # plotting loads slowly, and --json alone draws nothing
        from eha_core.report.files import write_document, write_report

        progress("writing the report")
        folder = arguments.out or Path("out") / "diagnosis" / arguments.recordings[0].stem
        written = write_document(diagnosis, folder) if arguments.no_report else write_report(diagnosis, folder)
    progress.end()
    if arguments.json == "-":
        print(as_json(diagnosis))
    else:
        if arguments.json is not None:
            written = (*written, write_json(Path(arguments.json), as_json(diagnosis)))
        print(account(diagnosis, written))


def assumed_cylinder(is_given: bool, recording: Recording, model: NominalModel) -> str:
    """The cylinder that is assumed without a nominal file; empty where one is given or the recording has parameters."""
    if is_given or recording.parameters or recording.parts:
        return ""
    values = model.values
    return f"of {values['piston_area'] * 1e4:.3g} cm^2 and {2e3 * values['actuator_displacement']:.3g} mm stroke"


def with_assumed(recording: Recording, cylinder: str) -> Recording:
    """The recording with a remark on the assumed cylinder, which the report lists."""
    remark = f"assumed: the catalogue's cylinder, {cylinder}, because no nominal file was given"
    return replace(recording, remarks=(*recording.remarks, remark))


def require_travel(recording: Recording, model: NominalModel, is_given: bool) -> None:
    """Raise RecordingError for a travel that the cylinder cannot have."""
    from eha_core.rig import require_possible_travel

    position = recording.channels.get("position")
    if position is None or "piston_area" not in model.composition.rows:
        return
    travel = float(position.values.max() - position.values.min())
    area = max(model.values["piston_area"], model.values["piston_area_b"])
    has_own = is_given or bool(recording.parameters)
    require_possible_travel(str(recording.path), travel, area, has_own)


def _check_paths(arguments: argparse.Namespace) -> None:
    """Raise EhaError for a path that could not be read or written, before any work is done."""
    if not arguments.each:  # with --each, a missing recording does not stop the others
        require_recordings((*arguments.recordings, *arguments.test))
    if arguments.json is None or arguments.out is not None:
        require_folder(arguments.out or Path("out"), "--out")
    if arguments.json not in (None, "-"):
        require_file(Path(arguments.json), "--json")
    if arguments.topics is not None:
        from eha_core.recording import load_topics_file

        # Read once, before anything slow: its open questions end the command at once.
        arguments.topics = load_topics_file(arguments.topics, assume=arguments.assume)


def _read(paths: Sequence[Path], arguments: argparse.Namespace) -> list[Recording]:
    from eha_core.recording import read_recording

    return [read_recording(path, arguments.topics) for path in paths]


def _run_motion_given(arguments: argparse.Namespace, recordings: Sequence[Recording], progress: Progress) -> int:
    """Find the law of the force from the motion, as of a test bench or a damper that no command drives."""
    from eha_core.api import known_model
    from eha_core.motion_given import diagnose_motion
    from eha_core.report.document import as_json
    from eha_core.report.motion_account import motion_account
    from eha_core.report.provenance import with_provenance

    tests = _read(arguments.test, arguments)
    values = known_model(arguments.nominal, recordings[0]).values
    areas = (values["piston_area"], values["piston_area_b"])
    found = diagnose_motion(recordings, progress, tests, areas)
    found = replace(found, diagnosis=with_provenance(found.diagnosis, recordings, "none: the motion is given"))
    written: tuple[Path, ...] = ()
    if arguments.json is None or arguments.out is not None:
        from eha_core.report.motion_given import write_motion_given  # draws, as above

        written = write_motion_given(found, arguments.out or Path("out") / "diagnosis" / arguments.recordings[0].stem)
    progress.end()
    if arguments.json == "-":
        print(as_json(found.diagnosis))
    else:
        if arguments.json is not None:
            written = (*written, write_json(Path(arguments.json), as_json(found.diagnosis)))
        print(motion_account(found, written))
    return DAMAGED if any(recording.damaged for recording in recordings) else 0


def _run_each(arguments: argparse.Namespace) -> int:
    """Diagnose every recording on its own; one that cannot be used does not stop the others."""
    from eha_core.workers import Workers

    if arguments.test:
        raise EhaError("--test needs one model, and --each makes one for every recording; leave one of them out")
    if arguments.json is not None:
        raise EhaError("--json takes one diagnosis; with --each, every recording's is in its own folder below --out")
    folders = [(arguments.out or Path("out") / "diagnosis") / path.stem for path in arguments.recordings]
    doubled = next((folder for folder in folders if folders.count(folder) > 1), None)
    if doubled is not None:
        raise EhaError(f"two recordings would both write to {doubled}; rename one, or diagnose them separately")
    options = (arguments.nominal, arguments.topics)
    calls = [
        (path.absolute(), *options, folder.absolute(), arguments.as_recorded, not arguments.no_report)
        for path, folder in zip(arguments.recordings, folders, strict=True)
    ]
    statuses = set()
    for path, status, line in Workers(arguments.jobs, arguments.dask).run(diagnose_alone, calls):
        print(f"{path.name}: {line}", file=sys.stderr if status == UNUSABLE else sys.stdout, flush=True)
        statuses.add(status)
    return next((status for status in (UNUSABLE, DAMAGED) if status in statuses), 0)


def diagnose_alone(
    path: Path,
    nominal: Path | None,
    topics: TopicsFile | None,
    folder: Path,
    as_recorded: bool = False,
    with_report: bool = True,
) -> tuple[Path, int, str]:
    """Diagnose one recording into `folder`; returns its path, the exit status, and the verdict or error in a line."""
    from eha_core.api import given_model, known_model
    from eha_core.diagnosis import diagnose_together
    from eha_core.long_record.admission import admitted
    from eha_core.long_record.judging import judged
    from eha_core.plausibility import admit
    from eha_core.report.files import write_document, write_report
    from eha_core.report.provenance import with_provenance

    try:
        given = given_model(nominal)
        record = admitted(path, topics, given.composition if given else None)
        model = known_model(given, record.recordings[0])
        recordings = [admit(recording, model.values, as_recorded, model.composition) for recording in record.recordings]
        for recording in () if as_recorded else recordings:
            require_travel(recording, model, given is not None)
        if cylinder := assumed_cylinder(given is not None, recordings[0], model):
            recordings[0] = with_assumed(recordings[0], cylinder)
        diagnosis = judged(diagnose_together(recordings, model, jobs=1), [record], model)
        diagnosis = with_provenance(diagnosis, [record], nominal)
        (write_report if with_report else write_document)(diagnosis, folder)
    except EhaError as error:
        return path, UNUSABLE, str(error)
    summary = " ".join([diagnosis.summary, *(long_record.statement for long_record in diagnosis.long_records)])
    return path, DAMAGED if record.damaged else 0, summary
