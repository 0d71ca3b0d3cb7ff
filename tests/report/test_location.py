"""Where the nominal equations fail, said in a sentence."""

from __future__ import annotations

from dataclasses import replace

import pytest

from eha_core.diagnosis.result import Location
from eha_core.report.location import location_statement

SITS = "93 % of the recalibrated model's unexplained error is in the force balance of the piston, near zero speed"


@pytest.mark.parametrize(
    ("when", "ending"),
    [
        ((), ""),
        (((0.0, 12.0),), ", through the whole record"),
        (((2.371, 6.7125),), ", from 2.371 s to 6.713 s"),
        (((1.04, 1.5), (3.0, 3.25)), ", in 2 intervals, the first from 1.0 s"),
    ],
)
def test_it_says_how_much_where_and_when(when: tuple[tuple[float, float], ...], ending: str) -> None:
    assert location_statement(Location("force", 0.93, "near zero speed", when)) == SITS + ending


def test_a_stretch_a_law_and_the_only_equation_are_said_as_such() -> None:
    location = Location("force", 0.93, "near zero speed", ((600.0, 612.0),))
    stretch = location_statement(replace(location, all_of_stretch=True))
    assert stretch == SITS + ", through all of the stretch from 600 s on"
    law = location_statement(replace(location, law_over="velocity", all_of_stretch=True))
    assert law == "93 % of the missing physics in the force balance of the piston is a law over velocity"
    alone = location_statement(replace(location, alone=True))
    assert alone == "in the force balance: nothing else was recorded"
