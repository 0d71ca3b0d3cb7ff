"""Events about quality of service: missed deadlines, lost liveliness, incompatible and matched endpoints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from rclpy.exceptions import UnsupportedEventTypeError
from rclpy.logging import get_logger
from rclpy.qos import QoSPolicyKind, qos_policy_name_from_kind
from rclpy_dds.wire import entities

# DDS numbers policies its own way.
_POLICY_OF_DDS_ID = {
    2: QoSPolicyKind.DURABILITY, 4: QoSPolicyKind.DEADLINE, 8: QoSPolicyKind.LIVELINESS,
    11: QoSPolicyKind.RELIABILITY, 13: QoSPolicyKind.HISTORY, 21: QoSPolicyKind.LIFESPAN,
}  # fmt: skip


class QoSPublisherEventType(IntEnum):
    """Events of a publisher."""

    RCL_PUBLISHER_OFFERED_DEADLINE_MISSED = 0
    RCL_PUBLISHER_LIVELINESS_LOST = 1
    RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS = 2
    RCL_PUBLISHER_INCOMPATIBLE_TYPE = 3
    RCL_PUBLISHER_MATCHED = 4


class QoSSubscriptionEventType(IntEnum):
    """Events of a subscription."""

    RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED = 0
    RCL_SUBSCRIPTION_LIVELINESS_CHANGED = 1
    RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS = 2
    RCL_SUBSCRIPTION_MESSAGE_LOST = 3
    RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE = 4
    RCL_SUBSCRIPTION_MATCHED = 5


@dataclass
class QoSDeadlineMissedInfo:
    """How often a deadline was missed."""

    total_count: int
    total_count_change: int


@dataclass
class QoSLivelinessLostInfo:
    """How often a publisher failed to show it was alive."""

    total_count: int
    total_count_change: int


@dataclass
class QoSLivelinessChangedInfo:
    """How many publishers are alive and how many are not."""

    alive_count: int
    not_alive_count: int
    alive_count_change: int
    not_alive_count_change: int


@dataclass
class QoSMessageLostInfo:
    """How many messages were lost."""

    total_count: int
    total_count_change: int


@dataclass
class QoSIncompatibleInfo:
    """How many endpoints do not match, and the policy of the last."""

    total_count: int
    total_count_change: int
    last_policy_kind: QoSPolicyKind


@dataclass
class MatchedInfo:
    """How many endpoints are matched."""

    total_count: int
    total_count_change: int
    current_count: int
    current_count_change: int


QoSOfferedDeadlineMissedInfo = QoSRequestedDeadlineMissedInfo = QoSDeadlineMissedInfo
QoSOfferedIncompatibleQoSInfo = QoSRequestedIncompatibleQoSInfo = QoSIncompatibleInfo
QoSPublisherMatchedInfo = QoSSubscriptionMatchedInfo = MatchedInfo

_STATUSES: dict[Any, tuple[str, Any]] = {
    QoSPublisherEventType.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED: ("offered_deadline_missed", QoSDeadlineMissedInfo),
    QoSPublisherEventType.RCL_PUBLISHER_LIVELINESS_LOST: ("liveliness_lost", QoSLivelinessLostInfo),
    QoSPublisherEventType.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS: ("offered_incompatible_qos", QoSIncompatibleInfo),
    QoSPublisherEventType.RCL_PUBLISHER_MATCHED: ("publication_matched", MatchedInfo),
}
_SUBSCRIPTION_STATUSES: dict[Any, tuple[str, Any]] = {
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED: (
        "requested_deadline_missed",
        QoSDeadlineMissedInfo,
    ),
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_LIVELINESS_CHANGED: ("liveliness_changed", QoSLivelinessChangedInfo),
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS: (
        "requested_incompatible_qos",
        QoSIncompatibleInfo,
    ),
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_MESSAGE_LOST: ("sample_lost", QoSMessageLostInfo),
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_MATCHED: ("subscription_matched", MatchedInfo),
}


class EventHandler:
    """Calls a function when one event of one endpoint happens."""

    def __init__(
        self, *, callback_group: Any, callback: Callable[..., Any], event_type: Any, endpoint: Any, entity: int
    ) -> None:
        table = _STATUSES if isinstance(event_type, QoSPublisherEventType) else _SUBSCRIPTION_STATUSES
        if event_type not in table:
            raise UnsupportedEventTypeError(
                "Cyclone DDS reports no incompatible types; endpoints of other types never meet"
            )
        self.callback_group = callback_group
        self.callback = callback
        self.event_type = event_type
        self.endpoint = endpoint
        self.entity = entity
        self.kind, self.info_class = table[event_type]
        endpoint._event_kinds.add(self.kind)
        entities.enable_statuses(entity, endpoint._event_kinds)

    def _take(self) -> Any:
        if self.endpoint._destroyed:
            return None
        status = entities.status(self.entity, self.kind)
        fields = {name: getattr(status, name, 0) for name in self.info_class.__dataclass_fields__}
        changes = [value for name, value in fields.items() if name.endswith("_change")]
        if not any(changes):
            return None
        if self.info_class is QoSIncompatibleInfo:
            fields["last_policy_kind"] = _POLICY_OF_DDS_ID.get(status.last_policy_id, QoSPolicyKind.INVALID)
        return self.info_class(**fields)

    def _handle(self, taken: Any) -> Any:
        return self.callback(taken)


class QoSEventHandler(EventHandler):
    """The name EventHandler had before."""


class _Callbacks:
    """Functions for events, made into handlers when the endpoint exists."""

    events: dict[str, Any] = {}
    incompatible = ""
    message = ""

    def __init__(self, *, use_default_callbacks: bool = True, **callbacks: Callable[..., Any] | None) -> None:
        unknown = set(callbacks) - set(self.events)
        if unknown:
            raise TypeError(f"unexpected event callbacks: {', '.join(sorted(unknown))}")
        for name in self.events:
            setattr(self, name, callbacks.get(name))
        self.use_default_callbacks = use_default_callbacks

    def create_event_handlers(
        self, callback_group: Any, endpoint: Any, entity: int, topic_name: str, logger_name: str
    ) -> list[EventHandler]:
        """Return the handlers; incompatible QoS is logged where no function is given."""
        handlers = []
        for name, event_type in self.events.items():
            callback = getattr(self, name)
            if callback is None and name == self.incompatible and self.use_default_callbacks:
                callback = self._log_incompatible(topic_name, get_logger(logger_name))
            if callback is not None:
                handlers.append(
                    EventHandler(
                        callback_group=callback_group,
                        callback=callback,
                        event_type=event_type,
                        endpoint=endpoint,
                        entity=entity,
                    )
                )
        return handlers

    def _log_incompatible(self, topic_name: str, logger: Any) -> Callable[[Any], None]:
        def warn(event: QoSIncompatibleInfo) -> None:
            policy = qos_policy_name_from_kind(event.last_policy_kind)
            logger.warn(self.message.format(topic=topic_name, policy=policy))

        return warn


class PublisherEventCallbacks(_Callbacks):
    """Functions for a publisher's events: deadline, liveliness, incompatible_qos, incompatible_type, matched."""

    events = {
        "deadline": QoSPublisherEventType.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED,
        "liveliness": QoSPublisherEventType.RCL_PUBLISHER_LIVELINESS_LOST,
        "incompatible_qos": QoSPublisherEventType.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS,
        "incompatible_type": QoSPublisherEventType.RCL_PUBLISHER_INCOMPATIBLE_TYPE,
        "matched": QoSPublisherEventType.RCL_PUBLISHER_MATCHED,
    }
    incompatible = "incompatible_qos"
    message = (
        "New subscription discovered on topic '{topic}', requesting incompatible QoS. "
        "No messages will be sent to it. Last incompatible policy: {policy}"
    )


class SubscriptionEventCallbacks(_Callbacks):
    """Functions for a subscription's events: as a publisher's, and message_lost."""

    events = {
        "deadline": QoSSubscriptionEventType.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED,
        "liveliness": QoSSubscriptionEventType.RCL_SUBSCRIPTION_LIVELINESS_CHANGED,
        "message_lost": QoSSubscriptionEventType.RCL_SUBSCRIPTION_MESSAGE_LOST,
        "incompatible_qos": QoSSubscriptionEventType.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS,
        "incompatible_type": QoSSubscriptionEventType.RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE,
        "matched": QoSSubscriptionEventType.RCL_SUBSCRIPTION_MATCHED,
    }
    incompatible = "incompatible_qos"
    message = (
        "New publisher discovered on topic '{topic}', offering incompatible QoS. "
        "No messages will be received from it. Last incompatible policy: {policy}"
    )
