"""Find where a model departs from a recording, which physics it is missing, and how much that physics improves it."""

from eha_core.diagnosis.pipeline import diagnose, diagnose_together, examine
from eha_core.diagnosis.result import Diagnosis

__all__ = ["Diagnosis", "diagnose", "diagnose_together", "examine"]
