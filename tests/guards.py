"""What a server of this machine refuses, over each of its routes."""

from __future__ import annotations

import http.client
import json
from typing import Any

from playground.local_server import LocalServer

GENEROUS = 60  # [s]
OTHERS = (
    ({}, "", "token"),
    ({}, "x" * 32, "token"),
    ({}, "%00", "token"),
    ({}, "..", "token"),
    ({}, "a" * 5000, "token"),
    ({"Host": "evil.example"}, None, "own machine"),
    ({"Host": "evil.example:{port}"}, None, "own machine"),
    ({"Host": "127.0.0.1"}, None, "own machine"),
    ({"Host": "127.0.0.1:1"}, None, "own machine"),
    ({"Host": "127.0.0.1.:{port}"}, None, "own machine"),
    ({"Host": ""}, None, "own machine"),
    ({"Origin": "http://evil.example"}, None, "origin"),
    ({"Origin": "null"}, None, "origin"),
    ({"Origin": "http://127.0.0.1.evil.example:{port}"}, None, "origin"),
    ({"Origin": "http://127.0.0.1:1"}, None, "origin"),
)
"""Headers and token (None: the right one) of requests that may not be, and a word of why.

With DNS rebinding the browser believes that it asks a foreign host, and reports it in ``Host``.
"""


def ask(
    server: LocalServer, method: str, path: str, body: Any = None, *, token: str | None = None, **headers: str
) -> tuple[int, str, dict[str, str]]:
    """Send a request below the token, or below another; return status, text and headers."""
    connection = http.client.HTTPConnection("127.0.0.1", server.guard.port, timeout=GENEROUS)
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    data = body if isinstance(body, bytes | None) else json.dumps(body).encode()
    whole = f"/{server.guard.token if token is None else token}/{path}"
    connection.request(method, whole, data, named)
    answer = connection.getresponse()
    read = answer.read()
    connection.close()
    text = read.decode("latin-1" if answer.headers["Content-Type"] == "image/png" else "utf-8")
    return answer.status, text, dict(answer.headers)


def assert_guarded(server: LocalServer) -> None:
    """Ask for each of a server's routes as those who may not; none is answered."""
    port = server.guard.port
    proof = {server.proof: server.guard.token} if server.proof else {}
    for route in server.routes:
        method, _, path = route.partition(" ")
        for headers, token, word in OTHERS:
            sent = proof | {name: value.format(port=port) for name, value in headers.items()}
            body = {} if method == "POST" else None
            status, text, _ = ask(server, method, path, body, token=token, **sent)
            assert status == 403 and word in text, (route, headers, token)
            assert text.count("\n") == 1 and server.guard.token not in text
