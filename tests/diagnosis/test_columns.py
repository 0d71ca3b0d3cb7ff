"""The guesses at which effects are tried: each way of having an effect once, and none that its bounds do not allow."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from made import LAWS, recorded

from eha_core.diagnosis.characteristic_scales import QUANTITIES, Scales
from eha_core.diagnosis.effect_parameters import MOST_ABOVE
from eha_core.diagnosis.search import columns
from eha_core.diagnosis.search.columns import SITES_OF_DRIVE, applicable_effects, columns_of
from eha_core.identification.observation import observe

SIZES = (0.02, 10.0, 0.1, 3000.0, 2e-4, 2e6, 1e11, 1e-10)
SCALES = Scales({quantity: (0.0, size) for quantity, size in zip(QUANTITIES, SIZES, strict=True)}, None)
NAMED = [effect for effect in LAWS.values() if effect.named]


def sizes_of(effect):
    """The nominal value of each size, by its full name."""
    return {f"{effect.id}.{row.name}": row.nominal for row in effect.parameters if row.switches}


@pytest.mark.parametrize("name", ["pressure_sensor_bias", "pressure_sensor_scale", "pressure_sensor_lag"])
def test_each_chamber_has_a_column_of_its_own_and_both_together_are_one_set(name):
    found = columns_of(LAWS[name], SCALES)
    assert len(found) == 2 * len(columns.SIZES)
    for a, b in zip(found[::2], found[1::2], strict=True):
        assert a.alternative == b.alternative
        (only_a,), (only_b,) = a.sizes, b.sizes
        assert only_a.endswith("_a") and only_b.endswith("_b")
        assert a.values[only_a] != 0.0 and a.values[only_b] == 0.0
        assert b.values[only_b] != 0.0 and b.values[only_a] == 0.0


def test_an_effect_is_tried_at_several_sizes_and_at_none_twice():
    name = "valve_null_offset.offset"
    first, small = columns_of(LAWS["valve_null_offset"], SCALES)
    assert small.values[name] == pytest.approx(0.1 * first.values[name])
    assert small.factors()[1] * small.values[name] < first.factors()[1] * first.values[name]
    starts = next(row.starts for row in LAWS["hardening_spring"].parameters if row.switches)
    sizes = [column.values["hardening_spring.coefficient"] for column in columns_of(LAWS["hardening_spring"], SCALES)]
    assert len(sizes) < len(columns.SIZES) * len(starts)
    assert len(set(sizes)) == len(sizes)


def test_what_takes_the_place_of_a_parameter_is_counted_from_it():
    name = "leakage_onset.internal_leakage"
    column = columns_of(LAWS["leakage_onset"], SCALES)[0]
    beside = column.beside({"internal_leakage": 3e-12})
    assert beside.values[name] == pytest.approx(3e-12 + column.values[name])
    assert beside.sized(0.0)[name] == 3e-12
    assert beside.sized(2.0)[name] == pytest.approx(3e-12 + 2.0 * column.values[name])
    assert beside.sized(-1e9)[name] == 0.0


def test_factors_end_where_the_parameter_may_not_go_on():
    row = next(row for row in LAWS["valve_deadband"].parameters if row.switches)
    for column in columns_of(LAWS["valve_deadband"], SCALES):
        least, most = column.factors()
        assert least == 0.0
        assert most <= column.most
        assert column.sized(most)[f"valve_deadband.{row.name}"] <= row.upper


def test_forms_of_one_law_with_several_sizes_scale_them_together():
    for column in columns_of(LAWS["stribeck_friction"], SCALES):
        assert column.sizes == ("stribeck_friction.force", "stribeck_friction.static_force")


def test_what_differs_between_recordings_has_a_column_in_each_and_is_off_in_the_others():
    name = "constant_load.force"
    alone, small = columns_of(LAWS["constant_load"], SCALES, (), 3)
    assert alone.sizes == small.sizes == (name,)
    each = columns_of(LAWS["constant_load"], SCALES, (name,), 3)[:3]
    names = (name, f"{name}@2", f"{name}@3")
    assert [column.sizes for column in each] == [(one,) for one in names]
    assert len({column.alternative for column in each}) == 1
    for column, own in zip(each, names, strict=True):
        assert column.values == {one: alone.values[name] if one == own else 0.0 for one in names}


def test_in_two_recordings_two_chambers_are_four_columns():
    marked = [f"pressure_sensor_bias.bias_{chamber}" for chamber in "ab"]
    each = columns_of(LAWS["pressure_sensor_bias"], SCALES, marked, 2)[:4]
    assert {column.sizes for column in each} == {(name + end,) for name in marked for end in ("", "@2")}
    assert len(each) == 4
    for column in each:
        assert sum(value != 0.0 for value in column.values.values()) == 1


@pytest.mark.parametrize("effect", NAMED, ids=lambda effect: effect.id)
def test_every_guess_is_on_within_bounds_and_unlike_the_others(effect):
    rows = dict(zip(effect.parameter_names(), effect.parameters, strict=True))
    nominal = sizes_of(effect)
    found = columns_of(effect, SCALES)
    assert found
    for column in found:
        assert set(column.values) == set(rows)
        assert all(rows[name].lower <= value <= rows[name].upper for name, value in column.values.items())
        assert all(column.values[name] != nominal[name] for name in column.sizes)
        assert effect.is_active(column.values)
        assert column.one_way == all(rows[name].lower >= rows[name].nominal for name in nominal)
        for row in effect.parameters:
            if row.above:
                share = column.values[f"{effect.id}.{row.name}"] / column.values[f"{effect.id}.{row.above}"] - 1.0
                assert 0.0 <= share <= MOST_ABOVE
    for one, other in combinations(found, 2):
        assert one.values != other.values
        if one.one_way or one.sizes != other.sizes:
            continue
        # a coefficient of the other sign has the guess of the other sign
        assert any(
            value != 2.0 * nominal[name] - other.values[name] if name in one.sizes else value != other.values[name]
            for name, value in one.values.items()
        )


@pytest.mark.parametrize("effect", NAMED, ids=lambda effect: effect.id)
def test_sizes_scale_from_their_nominal_value_and_stay_within_bounds(effect):
    rows = dict(zip(effect.parameter_names(), effect.parameters, strict=True))
    nominal = sizes_of(effect)
    for column in columns_of(effect, SCALES):
        for factor in (0.03, 1.0, 1.7, 1e9, -1.0, -1e9):
            sized = column.sized(factor)
            for name, value in column.values.items():
                row = rows[name]
                wanted = nominal[name] + factor * (value - nominal[name]) if name in column.sizes else value
                assert sized[name] == pytest.approx(min(max(wanted, row.lower), row.upper))


def test_an_effect_is_offered_where_its_site_is_driven_and_its_sensor_was_there():
    observation = observe(recorded({}, duration=3.0))
    assert {effect.id for effect in applicable_effects([observation])} == {effect.id for effect in NAMED}
    pressed = applicable_effects([replace(observation, drive="pressures")])
    assert {effect.site for effect in pressed} <= set(SITES_OF_DRIVE["pressures"])
    assert "coulomb_friction" in {effect.id for effect in pressed}
    blind = [channel for channel in observation.measured if channel.name == "position"]
    without = {effect.id for effect in applicable_effects([replace(observation, measured=tuple(blind))])}
    of_pressure = {effect.id for effect in NAMED if "measured_pressure_a" in effect.needs}
    assert of_pressure and without == {effect.id for effect in NAMED} - of_pressure


def test_laws_of_a_valve_or_of_oil_are_not_tried_where_nothing_tells_their_size():
    """A plant that a measured force drives has a force law to draw, and neither an opening nor a leakage."""
    known = {quantity: SCALES.by_quantity[quantity] for quantity in ("time", "position", "speed", "force")}
    unnamed = [effect for effect in LAWS.values() if not effect.named]
    assert {effect.site for effect in unnamed} > {"force"}
    found = columns.law_columns(unnamed, Scales(known, np.empty((0, 0))))
    assert found and {column.effect.site for column in found} == {"force"}
