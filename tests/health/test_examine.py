"""Every kind of fault is found with its channel and span, and what is sound has none."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import eha_core as eha
from eha_core.health import examine, unsuited
from eha_core.parameters import nominal_values
from eha_core.plant import COLUMNS, PAPER, Plant
from eha_core.recording import Recording, read_recording

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
from tools.hostile.faulty_recordings import EVERY, FAULTS, FaultKind, faulty, verdict  # noqa: E402
from tools.hostile.wrong_recordings import as_recording  # noqa: E402

TIME = np.arange(4000) / 500.0
CHANCE = np.random.default_rng(7)


@pytest.mark.parametrize("kind", FAULTS, ids=lambda kind: kind.name)
def test_a_fault_is_found_with_its_channel_and_span(kind: FaultKind, as_modelled: Recording) -> None:
    arrays = {name: (as_modelled.channels[name].time, as_modelled.channels[name].values) for name in EVERY}
    made, spans = faulty(kind, arrays, 5)
    recording = as_recording(made)
    faults = (*examine(recording).faults, *unsuited(recording, nominal_values(), PAPER))
    assert verdict(kind, faults, spans, arrays[kind.channel][0]) == "found"
    of_all = kind.name in ("hole of all channels", "log of 20 Hz")
    assert of_all or {fault.channel for fault in faults} == {kind.channel}


@pytest.mark.parametrize("bag", sorted((ROOT / "bags").glob("*.mcap")), ids=lambda path: path.stem)
def test_no_recording_of_the_repository_has_a_fault(bag: Path) -> None:
    recording = read_recording(bag)
    assert examine(recording).faults == ()
    assert not unsuited(recording, nominal_values(), PAPER)


def position(motion: np.ndarray, noise: float, step: float = 0.0) -> Recording:
    """A recording of a motion [m] by a sensor with that noise and quantisation [m]."""
    values = motion + noise * CHANCE.standard_normal(len(motion))
    if step:
        values = np.round(values / step) * step
    return eha.Recording.from_arrays(time=np.arange(len(motion)) / 500.0, position=values)


WAVE = 0.02 * np.sin(2.0 * np.pi * 0.7 * TIME)
STILL = 0.02 * np.sin(2.0 * np.pi * 0.7 * (TIME - np.clip(TIME - 2.0, 0.0, 3.0)))
RAMP = 0.01 * np.abs((TIME + 1.0) % 4.0 - 2.0)
STOP = np.clip(WAVE, -0.015, 0.015)
SOUND = {
    "in motion": position(WAVE, 1e-5),
    "with an encoder of its noise": position(WAVE, 1e-5, 1e-5),
    "with a coarse encoder": position(WAVE, 1e-6, 1e-4),
    "with an encoder and no noise": position(WAVE, 0.0, 2e-5),
    "a rest": position(STILL, 1e-5),
    "a rest with a coarse encoder": position(STILL, 1e-6, 1e-4),
    "a rest with an encoder finer than its noise": position(STILL, 1e-5, 5e-6),
    "a rest without noise": position(STILL, 0.0),
    "ramps with an encoder and no noise": position(RAMP, 0.0, 1e-5),
    "ramps with an encoder": position(RAMP, 2e-6, 2e-5),
    "at a stop": position(STOP, 1e-5),
    "at a stop with a coarse encoder": position(STOP, 1e-6, 1e-4),
    "a tiny motion": position(0.002 * WAVE, 1e-5),
    "a creep": position(1e-5 * TIME + 1e-5 * np.sin(TIME), 1e-5, 5e-6),
}


@pytest.mark.parametrize("name", SOUND)
def test_a_sound_position_has_no_fault(name: str) -> None:
    assert examine(SOUND[name]).faults == ()


STEPS = np.repeat(CHANCE.choice((-1.0, 1.0), 80), 50)
COMMANDS = {
    "a binary sequence": STEPS,
    "a staircase": np.repeat(CHANCE.standard_normal(400), 10),
    "a staircase of equal steps": np.repeat([0.0, 1.0, 2.0, 3.0], 1000),
    "a triangle": np.abs((TIME * 5.0) % 2.0 - 1.0),
    "a trapezoid": np.clip(2.0 * np.sin(2.0 * np.pi * TIME), -1.0, 1.0).round(1),
    "one step": np.where(TIME > 3.0, 1.0, 0.0),
    "a sine": np.sin(2.0 * np.pi * TIME),
    "pulses one way beside small steps": 0.05 * STEPS + np.where(TIME % 2.0 < 0.2, 5.0, 0.0),
    "of a loop with noise": WAVE + 0.001 * CHANCE.standard_normal(len(TIME)),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_a_sound_command_has_no_fault(name: str) -> None:
    beside = SOUND["a rest"].channels["position"].values
    recording = eha.Recording.from_arrays(time=TIME, voltage_command=COMMANDS[name], position=beside)
    assert examine(recording).faults == ()


@pytest.mark.parametrize("again", [4, 400])
def test_a_command_that_freezes_and_soon_steps_again_is_frozen(again: int) -> None:
    """A staircase with dither; after the frozen part it may step at once."""
    steps = np.where((TIME * 500.0 - 2000 - again) % 800 < 400, 1.0, -1.0)
    command = steps + 0.2 * np.sin(2.0 * np.pi * 4.03 * TIME)
    command[1300:2001] = command[1300]
    beside = SOUND["a rest"].channels["position"].values
    faults = examine(eha.Recording.from_arrays(time=TIME, voltage_command=command, position=beside)).faults
    assert [(fault.fault, fault.start, fault.end) for fault in faults] == [("frozen", TIME[1300], TIME[2000])]


def test_a_command_that_is_sent_only_where_it_changes_has_no_hole() -> None:
    moments = np.cumsum(CHANCE.exponential(0.1, 100))
    sent = eha.Recording.from_arrays(time=moments, voltage_command=CHANCE.standard_normal(100))
    assert examine(sent).faults == ()


@pytest.mark.parametrize("step", [0.0, 0.5, 1.0, 2.0, 5.0])
def test_noise_alone_is_no_fault(step: float) -> None:
    """Two hundred channels of 4 s at each resolution, where each check may find a fault in one of a million."""
    found = []
    for seed in range(20):
        noise = np.random.default_rng([seed, 3]).standard_normal((10, 2000)) + 5.0 * np.sin(TIME[:2000])
        noise = np.round(noise / step) * step if step else noise
        for values in noise:
            recording = eha.Recording.from_arrays(time=TIME[:2000], pressures="gauge", pressure_a=1e5 * values)
            found += examine(recording).faults
    assert found == []


@pytest.mark.parametrize(("volts", "kinds"), [(0.08, []), (0.12, ["still"])])
def test_a_piston_stays_under_a_small_command_and_is_blocked_under_another(volts: float, kinds: list[str]) -> None:
    """Overlap and hysteresis may take 5 % of the rated 2 V, from end to end."""
    resting = 1e-5 * np.random.default_rng(4).standard_normal(len(TIME))
    command = 0.5 * volts * np.sin(2.0 * np.pi * TIME)
    recording = eha.Recording.from_arrays(time=TIME, voltage_command=command, position=resting)
    assert [fault.fault for fault in unsuited(recording, nominal_values(), PAPER)] == kinds


@pytest.mark.parametrize(
    ("what", "kinds"),
    [
        ("stuck sensor", ["still"]),
        ("stuck sensor, one pressure", ["still"]),
        ("motion below the noise", []),
        ("overlap", []),
        ("friction", []),
        ("no pressures", []),
    ],
)
def test_under_a_small_command_the_pressures_show_whether_the_piston_moved(what: str, kinds: list[str]) -> None:
    """3 % of the rated voltage moves the nominal piston, unless overlap absorbs it or friction holds the piston."""
    generator = np.random.default_rng(6)
    command = 0.03 * np.sin(2.0 * np.pi * 0.5 * TIME)
    held = {"overlap": {"valve_deadband.half_width": 1e-3}, "friction": {"coulomb_friction.force": 2e4}}
    moved = Plant({**nominal_values(), **held.get(what, {})}, 2e-4).run(np.repeat(command, 10), 10)
    assert (np.ptp(moved.position) > 1e-3) != (what in held)
    pressures = {
        name: moved.values[:, COLUMNS.index(name)] + 1e4 * generator.standard_normal(len(TIME))
        for name in {"no pressures": (), "stuck sensor, one pressure": ("pressure_b",)}.get(what, EVERY[2:])
    }
    noise = generator.standard_normal(len(TIME))
    seen = moved.position - np.mean(moved.position) + 0.1 * noise
    position = seen if what == "motion below the noise" else 1e-5 * noise
    arrays = {"voltage_command": command, "position": position, **pressures}
    recording = as_recording({name: (TIME, values) for name, values in arrays.items()})
    assert [fault.fault for fault in unsuited(recording, nominal_values(), PAPER)] == kinds


def pressure(values: np.ndarray) -> Recording:
    """A pressure [Pa] at 200 Hz."""
    time = np.arange(len(values)) / 200.0
    return eha.Recording.from_arrays(time=time, pressures="gauge", pressure_a=values)


@pytest.mark.parametrize(("creep", "noise"), [(2.5e-5, 3e-6), (2.5e-6, 2e-5)])
def test_a_sensor_that_changes_between_two_levels_neither_wraps_nor_shows_that_nothing_moves(
    creep: float, noise: float
) -> None:
    """A piston that creeps by a share of its encoder's 0.1 mm about the edge of a level."""
    command = np.sin(2.0 * np.pi * 0.25 * TIME)
    moved = 5e-5 + creep * command + noise * np.random.default_rng(3).standard_normal(len(TIME))
    shown = np.round(moved / 1e-4) * 1e-4
    recording = eha.Recording.from_arrays(time=TIME, voltage_command=command, position=shown)
    assert len(np.unique(shown)) == 2
    assert (*examine(recording).faults, *unsuited(recording, nominal_values(), PAPER)) == ()


def test_a_converter_that_shows_two_levels_has_no_spikes() -> None:
    """A pressure that rests by the edge of a level is now and then on the next one."""
    values = np.full(1600, 1.04e7)
    values[[263, 667, 1201]] += 1.96e5
    assert examine(pressure(values)).faults == ()


@pytest.mark.parametrize(("rings", "kinds"), [(1.0, []), (0.0, ["spikes"])])
def test_a_blow_after_which_the_oil_rings_is_no_spike(rings: float, kinds: list[str]) -> None:
    """One sample of 1.4 MPa in a pressure of +-0.5 MPa, as a rig's at 200 Hz, and what rings after it."""
    time = np.arange(1600) / 200.0
    values = 4.8e6 + 5e5 * np.sin(2.0 * np.pi * 0.5 * time)
    values += 2e4 * np.random.default_rng(5).standard_normal(len(time))
    values[800] -= 1.4e6
    values[801:805] += rings * np.array([3.4e5, 0.0, -3.5e5, 1.7e5])
    assert [fault.fault for fault in examine(pressure(values)).faults] == kinds


@pytest.mark.parametrize("apart", [1, 2, 3, 4, 6])
@pytest.mark.parametrize("second", [1.0, -0.6])
def test_spikes_close_together_are_all_excluded(apart: int, second: float) -> None:
    """With a sample between two of one size it is not known which of the three are right: all may be excluded."""
    time = np.arange(1600) / 200.0
    values = 4.8e6 + 5e5 * np.sin(2.0 * np.pi * 0.5 * time)
    values += 2e4 * np.random.default_rng(5).standard_normal(len(time))
    places = [300, 800, 800 + apart, 1200]
    values[places] += 1.4e6 * np.array([1.0, 1.0, second, -1.0])
    health = examine(pressure(values))
    assert [fault.fault for fault in health.faults] == ["spikes"]
    lost = health.lost["pressure_a"]
    assert np.all(lost[places]) and np.count_nonzero(lost) <= len(places) + 1


@pytest.mark.parametrize("period", [2.0, 2.5, 3.0, 4.0, 6.0])
@pytest.mark.parametrize("kept", [0.75, 0.9, 0.97])
def test_oil_that_rings_at_any_frequency_has_no_spikes(period: float, kept: float) -> None:
    """A pressure at 200 Hz that rings after a shock; a sample keeps so much of the amplitude of the one before."""
    time = np.arange(1600) / 200.0
    values = 4.8e6 + 5e5 * np.sin(2.0 * np.pi * 0.5 * time)
    values += 2e4 * np.random.default_rng(5).standard_normal(len(time))
    since = np.arange(800.0)
    values[800:] += 2e6 * kept**since * np.cos(2.0 * np.pi * since / period)
    assert "spikes" not in [fault.fault for fault in examine(pressure(values)).faults]


@pytest.mark.parametrize("rate", [0.0, 0.01, -0.02])
def test_sensors_of_another_clock_follow_ever_later_or_earlier(rate: float) -> None:
    """Twelve seconds of a speed that follows noise of 4 Hz by 20 ms, stamped by a clock that runs so much faster."""
    time = np.arange(6000) / 500.0
    generator = np.random.default_rng(6)
    tones = [(frequency, generator.uniform(0.0, 2.0 * np.pi)) for frequency in np.arange(0.3, 4.0, 0.17)]
    command = sum(np.sin(2.0 * np.pi * frequency * time + phase) for frequency, phase in tones)
    moved = sum(-np.cos(2.0 * np.pi * f * (time - 0.02) + phase) / f for f, phase in tones)
    arrays = {"voltage_command": (time, command), "position": ((1.0 + rate) * time, 1e-3 * moved)}
    found = unsuited(as_recording(arrays), nominal_values(), PAPER)
    assert [fault.fault for fault in found] == (["clock"] if rate else [])
    if found:
        assert f"{100.0 * abs(rate):.2g} % {'fast' if rate > 0.0 else 'slow'}" in found[0].seen


def test_a_position_that_passes_the_end_of_its_counter_slowly_wraps_all_the_same() -> None:
    """With noise of ten times its motion in a sample, and one sample in a hundred lost, it leaps there many times."""
    generator = np.random.default_rng(8)
    true = WAVE + 1e-3 * generator.standard_normal(len(TIME))
    kept = generator.random(len(TIME)) > 0.01
    wrapped = np.where(true > 0.008, true - 0.06, true)
    recording = eha.Recording.from_arrays(time=TIME[kept], position=wrapped[kept])
    health = examine(recording)
    assert {fault.fault for fault in health.faults} == {"wrapped"}
    _, values = health.sound(recording.channels["position"])
    assert np.min(values) > -0.03 and np.max(values) < 0.009
    assert len(values) > 0.5 * len(TIME)


def test_a_position_that_wraps_while_samples_are_missing_is_on_the_other_turn_from_then_on() -> None:
    wrapped = np.where(WAVE > 0.008, WAVE - 0.06, WAVE)
    leaps = np.flatnonzero(np.abs(np.diff(wrapped)) > 0.03)
    hole = np.abs(TIME - TIME[leaps[2]]) < 0.04
    health = examine(eha.Recording.from_arrays(time=TIME[~hole], position=wrapped[~hole]))
    assert {fault.fault for fault in health.faults} == {"wrapped"}
    assert np.array_equal(health.lost["position"], wrapped[~hole] < WAVE[~hole])


@pytest.mark.parametrize(("factor", "kinds"), [(1.0, []), (4.0, ["jump"])])
def test_a_scale_that_leaps_takes_a_coarse_sensors_levels_along(factor: float, kinds: list[str]) -> None:
    """A pressure in steps of 75 kPa whose oil rings three times as much from 5 s on."""
    generator = np.random.default_rng(11)
    rough = 6e4 * np.where(TIME < 5.0, 1.0, 3.0) * generator.standard_normal(len(TIME))
    shown = np.round((4e6 + 5e5 * np.sin(2.0 * np.pi * 0.5 * TIME) + rough) / 7.5e4) * 7.5e4
    values = np.where(TIME < 5.0, shown, factor * shown)
    recording = eha.Recording.from_arrays(time=TIME, pressures="gauge", pressure_a=values)
    assert [fault.fault for fault in examine(recording).faults] == kinds


def test_a_scale_leaps_at_the_moment_of_the_leap_whatever_the_noise_of_blocks_does() -> None:
    """A pressure that turns to kPa at 5.013 s; its noise grows and shrinks slowly by a tenth."""
    generator = np.random.default_rng(9)
    noise = 1e4 * (1.0 + 0.1 * np.sin(2.0 * np.pi * 0.2 * TIME)) * generator.standard_normal(len(TIME))
    values = 4e6 + 1e6 * np.sin(2.0 * np.pi * 0.5 * TIME) + noise
    recording = eha.Recording.from_arrays(
        time=TIME, pressures="gauge", pressure_a=np.where(TIME >= 5.013, 1e-3 * values, values)
    )
    (fault,) = examine(recording).faults
    assert fault.fault == "jump" and fault.start == pytest.approx(5.013, abs=0.003)


def test_a_command_of_steps_that_drops_to_a_fill_value_is_told_from_its_steps() -> None:
    """Four times 40 ms at -10 V in steps of 1 V; the last beside a step."""
    dropped = STEPS.copy()
    for first in (510, 1220, 2030, 3140):
        dropped[first : first + 20] = -10.0
    recording = eha.Recording.from_arrays(time=TIME, voltage_command=dropped, position=WAVE)
    faults = [fault for fault in examine(recording).faults if fault.channel == "voltage_command"]
    assert [fault.fault for fault in faults] == 4 * ["dropped"]
    assert faults[0].span == pytest.approx((TIME[510], TIME[529]))


@pytest.mark.parametrize("every", [5, 10])
def test_a_position_is_interpolated_where_its_corners_do_not_show_too(every: int) -> None:
    """Rests of a quiet sensor, in which most bends are far below those of the moves, up to the end."""
    slow = TIME[::every]
    moves = 0.02 * np.interp(slow, [0.0, 1.0, 1.2, 3.0, 3.2, 5.0, 5.2, 8.0], [0.0, 0.0, 1.0, 1.0, -1.0, -1.0, 0.5, 0.5])
    values = moves + 1e-5 * np.random.default_rng(3).standard_normal(len(slow))
    recording = eha.Recording.from_arrays(time=TIME, position=np.interp(TIME, slow, values))
    health = examine(recording)
    assert [(fault.fault, fault.seen) for fault in health.faults] == [
        ("interpolated", f"interpolated from {500 / every:g} Hz")
    ]
    kept = np.flatnonzero(~health.lost["position"])
    assert np.count_nonzero(kept % every) <= 2 * every and len(kept) > 0.95 * len(slow)
