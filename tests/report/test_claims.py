"""Every sentence of the page is true of the figures it stands over."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from eha_core.diagnosis.result import ChannelFit, Diagnosis, Location
from eha_core.report.claims import WHITE, equations_hold, improvement, is_noise, noise_floor, residual_headline
from eha_core.report.finding import headline, supporting
from eha_core.report.stages import report_stages

SCALES = {"nm": 1e-9, "µm": 1e-6, "mm": 1e-3, "m": 1.0}


def fits(ratio: float) -> Mapping[str, ChannelFit]:
    return {
        "position": ChannelFit(9e-4, 5e-4, ratio * 1e-5, 1e-5),
        "pressure_a": ChannelFit(9e5, 5e5, 1e4, 1e4),
        "pressure_b": ChannelFit(9e5, 5e5, 1e4, 1e4),
    }


def diagnosis_with(friction: Diagnosis, ratio: float, whiteness: float) -> Diagnosis:
    return replace(friction, held_out=fits(ratio), whiteness={"position": whiteness, "pressure_a": 1.0})


@pytest.mark.parametrize(
    ("ratio", "whiteness", "said"),
    [
        (1.0, 2.0, "The residual is noise"),
        (1.05, WHITE - 0.01, "The residual is noise"),
        (1.0, WHITE + 0.01, "The residual is as small as the noise, but not white in position"),
        (0.4, 61.0, "The residual is as small as the noise, but not white in position"),
        (1.2, 2.0, "The residual is up to 1.2 times the noise"),
        (7.0, 90.0, "The residual is up to 7.0 times the noise"),
    ],
)
def test_noise_is_claimed_where_size_and_whiteness_bear_it(
    friction: Diagnosis, ratio: float, whiteness: float, said: str
) -> None:
    made = diagnosis_with(friction, ratio, whiteness)
    assert residual_headline(made) == said
    assert {one.name: one for one in report_stages(made)}["show"].headline == said
    assert is_noise(made) == (said == "The residual is noise")


def test_white_noise_is_seldom_called_coloured_and_a_drift_always() -> None:
    generator = np.random.default_rng(4)
    from eha_core.diagnosis.verdict import whiteness

    noise = [generator.standard_normal(6000) for _ in range(300)]
    assert np.mean(np.array(whiteness(noise)) > WHITE) < 0.03
    drift = 0.6 * np.sin(np.arange(6000) / 300.0)
    assert min(whiteness([one + drift for one in noise])) > WHITE


@pytest.mark.parametrize("ratio", [0.2, 1.0, 1.4, 80.0, 200.0])
def test_an_improvement_is_told_in_the_figures_own_numbers(friction: Diagnosis, ratio: float) -> None:
    made = diagnosis_with(friction, ratio, 1.0)
    text = improvement(made)
    stated = [float(value) * SCALES[unit] for value, unit in re.findall(r"([\d.]+) (µm|mm|nm)", text)]
    fit = made.held_out["position"]
    expected = [fit.rmse_before, fit.rmse_after]
    assert stated[:2] == pytest.approx(expected, rel=5e-3)
    assert ("falls" in text) == (fit.rmse_after < fit.rmse_before)
    assert ("that is its noise" in text) == (ratio == 1.0)
    assert "that is its noise" not in improvement(diagnosis_with(friction, 1.0, 9.0))
    assert improvement(replace(made, held_out={}, training=fits(ratio))).startswith("The position's")


def test_an_error_that_stays_is_not_told_as_a_change(friction: Diagnosis) -> None:
    text = improvement(diagnosis_with(friction, 90.0, 1.0))
    assert text == "On held-out data, the position's RMS error is 900 µm, as before; its noise is 10.0 µm."


def test_noise_is_called_a_floor_only_where_no_model_is_below_it(friction: Diagnosis) -> None:
    assert "no model can be expected to come closer" in noise_floor(diagnosis_with(friction, 1.0, 1.0))
    assert "no model can" not in noise_floor(diagnosis_with(friction, 0.004, 1.0))
    assert "closer than that to position" in noise_floor(diagnosis_with(friction, 0.004, 1.0))


def test_the_first_sentence_has_each_effect_with_its_95_percent_interval(friction: Diagnosis) -> None:
    # 200.4 N with a deviation of 1.3 N: half an interval is 1.96 times that.
    assert headline(friction) == "The model leaves out Coulomb friction (force 200.4 ± 2.5 N); 95 % intervals."
    likely = replace(friction, verdict="ambiguous")
    assert headline(likely).startswith("The model most likely leaves out")
    both = replace(friction, effects=friction.effects * 2)
    assert headline(both).count("200.4 ± 2.5 N") == 2


def test_what_stands_below_it_is_marked_as_likely_and_true(friction: Diagnosis, ambiguous: Diagnosis) -> None:
    text = " ".join(supporting(friction))
    assert "moving mass 10.9 kg" in text
    assert "internal leakage" not in text  # it did not change
    assert "distinguished from stribeck" not in text
    assert "cannot be distinguished from Stribeck friction" in " ".join(supporting(ambiguous))


def test_equations_are_said_to_hold_where_their_residuals_are_noise(consistent: Diagnosis) -> None:
    generator = np.random.default_rng(1)
    time = np.arange(200) * 0.03

    def headline_of(residual: np.ndarray) -> str:
        pictures = replace(consistent.pictures, equations={"force": (time, residual)})
        made = replace(consistent, pictures=pictures)
        assert equations_hold(made) == (float(np.mean(residual**2)) < 1.5)
        return {one.name: one for one in report_stages(made)}["locate"].headline

    assert headline_of(generator.standard_normal(200)) == "No equation is violated"
    assert headline_of(30.0 * generator.standard_normal(200)) != "No equation is violated"


def test_no_further_test_is_said_to_be_needed_only_where_something_is_settled(
    friction: Diagnosis, unknown: Diagnosis
) -> None:
    assert report_stages(friction)[-1].headline == "No further experiment is needed"
    assert report_stages(unknown)[-1].headline == "No test is proposed"


@dataclass(frozen=True)
class Explaining(Diagnosis):
    """A diagnosis that also says how much it explains and how far it predicts."""

    explained: Any = None
    prediction: Any = field(default_factory=dict)


def explaining(friction: Diagnosis, **more: Any) -> Diagnosis:
    given = {one.name: getattr(friction, one.name) for one in fields(Diagnosis)}
    return Explaining(**{**given, **more})


def test_an_explanation_that_is_not_complete_says_so_first(friction: Diagnosis) -> None:
    rest = Location("orifice", 0.7, "near null", ())
    part = SimpleNamespace(
        share=0.912, times_noise={"position": 3.21, "pressure_a": 1.0}, complete=False, left_over=(rest,), vague=False
    )
    partly = explaining(friction, explained=part)
    assert "and more that is not named" in headline(partly)
    text = " ".join(supporting(partly))
    assert "explains 91.2 % of the" in text
    assert (
        "more is missing, most likely in the valve's flow: the residual is up to 3.21 times the noise, in position"
        in text
    )
    whole = explaining(friction, explained=SimpleNamespace(share=0.9996, times_noise={"position": 1.0}, complete=True))
    assert "more" not in headline(whole)
    assert "explains 99.96 % of the" in " ".join(supporting(whole))
    nearly = SimpleNamespace(share=0.9999991, times_noise={"position": 1.0}, complete=True)
    assert "explains more than 99.99 % of the" in " ".join(supporting(explaining(friction, explained=nearly)))


def test_predictions_stand_in_a_table_in_their_own_units(friction: Diagnosis) -> None:
    ahead = SimpleNamespace(ahead={0.25: 1.2e-5, 1.0: 3.4e-5}, free_running=2.5e-3)
    stage = {one.name: one for one in report_stages(explaining(friction, prediction={"position": ahead}))}["show"]
    table = stage.tables[-1]
    assert table.headings == ("channel", "250 ms ahead", "1.00 s ahead", "free run, the whole record")
    assert table.rows == (("position", "12.0 µm", "34.0 µm", "2.50 mm"),)
