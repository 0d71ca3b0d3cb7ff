"""Write a valve's flow, pressure gain and leakage curves as a test bench prints them, computed in closed form.

python examples/valve_bench.py out/bench
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd

FULL, SUPPLY = 20.0, 210.0
"""mA and bar."""

OFFSET, OVERLAP, PLAY, ASYMMETRY = 0.25, 0.40, 0.15, 0.08
"""mA, half widths in mA, and the share of the flow gain that is missing at negative currents."""

GAIN = 1.2
"""l/min per mA at 70 bar."""


def sweep(largest: float, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Currents from null up, down and back [mA], and what follows them past the play."""
    up = np.arange(0.0, largest + 0.5 * step, step)
    currents = np.concatenate([up, up[-2::-1], -up[1:], -up[-2::-1]])
    at, followed = -PLAY, []
    for current in currents:
        at = min(current + PLAY, max(current - PLAY, at))
        followed.append(at)
    return currents, np.array(followed)


def write(folder: Path) -> None:
    """Write flow.csv, pressure.csv and leakage.csv."""
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(7)
    current, spool = sweep(FULL, 0.5)
    opening = spool + OFFSET
    opened = np.maximum(opening - OVERLAP, 0.0) - np.maximum(-opening - OVERLAP, 0.0)
    flow = GAIN * opened * np.where(opened < 0.0, 1.0 - ASYMMETRY, 1.0) + random.normal(0.0, 0.05, opened.size)
    save(folder / "flow.csv", {"I [mA]": current, "Q [l/min]": flow})
    leakage = 0.35 + 0.9 / (1.0 + (opening / 0.8) ** 2) + random.normal(0.0, 0.006, opening.size)
    save(folder / "leakage.csv", {"I [mA]": current, "leakage [l/min]": leakage})
    current, spool = sweep(2.0, 0.05)
    load = SUPPLY * np.tanh((spool + OFFSET) / 0.5)
    pressures = {f"p{side} [bar]": 0.5 * (SUPPLY + sign * load) + random.normal(0.0, 0.3, load.size)
                 for side, sign in (("A", 1.0), ("B", -1.0))}  # fmt: skip
    save(folder / "pressure.csv", {"I [mA]": current, **pressures})


def save(path: Path, columns: dict[str, np.ndarray]) -> None:
    """One table."""
    pd.DataFrame(columns).to_csv(path, index=False, float_format="%.4f")


if __name__ == "__main__":
    write(Path(sys.argv[1] if len(sys.argv) > 1 else "out/bench"))
