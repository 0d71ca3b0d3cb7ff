"""Who may ask the page's server: whoever has the address with its token, and nobody's other page."""

from __future__ import annotations

from secrets import compare_digest

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

OWN = "default-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
"""What the page may load: its own files alone."""
REPORT = (
    "sandbox allow-scripts allow-popups; default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; style-src"
    " 'unsafe-inline'; img-src data: blob:; font-src data:; frame-ancestors 'self'"
)
"""A report loads nothing, and cannot reach the page it is shown on: its text comes from a file of anybody's."""


class Guard:
    """Lets a request through whose path begins with the token, and takes the token off.

    A page of another site that names this address (DNS rebinding, a form) has no token; one that would have it is
    refused by its origin. Nothing is answered that a cache would keep or another page could show.
    """

    def __init__(self, application: ASGIApp, token: str) -> None:
        self._application = application
        self._token = token.encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] != "http":
            await self._application(scope, receive, send)
            return
        _, first, *rest = (*scope["path"].split("/", 2), "", "")[:3]
        headers = Headers(scope=scope)
        refused = ""
        if not compare_digest(first.encode("utf-8", "surrogateescape"), self._token):
            refused = "the address lacks its token; use the one that `eha open` printed"
        elif (origin := headers.get("origin")) is not None and origin != f"http://{headers.get('host')}":
            refused = "another page may not ask"

        async def answer(message: Message) -> None:
            if message["type"] == "http.response.start":
                added = MutableHeaders(scope=message)
                added.setdefault("content-security-policy", OWN)
                added["x-content-type-options"] = "nosniff"
                added["referrer-policy"] = "no-referrer"
                added["cache-control"] = "no-store"
                added["cross-origin-resource-policy"] = "same-origin"
            await send(message)

        if refused:
            await PlainTextResponse(refused, 403)(scope, receive, answer)
            return
        path = f"/{''.join(rest)}"
        await self._application({**scope, "path": path, "raw_path": path.encode()}, receive, answer)
