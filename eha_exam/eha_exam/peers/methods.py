"""The methods: calibration alone, sparse regressions, a black box for the residual, and a trained network."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eha_exam.concealed import SITES
from eha_exam.errors import ExamError
from eha_exam.peers.equations import Equation, equations, left_over, read_signals
from eha_exam.peers.localising import CLEAR, Finding, localise
from eha_exam.peers.neural_screen import load, screen

Array = NDArray[np.float64]

THRESHOLDS = np.geomspace(0.02, 0.6, 14)
"""Candidates for STLSQ's threshold on standardised terms; the one with the lowest BIC is taken."""
MOST_TERMS = 3
"""Of one equation, for FROLS; the number with the lowest BIC is taken."""
WORTH = 10.0
"""BIC that the terms of an equation must gain over none: very strong evidence by the usual scale."""
PRICE = 30.0
"""BIC that each effect of the forward selection must gain beyond that of its terms: what the nominal terms leave is no
white noise, as BIC takes it for, and a lower price names more that is not there (on recordings that no result is stated
of)."""
MODELS = 50
INCLUDED = 0.8
"""Models of an ensemble, and the share of them that must use a term."""
FOLDS = 4
EXPLAINED = 0.3
"""Share of what the nominal terms leave that a black box must predict on blocks it has not seen."""


def diagnose(method: str, path: Path) -> dict[str, Any]:
    """The diagnosis of one recording by one method."""
    signals = read_signals(path)
    if method == "neural_screen":
        return screen(signals, load())
    return diagnose_rows(method, equations(signals))


def diagnose_rows(method: str, rows: Sequence[Equation]) -> dict[str, Any]:
    """The diagnosis of a recording's equations by a method that needs no more."""
    if method == "calibration":
        return _answer("parameters", [], [])
    if method == "black_box":
        shares = [(_predictable(row), row.site) for row in rows]
        best, site = max(shares)
        return _answer("unknown_physics" if best > EXPLAINED else "parameters", [], [site])
    if method == "forward_bic":
        return _named(forward_bic(rows))
    if method == "localising_regression":
        return _located([localise(row) for row in rows])
    with warnings.catch_warnings():
        # A threshold that leaves no term is one of those tried, and nothing to be warned of.
        warnings.simplefilter("ignore", UserWarning)
        named = [effect for row in rows for effect in _sparse(method.removeprefix("sindy_"), row)]
    return _named(list(dict.fromkeys(named)))


def _named(effects: list[str]) -> dict[str, Any]:
    return _answer("missing_physics" if effects else "parameters", effects, [SITES[name] for name in effects])


def _located(findings: Sequence[Finding]) -> dict[str, Any]:
    """Names that have no rival in a balance; where all have, the sets that they and their rivals make; where there is
    no name, the balance in which all terms together explain a clear share."""
    findings = sorted(findings, key=lambda one: one.explained, reverse=True)
    rivals = dict(pair for one in reversed(findings) for pair in zip(one.terms, one.rivals, strict=True))
    named = list(dict.fromkeys(name for one in findings for name in one.terms))
    if not named:
        clearest = max(findings, key=lambda one: one.explained_by_all)
        found = clearest.explained_by_all > CLEAR
        return _answer("unknown_physics" if found else "parameters", [], [clearest.site])
    sets = [[other if one == name else one for one in named] for name in named for other in rivals[name]]
    answer = _answer("ambiguous" if sets else "missing_physics", named, [SITES[name] for name in named])
    return answer | {"alternatives": [{"effects": names} for names in sets]}


def _answer(verdict: str, effects: list[str], sites: list[str]) -> dict[str, Any]:
    unknown = {"site": sites[0], "function_of": "", "samples": []} if verdict == "unknown_physics" else None
    return {
        "schema": "eha.diagnosis/1",
        "verdict": verdict,
        "location": [{"site": site} for site in sites],
        "effects": [{"id": name, "site": SITES[name], "parameters": {}} for name in effects],
        "unknown": unknown,
    }


def _sparse(method: str, row: Equation) -> list[str]:
    """Effects that a sparse regression finds in one equation."""
    target, terms = left_over(row)
    found = {"stlsq": _stlsq, "frols": _frols, "ensemble": _ensemble}[method](target, terms)
    if _bic(target, terms, np.zeros(len(found), dtype=bool)) - _bic(target, terms, found) < WORTH:
        return []
    return [name for name, used in zip(row.effects, found, strict=True) if used]


def forward_bic(rows: Sequence[Equation]) -> list[str]:
    """Effects that are taken in or dropped one at a time, in all equations that have a term for them at once, as long
    as that lowers the sum of their BIC, in which each effect costs PRICE."""
    left = [left_over(row) for row in rows]
    names = list(dict.fromkeys(name for row in rows for name in row.effects))

    def cost(chosen: list[str]) -> float:
        pairs = zip(left, rows, strict=True)
        return PRICE * len(chosen) + sum(_bic(*terms, np.isin(row.effects, chosen)) for terms, row in pairs)

    chosen: list[str] = []
    while True:
        changed = [[*chosen, one] if one not in chosen else [n for n in chosen if n != one] for one in names]
        best = min(changed, key=cost)
        if cost(best) >= cost(chosen):
            return chosen
        chosen = best


def _bic(target: Array, terms: Array, used: NDArray[np.bool_]) -> float:
    """Bayesian information criterion; neighbouring bumps overlap, so a third of the rows counts as independent."""
    left = target - terms[:, used] @ np.linalg.lstsq(terms[:, used], target, rcond=None)[0]
    count = len(target) / 3.0
    return float(count * np.log(left @ left + 1e-300) + np.count_nonzero(used) * np.log(count))


def _best(target: Array, terms: Array, proposals: list[NDArray[np.bool_]]) -> NDArray[np.bool_]:
    return min(proposals, key=lambda used: _bic(target, terms, used))


def _pysindy() -> Any:
    try:
        import pysindy
    except ImportError:
        raise ExamError("the sindy methods need the package `pysindy`; install it, or leave --peers out") from None
    return pysindy


def _stlsq(target: Array, terms: Array) -> NDArray[np.bool_]:
    fits = [_pysindy().STLSQ(threshold=value, alpha=1e-6).fit(terms, target[:, None]) for value in THRESHOLDS]
    return _best(target, terms, [np.asarray(fit.coef_[0] != 0.0) for fit in fits])


def _frols(target: Array, terms: Array) -> NDArray[np.bool_]:
    fits = [_pysindy().FROLS(max_iter=count).fit(terms, target[:, None]) for count in range(1, MOST_TERMS + 1)]
    return _best(target, terms, [np.asarray(fit.coef_[0] != 0.0) for fit in fits])


def _ensemble(target: Array, terms: Array) -> NDArray[np.bool_]:
    generator = np.random.default_rng(0)
    counts = np.zeros(terms.shape[1])
    for _ in range(MODELS):
        rows = generator.integers(0, len(target), len(target))
        fit = _pysindy().STLSQ(threshold=0.1, alpha=1e-6).fit(terms[rows], target[rows, None])
        counts += fit.coef_[0] != 0.0
    return np.asarray(counts >= INCLUDED * MODELS)


def _predictable(row: Equation) -> float:
    """Share of what the nominal terms leave that gradient boosting predicts on blocks of time it was not fitted to."""
    try:
        from sklearn.ensemble import HistGradientBoostingRegressor
    except ImportError:
        raise ExamError("the black box needs the package `scikit-learn`; install it, or leave --peers out") from None
    target, _ = left_over(row)
    blocks = (np.arange(len(target)) * 5 * FOLDS // len(target)) % FOLDS
    errors = np.zeros_like(target)
    for fold in range(FOLDS):
        seen = blocks != fold
        model = HistGradientBoostingRegressor(max_iter=40, min_samples_leaf=10, random_state=0)
        model.fit(row.features[seen], target[seen])
        errors[~seen] = target[~seen] - model.predict(row.features[~seen])
    return 1.0 - float(errors @ errors) / float(target @ target)
