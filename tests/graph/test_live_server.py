"""The live page's server: who may ask, what is no number, who only holds a connection, what is printed of it all."""

from __future__ import annotations

import http.client
import socket
from collections.abc import Iterator

import pytest

from eha_sim_node.live import server as live
from eha_sim_node.live.server import PageServer


class Served:
    """A server on a port of its own, and the settings it was given."""

    def __init__(self) -> None:
        self.wanted: list[float] = []
        self.page = PageServer("127.0.0.1", 0, lambda: {"position": 0.01}, self.wanted.append)
        self.port = int(self.page.url.rstrip("/").rpartition(":")[2])

    def ask(self, path: str = "/values", body: bytes | None = None, **headers: str) -> int:
        given = {"Content-Type": "application/json", **{k.replace("_", "-"): text for k, text in headers.items()}}
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        connection.request("GET" if body is None else "POST", path, body, given)
        try:
            return connection.getresponse().status
        finally:
            connection.close()


@pytest.fixture
def served() -> Iterator[Served]:
    one = Served()
    yield one
    one.page.close()


@pytest.mark.parametrize("host", ["evil.example", "evil.example:8080", "127.0.0.1.evil.example", "[", ""])
def test_a_name_that_only_leads_here_is_refused(served: Served, host: str) -> None:
    assert served.ask(Host=host) == 403
    assert served.ask("/internal_leakage", b"1e-9", Host=host, Origin=f"http://{host}") == 403
    assert served.wanted == []


@pytest.mark.parametrize("host", ["127.0.0.1:8080", "localhost", "[::1]:80", "192.168.0.7", socket.gethostname()])
def test_this_machine_s_names_and_addresses_are_answered(served: Served, host: str) -> None:
    assert served.ask(Host=host) == 200
    assert served.ask("/internal_leakage", b"1e-9", Host=host, Origin=f"http://{host}") == 200
    assert served.wanted == [1e-9]


def test_what_is_no_number_is_refused_and_nothing_is_printed(served: Served, capfd: pytest.CaptureFixture[str]) -> None:
    for body in (b"1" + b"0" * 900, b"[" * 999, b"{", b"true", b"NaN", b"-1", b"", b" " * 2000):
        assert served.ask("/internal_leakage", body) == 400, body
    request = "POST /internal_leakage HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\n"
    for length in ("\u00b2", "-5", "9" * 5000, "many"):
        with socket.create_connection(("127.0.0.1", served.port), timeout=20) as one:
            one.sendall(f"{request}Content-Length: {length}\r\n\r\n1".encode("latin-1"))
            assert b" 400 " in one.recv(4096).split(b"\r\n")[0], length
    socket.create_connection(("127.0.0.1", served.port)).close()
    assert served.ask() == 200
    assert served.wanted == [] and capfd.readouterr() == ("", "")


def test_what_fails_inside_is_a_status_and_not_a_traceback(capfd: pytest.CaptureFixture[str]) -> None:
    served = Served()
    served.page.close()
    served.page = PageServer("127.0.0.1", 0, lambda: {"position": object()}, served.wanted.append)
    served.port = int(served.page.url.rstrip("/").rpartition(":")[2])
    assert served.ask() == 500
    served.page.close()
    assert capfd.readouterr() == ("", "")


def test_connections_that_are_only_held_keep_nobody_out(served: Served) -> None:
    held = [socket.create_connection(("127.0.0.1", served.port)) for _ in range(3 * live.MOST_CONNECTIONS)]
    assert served.ask() == 200
    held[0].settimeout(20)
    assert held[0].recv(1) == b""  # the oldest gave way
    for one in held:
        one.close()


def test_a_connection_that_stays_silent_is_closed(monkeypatch: pytest.MonkeyPatch, served: Served) -> None:
    monkeypatch.setattr(live._Handler, "timeout", 0.2)
    with socket.create_connection(("127.0.0.1", served.port), timeout=20) as one:
        one.sendall(b"POST /internal_leakage HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n")
        assert one.recv(1) == b""
