"""The published experiment against its printed values, an independent integration and the closed form."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eha_core.paper import LEVELS, Experiment, Reproduction, as_json, as_markdown, closed_form, reproduce
from eha_core.signals.sine import Sine

# Table 1, written out once more so that nothing here rests on the library's own rows.
R_C, L_C, XI, OMEGA, K, BETA = 100.0, 0.59, 0.48, 543.0, 2.38e-5, 1.4e9
P_S, K_S, X_S, A_P, M_P, B_S, V_LINE = 2.1e7, 10.0, 0.1, 645e-6, 9.0, 2000.0, 1e-5
AMPLITUDE, DURATION, STEP = 8.4e-3, 2.0, 1e-4


@pytest.fixture(scope="module")
def reproduction() -> Reproduction:
    """The experiment as `eha paper` carries it out."""
    return reproduce()


def signed_root(difference: float) -> float:
    """sign(d) sqrt |d|, the orifice law of equation (3)."""
    return float(np.sign(difference) * np.sqrt(abs(difference)))


def right_hand_side(time: float, state: np.ndarray, leakage: float, voltage: float) -> list[float]:
    """Equations (1) to (10) as printed, corrected for the misprints, without the stroke's ends."""
    current, spool, spool_rate, first, second, position, velocity = state
    if spool >= 0.0:
        into_first, out_of_second = K * spool * signed_root(P_S - first), K * spool * signed_root(second)
    else:
        into_first, out_of_second = K * spool * signed_root(first), K * spool * signed_root(P_S - second)
    past_the_seal = leakage * (first - second)
    return [
        (voltage - R_C * current) / L_C,
        spool_rate,
        OMEGA**2 * (current - spool) - 2.0 * XI * OMEGA * spool_rate,
        BETA / (V_LINE + A_P * (X_S + position)) * (into_first - past_the_seal - A_P * velocity),
        BETA / (V_LINE + A_P * (X_S - position)) * (A_P * velocity - out_of_second + past_the_seal),
        velocity,
        (A_P * (first - second) - B_S * velocity - K_S * position) / M_P,
    ]


def radau_displacement(leakage: float, times: np.ndarray) -> np.ndarray:
    """Displacement [m] under the continuous sine, by Radau at 1e-10."""
    solution = solve_ivp(
        lambda time, state: right_hand_side(time, state, leakage, AMPLITUDE * np.sin(2.0 * np.pi * time)),
        (0.0, times[-1]),
        [0.0, 0.0, 0.0, P_S / 2, P_S / 2, 0.0, 0.0],
        method="Radau",
        rtol=1e-10,
        atol=[1e-14, 1e-14, 1e-11, 1e-3, 1e-3, 1e-14, 1e-12],
        t_eval=times,
    )
    assert solution.success
    return np.asarray(solution.y[5])


@pytest.mark.parametrize("number", [1, 2, 3])
def test_first_three_levels_are_within_one_percent_of_table_3(reproduction: Reproduction, number: int) -> None:
    assert reproduction.levels[number - 1].ratio == pytest.approx(1.0, abs=0.01)


def test_fourth_level_stays_seven_to_nine_percent_low(reproduction: Reproduction) -> None:
    assert 0.91 <= reproduction.levels[3].ratio <= 0.93


def test_radau_gives_the_same_errors() -> None:
    # The held command lags the continuous sine by half a step; a phase of that much brings the two together.
    command = Sine(amplitude=AMPLITUDE, frequency=1.0, phase=np.pi * STEP)
    levels = reproduce(Experiment(command=command, duration=DURATION, step_size=STEP)).levels
    times = levels[0].time
    reference = radau_displacement(0.0, times)
    np.testing.assert_allclose(levels[0].reference, reference, rtol=0.0, atol=1e-9)
    for level in (levels[0], levels[3]):
        displacement = radau_displacement(level.internal_leakage, times)
        np.testing.assert_allclose(level.displacement, displacement, rtol=0.0, atol=1e-7)
        assert level.rmse == pytest.approx(np.sqrt(np.mean((displacement - reference) ** 2)), rel=1e-4)


def test_closed_form_holds_without_the_spring_it_neglects() -> None:
    levels = reproduce(Experiment(parameters={"spring_stiffness": 0.0})).levels
    for level in levels:
        assert level.rmse == pytest.approx(level.closed_form, rel=0.01)


def test_closed_form_of_level_1_by_hand() -> None:
    # k = 1e-12 * 2000 / (645e-6)^2 = 0.00480740...; 0.0048074 / 1.0048074 = 0.0047844
    assert closed_form(1e-12, 1.0) == pytest.approx(0.0047844, abs=1e-7)


def test_error_grows_with_leakage_and_saturates(reproduction: Reproduction) -> None:
    sweep = reproduction.sweep
    assert np.all(np.diff(sweep.rmse) > 0.0)
    assert sweep.rmse[-1] < np.sqrt(np.mean(reproduction.levels[0].reference ** 2))


def test_table_states_what_was_computed(reproduction: Reproduction) -> None:
    rows = as_json(reproduction.levels)["levels"]
    assert [row["internal_leakage"] for row in rows] == list(LEVELS)
    for row, level in zip(rows, reproduction.levels, strict=True):
        assert row["rmse"] == pytest.approx(np.sqrt(np.mean((level.displacement - level.reference) ** 2)))
        assert row["ratio"] == pytest.approx(row["rmse"] / row["printed"])
    assert "| 4 | 1e-09 | " in as_markdown(reproduction.levels)
