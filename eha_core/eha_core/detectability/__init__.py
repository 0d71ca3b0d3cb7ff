"""What a planned test can show, before it is made: the smallest effects, and those it cannot distinguish."""

from eha_core.detectability.certificate import Certificate, Detectable, Noticeable, certify
from eha_core.detectability.confusion import Confusion
from eha_core.detectability.planned import NOISE, PlannedTest

__all__ = ["NOISE", "Certificate", "Confusion", "Detectable", "Noticeable", "PlannedTest", "certify"]
