"""The tests that a diagnosis can prescribe are, in the exam, the voltages of the library's reference generator."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.diagnosis.experiment.design import trials
from eha_core.signals import make_signal, of_reference, signals
from eha_exam.errors import ExamError
from eha_exam.reference_signals import SIGNALS, TAPS, voltage_of

TIME = np.arange(60_001) / 1000.0

OTHERS = [
    {"signal": "sine", "sine.phase": 0.7, "sine.offset": -0.1, "chirp.amplitude": 3.0},
    {"signal": "chirp", "chirp.logarithmic": False, "chirp.duration": 7.0, "chirp.amplitude": 0.4},
    {"signal": "chirp", "chirp.logarithmic": "true", "chirp.start_frequency": 5.0, "chirp.end_frequency": 0.5},
    {"signal": "square", "square.frequency": 0.3, "square.duty": 0.2},
    {
        "signal": "multisine",
        "multisine.count": 5,
        "multisine.seed": 8,
        "multisine.period": 3.0,
        "multisine.lowest": 0.5,
    },
    *({"signal": "prbs", "prbs.order": order, "prbs.seed": 3, "prbs.dwell": 0.013} for order in TAPS),
]


def test_every_test_that_a_diagnosis_may_propose_is_the_generator_s_voltage() -> None:
    proposed = list(trials(0.4, 2.0))
    assert {trial.signal for trial in proposed} == set(SIGNALS)
    for trial in proposed:
        np.testing.assert_array_equal(voltage_of(trial.reference(), TIME), trial.voltage(TIME), err_msg=str(trial))


@pytest.mark.parametrize("reference", OTHERS, ids=str)
def test_other_parameters_mean_what_they_do_there(reference: dict[str, object]) -> None:
    expected = make_signal(*of_reference(reference)).value(TIME)
    np.testing.assert_array_equal(voltage_of(reference, TIME), expected)


@pytest.mark.parametrize("name", SIGNALS)
def test_parameters_have_the_generator_s_names_defaults_and_bounds(name: str) -> None:
    rows = {row.name: (row.default, row.lower, row.upper) for row in signals()[name].parameters()}
    del rows["offset"]
    assert {key: (row.default, row.lower, row.upper) for key, row in SIGNALS[name][1].items()} == rows


@pytest.mark.parametrize(
    ("reference", "message"),
    [
        ({"signal": "step"}, "the signal 'step'; choose sine"),
        ({}, "the signal 'None'"),
        ({"signal": "sine", "sine.amplitud": 1.0}, "did you mean amplitude?"),
        ({"signal": "sine", "sine.frequency": "fast"}, "no number"),
        ({"signal": "sine", "sine.frequency": -1.0}, "out of range; give 0 to 10000"),
        ({"signal": "sine", "sine.amplitude": float("nan")}, "out of range"),
        ({"signal": "prbs", "prbs.order": 99}, "out of range; give 3 to 16"),
        ({"signal": "chirp", "chirp.logarithmic": "often"}, "no truth value"),
        ({"signal": "chirp", "chirp.start_frequency": 10.0}, "start_frequency equals end_frequency"),
        ({"signal": "multisine", "multisine.lowest": 0.01}, "1 / period <= lowest"),
    ],
    ids=str,
)
def test_a_test_that_is_none_is_refused_in_one_line(reference: dict[str, object], message: str) -> None:
    with pytest.raises(ExamError, match=message.replace("?", r"\?")):
        voltage_of(reference, TIME)
