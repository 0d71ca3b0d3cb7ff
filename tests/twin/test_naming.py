"""What a departure is named, on rigs that the plant simulates."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from beside_rig import MULTISINE, NANOSECONDS, PERIOD, comparisons, rig

from eha_core.detectability.planned import PlannedTest, linearised
from eha_core.diagnosis.detection.rows import parameter_rows
from eha_core.nominal import nominal_of
from eha_core.recording.simulated import Simulated
from eha_core.signals import make_signal
from eha_core.twin import Twin
from eha_core.twin.departures import Departures
from eha_core.twin.explanation import Departure, Explanation
from eha_core.twin.naming import explain

LEAKAGE = 1e-12
"""m^3/(s Pa); the nominal coefficient."""


def departures(record: Simulated, twin: Twin) -> list[tuple[float, Departure]]:
    """What is to be named, with the stamp at which it was there [s]."""
    asked, found = Departures(), []
    for stamp, comparison in comparisons(record, twin):
        departure = asked.take(comparison, twin.kept, twin.parameters)
        if departure is not None:
            found.append((stamp, departure))
    return found


def named(seconds: float, model: Mapping[str, float] | None = None, **options: object) -> Explanation:
    """The last explanation of a rig."""
    return explain(departures(rig(seconds, **options), Twin(model))[-1][1])


def test_a_leak_of_twice_the_detectable_size_is_named_within_five_seconds() -> None:
    times = np.arange(round(5.0 / PERIOD)) * PERIOD
    test = PlannedTest(times, make_signal("multisine", MULTISINE).value(times), 5.0)
    rows = {row.name: row for row in parameter_rows(linearised(nominal_of({}), test))}
    leak = 2.0 * rows["internal_leakage"].change
    record = rig(8.0, changes=[(3.0, "internal_leakage", LEAKAGE + leak)])
    found = departures(record, Twin())
    stamp, first = found[0]
    assert 3.0 < stamp < 8.0
    explanation = explain(first)
    assert explanation.cause is not None and explanation.cause.name == "internal_leakage"
    assert explanation.rivals == ()
    (size,) = explanation.cause.sizes
    assert abs(size.value - LEAKAGE - leak) < 3.0 * size.deviation < 0.01 * leak
    # the flow is the coefficient times the true pressures' difference over the seconds that were compared
    end = first.excerpt.end / NANOSECONDS
    part = slice(round((end - explanation.seconds) / PERIOD), round(end / PERIOD))
    difference = (record.column("pressure_a") - record.column("pressure_b"))[part]
    flow, deviation = explanation.cause.flow or (0.0, 0.0)
    assert flow == pytest.approx(leak * np.sqrt(np.mean(difference**2)), rel=0.02)
    assert 0.0 < deviation < 0.01 * flow
    later = explain(found[-1][1])
    assert later.cause is not None and later.cause.sizes[0].deviation < 0.6 * size.deviation


@pytest.mark.parametrize(
    ("name", "parameter", "value"),
    [
        ("coulomb_friction", "coulomb_friction.force", 20.0),
        ("supply_pressure", "supply_pressure", 18e6),
        ("valve_null_offset", "valve_null_offset.offset", 2e-6),
        ("external_leakage", "external_leakage.coefficient_b", 1e-13),
        ("turbulent_leakage", "turbulent_leakage.coefficient", 1e-8),
    ],
)
def test_a_cause_is_named_with_its_size_in_the_interval(name: str, parameter: str, value: float) -> None:
    explanation = named(5.5, changes=[(2.0, parameter, value)])
    assert explanation.cause is not None and explanation.cause.name == name
    size = next(size for size in explanation.cause.sizes if size.name == parameter)
    assert abs(size.value - value) < 4.0 * size.deviation < 0.1 * value
    assert explanation.residual < 1.2


def test_what_changes_an_effect_of_the_model_is_that_effects_parameter() -> None:
    explanation = named(3.0, {"coulomb_friction.force": 250.0}, parameters={"coulomb_friction.force": 400.0})
    assert explanation.cause is not None and explanation.cause.name == "coulomb_friction.force"
    (size,) = explanation.cause.sizes
    assert size.modelled == 250.0 and abs(size.value - 400.0) < 4.0 * size.deviation


def test_what_seconds_cannot_distinguish_is_a_rival() -> None:
    """A sensor's offset and its gain, while the pressure has hardly moved."""
    record = rig(4.0, changes=[(2.0, "pressure_sensor_bias.bias_a", 2e5)])
    explanation = explain(departures(record, Twin())[0][1])
    assert explanation.cause is not None
    names = {explanation.cause.name, *(rival.name for rival in explanation.rivals)}
    assert names == {"pressure_sensor_bias", "pressure_sensor_scale"}


def test_friction_that_sticks_is_told_from_friction_that_only_slides() -> None:
    friction = {"stribeck_friction.force": 150.0, "stribeck_friction.static_force": 250.0}
    explanation = named(3.0, parameters=friction)
    assert explanation.cause is not None and explanation.cause.name == "stribeck_friction"
    for size in explanation.cause.sizes:
        assert abs(size.value - friction[size.name]) < 4.0 * size.deviation < 5.0


def test_a_value_far_off_is_found_as_exactly_as_its_interval_says() -> None:
    explanation = named(5.0, parameters={"supply_pressure": 15e6})
    assert explanation.cause is not None
    (size,) = explanation.cause.sizes
    assert abs(size.value - 15e6) < 4.0 * size.deviation < 1e4


UNKNOWN = {"08": 200.0, "11": -200.0, "14": -200.0, "18": 200.0}
"""N; knots of a force over the position that is no effect of the catalogue."""


@pytest.mark.parametrize(
    "changes",
    [
        {"internal_leakage": 5e-11, "coulomb_friction.force": 100.0},
        {f"recovered_force.knot_{knot}": force for knot, force in UNKNOWN.items()},
    ],
)
def test_two_causes_at_once_and_a_law_in_no_catalogue_are_no_single_one(changes: dict[str, float]) -> None:
    explanation = named(5.0, changes=[(2.0, name, value) for name, value in changes.items()])
    assert explanation.cause is None and explanation.rivals == ()


@pytest.mark.parametrize("noise", [0.0, 1.0, 5.0])
def test_nothing_is_named_where_nothing_departs(noise: float) -> None:
    assert departures(rig(8.0, noise), Twin()) == []
