"""Whether a cylinder can have a travel: a rod of many bores' length buckles."""

from __future__ import annotations

from math import pi, sqrt

from eha_core.errors import RecordingError

MOST_BORES = 60.0
"""Bores of travel that a cylinder has at most: slender ones of catalogues have 30, telescopes twice that (assumed)."""


def require_possible_travel(where: str, travel: float, area: float, is_given: bool) -> None:
    """Refuse a position that no cylinder of a piston can have gone through.

    Args:
        where: how the message begins.
        travel: from the lowest to the highest position [m].
        area: the piston's larger area [m^2].
        is_given: whether a nominal file says the area; else it is the catalogue's.

    Raises:
        RecordingError: the travel is longer than MOST_BORES diameters of the piston.
    """
    if travel <= MOST_BORES * sqrt(4.0 * area / pi):
        return
    whose = "" if is_given else ", which is the catalogue's for want of a nominal file"
    raise RecordingError(
        f"{where}: {travel:.3g} m of travel cannot be on a piston of {area * 1e4:.3g} cm^2{whose}; say the position's"
        " unit in a topics file (`unit: mm`), or make the rig's own nominal file with `eha init-rig`"
    )
