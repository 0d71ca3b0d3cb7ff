"""Numbers as a person reads them."""

from __future__ import annotations

import math

import pytest

from eha_core.quantities import Quantity, quantity, unit_text, with_deviation


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [
        (1.024e-5, "m", "10.2 µm"),
        (0.0643, "m", "64.3 mm"),
        (2.1e7, "Pa", "21.0 MPa"),
        (1.4e9, "Pa", "1.40 GPa"),
        (-0.4, "V", "-400 mV"),
        (9.997e3, "Pa", "10.0 kPa"),
        (9.994e3, "Pa", "9.99 kPa"),
        (0.48, "-", "0.480"),
        (1e-12, "m^3/(s Pa)", "60.0 ml/min per MPa"),  # 1e-6 m^3/s at 1 MPa
        (3e10, "Pa s/m^3", "500 kPa per l/min"),  # a litre a minute is 1/60000 m^3/s
        (2e-8, "m^3/(s Pa^0.5)", "1.20 l/min per √MPa"),  # 2e-5 m^3/s at 1 MPa
        (1e-4, "m^3/s", "6.00 l/min"),
        (9.8e-4, "m^2", "9.80 cm²"),
        (5e6, "N/m", "5.00 MN/m"),
        (2.3e-12, "kg m^2", "2.30 × 10⁻¹² kg m²"),
        (4.2e-7, "m^(7/2) kg^(-1/2)", "4.20 × 10⁻⁷ m³√(m/kg)"),
        (0.0, "N", "0 N"),
        (0.0, "Pa", "0 Pa"),
        (1e-3, "m", "1.00 mm"),
        (5e-9, "m", "0.00500 µm"),
        (math.inf, "N", "not known"),
        (math.nan, "m", "not known"),
    ],
)
def test_a_value_has_a_fitting_unit_and_three_digits(value: float, unit: str, shown: str) -> None:
    assert quantity(value, unit) == shown


@pytest.mark.parametrize(
    ("value", "deviation", "unit", "shown"),
    [
        (312.44, 3.91, "N", "312.4 ± 3.9 N"),
        (1998.1, 120.0, "N s/m", "1998 ± 120 N s/m"),
        (6.3, 11.2, "N", "6 ± 11 N"),
        (1.02e-12, 3e-14, "m^3/(s Pa)", "61.2 ± 1.8 ml/min per MPa"),
        (1.02e-12, 3e-14, "kg m^2", "(1.020 ± 0.030) × 10⁻¹² kg m²"),
        (5e-3, 2e-5, "s", "5.000 ± 0.020 ms"),
        (0.0, 1500.0, "Pa", "0.0 ± 1.5 kPa"),
        (250.0, 0.0, "N", "250 N"),
        (250.0, math.inf, "N", "250 N"),
    ],
)
def test_digits_are_those_that_the_deviation_deserves(value: float, deviation: float, unit: str, shown: str) -> None:
    assert with_deviation(value, deviation, unit) == shown


def test_powers_in_units_are_raised_and_pure_numbers_have_none() -> None:
    assert unit_text("N s^2/m^2") == "N s²/m²"
    assert unit_text("-") == ""
    assert unit_text("m^(5/2) kg^(-1/2)") == "m²√(m/kg)"


def test_a_format_string_shows_a_value_in_a_readable_unit() -> None:
    shown = "{force} or {force:4}, {ratio:%}".format(force=Quantity(76.41, "N"), ratio=Quantity(0.125, "-"))
    assert shown == "76.4 N or 76.41 N, 12.5 %"
    signed = "{ratio:+%} and {offset:+4}, {back:+}".format(
        ratio=Quantity(0.3, "-"), offset=Quantity(0.02, "m"), back=Quantity(-0.02, "m")
    )
    assert signed == "+30.0 % and +20.00 mm, -20.0 mm"
