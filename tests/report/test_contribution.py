"""Several effects listed one by one: the order, the values, and what each contributes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eha_core.diagnosis.result import Diagnosis, FittedValue
from eha_core.report.account import account
from eha_core.report.claims import residual_in_words
from eha_core.report.contribution import contribution, effect_table, ladder_picture, step_table
from eha_core.report.finding import headline, identified_parameters, warnings
from eha_core.report.html import page
from eha_core.report.picture import Bars, Cells, Upright
from eha_core.report.rivals_picture import rung
from eha_core.report.stages import report_stages
from eha_core.report.summary_tables import summarise


def bars_of(diagnosis: Diagnosis) -> Bars:
    picture = ladder_picture(diagnosis)
    assert picture is not None
    (bars,) = (mark for group in picture.groups for mark in group.panels[0].marks if isinstance(mark, Bars))
    return bars


def test_the_way_to_the_noise_has_every_model_with_what_it_leaves(several: Diagnosis) -> None:
    bars = bars_of(several)
    assert bars.names == (
        "nominal model", "recalibrated, nothing added", "without valve deadband", "without Coulomb friction",
        "without constant load", "with all of them",
    )  # fmt: skip
    nominal, recalibrated, augmented = (one.residual.overall for one in several.steps)
    overall = [nominal, recalibrated, *(one.overall for one in several.without.values()), augmented]
    assert 10.0 ** bars.x[:-1] == pytest.approx(overall[:-1])
    assert [float(text) for text in bars.texts] == pytest.approx(overall, rel=5e-3)
    picture = ladder_picture(several)
    assert picture is not None
    threshold = next(mark for mark in picture.groups[0].panels[0].marks if isinstance(mark, Upright))
    assert 10.0**threshold.x == pytest.approx(1.2)


def test_a_single_effect_or_law_has_no_model_without_it_but_the_recalibrated_one(
    several: Diagnosis, unknown: Diagnosis
) -> None:
    alone = replace(several, effects=several.effects[:1], without={})
    assert bars_of(alone).names[2:] == ("with valve deadband",)
    assert bars_of(replace(unknown, steps=several.steps)).names[2:] == ("with the recovered law",)
    assert ladder_picture(replace(several, steps=(), without={})) is None


def test_a_model_that_ran_away_is_not_drawn(several: Diagnosis) -> None:
    endless = replace(several.steps[0].residual, overall=float("inf"))
    ran_away = replace(several, steps=(replace(several.steps[0], residual=endless), *several.steps[1:]))
    assert "nominal model" not in bars_of(ran_away).names
    assert np.all(np.isfinite(bars_of(ran_away).x))


def test_the_table_has_a_row_an_effect_in_their_order(several: Diagnosis) -> None:
    table = effect_table(several)
    assert [row[0] for row in table.rows] == ["Valve deadband", "Coulomb friction", "Constant load"]
    assert table.rows[0][1:] == ("half width 59.60 ± 0.84 µA", "in the valve's flow", "30.7")
    assert table.rows[2][1] == "force -76.4 ± 1.0 N"
    (steps,) = step_table(several)
    assert steps.rows[1] == ("recalibrated, nothing added", "46.0", "54.0", "54.0", "51.5")
    assert [row[0] for row in steps.rows[-2:]] == ["without constant load", "with all of them"]


def test_the_contribution_of_an_effect_is_said_in_the_figures_own_numbers(several: Diagnosis) -> None:
    assert contribution(several, "valve_deadband") == (
        "Without it, with the others refitted, the residual is 30.7 times the noise; with it 1.00."
    )
    alone = replace(several, effects=several.effects[:1], without={})
    assert contribution(alone, "valve_deadband") == (
        "Without it, with the parameters refitted, the residual is 51.5 times the noise; with it 1.00."
    )
    assert contribution(several, "end_stop") == ""


def test_the_story_has_a_part_for_each_effect_with_its_law(several: Diagnosis) -> None:
    stage = {one.name: one for one in report_stages(several)}["model"]
    assert [part.title.partition(":")[0] for part in stage.parts] == [
        "1. Valve deadband", "2. Coulomb friction", "3. Constant load",
    ]  # fmt: skip
    assert stage.parts[1].sentences[0] == "The seals rub with 200 N."
    assert stage.parts[1].code == "M_p x_p'' = ... - force sign(x_p')"
    assert all(part.pictures for part in stage.parts)
    assert "valve deadband: half width with valve gain (0.95)" in " ".join(stage.sentences)
    cells = [mark for one in stage.pictures for mark in one.groups[0].panels[0].marks if isinstance(mark, Cells)]
    assert cells[0].names == ("valve gain", "valve deadband: half width", "constant load: force")
    assert page(several).count("<article>") == 3


def test_of_many_effects_the_first_sentence_has_the_names_and_the_table_the_values(several: Diagnosis) -> None:
    assert headline(several) == (
        "The model leaves out valve deadband (half width 59.60 ± 0.84 µA), Coulomb friction (force 200.4 ± 2.5 N) and"
        " constant load (force -76.4 ± 1.0 N); 95 % intervals."
    )
    end = replace(several.effects[1], id="end_stop", parameters={})
    many = replace(several, effects=(*several.effects, end))
    assert headline(many) == (
        "The model leaves out four effects: valve deadband, Coulomb friction, constant load and end stop."
    )
    part = replace(many, explained=replace(several.explained, complete=False))
    assert "four effects, and more that is not named: valve" in headline(part)


def test_a_hypothesis_that_swaps_one_effect_is_told_by_the_swap() -> None:
    chosen = {"valve_deadband", "coulomb_friction", "constant_load"}
    assert rung(chosen, chosen) == "the three named effects"
    swapped = {"valve_deadband", "stribeck_friction", "constant_load"}
    assert rung(swapped, chosen) == "Stribeck friction in place of Coulomb friction"
    assert rung({*chosen, "end_stop"}, chosen) == "the named effects with end stop"
    assert rung({"end_stop"}, chosen) == "end stop alone"
    assert rung({"end_stop"}, {"coulomb_friction"}) == "end stop"


def test_what_is_not_told_from_nothing_is_no_finding(several: Diagnosis) -> None:
    overlap = several.effects[0]
    assert set(identified_parameters(overlap)) == {"half_width"}
    gradual = {**overlap.parameters, "rounding": FittedValue(9e-5, 3.2e-5, "A")}
    assert set(identified_parameters(replace(overlap, parameters=gradual))) == {"half_width", "rounding"}
    neither = {name: FittedValue(1e-9, 1e-5, "A") for name in overlap.parameters}
    assert set(identified_parameters(replace(overlap, parameters=neither))) == {"half_width", "rounding"}
    for text in (account(several), str(summarise(several)), headline(several)):
        assert "rounding" not in text
    table = {one.name: one for one in report_stages(several)}["model"].tables[0]
    assert table.rows[1][0] == "valve_deadband.rounding"
    assert table.rows[1][-1] == "not distinguished from zero"


def test_what_is_left_is_said_with_its_size_and_its_colour(several: Diagnosis) -> None:
    text = residual_in_words(several)
    ratios = [one.rmse_after / one.noise for one in several.held_out.values()]
    assert text.startswith(f"{min(ratios):.2f} to {max(ratios):.2f} times the noise, and white")
    assert "largest autocorrelation 1.1 standard deviations" in text
    drifting = replace(several, whiteness={"position": 8.0, "pressure_a": 1.0})
    assert "not white in position: largest autocorrelation 8.0" in residual_in_words(drifting)


def test_a_recording_taken_as_it_is_and_a_damaged_one_are_announced_first(several: Diagnosis) -> None:
    assert warnings(several) == ()
    assert 'class="warning"' not in page(several)
    doubtful = replace(several, remarks=("warning: taken as recorded, although position is in mm",), damaged="cut off")
    assert warnings(doubtful)[0] == "Warning: taken as recorded, although position is in mm."
    assert "cut off" in warnings(doubtful)[1]
    text = page(doubtful)
    assert text.index("taken as recorded") < text.index("<h1>")
    of_two = replace(several, remarks=("a.mcap: 3 outliers", "b.mcap: warning: taken as recorded, although it is not"))
    assert warnings(of_two) == ("b.mcap: warning: taken as recorded, although it is not.",)
