"""The exam's tiers, their shares of an exam, and which cases an exam of a given length holds."""

from __future__ import annotations

from eha_exam.errors import ExamError, remedy

SHARES = {
    "single": 0.18,
    "small": 0.05,
    "other_law": 0.05,
    "pair": 0.12,
    "three": 0.10,
    "rig": 0.10,
    "recordings": 0.03,
    "named_and_unknown": 0.03,
    "null": 0.05,
    "null_parameters": 0.07,
    "tracking": 0.05,
    "window": 0.04,
    "position_only": 0.04,
    "outside": 0.03,
    "wrong_rig": 0.03,
    "refit": 0.015,
    "twins": 0.015,
    "event": 0.0,
}
"""Share of each tier in an exam of all tiers; one without a share is asked by its name."""

SETS = ("pair", "three", "rig", "recordings")
"""Tiers that conceal several effects of the catalogue at once."""

MEANINGS = {
    "single": "one effect of normal size, nominal parameters up to 30 % off",
    "small": "one effect of 15 % of that size",
    "other_law": "one effect that follows another published law than the catalogue's",
    "pair": "two effects",
    "three": "three effects",
    "rig": "four to six effects: dry friction, valve, supply, load, sensor and leakage together",
    "recordings": "two recordings of a rig with two effects and a load that differs between them",
    "named_and_unknown": "one effect of the catalogue, and one law that it does not know",
    "null": "nothing missing, nominal parameters exact",
    "null_parameters": "nothing missing, nominal parameters up to 30 % off",
    "tracking": "one effect under a tight position controller, which hides it in command and pressure",
    "window": "one effect that acts during a part of the recording",
    "event": "one effect that acts during a part of the recording, beside one or two that always act",
    "position_only": "one effect, command and position recorded alone",
    "outside": "one effect that the catalogue does not know",
    "wrong_rig": "one effect, and supply pressure and valve dynamics up to 15 % off too",
    "refit": "one effect, hidden by nominal parameters that were re-tuned on the recording",
    "twins": "one effect that the recording cannot tell from another; right is to say so",
}


def check_tier(tier: str) -> None:
    """ExamError when there is no such tier."""
    if tier not in SHARES:
        raise ExamError(f"tier {tier!r} is none of the exam's; {remedy(tier, SHARES)}")


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
