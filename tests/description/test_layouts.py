"""The layouts for Foxglove and PlotJuggler: what they plot is in a recording, or in a message that we publish."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from mcap.reader import make_reader
from rosbags.typesys import get_types_from_msg

ROOT = Path(__file__).resolve().parents[2]
LAYOUTS = ROOT / "eha_description" / "layouts"
RECORDING = ROOT / "bags" / "paper_leakage_levels.mcap"


def recorded_fields() -> dict[str, dict[str, str]]:
    """Fields of each topic's message with their types, from the definitions that the recording carries itself."""
    with RECORDING.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    found = {}
    for channel in summary.channels.values():
        schema = summary.schemas[channel.schema_id]
        head = re.split(r"=+\nMSG: ", schema.data.decode())[0]
        found[channel.topic] = _fields(head, schema.name)
    joint_state = found["/joint_states"]
    error = (ROOT / "eha_interfaces" / "msg" / "TrackingError.msg").read_text()
    return {**found, "/reference": joint_state, "/tracking_error": _fields(error, "eha_interfaces/msg/TrackingError")}


def _fields(text: str, name: str) -> dict[str, str]:
    (_, (_, fields)) = next(iter(get_types_from_msg(text, name).items()))
    return {field: str(kind) for field, kind in fields}


def plotted_by_foxglove() -> list[str]:
    document = json.loads((LAYOUTS / "foxglove.json").read_text())
    panels = [config for name, config in document["configById"].items() if name.startswith("Plot!")]
    return [path["value"] for panel in panels for path in panel["paths"]]


def plotted_by_plotjuggler() -> list[str]:
    root = ElementTree.parse(LAYOUTS / "plotjuggler.xml").getroot()
    return [str(curve.get("name")) for curve in root.iter("curve")]


@pytest.mark.parametrize("path", plotted_by_foxglove())
def test_what_foxglove_plots_is_published(path: str) -> None:
    topic, field, index = re.fullmatch(r"(/[a-z_/]+)\.([a-z_]+)(\[0\])?", path).groups()
    fields = recorded_fields()[topic]
    assert field in fields and ("SEQUENCE" in fields[field].upper()) == bool(index)


@pytest.mark.parametrize("name", plotted_by_plotjuggler())
def test_what_plotjuggler_plots_is_published(name: str) -> None:
    topic, _, field = name.rpartition("/")
    assert field in recorded_fields()[topic]


def test_every_panel_of_foxglove_has_its_place() -> None:
    document = json.loads((LAYOUTS / "foxglove.json").read_text())

    def panels(node) -> list[str]:
        return [node] if isinstance(node, str) else panels(node["first"]) + panels(node["second"])

    assert sorted(panels(document["layout"])) == sorted(document["configById"])
    urdf = document["configById"]["3D!rig"]["layers"]["urdf"]
    assert (urdf["sourceType"], urdf["topic"]) == ("topic", "/robot_description")
