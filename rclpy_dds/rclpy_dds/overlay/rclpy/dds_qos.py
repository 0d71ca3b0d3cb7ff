"""Quality of service between rclpy's profiles and Cyclone DDS's policies."""

from __future__ import annotations

from typing import Any

from cyclonedds.qos import Policy, Qos

from rclpy.duration import Duration, Infinite
from rclpy.qos import (
    _BEST_AVAILABLE_NANOSECONDS,
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy_dds.wire.entities import INFINITY


def to_dds(profile: QoSProfile, user_data: str = "", *, ignore_local: bool = False) -> Qos:
    """Return the DDS policies rmw_cyclonedds_cpp makes of a profile.

    Args:
        profile: the profile; "best available" and "system default" must have been resolved or mean the default.
        user_data: what the endpoint announces, such as its type hash.
        ignore_local: leave out what this process publishes.
    """
    depth = profile.depth or 1
    keep_all = profile.history == HistoryPolicy.KEEP_ALL
    history = Policy.History.KeepAll if keep_all else Policy.History.KeepLast(depth)
    policies: list[Any] = [
        history,
        Policy.DataRepresentation(use_cdrv0_representation=True),
        Policy.WriterDataLifecycle(autodispose=False),
        Policy.Deadline(_nanoseconds(profile.deadline)),
        Policy.Lifespan(_nanoseconds(profile.lifespan)),
        Policy.IgnoreLocal.Participant if ignore_local else Policy.IgnoreLocal.Nothing,
    ]
    if profile.reliability == ReliabilityPolicy.BEST_EFFORT:
        policies.append(Policy.Reliability.BestEffort)
    else:
        policies.append(Policy.Reliability.Reliable(INFINITY))
    if profile.durability == DurabilityPolicy.TRANSIENT_LOCAL:
        policies.append(Policy.Durability.TransientLocal)
        policies.append(Policy.DurabilityService(0, history, -1, -1, -1))
    else:
        policies.append(Policy.Durability.Volatile)
    lease = _nanoseconds(profile.liveliness_lease_duration)
    manual = profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    policies.append(Policy.Liveliness.ManualByTopic(lease) if manual else Policy.Liveliness.Automatic(lease))
    if user_data:
        policies.append(Policy.Userdata(user_data.encode("ascii")))
    return Qos(*policies)


def from_dds(qos: Qos) -> QoSProfile:
    """Return the profile of an endpoint found in the graph; what is not announced is UNKNOWN."""
    history = qos[Policy.History] if Policy.History in qos else None  # noqa: SIM401 - a Qos is no dict
    kept, depth = HistoryPolicy.UNKNOWN, 0
    if isinstance(history, Policy.History.KeepLast):
        kept, depth = HistoryPolicy.KEEP_LAST, history.depth
    elif history is not None:
        kept = HistoryPolicy.KEEP_ALL
    values: dict[str, Any] = {
        "history": kept,
        "depth": depth,
        "reliability": ReliabilityPolicy.RELIABLE,
        "durability": DurabilityPolicy.VOLATILE,
        "liveliness": LivelinessPolicy.AUTOMATIC,
        "lifespan": Infinite, "deadline": Infinite, "liveliness_lease_duration": Infinite,
    }  # fmt: skip
    if Policy.Reliability in qos and qos[Policy.Reliability] == Policy.Reliability.BestEffort:
        values["reliability"] = ReliabilityPolicy.BEST_EFFORT
    if Policy.Durability in qos and qos[Policy.Durability] != Policy.Durability.Volatile:
        values["durability"] = DurabilityPolicy.TRANSIENT_LOCAL
    if Policy.Deadline in qos:
        values["deadline"] = _duration(qos[Policy.Deadline].deadline)
    if Policy.Lifespan in qos:
        values["lifespan"] = _duration(qos[Policy.Lifespan].lifespan)
    if Policy.Liveliness in qos:
        liveliness = qos[Policy.Liveliness]
        values["liveliness_lease_duration"] = _duration(liveliness.lease_duration)
        if isinstance(liveliness, Policy.Liveliness.ManualByTopic):
            values["liveliness"] = LivelinessPolicy.MANUAL_BY_TOPIC
    return QoSProfile(**values)


def _nanoseconds(duration: Duration) -> int:
    """Return nanoseconds for DDS: not set, infinite and best available are all without limit."""
    value = duration.nanoseconds
    return INFINITY if value <= 0 or value >= _BEST_AVAILABLE_NANOSECONDS else value


def _duration(nanoseconds: int) -> Duration:
    return Infinite if nanoseconds >= INFINITY else Duration(nanoseconds=nanoseconds)
