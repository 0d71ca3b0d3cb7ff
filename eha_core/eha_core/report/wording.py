"""The labels that the terminal and the page share."""

from __future__ import annotations

import re
from collections.abc import Sequence

VERDICT_TITLES = {
    "consistent": "Nothing is missing",
    "parameters": "Parameters differ",
    "missing_physics": "Physics is missing",
    "ambiguous": "Physics is missing, and more than one cause fits",
    "unknown_physics": "Unknown physics",
}

_CHANNEL_TITLES = {
    "voltage_command": "voltage command",
    "current": "coil current",
    "spool": "spool position",
    "flow_a": "flow into chamber A",
    "flow_b": "flow out of chamber B",
    "pressure_a": "pressure of chamber A",
    "pressure_b": "pressure of chamber B",
    "supply_pressure": "supply pressure",
    "position": "position",
    "velocity": "velocity",
    "force": "force",
}

EQUATION_TITLES = {
    "force": "Force balance of the piston",
    "continuity_a": "Continuity of chamber A",
    "continuity_b": "Continuity of chamber B",
}

VARIABLE_UNITS = {
    "position": "m",
    "velocity": "m/s",
    "spool_position": "A",
    "pressure_a": "Pa",
    "pressure_b": "Pa",
}

LAW_AXES = {
    ("force", "velocity"): ("force on the piston", "N", "m/s"),
    ("force", "position"): ("force on the piston", "N", "m"),
    ("force", "pressure difference"): ("force on the piston", "N", "Pa"),
    ("force", "time"): ("force on the piston", "N", "s"),
    ("force", "position, times velocity"): ("force on the piston by its velocity", "N s/m", "m"),
    ("force", "position, times direction of motion"): ("force on the piston by its direction", "N", "m"),
    ("force", "pressure difference, times direction of motion"): ("force on the piston by its direction", "N", "Pa"),
    ("orifice", "spool position"): ("opening beyond the spool's position", "A", "A"),
    ("chamber", "pressure difference"): ("flow from chamber A to B", "m^3/s", "Pa"),
    ("chamber", "position, times pressure difference"): ("conductance from chamber A to B", "m^3/(s Pa)", "m"),
}
"""A recovered law's quantity, its unit, and the unit of its variable."""


def capital(text: str) -> str:
    """Text with a capital first letter, the rest as it is."""
    return text[:1].upper() + text[1:]


def channel_title(name: str) -> str:
    """A channel in an engineer's words; with several recordings, with the recording's number."""
    base, numbered, number = name.partition("@")
    title = _CHANNEL_TITLES.get(base, words(base))
    return f"{title}, recording {number}" if numbered else title


def channels_listed(names: Sequence[str]) -> str:
    """Channels as a sentence lists them, a pair of chambers as one."""
    pairs = {"pressure_a": ("pressure_b", "both chamber pressures"), "flow_a": ("flow_b", "both chamber flows")}
    second = {other for name, (other, _) in pairs.items() if name in names}
    titles = [
        pairs[name][1] if name in pairs and pairs[name][0] in names else channel_title(name)
        for name in names
        if name not in second
    ]
    return listed(titles)


def variable_title(name: str) -> str:
    """A state of the model in an engineer's words."""
    return channel_title(name) if name in _CHANNEL_TITLES else words(name)


def plain(text: str) -> str:
    """Text with channel names replaced by an engineer's words."""
    names = r"\b(pressure_[ab]|flow_[ab]|voltage_command|supply_pressure)\b"
    return re.sub(names, lambda channel: channel_title(channel[0]), text)


def words(name: str) -> str:
    """An identifier as words; chambers and their sides in capitals."""
    spaced = name.replace("_", " ").replace(".", ": ").replace("@", ", recording ")
    return re.sub(r" ([ab])\b", lambda chamber: chamber[0].upper(), spaced)


def listed(items: Sequence[str]) -> str:
    """Items as a sentence lists them: "a, b and c"."""
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}" if items else ""


def percent(share: float) -> str:
    """A share in whole per cent."""
    return f"{100.0 * share:.0f} %"


def probable(probability: float) -> str:
    """A probability in whole per cent, "over 99 %" at most: it is not known better."""
    return "over 99 %" if probability > 0.99 else percent(probability)


def span(seconds: tuple[float, float]) -> str:
    """A span of time."""
    return f"{seconds[0]:.1f} s to {seconds[1]:.1f} s"


def sentence(text: str) -> str:
    """Text with a capital letter and a full stop."""
    return f"{capital(text)}{'' if text.endswith(('.', '!', '?')) else '.'}" if text else ""
