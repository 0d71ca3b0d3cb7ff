"""Columns as a user names them: found, or refused with the remedy."""

from __future__ import annotations

import pytest

from eha_core.chosen_columns import required, stated_units, the_only, unit_among
from eha_core.errors import EhaError
from eha_core.unit_names import unit_named


def test_a_column_that_is_there_is_taken_and_a_misspelt_one_is_named() -> None:
    assert required("a.csv", ["duty", "boom"], "boom", "--motion") == "boom"
    with pytest.raises(EhaError, match=r"a\.csv: has no column 'bom' for --motion; .*boom"):
        required("a.csv", ["duty", "boom"], "bom", "--motion")


def test_of_several_columns_none_is_chosen() -> None:
    assert the_only("a.csv", [], "command", "--command") is None
    assert the_only("a.csv", ["duty"], "command", "--command") == "duty"
    with pytest.raises(EhaError, match=r"duty and pilot may be the command; choose one with --command COLUMN"):
        the_only("a.csv", ["duty", "pilot"], "command", "--command")


def test_a_unit_must_be_known_and_of_the_quantity() -> None:
    bar = unit_named("bar")
    assert unit_among("a.csv", "p", bar, ("Pa",), "bar") is bar
    with pytest.raises(EhaError, match=r"column 'p' has no unit; give --unit 'p=bar'"):
        unit_among("a.csv", "p", None, ("Pa",), "bar")
    with pytest.raises(EhaError, match=r"column 'p' is in Pa, not in m or rad; choose another column, or give"):
        unit_among("a.csv", "p", bar, ("m", "rad"), "mm")


def test_a_stated_unit_that_is_none_is_refused() -> None:
    assert stated_units({"boom": "deg"}, "deg")["boom"].si == "rad"
    with pytest.raises(EhaError, match=r"--unit boom=degg: degg is no unit"):
        stated_units({"boom": "degg"}, "deg")
