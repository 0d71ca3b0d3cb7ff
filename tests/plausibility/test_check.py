"""Mistakes are found on rigs of an independent plant, with the line that cures them; what can be right is let pass."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from eha_core.errors import RecordingError
from eha_core.plausibility import admit, check
from eha_core.plausibility.relations import relations
from eha_core.recording import Recording
from eha_exam.drawing import draw_case
from eha_exam.measuring import measure
from eha_exam.second import with_other_loads

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from tools.hostile import wrong_recordings as wrong
from tools.hostile.plant_tests import run_on_plant
from tools.hostile.sound_recordings import KINDS

FAMILIES = ("light_servo", "heavy_press", "single_rod", "low_pressure")
SEED = 31


@pytest.fixture(scope="module")
def rigs() -> dict[str, wrong.Rig]:
    """One rig of each family: stiff, heavy, with a single rod, soft; with hidden physics and in closed loop too."""
    found: dict[str, wrong.Rig] = {}
    for number in range(12):
        for tier in ("null_parameters", "single", "tracking"):
            case = draw_case(tier, number, SEED)
            if case.family not in found:
                found[case.family] = wrong.make_rig(replace(case, duration=12.0, rate=500.0))
    return found


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("lacking", wrong.SUBSETS, ids=lambda names: "without " + "+".join(names))
def test_what_is_sound_is_let_pass(rigs: dict[str, wrong.Rig], family: str, lacking: tuple[str, ...]) -> None:
    rig = rigs[family]
    arrays = {name: pair for name, pair in rig.arrays.items() if name not in lacking}
    assert check(wrong.as_recording(arrays), rig.nominal) is None


def cured(recording: Recording, cure: str) -> Recording:
    """The recording as the cure's line reads it, by a reader of its own."""
    channels = {}
    for name, rule in yaml.safe_load(cure)["channels"].items():
        if rule is None:
            continue
        source = name
        if "topic" in rule:
            source = next(one for one, channel in recording.channels.items() if channel.topic == rule["topic"])
        channel = recording.channels[source]
        zero = 101325.0 if channel.unit == "Pa" else 0.0
        values = float(rule.get("scale", 1.0)) * (channel.values + zero) + float(rule.get("offset", 0.0)) - zero
        channels[name] = replace(channel, name=name, values=values)
    removed = {name for name, rule in yaml.safe_load(cure)["channels"].items() if rule is None}
    kept = {name: channel for name, channel in recording.channels.items() if name not in removed}
    return replace(recording, channels={**kept, **channels})


@pytest.mark.parametrize("number", range(len(wrong.MISTAKES)), ids=lambda number: wrong.MISTAKES[number].name)
def test_each_mistake_is_told_and_its_cure_gives_the_rig_back(rigs: dict[str, wrong.Rig], number: int) -> None:
    mistake, rig, other = wrong.MISTAKES[number], *(rigs[FAMILIES[(number + k) % 4]] for k in (0, 1))
    recording = wrong.make_wrong(mistake, rig, other)
    finding = check(recording, rig.nominal)
    assert finding is not None
    assert mistake.expected in finding.mistake
    assert "\n" not in str(finding)
    whole = cured(recording, finding.cure)
    assert check(whole, rig.nominal) is None
    if whole.channels.keys() == rig.arrays.keys() and "mid-stroke" not in finding.mistake:
        for name, channel in whole.channels.items():
            np.testing.assert_allclose(channel.values, rig.arrays[name][1], rtol=1e-6, atol=1e-6)


def test_a_sign_that_only_two_channels_tell_names_both(rigs: dict[str, wrong.Rig]) -> None:
    rig = rigs["light_servo"]
    reversed_position = next(one for one in wrong.MISTAKES if one.name == "position reversed")
    lacking = ("velocity", "pressure_a", "pressure_b")
    finding = check(wrong.make_wrong(reversed_position, rig, rig, lacking), rig.nominal)
    assert finding is not None and finding.other is not None
    assert "voltage_command" in finding.cure and "position: {scale: -1}" in finding.other[1]


def test_what_no_single_mistake_explains_is_let_pass(rigs: dict[str, wrong.Rig]) -> None:
    """Two mistakes at once: the check tells one or none, and never claims what does not mend the recording."""
    rig = rigs["heavy_press"]
    arrays = dict(rig.arrays)
    rng = np.random.default_rng(4)
    for name in ("pressure_a", "pressure_b"):
        time, values = arrays[name]
        arrays[name] = (time, 40.0 * values[::-1] + 1e5 * rng.standard_normal(len(values)))
    assert check(wrong.as_recording(arrays), rig.nominal) is None


def test_a_rig_of_reversed_polarity_is_sound_once_it_is_said(rigs: dict[str, wrong.Rig]) -> None:
    rig = rigs["low_pressure"]
    backwards = wrong.make_wrong(wrong.MISTAKES[0], rig, rig)
    finding = check(backwards, rig.nominal)
    assert finding is not None and finding.cure == "channels: {voltage_command: {scale: -1}}"
    assert check(cured(backwards, finding.cure), rig.nominal) is None


def test_as_recorded_goes_on_with_a_warning_before_all_remarks(rigs: dict[str, wrong.Rig]) -> None:
    rig = rigs["single_rod"]
    recording = replace(wrong.make_wrong(wrong.MISTAKES[4], rig, rig), remarks=("one sample was left out",))
    with pytest.raises(RecordingError, match=r"rig\.mcap: pressure_a and pressure_b are swapped; .*--as-recorded"):
        admit(recording, rig.nominal)
    warned = admit(recording, rig.nominal, as_recorded=True)
    assert warned.remarks[0].startswith("warning: taken as recorded, although pressure_a and pressure_b are swapped")
    assert warned.remarks[1:] == recording.remarks


def test_a_force_against_the_motion_is_told() -> None:
    time = np.arange(0.0, 8.0, 2e-3)
    rng = np.random.default_rng(2)
    position = 0.02 * np.sin(2.0 * np.pi * 0.7 * time) + 1e-5 * rng.standard_normal(len(time))
    speed = 0.02 * 2.0 * np.pi * 0.7 * np.cos(2.0 * np.pi * 0.7 * time)
    force = 2000.0 * speed + 100.0 * np.sign(speed) + 5.0 * rng.standard_normal(len(time))
    nominal = {**draw_nominal(), "damping_coefficient": 2000.0}
    for factor, expected in ((1.0, None), (-1.0, "force has the opposite sign"), (1e-3, "force is in kN")):
        finding = check(wrong.as_recording({"position": (time, position), "force": (time, factor * force)}), nominal)
        assert (finding.mistake if finding else None) == expected


@pytest.mark.parametrize("noise", [0.0, 1e4])
def test_one_chamber_recorded_twice_is_told_under_noise_too(rigs: dict[str, wrong.Rig], noise: float) -> None:
    rig = rigs["light_servo"]
    time, values = rig.arrays["pressure_a"]
    twice = values + noise * np.random.default_rng(8).standard_normal(len(values))
    finding = check(wrong.as_recording({**rig.arrays, "pressure_b": (time, twice)}), rig.nominal)
    assert finding is not None and "pressure_a and pressure_b are one signal recorded twice" in finding.mistake


def test_pressures_that_fall_together_in_noise_are_no_copies(rigs: dict[str, wrong.Rig]) -> None:
    """Leaks to the outside draw both chambers down; under noise the little force between them hardly shows."""
    rig = rigs["low_pressure"]
    time, position = rig.arrays["position"]
    rng = np.random.default_rng(9)
    speed = np.gradient(np.interp(time, *rig.arrays["position"]), time)
    force = np.convolve(rig.nominal["damping_coefficient"] * speed, np.ones(25) / 25.0, "same")
    common = 1.5e6 * (1.0 - 0.5 * np.sin(time) ** 2)
    arrays = {"position": (time, position)}
    for name, side in (("pressure_a", 0.5), ("pressure_b", -0.5)):
        noise = 1e5 * rng.standard_normal(len(time))
        arrays[name] = (time, common + side * force / rig.nominal["piston_area"] + noise)
    assert check(wrong.as_recording(arrays), rig.nominal) is None


def test_a_command_that_a_leak_shifts_midway_has_to_do_with_the_motion() -> None:
    """A seal that tears under a load: the valve holds the load from then on, with far more than it moves it with."""
    effects = (
        ("constant_load", {"force": 355.0}),
        ("leakage_onset", {"time": 11.4, "internal_leakage": 1.15e-10}),
        ("position_sensor_offset", {"offset": -0.0313}),
    )
    test = {"loop": 0.0, "rate": 500.0, "noise": 3.0, "loads": (-808.0,), "effects": effects}
    case = replace(draw_case("recordings", 1, 7077), **test)
    torn = with_other_loads(case)[0]
    assert np.std(torn["voltage_command"][1]) > 0.05
    assert check(wrong.as_recording(torn), {**draw_nominal(), **case.nominal}) is None


def small_test(tier: str, number: int, seed: int) -> wrong.Rig:
    """A rig's test of some per cent of its usual travel, so slow that its valve hardly opens."""
    case = draw_case(tier, number, seed)
    case = KINDS["small"](replace(case, duration=8.0), np.random.default_rng([case.seed, 12]))
    truth = run_on_plant(case)
    arrays = wrong.with_velocity(case, measure(case, truth), truth)
    return wrong.Rig(case, arrays, {**draw_nominal(), **case.nominal})


def test_pressures_that_a_leak_draws_down_while_the_valve_hardly_opens_are_no_mistake() -> None:
    """Both chambers leak to the outside, by more than the piston takes: a sixteenth of the supply is left in them."""
    rig = small_test("tracking", 9, 12121)
    assert rig.case.effect_ids == ("external_leakage",)
    levels = [np.mean(rig.arrays[name][1]) / rig.nominal["supply_pressure"] for name in ("pressure_a", "pressure_b")]
    assert max(levels) < 0.07
    recording = wrong.as_recording(rig.arrays)
    assert not relations(recording, rig.nominal)["level"].sound
    assert check(recording, rig.nominal) is None


SLOW = ("null_parameters", 0, SEED)


@pytest.mark.parametrize("name", ["pressures in kPa", "pressures times 10", "one pressure times 10", "position in mm"])
def test_a_unit_is_told_where_little_but_noise_lies_between_the_pressures(name: str) -> None:
    """The valve hardly opens. What no leak explains is found, and noise between pressures is not taken for a copy."""
    rig = small_test(*SLOW)
    mistake = next(one for one in wrong.MISTAKES if one.name == name)
    assert check(wrong.as_recording(rig.arrays), rig.nominal) is None
    finding = check(wrong.make_wrong(mistake, rig, rig), rig.nominal)
    assert finding is not None and mistake.expected in finding.mistake


@pytest.mark.parametrize("end", [1.0, -1.0])
@pytest.mark.parametrize("lacking", wrong.SUBSETS, ids=lambda names: "without " + "+".join(names))
def test_a_position_in_mm_from_one_end_that_stays_inside_the_stroke_has_two_readings(
    lacking: tuple[str, ...], end: float
) -> None:
    """The piston works in one half of its stroke: counted from that half's end it seems to work in the other."""
    rig = small_test(*SLOW)
    stroke = rig.case.plant["actuator_displacement"]
    time, position = rig.arrays["position"]
    highest = np.max(end * position)
    one_half = end * (end * position - highest - 0.01 * stroke)
    arrays = {**rig.arrays, "position": (time, 1e3 * (one_half + end * stroke))}
    recording = wrong.as_recording({name: pair for name, pair in arrays.items() if name not in lacking})
    finding = check(recording, rig.nominal)
    assert finding is not None and finding.mistake == "position is in mm"
    assert finding.other is not None and finding.other[0] == "position is in mm and is not measured from mid-stroke"
    for cure, back in ((finding.cure, one_half + end * stroke), (finding.other[1], one_half)):
        whole = cured(recording, cure)
        assert check(whole, rig.nominal) is None
        np.testing.assert_allclose(whole.channels["position"].values, back, atol=1e-6)


def draw_nominal() -> dict[str, float]:
    return dict(wrong.nominal_values())


@pytest.mark.parametrize("samples", [3, 40])
def test_too_little_to_judge_is_let_pass(samples: int) -> None:
    time = np.linspace(0.0, 0.01 * samples, samples)
    arrays = {"position": (time, np.sin(time)), "voltage_command": (time, -np.cos(time))}
    assert check(wrong.as_recording(arrays), draw_nominal()) is None
