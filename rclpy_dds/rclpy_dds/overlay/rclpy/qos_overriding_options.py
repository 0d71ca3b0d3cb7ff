"""Policies that users may change through parameters `qos_overrides.<topic>.<entity>.<policy>`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor

from rclpy.duration import Duration
from rclpy.exceptions import ParameterAlreadyDeclaredException
from rclpy.qos import _DURATIONS, _ENUMS, QoSPolicyKind, QoSProfile


class InvalidQosOverridesError(Exception):
    """Raised when overrides make a profile that the callback refuses."""


@dataclass
class QosCallbackResult:
    """Whether a callback accepts a profile, and why not."""

    successful: bool = False
    reason: str = ""


class QoSOverridingOptions:
    """Which policies of an endpoint parameters may override."""

    def __init__(
        self,
        policy_kinds: Iterable[QoSPolicyKind],
        *,
        callback: Callable[[QoSProfile], Any] | None = None,
        entity_id: str | None = None,
    ) -> None:
        self.policy_kinds = policy_kinds
        self.callback = callback
        self.entity_id = entity_id

    @classmethod
    def with_default_policies(
        cls, *, callback: Callable[[QoSProfile], Any] | None = None, entity_id: str | None = None
    ) -> QoSOverridingOptions:
        """Return options for history, depth and reliability."""
        kinds = (QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY)
        return cls(policy_kinds=kinds, callback=callback, entity_id=entity_id)


def _declare_qos_parameters(
    entity_type: str, node: Any, topic_name: str, qos: QoSProfile, options: QoSOverridingOptions
) -> QoSProfile:
    """Declare the parameters and return the profile with what they say.

    Raises:
        InvalidQosOverridesError: the callback refuses the profile.
    """
    suffix = f"_{options.entity_id}" if options.entity_id else ""
    prefix = f"qos_overrides.{topic_name}.{entity_type}{suffix}"
    values = qos.to_dict()
    for kind in options.policy_kinds:
        policy = QoSPolicyKind(kind).name.lower()
        if policy not in values:
            raise ValueError(f"invalid policy kind for an override: {policy}")
        descriptor = ParameterDescriptor(
            description=f"qos policy {policy} of {entity_type} on {topic_name}", read_only=True
        )
        name = f"{prefix}.{policy}"
        try:
            given = node.declare_parameter(name, _to_parameter(policy, values[policy]), descriptor).value
        except ParameterAlreadyDeclaredException:
            given = node.get_parameter(name).value
        values[policy] = _from_parameter(policy, given)
    profile = QoSProfile(**values)
    if options.callback is not None:
        result = options.callback(profile)
        if not result.successful:
            raise InvalidQosOverridesError(f"{node.get_name()}: {topic_name}: {result.reason}")
    return profile


def _to_parameter(policy: str, value: Any) -> Any:
    if policy in _ENUMS:
        return value.short_key
    return value.nanoseconds if policy in _DURATIONS else value


def _from_parameter(policy: str, value: Any) -> Any:
    if policy in _ENUMS:
        try:
            return _ENUMS[policy].get_from_short_key(value)
        except KeyError:
            raise InvalidQosOverridesError(
                f"{value!r} is no {policy}; use one of {', '.join(_ENUMS[policy].short_keys())}"
            ) from None
    return Duration(nanoseconds=value) if policy in _DURATIONS else value
