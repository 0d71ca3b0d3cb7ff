"""What a demonstration's rig conceals: drawn at random, sealed in a file, and opened at the end.

The seal is the SHA-256 of the answer. It is published before anything is recorded, so that an answer opened afterwards
is known to be the one that was drawn. The file is packed, so that nobody reads it by looking at it.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import secrets
import zlib
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from eha_core.errors import EhaError

NUMBER = 3
"""How many of EFFECTS are concealed."""

Ranges = dict[str, dict[str, tuple[float, float]]]
"""Of each effect's parameters, between what they are drawn."""

EFFECTS: Ranges = {
    "coulomb_friction": {"force": (180.0, 320.0)},
    "valve_deadband": {"half_width": (1.0e-4, 2.0e-4)},
    "constant_load": {"force": (200.0, 500.0)},
}
"""The ranges that sizes are drawn from: seals that rub, lands that overlap, a load that hangs on the rod."""

SMALL: Ranges = {
    "flow_gain_asymmetry": {"ratio": (0.01, 0.02)},
    "valve_null_offset": {"offset": (1.5e-6, 3e-6)},
}
"""Of these one is concealed where a rig is to be interrogated: under a square wave each looks like the other."""

PLANT: dict[str, tuple[float, float]] = {
    "moving_mass": (10.0, 12.5),
    "damping_coefficient": (1800.0, 2400.0),
    "internal_leakage": (1e-12, 5e-12),
}
"""What differs from the nominal model beside; Table 1 says 9 kg, 2000 N s/m, and level 1 of Table 2 1e-12."""

NOISES = {"position": 1e-5, "velocity": 1e-3, "pressure_a": 1e4, "pressure_b": 1e4}
"""Standard deviation of each sensor's noise [m, m/s, Pa]."""


@dataclass(frozen=True)
class Answer:
    """Everything that makes the rig: drawn from `seed`, under the names of the exam's truth."""

    seed: int
    plant: dict[str, float]
    effects: dict[str, dict[str, float]]
    noises: dict[str, float]


def draw(seed: int | None = None) -> Answer:
    """A rig; without a seed, another one each time."""
    return _drawn(seed, lambda generator: dict(list(EFFECTS.items())[:NUMBER]))


def draw_small(seed: int | None = None) -> Answer:
    """A rig with one effect, and that a small one; without a seed, another one each time."""
    return _drawn(seed, lambda generator: dict([list(SMALL.items())[generator.integers(len(SMALL))]]))


def _drawn(seed: int | None, chosen: Callable[[np.random.Generator], Ranges]) -> Answer:
    seed = secrets.randbelow(2**32) if seed is None else seed
    generator = np.random.default_rng(seed)
    plant = {name: float(generator.uniform(*span)) for name, span in PLANT.items()}
    effects = {
        effect: {name: float(generator.uniform(*span)) for name, span in spans.items()}
        for effect, spans in chosen(generator).items()
    }
    return Answer(seed, plant, effects, NOISES)


def conceal(answer: Answer, path: Path) -> str:
    """Seal an answer, say where, and return its seal."""
    digest = seal(answer, path)
    print(f"  what it conceals is sealed in {os.path.relpath(path)}, SHA-256 {digest[:16]}...", flush=True)
    return digest


def reveal(path: Path, digest: str) -> Answer:
    """Open a sealed answer and say so. Raises EhaError where it is not the one that was sealed."""
    answer, opened = unseal(path)
    if opened != digest:
        raise EhaError(f"{path} is not the answer that was sealed")
    print(f"\nThe sealed answer, opened (SHA-256 {opened[:16]}..., seed {answer.seed}):")
    return answer


def seal(answer: Answer, path: Path) -> str:
    """Write the answer, packed, and return its seal."""
    text = json.dumps(asdict(answer)).encode()
    path.write_bytes(base64.b85encode(zlib.compress(text)) + b"\n")
    return hashlib.sha256(text).hexdigest()


def unseal(path: Path) -> tuple[Answer, str]:
    """The answer of a sealed file, and its seal."""
    text = zlib.decompress(base64.b85decode(path.read_bytes().strip()))
    return Answer(**json.loads(text)), hashlib.sha256(text).hexdigest()
