"""The missing physics as laws in SI units: force over velocity, flow over pressure difference, opening over spool.

A law has three parts: the fitted curve with its 95 % band, the nominal model's curve, and, where an equation contains
the law, points computed from the measured channels.
"""

from __future__ import annotations

from collections.abc import Callable

from eha_core.diagnosis.result import Diagnosis, NamedEffect
from eha_core.report.laws import chamber, force, orifice, schedule, sensor, supply
from eha_core.report.laws.law import Law
from eha_core.report.laws.models import Models
from eha_core.report.laws.unknown import unknown_law

__all__ = ["Law", "laws"]

_SITES: dict[str, Callable[[Models, NamedEffect], Law | None]] = {
    site.__name__.rpartition(".")[2]: site.law for site in (chamber, force, orifice, schedule, sensor, supply)
}


def laws(diagnosis: Diagnosis) -> dict[str, Law]:
    """The law of each named effect that has one, by its id and in the diagnosis' order, or the recovered law.

    A dead time or a hysteresis has none, because it is not a function of one quantity.
    """
    models = Models(diagnosis)
    if diagnosis.unknown is not None:
        return {"": unknown_law(models, diagnosis.unknown)}
    found = {effect.id: _SITES[effect.site](models, effect) for effect in diagnosis.effects if effect.site in _SITES}
    return {name: law for name, law in found.items() if law is not None}
