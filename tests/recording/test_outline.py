"""The outline of a signal: whole, whatever its length and however it comes."""

from __future__ import annotations

from math import isnan
from pathlib import Path

import numpy as np
import pytest

from eha_core.recording.inspection import inspect_file
from eha_core.recording.outline import STRETCHES, Outline

ROOT = Path(__file__).resolve().parents[2]


def outline(values: np.ndarray, parts: int = 1) -> np.ndarray:
    taken = Outline()
    for part in np.array_split(values, parts):
        taken.add(part)
    return np.array(taken.pairs())


@pytest.mark.parametrize("count", [1, 7, 299, 300, 301, 600, 601, 12_345, 100_000])
def test_every_value_is_within_its_stretch(count: int) -> None:
    values = np.random.default_rng(count).normal(size=count)
    pairs = outline(values)
    assert min(count, STRETCHES) <= len(pairs) <= 2 * STRETCHES + 1
    width = 1
    while -(-count // width) > 2 * STRETCHES + (count % width > 0):
        width *= 2
    expected = [(part.min(), part.max()) for part in (values[k : k + width] for k in range(0, count, width))]
    np.testing.assert_array_equal(pairs, expected)


def test_parts_make_the_outline_of_the_whole() -> None:
    values = np.sin(np.linspace(0.0, 50.0, 54_321))
    np.testing.assert_array_equal(outline(values, 17), outline(values))


def test_what_is_no_number_leaves_a_gap() -> None:
    values = np.ones(3000)
    values[1000:2000] = np.nan
    values[1500] = np.inf
    pairs = outline(values)
    assert all(isnan(low) and isnan(high) for low, high in pairs[70:120])
    assert tuple(pairs[0]) == tuple(pairs[-1]) == (1.0, 1.0)


def test_columns_and_messages_have_outlines(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("t,x\n" + "".join(f"{k},{k % 50}\n" for k in range(1000)))
    fields = {field.path: field for field in inspect_file(path).fields}
    assert fields["x"].outline[0] == (0.0, 3.0) and max(high for _, high in fields["x"].outline) == 49.0
    bag = inspect_file(ROOT / "bags" / "rig_coulomb_friction.mcap")
    for field in bag.fields:
        assert min(low for low, _ in field.outline) == field.low
        assert max(high for _, high in field.outline) == field.high
