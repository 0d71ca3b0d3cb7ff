"""A rig read from a diagnosis or from values by name: its model, its departures, and what is refused."""

from __future__ import annotations

import pytest
from rigs import FRICTION, LEAKAGE, MASS, document

from eha_core.error_budget import rig_from_changes, rig_from_document
from eha_core.error_budget.rig import MOST, PARAMETERS
from eha_core.errors import EhaError, ParameterError
from eha_core.parameters import nominal_values


def test_effects_and_a_leakage_depart_alone_and_all_other_parameters_together() -> None:
    rig = rig_from_document(document(), "made")
    assert [one.name for one in rig.departures] == ["coulomb_friction", LEAKAGE, PARAMETERS]
    assert [one.repairable for one in rig.departures] == [True, True, False]
    assert rig.departures[0].statement == "the seals rub"
    assert rig.values(()) == rig.modelled == nominal_values()
    assert rig.values(rig.departures) == nominal_values() | {FRICTION: 250.0, LEAKAGE: 1e-10, MASS: 11.0}
    assert rig.values(rig.departures[:1]) == nominal_values() | {FRICTION: 250.0}


def test_the_model_is_the_nominal_one_of_the_diagnosis_and_not_the_catalogue_s() -> None:
    made = document(fitted_values={FRICTION: 250.0, LEAKAGE: 1e-10, MASS: 11.0, "piston_area": 1e-3})
    rig = rig_from_document(made, "made")
    assert rig.modelled["piston_area"] == 1e-3 and rig.modelled[MASS] == 9.0


def test_deviations_and_their_correlation_keep_their_order() -> None:
    rig = rig_from_document(document(), "made")
    assert rig.deviations == {MASS: 0.5, LEAKAGE: 1e-12, FRICTION: 2.0}
    assert rig.correlation.tolist() == [[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.0, 1.0]]


def test_a_deviation_that_is_not_known_is_left_out_and_said() -> None:
    made = document()
    made["effects"][0]["parameters"]["force"]["std"] = None
    rig = rig_from_document(made, "made")
    assert rig.deviations == {MASS: 0.5, LEAKAGE: 1e-12} and rig.correlation.shape == (2, 2)
    assert any("coulomb_friction is not known" in remark for remark in rig.remarks)


def test_a_leakage_that_has_not_changed_is_one_of_the_parameters() -> None:
    made = document()
    made["parameters"][1]["changed"] = False
    rig = rig_from_document(made, "made")
    assert [one.name for one in rig.departures] == ["coulomb_friction", PARAMETERS]
    assert set(rig.departures[1].values) == {MASS, LEAKAGE}


def test_an_effect_of_an_interval_always_acts_and_that_is_said() -> None:
    made = document()
    made["fitted_values"] |= {"coulomb_friction.acts_from": 2.0, "coulomb_friction.acts_until": 4.0}
    made["effects"][0]["active"] = [2.0, 4.0]
    rig = rig_from_document(made, "made")
    assert rig.departures[0].values["coulomb_friction.acts_from"] == 0.0
    assert rig.departures[0].values["coulomb_friction.acts_until"] == 1e9
    assert rig.remarks == ("coulomb_friction acted from 2 s to 4 s of the recording; here it always acts",)


def test_an_instant_of_the_recording_lies_before_the_task() -> None:
    rig = rig_from_changes({"leakage_onset.time": 5.0, "leakage_onset.internal_leakage": 1e-10}, nominal_values())
    assert rig.departures[0].values["leakage_onset.time"] == 0.0


def test_values_by_name_depart_from_any_model() -> None:
    model = nominal_values() | {LEAKAGE: 0.0}
    rig = rig_from_changes({LEAKAGE: 1e-11, MASS: 12.0}, model)
    assert [one.name for one in rig.departures] == [LEAKAGE, PARAMETERS]
    assert rig.departures[0].absent == {LEAKAGE: 0.0} and not rig.deviations
    assert "600 ml/min per MPa" in rig.departures[0].statement


@pytest.mark.parametrize(
    "change, words",
    [
        ({"schema": "other"}, "made: no diagnosis"),
        ({"fitted_values": {}}, "made: it has no fitted_values"),
        ({"fitted_values": {MASS: 11.0}, "parameters": [], "effects": []}, "there is nothing to repair"),
        ({"plant": {"source": "measured_pressures"}}, "plant.source = measured_pressures is not taken"),
    ],
)
def test_what_has_nothing_to_repair_or_cannot_be_driven_is_refused(change: dict[str, object], words: str) -> None:
    with pytest.raises(EhaError, match=words):
        rig_from_document(document(**change), "made")


def test_more_departures_than_can_be_simulated_are_refused() -> None:
    from eha_core.effects import effects

    named = [effect for effect in effects() if effect.named][: MOST + 1]
    changes = {name: row.typical for effect in named
               for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)}  # fmt: skip
    with pytest.raises(EhaError, match=f"{MOST + 1} departures have {2 ** (MOST + 1)} subsets; a budget takes {MOST}"):
        rig_from_changes(changes, nominal_values())


def test_a_name_that_is_none_is_refused() -> None:
    with pytest.raises(ParameterError, match="no parameter named coulomb.force"):
        rig_from_changes({"coulomb.force": 1.0}, nominal_values())
