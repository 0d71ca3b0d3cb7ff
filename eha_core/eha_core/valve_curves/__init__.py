"""Steady curves of a valve test bench: flow, pressure gain and leakage over the command, with no time in them."""

from eha_core.valve_curves.columns import Selection, curves_of
from eha_core.valve_curves.result import FLOW, LEAKAGE, PRESSURE, Conditions, CurveFit, Found, Value, ValveCurves
from eha_core.valve_curves.study import fit_curves

__all__ = [
    "FLOW", "LEAKAGE", "PRESSURE", "Conditions", "CurveFit", "Found", "Selection", "Value", "ValveCurves", "curves_of",
    "fit_curves",
]  # fmt: skip
