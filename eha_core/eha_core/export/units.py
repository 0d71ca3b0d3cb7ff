"""Units of the catalogue in powers of SI's base units, as FMI states them."""

from __future__ import annotations

import re
from collections import Counter

BASES: dict[str, dict[str, int]] = {
    "m": {"m": 1}, "kg": {"kg": 1}, "s": {"s": 1}, "A": {"A": 1}, "rad": {"rad": 1},
    "N": {"kg": 1, "m": 1, "s": -2}, "Pa": {"kg": 1, "m": -1, "s": -2}, "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "ohm": {"kg": 1, "m": 2, "s": -3, "A": -2}, "H": {"kg": 1, "m": 2, "s": -2, "A": -2}, "1": {},
}  # fmt: skip


def base_unit(unit: str) -> dict[str, int] | None:
    """Exponents of the base units of a unit such as "m^3/(s Pa)"; None of one with roots, which FMI cannot state."""
    above, _, below = unit.partition("/")
    powers: Counter[str] = Counter()
    for text, sign in ((above, 1), (below.strip("()"), -1)):
        for symbol, power in re.findall(r"([A-Za-z1]+)(?:\^(\S+))?", text):
            if symbol not in BASES or not re.fullmatch(r"-?\d*", power):
                return None
            for base, exponent in BASES[symbol].items():
                powers[base] += sign * exponent * int(power or 1)
    return {base: power for base, power in powers.items() if power}
