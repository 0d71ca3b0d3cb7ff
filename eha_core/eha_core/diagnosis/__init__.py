"""Say where a model departs from a recording, which physics it leaves out, and how much better it does with it."""

from eha_core.diagnosis.pipeline import diagnose, diagnose_together, examine
from eha_core.diagnosis.result import Diagnosis

__all__ = ["Diagnosis", "diagnose", "diagnose_together", "examine"]
