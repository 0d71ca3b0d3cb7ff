"""A hypothesis is a value: what it holds is all that tells it from another."""

from eha_core.diagnosis.hypothesis import NOTHING, neutral
from eha_core.effects import effects

LAWS = {effect.id: effect for effect in effects()}
FRICTION, STRIBECK, LOAD = (LAWS[name] for name in ("coulomb_friction", "stribeck_friction", "constant_load"))


def test_the_order_in_which_effects_were_added_does_not_matter():
    one = NOTHING.with_effects([FRICTION]).with_effects([LOAD])
    assert one == NOTHING.with_effects([LOAD, FRICTION])
    assert hash(one) == hash(NOTHING.with_effects([LOAD, FRICTION]))
    assert one.ids == ("constant_load", "coulomb_friction")


def test_an_effect_that_acts_in_an_interval_is_another_member():
    limited = NOTHING.with_effects([FRICTION], limited=True)
    assert limited != NOTHING.with_effects([FRICTION])
    assert limited.limited and (limited.size, NOTHING.with_effects([FRICTION]).size) == (2, 1)
    assert not NOTHING.with_effects([FRICTION]).limited


def test_a_set_admits_no_second_form_of_one_law_and_no_effect_twice():
    one = NOTHING.with_effects([FRICTION])
    assert one.admits(LOAD)
    assert not one.admits(FRICTION)
    assert not one.admits(STRIBECK)


def test_a_set_without_a_member_is_the_set_that_it_was_added_to():
    both = NOTHING.with_effects([FRICTION, LOAD])
    (member,) = (one for one in both.members if one.effect is LOAD)
    assert both.without(member) == NOTHING.with_effects([FRICTION])
    assert both.holds(both.without(member))
    assert not both.without(member).holds(both)


def test_neutral_values_turn_an_effect_off():
    assert not FRICTION.is_active(neutral(FRICTION))
