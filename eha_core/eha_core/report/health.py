"""What is said of the faults of a recording's channels."""

from __future__ import annotations

from collections.abc import Iterator

from eha_core.diagnosis.result import Diagnosis
from eha_core.health import in_words


def faults_told(diagnosis: Diagnosis) -> Iterator[str]:
    """One sentence for each channel and kind of fault, that of several recordings with its number."""
    for number in sorted({number for number, _ in diagnosis.health}):
        for line in in_words([fault for other, fault in diagnosis.health if other == number]):
            yield f"recording {number}: {line}" if diagnosis.together else line
