"""The methods: calibration alone, PySINDy's sparse regressions, and a black box for the residual."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eha_exam.concealed import SITES
from eha_exam.errors import ExamError
from eha_exam.peers.equations import Equation, equations, read_signals

Array = NDArray[np.float64]

THRESHOLDS = np.geomspace(0.02, 0.6, 14)
"""Candidates for STLSQ's threshold on standardised terms; the one with the lowest BIC is taken."""
MOST_TERMS = 3
"""Of one equation, for FROLS; the number with the lowest BIC is taken."""
WORTH = 10.0
"""BIC that the terms of an equation must gain over none: very strong evidence by the usual scale."""
MODELS = 50
INCLUDED = 0.8
"""Models of an ensemble, and the share of them that must use a term."""
FOLDS = 4
EXPLAINED = 0.3
"""Share of what the nominal terms leave that a black box must predict on blocks it has not seen."""


def diagnose(method: str, path: Path) -> dict[str, Any]:
    """The diagnosis of one recording by one method."""
    rows = equations(read_signals(path))
    if method == "calibration":
        return _answer("parameters", [], [])
    if method == "black_box":
        shares = [(_predictable(row), row.site) for row in rows]
        best, site = max(shares)
        return _answer("unknown_physics" if best > EXPLAINED else "parameters", [], [site])
    with warnings.catch_warnings():
        # A threshold that leaves no term is one of those tried, and nothing to be warned of.
        warnings.simplefilter("ignore", UserWarning)
        named = [effect for row in rows for effect in _sparse(method.removeprefix("sindy_"), row)]
    effects = list(dict.fromkeys(named))
    return _answer("missing_physics" if effects else "parameters", effects, [SITES[name] for name in effects])


def _answer(verdict: str, effects: list[str], sites: list[str]) -> dict[str, Any]:
    unknown = {"site": sites[0], "function_of": "", "samples": []} if verdict == "unknown_physics" else None
    return {
        "schema": "eha.diagnosis/1",
        "verdict": verdict,
        "location": [{"site": site} for site in sites],
        "effects": [{"id": name, "site": SITES[name], "parameters": {}} for name in effects],
        "unknown": unknown,
    }


def _left_over(row: Equation) -> tuple[Array, Array]:
    """What the nominal terms leave of the target and of the candidates, all of unit length."""
    stacked = np.column_stack([row.target, row.candidates])
    left = stacked - row.nominal @ np.linalg.lstsq(row.nominal, stacked, rcond=None)[0]
    left /= np.linalg.norm(left, axis=0) + 1e-300
    return left[:, 0], left[:, 1:]


def _sparse(method: str, row: Equation) -> list[str]:
    """Effects that a sparse regression finds in one equation."""
    target, terms = _left_over(row)
    found = {"stlsq": _stlsq, "frols": _frols, "ensemble": _ensemble}[method](target, terms)
    if _bic(target, terms, np.zeros(len(found), dtype=bool)) - _bic(target, terms, found) < WORTH:
        return []
    return [name for name, used in zip(row.effects, found, strict=True) if used]


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
    target, _ = _left_over(row)
    blocks = (np.arange(len(target)) * 5 * FOLDS // len(target)) % FOLDS
    errors = np.zeros_like(target)
    for fold in range(FOLDS):
        seen = blocks != fold
        model = HistGradientBoostingRegressor(max_iter=40, min_samples_leaf=10, random_state=0)
        model.fit(row.features[seen], target[seen])
        errors[~seen] = target[~seen] - model.predict(row.features[~seen])
    return 1.0 - float(errors @ errors) / float(target @ target)
