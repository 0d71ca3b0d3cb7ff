"""A small web server: the page, the rig's latest values as JSON, and one setting that the page may change."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from math import isfinite

from eha_core.errors import EhaError

LARGEST_REQUEST = 1000  # bytes; a setting is a few dozen


class ServerError(EhaError):
    """The page cannot be served."""


class PageServer:
    """Serves from threads of its own until closed.

    Args:
        address: of the interface to listen on; 127.0.0.1 lets nobody in but this machine.
        port: TCP port; 0 takes a free one.
        values: makes the values that the page shows; called from the server's threads.
        set_leakage: takes a new K_Lin [m^3/(s Pa)] from the page; called likewise.

    Raises:
        ServerError: the address cannot be listened on.
    """

    def __init__(
        self,
        address: str,
        port: int,
        values: Callable[[], Mapping[str, object]],
        set_leakage: Callable[[float], None],
    ) -> None:
        handler = type(
            "Handler", (_Handler,), {"values": staticmethod(values), "set_leakage": staticmethod(set_leakage)}
        )
        try:
            self._server = ThreadingHTTPServer((address, port), handler)
        except (OSError, OverflowError) as error:
            raise ServerError(f"cannot serve at {address}:{port}: {error}; give another port or address") from error
        self._server.daemon_threads = True
        self.url = f"http://{address}:{self._server.server_address[1]}/"
        threading.Thread(target=self._server.serve_forever, name="page", daemon=True).start()

    def close(self) -> None:
        """Stop serving."""
        self._server.shutdown()
        self._server.server_close()


class _Handler(BaseHTTPRequestHandler):
    """GET / and /values, POST /internal_leakage."""

    values: Callable[[], Mapping[str, object]]
    set_leakage: Callable[[float], None]

    def do_GET(self) -> None:
        """Send the page or the values."""
        if self.path == "/":
            self._send(files(__package__).joinpath("page.html").read_bytes(), "text/html; charset=utf-8")
        elif self.path == "/values":
            self._send(json.dumps(self.values()).encode(), "application/json")
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:
        """Take a new leakage from the page, and from no other."""
        origin = self.headers.get("Origin")
        if origin is not None and origin != f"http://{self.headers.get('Host')}":
            self.send_error(HTTPStatus.FORBIDDEN, "only the page itself may change the rig")
        elif self.path != "/internal_leakage" or self.headers.get("Content-Type") != "application/json":
            self.send_error(HTTPStatus.NOT_FOUND)
        elif (value := self._number()) is None:
            self.send_error(HTTPStatus.BAD_REQUEST, "send one finite number of at least 0")
        else:
            self.set_leakage(value)
            self._send(b"{}", "application/json")

    def _number(self) -> float | None:
        length = self.headers.get("Content-Length", "")
        if not length.isdigit() or int(length) > LARGEST_REQUEST:
            return None
        try:
            value = json.loads(self.rfile.read(int(length)))
        except ValueError:
            return None
        usable = isinstance(value, (int, float)) and not isinstance(value, bool) and isfinite(value) and value >= 0.0
        return float(value) if usable else None

    def _send(self, body: bytes, kind: str) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:
        """Nothing: twenty requests a second are no news."""
