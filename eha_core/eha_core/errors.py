"""The errors that a user can cause. Each message is one line: what is wrong, where, and the remedy."""

from __future__ import annotations


class EhaError(Exception):
    """Anything that the user can put right."""


class ParameterError(EhaError):
    """A parameter is unknown, is no number, or lies outside its bounds."""


class RecordingError(EhaError):
    """A recording or a topics file cannot be used."""
