"""Installs the message definitions where there is no ROS 2 to build them; colcon uses CMakeLists.txt instead."""

from pathlib import Path

from setuptools import setup

NAME = "eha_interfaces"
MARKER = Path("build/resource") / NAME

# CMake writes the ament index's empty marker itself, so the source tree holds none to install.
MARKER.parent.mkdir(parents=True, exist_ok=True)
MARKER.touch()


def definitions(kind: str) -> list[str]:
    """Return the definition files of one kind, "msg" or "srv", relative to this file."""
    return sorted(path.as_posix() for path in Path(kind).glob(f"*.{kind}"))


setup(
    name=NAME,
    version="0.2.0",
    description="Messages and services of the electro-hydraulic actuator simulator",
    license="Apache-2.0",
    author="EHA simulator maintainers",
    author_email="maintainers@eha-sim.example",
    url="https://eha-sim.example",
    packages=[],
    data_files=[
        ("share/ament_index/resource_index/packages", [MARKER.as_posix()]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/msg", definitions("msg")),
        (f"share/{NAME}/srv", definitions("srv")),
    ],
)
