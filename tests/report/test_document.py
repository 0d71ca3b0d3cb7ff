"""diagnosis.json."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from eha_core.diagnosis.result import (
    Alternative,
    ChannelFit,
    Diagnosis,
    Experiment,
    FittedParameter,
    FittedValue,
    Location,
    NamedEffect,
    Pictures,
    UnknownLaw,
)
from eha_core.report.document import as_json, document
from eha_exam.document import fault_of

STATEMENT = (
    "90 % of the recalibrated model's unexplained error is in the force balance of the piston, near zero speed,"
    " through the whole record"
)
KEYS = {
    "schema": str, "recording": dict, "verdict": str, "location": list, "parameters": list, "effects": list,
    "alternatives": list, "unknown": dict, "fit": dict, "next_experiment": dict,
}  # fmt: skip


@pytest.fixture
def diagnosis() -> Diagnosis:
    """Everything a diagnosis can say at once, in the number types that NumPy leaves behind."""
    fit = {"position": ChannelFit(np.float64(3e-5), 2e-5, math.nan, np.float32(0.5))}
    return Diagnosis(
        path="a.mcap",
        duration=np.float64(12.0),
        channels=("voltage_command", "position"),
        not_examined=("continuity of chamber a: pressure_a was not recorded",),
        remarks=(),
        damaged=None,
        verdict="ambiguous",
        summary="…",
        location=(Location("force", np.float64(0.9), "near zero speed", ((0.0, 1.5),)),),
        parameters=(FittedParameter("moving_mass", 9.0, 9.1, math.inf, "kg", np.bool_(True)),),
        effects=(
            NamedEffect(
                "coulomb_friction", "force", "…", {"force": FittedValue(200.0, 1.0, "N")}, np.float64(90.0), "…"
            ),
        ),
        alternatives=(Alternative(("stribeck_friction",), 2.5),),
        unknown=UnknownLaw("force", "velocity", "", 0.9, ((0.0, 1.0), (1.0, 2.0))),
        training=fit,
        held_out=fit,
        next_experiment=Experiment("…", ("coulomb_friction",), {"signal": "sine", "sine.amplitude": np.float64(0.1)}),
        rivals=((("coulomb_friction",), 90.0),),
        whiteness={"position": 1.0},
        fitted_values={},
        pictures=Pictures({}, {}, {}, {}, {}),
    )


def test_has_every_key_of_the_schema(diagnosis: Diagnosis) -> None:
    found = document(diagnosis)
    assert {name: type(found[name]) for name in KEYS} == KEYS
    assert found["schema"] == "eha.diagnosis/1"
    assert found["recording"]["duration_s"] == 12.0
    assert found["recording"]["channels"] == ["voltage_command", "position"]
    assert found["location"][0] == {
        "site": "force", "share": 0.9, "where": "near zero speed", "when": [[0.0, 1.5]], "statement": STATEMENT,
    }  # fmt: skip
    assert found["effects"][0]["parameters"] == {"force": {"value": 200.0, "std": 1.0, "unit": "N"}}
    assert found["alternatives"] == [{"effects": ["stribeck_friction"], "evidence_gap": 2.5}]
    assert found["unknown"]["samples"] == [[0.0, 1.0], [1.0, 2.0]]
    assert found["next_experiment"]["reference"] == {"signal": "sine", "sine.amplitude": 0.1}
    assert set(found["fit"]) == {"training", "held_out"}


def test_what_is_not_finite_is_null_and_the_text_is_strict_json(diagnosis: Diagnosis) -> None:
    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    found = json.loads(as_json(diagnosis), parse_constant=refuse)
    assert found == document(diagnosis)
    assert found["parameters"][0]["std"] is None
    assert found["parameters"][0]["changed"] is True
    assert found["fit"]["held_out"]["position"] == {
        "rmse_before": 3e-5, "rmse_calibrated": 2e-5, "rmse_after": None, "noise": 0.5,
    }  # fmt: skip


def test_is_of_the_form_that_the_exam_reads(diagnosis: Diagnosis) -> None:
    assert fault_of(json.loads(as_json(diagnosis))) == ""
