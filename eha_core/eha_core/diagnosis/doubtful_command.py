"""A command that rests at times and was clipped or froze in the log: by itself it looks like one with a limit of its
own, or a longer rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from eha_core.diagnosis.calibrate import Calibration, calibrate_without_faulty_ends, is_at_noise
from eha_core.diagnosis.criteria import ELSEWHERE, NOISE_KNOWN
from eha_core.errors import RecordingError
from eha_core.health import DOUBTING, examine
from eha_core.identification.observation import Observation, observe
from eha_core.nominal import NominalModel
from eha_core.recording import Recording


def without_doubtful_command(
    recordings: Sequence[Recording], observations: Sequence[Observation], calibration: Calibration, model: NominalModel
) -> tuple[tuple[Observation, ...], Calibration] | None:
    """The observations without the spans in which the command may have been clipped or frozen, and their calibration;
    None where the nominal equations explain the whole, where there is no such span, or where they fail outside, too."""
    if is_at_noise(calibration.fitted):
        return None
    try:
        rest = [
            replace(observe(recording, model.composition, examine(recording, DOUBTING)), remarks=observation.remarks)
            for recording, observation in zip(recordings, observations, strict=True)
        ]
    except RecordingError:  # too little is left to judge by
        return None
    if all(one.undriven == other.undriven for one, other in zip(rest, observations, strict=True)):
        return None
    outside, of_rest = calibrate_without_faulty_ends(rest, model)
    return (outside, of_rest) if fails_only_inside(of_rest, calibration) else None


def fails_only_inside(outside: Calibration, whole: Calibration) -> bool:
    """Whether the nominal equations leave next to nothing but noise outside of some spans, and much in the whole.

    Physics that acts where a command has its extreme acts just below it, too, and what acts in one rest acts in others;
    a fault of the log does not.
    """
    left, of_whole = (max(one.fitted.data / one.fitted.count - 1.0, 0.0) for one in (outside, whole))
    return is_at_noise(outside.fitted) and left + NOISE_KNOWN < ELSEWHERE * of_whole
