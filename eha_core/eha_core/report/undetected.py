"""Upper limits of effects that were not named: a line for the terminal and the first screen, and the report's table."""

from __future__ import annotations

from collections.abc import Iterator

from eha_core.diagnosis.result import Detectable, Diagnosis, Noticeable
from eha_core.effects import effect_title
from eha_core.quantities import quantity
from eha_core.report.detectability import doubts
from eha_core.report.stage import Table, adds_physics
from eha_core.report.wording import channel_title, words

MENTIONED = ("internal_leakage", "external_leakage", "coulomb_friction", "constant_load")
"""The effects in the line: the leaks, friction and loads that matter first on a bench; the table has all."""


def not_missing(diagnosis: Diagnosis) -> str:
    """The upper limits of MENTIONED effects that were not named; why they are not known; or empty."""
    if diagnosis.undetected is None:
        return _why_not(diagnosis)
    sizes = [f"{title} {size}" for title, size in _mentioned(diagnosis)]
    more = "nothing else is missing" if adds_physics(diagnosis) else "nothing is missing"
    return f"{more}, or below (95 %): {', '.join(sizes)}" if sizes else ""


def _why_not(diagnosis: Diagnosis) -> str:
    """Why no upper limits are known; empty where the residual is noise or not known."""
    explained = diagnosis.explained
    if explained.complete or explained.vague or not explained.times_noise:
        return ""
    name, most = max(explained.times_noise.items(), key=lambda item: item[1])
    return (
        f"upper limits of further effects are not known, because the residual is up to {most:.3g} times the noise, in"
        f" {channel_title(name)}"
    )


def _mentioned(diagnosis: Diagnosis) -> Iterator[tuple[str, str]]:
    """Title and size of each of MENTIONED; of one with several sizes the largest."""
    found = diagnosis.undetected
    assert found is not None, "the caller has looked"
    every: list[Detectable | Noticeable] = [*found.effects, *found.parameters]
    for name in MENTIONED:
        rows = [row for row in every if _name(row) == name]
        sized = [(row, size) for row in rows if (size := _size(row)) is not None]
        if rows and len(sized) == len(rows):
            row, _ = max(sized, key=lambda pair: pair[1])
            yield effect_title(name), _leak(row) or quantity(_size(row) or 0.0, row.unit)


def _name(row: Detectable | Noticeable) -> str:
    return row.effect if isinstance(row, Detectable) else row.name


def _size(row: Detectable | Noticeable) -> float | None:
    return row.size if isinstance(row, Detectable) else row.change


def _leak(row: Detectable | Noticeable) -> str:
    return quantity(row.flow, "m^3/s") if row.flow else ""


def undetected_tables(diagnosis: Diagnosis) -> tuple[Table, ...]:
    """Tables of the smallest detectable sizes of effects that were not named and of parameter changes."""
    found = diagnosis.undetected
    if found is None:
        return ()
    effects = tuple(
        (f"{effect_title(row.effect)}, {words(row.parameter)}", _shown(row.size, row.unit), _leak(row), doubts(row))
        for row in found.effects
    )
    parameters = tuple(
        (words(row.name), _shown(row.change, row.unit), _leak(row), f"nominal {quantity(row.nominal, row.unit)}")
        for row in found.parameters
    )
    sure = f"with {100.0 * found.power:.0f} % probability"
    headings = ("as a leak", "")
    return (
        Table(("effect", "smallest size", *headings), effects, f"Not missing, or below: found {sure}"),
        Table(("parameter", "smallest change", *headings), parameters, f"Not changed, or by less: reported {sure}"),
    )


def _shown(size: float | None, unit: str) -> str:
    return "not found at any size" if size is None else quantity(size, unit)
