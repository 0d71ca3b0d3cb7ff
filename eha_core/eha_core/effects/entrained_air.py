"""Air carried along as bubbles: the oil is soft at low pressure and stiff at high pressure.

Signature: the pressures answer slowly after they were low, and the resonance falls with the pressure.
Equation: beta = (L + G) / (L / beta_oil + G / (n P)), L = 1 - air_fraction, G = air_fraction (P_0 / P)^(1/n), n = 1.4,
P the absolute pressure, P_0 one atmosphere.
Sign: a positive fraction softens.
Validity: bubbles that neither dissolve nor come out of solution within the recording; below 1 kPa absolute the mixture
is taken as at 1 kPa.
Source: J. Gholizadeh, R. Burton, G. Schoenau, "Fluid bulk modulus: a literature survey", International Journal of Fluid
Power 12 (2011); B.-H. Cho, H.-W. Lee, J.-S. Oh, "Estimation technique of air content in automatic transmission fluid by
measuring effective bulk modulus", International Journal of Automotive Technology 3 (2002).
"""

from math import exp, log

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EXPONENT = 1.4
"""Polytropic exponent of the air: no heat passes to the oil."""

REFERENCE_PRESSURE = 101325.0
"""Pa, absolute; the fraction of air is the one at this pressure."""

LEAST_PRESSURE = 1e3
"""Pa, absolute; about where oil boils. It keeps the mixture's stiffness above zero."""

EFFECT = Effect(
    site="chamber",
    approximate=True,
    statement="the oil carries air: {air_fraction:%} of its volume at one atmosphere",
    equation="1/beta = (L/beta_oil + G/(1.4 P)) / (L + G), L = 1 - air_fraction, G = air_fraction (P_0/P)^(1/1.4)",
    parameters=(
        Parameter(
            name="air_fraction",
            symbol="alpha",
            unit="-",
            nominal=0.0,
            lower=0.0,
            upper=0.5,
            meaning="share of the volume that is air at one atmosphere",
            source=ASSUMED,
            typical=0.03,
            switches=True,
            starts=(0.3, 1.0),
        ),
    ),
)


@inlined
def mixture(bulk, pressure, air_fraction):
    """Bulk modulus [Pa] at an absolute pressure [Pa], and the derivative of its logarithm [1/Pa]."""
    held = max(pressure, LEAST_PRESSURE)
    oil = 1.0 - air_fraction
    air = air_fraction * exp(log(REFERENCE_PRESSURE / held) / EXPONENT)
    air_yield = air / (EXPONENT * held)
    softness = oil / bulk + air_yield
    change = air_yield * ((1.0 + 1.0 / EXPONENT) / (held * softness) - 1.0 / (oil + air))
    return (oil + air) / softness, (change if pressure > LEAST_PRESSURE else 0.0)


@inlined
def contribution(
    area_b,
    bulk_a,
    bulk_change_a,
    bulk_b,
    bulk_change_b,
    cross_flow,
    cross_slope,
    leakage_a,
    leakage_b,
    position,
    pressure_a,
    pressure_b,
    atmospheric_pressure,
    air_fraction,
):
    """Soften the oil of each chamber by its own pressure."""
    bulk_a, bulk_change_a = mixture(bulk_a, pressure_a + atmospheric_pressure, air_fraction)
    bulk_b, bulk_change_b = mixture(bulk_b, pressure_b + atmospheric_pressure, air_fraction)
    return area_b, bulk_a, bulk_change_a, bulk_b, bulk_change_b, cross_flow, cross_slope, leakage_a, leakage_b
