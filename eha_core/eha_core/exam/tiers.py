"""The exam's tiers, their shares of an exam, and which cases an exam of a given length holds."""

from __future__ import annotations

from eha_core.errors import EhaError

SHARES = {
    "single": 0.24,
    "small": 0.09,
    "other_law": 0.06,
    "pair": 0.10,
    "null": 0.06,
    "null_parameters": 0.09,
    "tracking": 0.06,
    "window": 0.05,
    "position_only": 0.06,
    "outside": 0.06,
    "wrong_rig": 0.05,
    "refit": 0.04,
    "twins": 0.04,
}
"""Share of each tier in an exam of all tiers."""

MEANINGS = {
    "single": "one effect of normal size, nominal parameters up to 30 % off",
    "small": "one effect of 15 % of that size",
    "other_law": "one effect that follows another published law than the catalogue's",
    "pair": "two effects",
    "null": "nothing missing, nominal parameters exact",
    "null_parameters": "nothing missing, nominal parameters up to 30 % off",
    "tracking": "one effect under a tight position controller, which hides it in command and pressure",
    "window": "one effect that acts during a part of the recording",
    "position_only": "one effect, command and position recorded alone",
    "outside": "one effect that the catalogue does not know",
    "wrong_rig": "one effect, and supply pressure and valve dynamics up to 15 % off too",
    "refit": "one effect, hidden by nominal parameters that were re-tuned on the recording",
    "twins": "one effect that the recording cannot tell from another; right is to say so",
}


def check_tier(tier: str) -> None:
    """EhaError when there is no such tier."""
    if tier not in SHARES:
        raise EhaError(f"tier {tier!r} is none of the exam's; give one of {', '.join(SHARES)}")


def plan(cases: int, tier: str | None = None) -> list[tuple[str, int]]:
    """(tier, number) of each case of an exam; a shorter exam is the beginning of a longer one."""
    if tier is not None:
        check_tier(tier)
        return [(tier, number) for number in range(cases)]
    counts = dict.fromkeys(SHARES, 0)
    members = []
    for index in range(cases):
        furthest_behind = max(SHARES, key=lambda name: SHARES[name] * (index + 1) - counts[name])
        members.append((furthest_behind, counts[furthest_behind]))
        counts[furthest_behind] += 1
    return members
