"""Serves the page on this machine alone."""

from __future__ import annotations

import socket
from collections.abc import Callable
from pathlib import Path
from secrets import token_urlsafe
from tempfile import TemporaryDirectory

import uvicorn

from eha_core.errors import EhaError
from eha_core.page.application import application
from eha_core.page.session import Session

ADDRESS = "127.0.0.1"
"""The loopback interface: nobody else's machine reaches it."""
TOKEN_BYTES = 24
"""Random bytes of the token: 192 bits, which nobody guesses."""


def serve(session: Session, port: int, ready: Callable[[str], None]) -> None:
    """Serve the page until the process is interrupted; a diagnosis at work ends with it.

    Args:
        session: what the page works on.
        port: TCP port; 0 for any that is free.
        ready: is given the page's address once it can be asked for.

    Raises:
        EhaError: the port is taken.
    """
    token = token_urlsafe(TOKEN_BYTES)
    with TemporaryDirectory(prefix="eha_open_") as uploads, socket.socket() as listening:
        try:
            listening.bind((ADDRESS, port))
        except OSError as error:
            raise EhaError(f"port {port} cannot be had ({error.strerror}); choose another --port, or none") from error
        listening.listen()
        ready(f"http://{ADDRESS}:{listening.getsockname()[1]}/{token}/")
        settings = uvicorn.Config(
            application(session, Path(uploads), token),
            # the log would hold the token
            access_log=False, log_level="warning", lifespan="off", server_header=False, timeout_graceful_shutdown=1,
        )  # fmt: skip
        try:
            uvicorn.Server(settings).run([listening])
        finally:
            session.stop()
