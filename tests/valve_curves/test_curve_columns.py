"""Which columns of a bench's table make which curve, and what is asked where several may."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from bench import sweep, valve_flow
from scipy.io import savemat

from eha_core.errors import EhaError
from eha_core.valve_curves import FLOW, LEAKAGE, PRESSURE, Selection, curves_of

CURRENT = 1e3 * sweep(11)
ROWS = np.linspace(-1.0, 1.0, CURRENT.size)


@pytest.mark.parametrize(
    "names, kinds",
    [
        (["I [mA]", "Q [l/min]"], [FLOW]),
        (["t [s]", "I [mA]", "Q [l/min]", "pA [bar]", "pB [bar]", "pS [bar]", "Temp [°C]"], [FLOW]),
        (["I [mA]", "pA [bar]", "pB [bar]", "pS [bar]", "pT [bar]"], [PRESSURE]),
        (["I [mA]", "load pressure [MPa]"], [PRESSURE]),
        (["I [mA]", "pA [bar]", "pB [bar]", "QL leakage [l/min]"], [LEAKAGE, PRESSURE]),
        (["I [mA]", "Q [l/min]", "leakage [ml/min]"], [LEAKAGE, FLOW]),
        (["Strom_mA", "Leckage [l/min]"], [LEAKAGE]),
        (["command [%]", "flow [gpm]"], [FLOW]),
    ],
)
def test_columns_are_recognised_by_unit_and_name(names: list[str], kinds: list[str]) -> None:
    columns = {name: CURRENT if k == 0 or name.startswith("I ") else (k + 1.0) * ROWS for k, name in enumerate(names)}
    assert [curve.kind for curve in curves_of([columns], Selection())] == kinds


def test_pressure_a_minus_pressure_b_whatever_their_order() -> None:
    columns = {"I [mA]": CURRENT, "p_B [bar]": 10.0 - ROWS, "p_A [bar]": 10.0 + 2.0 * ROWS}
    (curve,) = curves_of([columns], Selection())
    assert curve.response == pytest.approx(3e5 * ROWS)
    (turned,) = curves_of([columns], Selection(response={PRESSURE: ["p_B [bar]", "p_A [bar]"]}))
    assert turned.response == pytest.approx(-3e5 * ROWS)


def test_every_format_gives_the_same_curve(tmp_path: Path) -> None:
    columns = {"I_mA": CURRENT, "Q_lpm": 6e4 * valve_flow(1e-3 * CURRENT)}
    pd.DataFrame(columns).to_csv(tmp_path / "a.csv", index=False)
    pd.DataFrame(columns).to_excel(tmp_path / "a.xlsx", index=False)
    savemat(tmp_path / "a.mat", columns)
    selection = Selection(units={"Q_lpm": "l/min", "I_mA": "mA"})
    for name in ("a.csv", "a.xlsx", "a.mat"):
        (curve,) = curves_of([tmp_path / name], selection)
        assert curve.response == pytest.approx(valve_flow(1e-3 * CURRENT), rel=1e-9, abs=1e-12), name


def test_rows_without_a_number_are_left_out_and_counted() -> None:
    columns = {"I [mA]": CURRENT, "Q [l/min]": np.where(CURRENT > 15.0, np.nan, ROWS)}
    (curve,) = curves_of([columns], Selection())
    assert curve.command.size == np.count_nonzero(CURRENT <= 15.0)
    assert "rows without a number were left out" in curve.remarks[0]


@pytest.mark.parametrize(
    "names, selection, said",
    [
        (["I [mA]", "i2 [mA]", "Q [l/min]"], Selection(), "may be the current; choose one with --current"),
        (["I [mA]", "p1 [bar]", "p2 [bar]", "p3 [bar]"], Selection(), "may be the load pressure; choose one"),
        (["I [mA]", "Q [l/min]"], Selection(units={"q": "bar"}), "has no column 'q' for --unit"),
        (["I [mA]", "Q [l/min]"], Selection(response={LEAKAGE: ["L"]}), "has no column 'L' for --leakage"),
        (["I [mA]", "x [mm]"], Selection(), "no column is a flow or a pressure"),
    ],
)
def test_what_is_open_is_asked_for_in_a_line(names: list[str], selection: Selection, said: str) -> None:
    with pytest.raises(EhaError, match=said.replace("'", ".")):
        curves_of([{name: CURRENT + k for k, name in enumerate(names)}], selection)
