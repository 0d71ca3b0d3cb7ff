"""The plant's parameters from a data sheet's lines, in closed form, each with how it was found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi, sqrt

from eha_core.errors import ParameterError
from eha_core.nominal import nominal_of
from eha_core.parameters import UNKNOWN, catalogue
from eha_core.plant import PAPER, Composition
from eha_core.rig.data_sheet import DATA, Datum

AMPERE_EQUIVALENT = 0.02
"""A at full opening where a valve's electronics hide its current: the paper's; the spool is counted in it, and every
other value would do."""


@dataclass(frozen=True)
class Entry:
    """One parameter of a nominal file: its value [SI], None where nobody knows it, and how it was found."""

    name: str
    value: float | None
    how: str


def parameters_of(
    given: Mapping[str, float], composition: Composition = PAPER, measured: Sequence[Entry] = ()
) -> list[Entry]:
    """The parameters of a rig, as far as they follow from a data sheet's lines [SI by name, see DATA].

    Args:
        given: a data sheet's lines.
        composition: the actuator's parts, which have some of the parameters and not others.
        measured: entries that take the place of those of a data sheet.

    Raises:
        ParameterError: lines that contradict each other, or a parameter outside of its bounds.
    """
    found = [*_valve(given), *_cylinder(given), *_oil(given), *_load(given), *_pump(given)]
    better = {entry.name: entry for entry in measured}
    if "valve_gain" in better and "rated_flow" in given:
        raise ParameterError("--rated-flow contradicts the flow gain of --curves; leave it out, with its pressure drop")
    found = [*(better.pop(entry.name, entry) for entry in found), *better.values()]
    entries = [entry for entry in found if entry.name in composition.rows]
    values = {entry.name: UNKNOWN if entry.value is None else entry.value for entry in entries}
    nominal_of(values, composition=composition)
    return entries


def asked_of(composition: Composition) -> tuple[Datum, ...]:
    """The lines of data sheets from which parameters of an actuator of these parts follow."""
    return tuple(datum for datum in DATA if datum.tells in composition.rows)


def _pump(given: Mapping[str, float]) -> list[Entry]:
    size = given.get("pump_displacement")
    per_radian = None if size is None else size / (2.0 * pi)
    return [_entry("pump_displacement", per_radian, "oil of a revolution over 2 pi")]


def piston_area(bore: float, rod: float) -> float:
    """The ring between bore and rod [m] in m^2: pi / 4 (D^2 - d^2)."""
    return pi / 4.0 * (bore**2 - rod**2)


def flow_gain(rated_flow: float, rated_pressure_drop: float, rated_current: float) -> float:
    """K in Q = K I sqrt(dp): half of the rated drop lies over each of the two edges that the flow passes."""
    return rated_flow / (rated_current * sqrt(rated_pressure_drop / 2.0))


def _valve(given: Mapping[str, float]) -> list[Entry]:
    voltage, current = given.get("rated_voltage"), given.get("rated_current")
    full = current or AMPERE_EQUIVALENT
    by = "rated current" if current else "assumed to stand for full opening, as electronics hide the current"
    entries = [
        _entry("coil_resistance", None if voltage is None else voltage / full, "rated voltage over that current"),
        _entry("coil_inductance", given.get("coil_inductance"), "as given"),
        _entry("saturation_current", full, by),
        _entry("valve_damping_ratio", given.get("valve_damping"), "as given"),
        _entry("valve_natural_frequency", given.get("valve_frequency"), "2 pi times the frequency of 90 degrees lag"),
    ]
    flow, drop = given.get("rated_flow"), given.get("rated_pressure_drop")
    if (flow is None) != (drop is None):
        raise ParameterError("--rated-flow and --rated-pressure-drop belong together; give both, or neither")
    gain = None if flow is None or drop is None else flow_gain(flow, drop, full)
    entries.append(_entry("valve_gain", gain, "rated flow / (rated current x root of half the rated pressure drop)"))
    return entries


def _cylinder(given: Mapping[str, float]) -> list[Entry]:
    bore, rod, rod_a = given.get("bore"), given.get("rod"), given.get("rod_a")
    for name, size in (("--rod", rod), ("--rod-a", rod_a)):
        if bore is not None and size is not None and size >= bore:
            raise ParameterError(f"{name} {size * 1e3:g} mm is not thinner than the bore of {bore * 1e3:g} mm")
    area_a = None if bore is None else piston_area(bore, rod_a or 0.0)
    area_b = None if bore is None or rod is None else piston_area(bore, rod)
    ring = "pi / 4 (bore^2 - rod^2)"
    on_a = f"{ring} on chamber A's side" if rod_a else "pi / 4 bore^2, no rod on chamber A's side"
    if rod_a is None:
        on_a += ", assumed"
    stroke = given.get("stroke")
    return [
        _entry("piston_area", area_a, on_a),
        _entry("piston_area_b", area_b, f"{ring} on chamber B's side"),
        _entry("actuator_displacement", stroke and stroke / 2.0, "half of the whole stroke"),
        _entry("line_volume", *_line_volume(given)),
    ]


def _line_volume(given: Mapping[str, float]) -> tuple[float | None, str]:
    bore, dead = given.get("hose_bore"), given.get("dead_volume")
    lengths = [given[name] for name in ("hose_length_a", "hose_length_b") if name in given]
    if lengths and bore is None:
        raise ParameterError("--hose-length-a and --hose-length-b need the hoses' inner diameter; give --hose-bore too")
    if bore is None or not lengths:
        return dead, "as given; hoses left out" if dead is not None else ""
    volume = pi / 4.0 * bore**2 * sum(lengths) / len(lengths) + (dead or 0.0)
    how = f"pi / 4 hose bore^2 x {'mean length' if len(set(lengths)) > 1 else 'length'}"
    return volume, how + (" and the dead volume" if dead else "; no dead volume beside, assumed")


def _oil(given: Mapping[str, float]) -> list[Entry]:
    flow, pressure = given.get("leakage_flow"), given.get("leakage_pressure")
    if (flow is None) != (pressure is None):
        raise ParameterError("--leakage-flow and --leakage-pressure belong together; give both, or neither")
    leakage = None if flow is None or pressure is None else flow / pressure
    return [
        _entry("supply_pressure", given.get("supply_pressure"), "as given"),
        _given_or("return_pressure", given, 0.0),
        _entry("bulk_modulus", given.get("bulk_modulus"), "as given"),
        _entry("internal_leakage", leakage, "leakage flow over its pressure difference"),
        Entry("external_leakage", 0.0, "assumed: none"),
    ]


def _load(given: Mapping[str, float]) -> list[Entry]:
    return [
        _entry("moving_mass", given.get("moving_mass"), "as given"),
        _entry("damping_coefficient", given.get("damping"), "as given"),
        _given_or("spring_stiffness", given, 0.0),
        Entry("atmospheric_pressure", catalogue()["atmospheric_pressure"].nominal, "assumed: standard atmosphere"),
    ]


def _entry(name: str, value: float | None, how: str) -> Entry:
    return Entry(name, value, how if value is not None else "not given")


def _given_or(name: str, given: Mapping[str, float], otherwise: float) -> Entry:
    return Entry(name, given[name], "as given") if name in given else Entry(name, otherwise, f"assumed: {otherwise:g}")
