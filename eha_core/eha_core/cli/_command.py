"""A command as given on the command line: a signal, or a file with that channel."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from eha_core.errors import EhaError, RecordingError, remedy
from eha_core.recording import read_recording
from eha_core.recording.recording import FloatArray
from eha_core.signals import from_text, signals

SIGNAL_DURATION = 10.0
"""s; default duration of a signal."""

Samples = tuple[FloatArray, FloatArray]


def is_signal(words: str) -> bool:
    """Whether the words name a signal, and no file has that name."""
    return words.partition(":")[0] in signals() and not Path(words).exists()


def read_command(arguments: argparse.Namespace, name: str) -> tuple[FloatArray, FloatArray, float]:
    """Instants [s], values of the channel of that name and the duration [s], from the arguments `command`, `duration`,
    `rate` and `topics`. Raises EhaError where the command is neither a signal nor a file with that channel."""
    words: str = arguments.command
    if is_signal(words):
        signal = from_text(words)
        duration = arguments.duration or SIGNAL_DURATION
        times = np.arange(round(duration * arguments.rate)) / arguments.rate
        return times, signal.value(times), duration
    if not Path(words).exists():
        shape = words.partition(":")[0]
        raise EhaError(f"--command {words}: neither a file nor a signal; {remedy(shape, signals())}")
    channel = read_recording(words, arguments.topics).channels.get(name)
    if channel is None:
        raise RecordingError(f"{words}: no {name} was recorded; a topics file (--topics) can name the topic")
    end = float(channel.time[-1])
    duration = arguments.duration or max(np.ceil(end * arguments.rate + 1) / arguments.rate, 1.0 / arguments.rate)
    return channel.time, channel.values, duration
