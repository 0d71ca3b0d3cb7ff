"""Several recordings, on the terminal and on the page: what each says of the joint model, and how a recording that it
never saw is predicted."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from eha_core.diagnosis.result import Diagnosis, PredictedRecording
from eha_core.parameters import catalogue
from eha_core.quantities import quantity
from eha_core.recording import CHANNEL_KINDS
from eha_core.report.stage import Table
from eha_core.report.wording import channel_title, words

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


def _tested(tested: PredictedRecording) -> Iterator[str]:
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


def recording_tables(diagnosis: Diagnosis) -> tuple[Table, ...]:
    """The same for the page: a table of the recordings fitted together, and one for each that was only predicted."""
    tables = [_together(diagnosis)] if diagnosis.together else []
    return (*tables, *(_prediction(tested) for tested in diagnosis.tests))


def _together(diagnosis: Diagnosis) -> Table:
    first = diagnosis.together[0]
    channels, own = list(first.held_out), list(first.own_values)
    rows = tuple(
        (
            Path(one.path).name,
            *(f"{one.held_out[name].rmse_after / one.held_out[name].noise:.2f}" for name in channels),
            *(_valued(name, one.own_values[name]) for name in own),
        )
        for one in diagnosis.together
    )
    headings = ("recording", *(f"{channel_title(name)} [× noise]" for name in channels), *map(words, own))
    return Table(headings, rows, "Recordings fitted together: held-out errors, and the values that are their own")


def _prediction(tested: PredictedRecording) -> Table:
    rows = []
    for channel in tested.noise:
        unit = CHANNEL_KINDS[channel].unit
        each = [tested.prediction[model][channel] for model in MODELS]
        title = channel_title(channel)
        for seconds in each[0].ahead:
            shown = (quantity(one.ahead[seconds], unit) for one in each)
            rows.append((f"{title}, {seconds:g} s ahead", *shown, quantity(tested.noise[channel], unit)))
        shown = (quantity(one.free_running, unit) for one in each)
        rows.append((f"{title}, free-running", *shown, quantity(tested.noise[channel], unit)))
    title = f"Test on {Path(tested.path).name}, which no model was fitted to: RMSE"
    return Table(("prediction", *MODELS, "noise"), tuple(rows), title)
