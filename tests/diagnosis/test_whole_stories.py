"""Recordings whose answer is no law of the rig: what fits to them, and a whole diagnosis, make of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made import STEP, recorded

from eha_core.diagnosis import diagnose
from eha_core.diagnosis.calibrate import Calibration, calibrate
from eha_core.diagnosis.common_scale import CLOCK, common_scale
from eha_core.diagnosis.event import event
from eha_core.diagnosis.fitted_values import fitted_parameters
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values
from eha_core.plant import PAPER, Plant
from eha_core.recording import Recording


def with_time(recording: Recording, factor: float, delay: float, *names: str) -> Recording:
    """The recording with some channels stamped by another clock."""
    channels = {
        name: replace(channel, time=factor * channel.time + delay) if name in names else channel
        for name, channel in recording.channels.items()
    }
    return replace(recording, channels=channels, duration=factor * recording.duration)


def pushed() -> Recording:
    """Eleven seconds of a rig as modelled, on which 2 kN push from 4 s to 6 s; it moves before they begin."""
    without = recorded({}, duration=12.0)
    voltage, every = without.channels["voltage_command"].values, round(0.002 / STEP)
    plant, parts = Plant({}, STEP), []
    for first, last, force in ((0, 2500, 0.0), (2500, 3500, 2000.0), (3500, 6000, 0.0)):
        plant.set_parameters({"constant_load.force": force})
        parts.append(plant.run(np.repeat(voltage[first:last], every), every))
    channels = dict(without.channels)
    for number, (name, noise) in enumerate((("position", 1e-5), ("pressure_a", 1e4), ("pressure_b", 1e4))):
        clean = np.concatenate([getattr(part, f"measured_{name}") for part in parts])
        noisy = clean + noise * np.random.default_rng([number, 5]).standard_normal(len(clean))
        channels[name] = replace(channels[name], values=noisy)
    channels = {
        name: replace(one, time=one.time[500:] - 1.0, values=one.values[500:]) for name, one in channels.items()
    }
    return replace(without, channels=channels, duration=11.0)


def calibrated(recording: Recording) -> Calibration:
    """The nominal equations fitted to a recording, as given and with the plant's own parameters free."""
    return calibrate([observe(recording)], NominalModel(nominal_values()), 2e-4)


def test_what_happens_once_is_an_event() -> None:
    """To a window of a second."""
    found = calibrated(pushed())
    span = event(found.shooting, found.nominal, found.nominal)
    assert span is not None and span == pytest.approx((4.0, 6.0), abs=1.1)


def test_a_clock_that_all_channels_share_is_one_scale() -> None:
    true = recorded({}, duration=8.0, amplitude=0.5)
    final = calibrated(with_time(true, 1.5, 0.0, *true.channels)).fitted
    scale = common_scale(final, fitted_parameters(final, nominal_values(), PAPER))
    assert scale is not None and scale.of == CLOCK
    assert scale.factor == pytest.approx(1.5, abs=0.02)


def test_sensors_that_are_late_alike_are_named_as_a_late_valves_rival() -> None:
    late = with_time(recorded({}, duration=8.0), 1.0, 0.025, "position", "pressure_a", "pressure_b")
    found = diagnose(late, nominal_values())
    assert "the valve acts late, or all sensors are stamped late alike" in found.summary
    (effect,) = found.effects
    assert effect.parameters["delay"].value == pytest.approx(0.025, abs=0.001)
