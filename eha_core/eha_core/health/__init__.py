"""The health of a recording's channels before any fit: gaps, and the faults of each channel."""

from eha_core.health.examine import DOUBTING, examine, unsuited
from eha_core.health.fault import Fault, Health
from eha_core.health.words import in_words

__all__ = ["DOUBTING", "Fault", "Health", "examine", "in_words", "unsuited"]
