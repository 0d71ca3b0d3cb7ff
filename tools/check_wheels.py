"""Builds wheels of library, messages and `rclpy_dds`, installs them into a clean environment, and uses them there.

    python tools/check_wheels.py FOLDER

Leaves the wheels in FOLDER. The environment holds the wheels and the pins of requirements/runtime.txt, and nothing of
this checkout; what runs there runs outside of it.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("eha_core", "eha_interfaces", "rclpy_dds")
LINES = """
import eha_core as eha
frame = eha.simulate("multisine:amplitude=0.12,seed=5", 4.0, {"coulomb_friction.force": 250.0}, noise=1.0).to_dict()
found = eha.diagnose(eha.Recording.from_arrays(**frame, pressures="gauge"))
print(found.summary())
assert [effect.id for effect in found.effects] == ["coulomb_friction"], found.effects
assert "site-packages" in eha.__file__, eha.__file__
found.save("report")
"""
"""What a user does first: arrays in, a diagnosis and its report out."""


def main() -> int:
    """Build, install, use; the exit status says whether it worked."""
    if len(sys.argv) != 2:
        print("usage: python tools/check_wheels.py FOLDER", file=sys.stderr)
        return 2
    folder = Path(sys.argv[1]).absolute()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    wheels = build(folder)
    check_contents(wheels)
    python = install(folder / "environment", wheels)
    use(python, folder / "elsewhere")
    print(f"wheels: {', '.join(wheel.name for wheel in wheels)} install and work")
    return 0


def build(folder: Path) -> list[Path]:
    """Make the wheels from copies of the packages, so that no build leaves files in the checkout."""
    sources = []
    for name in PACKAGES:
        copy = folder / "sources" / name
        ignored = shutil.ignore_patterns("*.egg-info", "build", "__pycache__")
        sources.append(shutil.copytree(ROOT / name, copy, ignore=ignored))
        shutil.copy(ROOT / "LICENSE", copy)
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*command, "--wheel-dir", folder, *sources], check=True)
    shutil.rmtree(folder / "sources")
    return sorted(folder.glob("*.whl"))


def check_contents(wheels: list[Path]) -> None:
    """Every wheel carries the licence, and one with Python code the mark that says it is typed."""
    for wheel in wheels:
        names = zipfile.ZipFile(wheel).namelist()
        wanted = ["LICENSE"] + ["py.typed"] * any(name.endswith(".py") for name in names)
        if lacking := [file for file in wanted if not any(name.endswith(f"/{file}") for name in names)]:
            raise SystemExit(f"{wheel.name} lacks {' and '.join(lacking)}")


def install(folder: Path, wheels: list[Path]) -> Path:
    """A clean environment with the wheels, at the versions that the project is tested with; returns its Python."""
    venv.create(folder, with_pip=False, symlinks=True)
    python = folder / "bin" / "python"
    pins = ROOT / "requirements" / "runtime.txt"
    # this environment's pip installs into that one, which has none of its own
    pip = [sys.executable, "-m", "pip", "--python", str(python)]
    subprocess.run([*pip, "install", "--quiet", "--constraint", str(pins), *map(str, wheels)], check=True)
    return python


def use(python: Path, folder: Path) -> None:
    """Run what a user would, in a folder that knows nothing of the checkout."""
    folder.mkdir()
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    eha = str(python.parent / "eha")
    commands = (
        [eha, "--version"],
        [eha, "simulate", "--command", "sine:amplitude=0.02,frequency=1", "--duration", "2", "--out", "run.mcap"],
        [eha, "effects", "coulomb_friction"],
        [str(python), "-c", LINES],
    )
    for command in commands:
        subprocess.run(command, check=True, cwd=folder, env=environment)
    if not (folder / "report" / "report.html").is_file():
        raise SystemExit("the report was not written: the wheel lacks a file of its")


if __name__ == "__main__":
    sys.exit(main())
