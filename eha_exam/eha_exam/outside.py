"""The laws outside the catalogue as curves, to hold a recovered curve against."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from eha_exam.case import Case

Array = NDArray[np.float64]
Curve = Callable[[Mapping[str, float], Array], Array]

CURVES: dict[str, tuple[str, Curve]] = {
    "position_ripple": ("position", lambda p, x: p["force"] * np.sin(2.0 * np.pi * x / p["pitch"] + p["phase"])),
    "periodic_force": ("time", lambda p, t: p["force"] * np.sin(2.0 * np.pi * p["frequency"] * t)),
    "direction_friction": ("velocity", lambda p, v: -np.where(v > 0.0, p["forward"], -p["backward"])),
    "one_sided_spring": ("position", lambda p, x: -p["stiffness"] * np.maximum(x - p["start"], 0.0)),
    "relief_leakage": (
        "pressure difference",
        lambda p, d: p["direction"] * p["coefficient"] * np.maximum(p["direction"] * d - p["opening"], 0.0),
    ),
}
"""Variable and law of each effect outside the catalogue that is a curve of one variable alone."""


def curve_agreement(case: Case, function_of: str, samples: Array) -> float | None:
    """R^2 of a recovered curve (n, 2) against the concealed law, up to what the nominal parameters can absorb.

    A constant and a straight line are free: null offset, viscous damping, spring and gain are parameters of the nominal
    model or of its fit. None where the law is no curve of that variable.
    """
    effect, values = case.effects[0]
    if effect not in CURVES or len(samples) < 5 or CURVES[effect][0] not in function_of:
        return None
    x, recovered = samples[:, 0], samples[:, 1]
    truth = CURVES[effect][1]({name: float(value) for name, value in values.items()}, x)
    free = np.column_stack([np.ones_like(x), x])
    apart = [column - free @ np.linalg.lstsq(free, column, rcond=None)[0] for column in (truth, recovered)]
    spread = float(np.sum(apart[0] ** 2))
    if spread == 0.0:
        return None
    return 1.0 - float(np.sum((apart[1] - apart[0]) ** 2)) / spread
