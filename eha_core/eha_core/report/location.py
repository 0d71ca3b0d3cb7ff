"""Where the nominal equations fail, as a sentence."""

from __future__ import annotations

from eha_core.diagnosis.result import Location
from eha_core.effects import SITES


def location_statement(location: Location) -> str:
    """A location in words."""
    percent, site = f"{100 * location.share:.0f} %", SITES[location.site].words
    if location.alone:
        return "in the force balance: nothing else was recorded"
    if location.law_over:
        return f"{percent} of the missing physics {site} is a law over {location.law_over}"
    if location.all_of_stretch:
        times = f", through all of the stretch from {location.when[0][0]:.0f} s on"
    else:
        times = _times(location.when)
    return f"{percent} of the recalibrated model's unexplained error is {site}, {location.where}{times}"


def _times(when: tuple[tuple[float, float], ...]) -> str:
    if not when:
        return ""
    if len(when) == 1 and when[0][0] == 0.0:
        return ", through the whole record"
    if len(when) == 1:
        return f", from {when[0][0]:.4g} s to {when[0][1]:.4g} s"
    return f", in {len(when)} intervals, the first from {when[0][0]:.1f} s"
