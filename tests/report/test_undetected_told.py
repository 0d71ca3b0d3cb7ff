"""How what was not named is told: one line, a table, diagnosis.json; and why where nothing is known."""

from __future__ import annotations

from dataclasses import replace

import pytest

from eha_core.diagnosis.result import Confusion, Detectable, Diagnosis, Explained, Noticeable, Undetected
from eha_core.report.account import account
from eha_core.report.document import document
from eha_core.report.finding import supporting
from eha_core.report.stages.show import stage
from eha_core.report.summary_tables import summarise
from eha_core.report.undetected import not_missing, undetected_tables

FOUND = Undetected(
    0.95,
    (
        Detectable("external_leakage", "coefficient_a", "m^3/(s Pa)", 1e-15, 0.2, (), {}, 1e-12, 1e-9),
        Detectable("external_leakage", "coefficient_b", "m^3/(s Pa)", 2e-15, 0.2, (), {}, 1e-12, 2e-9),
        Detectable("constant_load", "force", "N", 1.5, 0.3, (), {}, 200.0, None, (Confusion("spring", 3.0, 0.99),)),
        Detectable("position_sensor_scale", "ratio", "-", None, 1e-7, ("moving_mass",), {}, 0.05),
    ),
    (Noticeable("internal_leakage", "m^3/(s Pa)", 1e-12, 1e-11, 1e-6),),
)
LINE = "missing, or below (95 %): internal leakage 60.0 ml/min, external leakage 0.12 ml/min, constant load 1.50 N"


@pytest.fixture
def told(consistent: Diagnosis) -> Diagnosis:
    return replace(consistent, undetected=FOUND)


def test_a_line_names_leaks_friction_and_loads(told: Diagnosis, friction: Diagnosis) -> None:
    """Of the two chambers' leaks the larger: either would have been found at it."""
    assert not_missing(told) == f"nothing is {LINE.replace('0.12', '0.120')}"
    assert not_missing(replace(friction, undetected=FOUND)).startswith("nothing else is missing, or below (95 %): ")
    lines = account(told).splitlines()
    assert any(line.startswith("Not found    nothing is missing, or below (95 %)") for line in lines)
    assert any("or below (95 %): internal leakage 60.0 ml/min" in text for text in supporting(told))
    assert ("Not found", not_missing(told)) in summarise(told).facts


def test_the_table_has_every_size_and_what_it_is_confounded_with(told: Diagnosis) -> None:
    effects, parameters = undetected_tables(told)
    rows = {row[0]: row[1:] for row in effects.rows}
    assert rows["external leakage, coefficient B"][1] == "0.120 ml/min"
    assert rows["constant load, force"] == ("1.50 N", "", "cannot be distinguished from spring")
    assert rows["position sensor scale, ratio"] == ("not found at any size", "", "nearly compensated by moving_mass")
    assert parameters.rows[0][0] == "internal leakage" and parameters.rows[0][2] == "60.0 ml/min"
    assert {table.title for table in (effects, parameters)} < {table.title for table in stage(told).tables}


def test_the_document_has_them_by_effect(told: Diagnosis, consistent: Diagnosis) -> None:
    found = document(told)
    assert list(found["detectable"]) == ["external_leakage", "constant_load", "position_sensor_scale"]
    leak = found["detectable"]["external_leakage"]
    assert (leak["size"], leak["unit"], leak["power"]) == (1e-15, "m^3/(s Pa)", 0.95)
    assert [row["parameter"] for row in leak["further"]] == ["coefficient_b"]
    assert found["detectable"]["position_sensor_scale"]["size"] is None
    assert found["noticeable"][0]["name"] == "internal_leakage"
    assert document(consistent)["detectable"] is None


def test_a_residual_that_is_no_noise_is_told_in_place_of_sizes(friction: Diagnosis) -> None:
    left = Explained(0.6, {"position": 3.0, "pressure_a": 1.1}, False)
    bad = replace(friction, explained=left)
    assert undetected_tables(bad) == ()
    assert not_missing(bad) == (
        "upper limits of further effects are not known, because the residual is up to 3 times the noise, in position"
    )
