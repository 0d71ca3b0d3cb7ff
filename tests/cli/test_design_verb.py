"""`eha detect --for`: the files that it writes, and that the reference node takes its parameters file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from matplotlib.image import imread

from eha_core.cli import main
from eha_core.signals import make_signal
from eha_sim_node.reference import NAME, OWN_ROWS, chosen_signal, signal_rows

QUICK = ["--for", "internal_leakage,coulomb_friction", "--duration", "3"]


def test_from_effects_and_limits_to_a_test_that_the_reference_node_plays(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    limits, out = tmp_path / "limits.yaml", tmp_path / "out"
    limits.write_text("position: 0.03\nspeed: 0.15\n")
    assert main(["detect", *QUICK, "--within", str(limits), "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "designed test" in printed and "position, 30.0 mm" in printed and "test.yaml" in printed
    made = json.loads((out / "design.json").read_text())
    assert made["schema"] == "eha.design/1" and made["limits"]["energy"] is None
    assert max(made["reached"]["most"].values()) <= 1.0
    height, width, _ = imread(out / "design.png").shape
    assert height > 500 and width > 900

    # the node's own rows convert each value, and make the signal that was designed
    (given,) = (section["ros__parameters"] for name, section in yaml.safe_load((out / "test.yaml").read_text()).items()
                if name == NAME)  # fmt: skip
    rows = {row.name: row for row in (*OWN_ROWS, *signal_rows())}
    values = {name: row.default for name, row in rows.items()} | {n: rows[n].convert(v) for n, v in given.items()}
    assert values["duration"] == 3.0 and values["mode"] == "voltage" and values["rate"] == 500.0
    times, prefix = np.arange(1500) / 500.0, f"{values['signal']}."
    own = {name.removeprefix(prefix): value for name, value in made["reference"].items() if name.startswith(prefix)}
    volts = chosen_signal(values).value(times)
    assert np.ptp(volts) > 0.0 and np.array_equal(volts, make_signal(values["signal"], own).value(times))


@pytest.mark.parametrize(
    "words, told",
    [
        ([], "give --command, or the effects of a designed test with --for"),
        (["--command", "sine", "--within", "limits.yaml"], "--"),
        (["--for", ",", "--duration", "3"], "no effect is named"),
        ([*QUICK, "--within", "nowhere.yaml"], "limits file nowhere.yaml: cannot be read"),
    ],
)
def test_what_cannot_be_designed_is_one_line(
    words: list[str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["detect", *words, "--out", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1
