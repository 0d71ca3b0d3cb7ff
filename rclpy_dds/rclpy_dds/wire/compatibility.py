"""Which profiles of quality of service are compatible, said as ROS 2 says it."""

from __future__ import annotations

from typing import Any

_OPEN = ("SYSTEM_DEFAULT", "UNKNOWN")
_OPPOSED = (
    (
        "reliability", "BEST_EFFORT", "RELIABLE",
        "Best effort publisher and reliable subscription",
        "Reliable subscription, but publisher is {}", "Best effort publisher, but subscription is {}",
    ),
    (
        "durability", "VOLATILE", "TRANSIENT_LOCAL",
        "Volatile publisher and transient local subscription",
        "Transient local subscription, but publisher is {}", "Volatile publisher, but subscription is {}",
    ),
    (
        "liveliness", "AUTOMATIC", "MANUAL_BY_TOPIC",
        "Publisher's liveliness is automatic and subscription's is manual by topic",
        "Subscription's liveliness is manual by topic, but publisher's is {}",
        "Publisher's liveliness is automatic, but subscription's is {}",
    ),
)  # fmt: skip
"""Each policy's weakest offer and strongest request, and what is said where they meet, or meet what is unset."""
_PERIODS = (
    ("deadline", "deadline", "deadline is less than publisher deadline"),
    ("liveliness_lease_duration", "liveliness lease duration", "liveliness lease duration is less than publisher"),
)


def incompatibilities(offered: Any, asked: Any) -> list[str]:
    """Return why a subscription's profile asks for more than a publisher's offers."""
    found = [
        text
        for policy, weak, strong, text, *_ in _OPPOSED
        if (getattr(offered, policy).name, getattr(asked, policy).name) == (weak, strong)
    ]
    for name, words, less in _PERIODS:
        offer, ask = getattr(offered, name), getattr(asked, name)
        if offer.nanoseconds == 0 != ask.nanoseconds:
            found.append(f"Subscription has a {words}, but publisher does not")
        elif ask.nanoseconds != 0 and ask < offer:
            found.append(f"Subscription {less}")
    return found


def left_open(offered: Any, asked: Any) -> list[str]:
    """Return in which policies a default decides whether two profiles are compatible."""
    found = []
    for policy, weak, strong, _, to_strong, from_weak in _OPPOSED:
        offer, ask = getattr(offered, policy).name, getattr(asked, policy).name
        if offer in _OPEN and ask in _OPEN:
            found.append(f"Publisher {policy} is {offer.lower()} and subscription {policy} is {ask.lower()}")
        elif offer in _OPEN and ask == strong:
            found.append(to_strong.format(offer.lower()))
        elif ask in _OPEN and offer == weak:
            found.append(from_weak.format(ask.lower()))
    return found
