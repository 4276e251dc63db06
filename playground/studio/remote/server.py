"""Serve one window on 127.0.0.1 by HTTP and WebSocket, from a thread of its own.

    GET  /TOKEN/             a page of sliders
    GET  /TOKEN/state        what is shown, its time, presets and errors
    GET  /TOKEN/parameters   every parameter with its value, range, unit and group
    GET  /TOKEN/picture.png  the picture; ?size=WxH draws it at a size, ?width=N scales it down
    POST /TOKEN/do           {"set": {path: value}, "reset": path, "time": s, "playing": false,
                              "speed": 1, "preset": name, "undo": true, "redo": true}
    GET  /TOKEN/events       a WebSocket: events as JSON; takes what /do takes;
                              with an "id", each is answered

Nothing here draws or touches the session: each request becomes a call (see ``Calls``) and is
answered when the window has done it. What a client sends is bounded in size and in how much of it
may wait, so that a stream of values slows its sender and not the window; what a slow reader has
not received yet is bounded as well: of each value only the last.
"""

from __future__ import annotations

import asyncio
import json
import logging
import socket
import sys
import threading
from collections import deque
from collections.abc import Awaitable, Callable, Mapping
from importlib.resources import files
from typing import Any

from aiohttp import WSMsgType, web

from playground.data.image_files import encode_png
from playground.engine.frame import Frame
from playground.errors import DataError, ParameterError, PlaygroundError
from playground.json_text import read_json
from playground.local_server import BACKLOG, HEADERS, MAX_SILENCE, Guard, Unauthenticated
from playground.studio.remote.controls import MAX_REMOTE_SIDE, Busy, Calls, Controls, PictureNotReady

MAX_REQUEST_BYTES = 2**16
"""[bytes] of a request's body, or of one message."""
MAX_CLIENTS = 8
"""WebSockets at a time."""
MAX_CONNECTIONS = 64
"""Connections at a time that have shown the token; see ``local_server`` for others."""
MAX_REQUESTS = 32
"""Requests by HTTP that are being answered at a time."""
IN_FLIGHT = 100
"""Messages of one client that may wait for the window; more are not read until then."""
PATIENCE = 20.0
"""[s] for the window to answer a request by HTTP."""
_PAUSE = 0.1  # [s] between two looks at a window that computes frames

_BUNDLES = {"remote.js": "text/javascript", "remote.css": "text/css"}
_WANTED = 'expected a JSON object, as {"playing": false}'
_SILENT = logging.getLogger("playground.studio.remote")  # who asks gets the message; the terminal does not
_SILENT.setLevel(logging.CRITICAL + 1)
_Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class Server:
    """Listens from the beginning, answers from ``start`` to ``close``."""

    def __init__(self, port: int, token: str) -> None:
        """Listen on 127.0.0.1, on a free port where it is 0; raise ``DataError`` for one that is taken."""
        self.socket = _listening(port)
        self.guard = Guard(self.socket.getsockname()[1], token)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, name="the remote's server", daemon=True)
        self._clients: set[Client] = set()
        self._unauthenticated = Unauthenticated(self._force_close)
        self._authenticated: set[web.RequestHandler] = set()
        self._busy = 0  # requests that are being answered
        self._ended: asyncio.Event | None = None
        self._runner: web.AppRunner | None = None
        self._started = threading.Event()

    @property
    def url(self) -> str:
        """The address of the page, with the token."""
        return self.guard.url

    def start(self, calls: Calls, controls: Controls) -> None:
        """Answer from now on."""
        self._calls, self._controls = calls, controls
        self._thread.start()
        self._started.wait(10)

    def tell(self, events: list[dict[str, Any]]) -> None:
        """Send events to every client; may be called from any thread."""
        if self._clients and events:
            self._loop.call_soon_threadsafe(self._tell, events)

    def _tell(self, events: list[dict[str, Any]]) -> None:
        for client in self._clients:
            client.tell(events)

    def close(self) -> None:
        """Close all connections and the port."""
        if self._thread.is_alive() and self._ended is not None:
            self._loop.call_soon_threadsafe(self._ended.set)
            self._thread.join(5)
        self.socket.close()

    # ── the thread ───────────────────────────────────────────────────────────

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_until_complete(self._serve())
        finally:
            self._loop.close()

    async def _serve(self) -> None:
        self._ended, self._drawing = asyncio.Event(), asyncio.Lock()
        app = web.Application(middlewares=[self._guard], client_max_size=MAX_REQUEST_BYTES)
        app.router.add_get("/{token}/state", self._state)
        app.router.add_get("/{token}/parameters", self._parameters)
        app.router.add_get("/{token}/picture.png", self._picture)
        app.router.add_post("/{token}/do", self._do)
        app.router.add_get("/{token}/events", self._events)
        app.router.add_get("/{token}/{file:(remote\\.js|remote\\.css)?}", self._page)
        self._runner = web.AppRunner(
            app, access_log=None, logger=_SILENT, handle_signals=False, shutdown_timeout=0.5
        )
        await self._runner.setup()
        listener = await self._loop.create_server(self._connected, sock=self.socket, backlog=BACKLOG)
        self._started.set()
        await self._ended.wait()
        listener.close()
        for client in list(self._clients):
            await client.socket.close(code=1001, message=b"the window is closed")
        await self._runner.cleanup()

    def _connected(self) -> web.RequestHandler:
        """Return what serves a new connection, which is to show the token."""
        assert self._runner is not None and self._runner.server is not None
        made = self._runner.server()
        self._unauthenticated.add(made)
        self._loop.call_later(MAX_SILENCE, self._unauthenticated.expire)
        return made

    def _force_close(self, connection: web.RequestHandler) -> None:
        self._loop.call_soon(connection.force_close)  # after its transport is set

    @web.middleware
    async def _guard(self, request: web.Request, handler: _Handler) -> web.StreamResponse:
        """Refuse who may not ask, bound how many do, and turn every mistake into a message."""
        host, origin = request.headers.get("Host"), request.headers.get("Origin")
        if why := self.guard.refusal(host, origin, request.path):
            return _error(403, why)
        self._unauthenticated.discard(request.protocol)
        connections = self._runner.server.connections if self._runner and self._runner.server else []
        self._authenticated = {request.protocol, *self._authenticated.intersection(connections)}
        if len(self._authenticated) > MAX_CONNECTIONS or self._busy >= MAX_REQUESTS:
            return _error(503, "too many requests at a time")
        counts = not request.path.endswith("/events")
        self._busy += counts
        try:
            answer = await handler(request)
        except web.HTTPException as error:
            path = request.path.removeprefix(f"/{self.guard.token}")
            answer = _error(error.status, f"{error.reason}: {request.method} {path}")
        except (Busy, PictureNotReady) as error:
            answer = _error(503, str(error))
        except PlaygroundError as error:
            answer = _error(400, str(error))
        except TimeoutError:
            answer = _error(504, f"the window has not answered for {PATIENCE:g} s")
        except ConnectionError:  # who asked is gone
            raise
        except Exception as error:
            answer = _error(500, f"by a bug of the playground: {_sentence(error)}")
        finally:
            self._busy -= counts
        if not isinstance(answer, web.WebSocketResponse):
            answer.headers.update(HEADERS)
            answer.headers["Content-Security-Policy"] = _policy(self.guard.port)
        return answer

    async def _ask(self, function: Callable[[], Any]) -> Any:
        return await asyncio.wait_for(asyncio.wrap_future(self._calls.ask(function)), PATIENCE)

    async def _page(self, request: web.Request) -> web.Response:
        name = request.match_info["file"]
        kind = _BUNDLES.get(name, "text/html")
        text = files("playground.studio.remote").joinpath("page", name or "remote.html").read_text("utf-8")
        return web.Response(text=text, content_type=kind, charset="utf-8")

    async def _state(self, _: web.Request) -> web.Response:
        return _json(await self._ask(self._controls.state))

    async def _parameters(self, _: web.Request) -> web.Response:
        return _json(await self._ask(self._controls.parameters))

    async def _do(self, request: web.Request) -> web.Response:
        wishes = _object(await request.read())

        def act() -> dict[str, Any]:
            self._controls.do(wishes)
            return self._controls.state()

        return _json(await self._ask(act))

    async def _picture(self, request: web.Request) -> web.Response:
        size, width = _size(request.query.get("size", "")), _width(request.query.get("width", ""))
        async with self._drawing:  # one at a time
            frame = await self._frame(size)
            data = await asyncio.to_thread(_encoded, frame, width)
        return web.Response(body=data, content_type="image/png")

    async def _frame(self, size: tuple[int, int] | None) -> Frame:
        """Return the picture; wait for a while until the window has computed the frames before it."""
        clock = asyncio.get_running_loop().time
        end = clock() + PATIENCE
        while True:
            try:
                frame: Frame = await self._ask(lambda: self._controls.picture(size))
                return frame
            except PictureNotReady:
                if clock() > end:
                    raise
                await asyncio.sleep(_PAUSE)

    async def _events(self, request: web.Request) -> web.StreamResponse:
        if len(self._clients) >= MAX_CLIENTS:
            return _error(503, f"{MAX_CLIENTS} clients listen already")
        client = Client(web.WebSocketResponse(max_msg_size=MAX_REQUEST_BYTES, heartbeat=20.0))
        self._clients.add(client)
        try:
            await client.socket.prepare(request)
            client.tell([{"event": "state", **await self._ask(self._controls.state)}])
            sends = asyncio.create_task(client.send())
            try:
                async for message in client.socket:
                    if message.type is WSMsgType.TEXT:
                        await client.room.acquire()
                        self._begin(client, message.data)
                    elif message.type is WSMsgType.BINARY:
                        await client.socket.close(code=1003, message=b"expected JSON as text")
            finally:
                sends.cancel()
        finally:
            self._clients.discard(client)
        return client.socket

    def _begin(self, client: Client, text: str) -> None:
        """Ask for what a message says; its answer follows when the window has done it."""
        mark: object = None
        try:
            wishes = dict(_object(text))
            mark = wishes.pop("id", None)
            future = asyncio.wrap_future(self._calls.ask(lambda: self._controls.do(wishes)), loop=self._loop)
        except PlaygroundError as error:
            client.answer(mark, str(error))
            return

        def answer(done: asyncio.Future[Any]) -> None:
            error = None if done.cancelled() else done.exception()
            client.answer(mark, "" if error is None else _sentence(error))

        future.add_done_callback(answer)


class Client:
    """A WebSocket, and what it is still to receive."""

    def __init__(self, socket: web.WebSocketResponse) -> None:
        self.socket = socket
        self.room = asyncio.Semaphore(IN_FLIGHT)
        self._answers: deque[dict[str, Any]] = deque()  # as many as messages are in flight at most
        self.events: dict[str, dict[str, Any]] = {}  # the last of each kind
        self._news = asyncio.Event()

    def tell(self, events: list[dict[str, Any]]) -> None:
        """Have events sent; of those that wait, values are merged and others replaced."""
        for event in events:
            before = self.events.get(event["event"])
            if before is not None and "values" in event:
                event = {**event, "values": {**before["values"], **event["values"]}}
            self.events[event["event"]] = event
        self._news.set()

    def answer(self, mark: object, error: str) -> None:
        """Answer a message: if it has an ``id``, or was refused."""
        if mark is None and not error:
            self.room.release()
            return
        answer = {"error": error} if error else {"ok": True}
        self._answers.append(answer | ({"id": mark} if mark is not None else {}))
        self._news.set()

    async def send(self) -> None:
        """Send what there is, until it is cancelled or the socket is closed."""
        while not self.socket.closed:
            await self._news.wait()
            self._news.clear()
            events, self.events = self.events, {}
            try:
                for event in events.values():
                    await self.socket.send_str(json.dumps(event))
                while self._answers:
                    await self.socket.send_str(json.dumps(self._answers.popleft()))
                    self.room.release()
            except ConnectionError:
                return


def _policy(port: int) -> str:
    sockets = f"ws://127.0.0.1:{port} ws://localhost:{port}"
    own = f"script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self' {sockets}"
    return f"default-src 'none'; {own}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"


def _listening(port: int) -> socket.socket:
    made = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        if sys.platform != "win32":  # there it would let two programs have one port
            made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        made.bind(("127.0.0.1", port))
        made.listen(BACKLOG)
    except OSError as error:
        made.close()
        raise DataError(
            f"the remote cannot listen on port {port}: {error.strerror or error}; --remote 0 takes a free one"
        ) from None
    return made


def _object(text: str | bytes) -> Mapping[str, Any]:
    """Return the JSON object of a message; raise ``ParameterError``."""
    try:
        values = read_json(text, constant=_no_constant)
    except (ValueError, UnicodeDecodeError) as error:
        raise ParameterError(f"{_WANTED}: {error}") from None
    if not isinstance(values, dict):
        raise ParameterError(f"{_WANTED}; found {type(values).__name__}")
    return values


def _no_constant(text: str) -> Any:
    raise ValueError(f"{text} is no number")


def _size(text: str) -> tuple[int, int] | None:
    if not text:
        return None
    sides = [int(side) if side.isdecimal() and len(side) < 6 else 0 for side in text.lower().split("x")]
    if len(sides) != 2 or not all(1 <= side <= MAX_REMOTE_SIDE for side in sides):
        expected = f"expected width and height, 1 to {MAX_REMOTE_SIDE} pixels, as 640x360"
        raise ParameterError(f"size={text[:40]}: {expected}")
    return sides[0], sides[1]


def _width(text: str) -> int:
    if not text:
        return 0
    if not text.isdecimal() or len(text) > 5 or not 1 <= int(text) <= MAX_REMOTE_SIDE:
        raise ParameterError(f"width={text[:40]}: expected 1 to {MAX_REMOTE_SIDE} pixels, as 480")
    return int(text)


def _encoded(frame: Frame, width: int) -> bytes:
    """Return a picture as a PNG, no wider than ``width`` pixels where that is not 0."""
    if not 0 < width < frame.size[0]:
        return encode_png(frame.array)
    import numpy as np
    from PIL import Image

    height = max(round(frame.size[1] * width / frame.size[0]), 1)
    small = Image.fromarray(frame.array).resize((width, height), Image.Resampling.LANCZOS)
    return encode_png(np.asarray(small))


def _json(value: object) -> web.Response:
    return web.json_response(value)


def _error(status: int, message: str) -> web.Response:
    return web.json_response({"error": message}, status=status)


def _sentence(error: BaseException) -> str:
    return str(error) if isinstance(error, PlaygroundError) else f"{type(error).__name__}: {error}"
