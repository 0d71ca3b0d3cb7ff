"""From curves to their figures and the plant's parameters."""

from __future__ import annotations

from collections.abc import Sequence

from eha_core.errors import EhaError
from eha_core.valve_curves.flow import fit_flow
from eha_core.valve_curves.leakage import fit_leakage
from eha_core.valve_curves.parameters import parameters_of
from eha_core.valve_curves.pressure import fit_pressure
from eha_core.valve_curves.result import FLOW, LEAKAGE, PRESSURE, Conditions, Curve, CurveFit, ValveCurves

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
    fits: tuple[CurveFit, ...] = tuple(_FIT[curve.kind](curve) for curve in curves)
    return ValveCurves(fits, conditions, *parameters_of(fits, conditions))
