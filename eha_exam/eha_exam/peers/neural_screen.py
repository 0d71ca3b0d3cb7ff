"""A small neural network that was trained on recordings of the exam's own simulator, and names what it has seen there.

Its inputs are figures of the shared regression, its outputs one probability for each effect and for an unknown law of
each site. scikit-learn trains it; the weights are matrices in a file, and NumPy evaluates them.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations, islice
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from eha_exam.case import Arrays, Case
from eha_exam.concealed import SITES
from eha_exam.drawing import draw_case
from eha_exam.errors import ExamError
from eha_exam.measuring import measure, simulate_case
from eha_exam.peers.equations import Array, Signals, equations, left_over, signals_of
from eha_exam.tiers import plan
from eha_exam.truth.record import CATALOGUE, OUTSIDE

WEIGHTS = Path(__file__).with_name("neural_screen.npz")
UNKNOWN = {"unknown force": "force", "unknown chamber": "chamber"}
"""What laws in no catalogue are called, and their sites."""
LABELS = (*CATALOGUE, *UNKNOWN)

CASES = 300
SEED = 5050
"""What the weights that come with the exam were trained on. The seed is no exam's by default, and no results of it are
stated."""
UNSUITABLE = ("position_only", "refit", "twins")
"""Tiers that the network does not learn from: without pressures, or made with an oracle."""
HIDDEN = 32
"""Neurons of the hidden layer."""
PENALTY = 1.0
"""Weight of the squared weights; with ROUNDS and SURE cross-validated on the recordings of the training."""
ROUNDS = 1000
"""Passes over the examples at most."""
LAGS = (1, 6, 25)
"""Rows by which what is left over is compared with itself later."""
LARGEST = 3.0
"""Where figures without a bound are cut."""
SURE = 0.2
"""Probability that a set of names must have to be stated alone."""
OPEN = 5
"""Names that may go either way in the sets that are compared: those whose probability is nearest to a half."""
STATED = 3
"""Sets that are stated where none is sure."""


@dataclass(frozen=True)
class Network:
    """A network of one hidden layer: inputs standardised by `mean` and `scale`, rectified, and logistic outputs."""

    mean: Array
    scale: Array
    first: Array
    first_bias: Array
    second: Array
    second_bias: Array

    def probabilities(self, inputs: Array) -> Array:
        """Probability of each of LABELS (n, labels), for inputs (n, k)."""
        hidden = np.maximum((inputs - self.mean) / self.scale @ self.first + self.first_bias, 0.0)
        return np.asarray(1.0 / (1.0 + np.exp(-(hidden @ self.second + self.second_bias))))

    def save(self, path: Path) -> None:
        """Write the matrices as NumPy's archive."""
        np.savez_compressed(path, **vars(self))


def load(path: Path = WEIGHTS) -> Network:
    """The network whose matrices `Network.save` wrote; nothing but numbers is read. ExamError where there is none."""
    try:
        with np.load(path) as file:
            return Network(**{name: file[name] for name in Network.__dataclass_fields__})
    except (OSError, ValueError, KeyError) as error:
        raise ExamError(f"{path}: is no trained network ({error}); train one, or install the exam anew") from None


def inputs_of(s: Signals) -> Array:
    """Figures of a recording's equations (k,).

    Of each balance: what the nominal terms are fitted to be over what they are given as; the share of the target that
    they leave, and its correlation with itself later; its correlation with each term and with powers and products of
    the signals; and the terms' sizes, fitted together.
    """
    p = s.nominal
    force = (p["moving_mass"], p["damping_coefficient"], p["spring_stiffness"])
    chamber = (p["valve_gain"], 1.0 / p["bulk_modulus"], p["internal_leakage"])
    figures: list[Array] = []
    for row, given in zip(equations(s), (force, chamber, chamber), strict=True):
        fitted = np.linalg.lstsq(row.nominal, row.target, rcond=None)[0]
        share = np.linalg.norm(row.target - row.nominal @ fitted) / np.linalg.norm(row.target)
        target, terms = left_over(row)
        _, products = left_over(replace(row, candidates=_products(row.features)))
        later = [target[lag:] @ target[:-lag] for lag in LAGS]
        together = np.linalg.lstsq(terms, target, rcond=1e-6)[0]
        shown = np.concatenate([target @ terms, target @ products, np.clip(together, -LARGEST, LARGEST)])
        over = np.clip(np.abs(fitted) / given, 0.0, LARGEST)
        figures += [over, np.array([np.log(share), *later]), shown, np.abs(shown)]
    return np.concatenate(figures)


def _products(signals: Array) -> Array:
    """Magnitudes, signed squares, cubes and products of signals (n, k) brought to zero mean and unit variance."""
    z = (signals - signals.mean(axis=0)) / (signals.std(axis=0) + 1e-300)
    one, other = np.triu_indices(z.shape[1])
    slopes = np.gradient(z, axis=0)
    return np.column_stack([np.abs(z), z * np.abs(z), z**3, np.tanh(10.0 * z), slopes, z[:, one] * z[:, other]])


def targets_of(case: Case) -> Array:
    """Which of LABELS a case conceals (labels,), 1 or 0."""
    names = {f"unknown {SITES[name]}" if name in OUTSIDE else name for name in case.effect_ids}
    return np.array([float(label in names) for label in LABELS])


def recorded(cases: int, seed: int) -> Iterator[tuple[Case, Arrays]]:
    """That many cases and what their sensors record, in the exam's mix of tiers without UNSUITABLE."""
    members = (member for member in plan(2 * cases + len(UNSUITABLE)) if member[0] not in UNSUITABLE)
    for tier, number in islice(members, cases):
        case = draw_case(tier, number, seed)
        yield case, measure(case, simulate_case(case))


def train(examples: Iterable[tuple[Case, Arrays]]) -> Network:
    """The network that scikit-learn makes of cases and their recordings; the same for the same ones."""
    pairs = [(inputs_of(signals_of(arrays, case.nominal)), targets_of(case)) for case, arrays in examples]
    inputs, targets = (np.array(column) for column in zip(*pairs, strict=True))
    return fit(inputs, targets)


def fit(inputs: Array, targets: Array) -> Network:
    """The network for inputs (n, k) and targets (n, labels). ExamError where scikit-learn is not installed."""
    try:
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.neural_network import MLPClassifier
    except ImportError:
        raise ExamError("training needs the package `scikit-learn`; install it") from None
    mean, scale = inputs.mean(axis=0), inputs.std(axis=0) + 1e-12
    model = MLPClassifier((HIDDEN,), alpha=PENALTY, max_iter=ROUNDS, random_state=0)
    with warnings.catch_warnings():
        # The number of passes is what ends the training.
        warnings.simplefilter("ignore", ConvergenceWarning)
        model.fit((inputs - mean) / scale, targets)
    (first, second), (first_bias, second_bias) = model.coefs_, model.intercepts_
    return Network(mean, scale, first, first_bias, second, second_bias)


def screen(s: Signals, network: Network) -> dict[str, Any]:
    """The diagnosis of a recording by a network: its most probable set where that is SURE, else the STATED first."""
    probability = dict(zip(LABELS, network.probabilities(inputs_of(s)[None])[0].tolist(), strict=True))
    sets = _sets(probability)
    first, sure = sets[0]
    verdict = "ambiguous" if sure < SURE else "parameters" if not first else "missing_physics"
    unknown = [name for name in first if name in UNKNOWN]
    if verdict == "missing_physics" and unknown:
        verdict = "unknown_physics"
    return {
        "schema": "eha.diagnosis/1",
        "verdict": verdict,
        "effects": [
            {"id": name, "site": SITES[name], "probability": probability[name]} for name in first if name in SITES
        ],
        "unknown": {"site": UNKNOWN[unknown[0]]} if unknown else None,
        "alternatives": [{"effects": list(names)} for names, _ in sets[1:STATED]] if verdict == "ambiguous" else [],
    }


def _sets(probability: Mapping[str, float]) -> list[tuple[tuple[str, ...], float]]:
    """The sets of names that may be concealed with their probabilities, as if names were independent, the most probable
    first; of the OPEN most doubtful names either way is considered."""
    doubtful = sorted(probability, key=lambda name: abs(probability[name] - 0.5))[:OPEN]
    likely = {name for name, share in probability.items() if share > 0.5}
    flips = (set(chosen) for size in range(OPEN + 1) for chosen in combinations(doubtful, size))
    sets = [tuple(name for name in probability if name in likely ^ flip) for flip in flips]
    chances = [prod(p if name in names else 1.0 - p for name, p in probability.items()) for names in sets]
    return sorted(zip(sets, chances, strict=True), key=lambda pair: -pair[1])
