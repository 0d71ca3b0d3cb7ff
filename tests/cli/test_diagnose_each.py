"""Many recordings, each on its own: a line for each, an unusable one stops none, on processes and on Dask's workers."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from eha_core.cli import main

BAGS = Path(__file__).parents[2] / "bags"
MULTISINE = "multisine:amplitude=0.12,lowest=0.3,highest=8,count=16,period=20,seed=3"


@pytest.fixture(scope="module")
def as_modelled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three seconds of a rig that lacks nothing."""
    path = tmp_path_factory.mktemp("bags") / "as_modelled.mcap"
    words = ["--command", MULTISINE, "--duration", "3", "--noise", "1", "--seed", "11", "--instruments-only"]
    assert main(["simulate", *words, "--out", str(path)]) == 0
    return path


def test_an_unusable_recording_stops_none_of_the_others(
    as_modelled: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    paths = [as_modelled, tmp_path / "absent.csv", BAGS / "rig_cut_short.mcap"]
    assert main(["diagnose", "--each", *map(str, paths), "--out", str(tmp_path / "out")]) == 2
    out, err = capfd.readouterr()
    assert sorted(line.split(":")[0] for line in out.splitlines()) == ["as_modelled.mcap", "rig_cut_short.mcap"]
    assert "dry friction" in out
    # a worker that has to compile the plant says so, too
    [refusal] = [line for line in err.splitlines() if "compiling the plant" not in line]
    assert re.fullmatch(r"absent.csv: .*absent.csv.*", refusal)
    written = (tmp_path / "out").glob("*/diagnosis.json")
    verdicts = {path.parent.name: json.loads(path.read_text())["verdict"] for path in written}
    assert verdicts == {"as_modelled": "consistent", "rig_cut_short": "missing_physics"}


@pytest.mark.parametrize("words", [[], ["--each"]])
def test_the_report_can_be_left_out(as_modelled: Path, tmp_path: Path, words: list[str]) -> None:
    folder = tmp_path / "out"
    assert main(["diagnose", *words, "--no-report", str(as_modelled), "--out", str(folder)]) == 0
    written = [one for one in folder.rglob("*") if one.is_file()]
    assert written == [(folder / "as_modelled" if words else folder) / "diagnosis.json"]


def test_the_workers_of_a_dask_scheduler_do_the_same(
    as_modelled: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    dask = [sys.executable, "-m", "dask"]
    file = tmp_path / "scheduler.json"
    common = ["--scheduler-file", str(file), "--no-dashboard"]
    quiet = {"stderr": subprocess.DEVNULL, "cwd": tmp_path}
    scheduler = subprocess.Popen([*dask, "scheduler", *common, "--host", "127.0.0.1", "--port", "0"], **quiet)
    worker = subprocess.Popen([*dask, "worker", *common, "--nworkers", "1", "--nthreads", "1"], **quiet)
    try:
        while not (file.is_file() and file.read_text()):  # it is made before it is written
            assert scheduler.poll() is None
        address = json.loads(file.read_text())["address"]
        words = ["--each", str(as_modelled), "--out", str(tmp_path / "out"), "--dask", address]
        assert main(["diagnose", *words]) == 0
    finally:
        for process in (worker, scheduler):
            process.terminate()
            process.wait(30)
    assert capfd.readouterr().out.startswith("as_modelled.mcap: The nominal model explains")
    assert (tmp_path / "out" / "as_modelled" / "report.html").is_file()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--dask", "tcp://127.0.0.1:9"], "give --each too"),
        (["--each", "--json", "-"], "--json takes one diagnosis"),
        ([str(BAGS / "rig_as_modelled.mcap"), "--each"], "two recordings would both write to"),
        (["--each", "--test", str(BAGS / "rig_cut_short.mcap")], "--test needs one model"),
        (["--each", "--dask", "tcp://127.0.0.1:9"], "no scheduler answers there"),
    ],
)
def test_what_does_not_go_together_is_said_in_one_line(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["diagnose", str(BAGS / "rig_as_modelled.mcap"), *words, "--out", str(tmp_path)]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert err.count("\n") == 1
