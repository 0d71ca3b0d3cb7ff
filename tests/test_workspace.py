"""The colcon workspace leads to the ROS packages; were its links plain files, colcon would find and build nothing."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parent.parent


def test_the_workspace_holds_every_ros_package() -> None:
    packages = {path.parent for path in ROOT.glob("*/package.xml")}
    assert len(packages) == 5
    assert {link.resolve() for link in (ROOT / "ros2_ws" / "src").iterdir()} == packages
    for package in packages:
        assert ElementTree.parse(package / "package.xml").findtext("name") == package.name
