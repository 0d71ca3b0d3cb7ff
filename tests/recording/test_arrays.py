"""Recordings made of arrays and data frames."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from eha_core.errors import RecordingError
from eha_core.recording import Recording

TIME = np.arange(400) / 200.0
POSITION = 0.02 * np.sin(TIME)
PRESSURE = 1e7 + 1e5 * np.cos(TIME)


def test_arrays_are_channels_and_absolute_pressures_become_gauge() -> None:
    recording = Recording.from_arrays(time=TIME + 7.0, position=POSITION, pressure_a=PRESSURE)
    assert recording.duration == pytest.approx(TIME[-1])
    np.testing.assert_allclose(recording.channels["position"].time, TIME, atol=1e-9)
    np.testing.assert_array_equal(recording.channels["position"].values, POSITION)
    np.testing.assert_allclose(recording.channels["pressure_a"].values, PRESSURE - 101325.0)
    gauge = Recording.from_arrays(time=TIME, pressure_a=PRESSURE, pressures="gauge")
    np.testing.assert_array_equal(gauge.channels["pressure_a"].values, PRESSURE)


def test_a_frame_s_columns_are_found_by_name_or_as_told() -> None:
    frame = pd.DataFrame({"t": TIME, "position": POSITION, "p_head": PRESSURE, "note": "run 3"})
    recording = Recording.from_dataframe(frame, {"pressure_a": "p_head"}, time="t")
    assert set(recording.channels) == {"position", "pressure_a"}
    again = pd.DataFrame(recording.to_dict())
    np.testing.assert_allclose(again["pressure_a"], PRESSURE - 101325.0)


def test_a_frame_s_index_is_its_time_and_dates_count_from_the_first() -> None:
    dates = pd.Timestamp("2024-05-01T08:00") + pd.to_timedelta(TIME, unit="s")
    for index in (dates, pd.to_timedelta(TIME, unit="s"), TIME):
        recording = Recording.from_dataframe(pd.DataFrame({"position": POSITION}, index=index))
        np.testing.assert_allclose(recording.channels["position"].time, TIME, atol=2e-9)


def test_voltage_is_held_where_a_frame_is_made_of_channels_of_other_rates() -> None:
    position = Recording.from_arrays(time=TIME, position=POSITION).channels["position"]
    volts = Recording.from_arrays(time=[0.0, 1.0], voltage_command=[0.1, 0.2]).channels["voltage_command"]
    both = Recording(position.name, {"position": position, "voltage_command": volts}, 0, 2.0, {}, (), None, ())
    np.testing.assert_array_equal(both.to_dict()["voltage_command"], np.where(TIME < 1.0, 0.1, 0.2))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"time": TIME}, "no channel was given"),
        ({"time": TIME, "positon": POSITION}, "'positon' is not a channel; did you mean position?"),
        ({"time": TIME, "position": POSITION[1:]}, "position has 399 values and time 400"),
        ({"time": TIME, "position": POSITION[:, None]}, "position has the shape"),
        ({"time": TIME, "position": ["a"] * 400}, "position has values that are not numbers"),
        ({"time": TIME * np.nan, "position": POSITION}, "time has values that are not numbers"),
        ({"time": TIME, "pressure_a": PRESSURE / 1e6}, "give its `scale` to Pa"),
        ({"time": TIME, "pressure_a": PRESSURE, "pressures": "psi"}, "say 'absolute' or 'gauge'"),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(given: dict, said: str) -> None:
    with pytest.raises(RecordingError, match=said.replace("?", r"\?")) as refused:
        Recording.from_arrays(**given)
    assert "\n" not in str(refused.value)


def test_a_column_that_is_not_there_is_named() -> None:
    frame = pd.DataFrame({"time": TIME, "x": POSITION})
    with pytest.raises(RecordingError, match="no column 'y'; the columns are time, x"):
        Recording.from_dataframe(frame, {"position": "y"})
    with pytest.raises(RecordingError, match="'positon' is not a channel; did you mean position"):
        Recording.from_dataframe(frame, {"positon": "x"})
