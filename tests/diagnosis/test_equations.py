"""The friction that the search begins with, from the force balance."""

import pytest
from made import LAWS, recorded

from eha_core.diagnosis.characteristic_scales import QUANTITIES, Scales
from eha_core.diagnosis.criteria import HIGHER_AT_REST, MOVED
from eha_core.diagnosis.search.equations import KIND, friction_columns, friction_of
from eha_core.identification.observation import observe
from eha_core.parameters import nominal_values

SIZES = (0.02, 6.0, 0.1, 3000.0, 2e-4, 2e6, 1e11, 1e-10)
SCALES = Scales({quantity: (0.0, size) for quantity, size in zip(QUANTITIES, SIZES, strict=True)}, None)
FORMS = {effect.id for effect in LAWS.values() if effect.kind == KIND}
EVERY = tuple(LAWS.values())


def asked(*recordings, effects=EVERY):
    return friction_of([observe(one) for one in recordings], nominal_values(), effects, SCALES)


def test_clear_friction_is_held_and_every_form_begins_as_large():
    found = asked(recorded({"coulomb_friction.force": 250.0, "valve_deadband.half_width": 1e-4}, duration=6.0))
    assert not found.excluded and found.held == found.forms[0]
    begun = {start.effect.id: start.values for start in found.forms}
    assert begun.keys() == FORMS
    assert begun["coulomb_friction"]["coulomb_friction.force"] == pytest.approx(250.0, rel=0.03)
    presliding = begun["presliding_friction"]
    assert presliding["presliding_friction.force"] == pytest.approx(250.0, rel=0.1)
    assert presliding["presliding_friction.static_force"] >= presliding["presliding_friction.force"]
    assert HIGHER_AT_REST > 1.0
    for start in found.forms:
        rows = dict(zip(start.effect.parameter_names(), start.effect.parameters, strict=True))
        assert all(rows[name].lower <= value <= rows[name].upper for name, value in start.values.items())


def test_where_there_is_none_it_is_excluded_and_nothing_is_held():
    found = asked(recorded({"valve_deadband.half_width": 1e-4}, duration=6.0))
    assert found.excluded and found.held is None and found.forms == ()


def test_what_rubs_in_a_part_of_the_recording_is_not_excluded():
    planted = {"coulomb_friction.force": 250.0, "coulomb_friction.acts_from": 2.5, "coulomb_friction.acts_until": 4.0}
    found = asked(recorded(planted, duration=8.0))
    assert not found.excluded and found.held is None


def test_without_pressures_it_is_not_excluded_and_not_held_unless_another_recording_tells_it():
    planted = {"coulomb_friction.force": 250.0}
    blind = recorded(planted, duration=4.0, channels=("voltage_command", "position"))
    found = asked(blind)
    assert not found.excluded and found.held is None
    assert asked(blind, recorded(planted, duration=6.0, seed=2)).held is not None


def test_only_forms_that_are_offered_are_held():
    offered = [effect for effect in EVERY if effect.id == "presliding_friction" or not effect.kind]
    found = asked(recorded({"coulomb_friction.force": 250.0}, duration=6.0), effects=offered)
    assert {start.effect.id for start in found.forms} <= {"presliding_friction"}


def test_what_the_friction_held_may_be_off_by_is_its_values_and_its_form():
    found = asked(recorded({"coulomb_friction.force": 250.0}, duration=6.0))
    assert found.held is not None
    own = [column for column in friction_columns(found) if column.effect == found.held.effect]
    moved = [name for column in own for name, value in column.values.items()]
    assert moved and all("shape" not in name for name in moved)
    for column in own:
        ((name, value),) = column.values.items()
        assert value == pytest.approx((1.0 + MOVED) * found.held.values[name])
    others = [column for column in friction_columns(found) if column not in own]
    assert {column.effect.id for column in others} == FORMS - {found.held.effect.id}
    for column in others:
        assert column.values[f"{found.held.effect.id}.force"] == 0.0
        assert column.factors() == (0.0, 1.0)
