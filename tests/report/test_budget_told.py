"""A budget as a document, as a table, and as a picture."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from eha_core.error_budget import Budget, RepairStep, Share, Task
from eha_core.error_budget.rig import PARAMETERS
from eha_core.error_budget.shares import Figure
from eha_core.errors import EhaError
from eha_core.report.budget import account, document, waterfall, write_budget
from eha_core.signals import from_text


@pytest.fixture
def budget() -> Budget:
    return Budget(
        "rig",
        Task(from_text("sine:amplitude=0.01,frequency=2"), "lqr", duration=5.0),
        Figure(300e-6, 12e-6),
        Figure(40e-6),
        (
            Share("coulomb_friction", "the seals rub", Figure(200e-6, 11.4e-6), Figure(220e-6, 0.3e-6), True),
            Share(PARAMETERS, "other values of moving_mass", Figure(70e-6, 2e-6), Figure(60e-6), False),
            Share("valve_deadband", "the lands overlap", Figure(-10e-6, 1e-6), Figure(-5e-6, 1e-6), True),
        ),
        (RepairStep("coulomb_friction", Figure(80e-6, 1e-6)), RepairStep("valve_deadband", Figure(90e-6, 1e-6))),
        {(): 40e-6, ("coulomb_friction",): 250e-6},
        ("the recording cannot distinguish the effects from a or b",),
    )


def test_the_table_has_one_unit_and_the_digits_that_an_interval_deserves(budget: Budget) -> None:
    lines = account(budget).splitlines()
    assert lines[0] == (
        "rig: a sine (amplitude 10.0 mm, frequency 2.00 Hz) of position under lqr, counted from 1 s to 5 s"
    )
    rows = {line[2:32].strip(): line[32:].split("  ") for line in lines if line.startswith("  ")}
    told = {name: [cell.strip() for cell in cells if cell.strip()] for name, cells in rows.items()}
    assert "[µm]" in lines[2]
    assert told["the rig as modelled"] == ["40.0"]
    assert told["coulomb friction"] == ["200 ± 11", "220.00 ± 0.30"]
    assert told["other parameter values"] == ["70.0 ± 2.0"]
    assert told["valve deadband"] == ["-10.0 ± 1.0", "-5.0 ± 1.0"]
    assert told["today, the sum"] == ["300 ± 12"]
    assert told["1. coulomb friction"] == ["80.0 ± 1.0"]
    assert lines[-1].startswith("Note: the recording cannot distinguish")


def test_an_open_loop_is_named_so(budget: Budget) -> None:
    from dataclasses import replace

    opened = replace(budget, task=Task(from_text("sine:amplitude=8.4e-3"), ""))
    assert "amplitude 8.40 mV" in account(opened) and "open loop" in account(opened).replace("\n", " ")


def test_the_document_has_every_figure_in_metres(budget: Budget) -> None:
    made = json.loads(json.dumps(document(budget), allow_nan=False))
    assert made["schema"] == "eha.budget/1" and made["today"] == {"value": 300e-6, "reach": 12e-6}
    assert made["modelled"]["value"] + sum(row["share"]["value"] for row in made["shares"]) == pytest.approx(300e-6)
    assert made["repaired"]["value"] == 90e-6 and made["task"]["controller"] == "lqr"
    assert made["subsets"][1] == {"departures": ["coulomb_friction"], "rmse": 250e-6}


def test_the_waterfall_leads_from_today_over_each_repair_to_the_rig_as_modelled(budget: Budget) -> None:
    upper, lower = waterfall(budget).axes
    bars = {label.get_text(): bar for label, bar in zip(upper.get_yticklabels(), upper.patches, strict=True)}
    ends = {name: sorted((bar.get_x(), bar.get_x() + bar.get_width())) for name, bar in bars.items()}
    assert ends["today"] == pytest.approx([0.0, 300.0])
    assert ends["coulomb friction repaired"] == pytest.approx([80.0, 300.0])
    assert ends["valve deadband repaired"] == pytest.approx([80.0, 90.0])
    assert ends["the rig repaired"] == pytest.approx([0.0, 90.0])
    assert ends["other parameter values"] == pytest.approx([40.0, 90.0])
    assert ends["the rig as modelled"] == pytest.approx([0.0, 40.0])
    assert len(lower.patches) == 5  # three shares, and the gains of two repairs


def test_files_are_written_or_the_folder_is_named(budget: Budget, tmp_path: Path) -> None:
    document_path, picture = write_budget(budget, tmp_path / "new")
    assert json.loads(document_path.read_text())["source"] == "rig"
    assert np.ptp(imread(picture)[:, :, :3]) > 0.5
    (tmp_path / "file").write_text("")
    with pytest.raises(EhaError, match="file.*cannot be written.*choose another --out"):
        write_budget(budget, tmp_path / "file")
