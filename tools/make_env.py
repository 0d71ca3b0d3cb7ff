"""Makes the project's environment with nothing but a Python: `python3 tools/make_env.py .venv`.

It does nothing when the environment is there and made from the same pins and set-up files. A Debian or Ubuntu Python
comes without pip and without the means to make a virtual environment that has one; the pip of the environment is then
the wheel pinned below, taken from the package index that pip's own configuration names.
"""

from __future__ import annotations

import configparser
import hashlib
import importlib.util
import os
import re
import shutil
import ssl
import subprocess
import sys
import urllib.request
import venv
from pathlib import Path
from urllib.parse import urljoin

ROOT = Path(__file__).resolve().parent.parent
PYTHONS = [(3, minor) for minor in (10, 11, 12, 13)]
PIP_WHEEL = "pip-26.3-py3-none-any.whl"
PIP_SHA256 = "f3b60b20ffaadd4415ed7957212a38ac63fa4c5fa375bd0f4a797777940fad13"
USAGE = "usage: python3 tools/make_env.py FOLDER"
DEFAULT_INDEX = "https://pypi.org/simple"
EDITABLE = ("eha_core", "eha_exam", "eha_sim_node", "rclpy_dds")
DEFINITIONS = "eha_interfaces"
NODES = "eha_sim_node"
RECORDING = ROOT / "bags" / "rig_as_modelled.mcap"
# Whatever decides what gets installed: a change of one of these makes the environment stale.
SOURCES = (
    "tools/make_env.py",
    "requirements/*.txt",
    "*/setup.py",
    "*/setup.cfg",
    "*/pyproject.toml",
    "*/package.xml",
    "eha_interfaces/*/*.msg",
    "eha_interfaces/*/*.srv",
    "rclpy_dds/*.pth",
)


class CannotMake(Exception):
    """The environment cannot be made; the message says why and what to do."""


def main() -> int:
    """Make the environment that the command line names, unless it is up to date."""
    arguments = sys.argv[1:]
    if {"-h", "--help"} & set(arguments):
        print(f"{USAGE}\n\n{__doc__}")
        return 0
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print(USAGE, file=sys.stderr)
        return 2
    if sys.version_info[:2] not in PYTHONS:
        return run_by_another_python()
    folder = Path(arguments[0]).absolute()
    stamp = folder / "made-from"
    wanted = fingerprint()
    if stamp.is_file() and stamp.read_text() == wanted and python_of(folder).exists():
        return 0
    try:
        make(folder)
    except CannotMake as error:
        print(f"make env: {error}", file=sys.stderr)
        return 2
    except subprocess.CalledProcessError as error:
        print(f"make env: this command failed, see its output above: {' '.join(map(str, error.cmd))}", file=sys.stderr)
        return 2
    stamp.write_text(wanted)
    return 0


def run_by_another_python() -> int:
    """Hand over to a Python of a supported version on PATH; say so in one line where there is none."""
    names = [f"python{major}.{minor}" for major, minor in reversed(PYTHONS)]
    for found in filter(None, map(shutil.which, names)):
        # A version manager's launcher is on PATH even for a version that is switched off.
        if subprocess.run([found, "-c", ""], stderr=subprocess.DEVNULL, check=False).returncode == 0:
            return subprocess.run([found, *sys.argv], check=False).returncode
    version = ".".join(map(str, sys.version_info[:2]))
    print(
        f"make env: {sys.executable} is Python {version}, and none of {', '.join(names)} is on PATH; "
        "install one of them, or name one: make PYTHON=/path/to/python3",
        file=sys.stderr,
    )
    return 2


def fingerprint() -> str:
    """Return a digest of the interpreter's version and of every file that decides what gets installed."""
    digest = hashlib.sha256(sys.version.encode())
    for path in sorted(path for pattern in SOURCES for path in ROOT.glob(pattern)):
        digest.update(path.relative_to(ROOT).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def python_of(folder: Path) -> Path:
    """Return the path of an environment's interpreter."""
    return folder / "bin" / "python"


def make(folder: Path) -> None:
    """Make the environment in a folder: an interpreter of its own, pip, the pins, the project's packages."""
    print(f"make env: Python {sys.version.split()[0]} in {folder}", flush=True)
    venv.create(folder, clear=not usable(folder), with_pip=False, symlinks=True)
    python = python_of(folder)
    if not has_pip(python):
        install_pip(python)
    pip: list[str | Path] = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    # One after the other: the first file brings the pip that reads the rest.
    for name in ("build", "runtime", "develop"):
        subprocess.run([*pip, "--requirement", ROOT / "requirements" / f"{name}.txt"], check=True)
    packages = [word for name in EDITABLE for word in ("--editable", ROOT / name)] + [ROOT / DEFINITIONS]
    subprocess.run([*pip, "--no-build-isolation", "--no-deps", "--force-reinstall", *packages], check=True)
    lay_out_nodes(folder)
    compile_plant(folder)


def compile_plant(folder: Path) -> None:
    """Have a recording diagnosed, which compiles the plant for all that comes after: the code is kept by user and by
    version."""
    print("make env: a first diagnosis, which compiles the plant", flush=True)
    diagnosis: list[str | Path] = [folder / "bin" / "eha", "diagnose"]
    subprocess.run([*diagnosis, RECORDING, "--json", "-"], check=True, stdout=subprocess.DEVNULL)


def lay_out_nodes(folder: Path) -> None:
    """Put the nodes' programs and files where ROS looks for them, as `colcon build --symlink-install` does.

    An editable install leaves out a package's data files, and puts its programs on PATH.
    """
    index = folder / "share/ament_index/resource_index/packages"
    programs = folder / "lib" / NODES
    for made in (index, programs):
        made.mkdir(parents=True, exist_ok=True)
    (index / NODES).touch()
    share = folder / "share" / NODES
    share.unlink(missing_ok=True)
    share.symlink_to(ROOT / NODES)
    entry_points = configparser.RawConfigParser()
    entry_points.read(folder.glob(f"lib/python*/site-packages/{NODES}-*.dist-info/entry_points.txt"))
    for name in entry_points.options("console_scripts"):
        (folder / "bin" / name).replace(programs / name)


def usable(folder: Path) -> bool:
    """Return whether a folder holds an environment of this very Python version, which can be brought up to date."""
    question = "import sys; print(sys.version)"
    try:
        answer = subprocess.run([python_of(folder), "-c", question], capture_output=True, text=True, check=False)
    except OSError:
        return False
    return answer.stdout.strip() == sys.version


def has_pip(python: Path) -> bool:
    """Return whether an interpreter has pip."""
    return subprocess.run([python, "-c", "import pip"], stderr=subprocess.DEVNULL, check=False).returncode == 0


def install_pip(python: Path) -> None:
    """Put pip into an environment: the one that comes with Python, else the pinned wheel from the index."""
    if importlib.util.find_spec("ensurepip"):
        bundled = subprocess.run([python, "-m", "ensurepip", "--default-pip"], capture_output=True, check=False)
        if bundled.returncode == 0:
            return
    wheel = python.parent.parent / PIP_WHEEL
    wheel.write_bytes(download_pip())
    # pip runs from inside its own wheel, and so installs itself.
    subprocess.run([python, wheel / "pip", "install", "--quiet", "--no-index", wheel], check=True)
    wheel.unlink()


def download_pip() -> bytes:
    """Return pip's wheel from the first index that has it."""
    settings = pip_settings()
    context = ssl.create_default_context(cafile=settings.get("cert"))
    indexes = [settings.get("index-url", DEFAULT_INDEX), *settings.get("extra-index-url", "").split()]
    reasons = []
    for index in indexes:
        page = f"{index.rstrip('/')}/pip/"
        try:
            with urllib.request.urlopen(page, timeout=60, context=context) as answer:
                link = re.search(rf'href="([^"]*{re.escape(PIP_WHEEL)})[#"]', answer.read().decode())
            if link is None:
                reasons.append(f"{page} does not list {PIP_WHEEL}")
                continue
            with urllib.request.urlopen(urljoin(page, link[1]), timeout=60, context=context) as answer:
                wheel: bytes = answer.read()
        except OSError as error:
            reasons.append(f"{page}: {error}")
            continue
        if hashlib.sha256(wheel).hexdigest() == PIP_SHA256:
            return wheel
        reasons.append(f"{page}: {PIP_WHEEL} is not the file that was pinned")
    raise CannotMake(
        f"this Python has no pip to give, and it could not be fetched ({'; '.join(reasons)}); "
        "install python3-venv, or set PIP_INDEX_URL to an index within reach"
    )


def pip_settings() -> dict[str, str]:
    """Return what pip's configuration files and environment variables say about its index, by pip's option names.

    The order is pip's own: machine, user, the file that PIP_CONFIG_FILE names, variables; the last one wins.
    """
    user = Path(os.environ.get("XDG_CONFIG_HOME", Path.home() / ".config"))
    files = [Path("/etc/xdg/pip/pip.conf"), Path("/etc/pip.conf"), Path.home() / ".pip/pip.conf", user / "pip/pip.conf"]
    if "PIP_CONFIG_FILE" in os.environ:
        files.append(Path(os.environ["PIP_CONFIG_FILE"]))
    configuration = configparser.RawConfigParser()
    configuration.read(files)
    settings: dict[str, str] = {}
    for section in ("global", "install"):
        if configuration.has_section(section):
            settings.update(configuration.items(section))
    for option in ("index-url", "extra-index-url", "cert"):
        variable = "PIP_" + option.replace("-", "_").upper()
        if os.environ.get(variable):
            settings[option] = os.environ[variable]
    return settings


if __name__ == "__main__":
    sys.exit(main())
