"""Terms in which an engineer would write a law of one variable; those with an inner parameter are searched."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import exp, log, pi

import numpy as np
from scipy.optimize import minimize

from eha_core.weak_form.terms import RegressionData, Term, fitted, number, signed

WIDTHS = (0.003, 0.01, 0.03, 0.1, 0.3)
"""Widths of a smooth step that are tried, as shares of the largest value of the variable."""

BELLS = (0.05, 0.1, 0.2, 0.4)
"""Widths of a bell that are tried, as shares of the range."""

PLACES = np.linspace(0.1, 0.9, 17)
"""Places of a contact or a bell that are tried, as shares of the range."""

EVALUATIONS = 40
"""Evaluations that refine a term's inner parameters: a simplex ends within a thousandth of its first step."""

FREQUENCY_STEP = 0.2
"""Step between the frequencies that are tried, in cycles over the range: a peak is about one wide."""


def powers(symbol: str) -> tuple[Term, ...]:
    """The terms without an inner parameter: constant, powers, drag, and the root of turbulent flow."""
    bare = symbol.strip("()")
    return (
        Term("1", (np.ones_like,)),
        Term(symbol, (lambda z: z,)),
        Term(f"|{bare}|", (np.abs,)),
        Term(f"{symbol} |{bare}|", (lambda z: z * np.abs(z),)),
        Term(f"{symbol}^2", (np.square,)),
        Term(f"{symbol}^3", (lambda z: z**3,)),
        Term(f"sqrt|{bare}| sign({bare})", (lambda z: np.sign(z) * np.sqrt(np.abs(z)),)),
    )


def searched(data: RegressionData, symbol: str) -> tuple[Term, ...]:
    """A smooth sign, a contact and a bell, each with the parameters that explain most."""
    low, reach = float(np.min(data.at)), float(np.ptp(data.at))
    largest = float(np.max(np.abs(data.at)))
    places = [low + share * reach for share in PLACES]

    def smooth_sign(logarithm: float) -> Term:
        width = exp(logarithm)
        return Term(f"tanh({symbol} / {number(width)})", (lambda z: np.tanh(z / width),), 1)

    def contact(place: float) -> Term:
        return Term(f"max({symbol} {signed(-place)}, 0)", (lambda z: np.maximum(z - place, 0.0),), 1)

    def bell(place: float, logarithm: float) -> Term:
        width = exp(logarithm)
        text = f"exp(-(({symbol} {signed(-place)}) / {number(width)})^2)"
        return Term(text, (lambda z: np.exp(-(((z - place) / width) ** 2)),), 2)

    bells = [(place, log(share * reach)) for place in places for share in BELLS]
    return (
        _best(data, symbol, smooth_sign, [(log(share * largest),) for share in WIDTHS], (0.5,)),
        _best(data, symbol, contact, [(place,) for place in places], (0.02 * reach,)),
        _best(data, symbol, bell, bells, (0.02 * reach, 0.2)),
    )


def best_wave(data: RegressionData, symbol: str, slowest: float, fastest: float, pitch: bool) -> Term:
    """The sine whose frequency explains most: the refined peak of the periodogram.

    `slowest` and `fastest`: cycles per unit of the variable. `pitch`: write the wavelength instead of the frequency.
    """

    def wave(frequency: float) -> Term:
        turns = 2.0 * pi * frequency
        text = f"2π {symbol} / {number(1.0 / frequency)}" if pitch else f"2π·{number(frequency)} {symbol}"
        return Term(text, (lambda z: np.sin(turns * z), lambda z: np.cos(turns * z)), 1)

    step = FREQUENCY_STEP / float(np.ptp(data.at))
    return _best(
        data,
        symbol,
        wave,
        [(float(frequency),) for frequency in np.arange(slowest, fastest + step, step)],
        (0.3 * step,),
    )


def _best(
    data: RegressionData,
    symbol: str,
    family: Callable[..., Term],
    starts: Iterable[tuple[float, ...]],
    steps: tuple[float, ...],
) -> Term:
    """The member of a family that explains most together with a constant and a line: the best start, refined."""
    beside = powers(symbol)[:2]

    def criterion(numbers: Sequence[float]) -> float:
        return fitted(data, [*beside, family(*(float(value) for value in numbers))]).criterion

    start = min(starts, key=criterion)
    simplex = np.array(start) + np.vstack([np.zeros(len(start)), np.diag(steps)])
    exact = minimize(
        criterion, start, method="Nelder-Mead", options={"initial_simplex": simplex, "maxfev": EVALUATIONS}
    )
    return family(*(float(value) for value in exact.x))
