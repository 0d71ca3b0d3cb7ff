"""From the figures of curves to parameters of the plant, as far as the conditions of the test are known."""

from __future__ import annotations

from collections.abc import Sequence

from eha_core.rig.parameters import AMPERE_EQUIVALENT, flow_gain
from eha_core.valve_curves.leakage import Orifices, fit_lands
from eha_core.valve_curves.result import FLOW, LEAKAGE, PRESSURE, Conditions, CurveFit, Found, Value

_NOT_MEASURED = {
    FLOW: ("valve_gain", "flow_gain_asymmetry.ratio", "valve_deadband.half_width", "spool_hysteresis.half_width"),
    LEAKAGE: ("valve_null_leakage.conductance",),
}


def amperes(unit: str, conditions: Conditions) -> float | None:
    """Amperes, or ampere-equivalents of the spool, of one unit of the command; None where that is not known."""
    full = conditions.rated_current or AMPERE_EQUIVALENT
    if unit == "A":
        return 1.0
    if unit == "%":
        return full / 100.0
    return full / conditions.rated_voltage if conditions.rated_voltage else None


def parameters_of(fits: Sequence[CurveFit], conditions: Conditions) -> tuple[tuple[Found, ...], dict[str, str]]:
    """The plant's parameters that follow from the curves, and those that do not, with reason and remedy."""
    found: list[Found] = []
    left: dict[str, str] = {}
    by_kind = {fit.curve.kind: fit for fit in fits}
    for kind, names in _NOT_MEASURED.items():
        if kind not in by_kind:
            left |= dict.fromkeys(names, f"no {kind} curve is given")
    if (flow := by_kind.get(FLOW)) is not None:
        _of_flow(flow, conditions, found, left)
    else:
        _null_of(by_kind, conditions, found, left)
    if (leakage := by_kind.get(LEAKAGE)) is not None:
        _of_leakage(leakage, flow, conditions, found, left)
    return tuple(found), left


def _of_flow(fit: CurveFit, conditions: Conditions, found: list[Found], left: dict[str, str]) -> None:
    unit = amperes(fit.curve.unit, conditions)
    values = fit.values
    how = "1 - flow gain of negative over positive commands"
    found.append(_found("flow_gain_asymmetry.ratio", values["asymmetry"], 1.0, "-", how))
    if unit is None:
        reason = "the curve is over a voltage; give --rated-voltage, and --rated-current if it is known"
        left |= dict.fromkeys(("valve_gain", "valve_null_offset.offset", "valve_deadband.half_width"), reason)
        return
    gain = values["flow_gain_positive"]
    if conditions.pressure_drop is None:
        left["valve_gain"] = "the pressure drop over the valve is not known; give --pressure-drop"
    else:
        factor = flow_gain(1.0, conditions.pressure_drop, unit)
        how = "flow gain of positive commands / root of half the pressure drop"
        found.append(_found("valve_gain", gain, factor, "m^(5/2) kg^(-1/2)", how))
    found.append(_found("valve_null_offset.offset", values["null_shift"], -unit, "A", "minus the current of zero flow"))
    overlap = values["overlap"]
    if overlap.value >= 0.0 or not overlap.is_sure:
        found.append(_found("valve_deadband.half_width", overlap, unit, "A", "half of the dead zone"))
    else:
        left["valve_deadband.half_width"] = "the valve has underlap, for which the plant has no parameter"
    if "edge_rounding" in values and overlap.is_sure and overlap.value > 0.0:
        found.append(_found("valve_deadband.rounding", values["edge_rounding"], unit, "A", "rounding of the dead zone"))
    if "hysteresis" in values:
        how = "half of the loop's width"
        found.append(_found("spool_hysteresis.half_width", values["hysteresis"], 0.5 * unit, "A", how))
    else:
        left["spool_hysteresis.half_width"] = "one direction of travel was measured only; sweep up and down"
    if "curvature" in values:
        bend = values["curvature"]
        found.append(_found("flow_saturation.curvature", bend, 1.0 / unit, "1/A", "bend of the flow curve"))
    if values.keys() & {"saturation_positive", "saturation_negative"}:
        left["saturation_current"] = (
            "the flow saturates while the measured command still rises, which is no limit of the coil's current"
        )


def _null_of(by_kind: dict[str, CurveFit], conditions: Conditions, found: list[Found], left: dict[str, str]) -> None:
    """Null and hysteresis from the pressure gain, where no flow curve is given."""
    fit = by_kind.get(PRESSURE)
    unit = None if fit is None else amperes(fit.curve.unit, conditions)
    if fit is None or unit is None:
        left["valve_null_offset.offset"] = "no flow curve and no pressure gain curve over a known current is given"
        return
    how = "minus the current of zero load pressure"
    found.append(_found("valve_null_offset.offset", fit.values["null_shift"], -unit, "A", how))
    if "hysteresis" in fit.values:
        left.pop("spool_hysteresis.half_width", None)
        how = "half of the width of the loop about null"
        found.append(_found("spool_hysteresis.half_width", fit.values["hysteresis"], 0.5 * unit, "A", how))


def _of_leakage(
    fit: CurveFit, flow: CurveFit | None, conditions: Conditions, found: list[Found], left: dict[str, str]
) -> None:
    names = ("valve_null_leakage.conductance", "valve_null_leakage.width")
    unit = amperes(fit.curve.unit, conditions)
    missing = [
        word
        for word, known in (
            ("the flow curve", flow), ("--pressure-drop", conditions.pressure_drop),
            ("--supply-pressure", conditions.supply_pressure),
            ("one unit of the command in both", flow is None or flow.curve.unit == fit.curve.unit or None),
            ("--rated-voltage", unit),
        )
        if known is None
    ]  # fmt: skip
    drop, supply = conditions.pressure_drop, conditions.supply_pressure
    if missing or flow is None or drop is None or supply is None or unit is None:
        reason = f"needs {', '.join(missing)} too, as blocked ports share the leakage with the open edges"
        left |= dict.fromkeys(names, reason)
        return
    gain = flow_gain(flow.values["flow_gain_positive"].value, drop, 1.0)
    orifices = Orifices(gain, flow.values["overlap"].value, supply)
    lands = fit_lands(fit, orifices)
    if lands is None:
        left |= dict.fromkeys(names, "the curve has another shape than the plant's law of null leakage")
        return
    (conductance, reach), (width, width_reach) = lands
    how = "leakage curve, with the edges of the flow curve"
    found.append(Found(names[0], conductance, reach, "m^3/(s Pa)", how, conductance > reach))
    found.append(Found(names[1], width * unit, width_reach * unit, "A", how, conductance > reach))


def _found(name: str, value: Value, factor: float, unit: str, how: str) -> Found:
    reach = (value.reach or 0.0) * abs(factor)
    return Found(name, value.value * factor, reach, unit, how, value.is_sure)
