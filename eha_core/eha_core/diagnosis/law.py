"""An unknown law as an expression: of a recovered curve, or regressed on the equation residuals.

The weak form needs no simulation: an equation's missing part is regressed on functions of the measured states. These
are integrated with the same test functions and made orthogonal to the equation's own terms, so that the coefficients
are those of the law itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from eha_core.curve import KNOTS
from eha_core.diagnosis.criteria import BETTER_LAW, EXPRESSED, SIMPLE_FORMULA, VIOLATED, WORTH_A_FORMULA
from eha_core.diagnosis.result import UnknownLaw
from eha_core.identification.numbers import Array
from eha_core.weak_form.equation_residuals import EquationResidual
from eha_core.weak_form.library import best_wave, powers, searched
from eha_core.weak_form.terms import RegressionData, Sum, Term, sparsest

PERIODIC = (0.5, 10.0)
"""Hz; frequencies searched for a periodic force over time."""

FEWEST_WAVES = 1.5
"""Fewest cycles over the range of the variable: fewer cannot be distinguished from a power."""

MOST_WAVES = 0.25
"""Most cycles per knot of a curve: a wave needs four knots."""

MOST_RIPPLES = 15.0
"""Most cycles over the variable's range that are sought in a residual."""

OWN = 1e-4
"""A function counts as a combination of the equation's own terms if at most this share of it is orthogonal to them."""

REVERSING = 0.05
"""Width of the reversal of direction, in standard deviations of the speed."""

DRAWN = 800
"""Samples of an expression's curve: eight per cycle at 5 Hz over 20 s."""

OVERLAP = 2.0
"""Neighbouring test functions overlap: so many of them count as one independent row (assumed)."""

SYMBOLS = {
    "position": ("x", "m"),
    "velocity": ("v", "m/s"),
    "pressure difference": ("(P1 - P2)", "Pa"),
    "spool position": ("x_v", "A"),
    "time": ("t", "s"),
}
"""How each variable is written, and its unit."""

UNITS = {"force": "N", "chamber": "m^3/s", "orifice": "A"}
"""Unit of a law at each site: force on the piston, flow from chamber A to B, opening of the valve."""


DIRECTION = "direction of motion"


@dataclass(frozen=True)
class Expression:
    """A formula with its units, empty where nothing simple is good enough, and the R^2 that it reaches."""

    text: str
    r_squared: float


@dataclass(frozen=True)
class Form:
    """A kind of law: at a site, a function of one variable, times another if `times` is not empty."""

    site: str
    variable: str
    times: str = ""

    @property
    def title(self) -> str:
        """The form in an engineer's words."""
        return f"{self.variable}, times {self.times}" if self.times else self.variable


FORMS = (
    Form("force", "position"),
    Form("force", "velocity"),
    Form("force", "time"),
    Form("force", "position", "velocity"),
    Form("force", "position", DIRECTION),
    Form("force", "pressure difference", DIRECTION),
    Form("chamber", "pressure difference"),
    Form("orifice", "spool position"),
    Form("chamber", "position", "pressure difference"),
)
"""The forms of law that are sought, simpler ones first. A force over the pressure difference is not one of them: the
force balance has that term, with a free coefficient."""


def express(x: Array, y: Array, name: str, unit_y: str) -> Expression:
    """The simplest expression of a curve y(x) over the variable `name`, one of SYMBOLS; y in `unit_y`, x in SI.

    Its text is empty with fewer than eight points, or where no simple expression reaches an R^2 of SIMPLE_FORMULA.
    """
    total = float(np.sum((y - y.mean()) ** 2)) if len(y) else 0.0
    if len(x) < 8 or not total > 0.0:
        return Expression("", 0.0)
    symbol, unit = SYMBOLS[name]
    data = RegressionData(x, y, lambda values: values, total, float(len(x)))
    reach = float(np.ptp(x))
    waves = (FEWEST_WAVES / reach, MOST_WAVES * len(x) / reach)
    found = sparsest(data, _library(data, name, waves))
    if found.r_squared < SIMPLE_FORMULA:
        return Expression("", max(found.r_squared, 0.0))
    return Expression(f"{found.written()} [{unit_y}], {symbol.strip('()')} in {unit}", found.r_squared)


def _library(data: RegressionData, name: str, waves: tuple[float, float]) -> tuple[Term, ...]:
    """The terms that a law over a variable may have; over time only periodic ones, since others would fit drift."""
    symbol = SYMBOLS[name][0]
    if name == "time":
        return (powers(symbol)[0], best_wave(data, symbol, *waves, pitch=False))
    return (*powers(symbol), *searched(data, symbol), best_wave(data, symbol, *waves, pitch=True))


def weak_law(alternatives: Sequence[Sequence[EquationResidual]]) -> UnknownLaw | None:
    """The law that explains most of the equation residuals; None where the equations hold, or no law explains them.

    `alternatives`: for each model, the residual of the force balance, then those of the chambers. A law is sought in
    each of them, and the one with the smallest residual is returned.
    """
    best: UnknownLaw | None = None
    most = 0.0
    for form in FORMS:
        parts = [residuals[:1] if form.site == "force" else residuals[1:] for residuals in alternatives]
        sides = [part for part in parts if part]
        energies = [float(np.mean([residual.chi_square for residual in chosen])) for chosen in sides]
        # explained chi^2 is compared, not R^2, so that the most violated equation comes first
        lacking = min(energies, default=0.0)
        if lacking < VIOLATED:
            continue
        for chosen, energy in zip(sides, energies, strict=True):
            law = _law(form, chosen, WORTH_A_FORMULA * most / energy)
            explained = lacking - 1.0 - (energy - 1.0) * (1.0 - law.r_squared) if law else 0.0
            if explained > most + BETTER_LAW * lacking:
                best, most = law, explained
    return best


def _law(form: Form, residuals: Sequence[EquationResidual], least_share: float = 0.0) -> UnknownLaw | None:
    """The best law of a form, as an expression if that is as good as the curve; None if it explains too little."""
    data = _regression_data(form, residuals)
    reach = float(np.ptp(data.at))
    if not reach > 0.0:
        return None
    curve, share = _curve(data) if form.variable != "time" else ((), 0.0)
    if form.variable != "time" and share < least_share:
        return None
    waves = PERIODIC if form.variable == "time" else (FEWEST_WAVES / reach, MOST_RIPPLES / reach)
    found = sparsest(data, _library(data, form.variable, waves))
    if not found.terms and share <= 0.0:
        return None
    beyond = data.total / max(data.total - len(data.seen), 1.0)
    explained, drawn = min(found.r_squared * beyond, 1.0), min(share * beyond, 1.0)
    if explained < SIMPLE_FORMULA * drawn:
        return UnknownLaw(form.site, form.title, "", drawn, curve)
    text = _text(form, found) if explained >= EXPRESSED else ""
    return UnknownLaw(form.site, form.title, text, explained, _drawn(data, found))


def _regression_data(form: Form, residuals: Sequence[EquationResidual]) -> RegressionData:
    """The residuals as observations of the form's function, in units of noise."""
    bases = [np.linalg.qr(residual.terms)[0] for residual in residuals]
    factors = [_factor(form, residual) / residual.noise for residual in residuals]

    def rows(values: Array) -> Array:
        return np.concatenate(
            [
                _freed(residual.grid.average(values * factor), basis)
                for residual, factor, basis in zip(residuals, factors, bases, strict=True)
            ],
            axis=-1,
        )

    seen = np.concatenate([residual.missing / residual.noise for residual in residuals])
    at = residuals[0].states[form.variable]
    return RegressionData(at, seen, rows, float(seen @ seen), len(seen) / OVERLAP)


def _freed(rows: Array, basis: Array) -> Array:
    """Rows (..., n) made orthogonal to the equation's own terms; zero where they are combinations of these."""
    left = rows - (rows @ basis) @ basis.T
    kept = np.linalg.norm(left, axis=-1, keepdims=True) > OWN * np.linalg.norm(rows, axis=-1, keepdims=True)
    return np.asarray(np.where(kept, left, 0.0))


def _factor(form: Form, residual: EquationResidual) -> Array | float:
    """The factor of the form's function in a residual: one number, or one for each sample."""
    into = {"continuity_a": -1.0, "continuity_b": 1.0}.get(residual.equation, 1.0)
    if form.site == "orifice":
        return residual.states["flow_an_ampere"]
    if not form.times:
        return into
    if form.times == DIRECTION:
        speed = residual.states["velocity"]
        return into * np.asarray(np.tanh(speed / (REVERSING * float(np.std(speed)) or 1.0)))
    return into * residual.states[form.times]


def _curve(data: RegressionData) -> tuple[tuple[tuple[float, float], ...], float]:
    """The function as a curve through evenly spaced knots, and its adjusted R^2."""
    low, high = np.quantile(data.at, [0.002, 0.998])
    places = np.linspace(low, high, KNOTS)
    away = np.abs(np.clip(data.at, low, high) - places[:, None])
    columns = data.rows(np.maximum(1.0 - away * (KNOTS - 1) / (high - low), 0.0)).T
    heights, *_ = np.linalg.lstsq(columns, data.seen, rcond=1e-3)
    left = data.seen - columns @ heights
    freedom = (data.independent - 1.0) / max(data.independent - KNOTS, 1.0)
    share = 1.0 - float(left @ left) / data.total * freedom
    samples = zip(places, heights, np.linalg.norm(columns, axis=0) > 0.0, strict=True)
    return tuple((float(place), float(height)) for place, height, known in samples if known), share


def _drawn(data: RegressionData, found: Sum) -> tuple[tuple[float, float], ...]:
    """DRAWN samples of an expression over the visited range."""
    low, high = np.quantile(data.at, [0.002, 0.998])
    places = np.linspace(low, high, DRAWN)
    return tuple(zip(places.tolist(), found.values(places).tolist(), strict=True))


def _text(form: Form, found: Sum) -> str:
    """The expression with the units of its value and of its variables."""
    variables = [form.variable, *([form.times] if form.times else [])]
    times = "sign(v)" if form.times == DIRECTION else SYMBOLS[form.times][0] if form.times else ""
    units = [
        f"{symbol.strip('()')} in {unit}"
        for symbol, unit in (SYMBOLS[variable] for variable in variables if variable in SYMBOLS)
    ]
    return f"{found.written(times)} [{UNITS[form.site]}], {', '.join(units)}"
