"""Stage 6, show: how large an effect that was not named may be, from the quadratic model about the chosen set."""

from __future__ import annotations

from eha_core.diagnosis.calibrate import filtered_channels
from eha_core.diagnosis.criteria import CERTAINTY
from eha_core.diagnosis.detection.responses import FittedModel
from eha_core.diagnosis.detection.rows import effect_rows, middle_shapes, parameter_rows
from eha_core.diagnosis.detection.sizes import smallest, trials
from eha_core.diagnosis.evidence import Evidence
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.result import Explained, FittedParameter, Undetected
from eha_core.diagnosis.search.pool import Pool, Trace
from eha_core.effects import effects


def undetected(evidence: Evidence, left: Explained, parameters: tuple[FittedParameter, ...]) -> Undetected | None:
    """The smallest detectable size of each effect that was not named, and change of each parameter that did not change;
    None where the residual is more than noise, because its cause hides others."""
    if not (left.complete or left.vague):
        return None
    at = fitted_model(evidence)
    untold = [name for entry, _ in evidence.decision.rivals for name in entry.ids]
    if at.pool.filtered:
        untold += [effect.id for effect in effects() if effect.only_delays]
    tried = trials(at, untold)
    rows = effect_rows(at, *middle_shapes(tried, smallest(at, tried).tolist()))
    changed = {parameter.name for parameter in parameters if parameter.changed}
    return Undetected(CERTAINTY, rows, tuple(row for row in parameter_rows(at) if row.name not in changed))


def fitted_model(evidence: Evidence) -> FittedModel:
    """The chosen set, as the search fitted it and can extend it."""
    winner, calibration = evidence.decision.winner, evidence.calibration
    own = {parameter.name: parameter for parameter in winner.fit.free}
    plant = tuple(own.get(one.name, one) for one in calibration.fitted.free if "@" not in one.name)
    nominal = {NOTHING: evidence.comparison.nominal.fit}
    pool = Pool(calibration.problem, plant, Trace(), nominal, filtered_channels(evidence.observations))
    return FittedModel(evidence.observations, pool, winner.hypothesis, winner.fit, evidence.scales)
