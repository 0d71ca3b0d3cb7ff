"""Several recordings, on the terminal and on the page: the joint model's error in each, and its predictions of test
recordings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from eha_core.diagnosis.result import Diagnosis, LongRecord, PredictedRecording
from eha_core.parameter import Parameter
from eha_core.plant import Composition
from eha_core.quantities import quantity
from eha_core.recording import CHANNEL_KINDS
from eha_core.report.stage import Table
from eha_core.report.wording import channel_title, words

MOST_ROWS = 40
"""Parts of a long record in a table."""

MODELS = ("nominal", "recalibrated", "augmented")


def each_recording(diagnosis: Diagnosis) -> list[str]:
    """A line for each recording that the model was fitted to, and a table for each that it was only tested on."""
    lines = ["Recordings fitted together"] if diagnosis.together else []
    for recording in diagnosis.together:
        left = ", ".join(
            f"{channel_title(name)} {fit.rmse_after / fit.noise:.2f}" for name, fit in recording.held_out.items()
        )
        rows = ((_row(name, diagnosis.composition), value) for name, value in recording.own_values.items())
        own = "".join(f"; {row.name} {row.symbol} = {quantity(value, row.unit)}" for row, value in rows)
        lines.append(f"  {Path(recording.path).name}: {left} times the noise on held-out data{own}")
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
            yield f"{label:40}" + "".join(f"{quantity(prediction.ahead[seconds], unit):>14}" for prediction in each)
        label = f"  {channel_title(channel)}, free-running"
        yield f"{label:40}" + "".join(f"{quantity(prediction.free_running, unit):>14}" for prediction in each)


def _row(name: str, composition: Composition) -> Parameter:
    """The declaration (name, symbol, unit) of a parameter of the plant or of an effect, by its full name."""
    for effect in composition.effects:
        if name in effect.parameter_names():
            place = effect.parameter_names().index(name)
            return replace(composition.as_shown(effect).parameters[place], name=name)
    return composition.place_rows[name]


def recording_tables(diagnosis: Diagnosis) -> tuple[Table, ...]:
    """The same as tables: one of the recordings fitted together, and one for each long or test recording."""
    tables = [_together(diagnosis)] if diagnosis.together else []
    whole = (_whole(record) for record in diagnosis.long_records)
    return (*tables, *whole, *(_prediction(tested) for tested in diagnosis.tests))


def _together(diagnosis: Diagnosis) -> Table:
    first = diagnosis.together[0]
    channels = list(first.held_out)
    own = {name: _row(name, diagnosis.composition) for name in first.own_values}
    rows = tuple(
        (
            Path(recording.path).name,
            *(f"{recording.held_out[name].rmse_after / recording.held_out[name].noise:.2f}" for name in channels),
            *(quantity(recording.own_values[name], row.unit) for name, row in own.items()),
        )
        for recording in diagnosis.together
    )
    titles = (f"{words(row.name)} {row.symbol}" for row in own.values())
    headings = ("recording", *(f"{channel_title(name)} [× noise]" for name in channels), *titles)
    return Table(headings, rows, "Recordings fitted together: held-out errors and per-recording values")


def _whole(record: LongRecord) -> Table:
    """Parts of a long record: how much of each was fitted, and the errors of two models in it."""
    names = list(record.blocks[0].after) if record.blocks else []
    rows = []
    for part in np.array_split(np.arange(len(record.blocks)), min(MOST_ROWS, max(len(record.blocks), 1))):
        blocks = [record.blocks[place] for place in part]
        if not blocks:
            continue
        fitted = sum(block.end - block.start for block in blocks if block.fitted)
        cells = []
        for name in names:
            unit = CHANNEL_KINDS[name].unit
            after = [block.after[name] for block in blocks if name in block.after]
            before = [block.before[name] for block in blocks if name in block.before]
            cells += [_median(before, unit), _median(after, unit), quantity(max(after), unit) if after else "-"]
        rows.append((f"{blocks[0].start:.0f} to {blocks[-1].end:.0f} s", f"{fitted:.0f} s", *cells))
    kinds = ("nominal, median", "augmented, median", "augmented, largest")
    headings = ("part", "fitted", *(f"{channel_title(name)}: {kind}" for name in names for kind in kinds))
    title = f"The whole record: RMSE with parameters held, and the state fitted every {record.window:g} s"
    return Table(headings, tuple(rows), title)


def _median(values: list[float], unit: str) -> str:
    return quantity(float(np.median(values)), unit) if values else "-"


def _prediction(tested: PredictedRecording) -> Table:
    rows = []
    for channel in tested.noise:
        unit = CHANNEL_KINDS[channel].unit
        each = [tested.prediction[model][channel] for model in MODELS]
        title = channel_title(channel)
        for seconds in each[0].ahead:
            shown = (quantity(prediction.ahead[seconds], unit) for prediction in each)
            rows.append((f"{title}, {seconds:g} s ahead", *shown, quantity(tested.noise[channel], unit)))
        shown = (quantity(prediction.free_running, unit) for prediction in each)
        rows.append((f"{title}, free-running", *shown, quantity(tested.noise[channel], unit)))
    title = f"Test on {Path(tested.path).name}, which no model was fitted to: RMSE"
    return Table(("prediction", *MODELS, "noise"), tuple(rows), title)
