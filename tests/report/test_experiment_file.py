"""The proposed test as a parameters file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import yaml

from eha_core.diagnosis.experiment.design import not_proposed
from eha_core.diagnosis.result import Diagnosis
from eha_core.report.experiment_file import experiment_file
from eha_core.report.files import write_report
from eha_core.report.stages.next_experiment import stage


def test_the_file_holds_the_reference_s_parameters_in_their_own_types(ambiguous: Diagnosis) -> None:
    assert ambiguous.next_experiment is not None
    reference = {**ambiguous.next_experiment.reference, "sine.amplitude": 2e-5, "multisine.count": 16, "lockstep": True}
    experiment = replace(ambiguous.next_experiment, reference=reference, duration=8, record=("pressure_a",))
    text = experiment_file(ambiguous, experiment)
    loaded = yaml.safe_load(text)
    assert loaded == {"eha_reference": {"ros__parameters": {**reference, "duration": 8.0}}}
    assert all(
        type(loaded["eha_reference"]["ros__parameters"][name]) is type(value) for name, value in reference.items()
    )
    assert "Record voltage_command, position, pressure_a, pressure_b." in text


def test_the_report_s_folder_has_it_while_there_is_one(
    ambiguous: Diagnosis, friction: Diagnosis, tmp_path: Path
) -> None:
    assert tmp_path / "next_experiment.yaml" in write_report(ambiguous, tmp_path)
    assert (tmp_path / "next_experiment.yaml").is_file()
    assert tmp_path / "next_experiment.yaml" not in write_report(friction, tmp_path)
    assert not (tmp_path / "next_experiment.yaml").exists()


def test_the_page_names_the_causes_in_words_and_its_commands_fit_their_lines(ambiguous: Diagnosis) -> None:
    assert ambiguous.next_experiment is not None
    statement = "Coulomb friction or Stribeck friction: a sine should tell them apart"
    experiment = replace(ambiguous.next_experiment, statement=statement)
    shown = stage(replace(ambiguous, next_experiment=experiment))
    assert shown.sentences[0] == "Coulomb friction or Stribeck friction: a sine should tell them apart."
    assert max(map(len, shown.code.splitlines())) <= 130


def test_where_no_voltage_drives_the_rig_the_report_says_why_there_is_none(
    ambiguous: Diagnosis, tmp_path: Path
) -> None:
    refusal = not_proposed([("coulomb_friction",), ("stribeck_friction",)], ("flow_a", "flow_b"), "measured_flow")
    assert refusal.separates == ("coulomb_friction", "stribeck_friction")
    assert "flow_a and flow_b of measured_flow" in refusal.statement and "\n" not in refusal.statement
    without = replace(ambiguous, next_experiment=refusal)
    assert tmp_path / "next_experiment.yaml" not in write_report(without, tmp_path)
    assert not (tmp_path / "next_experiment.yaml").exists()
    page = (tmp_path / "report.html").read_text()
    assert "No test is proposed" in page and "come from the rig and not from the reference generator" in page
