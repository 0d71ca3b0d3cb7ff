"""The free parameters of a fit: their coordinates, bounds and priors."""

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
class FreeParameter:
    """One parameter that a fit moves, by q: value = reference exp(q) if logarithmic, else reference + scale q.

    The prior of q has mean 0 and standard deviation `prior_deviation`; `lower` and `upper` bound the value. A finite
    difference is at least `resolution` in q, because an instant takes effect at a step of the simulation. Where `above`
    names a parameter, q and the bounds apply to the share by which this one exceeds it.
    """

    name: str
    reference: float
    logarithmic: bool
    scale: float
    prior_deviation: float
    lower: float
    upper: float
    resolution: float = 0.0
    above: str = ""

    @property
    def longest_move(self) -> float:
        """Longest move of the coordinate in one iteration: a factor e, or ten scales."""
        return 1.0 if self.logarithmic else 10.0

    def value(self, q: float) -> float:
        """The parameter's value, or the share by which it exceeds another's, at coordinate q, inside the bounds."""
        value = self.reference * exp(min(max(q, -50.0), 50.0)) if self.logarithmic else self.reference + self.scale * q
        return min(max(value, self.lower), self.upper)

    def coordinate(self, value: float) -> float:
        """The coordinate of a value."""
        if self.logarithmic:
            return log(max(value, self.lower, 1e-300) / self.reference)
        return (value - self.reference) / self.scale

    def is_bound_by(self, value: float) -> bool:
        """Whether a bound limits a value; a bound at zero or at the nominal value does not count."""
        bounds = (bound for bound in (self.lower, self.upper) if bound not in (0.0, self.reference))
        return any(abs(value - bound) <= 1e-6 * abs(bound) for bound in bounds)

    def slope(self, value: float) -> float:
        """d value / d q, which converts a standard deviation of the coordinate to one of the value."""
        return value if self.logarithmic else self.scale


def coordinates(free: Sequence[FreeParameter], values: Mapping[str, float]) -> Array:
    """The coordinates at which the free parameters have these values."""
    return np.array([parameter.coordinate(_own(parameter, values)) for parameter in free])


def _own(parameter: FreeParameter, values: Mapping[str, float]) -> float:
    """The quantity of the coordinate: the value, or the share above another one, clipped to its bounds, beyond which
    the derivative would be zero."""
    if not parameter.above:
        return values[parameter.name]
    share = values[parameter.name] / values[parameter.above] - 1.0 if values[parameter.above] > 0.0 else 0.0
    return min(max(share, parameter.lower), parameter.upper)


def values_at(values: Mapping[str, float], free: Sequence[FreeParameter], q: Array) -> dict[str, float]:
    """Every parameter's value: `values`, and the free ones at coordinates `q`."""
    found = {**values, **{parameter.name: parameter.value(float(at)) for parameter, at in zip(free, q, strict=True)}}
    for parameter in free:
        if parameter.above:
            found[parameter.name] = found[parameter.above] * (1.0 + found[parameter.name])
    return found


@dataclass(frozen=True)
class Prior:
    """The prior of a nominal value: the standard `deviation` of its coordinate, and the factor that bounds it.

    `scale` [SI] is the coordinate's unit of a parameter that may be zero, and `bound_factor` is then in such units (0:
    unbounded); with a scale of 0 the coordinate is logarithmic.
    """

    deviation: float
    bound_factor: float
    scale: float = 0.0


NOMINAL_PRIORS: Mapping[str, Prior] = {
    "coil_inductance": Prior(0.3, 2.0),
    "valve_damping_ratio": Prior(0.3, 2.5),
    "valve_natural_frequency": Prior(0.3, 2.0),
    "valve_gain": Prior(0.7, 4.0),
    "bulk_modulus": Prior(0.7, 5.0),
    "supply_pressure": Prior(0.4, 2.0),
    "return_pressure": Prior(1.0, 10.0, 1e5),
    "spring_stiffness": Prior(1.0, 0.0, 2e4),
    "actuator_displacement": Prior(0.3, 2.0),
    "moving_mass": Prior(0.7, 5.0),
    "damping_coefficient": Prior(1.0, 8.0),
    "internal_leakage": Prior(1.0, 0.0, 3e-11),
}
"""Errors of data sheets and hand-over notes (assumed).

Held, because a recording depends on them only through the ones above: coil_resistance (through the gain), piston_area
(through gain, mass and damping), line_volume (through stroke and bulk modulus). Held, because a departure from them is
an effect of the catalogue: external_leakage, and piston_area_b where the nominal cylinder is symmetric.
"""

USUAL_SPREAD = (0.7, 4.0)
"""Prior of a source's own parameter, unless its part says otherwise."""

LATE = ("coil_inductance", "valve_damping_ratio", "valve_natural_frequency", "actuator_displacement")
"""Freed last: far from the optimum, the valve's dynamics or the stroke would compensate for a wrong mass or oil."""

TOUCHING = 0.985
"""Share of the stroke beyond which the piston has been at its end: the stroke is then known, and not fitted."""

NOT_KNOWN = Prior(2.3, 1000.0)
"""Prior of an unknown value: a factor of ten either way is likely, a thousand impossible (assumed)."""

FORCE_ONLY = ("spring_stiffness", "moving_mass", "damping_coefficient")
"""The parameters that a recording without the valve's command identifies."""


def free_nominal_parameters(
    nominal: Mapping[str, float], drive: str, travel: float, unknown: Collection[str] = (),
    composition: Composition = PAPER,
) -> tuple[FreeParameter, ...]:  # fmt: skip
    """The nominal parameters that are free with this drive; `travel` is the largest measured |position| [m].

    The nominal value of an `unknown` one is only its initial guess.
    """
    free = []
    for name, prior in {**NOMINAL_PRIORS, **_priors_of(composition.source)}.items():
        known = _not_known(prior) if name in unknown else prior
        if (drive not in WITH_OIL and name not in FORCE_ONLY) or name not in composition.place_rows:
            continue
        row = composition.place_rows[name]
        reference = nominal[name]
        if name == "spring_stiffness" and reference == 0.0 and drive not in WITH_OIL:
            continue  # an axis without a spring: a fitted one would only compensate for an offset
        logarithmic = known.scale == 0.0 and reference > 0.0
        lower, upper = row.lower, row.upper
        if logarithmic:
            lower, upper = max(lower, reference / known.bound_factor), min(upper, reference * known.bound_factor)
        if name == "actuator_displacement":
            if travel > TOUCHING * reference:
                continue
            lower = max(lower, 1.01 * travel)
        scale = 0.0 if logarithmic else max(known.scale or row.typical, abs(reference))
        if not logarithmic and known.bound_factor:
            upper = min(upper, reference + known.bound_factor * scale)
        free.append(FreeParameter(name, reference, logarithmic, scale, known.deviation, lower, max(lower, upper)))
    if nominal["piston_area_b"] != nominal["piston_area"] and drive in WITH_OIL:
        row = composition.place_rows["piston_area_b"]
        free.append(FreeParameter(row.name, nominal[row.name], True, 0.0, 0.3, row.lower, row.upper))
    return tuple(free)


def _priors_of(source: Source) -> dict[str, Prior]:
    """The priors of a source's own parameters, without those that it holds."""
    own = {row.name for row in source.own} - set(source.held)
    return {
        row.name: Prior(*source.spread.get(row.name, USUAL_SPREAD), 0.0 if row.logarithmic else row.typical)
        for row in source.parameters
        if row.name in own or row.name in source.spread
    }


def _not_known(prior: Prior) -> Prior:
    """The prior of a parameter whose nominal value is not known."""
    return replace(NOT_KNOWN, scale=prior.scale)


def not_believed(parameter: FreeParameter, row: Parameter) -> FreeParameter:
    """A nominal parameter with its prior released to NOT_KNOWN, within the limits of its `row` in the catalogue."""
    bound_factor = NOT_KNOWN.bound_factor
    if parameter.logarithmic:
        lower = max(row.lower, parameter.reference / bound_factor)
        upper = min(row.upper, parameter.reference * bound_factor)
    else:
        lower, upper = row.lower, min(row.upper, parameter.reference + bound_factor * parameter.scale)
    return replace(parameter, prior_deviation=NOT_KNOWN.deviation, lower=lower, upper=upper)
