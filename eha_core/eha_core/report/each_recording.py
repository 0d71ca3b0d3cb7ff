"""Several recordings on the terminal: what each says of the joint model, and how a recording that it never saw is
predicted."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from eha_core.diagnosis.result import Diagnosis, TestedRecording
from eha_core.parameters import catalogue
from eha_core.quantities import quantity
from eha_core.recording import CHANNEL_KINDS
from eha_core.report.wording import channel_title

MODELS = ("nominal", "recalibrated", "augmented")


def each_recording(diagnosis: Diagnosis) -> list[str]:
    """A line for every recording that the model was fitted to, and a table for every one it was only tested on."""
    lines = ["Recordings fitted together"] if diagnosis.together else []
    for one in diagnosis.together:
        left = ", ".join(
            f"{channel_title(name)} {fit.rmse_after / fit.noise:.2f}" for name, fit in one.held_out.items()
        )
        own = "".join(f"; {name} {_valued(name, value)}" for name, value in one.own_values.items())
        lines.append(f"  {Path(one.path).name}: {left} times the noise on held-out data{own}")
    for tested in diagnosis.tests:
        lines += _tested(tested)
    return lines


def _tested(tested: TestedRecording) -> Iterator[str]:
    title = f"Test on {Path(tested.path).name} (RMSE)"
    yield f"{title:40}" + "".join(f"{name:>14}" for name in MODELS)
    for channel in tested.noise:
        unit = CHANNEL_KINDS[channel].unit
        each = [tested.prediction[model][channel] for model in MODELS]
        for seconds in each[0].ahead:
            label = f"  {channel_title(channel)}, {seconds:g} s ahead"
            yield f"{label:40}" + "".join(f"{quantity(one.ahead[seconds], unit):>14}" for one in each)
        label = f"  {channel_title(channel)}, free-running"
        yield f"{label:40}" + "".join(f"{quantity(one.free_running, unit):>14}" for one in each)


def _valued(name: str, value: float) -> str:
    return quantity(value, catalogue()[name].unit)
