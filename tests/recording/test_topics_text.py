"""The topics file that is written: one line for each entry and each answer, whatever columns are called."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from inspections import a_column, a_time

from eha_core.errors import RecordingError
from eha_core.recording.inspection import Field, Inspection
from eha_core.recording.suggestions import suggest
from eha_core.recording.topics_text import topics_text, write_topics


def text_of(*fields: Field) -> str:
    inspection = Inspection(Path("my run.csv"), "csv", (a_time(), *fields), {}, ())
    return topics_text(inspection, suggest(inspection))


NAMES = ["way of the piston " * 6 + "[mm]", 'way "a": {b} [mm]', "way\nnext [mm]", "way \u00e4"]
"""Names that need quotes, and break where lines are folded."""


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_on_one_line_and_reads_back(name: str) -> None:
    *_, last = lines = text_of(a_column(name, 0.0, 80.0, "kg"), a_column("laser", 0.0, 7.0, "mm")).splitlines()
    assert len(lines) == 5 and last.startswith("# not taken for a channel: ")
    assert yaml.safe_load(last.partition(": ")[2]) == name
    (entry,) = [line for line in text_of(a_column(f"{name}.weg", 0.0, 8.0, "mm")).splitlines() if "position" in line]
    assert yaml.safe_load(entry) == {"position": {"column": f"{name}.weg", "unit": "mm"}}


def test_what_is_certain_is_an_entry_what_is_open_a_comment_and_the_rest_is_named() -> None:
    fields = [
        a_column("weg", 0.0, 80.0, "mm"), a_column("p_head", 1.0, 60.0, "bar"), a_column("beam", 0.0, 3.0, "kg"),
        a_column("signal 7", 0.0, 3.0),
    ]  # fmt: skip
    assert text_of(*fields).splitlines() == [
        '# Channels of "my run.csv", as `eha inspect` found them.',
        "# Where it says `ask`, put the right one of the answers in place of `{question: ..., ask: ...}`;",
        "# a null inside an answer is a number to fill in, an answer `null` means that there is no such channel.",
        "channels:",
        '  time: {column: "time", unit: s}',
        '  pressure_a: {column: "p_head", unit: bar, reference: gauge, assumed: "gauge, for want of a word on it"}',
        '  position: {column: "weg", unit: mm}',
        "  voltage_command:",
        '    question: "which number is voltage_command, if any?"',
        "    ask:",
        '      - {column: "signal 7", unit: V}  # it goes from 0 to 3',
        '      - {column: "signal 7", unit: mV}  # it goes from 0 to 3',
        "      - null",
        "  pressure_b:",
        '    question: "which number is pressure_b, if any?"',
        "    ask:",
        '      - {column: "signal 7", unit: bar, reference: gauge}  # it goes from 0 to 3',
        '      - {column: "signal 7", unit: MPa, reference: gauge}  # it goes from 0 to 3',
        "      - null",
        '# not taken for a channel: "beam"',
    ]


def test_a_topic_s_field_is_named_with_its_topic() -> None:
    fields = (
        Field("/cyl/weg", "data", 9, 0.0, 80.0, 500.0, "mm"),
        Field("/cyl/beam", "data", 9, 0.0, 80.0, 500.0, "kg"),
    )
    inspection = Inspection(Path("bag"), "bag", fields, {"/cyl/weg": "x", "/cyl/beam": "x"}, ())
    assert topics_text(inspection, suggest(inspection)).splitlines()[1:] == [
        "channels:",
        '  position: {topic: "/cyl/weg", field: "data", unit: mm}',
        '# not taken for a channel: "/cyl/beam data"',
    ]


def test_a_file_that_is_there_or_cannot_be_written_is_refused(tmp_path: Path) -> None:
    write_topics(tmp_path / "topics.yaml", "channels: {}  # \u00e4\n")
    assert (tmp_path / "topics.yaml").read_text(encoding="utf-8") == "channels: {}  # \u00e4\n"
    with pytest.raises(RecordingError, match="exists already; choose another name"):
        write_topics(tmp_path / "topics.yaml", "")
    with pytest.raises(RecordingError, match="cannot be written"):
        write_topics(tmp_path / "none" / "topics.yaml", "")
