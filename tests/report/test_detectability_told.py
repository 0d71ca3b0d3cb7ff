"""A certificate as a document, as a table, and as a picture."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from eha_core.detectability import Certificate, PlannedTest
from eha_core.diagnosis.result import Confusion, Detectable, Noticeable
from eha_core.report.detectability import account, document, picture, write_certificate

FRICTION = Detectable("coulomb_friction", "force", "N", 12.0, 0.3, (), {}, 200.0, None,
                      (Confusion("stribeck_friction", 3.0, 0.98),), 1.5)  # fmt: skip
LEAK = Detectable("external_leakage", "coefficient_a", "m^3/(s Pa)", 1e-12 / 60, 0.2, (), {}, 1e-12, 1e-6 / 60)
SCALE = Detectable("position_sensor_scale", "ratio", "-", None, 1e-7, ("moving_mass",), {}, 0.05)


@pytest.fixture
def certificate() -> Certificate:
    times = np.arange(10) / 10.0
    return Certificate(
        PlannedTest(times, np.sin(times), 12.0, ("position",), 2.0), 0.95, 6000, (FRICTION, LEAK, SCALE),
        (Noticeable("moving_mass", "kg", 9.0, 0.9), Noticeable("internal_leakage", "m^3/(s Pa)", 1e-12, 1e-11, 1e-5)),
        0.2, {"N": 12_000.0}, ("the coil saturates",),
    )  # fmt: skip


def test_the_table_has_sizes_in_the_field_s_units(certificate: Certificate) -> None:
    lines = account(certificate).splitlines()
    assert lines[0] == "12 s at 500 Hz of position (noise 20.0 µm); the piston goes through 20 % of its stroke"
    told = {line.split("  ")[1]: [cell.strip() for cell in line.split("  ")[2:] if cell.strip()]
            for line in lines if line.startswith("  ") and line[2] != " "}  # fmt: skip
    assert told["coulomb_friction, force"] == ["12.0 N", "0.1 % of stall force", "1.50 N"]
    assert told["external_leakage, coefficient_a"] == ["1.00 ml/min per MPa", "1.00 ml/min"]
    assert told["position_sensor_scale, ratio"] == ["not found"]
    assert told["moving_mass"] == ["0.900 kg", "10.0 %"]
    assert "      cannot be distinguished from stribeck_friction" in lines
    assert "      nearly compensated by moving_mass" in lines
    assert lines[-1] == "Note: the coil saturates"


def test_the_document_is_plain_and_whole(certificate: Certificate) -> None:
    made = json.loads(json.dumps(document(certificate), allow_nan=False))
    assert made["test"]["noise"] == {"position": 2e-5} and made["power"] == 0.95
    friction, leak, scale = made["effects"]
    assert friction["size"] == 12.0 and friction["not_distinguished_from"][0]["id"] == "stribeck_friction"
    assert leak["flow"] == pytest.approx(1e-6 / 60) and scale["size"] is None
    assert made["parameters"][1]["flow"] == 1e-5


def test_the_picture_has_a_row_for_each_size_and_the_smallest_first(certificate: Certificate) -> None:
    (axes,) = picture(certificate).axes
    assert [label.get_text() for label in axes.get_yticklabels()] == [
        "external_leakage, coefficient_a", "coulomb_friction, force", "position_sensor_scale, ratio",
    ]  # fmt: skip
    points = {(round(float(line.get_ydata()[0])), line.get_marker()): float(line.get_xdata()[0])
              for line in axes.lines if line.get_marker() in ("o", "|")}  # fmt: skip
    assert points == {(0, "o"): pytest.approx(1 / 60), (1, "o"): pytest.approx(0.06), (1, "|"): pytest.approx(0.0075)}


def test_files_are_written(certificate: Certificate, tmp_path: Path) -> None:
    document_path, drawn = write_certificate(certificate, tmp_path / "new")
    assert json.loads(document_path.read_text())["schema"] == "eha.detect/1"
    assert np.ptp(imread(drawn)[:, :, :3]) > 0.5
