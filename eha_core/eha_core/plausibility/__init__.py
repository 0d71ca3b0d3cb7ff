"""Whether a recording can be right at all: signs, scales and ranges of its channels, before any fit."""

from eha_core.plausibility.architecture import Contradiction, contradiction
from eha_core.plausibility.check import admit, check
from eha_core.plausibility.finding import Finding

__all__ = ["Contradiction", "Finding", "admit", "check", "contradiction"]
