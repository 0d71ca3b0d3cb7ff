"""What is nearly certain to be found is found, what is hardly to be found is not; and the table counts both."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from tools import detection_trials


@pytest.mark.parametrize(("probabilities", "found"), [((0.9999, 0.99999), True), ((1e-5, 1e-4), False)])
def test_an_effect_is_found_if_that_is_nearly_certain(
    probabilities: tuple[float, float], found: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(detection_trials, "PROBABILITIES", probabilities)
    rows = [detection_trials.try_rig(number, 20) for number in range(4)]
    clear = [row for row in rows if "found" in row and (row["predicted"] > 0.999 or row["predicted"] < 1e-3)]
    assert len(clear) >= 2 and all(row["found"] is (row["predicted"] > 0.999) for row in clear)
    assert any(row["found"] is found for row in clear)


def test_the_table_has_as_many_rigs_in_each_bin() -> None:
    rows = [{"predicted": 0.01 * k, "found": k > 50} for k in range(1, 101)] + [{"why": "not found at any size"}]
    head, *lines, told = detection_trials.by_decile(rows)
    assert [line.split(" | ")[1] for line in lines] == ["10"] * 10
    assert lines[0].startswith("| 0.01 to 0.10 | 10 | 0.055 | 0.000 |") and lines[-1].split(" | ")[3] == "1.000"
    assert head.startswith("| predicted") and told == "\n100 rigs compared, 1 with an effect not found at any size"
