"""The missing physics as laws in SI units: force over velocity, flow over pressure difference, opening over spool.

A law has three parts: the curve as fitted with its 95 % band, what the nominal model has in its place, and, where an
equation holds it, points that the measured channels give for it.
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
    """The law of each named effect that has one by its id, or the unknown law, in the order of the diagnosis.

    A dead time or a hysteresis has none: it is no function of one quantity.
    """
    models = Models(diagnosis)
    if diagnosis.unknown is not None:
        return {"": unknown_law(models, diagnosis.unknown)}
    found = {effect.id: _SITES[effect.site](models, effect) for effect in diagnosis.effects if effect.site in _SITES}
    return {name: law for name, law in found.items() if law is not None}
