"""Several recordings on the page: what each says of the joint model, and how an unseen one is predicted."""

from __future__ import annotations

from dataclasses import replace

import pytest

from eha_core.diagnosis import result
from eha_core.diagnosis.result import ChannelFit, Diagnosis, Prediction, RecordingFit
from eha_core.plant import Composition, compose
from eha_core.report.account import account
from eha_core.report.each_recording import recording_tables
from eha_core.report.html import page


def test_each_recording_has_its_errors_and_its_own_values(friction: Diagnosis) -> None:
    assert recording_tables(friction) == ()
    fits = [{"position": ChannelFit(9e-4, 5e-4, ratio * 1e-5, 1e-5)} for ratio in (1.02, 1.31)]
    own = ({"constant_load.force": 120.0}, {"constant_load.force": -80.0})
    triples = zip("ab", own, fits, strict=True)
    together = tuple(RecordingFit(f"bags/{name}.mcap", values, fit) for name, values, fit in triples)
    (table,) = recording_tables(replace(friction, together=together))
    assert table.headings == ("recording", "position [× noise]", "constant load: force F_L")
    assert table.rows == (("a.mcap", "1.02", "120 N"), ("b.mcap", "1.31", "-80.0 N"))


OWN = {
    "switched_pump": {"bypass_gain": 4.2e-7, "pump_leakage": 2e-13, "valve_overlap": 0.12},
    "servo_valve": {"moving_mass": 0.31, "constant_load.force": 12.5},
}


@pytest.mark.parametrize(
    ("composition", "headings", "cells", "remark"),
    [
        (
            compose("switched_pump", "single_rod"),
            ("bypass gain K_b", "pump leakage C_p", "valve overlap o"),
            ("4.20 × 10⁻⁷ m³√(m/kg)", "12.0 ml/min per MPa", "0.120"),
            "bypass_gain K_b = 4.20 × 10⁻⁷ m³√(m/kg); pump_leakage C_p = 12.0 ml/min per MPa; valve_overlap o = 0.120",
        ),
        (
            compose(cylinder="rotary_vane"),
            ("moment of inertia J", "constant load: force F_L"),
            ("0.310 kg m²", "12.5 N m"),
            "moment_of_inertia J = 0.310 kg m²; constant_load.force F_L = 12.5 N m",
        ),
    ],
    ids=["pump", "vane"],
)
def test_values_of_a_recording_are_called_as_in_their_parts(
    friction: Diagnosis, composition: Composition, headings: tuple[str, ...], cells: tuple[str, ...], remark: str
) -> None:
    fit = {"position": ChannelFit(9e-4, 5e-4, 1.02e-5, 1e-5)}
    together = (RecordingFit("bags/a.mcap", OWN[composition.source.id], fit),)
    diagnosis = replace(friction, composition=composition, together=together)
    (table,) = recording_tables(diagnosis)
    assert table.headings == ("recording", "position [× noise]", *headings)
    assert table.rows == (("a.mcap", "1.02", *cells),)
    line = next(one for one in account(diagnosis).splitlines() if "a.mcap: position" in one)
    assert line.endswith(f"on held-out data; {remark}")
    assert headings[0] in page(diagnosis)


def test_an_unseen_recording_has_every_model_s_errors_beside_the_noise(friction: Diagnosis) -> None:
    errors = {"nominal": 9e-4, "recalibrated": 5e-4, "augmented": 1.1e-5}
    prediction = {name: {"position": Prediction({0.25: one}, 2.0 * one)} for name, one in errors.items()}
    tested = replace(friction, tests=(result.PredictedRecording("bags/c.mcap", prediction, {"position": 1e-5}),))
    (table,) = recording_tables(tested)
    assert "c.mcap" in table.title
    assert table.rows == (
        ("position, 0.25 s ahead", "900 µm", "500 µm", "11.0 µm", "10.0 µm"),
        ("position, free-running", "1.80 mm", "1.00 mm", "22.0 µm", "10.0 µm"),
    )
    assert "Test on c.mcap" in page(tested)
