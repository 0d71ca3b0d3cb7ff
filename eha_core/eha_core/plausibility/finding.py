"""A mistake that the check finds or suspects, and the topics file that corrects it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from eha_core.recording import Channel, ChannelRule, Recording
from eha_core.recording.channel_rules import GAUGE
from eha_core.recording.discovery import default_rule
from eha_core.recording.reader import STANDARD_ATMOSPHERE


@dataclass(frozen=True)
class Finding:
    """A mistake in a recording.

    Attributes:
        mistake: the channel and what is wrong with it.
        cure: a topics file, in one line, that corrects it.
        other: a mistake that this recording cannot distinguish from it, and its cure.
    """

    mistake: str
    cure: str
    other: tuple[str, str] | None = None

    def __str__(self) -> str:
        other = f", or, if {self.other[0]}, `{self.other[1]}`" if self.other else ""
        return f"{self.mistake}; correct it in a topics file (--topics): `{self.cure}`{other}"


@dataclass(frozen=True)
class Suspect:
    """A mistake that may have been made; `undone` are the corrected channels, None for one to be left out.

    `moves_zero`: both a channel's unit and its zero are wrong; as long as the zero is inside the stroke, that cannot be
    distinguished from a wrong unit alone.
    """

    mistake: str
    undone: Mapping[str, Channel | None]
    moves_zero: bool = False

    @property
    def cure(self) -> str:
        """The topics file that corrects it."""
        return topics_line(self.undone)

    def without(self, recording: Recording) -> Recording:
        """The recording with the mistake corrected."""
        channels = {**recording.channels, **self.undone}
        return replace(recording, channels={name: channel for name, channel in channels.items() if channel})


def rescaled(recording: Recording, name: str, factor: float, shift: float = 0.0) -> Channel:
    """The channel as read by a topics file with another scale and offset; `shift` is in its SI unit.

    A pressure is scaled as in the message, before the atmospheric pressure is subtracted.
    """
    channel = recording.channels[name]
    rule = channel.rule or ChannelRule()
    zero = 0.0
    if channel.unit == "Pa" and rule.reference != GAUGE:
        zero = recording.parameters.get("atmospheric_pressure", STANDARD_ATMOSPHERE)
    values = factor * (channel.values + zero) - zero + shift
    rule = replace(rule, scale=factor * rule.scale, offset=factor * rule.offset + shift)
    return replace(channel, values=values, rule=rule)


def topics_line(channels: Mapping[str, Channel | None]) -> str:
    """The topics file, in one line, that reads these channels so; it has only entries that differ from the default."""
    return f"channels: {{{', '.join(_entry(name, channel) for name, channel in channels.items())}}}"


def _entry(name: str, channel: Channel | None) -> str:
    if channel is None:
        return f"{name}: null"
    rule = channel.rule or ChannelRule()
    default = default_rule(name, rule)
    parts = [
        f"{key}: {_text(getattr(rule, key))}"
        for key in ("topic", "field", "column", "scale", "offset", "reference")
        if getattr(rule, key) not in (None, getattr(default, key))
    ]
    return f"{name}: {{{', '.join(parts)}}}"


def _text(value: object) -> str:
    if not isinstance(value, float):
        return f'"{value}"' if "[" in str(value) else str(value)
    text = f"{value:.6g}"
    mantissa, _, exponent = text.partition("e")
    return f"{mantissa}.0e{exponent}" if exponent and "." not in mantissa else text  # YAML 1.1 reads 1e-3 as text
