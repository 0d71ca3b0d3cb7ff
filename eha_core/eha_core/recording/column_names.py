"""What a column's name says: which quantity, of which side, measured or wanted; in English, German, French and Spanish.

A name is divided into words. Each word that is known says something; one that is not makes the whole less than sure.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache

from eha_core.unit_names import unit_named


def _of(**words: str) -> dict[str, str]:
    return {word: meaning for meaning, several in words.items() for word in several.split()}


_QUANTITIES = _of(
    time="time timestamp stamp zeit zeitstempel uhrzeit clock epoch date datum datetime temps tiempo elapsed seconds second"
    " sekunden xvalue",
    pressure="pressure press pres prs pressures druck druecke pression presion pressione fluidpressure chamberpressure",
    position="position pos posn stroke displacement disp displ weg hub laser lvdt extension travel posicion course hubweg"
    " kolbenweg elongation lage ltr",
    velocity="velocity vel speed geschwindigkeit geschw vitesse velocidad xdot xd",
    force="force kraft effort forza fuerza loadcell kraftmessdose fx",
    flow="flow flowrate volumenstrom durchfluss debit caudal",
    voltage="voltage volt volts spannung tension uvalve ucmd",
    current="current strom courant corriente amps amperage",
    spool="spool schieber tiroir xv",
    command="cmd cmds command commands ctrl ansteuerung stellgroesse stellsignal duty pwm",
    angle="angle winkel theta phi angulo alpha rotation",
    torque="torque drehmoment couple",
    turning="rpm drehzahl turns",
    other="temp temperature temperatur acc accel acceleration beschleunigung power leistung level fuellstand humidity"
    " viscosity vibration status state mode error err fehler alarm flag enable enabled",
)  # fmt: skip
_LETTERS = {
    "t": "time", "p": "pressure", "x": "position", "v": "velocity", "f": "force", "q": "flow", "u": "voltage",
    "i": "current", "n": "turning",
}  # fmt: skip
"""Symbols; they say less than a word, and yield to one."""
_OBJECTS = _of(
    valve="valve ventil valves servo servovalve servoventil proportional solenoid coil spule magnet vanne valvula prop",
    cylinder="cylinder zylinder zyl cyl actuator aktor ram jack verin cilindro piston kolben",
    pump="pump pumpe pumps pompe motor",
    supply="supply versorgung battery batterie sys system source netz feed speise",
    tank="tank return ruecklauf reservoir drain sump",
)
_SIDES = _of(
    a="a 1 head headside cap capend blind bore boden bodenseite kolbenseite kolbenseitig bottom",
    b="b 2 rod rodside rodend annulus ring ringseite stange stangenseite kolbenstange stangenseitig gap",
    supply="s 0",
)
_WANTED = frozenset(
    [
        "ref",
        "reference",
        "des",
        "desired",
        "target",
        "set",
        "setpoint",
        "soll",
        "sollwert",
        "demand",
        "demanded",
        "consigne",
        "goal",
        "planned",
        "wanted",
    ]
)
"""What is asked for is not what is measured."""
_DENIED = frozenset(
    [
        "err",
        "error",
        "fehler",
        "abweichung",
        "deviation",
        "diff",
        "difference",
        "delta",
        "dp",
        "max",
        "min",
        "limit",
        "limits",
        "alarm",
        "status",
        "flag",
        "enable",
        "sim",
        "simulated",
        "model",
        "modelled",
        "est",
        "estimated",
        "predicted",
        "temp",
        "temperature",
        "temperatur",
        "pilot",
        "accumulator",
        "speicher",
    ]
)
"""What is derived, or of another part than the cylinder."""
_MEASURED = frozenset(("position", "velocity", "force", "pressure", "flow", "angle", "torque"))
_FILLERS = frozenset(
    [
        "main",
        "plot",
        "data",
        "value",
        "sensor",
        "measured",
        "meas",
        "messwert",
        "ist",
        "istwert",
        "actual",
        "act",
        "fbk",
        "feedback",
        "signal",
        "sig",
        "ch",
        "chan",
        "channel",
        "ai",
        "ain",
        "analog",
        "in",
        "input",
        "io",
        "out",
        "output",
        "hyd",
        "hydraulic",
        "rig",
        "run",
        "test",
        "log",
        "gvl",
        "plc",
        "global",
        "var",
        "st",
        "model",
        "root",
        "chamber",
        "kammer",
        "side",
        "seite",
        "port",
        "line",
        "axis",
        "ax",
        "axial",
        "exp",
        "x1",
        "no",
        "nr",
        "raw",
        "filt",
        "filtered",
        "filter",
        "the",
        "of",
        "at",
        "on",
        "daq",
        "dev",
        "device",
        "mod",
        "module",
        "group",
        "untitled",
        "abs",
        "rel",
        "gauge",
        "absolute",
        "zyl1",
        "state",
        "interface",
        "interfaces",
        "controller",
        "lbl",
        "y",
        "z",
        "d",
        "r",
        "lr",
        "fl",
        "l",
        "j",
        "joint",
        "states",
    ]
) | frozenset("oel oil pressures")
_FIRST = frozenset(
    [
        "up",
        "extend",
        "extending",
        "a",
        "1",
        "out",
        "open",
        "plus",
        "pos",
        "positive",
        "forward",
        "fwd",
        "heben",
        "ausfahren",
        "auf",
        "raise",
        "lift",
        "vor",
    ]
)
_SECOND = frozenset(
    [
        "down",
        "retract",
        "retracting",
        "b",
        "2",
        "in",
        "close",
        "closed",
        "minus",
        "neg",
        "negative",
        "backward",
        "back",
        "bwd",
        "rev",
        "reverse",
        "senken",
        "einfahren",
        "ab",
        "lower",
        "zurueck",
    ]
)
"""What the two one-sided commands of a valve are called; the first moves the piston out."""

_CHANNELS_OF_SIDES = {
    "pressure": {"a": "pressure_a", "b": "pressure_b", "supply": "supply_pressure"},
    "flow": {"a": "flow_a", "b": "flow_b"},
}
_ASCII = str.maketrans(
    {"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss", "é": "e", "è": "e", "ê": "e", "ó": "o", "í": "i", "á": "a", "ñ": "n"}
)


@dataclass(frozen=True)
class Meaning:
    """What a name says.

    Attributes:
        channels: the channels that it may be; none where it says nothing, or something else.
        quantity: the quantity that it names; empty where it names none.
        is_word: whether a whole word names it, and not a symbol of one letter.
        is_sure: whether every word of it is understood.
        is_wanted: whether it is what is asked for, and not what is measured.
        is_other: whether it is certainly no channel.
        side: 1 or -1 where the name is of one of two opposite directions; else 0.
    """

    channels: frozenset[str] = frozenset()
    quantity: str = ""
    is_word: bool = False
    is_sure: bool = False
    is_wanted: bool = False
    is_other: bool = False
    side: int = 0


NOTHING = Meaning()


def words_of(name: str) -> list[str]:
    """A name's words in small ASCII letters; digits are words of their own."""
    text = name.translate(_ASCII).translate({ord(k) - 32: v for k, v in (("ä", "Ae"), ("ö", "Oe"), ("ü", "Ue"))})
    text = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", text)
    text = re.sub(r"(?<=[A-Za-z])(?=\d)|(?<=\d)(?=[A-Za-z])", "_", text)
    return [word for word in re.split(r"[^a-z0-9]+", text.lower()) if word]


@lru_cache(maxsize=4096)
def meaning_of(name: str, unit: str = "", common: frozenset[str] = frozenset()) -> Meaning:
    """What a name says, by its last level, or where that names no channel with those before.

    Args:
        name: the name, its levels divided by `/`, `.` or brackets, without its unit.
        unit: the unit that is stated; a symbol yields to one that contradicts it.
        common: words that most names of the file have, which say nothing.
    """
    levels = [level for level in re.split(r"[./\[\]{}()|\\:]+", name) if words_of(level)]
    best = NOTHING
    for count in range(1, min(len(levels), 3) + 1):
        found = _of_words([word for level in levels[-count:] for word in words_of(level)], unit, common)
        if found.is_other or found.is_wanted and not found.channels:
            return found
        if len(found.channels) == 1:
            return found
        best = best if best.channels else found
    return best


def _of_words(words: list[str], unit: str, common: frozenset[str]) -> Meaning:
    words = [word for word in words if word not in common or len(words) == 1] or words
    words = _joined(words)
    known = unit_named(unit)
    quantities = [_QUANTITIES[word] for word in words if word in _QUANTITIES]
    objects = {_OBJECTS[word] for word in words if word in _OBJECTS}
    sides = _sides(words)
    letters = (
        [] if quantities else [_LETTERS[word] for word in words if word in _LETTERS and _agrees(_LETTERS[word], known)]
    )
    is_wanted, is_denied = bool(set(words) & _WANTED), bool(set(words) & _DENIED)
    # A commanded position is none that was measured; a commanded valve is the command.
    is_wanted |= "command" in quantities and bool(set(quantities) & _MEASURED) and "valve" not in objects
    if "flow" in quantities or letters[:1] == ["flow"]:
        sides |= {{"in": "a", "out": "b"}[word] for word in words if word in ("in", "out")}
    channels = _channels(quantities or letters[:1], objects, sides, known.si if known else "", is_wanted)
    unknown = [word for word in words if not _is_known(word)]
    if is_denied or "other" in quantities:
        return Meaning(quantity="other", is_other=True)
    if is_wanted and "voltage_command" not in channels:
        return Meaning(is_wanted=True)
    side = (1 if set(words) & _FIRST else 0) - (1 if set(words) & _SECOND else 0)
    quantity = (quantities or letters[:1] or [""])[0]
    sure = not unknown and not is_wanted and len(set(quantities) - {"command"}) < 2
    return Meaning(
        frozenset(channels), quantity, bool(quantities), sure, is_wanted, not channels and "tank" in objects, side
    )


def _joined(words: list[str]) -> list[str]:
    """Words of which two make one, as `load cell` and `x dot`."""
    made: list[str] = []
    for word in words:
        if made and made[-1] + word in (
            "loadcell",
            "xdot",
            "xvalue",
            "xv",
            "flowrate",
            "headside",
            "rodside",
            "rodend",
            "capend",
        ):
            made[-1] += word
        elif made and made[-1] == "x" and word in ("spool", "schieber"):
            made[-1] = word
        else:
            made.append(word)
    made = [part for word in made for part in _parts(word)]
    # pA, pb, pressurea: a symbol and its side in one word.
    split: list[str] = []
    for word in made:
        match = re.fullmatch(r"(p|q|pressure|druck|press)(a|b|s)", word)
        split += [match[1], match[2]] if match and word not in _QUANTITIES else [word]
    return split


def _parts(word: str) -> list[str]:
    """A compound such as `kolbendruck` or `rodpressure` as its two words; any other word as it is."""
    if _is_known(word):
        return [word]
    for k in range(len(word) - 3, 2, -1):
        left, right = word[:k], word[k:]
        if any(right in words for words in (_QUANTITIES, _OBJECTS, _SIDES)):
            for stem in (left, left.removesuffix("s"), left.removesuffix("n")):
                if any(stem in words for words in (_QUANTITIES, _OBJECTS, _SIDES, _WANTED, _DENIED)):
                    return [stem, right]
    return [word]


def _is_known(word: str) -> bool:
    named = (_QUANTITIES, _LETTERS, _OBJECTS, _SIDES, _WANTED, _FILLERS, _FIRST, _SECOND)
    return any(word in words for words in named) or word.isdigit()


def _agrees(quantity: str, known: object) -> bool:
    """Whether a symbol's quantity may be in a unit; one in which anything may be recorded says nothing against it."""
    si = getattr(known, "si", None)
    usual = {
        "time": "s", "pressure": "Pa", "position": "m", "velocity": "m/s", "force": "N", "flow": "m^3/s", "voltage": "V",
        "current": "A", "turning": "rad/s",
    }  # fmt: skip
    return (
        si is None
        or si in (usual[quantity], "%", "counts", "A")
        or (si == "V" and quantity in ("pressure", "position"))
    )


def _sides(words: list[str]) -> set[str]:
    return {_SIDES[word] for word in words if word in _SIDES}


def _channels(quantities: list[str], objects: set[str], sides: set[str], si: str, is_wanted: bool) -> set[str]:
    """The channels of what the words of a name say together."""
    said = set(quantities)
    if "time" in said:
        return {"time"}
    if "tank" in objects or (objects & {"supply"} and said & {"voltage", "current"}):
        return set()
    if "valve" in objects and (is_wanted or "command" in said) or (is_wanted and "voltage" in said):
        return {"voltage_command"}
    if "spool" in said or (said & {"position"} and "valve" in objects):
        return {"spool"} if not is_wanted else {"voltage_command"}
    for quantity, channels in _CHANNELS_OF_SIDES.items():
        if quantity in said or (
            not said and sides & {"a", "b"} and si == {"pressure": "Pa", "flow": "m^3/s"}[quantity]
        ):
            return _of_side(quantity, channels, objects, sides)
    if "turning" in said or (said & {"velocity"} and "pump" in objects) or ("pump" in objects and si == "rad/s"):
        return {"pump_speed"}
    if said & {"torque", "force"}:
        return {"force"}
    if said & {"position", "angle"}:
        return {"position"}
    if "velocity" in said:
        return {"velocity"}
    if "current" in said:
        return set() if "pump" in objects else {"current"}
    if said & {"voltage", "command"}:
        return set() if "pump" in objects else {"voltage_command"}
    if "valve" in objects:
        return {"current"} if si == "A" else {"voltage_command"}
    if "cylinder" in objects:
        return {"m": {"position"}, "m/s": {"velocity"}, "N": {"force"}, "": {"position"}}.get(si, set())
    return set()


def _of_side(quantity: str, channels: dict[str, str], objects: set[str], sides: set[str]) -> set[str]:
    """The channels of a pressure or a flow."""
    if quantity == "pressure" and objects & {"pump", "supply"} and not sides & {"a", "b"}:
        return {"supply_pressure"}
    found = {channels[side] for side in sides if side in channels}
    if not found and "cylinder" in objects and quantity == "pressure":
        return {"pressure_a"}  # of the piston's side, as `Kolbendruck`; not sure where the other is called likewise
    return found if len(found) == 1 else set(channels.values())


def names_a_side(name: str) -> bool:
    """Whether a name is of a quantity that has two sides, a pressure or a flow, so that a letter behind it is the side."""
    said = {_QUANTITIES.get(word, _LETTERS.get(word, "")) for word in _joined(words_of(name))}
    return bool(said & {"pressure", "flow"})


def common_words(names: list[str]) -> frozenset[str]:
    """Words that nearly all names of a file begin with: they name the rig, and say nothing of the column."""
    first = [words_of(name)[:1] for name in names]
    counts: dict[str, int] = {}
    for words in first:
        for word in words:
            counts[word] = counts.get(word, 0) + 1
    return frozenset(
        word for word, count in counts.items()
        if count >= 3 and count >= 0.6 * len(names) and word not in _QUANTITIES and word not in _LETTERS
    )  # fmt: skip
