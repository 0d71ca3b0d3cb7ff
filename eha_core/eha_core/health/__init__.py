"""Whether a recording's channels are sound in themselves: holes, and faults of each channel, before any fit."""

from eha_core.health.examine import examine, unsuited
from eha_core.health.fault import Fault, Health
from eha_core.health.words import in_words

__all__ = ["Fault", "Health", "examine", "in_words", "unsuited"]
