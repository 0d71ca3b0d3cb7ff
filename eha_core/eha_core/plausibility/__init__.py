"""Whether a recording can be right at all: signs, scales and ranges of its channels, before any fit."""

from eha_core.plausibility.check import admit, check
from eha_core.plausibility.finding import Finding

__all__ = ["Finding", "admit", "check"]
