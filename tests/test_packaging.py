"""One set of versions: the pins fit the package's bounds, and those for ROS are the same but for what numpy asks."""

from __future__ import annotations

import configparser
import json
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml
from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
from tools.make_env import PYTHONS  # noqa: E402 - a tool, which no package holds

OF_ANOTHER_NUMPY = {"pysindy", "scikit-learn"}


def pins(name: str) -> dict[str, str]:
    lines = (ROOT / "requirements" / name).read_text().splitlines()
    rows = [line.partition("#")[0].strip() for line in lines]
    return dict(row.split("==") for row in rows if row)


def bounds(package: str) -> dict[str, Requirement]:
    """What a package needs; the exam with its extra, which the environment has too."""
    settings = configparser.ConfigParser()
    settings.read(ROOT / package / "setup.cfg")
    rows = settings["options"]["install_requires"].split("\n")
    rows += settings["options.extras_require"].get("peers", "").split("\n")
    return {one.name: one for one in map(Requirement, filter(None, rows))}


def test_ros_machines_have_the_same_versions() -> None:
    runtime, ros = pins("runtime.txt"), pins("ros2.txt")
    assert {name for name in ros.keys() & runtime.keys() if ros[name] != runtime[name]} == OF_ANOTHER_NUMPY


def test_the_packages_allow_what_is_tested_and_nothing_older() -> None:
    runtime, ros = pins("runtime.txt"), pins("ros2.txt")
    library, exam = bounds("eha_core"), bounds("eha_exam")
    assert set(library | exam) == set(runtime) - {"cyclonedds"}  # which is rclpy_dds's
    for name, bound in (*library.items(), *exam.items()):
        assert bound.specifier.contains(runtime[name])
        if name in ros:
            assert [one.version for one in bound.specifier] == [ros[name]], name


def test_the_library_does_not_bring_what_the_exam_alone_uses() -> None:
    assert {"scikit-sundae", "scikit-learn"} <= set(bounds("eha_exam")) - set(bounds("eha_core"))


def test_what_is_optional_allows_what_is_tested() -> None:
    settings = configparser.ConfigParser()
    settings.read(ROOT / "eha_core" / "setup.cfg")
    extras = {name: rows.split("\n") for name, rows in settings["options.extras_require"].items()}
    optional = {name: [Requirement(row) for row in rows if row] for name, rows in extras.items()}
    develop = pins("develop.txt")
    assert {name: {one.name for one in ones} for name, ones in optional.items()} == {
        "files": {"h5py", "pyarrow", "openpyxl", "npTDMS", "asammdf"},
        "page": {"starlette", "uvicorn"},
        "export": {"ziglang"},
        "mujoco": {"mujoco"},
    }
    assert all(one.specifier.contains(develop[one.name]) for ones in optional.values() for one in ones)


def test_the_container_makes_the_environment() -> None:
    settings = json.loads((ROOT / ".devcontainer" / "devcontainer.json").read_text())
    assert settings["postCreateCommand"].startswith("make ")


def test_continuous_integration_runs_every_python_by_the_makefile() -> None:
    jobs = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text())["jobs"]
    assert jobs["test"]["strategy"]["matrix"]["python"] == [f"{major}.{minor}" for major, minor in PYTHONS]
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    commands = [step["run"].split() for job in jobs.values() for step in job["steps"] if "run" in step]
    assert commands
    for words in commands:
        assert words[0] == "make"
        assert {word for word in words[1:] if "=" not in word} <= targets, words


@pytest.mark.parametrize("name", ["eha_core", "eha_exam", "eha_sim_node", "rclpy_dds"])
def test_python_packages_are_marked_as_typed(name: str) -> None:
    assert (ROOT / name / name / "py.typed").is_file()  # that wheels carry it is seen by `make wheels`


@pytest.mark.parametrize("path", sorted(ROOT.glob("*/package.xml")), ids=lambda path: path.parent.name)
def test_ros_packages_say_what_a_release_asks_for(path: Path) -> None:
    package = ElementTree.parse(path).getroot()
    for tag in ("description", "license", "author", "maintainer", "export/build_type"):
        assert package.findtext(tag), tag
    assert package.find("maintainer").get("email")
    assert {url.get("type") for url in package.findall("url")} == {"website", "repository", "bugtracker"}
    assert (path.parent / "CHANGELOG.rst").read_text().splitlines()[1].endswith(package.findtext("name"))


def test_help_is_printed_and_makes_no_environment(tmp_path: Path) -> None:
    command = [sys.executable, ROOT / "tools" / "make_env.py"]
    for option, status in (("--help", 0), ("-h", 0), ("--fresh", 2)):
        done = subprocess.run([*command, option], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == status and "usage: python3 tools/make_env.py FOLDER" in done.stdout + done.stderr
    assert not list(tmp_path.iterdir())
