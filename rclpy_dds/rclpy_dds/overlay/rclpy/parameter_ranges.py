"""Whether a value lies in the range its descriptor allows."""

from __future__ import annotations

import math

from rcl_interfaces.msg import FloatingPointRange, IntegerRange

from rclpy.parameter import Parameter


def integer_problem(parameter: Parameter, allowed: IntegerRange) -> str:
    """Return why a whole number is refused, "" when it is not."""
    low, high = min(allowed.from_value, allowed.to_value), max(allowed.from_value, allowed.to_value)
    value = parameter.value
    if value in (low, high):
        return ""
    if not low < value < high:
        return f"Parameter {parameter.name} out of range. Min: {low}, Max: {high}, value: {value}"
    if allowed.step and (value - low) % allowed.step:
        return (
            f"The parameter value for {parameter.name} is not a valid step. "
            f"Min: {low}, max: {high}, value: {value}, step: {allowed.step}"
        )
    return ""


def float_problem(parameter: Parameter, allowed: FloatingPointRange, tolerance: float) -> str:
    """Return why a number is refused, "" when it is not; steps and edges hold within a relative tolerance."""
    low, high = min(allowed.from_value, allowed.to_value), max(allowed.from_value, allowed.to_value)
    value = parameter.value
    if math.isclose(value, low, rel_tol=tolerance) or math.isclose(value, high, rel_tol=tolerance):
        return ""
    if not low < value < high:
        return f"Parameter {parameter.name} out of range Min: {low}, Max: {high}, value: {value}"
    if allowed.step:
        nearest = low + round((value - low) / allowed.step) * allowed.step
        if not math.isclose(nearest, value, rel_tol=tolerance):
            return (
                f"The parameter value for {parameter.name} is not close enough to a valid step. "
                f"Min: {low}, max: {high}, value: {value}, step: {allowed.step}"
            )
    return ""
