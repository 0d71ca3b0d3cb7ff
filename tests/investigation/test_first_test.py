"""The first test stays within limits that nobody's rig may pass."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.diagnosis.experiment.limits import Limits, extremes
from eha_core.errors import EhaError
from eha_core.investigation import first_test
from eha_core.nominal import nominal_of
from eha_core.plant import Plant

LIMITS = Limits(position=0.06, speed=0.1, pressure=25e6, voltage=1.0)


def test_a_multisine_well_within_the_limits_is_chosen() -> None:
    test = first_test("", 4.0, nominal_of({}), LIMITS)
    assert (test.signal.signal, test.duration) == ("multisine", 4.0)
    voltages = np.repeat(test.signal.voltage(np.arange(2000) * 2e-3), 20)
    reached = extremes(Plant().run(voltages, 10).values, 1e-3)
    assert 0.02 < reached["speed"] < 0.5 * LIMITS.speed


def test_a_signal_that_was_given_is_taken_and_lasts_ten_seconds() -> None:
    test = first_test("sine:amplitude=0.2,frequency=3", 0.0, nominal_of({}), LIMITS)
    assert test.duration == 10.0
    assert test.signal.settings().startswith("amplitude 200 mV, frequency 3.00 Hz")
    assert test.largest == pytest.approx(0.2, rel=1e-3)


def test_a_voltage_beyond_the_limit_is_refused() -> None:
    with pytest.raises(EhaError, match=r"the first test reaches 1\.2 V, the limit is 1 V; give less"):
        first_test("sine:amplitude=1.2,frequency=5", 2.0, nominal_of({}), LIMITS)
    with pytest.raises(EhaError, match="there is no signal 'sinus'"):
        first_test("sinus", 2.0, nominal_of({}), LIMITS)
