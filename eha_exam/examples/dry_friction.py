"""A method that sits the exam: it looks for dry friction in the force on the piston, and knows nothing else.

    eha-exam --cases 20 --tier single --method 'dry friction={python} dry_friction.py {recordings} {answers}'

It fits mass, damping, spring and offset to the pressures' force by least squares. Where a force that changes its sign
with the velocity takes away more than half of the squared residual, it names Coulomb friction.
"""

import json
import sys
from pathlib import Path

import numpy as np
from scipy.signal import savgol_filter

from eha_exam.recordings import read_recording

RATE, WINDOW = 1000.0, 81  # Hz, and samples over which position and force are smoothed alike
SLOW = 0.05  # share of the largest speed below which friction's sign is not sure


def has_dry_friction(path: Path) -> bool:
    """Whether dry friction explains much of the force on the piston of a recording."""
    recording = read_recording(path)
    channels, p = recording.channels, recording.parameters
    if not {"position", "pressure_a", "pressure_b"} <= set(channels):
        return False
    time = np.arange(0.0, min(times[-1] for times, _ in channels.values()), 1.0 / RATE)
    x, a, b = (np.interp(time, *channels[name]) for name in ("position", "pressure_a", "pressure_b"))
    force = savgol_filter(p["piston_area"] * a - p["piston_area_b"] * b, WINDOW, 3)
    x, v, acceleration = (savgol_filter(x, WINDOW, 3, deriv=order, delta=1.0 / RATE) for order in range(3))
    moving = np.abs(v) > SLOW * np.max(np.abs(v))
    known = np.column_stack([acceleration, v, x, np.ones_like(x)])[moving]
    both = np.column_stack([known, np.sign(v)[moving]])
    fits = [np.linalg.lstsq(terms, force[moving], rcond=None)[0] for terms in (known, both)]
    without, with_friction = (
        np.sum((force[moving] - terms @ fit) ** 2) for terms, fit in zip((known, both), fits, strict=True)
    )
    return bool(fits[1][-1] > 0.0 and with_friction < 0.5 * without)


def main(recordings: Path, answers: Path) -> None:
    """Answer every recording; of a rig that was recorded several times, the further files are those with a number."""
    for path in sorted(recordings.glob("recording-*.mcap")):
        if path.stem.count("-") > 1:
            continue
        found = has_dry_friction(path)
        effects = [{"id": "coulomb_friction", "site": "force"}] if found else []
        verdict = "missing_physics" if found else "parameters"
        document = {"schema": "eha.diagnosis/1", "verdict": verdict, "effects": effects}
        (answers / f"{path.stem}.json").write_text(json.dumps(document), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
