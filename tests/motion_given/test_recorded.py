"""What happened to the force in recording is named where it is proved, and otherwise said as a possibility."""

from __future__ import annotations

import numpy as np
import pytest
from benches import TIME, motion, velocity
from measured import needs_dampers, processed, raw, raw_at_5_hz

from eha_core.motion_given import find_law, fit_law
from eha_core.motion_given.recorded import averaging, possible_timing

V = velocity(TIME)
FORCE = 150.0 * np.sign(V) + 900.0 * V
LAW = ("viscous_friction", "coulomb_friction")


def averaged(force: np.ndarray, window: int) -> np.ndarray:
    noisy = force + 2.0 * np.random.default_rng(5).standard_normal(len(force))
    return np.convolve(noisy, np.ones(window) / window, "same")


def test_an_average_is_named_with_its_window_and_the_law_is_that_before_it() -> None:
    bench = motion(averaged(FORCE, 40), noise=0.0)
    law = find_law([bench])
    found = averaging([bench], law)
    assert law.ids == LAW
    assert law.values["coulomb_friction"]["force"].value == pytest.approx(150.0, rel=0.02)
    assert found is not None and found.evidence > 20.0
    assert found.parameters["window"].value == pytest.approx(0.08)
    assert "moving average over 80" in found.statement and "position" not in found.statement


def test_two_windows_that_are_neither_one_time_nor_one_share_are_both_given() -> None:
    benches = [motion(averaged(FORCE, window), noise=0.0) for window in (20, 40)]
    found = averaging(benches, fit_law(benches, LAW))
    assert found is not None
    assert [one.value for one in found.parameters.values()] == pytest.approx([0.04, 0.08])


def test_a_delay_is_a_possibility_and_no_finding() -> None:
    late = np.interp(TIME - 0.02, TIME, FORCE)
    bench = motion(late)
    law = fit_law([bench], LAW)
    assert averaging([bench], law) is None
    (said,) = possible_timing([bench], law)
    late_by = float(said.split("reverses ")[1].split(" ms after")[0])
    assert late_by == pytest.approx(20.0, abs=2.0)
    assert "may be" in said and said.endswith("a second recording at another frequency would tell")


def test_an_average_over_past_samples_is_a_possibility() -> None:
    """Samples say over how many they were averaged, and only the law says when."""
    bench = motion(np.roll(averaged(FORCE, 40), 20), noise=0.0)
    law = fit_law([bench], LAW)
    assert bench.averaged == pytest.approx(0.08)
    (said,) = possible_timing([bench], law)
    late_by = float(said.split("reverses ")[1].split(" ms after")[0])
    assert late_by == pytest.approx(40.0, abs=4.0)
    assert "an average over past samples only" in said


def test_a_force_that_the_law_explains_has_no_timing() -> None:
    bench = motion(FORCE)
    assert possible_timing([bench], fit_law([bench], LAW)) == []


def test_an_analogue_filter_is_a_possibility_and_no_finding() -> None:
    """A first-order lag of 30 ms run both ways: no delay, and no zeros in the spectrum."""
    from scipy.signal import filtfilt

    share = 1.0 - np.exp(-0.002 / 0.03)
    bench = motion(filtfilt([share], [1.0, share - 1.0], 900.0 * np.sign(V)))
    law = fit_law([bench], ["coulomb_friction"])
    assert averaging([bench], law) is None
    (said,) = possible_timing([bench], law)
    assert "turns round more slowly" in said and "does not show an average" in said


@needs_dampers
def test_nothing_is_named_of_the_raw_recordings_alone_or_together() -> None:
    slow, strong, fast = raw(0), raw(4), raw_at_5_hz()
    for motions in ([slow], [strong], [fast], [slow, strong], [slow, strong, fast]):
        assert averaging(motions, fit_law(motions, ["viscous_friction", "bouc_wen_friction"])) is None


@needs_dampers
def test_processed_recordings_agree_on_one_share_of_the_period() -> None:
    motions = [processed(test, "0x5A") for test in ("10mm1Hz", "25mm0x5Hz", "5mm3Hz")]
    found = averaging(motions, fit_law(motions, ["viscous_friction", "bouc_wen_friction"]))
    assert found is not None
    assert 0.095 < found.parameters["share"].value < 0.114
    assert "of the motion's period, and so is the position" in found.statement
    assert found.evidence > 0.0


@needs_dampers
def test_one_processed_recording_gives_its_window_in_seconds() -> None:
    motions = [processed("5mm3Hz", "1A")]
    found = averaging(motions, fit_law(motions, ["viscous_friction", "bouc_wen_friction"]))
    assert found is not None
    assert found.parameters["window"].value == pytest.approx(0.033, abs=1e-9)
