"""A server of this machine: who may ask, how much and for how long, and what is answered where."""

from __future__ import annotations

import http.client
import socket
import struct
import threading
from collections.abc import Iterator

import pytest

from playground import local_server
from playground.errors import DataError, ParameterError
from playground.local_server import (
    MAX_UNAUTHENTICATED,
    TEXT,
    Answer,
    Guard,
    LocalServer,
    Request,
    as_json,
    check_token,
    new_token,
)

from .crowds import crowd, wait_until_open
from .guards import GENEROUS, ask, assert_guarded

MAX_BYTES = 2**20


class Site:
    """Pages that answer, fail or wait."""

    def __init__(self) -> None:
        self.asked: list[bytes] = []
        self.begun, self.goes_on = threading.Semaphore(0), threading.Event()
        routes = {
            "GET ": lambda _: Answer(200, TEXT, b"page", "default-src 'self'"),
            "GET state": lambda request: as_json(dict(request.query)),
            "GET folder/": lambda request: Answer(200, TEXT, request.path.encode()),
            "GET slow": self.wait,
            "POST do": self.do,
            "POST done": lambda _: as_json({}, last=True),
        }
        self.server = LocalServer(routes, max_bytes=MAX_BYTES, proof="X-Proof")

    def wait(self, request: Request) -> Answer:
        self.begun.release()
        assert self.goes_on.wait(GENEROUS)
        return as_json({})

    def do(self, request: Request) -> Answer:
        self.asked.append(request.body)
        if errors := {b"1": ParameterError, b"2": ValueError, b"3": DataError, b"4": TimeoutError}.get(
            request.body
        ):
            raise errors("a message")
        return as_json({})


@pytest.fixture
def site() -> Iterator[Site]:
    made = Site()
    serving = threading.Thread(target=made.server.serve, daemon=True)
    serving.start()
    yield made
    made.server.end()
    serving.join(GENEROUS)
    assert not serving.is_alive()
    made.server.server_close()


# ── who may ask ──────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("port", "host", "origin", "path", "word"),
    [
        (8080, "127.0.0.1:8080", None, "/secret", ""),
        (8080, "LOCALHOST:8080", "http://127.0.0.1:8080", "/secret/state", ""),
        (80, "127.0.0.1", "http://localhost", "/secret/", ""),  # browsers leave the usual port out
        (8080, "127.0.0.1:8080", None, "/", "token"),
        (8080, "127.0.0.1:8080", None, "/secre\u0301t/", "token"),
        (8080, None, None, "/secret/", "Host"),
        (8080, "127.0.0.1", None, "/secret/", "Host"),
        (8080, "127.0.0.1:8081", None, "/secret/", "Host"),
        (8080, "evil.example:8080", None, "/secret/", "Host"),
        (8080, "127.0.0.1:8080.evil.example", None, "/secret/", "Host"),
        (8080, "127.0.0.1:8080", "null", "/secret/", "origin"),
        (8080, "127.0.0.1:8080", "http://evil.example", "/secret/", "origin"),
        (8080, "127.0.0.1:8080", "https://127.0.0.1:8080", "/secret/", "origin"),
        (8080, "127.0.0.1:8080", "http://127.0.0.1:8081", "/secret/", "origin"),
    ],
)
def test_only_this_machine_with_the_token_may_ask(port, host, origin, path, word):
    why = Guard(port, "secret").refusal(host, origin, path)
    assert word in why and bool(word) == bool(why)


def test_tokens_are_random_and_long_unless_they_are_given():
    made = {new_token() for _ in range(50)}
    assert len(made) == 50 and all(check_token(token) == token and len(token) >= 32 for token in made)
    for token in ("", "short", "a" * 129, "with spaces in the text", "a/../../../../b/c/d"):
        with pytest.raises(ParameterError, match="16 to 128"):
            check_token(token)


def test_each_route_is_guarded(site: Site):
    assert_guarded(site.server)
    assert site.asked == []


def test_nearly_its_token_is_not_its_token(site: Site):
    token = site.server.guard.token
    for wrong in (token[:-1], token + "x", token.swapcase(), token[:-1] + ("a" if token[-1] != "a" else "b")):
        assert ask(site.server, "GET", "state", token=wrong)[0] == 403
    assert ask(site.server, "GET", "state")[0] == 200


def test_who_asks_is_looked_at_before_the_body_is_waited_for(site: Site):
    port, token = site.server.guard.port, site.server.guard.token
    promised = "Content-Length: 100000\r\n\r\n"  # of which nothing comes
    for path, host, more in (
        ("/wrong/do", f"127.0.0.1:{port}", f"X-Proof: {token}\r\n"),
        (f"/{token}/do", "evil.example", f"X-Proof: {token}\r\n"),
        (f"/{token}/do", f"127.0.0.1:{port}", "X-Proof: wrong\r\n"),
        (f"/{token}/do", f"127.0.0.1:{port}", f"X-Proof: {token}\r\nOrigin: http://evil.example\r\n"),
    ):
        head = f"POST {path} HTTP/1.1\r\nHost: {host}\r\n{more}{promised}"
        assert sent(site, head).startswith(b"HTTP/1.1 403 ")


# ── how much, and for how long ───────────────────────────────────────────────


def test_a_silent_crowd_is_bounded_and_closed(site: Site, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(local_server, "MAX_SILENCE", 0.5)
    kept = http.client.HTTPConnection("127.0.0.1", site.server.guard.port, timeout=20)
    kept.request("GET", f"/{site.server.guard.token}/state")
    kept.getresponse().read()
    with crowd(site.server.guard.port) as strangers:
        assert ask(site.server, "GET", "state")[0] == 200
        assert 0 < wait_until_open(strangers, MAX_UNAUTHENTICATED) <= 16
        assert wait_until_open(strangers, 0) == 0
    kept.request("GET", f"/{site.server.guard.token}/state")  # the same connection: it has shown the token
    assert kept.getresponse().status == 200
    kept.close()


def test_more_requests_at_a_time_than_may_be_are_refused(site: Site):
    answers: list[int] = []
    waiting = [
        threading.Thread(target=lambda: answers.append(ask(site.server, "GET", "slow")[0])) for _ in range(16)
    ]
    for each in waiting:
        each.start()
        assert site.begun.acquire(timeout=GENEROUS)
    assert ask(site.server, "GET", "slow")[0] == 503
    site.goes_on.set()
    for each in waiting:
        each.join(GENEROUS)
    assert answers == [200] * 16
    assert ask(site.server, "GET", "slow")[0] == 200


@pytest.mark.parametrize(
    "line",
    [
        "",
        "Content-Length: x\r\n",
        f"Content-Length: {MAX_BYTES + 1}\r\n",
        f"Content-Length: {2**40}\r\n",
        f"Content-Length: {'9' * 5000}\r\n",
        "Transfer-Encoding: chunked\r\n",
    ],
)
def test_a_request_without_length_or_too_long_is_refused(site: Site, line: str):
    guard = site.server.guard
    head = f"POST /{guard.token}/do HTTP/1.1\r\nHost: 127.0.0.1:{guard.port}\r\nX-Proof: {guard.token}\r\n"
    assert sent(site, f"{head}{line}\r\n").startswith(b"HTTP/1.1 413 "), "and the connection is closed"


def test_a_connection_that_breaks_says_nothing(site: Site, capfd: pytest.CaptureFixture[str]):
    linger = struct.pack("ii", 1, 0)  # closing resets the connection
    guard = site.server.guard
    head = f"Host: 127.0.0.1:{guard.port}\r\nX-Proof: {guard.token}\r\n"
    for request in (
        f"GET /{guard.token}/ HTTP/1.1\r\n{head}\r\n",
        f"POST /{guard.token}/do HTTP/1.1\r\n{head}Content-Length: 500\r\n\r\n{{",
        f"POST /{guard.token}/do HTTP/1.1\r\n{head}",
    ):
        for _ in range(5):
            with socket.create_connection(("127.0.0.1", guard.port), timeout=GENEROUS) as connection:
                connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, linger)
                connection.sendall(request.encode())
    assert ask(site.server, "GET", "")[0] == 200 and site.asked == []
    assert capfd.readouterr().err == ""


# ── what is answered ─────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("path", "status", "text"),
    [
        ("", 200, "page"),
        ("state?since=4&x", 200, '{"since": "4"}'),
        ("folder/a/b.png?x", 200, "a/b.png"),
        ("folder/", 200, ""),
        ("folder", 404, "there is no such page\n"),
        ("state/", 404, "there is no such page\n"),
        ("do", 404, "there is no such page\n"),  # nothing changes by a GET
        ("../state", 404, "there is no such page\n"),
    ],
)
def test_a_route_answers_its_path_and_a_folder_all_below_it(site: Site, path: str, status: int, text: str):
    assert ask(site.server, "GET", path)[:2] == (status, text)


@pytest.mark.parametrize(
    ("body", "status"), [(b"0", 200), (b"1", 400), (b"2", 400), (b"3", 500), (b"4", 504)]
)
def test_a_mistake_is_answered_in_a_message(site: Site, body: bytes, status: int):
    found, text, _ = ask(site.server, "POST", "do", body, X_Proof=site.server.guard.token)
    assert (found, text) == (status, "{}" if status == 200 else "a message\n")


@pytest.mark.parametrize("method", ["OPTIONS", "PUT", "DELETE", "PATCH", "HEAD", "TRACE"])
def test_other_methods_are_not_known(site: Site, method: str):
    status, _, headers = ask(site.server, method, "state")
    assert status == 501
    assert not [name for name in headers if name.lower().startswith("access-control")]


def sent(site: Site, text: str) -> bytes:
    """Send a request as it is, without a body; return the answer up to its end."""
    with socket.create_connection(("127.0.0.1", site.server.guard.port), timeout=GENEROUS) as connection:
        connection.sendall(text.encode())
        answer = b""
        while more := connection.recv(4096):
            answer += more
    return answer
