"""The meaning of a column's name: which quantity, of which side, measured or a set point.

A name is divided into words. Each known word adds to the meaning; an unknown one makes it uncertain.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache

from eha_core.recording import name_words as words_known
from eha_core.recording.name_words import LETTERS, OBJECTS, QUANTITIES, SIDES, WANTED
from eha_core.unit_names import Unit, unit_named

_CHANNELS_OF_SIDES = {
    "pressure": ("Pa", {"a": "pressure_a", "b": "pressure_b", "supply": "supply_pressure"}),
    "flow": ("m^3/s", {"a": "flow_a", "b": "flow_b"}),
}
_USUAL_UNITS = {
    "time": "s", "pressure": "Pa", "position": "m", "velocity": "m/s", "force": "N", "flow": "m^3/s", "voltage": "V",
    "current": "A", "turning": "rad/s",
}  # fmt: skip
_ASCII = str.maketrans(
    {
        "ä": "ae", "ö": "oe", "ü": "ue", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "ß": "ss", "é": "e", "è": "e", "ê": "e",
        "ó": "o", "í": "i", "á": "a", "ñ": "n",
    }
)  # fmt: skip
_MOST_LEVELS = 3
"""Most levels of a name that are read together."""
_COMMON = 0.6
"""Share of a file's names that begin with a word, from which the word is ignored."""


@dataclass(frozen=True)
class Meaning:
    """The meaning of a name.

    Attributes:
        channels: the channels that it may be; empty where the name is meaningless or means something else.
        quantity: the quantity that it names; empty without one.
        is_word: whether a whole word names it, not a symbol of one letter.
        is_sure: whether every word of it is known.
        is_wanted: whether it is a set point, not a measurement.
        is_other: whether it is certainly not a channel.
        side: 1 or -1 for one of two opposite directions; else 0.
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
    text = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name.translate(_ASCII))
    text = re.sub(r"(?<=[A-Za-z])(?=\d)|(?<=\d)(?=[A-Za-z])", "_", text)
    return [word for word in re.split(r"[^a-z0-9]+", text.lower()) if word]


@lru_cache(maxsize=4096)
def meaning_of(name: str, unit: str = "", common: frozenset[str] = frozenset()) -> Meaning:
    """The meaning of a name, by its last level, or together with those before if that names no channel.

    Args:
        name: the name, its levels divided by `/`, `.` or brackets, without its unit.
        unit: the stated unit; it overrides a symbol that contradicts it.
        common: words that most names of the file have, which are ignored.
    """
    levels = [level for level in re.split(r"[./\[\]{}()|\\:]+", name) if words_of(level)]
    best = NOTHING
    for count in range(1, min(len(levels), _MOST_LEVELS) + 1):
        found = _of_words([word for level in levels[-count:] for word in words_of(level)], unit, common)
        if len(found.channels) == 1 or found.is_other or (found.is_wanted and not found.channels):
            return found
        best = best if best.channels else found
    return best


def names_a_side(name: str) -> bool:
    """Whether a name is of a quantity with two sides, a pressure or a flow, so that a letter after it is the side."""
    said = {QUANTITIES.get(word, LETTERS.get(word, "")) for word in _joined(words_of(name))}
    return bool(said & {"pressure", "flow"})


def reference_in(name: str) -> str | None:
    """The pressure reference that a name states, "absolute" or "gauge"; None where it states neither, or both."""
    said = {words_known.REFERENCES[word] for word in words_of(name) if word in words_known.REFERENCES}
    return next(iter(said)) if len(said) == 1 else None


def without_reference(name: str) -> str:
    """A name without the pressure reference at its end, as in `pA_kPa_abs`."""
    start, mark, last = re.fullmatch(r"(.*?)([\s_-]*)([A-Za-z]*)", name, re.DOTALL).groups()  # type: ignore[union-attr]
    return start if mark and last.lower() in words_known.REFERENCES else name


def common_words(names: list[str]) -> frozenset[str]:
    """Words that most names of a file begin with: they name the rig, not the column."""
    counts: dict[str, int] = {}
    for name in names:
        for word in words_of(name)[:1]:
            counts[word] = counts.get(word, 0) + 1
    often = (word for word, count in counts.items() if count >= max(3, _COMMON * len(names)))
    return frozenset(word for word in often if word not in QUANTITIES and word not in LETTERS)


def _of_words(words: list[str], unit: str, common: frozenset[str]) -> Meaning:
    joined = _joined(words)
    words = [word for word in joined if word not in common] or joined
    known, said = unit_named(unit), set(words)
    quantities = [QUANTITIES[word] for word in words if word in QUANTITIES]
    objects = {OBJECTS[word] for word in words if word in OBJECTS}
    letters = [LETTERS[word] for word in words if word in LETTERS and _agrees(LETTERS[word], known)]
    named = quantities or letters[:1]
    is_wanted = bool(said & WANTED)
    # A commanded position is not a measured one; a commanded valve is the command.
    is_wanted |= "command" in quantities and bool(set(quantities) & words_known.MEASURED) and "valve" not in objects
    if said & words_known.DENIED or "other" in quantities:
        return Meaning(quantity="other", is_other=True)
    sides = _sides(words)
    behind = {after for word, after in zip(words, words[1:], strict=False) if _is_pressure(word)}
    objects |= {"tank"} if behind & words_known.TANK_LETTERS else set()
    sides |= {"supply"} if behind & words_known.SUPPLY_LETTERS else set()
    if "flow" in named:
        sides |= {{"in": "a", "out": "b"}[word] for word in words if word in ("in", "out")}
    channels = _channels(named, objects, sides, known.si if known else "", is_wanted)
    if is_wanted and "voltage_command" not in channels:
        return Meaning(is_wanted=True)
    side = bool(said & words_known.FIRST) - bool(said & words_known.SECOND)
    understood = all(_is_known(word) for word in words)
    sure = understood and not is_wanted and len(set(quantities) - {"command"}) < 2
    is_other = not channels and bool(objects & {"tank", "pump", "supply"})
    return Meaning(frozenset(channels), (*named, "")[0], bool(quantities), sure, is_wanted, is_other, side)


def _sides(words: list[str]) -> set[str]:
    """The sides that words name; with a letter, a number is not a side, as in `pB1`, pressure B of cylinder 1."""
    by_letter = {SIDES[word] for word in words if word in SIDES and not word.isdigit()}
    return by_letter if by_letter & {"a", "b"} else {SIDES[word] for word in words if word in SIDES}


def _is_pressure(word: str) -> bool:
    return "pressure" in (QUANTITIES.get(word), LETTERS.get(word))


def _joined(words: list[str]) -> list[str]:
    """The words, with pairs such as `load cell` joined and compounds divided."""
    made: list[str] = []
    for word in words:
        if made and word.isdigit() and made[-1] in words_known.NUMBERED:
            continue  # the number of an input is not a side
        if made and made[-1] + word in words_known.PAIRS:
            made[-1] += word
        elif made and made[-1] == "x" and QUANTITIES.get(word) == "spool":
            made[-1] = word
        else:
            made.append(word)
    return [part for word in made for part in _parts(word)]


def _parts(word: str) -> list[str]:
    """A compound such as `kolbendruck`, `rodpressure` or `pb` as its two words; any other word as it is."""
    if _is_known(word) or word in words_known.DENIED:
        return [word]
    if match := re.fullmatch(r"(p|q|pressure|druck|press)(a|b|s)", word):
        return [match[1], match[2]]
    for k in range(len(word) - 3, 2, -1):
        left, right = word[:k], word[k:]
        if any(right in several for several in words_known.COMPOUNDED):
            for stem in (left, left.removesuffix("s"), left.removesuffix("n")):
                if any(stem in several for several in words_known.STEMS):
                    return [stem, right]
    return [word]


def _is_known(word: str) -> bool:
    return word.isdigit() or any(word in several for several in words_known.EVERY)


def _agrees(quantity: str, known: Unit | None) -> bool:
    """Whether a symbol's quantity may be in a unit; units that any sensor may give are compatible with all."""
    if known is None or known.si in (_USUAL_UNITS[quantity], "%", "counts", "A"):
        return True
    return known.si == "V" and quantity in ("pressure", "position")


def _channels(named: list[str], objects: set[str], sides: set[str], si: str, is_wanted: bool) -> set[str]:
    """The channels that the words of a name mean together."""
    said = set(named)
    if "time" in said:
        return {"time"}
    if "tank" in objects or ("supply" in objects and said & {"voltage", "current"}):
        return set()
    if ("valve" in objects and (is_wanted or "command" in said)) or (is_wanted and "voltage" in said):
        return {"voltage_command"}
    if "spool" in said or ("position" in said and "valve" in objects):
        return {"voltage_command"} if is_wanted else {"spool"}
    for quantity, (own, channels) in _CHANNELS_OF_SIDES.items():
        if quantity in said or (not said and sides & {"a", "b"} and si == own):
            return _of_side(quantity, channels, objects, sides)
    return _without_side(said, objects, si)


def _of_side(quantity: str, channels: dict[str, str], objects: set[str], sides: set[str]) -> set[str]:
    """The channels of a pressure or a flow."""
    if quantity == "pressure" and objects & {"pump", "supply"} and not sides & {"a", "b"}:
        return {"supply_pressure"}
    found = {channels[side] for side in sides if side in channels}
    if not found and "cylinder" in objects and quantity == "pressure":
        return {"pressure_a"}  # of the piston's side, as in `Kolbendruck`
    return found if len(found) == 1 else set(channels.values())


def _without_side(said: set[str], objects: set[str], si: str) -> set[str]:
    """The channels of a quantity that a rig has once."""
    is_pump = "pump" in objects
    if "turning" in said or (is_pump and ("velocity" in said or si == "rad/s")):
        return {"pump_speed"}
    for quantities, channel in (
        ({"torque", "force"}, "force"), ({"position", "angle"}, "position"), ({"velocity"}, "velocity"),
    ):  # fmt: skip
        if said & quantities:
            return {channel}
    if said & {"current", "voltage", "command"}:
        return set() if is_pump else {"current"} if "current" in said else {"voltage_command"}
    if "valve" in objects:
        return {"current"} if si == "A" else {"voltage_command"}
    if "cylinder" in objects:
        return {"m": {"position"}, "m/s": {"velocity"}, "N": {"force"}, "": {"position"}}.get(si, set())
    return set()
