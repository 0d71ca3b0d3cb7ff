"""How well `eha budget` predicts a repair: drawn rigs with two effects, diagnosed from a recording, then repaired.

    python -m tools.repair_trials --rigs 100 --seed S --out FILE [--first K] [--jobs 2]

Each rig and its recording are drawn as the exam draws them, and diagnosed. The budget of what was found says which RMSE
a position controller is left with once an effect is repaired. Then the exam's truth, which shares no code with the
model, runs the same loop without that effect. A line of FILE is one rig.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import inf, pi
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from eha_core.api import known_model
from eha_core.control import make_controller
from eha_core.control.interface import Controller, Measurement, Target
from eha_core.diagnosis.pipeline import diagnose_together
from eha_core.error_budget import Budget, Rig, Task, error_budget, rig_from_document
from eha_core.errors import EhaError
from eha_core.recording import read_recording
from eha_core.report.document import document
from eha_core.signals import make_signal
from eha_exam.case import Case
from eha_exam.drawing import draw_case
from eha_exam.errors import ExamError
from eha_exam.files import recording_name, write_case
from eha_exam.measuring import measure, simulate_case
from eha_exam.truth.record import Effect
from eha_exam.truth.simulate import COLUMNS, SteppedTruth
from tools.trial_rows import try_rigs

POSITION = COLUMNS.index("position")

CONTROLLER = "lqr"
"""It is designed from the model; the PID's crossover is for light rigs and makes some of the heavy ones oscillate."""

SHARE = 0.5
"""Of the recording's amplitude and speed that the task's sine has."""

ALWAYS = {"leakage_onset": {"time": -inf}}
"""What begins during a recording acts from the start of the task, as the budget says of it."""

WITHIN = 0.05
"""Share by which the RMSE after a repair may differ from its prediction."""


def try_rig(number: int, seed: int) -> dict[str, Any]:
    """One rig: what was concealed and named; and the RMSE [m] today and after each repair, predicted and true."""
    case = draw_case("pair", number, seed)
    row: dict[str, Any] = {"number": number, "concealed": list(case.effect_ids)}
    try:
        rig = _diagnosed(case)
    except (EhaError, ExamError) as error:
        return row | {"why": str(error)}
    task = task_of(case)
    budget = error_budget(rig, task)
    named = [departure.name for departure in rig.departures if departure.repairable]
    effects = [(name, {**values, **ALWAYS.get(name, {})}) for name, values in case.effects]
    row |= {"named": named, "today": [budget.today.value, true_rmse(case, effects, rig, task)], "repairs": {}}
    for name in sorted(set(named) & set(case.effect_ids)):
        left = [effect for effect in effects if effect[0] != name]
        row["repairs"][name] = [predicted(budget, name), true_rmse(case, left, rig, task)]
    return row


def _diagnosed(case: Case) -> Rig:
    """The rig as the diagnosis of the case's recording has it."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / recording_name(case)
        write_case(case, measure(case, simulate_case(case)), path)
        recording = read_recording(path)
        found = document(diagnose_together([recording], known_model(None, recording), jobs=1))
    return rig_from_document(found, case.name)


def task_of(case: Case) -> Task:
    """A sine of half the recording's amplitude and speed under the controller."""
    amplitude = SHARE * case.amplitude
    signal = make_signal("sine", {"amplitude": amplitude, "frequency": SHARE * case.speed / (2.0 * pi * amplitude)})
    largest = case.plant["saturation_current"] * case.plant["coil_resistance"]
    return Task(signal, CONTROLLER, command_limit=largest)


def predicted(budget: Budget, name: str) -> float:
    """The RMSE [m] without one departure."""
    gain = next(share.gain.value for share in budget.shares if share.name == name)
    return budget.today.value - gain


def true_rmse(case: Case, effects: Sequence[Effect], rig: Rig, task: Task) -> float:
    """The RMSE [m] of the truth with these effects under the controller that was designed for the rig as modelled."""
    controller = make_controller(task.controller, rig.modelled, 1.0 / task.rate, task.command_limit)
    position, wanted = _followed(controller, case, effects, task)
    return float(np.sqrt(np.mean((position - wanted)[round(task.skip * task.rate) :] ** 2)))


def _followed(
    controller: Controller, case: Case, effects: Sequence[Effect], task: Task
) -> tuple[np.ndarray[Any, np.dtype[np.float64]], np.ndarray[Any, np.dtype[np.float64]]]:
    """The truth's piston and the reference [m] at each command; it begins on the reference, at rest, and the first
    measurement is known, as in the budget."""
    times = np.arange(round(task.duration * task.rate) + 1) / task.rate
    wanted, speed = task.signal.value(times), task.signal.derivative(times)
    start = float(wanted[0])
    truth = SteppedTruth(case.plant, effects, task.rate, len(times), initial_position=start)
    piston = np.empty(len(times))
    for tick in range(len(times)):
        position, velocity, pressure_a, pressure_b = truth.sense()
        force = case.plant["piston_area"] * pressure_a - case.plant["piston_area_b"] * pressure_b
        seen = Measurement(start, 0.0, 0.0) if tick == 0 else Measurement(position, velocity, force)
        voltage = controller.voltage(seen, Target(float(wanted[tick]), float(speed[tick])))
        piston[tick] = truth.hold(voltage)[POSITION]
    return piston, np.asarray(wanted)


def summed_up(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """How many repairs ended within WITHIN of the prediction: on rigs of which all was named, and on the others."""
    told = [row for row in rows if row.get("repairs")]
    whole = [row for row in told if set(row["concealed"]) <= set(row["named"])]
    for some, of_which in ((whole, "both effects were named"), ([row for row in told if row not in whole], "one was")):
        errors = [[abs(true / said - 1.0) for said, true in row["repairs"].values()] for row in some]
        every, rigs = np.array(sum(errors, [])), sum(max(own) <= WITHIN for own in errors)
        yield f"{len(some)} rigs of which {of_which}: all repairs within {100 * WITHIN:g} % on {rigs}"
        if len(every):
            near = f"{np.sum(every <= WITHIN)} within {100 * WITHIN:g} %, median error {100 * np.median(every):.2g} %"
            yield f"  {len(every)} repairs: {near}, 90 % of them below {100 * np.quantile(every, 0.9):.2g} %"
    for row in told:
        for name, (said, true) in row["repairs"].items():
            if abs(true / said - 1.0) > WITHIN:
                what = f"{row['number']}, {' + '.join(row['concealed'])}, named {' + '.join(row['named'])}"
                yield f"{what}: without {name} {1e6 * said:.4g} um predicted, {1e6 * true:.4g} um true"


if __name__ == "__main__":
    try_rigs(try_rig, summed_up, __doc__, 100)
