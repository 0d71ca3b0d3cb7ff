"""What a Python session or a notebook calls: simulate, read, diagnose, and look the catalogue up."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from inspect import getdoc
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from eha_core.effects import effects
from eha_core.errors import ParameterError
from eha_core.nominal import NominalModel, load_nominal, nominal_of
from eha_core.parameters import effect_names
from eha_core.plant import Composition, composition_of
from eha_core.recording import Recording, read_recording

if TYPE_CHECKING:
    from eha_core.report.results import Results

Nominal = Mapping[str, object] | NominalModel | str | Path | None


def read(path: str | Path, topics: str | Path | None = None) -> Recording:
    """Read a recording from an .mcap or .db3 file, a rosbag2 folder, or a table: .csv, .lvm, .mat, .parquet.

    Args:
        path: the recording.
        topics: a topics file, where channels have other names or units than the usual ones.

    Raises:
        RecordingError: nothing usable is there; the message says what to do.
    """
    return read_recording(path, topics)


def simulate(
    command: str | ArrayLike,
    duration: float | None = None,
    parameters: Mapping[str, float] | None = None,
    *,
    noise: float = 0.0,
    seed: int = 1,
    rate: float = 500.0,
    step_size: float = 1e-4,
    initial_position: float = 0.0,
    states: bool = False,
) -> Recording:
    """Drive the simulated actuator with a command and return what its sensors record.

    Args:
        command: a signal such as "sine:amplitude=8.4e-3,frequency=1", or one voltage [V] for each sample.
        duration: simulated time [s]; by default that of the voltages, or 10 s of a signal.
        parameters: values that differ from the nominal plant, effects as "coulomb_friction.force"; SI units.
        noise: sensor noise; 1 is 10 um, 1 mm/s and 0.01 MPa.
        seed: seed of the noise.
        rate: sampling rate [Hz]; a period must be a whole number of steps.
        step_size: the plant's step [s].
        initial_position: where the piston starts [m].
        states: whether what no usual instrument shows is recorded too: current, spool, flows and supply pressure.

    Raises:
        ParameterError: a parameter, the signal or the rate does not fit.
    """
    from eha_core.recording.simulated import Experiment
    from eha_core.recording.simulated import simulate as run
    from eha_core.recording.simulated_table import as_recording
    from eha_core.signals import from_text

    if isinstance(command, str):
        duration = duration or 10.0
        times = np.arange(round(duration * rate)) / rate
        voltages = np.asarray(from_text(command).value(times), dtype=np.float64)
    else:
        voltages = np.asarray(command, dtype=np.float64)
        if voltages.ndim != 1 or not len(voltages):
            raise ParameterError(f"command has the shape {voltages.shape}; give one voltage for each sample")
        times = np.arange(len(voltages)) / rate
        duration = duration or len(voltages) / rate
    experiment = Experiment(
        times, voltages, duration, parameters or {}, (), step_size, rate, noise, seed, initial_position
    )
    return as_recording(run(experiment), states)


def diagnose(
    recording: Recording | str | Path | Sequence[Recording | str | Path],
    nominal: Nominal = None,
    *,
    jobs: int = 2,
    progress: Callable[[str], None] = lambda _: None,
    tests: Sequence[Recording | str | Path] = (),
    as_recorded: bool = False,
) -> Results:
    """Say where a model departs from a recording, which physics it leaves out, and how much better it does with it.

    Args:
        recording: a recording or its path; several are one rig, fitted with one set of parameters and effects. Of
            one longer than two minutes stretches are fitted, and the whole judges the result.
        nominal: the model: parameter values that differ from the catalogue's ("unknown" where nobody knows one; parts
            as {"plant": {"source": "switched_pump"}}), a parameters file, an FMU, or a `NominalModel`. By default the
            parts and values that the recording carries, effects left out, or else the catalogue's nominal actuator.
            Where position and force are all that was recorded and there is no model, the motion is taken as given and
            the law of the force is found.
        jobs: threads that simulate side by side.
        progress: receives each stage as it begins.
        tests: recordings that nothing is fitted to, only predicted.
        as_recorded: go on where a recording cannot be right (a sign, a scale or a unit is wrong); a remark warns of it.

    Raises:
        RecordingError: the recording cannot be right or cannot be diagnosed; the message says why.
        ParameterError: the model does not fit.
    """
    from eha_core.diagnosis import diagnose_together
    from eha_core.long_record.admission import admitted
    from eha_core.long_record.judging import judged
    from eha_core.plausibility import admit
    from eha_core.report.provenance import with_provenance
    from eha_core.report.results import Results

    given = [recording] if isinstance(recording, (Recording, str, Path)) else list(recording)
    composition = given_parts(nominal)
    records, unseen = (
        [admitted(entry, None, composition, progress) for entry in several] for several in (given, tests)
    )
    recordings, tested = ([piece for record in several for piece in record.recordings] for several in (records, unseen))
    if takes_motion_as_given(recordings, nominal):
        return _diagnose_motion(recordings, progress, tested)
    model = known_model(nominal, recordings[0])
    recordings, tested = (
        [admit(piece, model.values, as_recorded, model.composition, "as_recorded=True") for piece in pieces]
        for pieces in (recordings, tested)
    )
    found = judged(diagnose_together(recordings, model, progress, jobs, tested), records, model, progress)
    origin = "values given by name" if isinstance(nominal, (Mapping, NominalModel)) else nominal
    return Results(with_provenance(found, records, origin, "eha_core.diagnose"))


def takes_motion_as_given(recordings: Sequence[Recording], nominal: object) -> bool:
    """Whether nothing drives a plant: motion and force alone were recorded, and there is no model of an actuator."""
    from eha_core.motion_given.motion import is_motion_given

    modelled = nominal is not None or any(recording.parameters for recording in recordings)
    return not modelled and all(map(is_motion_given, recordings))


def _diagnose_motion(
    recordings: Sequence[Recording], progress: Callable[[str], None], tests: Sequence[Recording]
) -> Results:
    """The law of the force that goes with the motion, as `eha diagnose` finds it for such recordings."""
    from eha_core.motion_given import diagnose_motion
    from eha_core.report.provenance import with_provenance
    from eha_core.report.results import MotionResults

    values = known_model(None, recordings[0]).values
    found = diagnose_motion(recordings, progress, tests, (values["piston_area"], values["piston_area_b"]))
    origin = "none: the motion is given"
    return MotionResults(replace(found, diagnosis=with_provenance(found.diagnosis, recordings, origin,
                                                                  "eha_core.diagnose")))  # fmt: skip


def nominal_model(nominal: Nominal, recording: Recording) -> Mapping[str, float]:
    """Every parameter of the model that a recording is held against; see `known_model` and `diagnose`."""
    return known_model(nominal, recording).values


def known_model(nominal: Nominal, recording: Recording) -> NominalModel:
    """The model that a recording is held against, and which of its parameters are unknown or differ by recording."""
    model = given_model(nominal, recording.parts)
    if model is not None:
        return model
    composition = composition_of(recording.parts)
    kept = {name: value for name, value in recording.parameters.items() if name not in effect_names()}
    known = {name: value for name, value in kept.items() if name in composition.rows}
    return nominal_of(known, composition=composition)


def given_parts(nominal: Nominal) -> Composition | None:
    """The actuator's parts as a model names them; None where it leaves them to the recording."""
    if nominal is None or (isinstance(nominal, Mapping) and "plant" not in nominal):
        return None
    model = given_model(nominal)
    return model.composition if model is not None else None


def _read_model(path: Path) -> NominalModel:
    """The model of a parameters file or of an FMU."""
    if path.suffix.lower() != ".fmu":
        return load_nominal(path)
    from eha_core.export.read_fmu import read_fmu  # what compiles the plant takes a while to import

    return read_fmu(path)


def given_model(nominal: Nominal, parts: Mapping[str, str] | None = None) -> NominalModel | None:
    """The model that was given, of these parts where it names none; None where it is left to the recording."""
    if isinstance(nominal, (str, Path)):
        nominal = _read_model(Path(nominal))
    if isinstance(nominal, NominalModel):
        return nominal
    if nominal is None:
        return None
    given = dict(nominal)
    chosen = given.pop("plant", parts or {})
    if not isinstance(chosen, Mapping):
        raise ParameterError(f"plant = {chosen!r} names no parts; write for example {{'source': 'switched_pump'}}")
    return nominal_of(given, composition=composition_of(chosen))


@dataclass(frozen=True)
class Entry:
    """One effect or signal: its name, where it belongs, what its documentation says and its equation.

    `parameters` has the name, unit and meaning of each.
    """

    name: str
    site: str
    summary: str
    documentation: str
    equation: str
    parameters: tuple[tuple[str, str, str], ...]

    def __str__(self) -> str:
        rows = [f"  {name} [{unit or '-'}]: {meaning}" for name, unit, meaning in self.parameters]
        return "\n".join([f"{self.name} ({self.site})", "", self.documentation, "", self.equation, *rows])


class Catalogue(Mapping[str, Entry]):
    """Entries by name; prints as a list, and shows as a table in a notebook."""

    def __init__(self, entries: Sequence[Entry]) -> None:
        self._entries = {entry.name: entry for entry in entries}

    def __getitem__(self, name: str) -> Entry:
        return self._entries[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __repr__(self) -> str:
        width = max(map(len, self._entries))
        return "\n".join(f"{entry.name:{width}}  {entry.site:9}{entry.summary}" for entry in self._entries.values())

    def _repr_html_(self) -> str:
        from html import escape

        rows = "".join(
            f"<tr><td><code>{entry.name}</code></td><td>{entry.site}</td>"
            f'<td style="text-align:left">{escape(entry.summary)}</td>'
            f'<td style="text-align:left"><code>{escape(entry.equation)}</code></td></tr>'
            for entry in self._entries.values()
        )
        return f"<table><tr><th>name</th><th>site</th><th>what it is</th><th>equation</th></tr>{rows}</table>"


def catalogue() -> Catalogue:
    """The physical effects that the simulator can add and a diagnosis can name, by id."""
    entries = []
    for effect in effects():
        text = getdoc(import_module(f"eha_core.effects.{effect.id}")) or ""
        if effect.named:
            summary = " ".join(text.partition("\n\n")[0].split())
            rows = tuple((row.name, row.unit, row.meaning) for row in effect.parameters)
            entries.append(Entry(effect.id, effect.site, summary, text, effect.equation, rows))
    return Catalogue(entries)


def signal_shapes() -> Catalogue:
    """The signals that `simulate` takes as a command, by name."""
    from eha_core.signals import signals

    entries = []
    for name, signal in signals().items():
        units = {"same": "V or m"}
        rows = tuple((row.name, units.get(row.unit, row.unit), row.meaning) for row in signal.parameters())
        text = getdoc(signal) or ""
        entries.append(Entry(name, "signal", " ".join(text.partition("\n\n")[0].split()), text, "", rows))
    return Catalogue(entries)
