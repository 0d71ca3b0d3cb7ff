"""How well the joint model fits each training recording, and how well it predicts each test recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from eha_core.diagnosis.evidence import Evidence
from eha_core.diagnosis.explained import predictions
from eha_core.diagnosis.result import ChannelFit, PredictedRecording, RecordingFit
from eha_core.identification.fit import Fit
from eha_core.identification.observation import observe
from eha_core.identification.per_recording import base_name, named, values_of
from eha_core.identification.together import check_alike
from eha_core.recording import Recording


def fitted_recordings(evidence: Evidence, final: Fit, held_out: Mapping[str, ChannelFit]) -> tuple[RecordingFit, ...]:
    """Each recording's fit on its held-out windows and its own values; empty for a single recording."""
    observations, marked = evidence.observations, evidence.calibration.shooting.per_recording
    if len(observations) == 1:
        return ()
    own = [parameter.name for parameter in final.free if parameter.name in marked]
    return tuple(
        RecordingFit(
            observation.path,
            {name: final.values[named(name, number)] for name in own},
            of_recording(held_out, number),
        )
        for number, observation in enumerate(observations, 1)
    )


def of_recording(channels: Mapping[str, ChannelFit], number: int) -> Mapping[str, ChannelFit]:
    """The channels of one recording, by their plain names."""
    return {base_name(name): fit for name, fit in channels.items() if name == named(base_name(name), number)}


def predicted_recordings(evidence: Evidence, final: Fit, tests: Sequence[Recording]) -> tuple[PredictedRecording, ...]:
    """How well the three models predict recordings that nothing was fitted to.

    Values that differ between recordings are not known of these: a nominal parameter keeps its nominal value, an
    effect's parameter takes the mean over the training recordings.

    Raises RecordingError where a recording cannot be used.
    """
    models = {
        "nominal": evidence.nominal,
        "recalibrated": _values_for_another_recording(evidence, evidence.comparison.nominal.fit),
        "augmented": _values_for_another_recording(evidence, final),
    }
    found = []
    for recording in tests:
        observation = observe(recording, evidence.observation.composition)
        check_alike([evidence.observation, observation])
        step = evidence.calibration.shooting.step_size
        predicted = {name: predictions(observation, values, step) for name, values in models.items()}
        noise = {channel.name: channel.noise for channel in observation.measured}
        found.append(PredictedRecording(observation.path, predicted, noise))
    return tuple(found)


def _values_for_another_recording(evidence: Evidence, model: Fit) -> Mapping[str, float]:
    """A fitted model's values for a recording that it was not fitted to."""
    shooting = evidence.calibration.shooting
    count = len(shooting.first_windows)
    values = dict(model.values)
    for name in shooting.per_recording:
        each = [values_of(model.values, number)[name] for number in range(1, count + 1)]
        values[name] = evidence.nominal[name] if "." not in name else float(np.mean(each))
    return values
