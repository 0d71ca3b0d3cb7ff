"""Series for the report: the measured channels, and those of the nominal, recalibrated and augmented models."""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.characteristic_scales import scales_alone
from eha_core.diagnosis.evidence import Evidence
from eha_core.diagnosis.result import Pictures
from eha_core.identification.fit import Fit
from eha_core.identification.numbers import Array
from eha_core.identification.shooting import Shooting
from eha_core.identification.validate import instants_of, split


def pictures(evidence: Evidence, before: Fit, calibrated: Fit, after: Fit) -> Pictures:
    """Measured and modelled channels at the same times; the models restart in each window."""
    whole = evidence.calibration.shooting
    shooting = evidence.shown(whole)
    models = [_modelled(shooting, evidence.shown_fit(whole, result)) for result in (before, calibrated, after)]
    times = {name: shooting.times(sampling) for name, sampling in zip(shooting.names, shooting.samplings, strict=True)}
    measured = {name: sampling.values for name, sampling in zip(shooting.names, shooting.samplings, strict=True)}
    variables: dict[str, Array] = {}
    scales = scales_alone(whole, evidence.scales, evidence.lead)
    if len(scales.rows):
        for name in ("velocity", "spool_position", "position", "pressure_a", "pressure_b"):
            variables[name] = scales.column(name)
        variables["time"] = np.asarray((np.arange(len(scales.rows)) + 1) * shooting.every * shooting.step_size)
    if evidence.observation.drive == "voltage":
        times["voltage_command"], measured["voltage_command"] = evidence.observation.inputs[0]
    equations = {residual.equation: (residual.time, residual.residual) for residual in evidence.equations}
    outside = split(whole, instants_of(after))[1]
    lead = whole.recordings[evidence.lead - 1]
    spans = whole.local_edges.tolist()
    judged = tuple((spans[window][0], spans[window][1]) for window in outside.windows if window in lead)
    return Pictures(times, measured, models[0], models[1], models[2], variables, equations, judged)


def _modelled(shooting: Shooting, result: Fit) -> dict[str, Array]:
    pairs = zip(shooting.names, shooting.samplings, result.residuals, strict=True)
    return {name: sampling.values - residual * sampling.noise for name, sampling, residual in pairs}
