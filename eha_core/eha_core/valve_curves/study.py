"""From curves to their figures and the plant's parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from eha_core.errors import EhaError
from eha_core.valve_curves.flow import fit_flow
from eha_core.valve_curves.leakage import fit_leakage
from eha_core.valve_curves.parameters import parameters_of
from eha_core.valve_curves.pressure import fit_pressure
from eha_core.valve_curves.result import FLOW, LEAKAGE, PRESSURE, Conditions, Curve, CurveFit, Value, ValveCurves

_FIT = {FLOW: fit_flow, PRESSURE: fit_pressure, LEAKAGE: fit_leakage}


def fit_curves(curves: Sequence[Curve], conditions: Conditions) -> ValveCurves:
    """The figures of all curves of one valve, at most one of each kind.

    Raises:
        EhaError: two curves of one kind, or a curve that is no valve's.
    """
    by_kind: dict[str, Curve] = {}
    for curve in curves:
        if (first := by_kind.get(curve.kind)) is not None:
            raise EhaError(
                f"{curve.source}: is a second {curve.kind} curve, after {first.source}; give one of each kind"
            )
        by_kind[curve.kind] = curve
    fits = tuple(_with_share(_FIT[curve.kind](curve), conditions) for curve in curves)
    return ValveCurves(fits, conditions, *parameters_of(fits, conditions))


def _with_share(fit: CurveFit, conditions: Conditions) -> CurveFit:
    """A pressure gain curve with its gain in parts of supply pressure and full command, where both are known."""
    full = {"A": conditions.rated_current, "V": conditions.rated_voltage, "%": 100.0}[fit.curve.unit]
    if fit.curve.kind != PRESSURE or conditions.supply_pressure is None or full is None:
        return fit
    gain, factor = fit.values["pressure_gain"], full / conditions.supply_pressure
    share = Value("pressure_gain_share", gain.value * factor, (gain.reach or 0.0) * factor, "%/%")
    return replace(fit, values={**fit.values, share.name: share})
