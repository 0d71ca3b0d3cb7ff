"""What could be added to a set: for each effect the values at which it is tried, as columns of the linear model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from eha_core.curve import KNOTS
from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.criteria import HATS, OF_SCALE
from eha_core.diagnosis.effect_parameters import MOST_ABOVE
from eha_core.effects import Effect
from eha_core.identification.observation import Observation
from eha_core.identification.per_recording import named
from eha_core.parameter import Parameter

LAWS = {
    "recovered_force": ("position", "velocity", "pressure difference", "time", "position, times velocity"),
    "recovered_opening": ("spool position",),
    "recovered_leakage": ("pressure difference",),
}
"""What each curve can be over; a curve with several carries its choice in a parameter `variable`."""

SIZES = {1.0: 100.0, 0.1: 3.0}
"""Shares of a guess's size at which an effect is tried, and the largest factor on each: what an effect does is seldom
in proportion to its size (assumed)."""

SITES_OF_DRIVE = {
    "voltage": ("command", "spool", "orifice", "supply", "chamber", "force", "sensor", "schedule"),
    "pressures": ("force", "sensor"),
    "force": ("force", "sensor"),
    "measured": ("spool", "orifice", "supply", "chamber", "force", "sensor", "schedule"),
}
"""Where a recording with this drive can show anything."""


def applicable_effects(observations: Sequence[Observation]) -> tuple[Effect, ...]:
    """The effects that these recordings could show: those of examined sites whose sensor was there."""
    sites = SITES_OF_DRIVE[observations[0].drive]
    found = [effect for effect in observations[0].composition.effects if effect.site in sites and effect.named]
    if not any(channel.name.startswith("pressure") for observation in observations for channel in observation.measured):
        found = [effect for effect in found if "measured_pressure_a" not in effect.needs]
    return tuple(found)


@dataclass(frozen=True)
class Column:
    """One guess of an effect: `values` (full names) at which it is tried, and what its sizes do.

    Attributes:
        effect: the effect.
        values: of its parameters, in every recording where they differ between recordings.
        sizes: the names that are scaled by the coefficient that the linear model finds for the column.
        alternative: columns of one effect with the same number belong together, each with a coefficient of its own;
            columns with different numbers exclude each other.
        one_way: the coefficient cannot be negative.
        most: the largest coefficient.
        limited: the effect acts over an interval only, whose ends are in `values`.
        variable: of a law that is in no catalogue, what its curve is over.
        nothing: where a size changes nothing, of those of which that is not the nominal value.
    """

    effect: Effect
    values: Mapping[str, float]
    sizes: tuple[str, ...]
    alternative: int
    one_way: bool
    most: float = 100.0
    limited: bool = False
    variable: str = ""
    nothing: Mapping[str, float] = field(default_factory=dict)

    def beside(self, values: Mapping[str, float]) -> Column:
        """The column in a model of these values: what takes the place of a parameter there is counted from it."""
        rows = dict(zip(self.effect.parameter_names(), self.effect.parameters, strict=True))
        nothing = {name: values[rows[name].replaces] for name in self.sizes if name in rows and rows[name].replaces}
        if not nothing:
            return self
        shifted = {name: self.values[name] + at for name, at in nothing.items()}
        return replace(self, values={**self.values, **shifted}, nothing=nothing)

    def factors(self) -> tuple[float, float]:
        """The least and the largest factor on the sizes that their bounds, and the linear model, allow."""
        rows = dict(zip(self.effect.parameter_names(), self.effect.parameters, strict=True))
        least, most = 0.0 if self.one_way else -self.most, self.most
        for name in self.sizes:
            row = rows[name.partition("@")[0]]
            nothing = self.nothing.get(name, row.nominal)
            step = self.values[name] - nothing
            ends = sorted(((row.lower - nothing) / step, (row.upper - nothing) / step))
            least, most = max(least, ends[0]), min(most, ends[1])
        return min(least, 0.0), max(most, 0.0)

    def sized(self, factor: float) -> dict[str, float]:
        """The values with the sizes at so many times what they are, within their bounds."""
        rows = dict(zip(self.effect.parameter_names(), self.effect.parameters, strict=True))
        values = dict(self.values)
        for name in self.sizes:
            row = rows[name.partition("@")[0]]
            nothing = self.nothing.get(name, row.nominal)
            values[name] = min(max(nothing + factor * (values[name] - nothing), row.lower), row.upper)
        return values


def columns_of(
    effect: Effect, scales: Scales, per_recording: Sequence[str] = (), recordings: int = 1
) -> tuple[Column, ...]:
    """Every column of an effect: a combination of starting shapes at each of SIZES, unless the starts that the effect
    declares hold it already, and in it a column for each independent size.

    Sizes are independent where the effect may have either of them alone, as the biases of two sensors, or where they
    differ between recordings.
    """
    rows = dict(zip(effect.parameter_names(), effect.parameters, strict=True))
    switching = [name for name, row in rows.items() if row.switches]
    apart = len(switching) > 1 and all(0.0 in rows[name].starts for name in switching)
    groups = [[name] for name in switching] if apart else [switching]
    one_way = not all(rows[name].lower < rows[name].nominal for name in switching)
    found: list[Column] = []
    starts = list(_starts(effect, rows, scales, one_way))
    shares = [*product(SIZES.items(), starts)]
    for alternative, ((share, most), chosen) in enumerate(shares):
        sized = Column(effect, chosen, tuple(switching), alternative, one_way, most).sized(share)
        if share < 1.0 and any(np.allclose(list(sized.values()), list(other.values()), atol=0.0) for other in starts):
            continue
        off = {name: rows[name].nominal for name in switching}
        for group in groups:
            differs = any(name in per_recording for name in group)
            for number in range(1, recordings + 1 if differs else 2):
                on = {named(name, number) if name in per_recording else name: chosen[name] for name in group}
                everywhere = {named(name, n): off[name] for name in group if name in per_recording
                              for n in range(1, recordings + 1)}  # fmt: skip
                column = Column(effect, {**chosen, **off, **everywhere, **on}, tuple(on), alternative, one_way, most)
                found.append(replace(column, values=column.sized(share)))
    return tuple(found)


def _starts(effect: Effect, rows: Mapping[str, Parameter], scales: Scales, one_way: bool) -> Iterator[dict[str, float]]:
    """The combinations of starting values that the effect's rows declare; of sizes none that is zero or, where the
    coefficient has a sign, differs by its sign alone."""
    choices = []
    for row in rows.values():
        origin, scale = scales.by_quantity.get(row.relative_to, (0.0, row.typical))
        starts = [at for at in row.starts if at != 0.0 or not row.switches]
        if row.switches and not one_way:
            starts = sorted({abs(at) for at in starts}) or [1.0]
        choices.append([min(max(origin + scale * at, row.lower), row.upper) for at in starts])
    for values in product(*choices):
        found = dict(zip(rows, values, strict=True))
        if all(_may_be(effect, found, row) for row in rows.values()):
            yield found


def _may_be(effect: Effect, values: Mapping[str, float], row: Parameter) -> bool:
    """Whether a guess has a parameter as far above another as a fit lets it be."""
    if not row.above:
        return True
    share = values[f"{effect.id}.{row.name}"] / values[f"{effect.id}.{row.above}"] - 1.0
    return 0.0 <= share <= MOST_ABOVE


def law_columns(effects: Sequence[Effect], scales: Scales) -> tuple[Column, ...]:
    """Laws that are in no catalogue: for each variable that a curve can be over, HATS columns that together draw it."""
    found = []
    for effect in effects:
        known = _size_of(effect, scales)
        if known is None:
            continue
        size = OF_SCALE * known
        for place, variable in enumerate(LAWS.get(effect.id, ())):
            covered = range_of(variable, scales)
            if covered is None:
                continue
            values = {f"{effect.id}.lower": covered[0], f"{effect.id}.upper": covered[1]}
            if len(LAWS[effect.id]) > 1:
                values[f"{effect.id}.variable"] = float(place)
            unit = size / max(scales.by_quantity["speed"][1], 1e-9) if variable.endswith("times velocity") else size
            centres = np.linspace(0.0, KNOTS - 1.0, HATS)
            for centre in centres:
                heights = unit * np.maximum(0.0, 1.0 - np.abs(np.arange(KNOTS) - centre) / (centres[1] - centres[0]))
                knots = {f"{effect.id}.knot_{k:02d}": float(height) for k, height in enumerate(heights)}
                sizes = tuple(name for name, height in knots.items() if height != 0.0)
                found.append(Column(effect, {**values, **knots}, sizes, place, False, variable=variable))
    return tuple(found)


def _size_of(effect: Effect, scales: Scales) -> float | None:
    """What a curve of an effect is large against: the usual force, opening or leakage.

    None where the recording does not tell, as of a plant that a measured force drives, which has no valve and no oil.
    """
    quantities = {"force": ("force",), "orifice": ("spool",)}.get(effect.site, ("leakage_flow", "pressure"))
    if any(name not in scales.by_quantity for name in quantities):
        return None
    return float(np.prod([scales.by_quantity[name][1] for name in quantities]))


def range_of(variable: str, scales: Scales) -> tuple[float, float] | None:
    """The range of a variable that the recording covers; None where it is not known."""
    variable = variable.partition(",")[0]
    if variable == "time":
        return 0.0, scales.by_quantity["time"][1]
    if variable == "position":
        centre, half = scales.by_quantity["position"]
        return centre - half, centre + half
    if not len(scales.rows):
        speed = scales.by_quantity["speed"][1]
        return (-2.5 * speed, 2.5 * speed) if variable == "velocity" else None
    if variable == "pressure difference":
        series = scales.column("pressure_a") - scales.column("pressure_b")
    else:
        series = scales.column({"velocity": "velocity", "spool position": "spool_position"}[variable])
    low, high = np.quantile(series, [0.002, 0.998])
    return float(low), float(high)
