"""A recording with a fault of its own gets no physics from it: the span is cut out and said, or it is refused."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eha_core.diagnosis import diagnose
from eha_core.diagnosis.calibrate import calibrate
from eha_core.errors import RecordingError
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values
from eha_core.plausibility import admit
from eha_core.recording import Recording, read_recording
from eha_core.report.document import document
from eha_exam.drawing import draw_case

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
from tools.hostile.diagnosed import make_rig  # noqa: E402
from tools.hostile.faulty_recordings import FAULTS, faulty  # noqa: E402
from tools.hostile.wrong_recordings import as_recording  # noqa: E402

BAGS = ROOT / "bags"
EVERY = ("voltage_command", "position", "pressure_a", "pressure_b")


@pytest.fixture(scope="module")
def sound() -> Recording:
    """Twelve seconds of a rig that lacks nothing, at 500 Hz."""
    return read_recording(BAGS / "rig_as_modelled.mcap")


def changed(recording: Recording, name: str, change: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Recording:
    """The recording with other values of one channel."""
    channel = recording.channels[name]
    values = change(channel.time, channel.values)
    return replace(recording, channels={**recording.channels, name: replace(channel, values=values)})


def without(recording: Recording, names: tuple[str, ...], lost: Callable[[np.ndarray], np.ndarray]) -> Recording:
    """The recording without some samples of some channels."""
    channels = dict(recording.channels)
    for name in names:
        kept = ~lost(channels[name].time)
        channels[name] = replace(channels[name], time=channels[name].time[kept], values=channels[name].values[kept])
    return replace(recording, channels=channels)


def slower(recording: Recording, every: int) -> Recording:
    """Every so many samples of every channel."""
    channels = {
        name: replace(channel, time=channel.time[::every], values=channel.values[::every])
        for name, channel in recording.channels.items()
    }
    return replace(recording, channels=channels)


def frozen(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    inside = (time >= 3.0) & (time < 5.0)
    return np.where(inside, values[inside][0], values)


def held(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.asarray(values[np.arange(len(values)) // 10 * 10])


def dropouts(time: np.ndarray) -> np.ndarray:
    moments = np.random.default_rng(3).uniform(0.3, 11.7, 24)
    return np.any([(time >= start) & (time < start + 0.05) for start in moments], axis=0)


MADE: dict[str, tuple[Callable[[Recording], Recording], str, str]] = {
    "frozen sensor": (lambda one: changed(one, "position", frozen), "position", "frozen"),
    "two seconds of the command": (
        lambda one: without(one, EVERY[:1], lambda time: (time >= 5.0) & (time < 7.0)), "voltage_command", "hole",
    ),
    "dropouts of the command": (lambda one: without(one, EVERY[:1], dropouts), "voltage_command", "hole"),
    "four seconds of a split bag": (
        lambda one: without(one, EVERY, lambda time: (time >= 4.0) & (time < 8.0)), "voltage_command", "hole",
    ),
    "position held": (lambda one: changed(one, "position", held), "position", "held"),
    "end of the position's range": (
        lambda one: changed(one, "position", lambda _, values: np.clip(values, -0.012, 0.012)), "position", "saturated",
    ),
    "end of a pressure's range": (
        lambda one: changed(one, "pressure_a", lambda _, values: np.minimum(values, 1.05e7)), "pressure_a", "saturated",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MADE)
def test_a_rig_as_modelled_is_at_the_noise_whatever_the_recording_lacks(name: str, sound: Recording) -> None:
    """Of the samples that are left the nominal model leaves noise, over every window, with the piston's states free."""
    make, channel, kind = MADE[name]
    observation = observe(make(sound))
    assert {(fault.channel, fault.fault) for fault in observation.health} >= {(channel, kind)}
    calibration = calibrate([observation], NominalModel(nominal_values()), 2e-4)
    at_nominal = calibration.nominal
    assert at_nominal.objective < 1.1 * at_nominal.count
    assert at_nominal.objective - calibration.fitted.objective < 40.0


def test_the_result_names_the_fault_and_no_physics(sound: Recording) -> None:
    found = document(diagnose(changed(sound, "position", frozen), nominal_values()))
    assert found["verdict"] == "consistent" and not found["effects"]
    (fault,) = found["health"]
    assert (fault["channel"], fault["fault"]) == ("position", "frozen")
    assert fault["from"] == pytest.approx(3.0, abs=0.01) and fault["to"] == pytest.approx(5.0, abs=0.01)


def test_of_a_split_bag_without_its_middle_only_what_is_missing_from_the_model_is_named() -> None:
    friction = read_recording(BAGS / "rig_coulomb_friction.mcap")
    split = without(friction, (*EVERY, "velocity"), lambda time: (time >= 4.0) & (time < 8.0))
    found = document(diagnose(split, nominal_values()))
    (effect,) = found["effects"]
    assert effect["id"] == "coulomb_friction" and effect["active"] is None
    assert effect["parameters"]["force"]["value"] == pytest.approx(250.0, abs=1.0)
    spans = {fault["channel"]: (fault["from"], fault["to"]) for fault in found["health"]}
    assert spans == {name: pytest.approx((4.0, 8.0), abs=0.01) for name in EVERY}


def interpolated(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.interp(time, time[::10], values[::10])


def blocked(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    return 1e-5 * np.random.default_rng(2).standard_normal(len(values))


REFUSED: dict[str, tuple[Callable[[Recording], Recording], str]] = {
    "command from 50 Hz": (
        lambda one: changed(one, "voltage_command", interpolated), "voltage_command: interpolated from 50 Hz",
    ),
    "log of 50 Hz": (lambda one: slower(one, 10), "voltage_command: logged at 50 Hz, too slowly"),
    "blocked piston": (lambda one: changed(one, "position", blocked), "position: does not move"),
    "bar as Pa": (
        lambda one: changed(one, "pressure_a", lambda _, values: 1e-5 * values), "the atmosphere in Pa added to bar",
    ),
    "bar as Pa, absolute": (
        lambda one: changed(one, "pressure_a", lambda _, values: 1e-5 * values - 101325.0), "pressure_a is in bar",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_tells_nothing_is_refused_with_what_to_do(name: str, sound: Recording) -> None:
    make, expected = REFUSED[name]
    with pytest.raises(RecordingError, match=expected):
        admit(make(sound), nominal_values())
    (warning, *_) = admit(make(sound), nominal_values(), as_recorded=True).remarks
    assert expected in warning


def test_a_test_that_was_cut_to_pieces_is_refused(sound: Recording) -> None:
    with pytest.raises(RecordingError, match="almost nothing of position can be used"):
        observe(without(sound, EVERY[:1], lambda time: (time % 0.2 < 0.1) & (time > 0.3)))


def test_beside_a_digital_filter_no_other_signal_is_named_late() -> None:
    """A digital filter of first order delays by half a sample less than a lag of its time constant."""
    rig = make_rig(draw_case("null_parameters", 135, 60411))
    made, _ = faulty(next(kind for kind in FAULTS if kind.name == "position low-passed at 25 Hz"), rig.arrays, 60411135)
    found = diagnose(admit(as_recording(made), rig.nominal), rig.nominal)
    assert [fault.fault for _, fault in found.health] == ["low_passed"]
    assert [effect.id for effect in found.effects] == ["position_sensor_lag"]
    kept = np.exp(-2.0 * np.pi * 25.0 / 1000.0)
    assert found.effects[0].parameters["time_constant"].value == pytest.approx(1e-3 * kept / (1.0 - kept), rel=0.01)
    assert found.explained.complete
    assert found.undetected is not None
    assert not {row.effect for row in found.undetected.effects} & {"command_delay", "pressure_sensor_lag"}
