"""Builds wheels of library, messages, exam and `rclpy_dds`, installs them into clean environments, and uses them there.

    python tools/check_wheels.py FOLDER

Leaves the wheels in FOLDER. One environment holds all wheels but the exam's, another the exam's alone, at the versions
that requirements/runtime.txt pins, and nothing of this checkout; what runs there runs outside of it.
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
PACKAGES = ("eha_core", "eha_exam", "eha_interfaces", "rclpy_dds")
EXAMPLE = ROOT / "eha_exam" / "examples" / "dry_friction.py"
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
    exam = [wheel for wheel in wheels if wheel.name.startswith("eha_exam")]
    library = [wheel for wheel in wheels if wheel not in exam]
    use(install(folder / "environment", library), folder / "elsewhere")
    sit_an_exam(install(folder / "exam", exam), folder / "examined")
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
    environment = outside()
    eha = str(python.parent / "eha")
    commands = (
        [eha, "--version"],
        [eha, "simulate", "--command", "sine:amplitude=0.02,frequency=1", "--duration", "2", "--out", "run.mcap"],
        [eha, "effects", "coulomb_friction"],
        [eha, "exam", "--help"],
        [str(python), "-c", LINES],
    )
    for command in commands:
        subprocess.run(command, check=True, cwd=folder, env=environment)
    if not (folder / "report" / "report.html").is_file():
        raise SystemExit("the report was not written: the wheel lacks a file of its")
    refused = subprocess.run([eha, "exam"], capture_output=True, text=True, check=False, cwd=folder, env=environment)
    if refused.returncode == 0 or "pip install eha_exam" not in refused.stderr:
        raise SystemExit(f"`eha exam` without the exam does not say what to install: {refused.stderr}")


def outside() -> dict[str, str]:
    """The environment's variables without those that would lead a Python to this checkout."""
    return {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}


def sit_an_exam(python: Path, folder: Path) -> None:
    """Have a method of forty lines sit a short exam, and that of the shipped set, where there is nothing of the library
    that is examined."""
    folder.mkdir()
    environment = outside() | {"EHA_CACHE_DIR": str(folder / "cache")}
    absent = "import importlib.util as util, sys; sys.exit(util.find_spec('eha_core') is not None)"
    subprocess.run([str(python), "-c", absent], check=True, cwd=folder, env=environment)
    script = shutil.copy(EXAMPLE, folder)
    command = [str(python.parent / "eha-exam"), "--cases", "3", "--tier", "null", "--seed", "1", "--out", "exam"]
    method = f"dry friction={{python}} {script} {{recordings}} {{answers}}"
    subprocess.run([*command, "--method", method, "--require", "1"], check=True, cwd=folder, env=environment)
    shipped = [command[0], "--set", str(ROOT / "eha_exam" / "shipped"), "--out", "shipped", "--method", method]
    subprocess.run(shipped, check=True, cwd=folder, env=environment)
    table = (folder / "exam" / "table.md").read_text(encoding="utf-8")
    print(table.partition("\n## ")[0])


if __name__ == "__main__":
    sys.exit(main())
