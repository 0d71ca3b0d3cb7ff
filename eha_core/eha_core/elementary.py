"""Exponential, logarithm and power that the compiler vectorises, and that give the scalar step the same digits.

A call into the C library keeps a loop over lanes from becoming one over vectors. These are a reduction of the argument
by powers of two, told from the bits of the number (IEEE 754), and a truncated power series. Within the tolerances that
their tests state they are NumPy's; the interpreter finds the same digits.
"""

from __future__ import annotations

import struct
from fractions import Fraction
from math import factorial

from numba import types
from numba.extending import intrinsic, overload

from eha_core.compiled import inlined

LOG2_E = 1.4426950408889634
LN2_HIGH, LN2_LOW = 0.6931471803691238, 1.9082149292705877e-10
"""The logarithm of two in two parts: the first has so few digits that its product with a whole exponent is exact."""

LEAST, MOST = -708.0, 709.0
"""Beyond these the exponential is no normal number; it is held there."""

WHOLE = 6755399441055744.0
"""1.5 * 2^52: a number added to it loses what stands behind the point, and shows its whole part in the lowest bits."""

MANTISSA, EXPONENT_BIAS = 52, 1023
"""How many bits a float64's mantissa has, above which stands its exponent, and what is added to that (IEEE 754)."""

FRACTION, ONE, TWO_TO_52 = 0x000FFFFFFFFFFFFF, 0x3FF0000000000000, 0x4330000000000000
"""Bits: those of the mantissa, those of 1.0, and those of 2^52, in whose lowest bits a whole number can be put."""

BIAS_BESIDE = 2.0**MANTISSA + EXPONENT_BIAS
"""What is taken off an exponent's bits that were put into 2^52."""

SQRT_2 = 1.4142135623730951

E3, E4, E5, E6, E7, E8, E9, E10, E11, E12, E13 = (1.0 / factorial(order) for order in range(3, 14))
"""Coefficients of the exponential's series."""

L3, L5, L7, L9, L11, L13, L15, L17, L19, L21 = (1.0 / order for order in range(3, 22, 2))
"""Coefficients of the series of artanh, of which the logarithm is twice."""


def _bits(number: float) -> int:
    """The bits of a float64, as an integer."""
    return int(struct.unpack("q", struct.pack("d", number))[0])


def _number(bits: int) -> float:
    """The float64 of these bits."""
    return float(struct.unpack("d", struct.pack("Q", bits & 0xFFFFFFFFFFFFFFFF))[0])


def _fma(one: float, other: float, added: float) -> float:
    """one * other + added, rounded once: in the processor it takes half as long as two operations."""
    return float(Fraction(one) * Fraction(other) + Fraction(added))


@intrinsic
def _compiled_bits(context, number):
    def generate(codegen, builder, signature, arguments):
        return builder.bitcast(arguments[0], codegen.get_value_type(types.int64))

    return types.int64(types.float64), generate


@intrinsic
def _compiled_number(context, bits):
    def generate(codegen, builder, signature, arguments):
        return builder.bitcast(arguments[0], codegen.get_value_type(types.float64))

    return types.float64(types.int64), generate


@intrinsic
def _compiled_fma(context, one, other, added):
    def generate(codegen, builder, signature, arguments):
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), generate


overload(_bits, inline="always")(lambda number: lambda number: _compiled_bits(number))
overload(_number, inline="always")(lambda bits: lambda bits: _compiled_number(bits))
overload(_fma, inline="always")(lambda one, other, added: lambda one, other, added: _compiled_fma(one, other, added))


@inlined
def exp(of):
    """e to the power `of`, held between those of LEAST and MOST."""
    held = min(MOST, max(LEAST, of))
    shifted = _fma(held, LOG2_E, WHOLE)
    twos = shifted - WHOLE
    rest = _fma(-twos, LN2_LOW, _fma(-twos, LN2_HIGH, held))
    square = rest * rest
    fourth = square * square
    first = _fma(_fma(E5, rest, E4), square, _fma(E3, rest, 0.5))
    second = _fma(_fma(E9, rest, E8), square, _fma(E7, rest, E6))
    third = _fma(_fma(E13, rest, E12), square, _fma(E11, rest, E10))
    series = _fma(_fma(_fma(third, fourth, second), fourth, first), square, rest)
    return (1.0 + series) * _number((_bits(shifted) + EXPONENT_BIAS) << MANTISSA)


@inlined
def log(of):
    """Natural logarithm of a positive normal number; that of zero is -709.1, the least there is."""
    bits = _bits(of)
    twos = _number((bits >> MANTISSA) | TWO_TO_52) - BIAS_BESIDE
    mantissa = _number((bits & FRACTION) | ONE)
    above = mantissa > SQRT_2
    mantissa = 0.5 * mantissa if above else mantissa
    twos = twos + 1.0 if above else twos
    share = (mantissa - 1.0) / (mantissa + 1.0)
    square = share * share
    fourth = square * square
    first = _fma(_fma(L9, square, L7), fourth, _fma(L5, square, L3))
    second = _fma(_fma(L17, square, L15), fourth, _fma(L13, square, L11))
    third = _fma(L21, square, L19)
    eighth = fourth * fourth
    series = _fma(_fma(third, eighth, second), eighth, first)
    doubled = share + share
    return _fma(twos, LN2_HIGH, _fma(twos, LN2_LOW, _fma(doubled * square, series, doubled)))


@inlined
def power(of, exponent):
    """A number from zero up, to a positive power."""
    return exp(exponent * log(of))
