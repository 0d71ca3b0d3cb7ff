"""Cases with their recordings, made from a seed: drawn, simulated, measured, and kept in a cache."""

from __future__ import annotations

import hashlib
import os
import pickle
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from eha_exam.case import Array, Arrays, Case
from eha_exam.concealed import draw_effect, scaled
from eha_exam.drawing import draw_case
from eha_exam.measuring import measure, simulate_case
from eha_exam.oracle import Insight, consult, seen_beside_the_others
from eha_exam.tiers import SETS

__all__ = ["Arrays", "Case", "draw_case", "make_case", "make_cases"]

HIDDEN = 1.1
"""RMS that a refit may leave of an effect, over the noise: with the noise itself, within 1.5 times the noise."""
FARTHEST = 0.5
"""Relative change of a nominal parameter beyond which nobody would believe a refit."""
INDISTINCT = 0.2
"""Log-likelihood that an oracle may gain beyond a rival in its windows where the two count as not distinguished: over
the whole recording, whose windows also meet, that is some ten times as much ..."""
AIMED_AT = 0.1
"""... and those that an effect is made so small as to gain."""
MAKERS = (
    "case", "cases", "concealed", "drawing", "excitation", "imitation", "measuring", "oracle", "outside", "plants",
    "tiers",
)  # fmt: skip
"""The exam's modules that a case and its recording are made by; the others score and present."""

ATTEMPTS = 4


def make_case(tier: str, number: int, seed: int) -> tuple[Case, Arrays]:
    """A case and its recording, from the cache where it was made before with the same sources.

    The oracle is asked whether the case is decidable; `refit` and `twins` are made with its help.
    """
    key = hashlib.sha256(f"{tier} {number} {seed} {_fingerprint()}".encode()).hexdigest()[:24]
    path = _cache() / f"{key}.pickle"
    if path.is_file():
        with path.open("rb") as file:
            made: tuple[Case, Arrays] = pickle.load(file)
        return made
    case, truth = _decide(draw_case(tier, number, seed))
    made = (case, measure(case, truth))
    draft = path.with_suffix(f".{os.getpid()}")
    draft.write_bytes(pickle.dumps(made))
    draft.rename(path)
    return made


def make_cases(tier: str, n: int, seed: int) -> list[tuple[Case, Arrays]]:
    """The first n cases of a tier with their recordings."""
    return [make_case(tier, number, seed) for number in range(n)]


def _decide(case: Case) -> tuple[Case, dict[str, Array]]:
    """The truth of a case, and the case with what the oracle says of it."""
    truth = simulate_case(case)
    if not case.effects:
        return case, truth
    if case.rivals:
        return _as_twin(case, truth)
    if case.tier in SETS:
        seen = seen_beside_the_others(case, truth)
        return replace(case, seen=seen, decidable=len(seen) == len(case.effects)), truth
    insight = consult(case, truth)
    if case.tier == "refit" and insight.residual > HIDDEN:
        case = _smaller(case, HIDDEN / insight.residual)
        truth = simulate_case(case)
        insight = consult(case, truth)
    if case.tier == "refit":
        case = replace(case, nominal=_refitted(case, insight))
    return replace(case, decidable=insight.decidable), truth


def _smaller(case: Case, share: float) -> Case:
    ratio = case.setting.rig.area_ratio
    effects = tuple((name, scaled(name, dict(values), share, ratio)) for name, values in case.effects)
    return replace(case, effects=effects)


def _refitted(case: Case, insight: Insight) -> dict[str, float]:
    """Nominal values that were re-tuned on this recording until they hide the effect as well as they can."""
    nominal = dict(case.nominal)
    for name, change in insight.imitation.items():
        nominal[name] = case.plant[name] * (1.0 + float(np.clip(change, -FARTHEST, FARTHEST)))
    return nominal


def _as_twin(case: Case, truth: dict[str, Array]) -> tuple[Case, dict[str, Array]]:
    """The effect made smaller until the oracle cannot tell it from its rival; decidable says that it sees something."""
    generator = np.random.default_rng([case.seed, 3])
    rival = (case.rivals[0], draw_effect(case.rivals[0], case.setting, generator))
    for _ in range(ATTEMPTS):
        insight = consult(case, truth, rival)
        if insight.beyond_rival is not None and insight.beyond_rival < INDISTINCT:
            return replace(case, decidable=insight.decidable), truth
        case = _smaller(case, 0.5 if insight.beyond_rival is None else float(np.sqrt(AIMED_AT / insight.beyond_rival)))
        truth = simulate_case(case)
    return replace(case, rivals=(), decidable=consult(case, truth).decidable), truth


def _cache() -> Path:
    root = os.environ.get("EHA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME")
    folder = (Path(root) if root else Path.home() / ".cache" / "eha_exam") / "exam"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@cache
def _fingerprint() -> str:
    """A hash of the sources that a recording is made by: one made by others of them is not this case's."""
    here = Path(__file__).parent
    digest = hashlib.sha256()
    for path in [*(here / f"{name}.py" for name in MAKERS), *sorted(here.glob("truth/*.py"))]:
        digest.update(path.read_bytes())
    return digest.hexdigest()
