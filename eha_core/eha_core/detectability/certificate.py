"""A certificate of a planned test: the smallest detectable size of each effect, and the effects confounded with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from eha_core.detectability.planned import NOISE, PlannedTest, RigAsModelled, linearised
from eha_core.detectability.refit import confirmed
from eha_core.diagnosis.criteria import CERTAINTY
from eha_core.diagnosis.detection.responses import FittedModel
from eha_core.diagnosis.detection.rows import effect_rows, middle_shapes, parameter_rows
from eha_core.diagnosis.detection.sizes import Trial, smallest, trials
from eha_core.diagnosis.result import Detectable, Noticeable
from eha_core.nominal import NominalModel


@dataclass(frozen=True)
class Certificate:
    """What a planned test can detect.

    Attributes:
        test: the test.
        power: the probability with which the listed sizes are found.
        samples: the number of samples.
        effects: the effects, in the catalogue's order. parameters: the nominal parameters.
        stroke: the largest distance from mid-stroke, as a share of the stroke.
        scales: full scales that sizes may be compared with, by unit [SI].
        remarks: warnings about the test.
    """

    test: PlannedTest
    power: float
    samples: int
    effects: tuple[Detectable, ...]
    parameters: tuple[Noticeable, ...]
    stroke: float
    scales: Mapping[str, float]
    remarks: tuple[str, ...] = ()


def certify(model: NominalModel, test: PlannedTest) -> Certificate:
    """What a diagnosis would find in a recording of this test if the rig differs from the model by one effect.

    Raises ParameterError for an actuator that no voltage drives.
    """
    with threadpool_limits(1):
        at = linearised(model, test)
        tried, factors = middle_shapes(*_measured(at))
        rows = effect_rows(at, tried, confirmed(at, tried, factors))
        if not set(NOISE) <= set(test.channels):
            rows = _with_pressures(rows, linearised(model, test.recording(tuple(NOISE))))
        values = model.values
        area, drop = values["piston_area"], values["supply_pressure"] - values["return_pressure"]
        scales = {"m": values["actuator_displacement"], "A": values["saturation_current"], "N": area * drop, "Pa": drop}
        stroke = float(np.max(np.abs(at.motion.position))) / values["actuator_displacement"]
        remarks = _remarks(at, stroke)
        return Certificate(test, CERTAINTY, at.fit.count, rows, parameter_rows(at), stroke, scales, remarks)


def _measured(at: FittedModel) -> tuple[list[Trial], list[float]]:
    tried = trials(at)
    return tried, smallest(at, tried).tolist()


def _with_pressures(rows: Sequence[Detectable], at: FittedModel) -> tuple[Detectable, ...]:
    """The rows with the sizes that are found if pressures are recorded, too, and effects that only these show. These
    sizes are the linearisation's, not confirmed by fits."""
    more = {(row.effect, row.parameter): row for row in effect_rows(at, *middle_shapes(*_measured(at)))}
    known = {(row.effect, row.parameter) for row in rows}
    found = [replace(row, with_pressures=more[row.effect, row.parameter].size) for row in rows]
    added = [replace(row, size=None, flow=None, with_pressures=row.size, confusions=())
             for key, row in more.items() if key not in known]  # fmt: skip
    return (*found, *added)


def _remarks(at: RigAsModelled, stroke: float) -> tuple[str, ...]:
    remarks = []
    if stroke > 0.98:
        remarks.append("the piston reaches the end of its stroke: give a smaller or slower command")
    saturation = at.fit.values["saturation_current"] * at.fit.values["coil_resistance"]
    largest = float(np.max(np.abs(at.motion.voltage)))
    if largest > saturation:
        remarks.append(f"the command reaches {largest:.3g} V, and the coil saturates at {saturation:.3g} V")
    return tuple(remarks)
