"""Whether a recording is plausible: signs, scales and ranges of its channels, before any fit."""

from eha_core.plausibility.check import admit, check
from eha_core.plausibility.finding import Finding
from eha_core.plausibility.other_source import Contradiction, contradiction

__all__ = ["Contradiction", "Finding", "admit", "check", "contradiction"]
