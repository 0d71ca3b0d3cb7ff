"""Which parameters a fit may move, in which coordinate, and how far it takes their nominal values on trust."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from math import exp, log

import numpy as np

from eha_core.identification.numbers import Array
from eha_core.identification.observation import WITH_OIL
from eha_core.parameter import Parameter
from eha_core.plant import PAPER, Composition
from eha_core.plant.parts import Source


@dataclass(frozen=True)
class Free:
    """One parameter that a fit moves, by q: value = reference exp(q) if logarithmic, else reference + scale q.

    The prior says q = 0 with standard deviation `trust`. `lower` and `upper` bound the value. A derivative is taken
    over no less than `resolution` in q: an instant acts from one step of the simulation to the next. Where `above`
    names a parameter, q and the bounds are of the share by which this one exceeds that.
    """

    name: str
    reference: float
    logarithmic: bool
    scale: float
    trust: float
    lower: float
    upper: float
    resolution: float = 0.0
    above: str = ""

    @property
    def longest_move(self) -> float:
        """How far one iteration may carry the coordinate: a factor e, or ten scales."""
        return 1.0 if self.logarithmic else 10.0

    def value(self, q: float) -> float:
        """The parameter's value, or the share by which it exceeds another's, at coordinate q, inside the bounds."""
        value = self.reference * exp(min(max(q, -50.0), 50.0)) if self.logarithmic else self.reference + self.scale * q
        return min(max(value, self.lower), self.upper)

    def coordinate(self, value: float) -> float:
        """The coordinate of such a value."""
        if self.logarithmic:
            return log(max(value, self.lower, 1e-300) / self.reference)
        return (value - self.reference) / self.scale

    def is_bound_by(self, value: float) -> bool:
        """Whether a value rests on a bound; one at nothing, or where it is nominal, is no wish for more."""
        bounds = (bound for bound in (self.lower, self.upper) if bound not in (0.0, self.reference))
        return any(abs(value - bound) <= 1e-6 * abs(bound) for bound in bounds)

    def slope(self, value: float) -> float:
        """d value / d q, to carry a standard deviation from the coordinate to the value."""
        return value if self.logarithmic else self.scale


def coordinates(free: Sequence[Free], values: Mapping[str, float]) -> Array:
    """The coordinates at which the free parameters have these values."""
    return np.array([one.coordinate(_own(one, values)) for one in free])


def _own(one: Free, values: Mapping[str, float]) -> float:
    """What the coordinate is of: the value, or the share above another, inside its bounds: past one is no slope."""
    if not one.above:
        return values[one.name]
    share = values[one.name] / values[one.above] - 1.0 if values[one.above] > 0.0 else 0.0
    return min(max(share, one.lower), one.upper)


def values_at(values: Mapping[str, float], free: Sequence[Free], q: Array) -> dict[str, float]:
    """Every parameter's value: `values`, and the free ones at coordinates `q`."""
    found = {**values, **{one.name: one.value(float(at)) for one, at in zip(free, q, strict=True)}}
    for one in free:
        if one.above:
            found[one.name] = found[one.above] * (1.0 + found[one.name])
    return found


@dataclass(frozen=True)
class Trust:
    """How far a nominal value is taken on trust: by `trust` in its coordinate, and never beyond a factor of `reach`.

    `scale` [SI] is the coordinate's unit where the parameter may be zero, and `reach` then counts such units (0: any);
    a scale of 0 says that it moves by factors.
    """

    trust: float
    reach: float
    scale: float = 0.0


NOMINAL_TRUST: Mapping[str, Trust] = {
    "coil_inductance": Trust(0.3, 2.0),
    "valve_damping_ratio": Trust(0.3, 2.5),
    "valve_natural_frequency": Trust(0.3, 2.0),
    "valve_gain": Trust(0.7, 4.0),
    "bulk_modulus": Trust(0.7, 5.0),
    "supply_pressure": Trust(0.4, 2.0),
    "return_pressure": Trust(1.0, 10.0, 1e5),
    "spring_stiffness": Trust(1.0, 0.0, 2e4),
    "actuator_displacement": Trust(0.3, 2.0),
    "moving_mass": Trust(0.7, 5.0),
    "damping_coefficient": Trust(1.0, 8.0),
    "internal_leakage": Trust(1.0, 0.0, 3e-11),
}
"""Assumed: how far data sheets and hand-over notes are off.

Held, because a recording sees them only through the ones above: coil_resistance (through the gain), piston_area
(through gain, mass and damping), line_volume (through stroke and bulk modulus). Held, because a departure from them is
physics and has its name in the catalogue: external_leakage, and piston_area_b where the nominal cylinder is symmetric.
"""

USUAL_SPREAD = (0.7, 4.0)
"""Of a source's own parameter, where its part says nothing else."""

LATE = ("coil_inductance", "valve_damping_ratio", "valve_natural_frequency", "actuator_displacement")
"""Freed last: a fit that is still far off would bend the valve's dynamics or the stroke to imitate a wrong mass or
oil."""

TOUCHING = 0.985
"""Share of the stroke beyond which the piston has been at its end: then the stroke is seen, and not fitted."""

NOT_KNOWN = Trust(2.3, 1000.0)
"""Of a value that nobody knows: a factor of ten either way is likely, a thousand impossible (assumed)."""

FORCE_ONLY = ("spring_stiffness", "moving_mass", "damping_coefficient")
"""What a recording without the valve's command can tell."""


def nominal_freedom(
    nominal: Mapping[str, float], drive: str, travel: float, unknown: Collection[str] = (),
    composition: Composition = PAPER,
) -> tuple[Free, ...]:  # fmt: skip
    """The nominal parameters that a recording with this drive may move; `travel` is the largest |position| seen [m].

    Of `unknown` ones the nominal value is only where the search begins.
    """
    free = []
    for name, trust in {**NOMINAL_TRUST, **_trust_of(composition.source)}.items():
        known = _not_known(trust) if name in unknown else trust
        if (drive not in WITH_OIL and name not in FORCE_ONLY) or name not in composition.place_rows:
            continue
        row = composition.place_rows[name]
        reference = nominal[name]
        if name == "spring_stiffness" and reference == 0.0 and drive not in WITH_OIL:
            continue  # an axis said to have no spring; a spring would only take up what an offset leaves
        logarithmic = known.scale == 0.0 and reference > 0.0
        lower, upper = row.lower, row.upper
        if logarithmic:
            lower, upper = max(lower, reference / known.reach), min(upper, reference * known.reach)
        if name == "actuator_displacement":
            if travel > TOUCHING * reference:
                continue
            lower = max(lower, 1.01 * travel)
        scale = 0.0 if logarithmic else max(known.scale or row.typical, abs(reference))
        if not logarithmic and known.reach:
            upper = min(upper, reference + known.reach * scale)
        free.append(Free(name, reference, logarithmic, scale, known.trust, lower, max(lower, upper)))
    if nominal["piston_area_b"] != nominal["piston_area"] and drive in WITH_OIL:
        row = composition.place_rows["piston_area_b"]
        free.append(Free(row.name, nominal[row.name], True, 0.0, 0.3, row.lower, row.upper))
    return tuple(free)


def _trust_of(source: Source) -> dict[str, Trust]:
    """How far the values of a source's own parameters are taken on trust; none of those that it holds."""
    own = {row.name for row in source.own} - set(source.held)
    return {
        row.name: Trust(*source.spread.get(row.name, USUAL_SPREAD), 0.0 if row.logarithmic else row.typical)
        for row in source.parameters
        if row.name in own or row.name in source.spread
    }


def _not_known(trust: Trust) -> Trust:
    """The trust in the nominal value of a parameter that is not known."""
    return replace(NOT_KNOWN, scale=trust.scale)


def not_believed(one: Free, row: Parameter) -> Free:
    """A nominal parameter as free as if nobody knew its value, within the limits of its `row` in the catalogue."""
    reach = NOT_KNOWN.reach
    if one.logarithmic:
        lower, upper = max(row.lower, one.reference / reach), min(row.upper, one.reference * reach)
    else:
        lower, upper = row.lower, min(row.upper, one.reference + reach * one.scale)
    return replace(one, trust=NOT_KNOWN.trust, lower=lower, upper=upper)
