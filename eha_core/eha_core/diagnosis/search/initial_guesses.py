"""What could be missing: each effect of the catalogue, and the values from which a fit with it begins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.effect_parameters import MOST_ABOVE
from eha_core.effects import Effect
from eha_core.identification.observation import Observation
from eha_core.parameter import Parameter

SITES_OF_DRIVE = {
    "voltage": ("command", "spool", "orifice", "supply", "chamber", "force", "sensor", "schedule"),
    "pressures": ("force", "sensor"),
    "force": ("force", "sensor"),
    "measured": ("spool", "orifice", "supply", "chamber", "force", "sensor", "schedule"),
}
"""Where a recording with this drive can show anything."""


@dataclass(frozen=True)
class InitialGuess:
    """An effect with values for its parameters (full names)."""

    effect: Effect
    values: Mapping[str, float]


def applicable_effects(observations: Sequence[Observation]) -> tuple[Effect, ...]:
    """The effects that these recordings could show: those of examined sites whose sensor was there."""
    sites = SITES_OF_DRIVE[observations[0].drive]
    found = [effect for effect in observations[0].composition.effects if effect.site in sites and effect.named]
    if not any(channel.name.startswith("pressure") for observation in observations for channel in observation.measured):
        found = [effect for effect in found if "measured_pressure_a" not in effect.needs]
    return tuple(found)


def initial_guesses(effect: Effect, scales: Scales) -> tuple[InitialGuess, ...]:
    """Every combination of the starting values that the effect's parameters declare."""
    choices = []
    for row in effect.parameters:
        origin, scale = scales.by_quantity.get(row.relative_to, (0.0, row.typical))
        choices.append([min(max(origin + scale * at, row.lower), row.upper) for at in row.starts])
    names = effect.parameter_names()
    found = [InitialGuess(effect, dict(zip(names, values, strict=True))) for values in product(*choices)]
    return tuple(guess for guess in found if all(_may_be(guess, row) for row in effect.parameters))


def _may_be(guess: InitialGuess, row: Parameter) -> bool:
    """Whether a guess has a parameter as far above another as a fit lets it be."""
    own = guess.effect.id
    if not row.above:
        return True
    share = guess.values[f"{own}.{row.name}"] / guess.values[f"{own}.{row.above}"] - 1.0
    return 0.0 <= share <= MOST_ABOVE
