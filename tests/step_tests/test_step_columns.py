"""Columns of step tests: recognised by names and units, chosen, or asked for in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eha_core as eha
from eha_core.errors import EhaError
from eha_core.step_tests import Selection, records_of

TIME = np.arange(0.0, 1.0, 0.01)
COMMAND = np.where(TIME > 0.5, 30.0, 0.0)
MOTION = np.linspace(0.0, 5.0, TIME.size)


def columns(*names: str) -> dict[str, np.ndarray]:
    """A time, and the command first among the other columns."""
    return {"time": TIME, **{name: COMMAND if number == 0 else MOTION for number, name in enumerate(names)}}


@pytest.mark.parametrize(
    "names, chosen, units",
    [
        (("duty [%]", "angle [deg]"), {}, ("%", "deg")),
        (("valve command [V]", "position [mm]"), {}, ("V", "mm")),
        (("coil current [mA]", "piston_position_mm"), {}, ("mA", "mm")),
        (("pilot pressure [bar]", "boom speed [deg/s]", "pump pressure [bar]"), {}, ("bar", "deg/s")),
        (("cmd", "x"), {"units": {"cmd": "%", "x": "mm"}}, ("%", "mm")),
        (("a", "b"), {"command": "a", "motion": "b", "units": {"a": "V", "b": "rad"}}, ("V", "rad")),
        (("Stellsignal [%]", "Winkel [\u00b0]"), {}, ("%", "deg")),
        (("duty [%]", "position [mm]", "velocity [mm/s]"), {}, ("%", "mm")),
        (("duty [%]", "angle [deg]", "target angle [deg]", "coil current [A]"), {}, ("%", "deg")),
    ],
)
def test_columns_are_recognised(names: tuple[str, ...], chosen: dict[str, object], units: tuple[str, str]) -> None:
    (record,) = records_of([columns(*names)], Selection(**chosen))  # type: ignore[arg-type]
    assert (record.command_unit, record.motion_unit) == units
    assert record.is_velocity == units[1].endswith("/s")
    np.testing.assert_array_equal(record.command, COMMAND)
    np.testing.assert_allclose(record.motion, MOTION)


@pytest.mark.parametrize(
    "names, chosen, said",
    [
        (("cmd", "angle [deg]"), {}, "column 'cmd' has no unit; give --unit 'cmd=%'"),
        (("duty [%]", "position"), {}, "column 'position' has no unit; give --unit 'position=mm'"),
        (("duty [%]", "y"), {}, "no column is a position, angle or velocity; choose one with --motion COLUMN"),
        (("y", "angle [deg]"), {}, "no column is a command; choose one with --command COLUMN"),
        (("duty [%]", "boom angle [deg]", "arm angle [deg]"), {}, "choose one with --motion COLUMN"),
        (("duty [%]", "angle [deg]"), {"motion": "angel"}, "has no column 'angel' for --motion"),
        (("duty [%]", "angle [deg]"), {"command": "angle [deg]"}, "cannot be command and motion"),
        (("duty [%]", "angle [deg]", "force [N]"), {"motion": "force [N]"}, "is in N, not in m or rad"),
        (("duty [%]", "angle [deg]"), {"time": "clock"}, "has no column 'clock' for --time"),
        (("duty [%]", "angle [deg]"), {"units": {"z": "mm"}}, "has no column 'z' for --unit"),
        (("duty [%]", "angle [deg]"), {"units": {"angle [deg]": "furlong"}}, "furlong is no unit"),
    ],
)
def test_what_is_not_clear_is_asked_for_in_a_line(names: tuple[str, ...], chosen: dict[str, object], said: str) -> None:
    with pytest.raises(EhaError) as error:
        records_of([columns(*names)], Selection(**chosen))  # type: ignore[arg-type]
    assert said in str(error.value) and "\n" not in str(error.value)


def test_files_are_read_in_the_units_of_the_first() -> None:
    first, second = records_of([columns("u [V]", "x [mm]"), columns("u [mV]", "x [m]")], Selection())
    np.testing.assert_allclose(second.motion, 1e3 * first.motion)
    np.testing.assert_allclose(second.command, 1e-3 * first.command)
    with pytest.raises(EhaError, match="its motion is in deg, that of columns in mm"):
        records_of([columns("u [V]", "x [mm]"), columns("u [V]", "angle [deg]")], Selection())


def test_a_file_without_a_time_or_with_one_that_goes_back() -> None:
    with pytest.raises(EhaError, match="no column is a time; choose one with --time COLUMN"):
        records_of([{"duty [%]": COMMAND, "angle [deg]": MOTION}], Selection())
    back = columns("duty [%]", "angle [deg]")
    back["time"] = np.concatenate([TIME[:50], TIME[:50]])
    with pytest.raises(EhaError, match="the time goes back after 0.49 s"):
        records_of([back], Selection())


def test_rows_without_a_number_are_left_out() -> None:
    holed = columns("duty [%]", "angle [deg]")
    holed["angle [deg]"] = np.where(np.arange(TIME.size) % 7 == 3, np.nan, MOTION)
    (record,) = records_of([holed], Selection())
    assert record.time.size == np.count_nonzero(np.isfinite(holed["angle [deg]"])) and record.has_own_times


def test_a_recording_of_messages(tmp_path: Path) -> None:
    time = np.arange(0.0, 2.0, 0.01)
    volts = np.where((time >= 0.5) & (time < 1.5), 0.03, 0.0)
    from eha_core.recording.simulated import Experiment, simulate, write_simulated

    run = simulate(Experiment(time, volts, 2.0, {}, (), 1e-4, 100.0, 1.0, 1, 0.0))
    write_simulated(tmp_path / "step.mcap", run)
    found = eha.steps([tmp_path / "step.mcap"])
    assert (found.command_unit, found.motion_unit) == ("V", "m")
    (step,) = found.steps
    assert step.level == pytest.approx(0.03) and step.resolution < 1e-6
    assert step.speed is not None and step.speed.value == pytest.approx(0.0355, abs=0.002)
    relabelled = eha.steps([tmp_path / "step.mcap"], units={"position": "rad"})
    assert relabelled.speed_unit == "rad/s"
