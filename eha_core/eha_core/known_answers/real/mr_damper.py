"""A magneto-rheological damper: its coil current is what was changed, so its dry friction has to be what changes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from eha_core.known_answers.real.originals import original
from eha_core.known_answers.real.question import Question
from eha_core.known_answers.real.sealing import Array, seal, write_csv
from eha_core.motion_given import Law, Motion, find_law, motion_of, predict
from eha_core.recording import Recording

RIG = "MR damper"
CURRENTS = {"0A": 0.0, "0x25A": 0.25, "0x5A": 0.5, "0x75A": 0.75, "1A": 1.0}
TESTS = {"10mm1Hz": "1 Hz", "25mm0x5Hz": "0.5 Hz", "5mm3Hz": "3 Hz"}
FOUND_ON = "10mm1Hz"
"""The test between the other two in frequency and stroke, on which each current's law is found."""

LARGEST_ERROR = 0.08
"""RMS error over the force's deviation at a frequency that was not fitted; regression on sign(v), v and x leaves
0.17."""

AVERAGED = 0.1
"""Share of the period over which the authors' program averages displacement and force (their sincronize.m)."""

PERIOD_KNOWN = 0.03
"""Share to which the period and a window of whole samples are known: 33 samples, and a machine that is 2 % fast."""

HYSTERETIC = "bouc_wen_friction"


def ask(data: Path, out: Path) -> list[Question]:
    """The damper's questions; `out` takes the sealed predictions."""
    for current in CURRENTS:
        time, position, velocity, force = read(data, FOUND_ON, current, (0, 1, 2, 3))
        columns = {"time": time, "position": 1e-3 * position, "velocity": 1e-3 * velocity, "force": force}
        write_csv(out / f"{FOUND_ON}{current}.csv", columns)
    laws = {current: find_law([_motion(data, FOUND_ON, current)]) for current in CURRENTS}
    return [*_parts(laws), _growth(laws), _recording(data), *_frequencies(data, out)]


def read(data: Path, test: str, current: str, columns: tuple[int, ...]) -> Array:
    """Columns of one file: time [s], displacement [mm], velocity [mm/s], force [N].

    Raises:
        EhaError: the file is not there.
    """
    return np.asarray(np.loadtxt(original(data, f"{test}{current}.txt"), usecols=columns).T)


def _motion(data: Path, test: str, current: str, with_force: bool = True) -> Motion:
    time, position, velocity = read(data, test, current, (0, 1, 2))
    force = read(data, test, current, (3,)) if with_force else np.zeros_like(time)
    motion = motion_of(
        Recording.from_arrays(
            time=time, position=1e-3 * position, velocity=1e-3 * velocity, force=force, name=f"{test}{current}"
        )
    )
    # displacement and force were averaged alike, so the displacement shows the window where the force is sealed
    return motion if with_force else replace(motion, averaged=motion.position_averaged)


def _parts(laws: dict[str, Law]) -> list[Question]:
    return [
        Question(
            RIG,
            f"what makes the force at {CURRENTS[current]:g} A?",
            "a dry and hysteretic part (its authors fit Bouc-Wen)",
            f"{' + '.join(law.ids)}; {100 * law.share_left:.1f} % left on held-out blocks",
            HYSTERETIC in law.ids,
        )
        for current, law in laws.items()
    ]


def _growth(laws: dict[str, Law]) -> Question:
    found = [law.values[HYSTERETIC]["force"] for law in laws.values() if HYSTERETIC in law.ids]
    apart = all(b.value - a.value > 1.96 * np.hypot(a.std, b.std) for a, b in zip(found[:-1], found[1:], strict=True))
    forces = ", ".join(f"{force.value:.0f} ± {1.96 * force.std:.0f}" for force in found)
    return Question(
        RIG, "dry friction over the current [N]", "grows with the current", forces, apart and len(found) == len(laws)
    )


def _recording(data: Path) -> Question:
    """The force's smoothing is the recorder's and not the damper's: it must not change with the current."""
    motions = [_motion(data, test, current) for current in CURRENTS for test in TESTS]
    shares = [motion.averaged / motion.period for motion in motions if motion.averaged and motion.period]
    shown = f"{min(shares):.3f} to {max(shares):.3f}, mean {np.mean(shares):.3f}" if shares else "none"
    return Question(
        RIG,
        "smoothing of the recorded force, as a share of the period, in 15 recordings",
        "an average over 0.100 of the period, which its authors' program makes",
        shown,
        len(shares) == len(motions) and bool(np.allclose(shares, AVERAGED, rtol=PERIOD_KNOWN)),
    )


def _frequencies(data: Path, out: Path) -> list[Question]:
    questions = []
    for current, ampere in CURRENTS.items():
        for unseen in TESTS:
            others = [test for test in TESTS if test != unseen]
            law = find_law([_motion(data, test, current) for test in others])
            motion = _motion(data, unseen, current, with_force=False)
            sealed = seal(out, f"{unseen}{current}", np.interp(*_on_file(data, unseen, current, motion, law)))
            force = read(data, unseen, current, (3,))
            error = float(np.sqrt(np.mean((sealed.open() - force) ** 2)) / np.std(force))
            questions.append(
                Question(
                    RIG,
                    f"force at {ampere:g} A and {TESTS[unseen]} from {' and '.join(TESTS[test] for test in others)}",
                    f"measured; within {100 * LARGEST_ERROR:.0f} % of its deviation",
                    f"{100 * error:.1f} %",
                    error <= LARGEST_ERROR,
                    sealed.short,
                )
            )
    return questions


def _on_file(data: Path, test: str, current: str, motion: Motion, law: Law) -> tuple[Array, Array, Array]:
    """The law at the file's own instants: what `np.interp` takes."""
    time = read(data, test, current, (0,))
    return time - time[0], motion.time, predict(law, motion)
