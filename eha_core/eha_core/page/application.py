"""The page's addresses: each takes a request apart, asks the session, and answers in JSON or with a file."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable
from importlib import resources
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, Response
from starlette.routing import Route

from eha_core.errors import EhaError
from eha_core.page.guard import REPORT, Guard
from eha_core.page.session import Session
from eha_core.page.uploads import MOST_BYTES, TooLarge, plain_name, receive, too_large

HOSTS = ("127.0.0.1", "localhost")
"""The names that this machine calls itself by; with any other a request comes from elsewhere's page."""
LARGEST_JSON = 2**20
"""Bytes of what the page sends besides files."""
_TYPES = {"page.html": "text/html", "page.js": "text/javascript", "page.css": "text/css"}

Answer = Callable[[Request], Awaitable[Response]]


def application(session: Session, uploads: Path, token: str, most: int = MOST_BYTES) -> Starlette:
    """The page's server.

    Args:
        session: what the page works on.
        uploads: the folder in which files that are dropped are kept.
        token: what every path begins with.
        most: bytes of a file that is dropped.
    """
    pages = _Pages(session, uploads, most)
    routes = [
        Route("/", _own("page.html")),
        *(Route(f"/{name}", _own(name)) for name in _TYPES if name != "page.html"),
        Route("/state", pages.state),
        Route("/file", _told(pages.file), methods=["POST"]),
        Route("/topics", _told(pages.topics), methods=["POST"]),
        Route("/nominal", _told(pages.nominal), methods=["POST"]),
        Route("/diagnosis", _told(pages.begin), methods=["POST"]),
        Route("/diagnosis", _told(pages.progress), methods=["GET"]),
        Route("/diagnosis", _told(pages.stop), methods=["DELETE"]),
        Route("/report", _told(pages.report)),
        Route("/download/{name}", _told(pages.download)),
    ]
    of_this_machine = Middleware(TrustedHostMiddleware, allowed_hosts=list(HOSTS), www_redirect=False)
    return Starlette(routes=routes, middleware=[of_this_machine, Middleware(Guard, token)])


class _Pages:
    """Answers requests."""

    def __init__(self, session: Session, uploads: Path, most: int) -> None:
        self._session, self._uploads, self._most = session, uploads, most

    async def state(self, request: Request) -> Response:
        return JSONResponse(await run_in_threadpool(self._session.state))

    async def file(self, request: Request) -> Response:
        name = plain_name(request.query_params.get("name", ""))
        length = request.headers.get("content-length", "")
        if length.isdecimal() and int(length) > self._most:
            raise too_large(name, self._most)
        # a folder of its own, so that a name cannot be taken
        path = Path(mkdtemp(dir=self._uploads)) / name
        await receive(request.stream(), path, self._most)
        try:
            await run_in_threadpool(self._session.open, path)
        except EhaError as error:
            raise EhaError(str(error).replace(f"{path.parent}/", "")) from error
        return JSONResponse(await run_in_threadpool(self._session.state))

    async def topics(self, request: Request) -> Response:
        given = await _json(request)
        text = await run_in_threadpool(self._session.say, _list(given, "rows"), _list(given, "without"))
        return JSONResponse({"text": text})

    async def nominal(self, request: Request) -> Response:
        given = await _json(request)
        if given.get("forget"):
            self._session.forget_nominal()
            return JSONResponse({})
        lines = given.get("lines")
        sheet = self._session.fill_in(str(given.get("source")), lines if isinstance(lines, dict) else {})
        return JSONResponse({"text": sheet.text, "unknown": sheet.unknown, "problems": sheet.problems})

    async def begin(self, request: Request) -> Response:
        await run_in_threadpool(self._session.diagnose)
        return JSONResponse({})

    async def progress(self, request: Request) -> Response:
        start = request.query_params.get("from", "0")
        return JSONResponse(self._session.progress(int(start) if start.isdecimal() else 0))

    async def stop(self, request: Request) -> Response:
        await run_in_threadpool(self._session.stop)
        return JSONResponse({})

    async def report(self, request: Request) -> Response:
        headers = {"content-security-policy": REPORT}
        return FileResponse(self._session.result("report.html"), media_type="text/html", headers=headers)

    async def download(self, request: Request) -> Response:
        name = request.path_params["name"]
        return FileResponse(
            self._session.result(name), media_type="application/octet-stream", filename=name,
            headers={"content-security-policy": "sandbox"},
        )  # fmt: skip


def _own(name: str) -> Answer:
    async def answer(request: Request) -> Response:
        text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
        return Response(text, media_type=_TYPES[name])

    return answer


def _told(answer: Answer) -> Answer:
    """What an answer refuses, as one line for the page."""

    async def guarded(request: Request) -> Response:
        try:
            return await answer(request)
        except TooLarge as error:
            return JSONResponse({"error": str(error)}, 413, {"connection": "close"})
        except EhaError as error:
            return JSONResponse({"error": str(error)}, 404 if request.method == "GET" else 400)

    return guarded


async def _json(request: Request) -> dict[str, Any]:
    body = bytearray()
    async for part in request.stream():
        body += part
        if len(body) > LARGEST_JSON:
            raise TooLarge("the page sent more than it has to say")
    try:
        given = json.loads(body)
    except (ValueError, RecursionError) as error:
        raise EhaError("the page sent no JSON; load it again") from error
    if not isinstance(given, dict):
        raise EhaError("the page sent no object; load it again")
    return given


def _list(given: dict[str, Any], name: str) -> list[Any]:
    found = given.get(name)
    return found if isinstance(found, list) else []
