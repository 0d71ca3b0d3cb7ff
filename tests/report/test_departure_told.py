"""The sentence about a departure's cause, and its named values."""

from eha_core.report.departure import as_values, likely_cause
from eha_core.twin.explanation import Cause, Explanation, Size

LEAK = Cause("internal_leakage", (Size("internal_leakage", 5e-11, 2e-14, 1e-12, "m^3/(s Pa)"),), (4.5e-6, 3e-9))
FRICTION = Cause("coulomb_friction", (Size("coulomb_friction.force", 98.9, 0.6, 0.0, "N"),))
BIASES = (
    Size("pressure_sensor_bias.bias_a", 2e5, 500.0, 0.0, "Pa"),
    Size("pressure_sensor_bias.bias_b", -400.0, 550.0, 0.0, "Pa"),
)
BIAS = Cause("pressure_sensor_bias", BIASES)


def test_a_leak_is_a_flow_and_friction_a_force() -> None:
    assert likely_cause(Explanation(0.7, LEAK)) == "likely cause: internal leakage, 270.00 ± 0.35 ml/min more (95 %)"
    assert likely_cause(Explanation(0.7, FRICTION)) == "likely cause: Coulomb friction, 98.9 ± 1.2 N (95 %)"


def test_what_the_model_has_otherwise_is_said() -> None:
    lower = Cause("supply_pressure", (Size("supply_pressure", 1.8e7, 5e3, 2.1e7, "Pa"),))
    assert likely_cause(Explanation(0.7, lower)).endswith(
        "supply pressure, 18.0000 ± 0.0098 MPa instead of 21.0 MPa (95 %)"
    )
    other = Cause("coulomb_friction.force", (Size("coulomb_friction.force", 400.0, 0.5, 250.0, "N"),))
    assert likely_cause(Explanation(0.7, other)).startswith(
        "likely cause: Coulomb friction, force, 400.00 ± 0.98 N instead"
    )


def test_rivals_and_what_is_left_are_said() -> None:
    text = likely_cause(Explanation(1.0, BIAS, (LEAK, FRICTION), 1.6))
    assert text == (
        "likely cause: pressure sensor bias, bias A 200.00 ± 0.98 kPa and bias B -0.4 ± 1.1 kPa (95 %),"
        " which leaves 1.6 times the noise, cannot be distinguished from internal leakage or Coulomb friction"
    )


def test_named_values_have_the_cause_its_sizes_and_the_rivals() -> None:
    assert as_values(Explanation(1.74, LEAK, (FRICTION,))) == {
        "named from": "1.7 s",
        "cause": "internal_leakage",
        "size: flow": "270.00 ± 0.35 ml/min",
        "size: internal_leakage": "3.0000 ± 0.0024 l/min per MPa",
        "residual times the noise": 1.0,
        "cannot be distinguished from": "coulomb_friction",
    }


def test_nothing_that_explains_it_is_said_and_has_no_size() -> None:
    nothing = Explanation(1.74, None)
    assert likely_cause(nothing) == "no single effect or parameter explains 1.7 s of it"
    assert as_values(nothing) == {"named from": "1.7 s", "cause": "none"}
