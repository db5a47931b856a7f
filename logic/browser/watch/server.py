"""Server of the page, for this machine alone and for those who know its token."""

import contextlib
import secrets
import signal
import socket
from collections.abc import AsyncIterator, Awaitable
from pathlib import Path
from types import FrameType
from typing import Any

import msgspec
import uvicorn
from starlette.applications import Starlette
from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, Response, StreamingResponse
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from vitruvius.logic.browser.loopback import LOOPBACK, refused_port, require_port
from vitruvius.logic.browser.watch.pool import Stale
from vitruvius.logic.browser.watch.session import Session, Sheet
from vitruvius.logic.errors import RequestError, VitruviusError

PAGE = Path(__file__).with_name("page")
HOSTS = {LOOPBACK, "localhost"}
"""Names of this machine. A page with another name that resolves to it (DNS rebinding) is refused."""

MOST_BYTES = 1 << 22
"""Largest size of a question, in bytes; the largest one contains a house."""

STALE = "The rules have changed since: ask again."

HEADERS = {
    "cache-control": "no-store",
    "content-security-policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "referrer-policy": "no-referrer",
    "x-content-type-options": "nosniff",
}


class Asked(msgspec.Struct):
    """Question of the page."""

    version: int
    request: Sheet | None = None
    house: dict[str, Any] | None = None
    part: str = ""


def application(session: Session, token: str) -> ASGIApp:
    """Return the application that serves the page under ``/TOKEN/`` and answers its questions."""

    async def events(request: Request) -> Response:
        async def lines() -> AsyncIterator[bytes]:
            async for rules in session.versions():
                yield b"event: rules\ndata: " + msgspec.json.encode(rules) + b"\n\n"

        return StreamingResponse(lines(), media_type="text/event-stream")

    async def sheet(request: Request) -> Response:
        asked = await _asked(request)
        if asked.request is None:
            raise RequestError("sheet: name the houses by request")
        wanted = asked.request

        async def lines() -> AsyncIterator[bytes]:
            try:
                async for part in session.sheet(asked.version, wanted):
                    yield msgspec.json.encode(part) + b"\n"
            except Stale:
                yield msgspec.json.encode({"error": STALE}) + b"\n"

        return StreamingResponse(lines(), media_type="application/x-ndjson")

    async def lint(request: Request) -> Response:
        asked = await _asked(request)
        return await _answer(session.lint(asked.version))

    async def why(request: Request) -> Response:
        asked = await _asked(request)
        return await _answer(session.why(asked.version, asked.house or {}, asked.part))

    @contextlib.asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        session.begin()
        yield

    routes = [
        Route("/events", events),
        *(Route(f"/{each.__name__}", each, methods=["POST"]) for each in (sheet, lint, why)),
        Mount("/", StaticFiles(directory=PAGE, html=True)),
    ]
    refused = {RequestError: _refused}
    app = Starlette(routes=[Mount(f"/{token}", routes=routes)], exception_handlers=refused, lifespan=lifespan)
    return Guard(app, token)


class Guard:
    """Application that admits only requests to this machine's own names with the token, and adds headers."""

    def __init__(self, app: ASGIApp, token: str) -> None:
        """Wrap an application."""
        self._app, self._token = app, token.encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(HEADERS)
            await send(message)

        refusal = self._refusal(scope)
        app = PlainTextResponse(f"{refusal}\n", 403) if refusal else self._app
        await app(scope, receive, with_headers)

    def _refusal(self, scope: Scope) -> str:
        host = Headers(scope=scope).get("host", "")
        if host.partition(":")[0] not in HOSTS:
            return f"the host {host} is not this machine: open what vitruvius watch printed"
        given = scope["path"].partition("/")[2].partition("/")[0].encode()  # the path of OPTIONS may be *
        if not secrets.compare_digest(given, self._token):
            return "the token in this address is not that of this page: open what vitruvius watch printed"
        return ""


class Server(uvicorn.Server):
    """Server that ends its session first, so that streams to a page end with it and Ctrl-C works at once."""

    def __init__(self, session: Session, token: str) -> None:
        """Configure uvicorn for one session."""
        super().__init__(
            uvicorn.Config(
                application(session, token),
                http="h11",
                ws="none",
                lifespan="on",
                log_level="error",
                timeout_graceful_shutdown=1,
            )
        )
        self._session, self.ended_by = session, 0

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Store the signal, because uvicorn raises it again in a place where asyncio may miss it."""
        self.ended_by = sig
        super().handle_exit(sig, frame)

    def run(self, sockets: list[socket.socket] | None = None) -> None:
        """Serve until a signal. Raises ``KeyboardInterrupt`` for Ctrl-C."""
        super().run(sockets)
        if self.ended_by == signal.SIGINT:
            raise KeyboardInterrupt

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End the session, then the connections."""
        self._session.end()
        await super().shutdown(sockets)


def listening(port: int) -> socket.socket:
    """Return a socket on the loopback interface; port 0 takes any free port.

    Raises ``RequestError`` if the port is in use or not allowed.
    """
    require_port(port)
    try:
        return socket.create_server((LOOPBACK, port))
    except OSError as error:
        raise refused_port(port, error) from None


async def _asked(request: Request) -> Asked:
    """Return the question in a request. Raises ``RequestError`` for a malformed one."""
    body = b""
    async for part in request.stream():
        body += part
        if len(body) > MOST_BYTES:
            raise RequestError(f"a question has at most {MOST_BYTES >> 20} MiB")
    try:
        return msgspec.json.decode(body, type=Asked)
    except msgspec.DecodeError as error:
        raise RequestError(str(error)) from None


async def _answer(asked: Awaitable[Any]) -> Response:
    """Return an answer, or a record with the error that prevents it."""
    try:
        return JSONResponse(await asked)
    except VitruviusError as error:
        return JSONResponse({"error": str(error)})
    except Stale:
        return JSONResponse({"error": STALE})


def _refused(_: Request, error: Exception) -> Response:
    """Return the response to a malformed question."""
    return PlainTextResponse(f"{error}\n", 400)
