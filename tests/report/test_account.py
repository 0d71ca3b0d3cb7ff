"""The account on the terminal."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from eha_core.diagnosis.result import Alternative, Diagnosis
from eha_core.report.account import account

WRITTEN = tuple(Path("out") / name for name in ("report.html", "figures", "diagnosis.json", "fitted.yaml"))


def test_says_what_where_how_sure_and_how_much_better(friction: Diagnosis) -> None:
    text = account(friction, WRITTEN)
    assert "the seals rub with 200 N" in text
    assert "93 % of the recalibrated model's unexplained error is in the force balance" in " ".join(text.split())
    assert "coulomb_friction (force 200.4 ± 2.5 N; 95 %)" in text
    assert "moving_mass 10.946 ± 0.069 kg (nominal 9.00 kg)" in text
    assert "internal_leakage" not in text  # it did not change
    assert "out/: report.html, figures, diagnosis.json, fitted.yaml" in text


def test_says_when_where_that_is_a_few_spans(friction: Diagnosis) -> None:
    place = replace(friction.location[0], law_over="velocity")
    text = " ".join(account(replace(friction, location=(place,)), WRITTEN).split())
    assert "is a law over velocity; 1.0 s to 1.5 s and 3.0 s to 3.2 s" in text


def test_errors_stand_in_the_channel_s_own_unit(friction: Diagnosis) -> None:
    fit = friction.held_out["position"]
    row = next(line for line in account(friction).splitlines() if line.startswith("  position ["))
    label, _, numbers = row.partition("]")
    assert label.endswith("[µm")
    shown = [float(one) for one in numbers.replace(",", "").split()]
    expected = [1e6 * one for one in (fit.rmse_before, fit.rmse_calibrated, fit.rmse_after, fit.noise)]
    assert all(abs(one - other) <= 0.005 * other for one, other in zip(shown, expected, strict=True))


def test_rivals_and_the_test_that_separates_them(ambiguous: Diagnosis) -> None:
    text = account(ambiguous)
    assert "from stribeck_friction (evidence 3.1 less)" in text
    assert "A sine tells them apart" in text


def test_an_unknown_law_is_told_with_its_expression(unknown: Diagnosis) -> None:
    assert "a law over velocity: 250 tanh(20 v) (R² 0.980)" in account(unknown)
    assert "may be biased by the missing effect" in " ".join(account(unknown).split())
    simulated = replace(unknown, fitted_values={**unknown.fitted_values, "recovered_force.knot_00": 3.0})
    assert "biased" not in account(simulated)


def test_what_was_not_examined_or_damaged_is_told(position_alone: Diagnosis) -> None:
    text = " ".join(account(position_alone).split())
    assert "damaged: the first 4 s" in text
    assert "RMSE on held-out data" not in text


def test_stays_on_one_screen(any_diagnosis: Diagnosis) -> None:
    lines = account(any_diagnosis, WRITTEN).splitlines()
    assert len(lines) <= 25
    assert all(line == line.rstrip() and len(line) <= 100 for line in lines)


def test_stays_on_one_screen_however_much_there_is_to_say(ambiguous: Diagnosis) -> None:
    wordy = replace(
        ambiguous,
        summary="word " * 200,
        location=(replace(ambiguous.location[0], where="word " * 200),),
        effects=ambiguous.effects * 9,
        parameters=ambiguous.parameters[:1] * 30,
        alternatives=(Alternative(("one", "other"), 1.0),) * 20,
        remarks=("word " * 100,),
        next_experiment=replace(ambiguous.next_experiment, statement="word " * 200),
    )
    lines = account(wordy, WRITTEN).splitlines()
    assert len(lines) <= 25 + 4 * 6  # four more for each of the eight effects that can be named beyond the second
    assert len(account(replace(wordy, effects=ambiguous.effects[:2]), WRITTEN).splitlines()) <= 25
    assert max(map(len, lines)) <= 100


def test_what_does_not_fit_ends_with_whole_items_and_their_number(friction: Diagnosis) -> None:
    (mass,) = (one for one in friction.parameters if one.name == "moving_mass")
    many = replace(friction, parameters=(mass,) * 7, remarks=("pressure_a: 3 outliers were excluded", "word " * 60))
    lines = account(many).splitlines()
    text = " ".join(" ".join(lines).split())
    assert "(nominal 9.00 kg); moving_mass 10.946 ± 0.069 kg (nominal 9.00 kg); and 4 more RMSE" in text
    assert "pressure_a: 3 outliers were excluded; and 1 more" in text
    (cut,) = (line for line in account(replace(friction, summary="word " * 200)).splitlines() if line.endswith("…"))
    assert cut.endswith("word …")


def test_without_added_physics_there_is_no_column_for_it(friction: Diagnosis, consistent: Diagnosis) -> None:
    def heading(diagnosis: Diagnosis) -> list[str]:
        return next(line for line in account(diagnosis).splitlines() if line.startswith("RMSE")).split()

    assert heading(friction)[-4:] == ["nominal", "recalibrated", "augmented", "noise"]
    assert heading(consistent)[-3:] == ["nominal", "recalibrated", "noise"]
    rows = (line for line in account(consistent).splitlines() if line.startswith("  p"))
    assert {len(row.partition("]")[2].split()) for row in rows} == {3}
