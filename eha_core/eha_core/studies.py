"""Studies that go with a diagnosis: what a test can show before it is made, and what an error consists of after it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eha_core.api import Nominal, diagnose, given_model
from eha_core.errors import ParameterError
from eha_core.nominal import nominal_of
from eha_core.plant.fitted import read_diagnosis
from eha_core.recording import Recording, read_recording

if TYPE_CHECKING:
    from eha_core.detectability import Certificate, DesignedTest, PlannedTest
    from eha_core.error_budget import Budget, Rig, Task
    from eha_core.report.results import Results
    from eha_core.signals import Signal
    from eha_core.step_tests import StepTests
    from eha_core.valve_curves import ValveCurves

Array = NDArray[np.float64]
Command = str | ArrayLike | tuple[ArrayLike, ArrayLike]


def detect(
    command: Command,
    nominal: Nominal = None,
    *,
    duration: float | None = None,
    channels: Sequence[str] = ("position", "pressure_a", "pressure_b"),
    noise: float = 1.0,
    rate: float = 500.0,
) -> Certificate:
    """Say how small an effect a planned test shows, and what it cannot distinguish.

    Args:
        command: a signal such as "multisine:amplitude=0.12", one voltage [V] for each sample, or instants [s] and the
            voltages that hold from them on.
        nominal: the model of the rig, as `diagnose` takes it.
        duration: length of the test [s]; by default that of the voltages, or 10 s of a signal.
        channels: what is recorded beside the command: position, and pressure_a and pressure_b.
        noise: factor on the sensors' noise; 1 is 10 um and 0.01 MPa.
        rate: samples a second [Hz].

    Returns:
        For each effect the smallest size that a diagnosis names with 95 % probability, where the rig is as modelled
        but for it; `eha_core.report.detectability` presents it.

    Raises:
        ParameterError: the command, the channels, the rate or the model do not fit.
    """
    from eha_core.detectability import certify

    return certify(given_model(nominal) or nominal_of({}), _planned(command, duration, channels, noise, rate))


def design_test(
    names: Sequence[str],
    command: Command,
    nominal: Nominal = None,
    *,
    limits: str | Path | None = None,
    duration: float | None = None,
    channels: Sequence[str] = ("position", "pressure_a", "pressure_b"),
    noise: float = 1.0,
    rate: float = 500.0,
) -> DesignedTest:
    """Design the test that shows the smallest sizes of some effects on a rig, and stays within its limits.

    Args:
        names: effects of the catalogue, or nominal parameters such as internal_leakage.
        command: what the designed test is compared with, as `detect` takes it; both last as long.
        nominal: the model of the rig, as `diagnose` takes it.
        limits: a YAML file of position, speed, pressure, energy and voltage [SI]; by default what the model bears.
        duration, channels, noise, rate: as `detect` takes them.

    Returns:
        The signal, what it shows beside the command, and how close rigs within the priors come to each limit;
        `eha_core.report.designed_test` presents it.

    Raises:
        EhaError: the rig bears none of the signals within these limits.
        ParameterError: names, limits, command or model do not fit.
    """
    from eha_core.detectability import design, read_limits

    if not names:
        raise ParameterError("no effect is named; give some of those that `eha effects` lists")
    model = given_model(nominal) or nominal_of({})
    return design(model, names, read_limits(limits, model), _planned(command, duration, channels, noise, rate))


def _planned(
    command: Command, duration: float | None, channels: Sequence[str], noise: float, rate: float
) -> PlannedTest:
    from eha_core.detectability import PlannedTest

    times, voltages, length = _given(command, duration, rate)
    return PlannedTest(times, voltages, duration or length, tuple(channels), noise, rate)


def _given(command: Command, duration: float | None, rate: float) -> tuple[Array, Array, float]:
    """Instants [s] and voltages [V] of a command, and its length [s]."""
    from eha_core.signals import from_text

    if not rate > 0.0:
        raise ParameterError(f"rate = {rate:g} Hz is out of range; give samples a second")
    if isinstance(command, str):
        length = duration or 10.0
        times = np.arange(round(length * rate)) / rate
        return times, np.asarray(from_text(command).value(times), dtype=np.float64), length
    if isinstance(command, tuple):
        times, voltages = (np.asarray(each, dtype=np.float64) for each in command)
    else:
        voltages = np.asarray(command, dtype=np.float64)
        times = np.arange(voltages.size) / rate
    if voltages.ndim != 1 or not voltages.size or voltages.shape != times.shape:
        raise ParameterError(f"command has the shape {voltages.shape}; give one voltage for each instant")
    if not np.all(np.isfinite(voltages)):
        raise ParameterError("command has voltages that are no numbers; give finite ones")
    return times, voltages, float(times[-1]) + 1.0 / rate


def budget(
    found: Results | Recording | Mapping[str, float] | str | Path,
    reference: str | Signal,
    controller: str = "pid",
    *,
    nominal: Nominal = None,
    duration: float | None = None,
    skip: float | None = None,
    rate: float = 500.0,
    command_limit: float = 10.0,
) -> Budget:
    """Share the RMSE of a tracking error out among the effects that a rig has, and say what each repair would gain.

    Args:
        found: what `diagnose` returned, the path of a diagnosis.json, a recording or its path, which is diagnosed
            first, or values that depart from the model, as {"coulomb_friction.force": 250.0}.
        reference: the position to follow [m], as "sine:amplitude=0.01,frequency=1"; in open loop the voltage [V].
        controller: one of `eha_core.control.CONTROLLERS`, made for the rig as modelled; empty for open loop, where the
            error is the difference from the rig as modelled.
        nominal: the model, of a recording or of values that depart, as `diagnose` takes it.
        duration: length of the motion [s]; 4, in open loop 10.
        skip: seconds at the start that are not counted; 1, in open loop 0.
        rate: commands and samples of the error a second [Hz].
        command_limit: largest voltage of the controller [V].

    Returns:
        Shares that add up to today's RMSE with that of the rig as modelled; `eha_core.report.budget` presents them.

    Raises:
        EhaError: nothing was found that could be repaired, or too much for every subset to be simulated.
        ParameterError: the task or the rig's values do not fit.
    """
    from eha_core.error_budget import error_budget

    task = task_of(reference, controller, duration, skip, rate, command_limit)
    return error_budget(rig_of(found, nominal), task)


def task_of(
    reference: str | Signal, controller: str, duration: float | None, skip: float | None, rate: float,
    command_limit: float,
) -> Task:  # fmt: skip
    """The motion that `budget` counts the error of, with its defaults."""
    from eha_core.error_budget import Task
    from eha_core.signals import from_text

    signal = from_text(reference) if isinstance(reference, str) else reference
    usual = (4.0, 1.0) if controller else (10.0, 0.0)
    length, uncounted = (given if given is not None else default
                         for given, default in zip((duration, skip), usual, strict=True))  # fmt: skip
    return Task(signal, controller, length, uncounted, rate, command_limit)


def rig_of(
    found: Results | Recording | Mapping[str, float] | str | Path,
    nominal: Nominal = None,
    topics: str | Path | None = None,
    jobs: int = 2,
) -> Rig:
    """The rig that `budget` is of; a recording is read by `topics` and diagnosed on so many threads."""
    from eha_core.error_budget import rig_from_changes, rig_from_document
    from eha_core.report.document import document
    from eha_core.report.results import Results

    if isinstance(found, Mapping):
        model = given_model(nominal) or nominal_of({})
        if model.unknown:
            raise ParameterError(f"{min(model.unknown)} is unknown, which only a diagnosis takes; give its value")
        return rig_from_changes(found, model.values, model.composition)
    if isinstance(found, (str, Path)) and Path(found).suffix == ".json":
        return rig_from_document(read_diagnosis(found), str(found))
    if not isinstance(found, Results):
        recording = found if isinstance(found, Recording) else read_recording(found, topics)
        found = diagnose(recording, nominal, jobs=jobs)
    return rig_from_document(document(found.diagnosis), found.diagnosis.path)


def curves(
    files: Sequence[str | Path | Mapping[str, ArrayLike]],
    *,
    command: str | None = None,
    flow: str | None = None,
    load_pressure: str | Sequence[str] | None = None,
    leakage: str | None = None,
    units: Mapping[str, str] | None = None,
    pressure_drop: float | None = None,
    supply_pressure: float | None = None,
    rated_current: float | None = None,
    rated_voltage: float | None = None,
) -> ValveCurves:
    """Find a valve's null, gains, overlap, hysteresis and leakage in the steady curves of a test bench.

    Args:
        files: tables, or columns by name, with curves of flow, load pressure or leakage over the command.
        command: column of the current [A], the voltage [V] or the share of the full command [%].
        flow, load_pressure, leakage: the other column; of a load pressure also two, pressure A and pressure B. Columns
            that are not named are recognised by their units and names.
        units: by column, its unit, where its name states none, as {"Q": "l/min"}.
        pressure_drop: over both edges of the valve during the flow curve [Pa].
        supply_pressure: at blocked ports, above the return line's [Pa].
        rated_current: coil current at the full command [A], of a curve over a voltage or a share.
        rated_voltage: the full command [V], of a curve over a voltage.

    Returns:
        The figures of each curve with 95 % intervals, and the plant's parameters that follow;
        `eha_core.report.curves` presents them.

    Raises:
        RecordingError: a file cannot be read as a table.
        EhaError: a column or its unit is missing, or a curve is no valve's.
    """
    from eha_core.valve_curves import FLOW, LEAKAGE, PRESSURE, Conditions, Selection, curves_of, fit_curves

    pressures = [load_pressure] if isinstance(load_pressure, str) else load_pressure
    response = {FLOW: [flow] if flow else [], PRESSURE: pressures or [], LEAKAGE: [leakage] if leakage else []}
    selection = Selection(command, response, units or {})
    conditions = Conditions(pressure_drop, supply_pressure, rated_current, rated_voltage)
    return fit_curves(curves_of(files, selection), conditions)


def steps(
    files: Sequence[str | Path | Mapping[str, ArrayLike]],
    *,
    command: str | None = None,
    motion: str | None = None,
    time: str | None = None,
    units: Mapping[str, str] | None = None,
    topics: str | Path | None = None,
) -> StepTests:
    """Read short step tests of a machine's valve together: dead zone, gain, delay, saturation and end stops.

    Args:
        files: tables, recordings of messages, or columns by name: the command steps from neutral to a level and back.
        command, motion, time: columns, of messages channels; those that are not named are recognised.
        units: by column, its unit, where its name states none, as {"boom": "deg"}.
        topics: a topics file for recordings of messages.

    Returns:
        The figures of each step and of each direction with 95 % intervals, in the units of the first file;
        `eha_core.report.steps` presents them.

    Raises:
        RecordingError: a file cannot be read.
        EhaError: a column or its unit is missing, or no file has a step.
    """
    from eha_core.step_tests import Selection, read_steps, records_of

    return read_steps(records_of(files, Selection(command, motion, time, units or {}, topics)))
