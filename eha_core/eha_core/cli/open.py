"""`eha open`: diagnose a log file on a page in the browser, served by this machine."""

from __future__ import annotations

import argparse
import os
import sys
import webbrowser
from importlib.util import find_spec
from pathlib import Path

from eha_core.cli._paths import require_folder
from eha_core.errors import EhaError

NEEDED = ("starlette", "uvicorn")
"""The packages that serve the page, which no other command needs."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "open",
        help="diagnose a log file on a page in the browser",
        description=__doc__,
        epilog=f"Only this machine can open the page. It needs: pip install {' '.join(NEEDED)}. Ctrl-C ends it.",
    )
    add = parser.add_argument
    add("file", nargs="?", type=Path, metavar="FILE", help="the log file; without one, drop it on the page")
    add("--out", type=Path, default=Path("out") / "open", metavar="DIR", help="folder of the results (out/open)")
    add("--port", type=int, default=0, metavar="N", help="TCP port (default: any that is free)")
    add("--no-browser", action="store_true", help="print the page's address and start no browser")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    if any(find_spec(name) is None for name in NEEDED):
        raise EhaError(f"the page is served by {' and '.join(NEEDED)}; install them: pip install {' '.join(NEEDED)}")
    if not 0 <= arguments.port <= 65_535:
        raise EhaError(f"--port {arguments.port} is not possible; choose one from 1024 to 65535, or leave it out")
    require_folder(arguments.out, "--out")
    from eha_core.page.server import serve
    from eha_core.page.session import Session

    session = Session(arguments.out)
    if arguments.file is not None:
        session.open(arguments.file)

    def ready(address: str) -> None:
        print(f"eha open: {address}  (Ctrl-C ends it)", flush=True)
        if not arguments.no_browser and _has_screen():
            webbrowser.open(address)

    serve(session, arguments.port, ready)
    return 0


def _has_screen() -> bool:
    """Whether there is a display; without one, a text browser would take over the terminal."""
    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
