"""Numbers in a unit that no rig reaches are refused with the unit they may be in; outliers are left out and counted."""

from __future__ import annotations

import re

import numpy as np
import pytest

from eha_core.errors import RecordingError
from eha_core.recording.channel_rules import ABSOLUTE, GAUGE, ChannelRule
from eha_core.recording.samples import Samples
from eha_core.recording.units import in_model_units

ATMOSPHERE = 101325.0


def scaled(name: str, values, **rule):
    samples = Samples(np.arange(len(values), dtype=np.int64), np.array(values, dtype=np.float64))
    return in_model_units("/topic", name, ChannelRule("/topic", "data", **rule), samples, ATMOSPHERE)


@pytest.mark.parametrize(
    ("name", "largest", "units"),
    [
        ("position", 80.0, ["mm"]),
        ("position", 8e4, ["um"]),
        ("position", 1e9, []),
        ("pressure_a", 5.0, ["MPa"]),
        ("pressure_a", 160.0, ["bar", "psi"]),  # 16 MPa, or 1.1 MPa
        ("pressure_a", 1.6e4, ["kPa"]),
    ],
)
def test_the_units_are_named_that_make_it_a_rigs(name: str, largest: float, units: list[str]) -> None:
    # 160 in kPa is no pressure of a rig, 1.6e4 in psi is 110 MPa
    with pytest.raises(RecordingError) as refused:
        scaled(name, [largest, 0.5 * largest])
    assert re.findall(r"if it is in (\w+)", str(refused.value)) == units
    assert f"{largest:.4g}" in str(refused.value)


@pytest.mark.parametrize(("reference", "least"), [(ABSOLUTE, 2e4), (GAUGE, 1e3)])
def test_a_pressure_that_never_exceeds_a_little_is_in_another_unit(reference: str, least: float) -> None:
    assert len(scaled("pressure_a", [least, 0.0], reference=reference)[0].values) == 2
    with pytest.raises(RecordingError, match="which is not plausible for a rig"):
        scaled("pressure_a", [0.999 * least, 0.0], reference=reference)
    assert not scaled("pressure_a", [0.0, 0.0], reference=GAUGE)[0].values.any()  # a dead sensor is no unit


def test_one_impossible_sample_in_a_hundred_is_left_out_and_two_are_a_unit() -> None:
    values = np.full(100, 0.02)
    values[7] = 1e6
    samples, notes = scaled("position", values)
    assert 7 not in samples.stamps and len(samples.stamps) == len(samples.values) == 99
    assert len(notes) == 1 and notes[0].startswith("1 samples beyond")
    values[8] = -1e6
    with pytest.raises(RecordingError):
        scaled("position", values)


def test_pressures_become_those_above_the_atmosphere() -> None:
    absolute, remarks = scaled("pressure_a", [1e6, 2e6])
    assert absolute.values.tolist() == [1e6 - ATMOSPHERE, 2e6 - ATMOSPHERE] and "taken as absolute" in remarks[0]
    assert scaled("pressure_a", [1e6, 2e6], reference=ABSOLUTE)[1] == ()
    gauge, remarks = scaled("pressure_a", [10.0, 20.0], scale=1e5, offset=5.0, reference=GAUGE)
    assert gauge.values.tolist() == [1e6 + 5.0, 2e6 + 5.0] and remarks == ()
    with pytest.raises(RecordingError, match="mostly negative"):
        scaled("pressure_a", [-1e6, -1e6, 1e6], reference=ABSOLUTE)
    scaled("pressure_a", [-1e6, -1e6, 1e6], reference=GAUGE)
    scaled("pressure_a", [0.0, 0.0, 1e6], reference=ABSOLUTE)


LARGEST = {
    "voltage_command": 1e4, "current": 1e3, "spool": 1e3, "flow_a": 10.0, "flow_b": 10.0, "pressure_a": 1e9,
    "pressure_b": 1e9, "pump_speed": 1e5, "supply_pressure": 1e9, "position": 50.0, "velocity": 100.0, "force": 1e9,
}  # fmt: skip
"""The largest magnitudes of any rig."""


@pytest.mark.parametrize(("name", "largest"), list(LARGEST.items()))
def test_one_sample_beyond_the_largest_of_any_rig_is_left_out(name: str, largest: float) -> None:
    values = np.full(200, 0.5 * largest)
    values[3], values[4], values[5] = largest, -largest, np.nextafter(largest, np.inf)
    samples, _ = scaled(name, values, reference=GAUGE)
    assert samples.stamps.tolist() == [k for k in range(200) if k != 5]


@pytest.mark.parametrize(
    ("name", "largest", "unit", "is_told"),
    [
        ("position", 5000.0, "mm", True),
        ("position", 5001.0, "mm", False),
        ("position", 51.0, "um", False),
        ("position", 1000.0, "um", True),
        ("position", 999.0, "um", False),
        ("pressure_a", 10.0, "bar", True),
        ("pressure_a", 9.9, "bar", False),
        ("pressure_a", 500.0, "bar", True),
        ("pressure_a", 501.0, "bar", False),
        ("pressure_a", 1.0, "MPa", True),
        ("pressure_a", 0.99, "MPa", False),
        ("pressure_a", 51.0, "MPa", False),
        ("pressure_a", 146.0, "psi", True),
        ("pressure_a", 145.0, "psi", False),
        ("pressure_a", 999.0, "kPa", False),
        ("pressure_a", 1000.0, "kPa", True),
    ],
)
def test_a_unit_is_named_from_the_least_to_the_most_of_rigs(
    name: str, largest: float, unit: str, is_told: bool
) -> None:
    """Of pressures 1 to 50 MPa, of strokes 1 mm to 5 m."""
    with pytest.raises(RecordingError) as refused:
        scaled(name, [largest, -largest])
    assert (f"if it is in {unit}" in str(refused.value)) == is_told


def test_no_unit_is_named_for_a_quantity_of_which_none_is_usual() -> None:
    with pytest.raises(RecordingError, match="in a topics file$"):
        scaled("force", [2e9, 2e9])
