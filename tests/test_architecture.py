"""The walls between the packages, which pyproject.toml names, hold; and would not if somebody broke through."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def lint_imports(configuration: Path, folder: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Run import-linter with one configuration file."""
    command = [Path(sys.executable).parent / "lint-imports", "--no-cache", "--config", configuration]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)


def test_every_contract_is_kept() -> None:
    result = lint_imports(ROOT / "pyproject.toml")
    assert result.returncode == 0, result.stdout + result.stderr
    assert re.search(r"Contracts: [1-9]\d* kept, 0 broken", result.stdout)


def test_a_breach_is_found(tmp_path: Path) -> None:
    package = tmp_path / "eha_core_copy"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "plant.py").write_text("import rclpy\n")
    configuration = tmp_path / "pyproject.toml"
    configuration.write_text(
        '[tool.importlinter]\nroot_packages = ["eha_core_copy"]\ninclude_external_packages = true\n'
        '[[tool.importlinter.contracts]]\nname = "no ROS"\ntype = "forbidden"\n'
        'source_modules = ["eha_core_copy"]\nforbidden_modules = ["rclpy"]\n'
    )
    result = lint_imports(configuration, tmp_path)
    assert result.returncode == 1
    assert "no ROS BROKEN" in result.stdout
