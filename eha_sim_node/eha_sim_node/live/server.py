"""A small web server: the page, the rig's latest values as JSON, and one setting that the page may change."""

from __future__ import annotations

import contextlib
import json
import socket
import threading
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from ipaddress import ip_address
from math import isfinite
from typing import Any
from urllib.parse import urlsplit

from eha_core.errors import EhaError

LARGEST_REQUEST = 1000
"""Bytes of a setting, which has a few dozen."""
SLOWEST = 5.0
"""Seconds for which a connection may be silent in the middle of a request; assumed."""
MOST_CONNECTIONS = 64
"""Connections at once, each a thread; a browser keeps six, and each lasts one request. Assumed: ten browsers."""


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
            self._server = _Server((address, port), handler)
        except (OSError, OverflowError) as error:
            raise ServerError(f"cannot serve at {address}:{port}: {error}; give another port or address") from error
        self.url = f"http://{address}:{self._server.server_address[1]}/"
        threading.Thread(target=self._server.serve_forever, name="page", daemon=True).start()

    def close(self) -> None:
        """Stop serving."""
        self._server.shutdown()
        self._server.server_close()


class _Server(ThreadingHTTPServer):
    """Where too many connections are open, the oldest gives way to the newest: who only holds one keeps nobody out."""

    daemon_threads = True

    def __init__(self, *arguments: Any) -> None:
        self._open: dict[socket.socket, None] = {}
        self._lock = threading.Lock()
        super().__init__(*arguments)

    def process_request(self, request: Any, client_address: Any) -> None:
        with self._lock:
            if len(self._open) >= MOST_CONNECTIONS:
                oldest = next(iter(self._open))
                del self._open[oldest]
                with contextlib.suppress(OSError):
                    oldest.shutdown(socket.SHUT_RDWR)  # which ends its thread
            self._open[request] = None
        super().process_request(request, client_address)

    def shutdown_request(self, request: Any) -> None:
        with self._lock:
            self._open.pop(request, None)
        super().shutdown_request(request)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Nothing: who breaks a connection off is no news."""


class _Refused(Exception):
    """A request that is answered with a status and a reason."""

    def __init__(self, status: HTTPStatus, reason: str | None = None) -> None:
        self.status, self.reason = status, reason


class _Handler(BaseHTTPRequestHandler):
    """GET / and /values, POST /internal_leakage."""

    timeout = SLOWEST
    values: Callable[[], Mapping[str, object]]
    set_leakage: Callable[[float], None]

    def do_GET(self) -> None:
        """Send the page or the values."""
        self._answer({"/": self._page, "/values": self._values})

    def do_POST(self) -> None:
        """Take a new leakage from the page, and from no other."""
        self._answer({"/internal_leakage": self._leakage})

    def _answer(self, answers: Mapping[str, Callable[[], tuple[bytes, str]]]) -> None:
        """Send what the path stands for; whatever goes wrong is a status and one line, here and nowhere else."""
        try:
            if not _is_of_this_machine(self.headers.get_all("Host", [])):
                raise _Refused(HTTPStatus.FORBIDDEN, "ask by the address that the node printed")
            if self.path not in answers:
                raise _Refused(HTTPStatus.NOT_FOUND)
            body, kind = answers[self.path]()
        except _Refused as refused:
            self.send_error(refused.status, refused.reason)
        except TimeoutError:
            self.send_error(HTTPStatus.REQUEST_TIMEOUT)
        except Exception:
            self.send_error(HTTPStatus.INTERNAL_SERVER_ERROR)
        else:
            self._send(body, kind)

    def _page(self) -> tuple[bytes, str]:
        return files(__package__).joinpath("page.html").read_bytes(), "text/html; charset=utf-8"

    def _values(self) -> tuple[bytes, str]:
        return json.dumps(self.values()).encode(), "application/json"

    def _leakage(self) -> tuple[bytes, str]:
        origin = self.headers.get("Origin")
        if origin is not None and origin != f"http://{self.headers.get('Host')}":
            raise _Refused(HTTPStatus.FORBIDDEN, "only the page itself may change the rig")
        if self.headers.get("Content-Type") != "application/json":
            raise _Refused(HTTPStatus.NOT_FOUND)
        self.set_leakage(self._number())
        return b"{}", "application/json"

    def _number(self) -> float:
        length = self.headers.get("Content-Length", "")
        try:
            value: Any = json.loads(self.rfile.read(int(length))) if 0 < int(length) <= LARGEST_REQUEST else None
            number = isinstance(value, (int, float)) and not isinstance(value, bool)
            if number and isfinite(value) and value >= 0.0:
                return float(value)
        except (ValueError, OverflowError, RecursionError):
            pass
        raise _Refused(HTTPStatus.BAD_REQUEST, "send one finite number of at least 0")

    def _send(self, body: bytes, kind: str) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:
        """Nothing: twenty requests a second are no news."""


def _is_of_this_machine(hosts: list[str]) -> bool:
    """Whether a request names this machine, and not a name of somebody's that leads here (DNS rebinding).

    An address is nobody's name. Of names only those count that this machine calls itself by.
    """
    own = socket.gethostname().lower()
    try:
        name = urlsplit(f"//{hosts[0]}").hostname if len(hosts) == 1 else None
        if name not in ("localhost", own, f"{own}.local"):
            ip_address(name or "")
    except ValueError:
        return False
    return True
