"""From marks to figures: shares with their intervals, by tier and noise, and against the stated targets."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from statistics import median

from eha_exam.reliability import APART, FEWEST, Bin, reliability
from eha_exam.scoring import Mark, Proportion
from eha_exam.tiers import MEANINGS, SETS

ROUNDING = 1e-9
"""An interval that ends at 1 may fall short of it by a last digit."""

Choice = Callable[[Mark], bool]


@dataclass(frozen=True)
class Row:
    """One line of the table: how a tool did on a group of cases."""

    group: str
    cases: int
    right: Proportion
    abstained: Proportion
    wrong: Proportion
    failed: Proportion
    site_right: Proportion
    median_seconds: float
    longest_seconds: float


@dataclass(frozen=True)
class Target:
    """A stated aim, what was reached, and whether that meets it.

    `met` is true or false only where the whole 95 % interval of what was reached says so, else None; `judged` says the
    same in a word: "yes", "no", "open", or "no case".
    """

    statement: str
    aim: str
    reached: str
    met: bool | None
    judged: str


@dataclass(frozen=True)
class Summary:
    """The score of one tool.

    `confusion`: what was named in place of what, and how often; `rightly`: how often each effect was named that was
    there. `by_noise`: the cases that are right, by tier and noise. `reliability`: stated against observed probability.
    """

    tool: str
    rows: tuple[Row, ...]
    targets: tuple[Target, ...]
    lost: tuple[Mark, ...]
    confusion: tuple[tuple[str, str, int], ...] = ()
    rightly: tuple[tuple[str, int], ...] = ()
    by_noise: tuple[tuple[str, float, Proportion], ...] = ()
    reliability: tuple[Bin, ...] = ()


def summarise(tool: str, marks: Sequence[Mark]) -> Summary:
    """The score of a tool from its marks."""
    groups: list[tuple[str, list[Mark]]] = [("all", list(marks))]
    for tier in MEANINGS:
        inside = [mark for mark in marks if mark.tier == tier]
        groups.append((tier, inside))
        if tier in ("single", "small"):
            groups += [
                (f"{tier}, noise {noise:g}x", [mark for mark in inside if mark.noise == noise]) for noise in (1, 3, 10)
            ]
    rows = tuple(_row(name, group) for name, group in groups if group)
    lost = tuple(mark for mark in marks if mark.outcome in ("wrong", "failed"))
    return Summary(
        tool,
        rows,
        tuple(_targets(marks)),
        lost,
        tuple(confusion(marks)),
        tuple(_rightly(marks)),
        tuple(_by_noise(marks)),
        tuple(reliability(marks)),
    )


def _by_noise(marks: Sequence[Mark]) -> Iterator[tuple[str, float, Proportion]]:
    noises = sorted({mark.noise for mark in marks})
    for tier in MEANINGS:
        for noise in noises:
            inside = [mark for mark in marks if (mark.tier, mark.noise) == (tier, noise)]
            if inside:
                yield tier, noise, _count(inside, lambda mark: mark.outcome == "right")


def _count(marks: Sequence[Mark], chosen: Choice) -> Proportion:
    return Proportion(sum(1 for mark in marks if chosen(mark)), len(marks))


def _of_sets(marks: Sequence[Mark]) -> list[tuple[str, float, Proportion]]:
    """The aims for several effects at once: statement, share asked, share reached."""
    pairs = [mark for mark in marks if mark.tier == "pair" and mark.decidable]
    three, rigs = ([mark for mark in marks if mark.tier == tier] for tier in ("three", "rig"))
    together = [mark for mark in marks if mark.tier == "recordings"]
    return [
        ("pairs exact", 0.95, _count(pairs, lambda mark: mark.outcome == "right")),
        ("three effects exact", 0.92, _count(three, lambda mark: mark.exact)),
        ("rigs exact", 0.80, _count(rigs, lambda mark: mark.exact)),
        ("two recordings with loads of their own exact", 0.80, _count(together, lambda mark: mark.exact)),
        ("decidable effects of rigs found", 0.95, _found(rigs)),
        ("`complete` stated correctly", 1.0, _count([mark for mark in marks if mark.truthful is not None], _truthful)),
    ]


def _truthful(mark: Mark) -> bool:
    return bool(mark.truthful)


def _holds_the_truth(mark: Mark) -> bool:
    return mark.collection is not None and mark.collection[1]


def _found(marks: Sequence[Mark]) -> Proportion:
    """Of the effects that can be seen beside the others, those that are named."""
    found = [effect in mark.named for mark in marks for effect in mark.seen]
    return Proportion(sum(found), len(found))


def _false_names(marks: Sequence[Mark]) -> Proportion:
    """Of the names given, those of nothing concealed."""
    return Proportion(sum(len(mark.false) for mark in marks), sum(len(mark.named) for mark in marks))


def confusion(marks: Sequence[Mark]) -> list[tuple[str, str, int]]:
    """What was named in place of what: (concealed and not named, named and not concealed, how often)."""
    counts: Counter[tuple[str, str]] = Counter()
    for mark in marks:
        missed = sorted(set(mark.seen or mark.concealed) - set(mark.named)) or ["nothing"]
        false = sorted(mark.false) or ["nothing"]
        counts.update((concealed, other) for concealed in missed for other in false if concealed != other)
    return [(concealed, other, count) for (concealed, other), count in counts.most_common()]


def _rightly(marks: Sequence[Mark]) -> list[tuple[str, int]]:
    """How often each effect was named that was there."""
    return Counter(name for mark in marks for name in sorted(set(mark.named) & set(mark.concealed))).most_common()


def _row(name: str, marks: Sequence[Mark]) -> Row:
    located = [mark for mark in marks if mark.site_right is not None]
    return Row(
        group=name,
        cases=len(marks),
        right=_count(marks, lambda mark: mark.outcome == "right"),
        abstained=_count(marks, lambda mark: mark.outcome == "abstained"),
        wrong=_count(marks, lambda mark: mark.outcome == "wrong"),
        failed=_count(marks, lambda mark: mark.outcome == "failed"),
        site_right=_count(located, lambda mark: bool(mark.site_right)),
        median_seconds=median(mark.seconds for mark in marks),
        longest_seconds=max(mark.seconds for mark in marks),
    )


def _shares(marks: Sequence[Mark]) -> list[tuple[str, float, Proportion]]:
    """The aims that ask for a share of at least so much: statement, share asked, share reached."""
    single = [mark for mark in marks if mark.tier == "single" and mark.decidable]
    ambiguous = [mark for mark in marks if mark.in_stated_set is not None]
    stated = [mark for mark in marks if mark.collection is not None]
    twins = [mark for mark in marks if mark.tier == "twins" and mark.decidable]
    outside = [mark for mark in marks if mark.tier == "outside" and mark.decidable]
    curves = [mark for mark in outside if mark.curve_r_squared is not None]
    fits = [mark for mark in marks if mark.outcome == "right" and mark.held_out_ratio is not None]
    right: Choice = lambda mark: mark.outcome == "right"  # noqa: E731 - one rule, used in several rows
    return [
        *(
            (
                f"single effect named, noise {noise:g}x",
                goal,
                _count([mark for mark in single if mark.noise == noise], right),
            )
            for noise, goal in ((1.0, 0.98), (3.0, 0.98), (10.0, 0.95))
        ),
        ("right site of single effects", 0.99, _count(single, lambda mark: bool(mark.site_right))),
        *_of_sets(marks),
        (
            "named from command and position",
            0.90,
            _count([mark for mark in marks if mark.tier == "position_only"], right),
        ),
        ("truth in the set stated as ambiguous", 0.99, _count(ambiguous, lambda mark: bool(mark.in_stated_set))),
        (
            "ambiguous cases that the prescribed test resolves",
            0.90,
            _count([mark for mark in ambiguous if mark.in_stated_set], lambda mark: bool(mark.resolved)),
        ),
        ("truth in the 95 % collection of sets", 0.95, _count(stated, _holds_the_truth)),
        ("twins said to be ambiguous", 0.99, _count(twins, right)),
        ("right site outside the catalogue", 0.95, _count(outside, lambda mark: bool(mark.site_right))),
        (
            "recovered curves with R^2 of 0.95",
            0.95,
            _count(curves, lambda mark: mark.curve_r_squared is not None and mark.curve_r_squared >= 0.95),
        ),
        (
            "held-out error within 1.1 times the noise",
            0.95,
            _count(fits, lambda mark: mark.held_out_ratio is not None and mark.held_out_ratio <= 1.1),
        ),
    ]


def _targets(marks: Sequence[Mark]) -> list[Target]:
    targets = [_at_least(statement, goal, reached) for statement, goal, reached in _shares(marks)]
    sets = [mark for mark in marks if mark.tier in SETS]
    small = [mark for mark in marks if mark.tier == "small"]
    null = [mark for mark in marks if mark.tier in ("null", "null_parameters")]
    held = [inside for mark in marks for inside in mark.intervals]
    nominal = [inside for mark in marks for inside in mark.nominal_intervals]
    targets += [
        _at_most("names in sets that are false", 0.02, _false_names(sets)),
        _at_most("small effects named wrongly", 0.01, _count(small, lambda mark: mark.outcome == "wrong")),
        _at_most("false discoveries with nothing missing", 0.01, _count(null, lambda mark: mark.discovery)),
        _covering("effects' parameters", held),
        _covering("nominal parameters", nominal),
        *(_as_stated(one) for one in reliability(marks) if one.observed.trials >= FEWEST),
    ]
    sizes = [mark.collection[0] for mark in marks if mark.collection is not None]
    if sizes:
        targets.append(_target("sets in the 95 % collection, median", "2", f"{median(sizes):g}", median(sizes) <= 2))
    if marks:
        seconds = [mark.seconds for mark in marks]
        for what, limit, reached in (("median", 10.0, median(seconds)), ("longest", 60.0, max(seconds))):
            statement = f"CPU seconds a recording, {what}"
            targets.append(_target(statement, f"{limit:g}", f"{reached:.1f}", reached <= limit))
    return targets


def _as_stated(one: Bin) -> Target:
    statement = f"names stated at {100 * one.low:g} to {100 * one.high:g} % that are true"
    aim = f"within {100 * APART:.0f} points of {100 * one.stated:.1f} %"
    return _within(statement, aim, one.observed, max(one.stated - APART, 0.0), min(one.stated + APART, 1.0))


def _target(statement: str, aim: str, reached: str, met: bool | None) -> Target:
    return Target(statement, aim, reached, met, {True: "yes", False: "no", None: "open"}[met])


def _within(statement: str, aim: str, reached: Proportion, least: float, most: float) -> Target:
    """A target that is met where the whole interval lies between two shares, and not met where all of it lies
    outside."""
    if not reached.trials:
        return Target(statement, aim, str(reached), None, "no case")
    low, high = reached.interval
    met = None
    if least <= low and high <= most:
        met = True
    elif high < least - ROUNDING or low > most + ROUNDING:
        met = False
    return _target(statement, aim, str(reached), met)


def _at_least(statement: str, goal: float, reached: Proportion) -> Target:
    aim = f"at least {100 * goal:.0f} %" if goal < 1.0 else "100 %"
    return _within(statement, aim, reached, goal, 1.0)


def _at_most(statement: str, goal: float, reached: Proportion) -> Target:
    return _within(statement, f"at most {100 * goal:.0f} %", reached, 0.0, goal)


def _covering(what: str, held: Sequence[bool]) -> Target:
    statement = f"95 % intervals of {what} that hold the truth"
    return _within(statement, "93 to 97 %", Proportion(sum(held), len(held)), 0.93, 0.97)
