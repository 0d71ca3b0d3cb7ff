"""The parameters that several forms of dry friction share."""

from __future__ import annotations

from dataclasses import replace

from eha_core.effects.declaration import ASSUMED
from eha_core.parameter import Parameter

STRIBECK_VELOCITY = Parameter(
    name="stribeck_velocity",
    symbol="v_s",
    unit="m/s",
    nominal=0.01,
    lower=1e-5,
    upper=10.0,
    meaning="speed over which friction falls",
    source=ASSUMED,
    typical=0.01,
    logarithmic=True,
    relative_to="speed",
    starts=(0.2,),
)


_FORCE = Parameter(
    name="force",
    symbol="F_c",
    unit="N",
    nominal=0.0,
    lower=0.0,
    upper=1e5,
    meaning="dry friction force",
    source=ASSUMED,
    typical=200.0,
    switches=True,
    relative_to="force",
    starts=(0.1, 0.4),
)


def sliding_force(meaning: str) -> Parameter:
    """The friction in motion."""
    return replace(_FORCE, meaning=meaning)


def break_away_force(meaning: str, typical: float) -> Parameter:
    """The friction at rest, never below that in motion."""
    at_rest = replace(_FORCE, name="static_force", symbol="F_s", starts=(0.2, 0.6), above="force")
    return replace(at_rest, meaning=meaning, typical=typical)
