"""The page and the figures."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread

import eha_core
from eha_core.diagnosis.result import Diagnosis, Pictures, ProbableSet
from eha_core.quantities import quantity
from eha_core.report.document import as_json
from eha_core.report.figures import write_figures
from eha_core.report.first_screen import law_panel, law_picture, pictures
from eha_core.report.html import page
from eha_core.report.laws.law import Axis, Law
from eha_core.report.picture import LONGEST_LINE, Bars, Line, Upright
from eha_core.report.provenance import with_provenance
from eha_core.report.rivals_picture import evidence_picture
from eha_core.report.stages import report_stages
from eha_core.report.wording import words

ORDER = ["read", "calibrate", "locate", "name", "model", "show", "next"]


class _Reader(HTMLParser):
    """Gathers text, section ids and addresses, and sees that tags close."""

    VOID = ("meta", "br", "link", "img")

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.sections: list[str] = []
        self.addresses: list[str] = []
        self.words: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        found = dict(attributes)
        if tag == "section":
            self.sections.append(found["id"] or "")
        self.addresses += [value for name, value in attributes if name in ("src", "href") and value]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if not {"script", "style"} & set(self.open):
            self.words.append(data)


def _read(text: str) -> _Reader:
    reader = _Reader()
    reader.feed(text)
    assert reader.open == []
    return reader


def test_the_report_says_how_probable_each_name_and_each_set_is(friction: Diagnosis) -> None:
    (effect,) = friction.effects
    sets = (ProbableSet((effect.id,), 0.58), ProbableSet((effect.id, "constant_load"), 0.41))
    found = replace(friction, effects=(replace(effect, probability=0.994),), sets=sets)
    stages = {stage.name: stage for stage in report_stages(found)}
    (table,) = stages["name"].tables
    assert [row[1] for row in table.rows] == ["58 %", "41 %"]
    assert "constant load" in table.rows[1][0]
    assert any("over 99 % probable" in text for text in stages["model"].parts[0].sentences)


def test_tells_the_story_in_order_and_needs_nothing_else(any_diagnosis: Diagnosis) -> None:
    text = page(any_diagnosis)
    reader = _read(text)
    assert reader.sections == ORDER
    beside = {"fitted.yaml", "comparison.mcap", "diagnosis.json"}
    beside |= {"next_experiment.yaml"} if any_diagnosis.next_experiment else set()
    assert {one for one in reader.addresses if not one.startswith("#")} == beside
    assert len(text) < 8e6
    assert "a rig & its <friction>.mcap" in "".join(reader.words)
    assert text.count("plotly.js v") <= 2  # the library stands there once


def test_a_long_recording_makes_no_larger_page(friction: Diagnosis) -> None:
    pictures, times = friction.pictures, 100

    def longer(series: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        return {name: np.tile(values, times) for name, values in series.items()}

    time = {name: np.arange(times * len(one)) * (one[1] - one[0]) for name, one in pictures.time.items()}
    states = {**longer(pictures.variables), "time": time["position"]}
    models = (longer(one) for one in (pictures.measured, pictures.before, pictures.calibrated, pictures.after))
    spans = tuple((float(start), start + 1.0) for start in range(1, 600, 3))
    long = replace(friction, duration=600.0, pictures=Pictures(time, *models, states, pictures.equations, spans))
    assert len(page(long)) < 8e6


def test_every_plot_is_data_that_parses(friction: Diagnosis) -> None:
    plots = re.findall(r'<script type="application/json">(.*?)</script>', page(friction), re.DOTALL)
    assert len(plots) > 10
    for plot in plots:
        drawn = json.loads(plot)
        assert drawn["data"]
        assert drawn["layout"]["height"] > 0


def test_the_ladder_has_every_rung_its_distance_and_the_model_that_adds_nothing(friction: Diagnosis) -> None:
    (picture,) = {one.name: one for one in report_stages(friction)}["name"].pictures
    panel = picture.groups[0].panels[0]
    assert panel.names == (
        "Coulomb friction", "Stribeck friction", "nothing added (recalibrated model)", "end stop",
    )  # fmt: skip
    (bars,) = (mark for mark in panel.marks if isinstance(mark, Bars))
    assert bars.texts == ("best", "31 behind", "5,321 behind", "5,333 behind")
    (threshold,) = (mark for mark in panel.marks if isinstance(mark, Upright))
    assert bars.x[0] < threshold.x < bars.x[1]  # 31 are distinguished
    assert "turbulent leakage" in picture.caption


def test_where_it_comes_from_stands_on_the_page_and_in_json(friction: Diagnosis, tmp_path: Path) -> None:
    file = tmp_path / "rig.csv"
    file.write_bytes(b"time,position\n0,1\n")
    recording = SimpleNamespace(path=file)
    shown = with_provenance(friction, [recording], "nominal.yaml", "eha diagnose rig.csv")
    assert shown.provenance["recording_sha256"] == hashlib.sha256(file.read_bytes()).hexdigest()
    text = page(shown)
    for value in (*shown.provenance.values(), eha_core.__version__):
        assert value in text
    assert json.loads(as_json(shown))["provenance"] == dict(shown.provenance)
    recording = SimpleNamespace(path=tmp_path / "absent")
    assert with_provenance(friction, [recording]).provenance["recording_sha256"] == "-"


def test_numbers_on_the_page_are_those_of_the_diagnosis(friction: Diagnosis) -> None:
    words = " ".join("".join(_read(page(friction)).words).split())
    assert "200.4 ± 1.3 N" in words
    assert "10.946 ± 0.035 kg" in words
    assert quantity(friction.held_out["position"].rmse_after, "m") in words


@pytest.mark.parametrize(
    ("kind", "stage", "headline"),
    [
        ("friction", "name", "The evidence points to Coulomb friction"),
        ("friction", "show", "The residual is noise"),
        ("friction", "next", "No further experiment is needed"),
        ("ambiguous", "name", "The best explanation is Coulomb friction, but it is not the only one"),
        ("ambiguous", "next", "One more test would distinguish Coulomb friction from Stribeck friction"),
        ("unknown", "name", "Nothing in the catalogue explains it"),
        ("unknown", "model", "A law over velocity is missing"),
        ("consistent", "locate", "No equation is violated"),
        ("consistent", "model", "The model stands as it was given"),
    ],
)
def test_headlines(kind: str, stage: str, headline: str, request: pytest.FixtureRequest) -> None:
    found = {one.name: one for one in report_stages(request.getfixturevalue(kind))}
    assert found[stage].headline == headline


def test_axes_of_one_unit_have_one_scale() -> None:
    amperes = np.array([-1.2e-3, 0.0, 1.2e-3])
    overlap = np.sign(amperes) * np.maximum(np.abs(amperes) - 3e-4, 0.0)
    law = Law("Valve deadband", Axis("spool position", "A"), Axis("Opening", "A"), amperes, overlap, overlap, overlap)
    panel = law_panel(law)
    assert (panel.x_label, panel.y_label) == ("spool position [mA]", "Opening [mA]")
    (line,) = (mark for mark in panel.marks if isinstance(mark, Line))
    assert np.allclose([*line.x, *line.y], [-1.2, 0.0, 1.2, -0.9, 0.0, 0.9])


def test_points_are_explained_where_there_are_some() -> None:
    x = np.array([-0.1, 0.1])
    law = Law("Constant load", Axis("velocity", "m/s"), Axis("Force", "N"), x, x, x, x)
    diagnosis: Any = None  # not asked, where its laws are given
    for one, shown in ((law, False), (replace(law, points_x=x, points_y=x), True)):
        picture = law_picture(diagnosis, {"constant_load": one})
        assert picture is not None
        assert ("Points:" in picture.caption) == shown


def test_a_per_cent_sign_stands_apart_from_its_number(friction: Diagnosis) -> None:
    words = "".join(_read(page(friction)).words)
    assert "93\N{NO-BREAK SPACE}% of the recalibrated model's unexplained error is in the force balance" in words
    assert not re.search(r"\d%", words)


def test_parameters_that_are_hardly_told_are_as_many_as_the_sentence_says(friction: Diagnosis) -> None:
    def said(*names: str) -> str:
        shown = tuple(replace(one, note="held" if one.name in names else "") for one in friction.parameters)
        stage = {one.name: one for one in report_stages(replace(friction, parameters=shown))}["calibrate"]
        return " ".join(stage.sentences)

    first, second = (one.name for one in friction.parameters[:2])
    assert f"{words(first)}; it stays near its nominal value." in said(first)
    assert f"{words(second)}; they stay near their nominal values." in said(first, second)
    assert "says little" not in said()


def test_without_added_physics_no_model_is_called_augmented(consistent: Diagnosis) -> None:
    text = "".join(_read(page(consistent)).words)
    assert "recalibrated / noise" in text
    assert "augmented" not in text.replace("augmented model and residuals", "")


def test_hypotheses_whose_fits_stopped_short_are_said_to_have(friction: Diagnosis) -> None:
    def caption(score: float) -> str:
        return evidence_picture(replace(friction, rivals=(*friction.rivals, (("end_stop",), score)))).caption

    assert "dropped before its fit had converged" in caption(-4.6e6)
    assert "left before" not in caption(-12.0)  # what parameters cost


def test_a_hypothesis_that_differs_in_many_effects_is_drawn_with_its_label_on_several_lines(
    friction: Diagnosis, tmp_path: Path
) -> None:
    others = ("position_sensor_lag", "pressure_sensor_lag", "stribeck_friction", "turbulent_leakage", "valve_deadband")
    named = tuple(effect.id for effect in friction.effects)
    rivals = (*friction.rivals, ((*named, *others), -20.0), ((*named, "valve_null_leakage", *others), -30.0))
    picture = evidence_picture(replace(friction, rivals=rivals))
    (panel,) = picture.groups[0].panels
    lines = [line for label in panel.row_labels for line in label]
    assert max(map(len, lines)) <= LONGEST_LINE and max(map(len, panel.row_labels)) > 2
    write_figures([picture], tmp_path)
    height, width = imread(tmp_path / "4-name.png").shape[:2]
    shown = evidence_picture(friction).groups[0].panels[0]
    assert panel.height / len(panel.row_labels) > shown.height / len(shown.row_labels)
    assert width > height


def test_where_nothing_is_named_no_hypothesis_has_the_colour_of_a_name(unknown: Diagnosis, friction: Diagnosis) -> None:
    def shown(diagnosis: Diagnosis) -> tuple[set[str], str]:
        picture = evidence_picture(diagnosis)
        (bars,) = (mark for mark in picture.groups[0].panels[0].marks if isinstance(mark, Bars))
        return set(bars.roles), picture.caption

    scored = replace(unknown, rivals=((("quadratic_damping",), 2e4), (("coulomb_friction",), 1e4)))
    roles, caption = shown(scored)
    assert roles == {"other"}
    assert "None of these explains enough" in caption and "what was named" not in caption
    roles, caption = shown(friction)
    assert "after" in roles and "what was named" in caption


def test_an_unknown_law_is_drawn_and_written(unknown: Diagnosis) -> None:
    stage = {one.name: one for one in report_stages(unknown)}["model"]
    assert stage.code == "250 tanh(20 v)"
    assert "the simulation does not include it" in " ".join(stage.sentences)
    assert "may have biased" in " ".join({one.name: one for one in report_stages(unknown)}["calibrate"].sentences)
    assert unknown.unknown is not None
    product = replace(unknown.unknown, function_of="position, times velocity")
    simulated = replace(unknown, unknown=product, fitted_values={"recovered_force.knot_00": 3.0})
    stage = {one.name: one for one in report_stages(simulated)}["model"]
    assert "without it" not in " ".join(stage.sentences)
    picture = law_picture(simulated)
    assert picture is not None
    panel = picture.groups[0].panels[0]
    assert (panel.x_label, panel.y_label) == ("position [mm]", "Force on the piston by its velocity [N s/m]")


def test_the_proposed_test_is_drawn_with_the_commands_that_run_it(ambiguous: Diagnosis) -> None:
    stage = report_stages(ambiguous)[-1]
    line = stage.pictures[0].groups[0].panels[0].marks[0]
    assert np.allclose(line.y, 20.0 * np.sin(2 * np.pi * 3.0 * line.x), atol=0.05)  # mV
    assert "ros2 launch eha_sim_node next_experiment.launch.yaml file:=next_experiment.yaml" in stage.code
    assert "It lasts 10 s; record voltage command, position, pressure of" in " ".join(stage.sentences)


def test_every_stage_with_something_to_see_has_a_figure(friction: Diagnosis, tmp_path: Path) -> None:
    drawn = [*pictures(friction), *(picture for stage in report_stages(friction) for picture in stage.pictures)]
    written = write_figures(drawn, tmp_path / "figures")
    assert {path.name[0] for path in written} == set("0123456")
    assert len({path.name for path in written}) == len(drawn)
    for path in written:
        pixels = imread(path)
        assert pixels.shape[1] > 800
        assert pixels[..., :3].std() > 0.01  # not blank
