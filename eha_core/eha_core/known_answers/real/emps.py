"""The EMPS positioning axis: its asymmetry is viscous friction that differs by direction, and no load.

Data: A. Janot, M. Gautier, M. Brunot, "Data set and reference models of EMPS", 2019. The rigid model of its authors has
a load; windows of 0.25 s tell that direction-dependent friction, of as many values, explains the recordings better.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scipy.io import loadmat

from eha_core.known_answers.real.axis import (
    Array,
    Axis,
    Windows,
    cut_ahead,
    fit_axis,
    from_fitted_starts,
    rms,
    simulate,
)
from eha_core.known_answers.real.originals import original
from eha_core.known_answers.real.question import Question
from eha_core.known_answers.real.sealing import seal, write_csv
from eha_core.known_answers.shipped import diagnose, named

RIG = "EMPS axis"
FOUND_ON, TEST = "DATA_EMPS", "DATA_EMPS_PULSES"
MOTOR_GAIN = 35.15065
"""N/V of the drive, as published with the data."""

VISCOUS_ONLY = {
    "moving_mass": 95.1089, "damping_coefficient": 203.5034, "spring_stiffness": 0.0, "actuator_displacement": 0.3,
}  # fmt: skip
"""The published axis with its dry friction and its offset left out; its ends are out of
the reach of the reference (0.25 m)."""

PUBLISHED = Axis(95.1089, 203.5034, 203.5034, 20.3935, -3.1648)

DIRECTIONAL = "directional_damping"
DRY = ("coulomb_friction", "stribeck_friction", "presliding_friction", "bouc_wen_friction")
"""Forms of dry friction: the axis is known to have it, not which form."""

WINDOW, LARGEST_ERROR = 0.25, 1e-4
"""s and m RMS: what one set of values has to reach on both recordings (0.19 mm with a load)."""

AHEAD, EVERY, BETTER = 1.0, 0.1, 2.0 / 3.0
"""s ahead of measured starts, s between these, and the share of the error of load and Coulomb friction that may be
left."""


def ask(data: Path, out: Path) -> list[Question]:
    """The axis' questions; `out` takes the diagnosed files and the sealed prediction."""
    for name in (FOUND_ON, TEST):
        time, force, position = read(data, name, "t", "force", "qm")
        write_csv(out / f"{name}.csv", {"time": time, "force": force, "position": position})
    diagnosis = _diagnose(out, VISCOUS_ONLY)
    names = named(diagnosis)
    return [
        Question(
            RIG,
            "what does a viscous-only model leave out?",
            "viscous friction by direction and dry friction, no load",
            " + ".join(names) or str(diagnosis.get("verdict", "none")),
            DIRECTIONAL in names and any(form in names for form in DRY) and {*names} <= {DIRECTIONAL, *DRY},
        ),
        _both_recordings(data),
        _ahead(data, out, diagnosis),
        *_knocked_out(out, diagnosis),
    ]


def read(data: Path, name: str, *wanted: str) -> list[Array]:
    """Variables of one recording: `t` [s], `qm` [m], `force` [N].

    Raises:
        EhaError: the file is not there.
    """
    found = loadmat(original(data, f"{name}.mat"), variable_names=["vir" if key == "force" else key for key in wanted])
    return [
        MOTOR_GAIN * found["vir"].ravel().astype(float) if key == "force" else found[key].ravel().astype(float)
        for key in wanted
    ]


def _diagnose(out: Path, nominal: Mapping[str, float]) -> Mapping[str, Any]:
    """What `eha diagnose`, which is run in a folder of its own, says of the first recording, held against a model."""
    folder = out.resolve()
    file = folder / "nominal.yaml"
    file.write_text(json.dumps({"eha_sim": {"ros__parameters": dict(nominal)}}), encoding="utf-8")
    words = [str(folder / f"{FOUND_ON}.csv"), "--nominal", str(file)]
    return diagnose(words)[0]


def axis_of(diagnosis: Mapping[str, Any]) -> Axis:
    """The axis that a diagnosis found; of dry friction that clings before it slides, as it slides."""
    fitted = {row["name"]: float(row["fitted"]) for row in diagnosis.get("parameters") or ()}
    effects = _effects_of(diagnosis)
    dry = next((effects[form] for form in DRY if form in effects), {})
    force = dry.get("force", 0.0)
    mean = fitted.get("damping_coefficient", VISCOUS_ONLY["damping_coefficient"])
    ratio = effects.get(DIRECTIONAL, {}).get("ratio", 0.0)
    return Axis(
        mass=fitted.get("moving_mass", VISCOUS_ONLY["moving_mass"]),
        forward=mean * (1.0 + ratio),
        backward=mean * (1.0 - ratio),
        friction=force,
        load=effects.get("constant_load", {}).get("force", 0.0),
        rise=dry.get("static_force", force) - force,
        stribeck_velocity=dry.get("stribeck_velocity", 1.0),
    )


def _effects_of(diagnosis: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """The named effects' parameters [SI]."""
    return {
        effect["id"]: {name: float(value["value"]) for name, value in effect["parameters"].items()}
        for effect in diagnosis.get("effects") or ()
    }


def _windows(data: Path, name: str, length: float) -> Windows:
    time, force, position = read(data, name, "t", "force", "qm")
    return Windows.cut(force, position, float(time[1] - time[0]), length)


def _both_recordings(data: Path) -> Question:
    windows = [_windows(data, name, WINDOW) for name in (FOUND_ON, TEST)]
    found = fit_axis(PUBLISHED, windows, with_load=False)
    rival = fit_axis(PUBLISHED, windows, with_load=True)
    errors, others = ([rms(from_fitted_starts(axis, each)) for each in windows] for axis in (found, rival))
    return Question(
        RIG,
        f"one set of values for both recordings, windows of {WINDOW:g} s from fitted starts",
        f"within {1e3 * LARGEST_ERROR:.2f} mm RMSE each, and closer than with a load",
        f"{1e3 * errors[0]:.3f} and {1e3 * errors[1]:.3f} mm with {found.forward:.0f} and {found.backward:.0f} N s/m,"
        f" {found.friction:.1f} N; with a load {1e3 * others[0]:.3f} and {1e3 * others[1]:.3f} mm",
        max(errors) <= LARGEST_ERROR and errors[0] < others[0] and errors[1] < others[1],
    )


def _ahead(data: Path, out: Path, diagnosis: Mapping[str, Any]) -> Question:
    """The diagnosed values, and load and Coulomb friction: as published, and as fits the same recording best."""
    rival = fit_axis(PUBLISHED, [_windows(data, FOUND_ON, WINDOW)], with_load=True)
    time, force, position = read(data, TEST, "t", "force", "qm")
    test, speed = cut_ahead(force, position, float(time[1] - time[0]), AHEAD, EVERY)
    axes = {"diagnosed": axis_of(diagnosis), "load_and_coulomb": rival, "published": PUBLISHED}
    sealed = {
        name: seal(out, name, simulate(axis, test.force, test.position[:, 0], speed, test.period))
        for name, axis in axes.items()
    }
    found, fitted, published = (1e3 * rms(prediction.open() - test.position) for prediction in sealed.values())
    return Question(
        RIG,
        f"position on the test recording, {AHEAD:g} s ahead from measured starts",
        "better than load and Coulomb friction by a third",
        f"{found:.2f} mm against {fitted:.2f} mm at best and {published:.2f} mm as published",
        found <= BETTER * fitted,
        sealed["diagnosed"].short,
    )


def _knocked_out(out: Path, diagnosis: Mapping[str, Any]) -> list[Question]:
    """The diagnosed model without each of its two effects: that one has to be found again, alone."""
    fitted = {row["name"]: float(row["fitted"]) for row in diagnosis.get("parameters") or ()}
    effects = _effects_of(diagnosis)
    trials = (("viscous friction by direction", (DIRECTIONAL,)), ("dry friction", DRY))
    questions = []
    for words, right in trials:
        kept = {
            f"{effect}.{name}": value
            for effect, parameters in effects.items()
            if effect not in right
            for name, value in parameters.items()
        }
        names = named(_diagnose(out, {**VISCOUS_ONLY, **fitted, **kept}))
        questions.append(
            Question(
                RIG,
                f"{words} knocked out of the model",
                "is found again, and nothing else",
                " + ".join(names) or "nothing",
                len(names) == 1 and names[0] in right,
            )
        )
    return questions
