"""What a planned test can detect, before it is made: the smallest effects, and those that it cannot distinguish."""

from eha_core.detectability.certificate import Certificate, certify
from eha_core.detectability.design import DesignedTest, design
from eha_core.detectability.limits_file import read_limits
from eha_core.detectability.planned import NOISE, PlannedTest

__all__ = ["NOISE", "Certificate", "DesignedTest", "PlannedTest", "certify", "design", "read_limits"]
