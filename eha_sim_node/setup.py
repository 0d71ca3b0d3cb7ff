"""Installs the nodes as an ament_python package, by colcon and by pip alike."""

from pathlib import Path

from setuptools import setup

NAME = "eha_sim_node"


def files(folder: str) -> list[str]:
    """Return the YAML files of a folder beside this file, as paths relative to it."""
    return sorted(path.as_posix() for path in Path(folder).glob("*.yaml"))


setup(
    name=NAME,
    version="0.2.0",
    description="Nodes of the electro-hydraulic actuator simulator",
    license="Apache-2.0",
    author="EHA simulator maintainers",
    author_email="maintainers@eha-sim.example",
    url="https://eha-sim.example",
    packages=[NAME, f"{NAME}.live"],
    package_data={NAME: ["py.typed"], f"{NAME}.live": ["page.html"]},
    package_dir={"": "."},  # so that an editable install wins over this folder when Python starts beside it
    python_requires=">=3.10",
    install_requires=["eha_core"],
    extras_require={"test": ["pytest", "pytest-timeout"]},  # by these colcon knows that pytest runs the tests
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/launch", files("launch")),
        (f"share/{NAME}/config", files("config")),
    ],
    entry_points={
        "console_scripts": [
            "sim = eha_sim_node.sim:main",
            "reference = eha_sim_node.reference:main",
            "monitor = eha_sim_node.monitor:main",
            "twin = eha_sim_node.twin:main",
            "controller = eha_sim_node.controller:main",
            "live_page = eha_sim_node.live_page:main",
            "investigate = eha_sim_node.investigate:main",
        ]
    },
)
