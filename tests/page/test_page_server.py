"""The page's server: this machine alone, with its token, within its ceilings; and the command that starts it."""

from __future__ import annotations

import asyncio
import http.client
import json
import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from urllib.parse import quote, urlsplit

import pytest

from eha_core.cli import main
from eha_core.errors import EhaError
from eha_core.page.run import FILES
from eha_core.page.uploads import MOST_BYTES, TooLarge, plain_name, receive

ROOT = Path(__file__).resolve().parents[2]
BAG = ROOT / "bags" / "rig_coulomb_friction.mcap"


class Server:
    """`eha open` in a process of its own."""

    def __init__(self, folder: Path, *words: str) -> None:
        command = [sys.executable, "-m", "eha_core.cli", "open", "--no-browser", "--out", str(folder / "out"), *words]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        match = re.match(r"eha open: (http://127\.0\.0\.1:\d+/\S+/)", line)
        assert match, line + self.process.stderr.read()
        self.url = match[1]
        self.host = urlsplit(self.url).netloc
        self.root = urlsplit(self.url).path

    def ask(
        self, path: str = "", method: str = "GET", body: bytes | str | None = None, **headers: str
    ) -> tuple[int, bytes, http.client.HTTPMessage]:
        """The status, body and headers of an answer to a path below the token's, or to one with a leading slash."""
        connection = http.client.HTTPConnection(self.host, timeout=120)
        whole = path if path.startswith("/") else self.root + path
        connection.request(method, whole, body, {name.replace("_", "-"): text for name, text in headers.items()})
        answer = connection.getresponse()
        try:
            return answer.status, answer.read(), answer.headers
        finally:
            connection.close()

    def end(self) -> None:
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        self.process.communicate(timeout=60)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    started = Server(tmp_path_factory.mktemp("page"), str(BAG))
    yield started
    started.end()


def test_whoever_has_the_address_gets_the_page_and_what_the_file_holds(server: Server) -> None:
    status, page, headers = server.ask()
    assert status == 200 and b"<title>eha open</title>" in page
    assert headers["content-security-policy"].startswith("default-src 'self'")
    assert (headers["referrer-policy"], headers["cache-control"]) == ("no-referrer", "no-store")
    for name in ("page.js", "page.css"):
        assert server.ask(name)[0] == 200
    state = json.loads(server.ask("state")[1])
    assert state["file"]["name"] == BAG.name
    assert {row["channel"] for row in state["file"]["rows"]} >= {"voltage_command", "position", "pressure_a"}
    assert [one["name"] for one in state["choices"]["sources"]][-2:] == ["servo_valve", "switched_pump"]


def test_without_the_token_nothing_is_answered(server: Server) -> None:
    for path in ("/", "/state", "/page.js", f"/{'A' * 32}/state", f"{server.root[:-2]}/state", f"/x{server.root}state"):
        status, body, _ = server.ask(path)
        assert status == 403 and b"token" in body and BAG.name.encode() not in body
    status, _, _ = server.ask("/diagnosis", "POST", "{}")
    assert status == 403


@pytest.mark.parametrize("host", ["rebound.example", "rebound.example:80", "127.0.0.1.rebound.example", "0.0.0.0", ""])
def test_another_host_s_name_is_refused(server: Server, host: str) -> None:
    status, body, _ = server.ask("state", Host=host)
    assert status == 400 and BAG.name.encode() not in body


def test_another_page_may_not_ask(server: Server) -> None:
    for origin in ("http://elsewhere.example", "null", f"https://{server.host}"):
        assert server.ask("diagnosis", "POST", "{}", Origin=origin)[0] == 403
    assert server.ask("state", Origin=f"http://{server.host}")[0] == 200


def test_nobody_else_s_machine_is_listened_to(server: Server) -> None:
    port = int(server.host.partition(":")[2])
    others = {row[4][0] for row in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)} - {"127.0.0.1"}
    for address in (*others, "127.0.0.2"):
        with socket.socket() as one:
            one.settimeout(5)
            assert one.connect_ex((address, port)) != 0


@pytest.mark.parametrize(
    "path",
    [
        "download/../../../../etc/passwd", "download/..%2f..%2f..%2fetc%2fpasswd", "download/%2fetc%2fpasswd",
        "download/page.py", "download/progress.log", "download/topics.yaml", "report", "../../etc/passwd",
        "page.html/../../server.py", "server.py", "download/", "download/..",
    ],
)  # fmt: skip
def test_only_results_are_handed_out_and_only_by_their_names(server: Server, path: str) -> None:
    status, body, _ = server.ask(path)
    assert status in (403, 404)
    assert b"root:" not in body and b"import" not in body


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        ("rig.csv", "rig.csv"), ("../../rig.csv", "rig.csv"), ("C:\\logs\\rig 1.csv", "rig 1.csv"), ("..", None),
        ("/etc/passwd", "passwd"), ("", None), ("a/", None), (".hidden", "hidden"),
        ("r\u00f6hre\x1b[2J.csv", "r\u00f6hre__2J.csv"),
        ("x" * 500 + ".mcap", "x" * 115 + ".mcap"),
    ],
)  # fmt: skip
def test_a_name_is_of_no_folder(given: str, kept: str | None) -> None:
    if kept is None:
        with pytest.raises(EhaError, match="is no name of a file"):
            plain_name(given)
    else:
        assert plain_name(given) == kept


def test_a_file_that_is_dropped_stays_in_its_own_folder(server: Server, tmp_path: Path) -> None:
    name = f"../../{tmp_path.name}.csv"
    body = "t [s],u [V],x [mm]\n" + "".join(f"{k / 500},{k % 7},{k % 11}\n" for k in range(200))
    status, answer, _ = server.ask(f"file?name={quote(name)}", "POST", body)
    assert status == 200 and json.loads(answer)["file"]["name"] == f"{tmp_path.name}.csv"


def test_a_file_that_cannot_be_read_is_refused_in_one_line(server: Server) -> None:
    status, answer, _ = server.ask("file?name=log.blf", "POST", b"LOGG" + bytes(200))
    error = json.loads(answer)["error"]
    assert status == 400 and "log.blf: is a Vector CAN log" in error
    assert "\n" not in error and "/tmp" not in error


def test_more_than_the_ceiling_is_refused_before_it_comes(server: Server) -> None:
    with socket.create_connection(server.host.split(":"), timeout=60) as one:
        first = f"POST {server.root}file?name=big.csv HTTP/1.1"
        lines = (first, f"Host: {server.host}", f"Content-Length: {MOST_BYTES + 1}")
        one.sendall("\r\n".join([*lines, "", ""]).encode())
        assert one.recv(4096).startswith(b"HTTP/1.1 413")


def test_more_than_the_ceiling_is_not_kept(tmp_path: Path) -> None:
    async def parts() -> AsyncIterator[bytes]:
        for _ in range(11):
            yield bytes(100)

    with pytest.raises(TooLarge, match=r"big.csv: is larger than .*; `eha open FILE` reads it in its place"):
        asyncio.run(receive(parts(), tmp_path / "big.csv", most=1000))
    assert not list(tmp_path.iterdir())
    assert asyncio.run(receive(parts(), tmp_path / "fits.csv", most=1100)) == 1100
    assert (tmp_path / "fits.csv").stat().st_size == 1100


def test_what_the_page_does_not_send_is_refused(server: Server) -> None:
    for body in ("{", "[]", "7", "[" * 100_000):
        assert server.ask("topics", "POST", body)[0] == 400
    assert server.ask(f"diagnosis?from={quote(chr(0xB2))}")[0] == 404  # none was begun; a power of two is no number
    assert server.ask("topics", "POST", "x" * 2**21)[0] == 413
    assert server.ask("nominal", "POST", json.dumps({"source": "a windmill", "lines": {}}))[0] == 400
    status, answer, _ = server.ask("nominal", "POST", json.dumps({"source": "servo_valve", "lines": {"bore": "40"}}))
    assert status == 200 and json.loads(answer)["problems"] == {"bore": "40: in which unit? write for example '40 mm'"}


def test_a_data_sheet_gives_the_file_that_init_rig_writes(
    server: Server, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = {
        "bore": "40 mm",
        "rod": "25mm",
        "stroke": "200 mm",
        "rated_flow": "40 l/min",
        "rated_pressure_drop": "70 bar",
    }
    path = tmp_path / "model.yaml"
    words = [word for name, text in lines.items() for word in (f"--{name.replace('_', '-')}", text)]
    assert main(["init-rig", "--out", str(path), *words]) == 0
    printed = capsys.readouterr().out
    body = json.dumps({"source": "servo_valve", "lines": lines})
    sheet = json.loads(server.ask("nominal", "POST", body)[1])
    assert sheet["text"] == path.read_text()
    assert f"{sheet['unknown']} unknown" in printed
    server.ask("nominal", "POST", json.dumps({"forget": True}))
    status, _, _ = server.ask("file?name=model.yaml", "POST", path.read_bytes())
    assert status == 200
    assert json.loads(server.ask("state")[1])["nominal"] == {"name": "model.yaml", "text": path.read_text()}


def test_a_diagnosis_can_be_stopped_and_ends_with_the_server(tmp_path: Path) -> None:
    server = Server(tmp_path, str(BAG))
    try:
        rows = json.loads(server.ask("state")[1])["file"]["rows"]
        for end in ("stop", "server"):
            assert server.ask("topics", "POST", json.dumps({"rows": rows, "without": []}))[0] == 200
            assert server.ask("diagnosis", "POST", "{}")[0] == 200
            assert server.ask("diagnosis", "POST", "{}")[0] == 400  # one is at work
            assert json.loads(server.ask("diagnosis")[1])["running"] is True
            found = subprocess.run(
                ["pgrep", "--parent", str(server.process.pid), "--full", "eha_core.cli diagnose"],
                capture_output=True, text=True, check=True,
            )  # fmt: skip
            child = int(found.stdout)
            if end == "stop":
                assert server.ask("diagnosis", "DELETE")[0] == 200
                state = json.loads(server.ask("diagnosis")[1])
                assert (state["running"], state["stopped"]) == (False, True)
            else:
                server.end()
            with pytest.raises(ProcessLookupError):
                os.kill(child, 0)
    finally:
        server.end()
    assert {path.name for path in (tmp_path / "out" / BAG.stem).iterdir()}.isdisjoint(set(FILES) - {"topics.yaml"})


def test_results_of_another_time_stay(tmp_path: Path) -> None:
    from eha_core.page.session import Session

    (tmp_path / BAG.stem).mkdir()
    (tmp_path / BAG.stem / "topics.yaml").write_text("kept")
    session = Session(tmp_path)
    session.open(BAG)
    session.say(session.state()["file"]["rows"], [])
    assert (tmp_path / BAG.stem / "topics.yaml").read_text() == "kept"
    assert (tmp_path / f"{BAG.stem}-2" / "topics.yaml").read_text().startswith("# Channels of")


def test_without_the_extra_the_command_says_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("eha_core.cli.open.find_spec", lambda name: None)
    assert main(["open"]) == 2
    said = capsys.readouterr().err
    assert (
        said == "eha open: the page is served by starlette and uvicorn; install them: pip install starlette uvicorn\n"
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["nowhere.csv"], "nowhere.csv: there is no such file or folder"),
        (["--port", "70000"], "--port 70000 is not possible"),
        (["--out", "/proc/version/x"], "cannot be written"),
    ],
)
def test_a_mistake_is_one_line(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["open", "--no-browser", *words]) == 2
    said = capsys.readouterr().err
    assert message in said and said.count("\n") == 1


def test_a_port_that_is_taken_is_said(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert main(["open", "--no-browser", "--port", str(port), "--out", str(tmp_path)]) == 2
    assert f"port {port} cannot be had" in capsys.readouterr().err
