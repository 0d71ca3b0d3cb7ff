"""What the watch sees before a limit is passed, against motions whose limits are known."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.diagnosis.experiment.limits import Limits
from eha_core.investigation import Watch
from eha_core.investigation.watch import AHEAD

LIMITS = Limits(position=0.06, speed=0.3, pressure=25e6)


def first_trouble(positions: np.ndarray, pressure: float = 10e6, limits: Limits = LIMITS) -> tuple[int, str]:
    watch = Watch(limits)
    for place, position in enumerate(positions.tolist()):
        if trouble := watch.trouble(place * 2e-3, position, {"pressure_a": pressure}):
            return place, trouble
    return -1, ""


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_position_limit_is_in_sight_while_there_is_time_to_stop(way: float) -> None:
    positions = way * 0.1 * np.arange(1000) * 2e-3
    place, trouble = first_trouble(positions)
    assert abs(positions[place]) == pytest.approx(0.06 - 0.1 * AHEAD, abs=0.1 * 2.1e-3)
    sign = "-" if way < 0.0 else ""
    assert trouble.startswith(f"position {sign}55.") and "moving at " in trouble
    assert trouble.endswith(": the limit of 60.0 mm is in sight")


def test_a_piston_that_comes_back_from_near_a_limit_goes_on() -> None:
    assert first_trouble(0.0585 - 0.1 * np.arange(500) * 2e-3) == (-1, "")


def test_noise_of_a_usual_sensor_is_no_trouble() -> None:
    positions = 0.0595 + 1e-5 * np.random.default_rng(1).standard_normal(20_000)
    assert first_trouble(positions) == (-1, "")


def test_speed_and_pressure_have_limits_too() -> None:
    assert first_trouble(0.31 * np.arange(100) * 2e-3)[1] == "speed 310 mm/s: the limit is 300 mm/s"
    assert first_trouble(np.zeros(3), 23.7e6) == (-1, "")
    assert first_trouble(np.zeros(3), 23.8e6)[1] == "pressure a 23.8 MPa: the limit of 25.0 MPa is in sight"


def test_feedback_that_is_no_number_is_trouble() -> None:
    assert first_trouble(np.array([0.0, np.nan])) == (1, "position is nan")
