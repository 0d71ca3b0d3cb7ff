"""Faults of a recording stand first on the terminal, and no line runs through what was excluded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eha_core.diagnosis.result import Diagnosis, RecordingFit
from eha_core.health import Fault
from eha_core.report.account import account
from eha_core.report.finding import warnings
from eha_core.report.first_screen import pictures, residual_picture
from eha_core.report.health import excluded, fault_lines
from eha_core.report.picture import Band, Line, Spans
from eha_core.report.stages import read
from eha_core.report.summary_tables import summarise

FROZEN = Fault("position", "frozen", 2.0, 3.0, "frozen at 0.1 m", "see why the sensor repeats its value")
HOLE = Fault("voltage_command", "hole", 4.0, 4.5, "no sample for 0.5 s", "record it without interruption")
HELD = Fault("pressure_a", "held", 0.0, 6.0, "sampled at 50 Hz", "record the sensor at its own rate", False)


def ill(friction: Diagnosis, *faults: Fault) -> Diagnosis:
    return replace(friction, health=tuple((1, fault) for fault in faults))


def test_the_terminal_names_channel_span_and_remedy_before_the_verdict(friction: Diagnosis) -> None:
    text = " ".join(account(ill(friction, FROZEN)).split())
    reported = "position: frozen at 0.1 m, from 2 s to 3 s (excluded); see why the sensor repeats its value"
    assert reported in text and text.index(reported) < text.index("Verdict")
    assert "Health" not in account(friction)
    assert "frozen at 0.1" in str(summarise(ill(friction, FROZEN)))
    assert any("frozen" in sentence for sentence in read.stage(ill(friction, FROZEN)).sentences)


def test_a_hole_of_several_channels_is_told_once(friction: Diagnosis) -> None:
    holes = [replace(HOLE, channel=name) for name in ("voltage_command", "position", "pressure_a")]
    (line,) = fault_lines(ill(friction, *holes))
    assert line.startswith("voltage_command, position, pressure_a: no sample for 0.5 s, from 4 s to 4.5 s")


def test_of_several_recordings_the_number_is_told(friction: Diagnosis) -> None:
    two = tuple(RecordingFit(path, {}, {}) for path in ("a.mcap", friction.path))
    several = replace(friction, together=two, health=((1, FROZEN), (2, HOLE)))
    assert [line.partition(":")[0] for line in fault_lines(several)] == ["recording 1", "recording 2"]
    assert excluded(several, "position") == ((4.0, 4.5),)


def test_the_first_picture_shades_what_was_excluded_and_draws_nothing_there(friction: Diagnosis) -> None:
    picture = residual_picture(ill(friction, FROZEN, HOLE, HELD))
    of_position, of_pressure = picture.groups[0].panels[0], picture.groups[1].panels[0]
    assert [mark.spans for mark in of_position.marks if isinstance(mark, Spans)] == [((2.0, 3.0), (4.0, 4.5))]
    assert [mark.spans for mark in of_pressure.marks if isinstance(mark, Spans)] == [((4.0, 4.5),)]
    assert [type(mark) for mark in of_position.marks] == [Band, Spans, Line]
    (line,) = [mark for mark in of_position.marks if isinstance(mark, Line)]
    drawn = line.x[np.isfinite(line.y)]
    assert not np.any((drawn > 2.001) & (drawn < 2.999)) and np.any(drawn > 4.5)
    assert not any(isinstance(mark, Spans) for mark in residual_picture(friction).groups[0].panels[0].marks)


def test_a_sensors_hole_is_shaded_and_the_page_begins_with_it(friction: Diagnosis) -> None:
    hole = replace(HOLE, channel="position", excludes=False)
    assert excluded(ill(friction, hole), "position") == ((4.0, 4.5),)
    assert excluded(ill(friction, hole), "pressure_a") == ()
    assert warnings(ill(friction, hole)) == ("Position: no sample for 0.5 s, from 4 s to 4.5 s; record it without"
                                             " interruption.",)  # fmt: skip


def test_the_page_names_channels_in_words(friction: Diagnosis) -> None:
    holes = [replace(HOLE, channel=name) for name in ("voltage_command", "pressure_a")]
    (line,) = warnings(ill(friction, *holes))
    assert line.startswith("Voltage command, pressure of chamber A: no sample for 0.5 s")


def test_where_a_part_was_excluded_the_first_picture_shows_it(friction: Diagnosis) -> None:
    assert [picture.name for picture in pictures(ill(friction, FROZEN))][0] == "0-residuals"
    assert [picture.name for picture in pictures(ill(friction, HELD))][0] != "0-residuals"
