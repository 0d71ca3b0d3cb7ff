"""Every signal by one contract, and each against its definition."""

from __future__ import annotations

from math import isfinite
from pathlib import Path

import numpy as np
import pytest
from scipy import signal as scipy_signal

from eha_core.errors import ParameterError
from eha_core.signals import Signal, from_text, make_signal, of_reference, signals

TIMES = np.arange(0, 30_000) * 1e-3


@pytest.fixture
def csv_path(tmp_path: Path) -> str:
    path = tmp_path / "signal.csv"
    path.write_text("time,remark,u\n5.0,,0.0\n6.0,,2.0\n7.0,,1.0\n")
    return str(path)


@pytest.fixture(params=list(signals()))
def any_signal(request: pytest.FixtureRequest, csv_path: str) -> Signal:
    extra = {"path": csv_path, "column": "u"} if request.param == "csv_file" else {}
    return make_signal(request.param, {**extra, "offset": 0.25})


def test_the_signals_of_the_reference_node_are_there() -> None:
    assert set(signals()) == {
        "sine", "step", "staircase", "trapezoid", "chirp", "multisine", "prbs", "square", "csv_file",
    }  # fmt: skip


def test_every_parameter_is_described(any_signal: Signal) -> None:
    assert any_signal.__doc__ and "offset" in {row.name for row in any_signal.parameters()}
    for row in any_signal.parameters():
        assert len(row.meaning) > 5
        if isinstance(row.default, float):
            assert row.lower <= row.default <= row.upper and (row.unit or row.name in ("duty", "scale"))


def test_numbers_and_arrays_give_the_same(any_signal: Signal) -> None:
    values, rates = any_signal.value(TIMES), any_signal.derivative(TIMES)
    assert values.shape == rates.shape == TIMES.shape
    assert np.isfinite(values).all() and np.isfinite(rates).all()
    for k in (0, 1, 999, 1000, 12_345):
        number = any_signal.value(float(TIMES[k]))
        assert isinstance(number, float) and number == pytest.approx(values[k], rel=1e-13)
        assert any_signal.derivative(float(TIMES[k])) == pytest.approx(rates[k], rel=1e-12, abs=1e-15)


def test_the_derivative_integrates_to_the_value_between_jumps(any_signal: Signal) -> None:
    times = np.arange(0, 200_001) * 1e-4
    values, rates = any_signal.value(times), any_signal.derivative(times)
    gained = 0.5 * (rates[1:] + rates[:-1]) * 1e-4
    smooth = np.abs(np.diff(values)) < 1e-4
    np.testing.assert_allclose(np.diff(values)[smooth], gained[smooth], rtol=0, atol=2e-4)
    assert np.mean(smooth) > 0.3
    if any_signal.name not in ("step", "square", "staircase", "prbs"):
        assert abs(np.sum(gained) - (values[-1] - values[0])) < 1e-3


def test_before_the_start_the_first_value_holds(any_signal: Signal) -> None:
    assert any_signal.value(-3.0) == any_signal.value(0.0)
    assert any_signal.derivative(-3.0) == 0.0


def test_the_offset_is_added(any_signal: Signal) -> None:
    extra = {row.name: getattr(any_signal, row.name) for row in any_signal.parameters()}
    moved = make_signal(any_signal.name, {**extra, "offset": 1.25})
    np.testing.assert_allclose(moved.value(TIMES) - any_signal.value(TIMES), 1.0, rtol=0, atol=1e-15)


def test_made_twice_is_the_same(any_signal: Signal) -> None:
    parameters = {row.name: getattr(any_signal, row.name) for row in any_signal.parameters()}
    again = make_signal(any_signal.name, parameters)
    assert again == any_signal
    np.testing.assert_array_equal(again.value(TIMES), any_signal.value(TIMES))


def test_numbers_out_of_range_are_refused(any_signal: Signal) -> None:
    for row in any_signal.parameters():
        if not isinstance(row.default, float):
            continue
        for value in (
            float("nan"),
            float("inf"),
            *(bound for bound in (row.lower - 1, row.upper + 1) if isfinite(bound)),
        ):
            with pytest.raises(ParameterError, match=rf"{any_signal.name}\.{row.name} = .* is out of range; give"):
                make_signal(any_signal.name, {row.name: value})


def test_sine() -> None:
    sine = from_text("sine:amplitude=8.4e-3,frequency=2,phase=0.5")
    np.testing.assert_allclose(sine.value(TIMES), 8.4e-3 * np.sin(4 * np.pi * TIMES + 0.5), rtol=0, atol=1e-15)


def test_step() -> None:
    step = make_signal("step", {"height": 2.0, "at": 0.3})
    assert step.value(np.array([0.0, 0.299, 0.3, 3 * 0.1, 9.0])).tolist() == [0.0, 0.0, 2.0, 2.0, 2.0]


def test_square_against_scipy() -> None:
    square = make_signal("square", {"amplitude": 3.0, "frequency": 0.7, "duty": 0.3})
    times = TIMES + 0.0003
    np.testing.assert_array_equal(square.value(times), 3.0 * scipy_signal.square(2 * np.pi * 0.7 * times, 0.3))


def test_staircase_goes_up_and_down_on_its_ticks() -> None:
    staircase = make_signal("staircase", {"height": 2.0, "dwell": 0.1, "steps": 3})
    values = staircase.value(np.arange(14) * 0.1)
    assert values.tolist() == [0, 2, 4, 6, 4, 2, 0, 2, 4, 6, 4, 2, 0, 2]


def test_trapezoid_corners() -> None:
    parameters = {"amplitude": 4.0, "rise": 1.0, "hold": 2.0, "rest": 0.5}
    trapezoid = make_signal("trapezoid", parameters)
    assert trapezoid.value(np.array([0.0, 0.5, 1, 3, 3.5, 4, 4.4, 5, 5.5, 8.5, 9])).tolist() == [
        0, 2, 4, 4, 2, 0, 0, -2, -4, 0, 0,
    ]  # fmt: skip
    assert trapezoid.derivative(np.array([0.5, 2.0, 3.5, 4.2, 5.0])).tolist() == [4, 0, -4, 0, -4]
    assert make_signal("trapezoid", {**parameters, "mirrored": False}).value(5.0) == 2.0


@pytest.mark.parametrize("logarithmic", [True, False])
def test_chirp_against_scipy(logarithmic: bool) -> None:
    parameters = {"amplitude": 1.0, "start_frequency": 0.5, "end_frequency": 8.0, "duration": 10.0}
    chirp = make_signal("chirp", {**parameters, "logarithmic": logarithmic})
    times = np.linspace(0.0, 10.0, 2001)
    method = "logarithmic" if logarithmic else "linear"
    expected = scipy_signal.chirp(times, 0.5, 10.0, 8.0, method=method, phi=-90)
    np.testing.assert_allclose(chirp.value(times), expected, rtol=0, atol=1e-10)
    after = np.linspace(10.0, 12.0, 101)
    assert np.max(np.abs(np.diff(chirp.value(after)))) < 2 * np.pi * 8.0 * 0.0201


def test_multisine_has_its_lines_and_its_peak() -> None:
    multisine = make_signal(
        "multisine", {"amplitude": 2.0, "lowest": 0.1, "highest": 10.0, "count": 12, "period": 20.0}
    )
    values = multisine.value(np.arange(20_000) * 1e-3)
    assert np.max(np.abs(values)) == pytest.approx(2.0, rel=1e-3)
    lines = np.abs(np.fft.rfft(values))
    excited = np.flatnonzero(lines > 1e-6 * lines.max())
    assert excited.tolist() == np.unique(np.round(np.geomspace(0.1, 10.0, 12) * 20.0)).astype(int).tolist()
    np.testing.assert_allclose(lines[excited], lines[excited[0]], rtol=1e-9)
    assert multisine.value(3.3) == pytest.approx(multisine.value(23.3), abs=1e-9)
    assert not np.allclose(
        values, make_signal("multisine", {"amplitude": 2.0, "seed": 2}).value(np.arange(20_000) * 1e-3)
    )


@pytest.mark.parametrize("order", range(3, 17))
def test_prbs_is_a_maximum_length_sequence(order: int) -> None:
    length = 2**order - 1
    bits = make_signal("prbs", {"amplitude": 1.0, "dwell": 0.25, "order": order}).value(np.arange(2 * length) * 0.25)
    assert set(bits.tolist()) == {1.0, -1.0}
    np.testing.assert_array_equal(bits[:length], bits[length:])
    assert abs(bits[:length].sum()) == 1.0
    spectrum = np.abs(np.fft.fft(bits[:length])) ** 2
    np.testing.assert_allclose(np.fft.ifft(spectrum).real[1:], -1.0, rtol=0, atol=1e-6)


def test_csv_file(csv_path: str) -> None:
    lines = from_text(f"csv_file:path={csv_path},column=u,scale=10")
    assert lines.value(np.array([0.0, 0.5, 1.0, 1.5, 2.0, 99.0])).tolist() == [0, 10, 20, 15, 10, 10]
    assert lines.derivative(np.array([0.5, 1.5, 3.0])).tolist() == [20, -10, 0]
    held = from_text(f"csv_file:path={csv_path},column=u,hold=true")
    assert held.value(np.array([0.0, 0.999, 1.0, 1.999, 2.0])).tolist() == [0, 0, 2, 2, 1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("sinus:amplitude=1", "there is no signal 'sinus'; did you mean sine"),
        ("sine:height=1", "signal sine has no parameter 'height'; it has amplitude, frequency, phase, offset"),
        ("sine:amplitude", "'amplitude' is no name=value"),
        ("sine:amplitude=big", "sine.amplitude = 'big' is no number; it is height of the sine"),
        ("prbs:order=2.5", "prbs.order = '2.5' is no whole number"),
        ("prbs:order=40", "prbs.order = 40 is out of range; give 3 to 16"),
        ("trapezoid:mirrored=perhaps", "trapezoid.mirrored = 'perhaps' is no truth value"),
        ("chirp:start_frequency=1,end_frequency=1", "chirp: start_frequency equals end_frequency"),
        ("multisine:lowest=5,highest=1", "multisine: needs 1 / period <= lowest <= highest"),
        ("csv_file:path=/absent.csv", r"csv_file.path: /absent.csv: cannot be read \(No such file"),
    ],
)
def test_words_that_make_no_signal_are_refused_in_one_line(text: str, message: str) -> None:
    with pytest.raises(ParameterError, match=message) as caught:
        from_text(text)
    assert "\n" not in str(caught.value)


def test_the_reference_nodes_parameters_choose_a_signal_and_keep_the_others_to_themselves():
    given = {"mode": "voltage", "signal": "sine", "sine.amplitude": 0.1, "sine.frequency": 2.0, "chirp.amplitude": 9.0}
    assert of_reference(given) == ("sine", {"amplitude": 0.1, "frequency": 2.0})
