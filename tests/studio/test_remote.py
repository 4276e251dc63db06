"""Remotes by HTTP and WebSocket: who may ask, what is answered, and that nothing is lost in a flood."""

from __future__ import annotations

import asyncio
import io
import itertools
import json
import random
import re
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from pathlib import Path
from typing import Any

import aiohttp
import numpy as np
import pytest
from PIL import Image

from playground import cli
from playground.engine.engine import Engine
from playground.errors import ContextError, DataError, ParameterError, PlaygroundError
from playground.extras import install_command
from playground.local_server import MAX_UNAUTHENTICATED
from playground.shader.parameter import coerce, part_names
from playground.shader.widgets import Widget
from playground.sketch.assign import range_of
from playground.sketch.model import Parameter, Value
from playground.studio.panel.values import check_range, value_fraction, with_fraction
from playground.studio.remote.controllers import read_bindings
from playground.studio.remote.controls import MAX_WAITING, Busy, Calls, Controls, PictureNotReady
from playground.studio.remote.osc import Addresses
from playground.studio.remote.remotes import RemoteOptions, Remotes

from ..crowds import crowd, wait_until_open
from ..docs.pages import DOCS, Block, blocks_of
from .remote_desk import KERNEL, SIZE, TOKEN, Harness, write_sketch


def fetched(url: str, body: Any = None, **headers: str) -> tuple[int, bytes]:
    """Return the status and the body of one request."""

    async def go() -> tuple[int, bytes]:
        async with aiohttp.ClientSession() as client:
            data = body if isinstance(body, bytes | None) else json.dumps(body).encode()
            method = "GET" if body is None else "POST"
            async with client.request(method, url, data=data, headers=headers) as answer:
                return answer.status, await answer.read()

    return asyncio.run(go())


def opened(remote: Harness) -> str:
    server = remote.open(port=0, token=TOKEN).server
    return server.url


def get(remote: Harness, path: str) -> Any:
    status, text = remote.during(lambda: fetched(remote.remotes.server.url + path))
    assert status == 200, text
    return json.loads(text)


def do(remote: Harness, **wishes: Any) -> Any:
    status, text = remote.during(lambda: fetched(remote.remotes.server.url + "do", wishes))
    answer = json.loads(text)
    assert (status == 200) == ("error" not in answer)
    return answer


# ── who may ask ──────────────────────────────────────────────────────────────


def test_requests_that_may_not_ask_are_refused_and_do_nothing(remote: Harness):
    url = opened(remote)
    bare = url.removesuffix(f"{TOKEN}/")
    body = {"set": {"height.level": 0.9}}
    wishes = json.dumps(body).encode()
    refused: list[Callable[[], tuple[int, bytes]]] = [
        lambda: fetched(bare),
        lambda: fetched(f"{bare}state"),
        lambda: fetched(f"{bare}wrong-token-of-a-test/do", wishes),
        lambda: fetched(f"{bare}do", wishes),
        lambda: fetched(f"{url}do", wishes, Host="evil.example"),
        lambda: fetched(f"{url}do", wishes, Origin="http://evil.example"),
    ]
    for request in refused:
        status, text = remote.during(request)
        assert status == 403 and json.loads(text)["error"].count("\n") == 0
    assert remote.value("height.level") == 0.25

    def handshake() -> int:
        async def go() -> int:
            async with aiohttp.ClientSession() as client:
                with pytest.raises(aiohttp.WSServerHandshakeError) as caught:
                    await client.ws_connect(f"{url}events", origin="http://evil.example")
                return int(caught.value.status)

        return asyncio.run(go())

    assert remote.during(handshake) == 403


def test_it_listens_on_this_machine_alone(remote: Harness):
    opened(remote)
    server = remote.remotes.server
    assert server is not None and server.socket.getsockname()[0] == "127.0.0.1"


# ── what is answered ─────────────────────────────────────────────────────────


def test_parameters_are_listed_with_range_unit_and_group(remote: Harness):
    opened(remote)
    result = {item["path"]: item for item in get(remote, "parameters")}
    level = result["height.level"]
    assert (level["low"], level["high"], level["value"], level["group"]) == (0.0, 1.0, 0.25, "Shape")
    assert level["description"] == "How high" and level["pass"] == "height" and not level["changed"]
    assert result["height.scale"]["unit"] == "m" and result["height.scale"]["widget"] == "log_slider"
    assert result["height.kind"]["value"] == "round" and result["height.kind"]["choices"][-1] == "flat"
    assert result["height.sun"]["parts"] == ["azimuth", "elevation"]
    assert result["height.rocks"]["value"] is True and result["height.free"]["low"] is None
    assert result["height.tint"]["parts"] == ["r", "g", "b"]


def test_each_value_that_is_listed_can_be_set_again(remote: Harness):
    opened(remote)
    before = get(remote, "parameters")
    for key in ("value", "text"):
        values = {item["path"]: item[key] for item in before}
        assert "error" not in do(remote, set=values)
        assert [item["value"] for item in get(remote, "parameters")] == [item["value"] for item in before]


def test_values_are_set_with_the_checks_and_sentences_of_set(remote: Harness):
    opened(remote)
    good = {"height.level": 0.5, "height.sun": [90, 10], "height.kind": "sharp", "height.tint": "#ffffff"}
    do(remote, set=good)
    assert remote.value("height.level") == 0.5 and remote.value("height.sun") == (90.0, 10.0)
    assert remote.value("height.kind") == 1 and remote.value("height.tint") == (1.0, 1.0, 1.0)
    wrong = {"height.level": 2, "height.levle": 0.5, "height.kind": "shrp", "height.sun": "x", "size": -1}
    for path, value in wrong.items():
        with pytest.raises(ParameterError) as caught:
            remote.session.sketch.with_values({path: value})
        assert do(remote, set={"height.count": 7, path: value})["error"] == str(caught.value)
    assert remote.value("height.count") == 3, "all or none"
    assert "own folder" in do(remote, set={"height.grass": "/etc/passwd"})["error"]
    assert "own folder" in do(remote, set={"height.grass": "../../x.png"})["error"]
    remote.session.drafts.lock("height.level", True)
    assert "locked" in do(remote, set={"height.level": 0.1})["error"]
    assert "locked" in do(remote, reset="height.level")["error"]


def test_a_button_is_pressed_once_and_sets_nothing(remote: Harness):
    opened(remote)
    pressed = remote.pressed()
    do(remote, set={"height.fire": True, "height.level": 0.5})
    assert pressed == ["height.fire"] and remote.value("height.fire") is False
    do(remote, set={"height.fire": False})
    assert pressed == ["height.fire"] and remote.value("height.level") == 0.5
    ranges = {item["path"]: item["ranges"] for item in get(remote, "parameters")}
    assert ranges["height.place"] == [[-1, 1], [0, 10]] and ranges["height.sun"] == [[0, 360], [0, 90]]
    assert ranges["height.free"] == [None]


def test_what_a_remote_sets_is_a_step_that_can_be_undone(remote: Harness):
    opened(remote)
    assert do(remote, set={"height.level": 0.5})["can_undo"]
    do(remote, set={"height.count": 9})
    assert len(remote.bench.undo.history.steps) == 2
    assert do(remote, undo=True)["can_redo"] and remote.value("height.count") == 3
    remote.bench.undo.undo()  # by a key of the window
    assert remote.value("height.level") == 0.25
    do(remote, redo=True)
    assert remote.value("height.level") == 0.5
    do(remote, reset=["height.level"])
    assert remote.value("height.level") == 0.25


def test_time_and_presets(remote: Harness):
    opened(remote)
    state = do(remote, time=2.5, playing=False, speed=2.0)
    assert (state["time"], state["playing"], state["speed"]) == (2.5, False, 2.0)
    assert state["moves"] and state["presets"] == ["high"]
    do(remote, preset="high")
    assert remote.value("height.level") == 0.75 and remote.value("height.kind") == 2
    do(remote, undo=True)
    assert remote.value("height.level") == 0.25, "a preset is one step"
    assert "did you mean 'high'?" in do(remote, preset="hihg")["error"]
    assert "from 0 to" in do(remote, time=-1)["error"] and "from 0 to" in do(remote, time="now")["error"]
    assert "true or false" in do(remote, playing=1)["error"]
    assert "did you mean 'speed'?" in do(remote, sped=1)["error"]


def test_the_picture_is_the_windows_or_one_of_a_size(remote: Harness):
    opened(remote)

    def picture(query: str = "") -> Any:
        status, data = remote.during(lambda: fetched(f"{remote.remotes.server.url}picture.png{query}"))  # type: ignore
        return np.asarray(Image.open(io.BytesIO(data))) if status == 200 else json.loads(data)["error"]

    own = remote.session.read()
    np.testing.assert_array_equal(picture(), own.array)
    assert picture("?width=24").shape[:2] == (SIZE[1] // 2, 24)
    assert picture("?width=4000").shape[:2] == SIZE[::-1], "it is not enlarged"
    drawn = picture("?size=64x40")
    sketch, now = remote.session.sketch, remote.session.clock.time
    expected = remote.session.engine.render(sketch, size=(64, 40), time=now).array
    np.testing.assert_array_equal(drawn, expected)
    np.testing.assert_array_equal(picture(), own.array)
    for query in ("?size=0x9", "?size=9", "?size=5000x5000", "?width=-1", "?width=a", "?size=axb"):
        assert "expected" in picture(query)


@pytest.mark.slow
def test_picture_waits_for_earlier_frames_without_blocking(
    remote: Harness, monkeypatch: pytest.MonkeyPatch
) -> None:
    url = opened(remote)
    left = 3  # frames of the window in which it is behind
    frame, read = remote.session.frame, remote.session.read

    def slow(size: tuple[int, int]) -> Any:
        nonlocal left
        texture, left = frame(size), left - 1
        remote.session.catch_up.behind = (5, 36_001) if left > 0 else None
        return texture

    def in_time() -> Any:
        assert left <= 0, "all frames are computed between two of the window"
        return read()

    monkeypatch.setattr(remote.session, "frame", slow)
    monkeypatch.setattr(remote.session, "read", in_time)
    remote.frame()
    assert remote.during(lambda: fetched(f"{url}picture.png"))[0] == 200
    assert left <= 0

    monkeypatch.setattr("playground.studio.remote.server.PATIENCE", 0.5)
    left = 10**9
    remote.frame()
    status, data = remote.during(lambda: fetched(f"{url}picture.png?size=8x8"))
    assert status == 503 and "frame 5 of 36,001" in json.loads(data)["error"]


def test_what_is_no_request_of_it_is_answered_in_a_sentence(remote: Harness):
    url = opened(remote)
    for path, body, status in (
        ("nothing", None, 404),
        ("do", b"{", 400),
        ("do", b"[1]", 400),
        ("do", b'{"time": NaN}', 400),
        ("do", b"[" * 5000, 400),
        ("do", b"\xff\xfe", 400),
        ("do", b'{"set": 3}', 400),
        ("do", b'{"set": {"height.level": {"a": 1}}}', 400),
        ("do", b'"' + b"a" * 100_000 + b'"', 413),
        ("state", b"{}", 405),
    ):
        result, text = remote.during(lambda path=path, body=body: fetched(url + path, body))
        assert result == status and json.loads(text)["error"], (path, body, text)
    assert remote.value("height.level") == 0.25


def test_the_page_is_served_and_loads_nothing_from_elsewhere(remote: Harness):
    url = opened(remote)

    def page() -> tuple[str, str, str]:
        async def go() -> tuple[str, str, str]:
            async with aiohttp.ClientSession() as client, client.get(url) as answer:
                text, policy = await answer.text(), answer.headers["Content-Security-Policy"]
                async with client.get(f"{url}remote.js") as script:
                    return text, policy, await script.text()

        return asyncio.run(go())

    text, policy, script = remote.during(page)
    assert '<script src="remote.js"' in text and "default-src 'none'" in policy
    assert set(re.findall(r"https?:[^\"'`]*", text + script)) <= {"http://www.w3.org/2000/svg"}  # a name
    assert TOKEN not in text + script


# ── events, and floods ───────────────────────────────────────────────────────


async def until(client: aiohttp.ClientWebSocketResponse, kind: str) -> dict[str, Any]:
    while True:
        message = json.loads((await client.receive(timeout=20)).data)
        if kind in (message.get("event"), *message):
            return dict(message)


async def both(client: aiohttp.ClientWebSocketResponse, *kinds: str) -> list[dict[str, Any]]:
    """Return a message of each of two kinds, whichever comes first."""
    values: dict[str, dict[str, Any]] = {}
    while len(values) < 2:
        message = json.loads((await client.receive(timeout=20)).data)
        values |= {kind: message for kind in kinds if kind in (message.get("event"), *message)}
    return [values[kind] for kind in kinds]


def test_events_tell_of_values_saves_and_errors(remote: Harness, tmp_path: Path):
    url = opened(remote)
    file = tmp_path / "hills" / "hills.glsl"

    def listen() -> list[dict[str, Any]]:
        async def go() -> list[dict[str, Any]]:
            async with aiohttp.ClientSession() as client, client.ws_connect(f"{url}events") as events:
                values = [await until(events, "state")]
                await events.send_str(json.dumps({"id": 7, "set": {"height.level": 0.5}}))
                values += await both(events, "values", "ok")
                await events.send_str(json.dumps({"set": {"height.level": 5}}))
                values.append(await until(events, "error"))
                await events.send_str(json.dumps({"playing": False}))
                values.append(await until(events, "time"))
                file.write_text(KERNEL.replace("level *", "level + nothing *"), encoding="utf-8")
                remote.remotes.calls.ask(remote.session.drafts.reload)
                values.append(await until(events, "errors"))
                file.write_text(KERNEL.replace("level *", "0.5 * level *"), encoding="utf-8")
                remote.remotes.calls.ask(remote.session.drafts.reload)
                values += await both(events, "reloaded", "errors")
                return values

        return asyncio.run(go())

    state, values, ok, refused, paused, wrong, reloaded, fixed = remote.during(listen)
    assert state["title"] == "Hills" and values["values"] == {"height.level": 0.5}
    assert ok == {"ok": True, "id": 7} and "outside its range 0 to 1" in refused["error"]
    assert paused["playing"] is False
    assert wrong["errors"][0]["file"].endswith("hills.glsl") and "nothing" in wrong["errors"][0]["message"]
    assert reloaded["milliseconds"] > 0 and fixed["errors"] == []


@pytest.mark.slow
def test_ten_thousand_values_lose_neither_the_last_nor_an_error(remote: Harness):
    url = opened(remote)
    count, frames = 10_000, 0
    draw = remote.frame

    def counting() -> None:
        nonlocal frames
        frames += 1
        draw()

    remote.frame = counting  # type: ignore

    def flood() -> list[str]:
        async def go() -> list[str]:
            refused = []
            async with aiohttp.ClientSession() as client, client.ws_connect(f"{url}events") as events:
                for n in range(count):
                    await events.send_str(json.dumps({"set": {"height.level": n / count}}))
                await events.send_str(json.dumps({"set": {"height.count": 99}}))
                await events.send_str(json.dumps({"id": "last", "set": {"height.level": 0.875}}))
                while True:
                    message = json.loads((await events.receive(timeout=30)).data)
                    refused += [message["error"]] if "error" in message else []
                    if message.get("id") == "last":
                        return refused

        return asyncio.run(go())

    refused = remote.during(flood)
    remote.frame()
    assert remote.value("height.level") == 0.875 and remote.value("height.count") == 3
    assert len(refused) == 1 and "height.count" in refused[0]
    assert frames > 20, "frames went on meanwhile"
    assert remote.bench.undo.history.steps[-1].after == {("value", "height.level"): 0.875}


def test_a_reader_that_does_not_read_costs_no_memory(remote: Harness):
    from playground.studio.remote.server import IN_FLIGHT, Client

    class Socket:
        closed = False

    async def go() -> Client:
        client = Client(Socket())  # type: ignore
        for n in range(5000):
            client.tell(
                [{"event": "values", "values": {"a": n, f"b{n % 3}": n}}, {"event": "time", "time": n}]
            )
        for _ in range(IN_FLIGHT):
            await asyncio.wait_for(client.room.acquire(), 1)
        assert client.room.locked()
        return client

    client = asyncio.run(go())
    assert len(client.events) == 2 and client.events["time"]["time"] == 4999
    assert client.events["values"]["values"] == {"a": 4999, "b0": 4998, "b1": 4999, "b2": 4997}


def test_more_clients_than_may_listen_are_refused(remote: Harness):
    from playground.studio.remote.server import MAX_CLIENTS

    url = opened(remote)

    def crowd() -> int:
        async def go() -> int:
            async with aiohttp.ClientSession() as client:
                open_ones = [await client.ws_connect(f"{url}events") for _ in range(MAX_CLIENTS)]
                with pytest.raises(aiohttp.WSServerHandshakeError) as caught:
                    await client.ws_connect(f"{url}events")
                assert not any(item.closed for item in open_ones)
                for item in open_ones:
                    await item.close()
                return int(caught.value.status)

        return asyncio.run(go())

    assert remote.during(crowd) == 503


def test_a_silent_crowd_does_not_lock_the_owner_out(remote: Harness, monkeypatch: pytest.MonkeyPatch):
    for module in ("studio.remote.server", "local_server"):
        monkeypatch.setattr(f"playground.{module}.MAX_SILENCE", 0.5)
    url = opened(remote)

    def listens() -> None:
        async def go() -> None:
            async with aiohttp.ClientSession() as client, client.ws_connect(f"{url}events") as events:
                await until(events, "state")
                with crowd(remote.remotes.server.guard.port) as strangers:
                    async with client.get(f"{url}state") as answer:
                        assert answer.status == 200
                    assert await asyncio.to_thread(wait_until_open, strangers, MAX_UNAUTHENTICATED) > 0
                    assert (await asyncio.to_thread(fetched, f"{url}state"))[0] == 200
                    assert await asyncio.to_thread(wait_until_open, strangers, 0) == 0
                await events.send_json({"id": 1, "set": {"height.level": 0.5}})
                assert (await until(events, "values"))["values"] == {"height.level": 0.5}

        asyncio.run(go())

    remote.during(listens)


def test_calls_are_bounded_run_in_order_and_refused_once_closed():
    calls, done = Calls(), list[int]()
    futures = [calls.ask(lambda n=n: done.append(n)) for n in range(MAX_WAITING)]
    with pytest.raises(Busy, match="wait for the window"):
        calls.ask(lambda: None)
    calls.run(0.0)
    assert done == [0], "at least one in each frame, and no more than the budget allows"
    while calls.run():
        pass
    assert done == list(range(MAX_WAITING)) and all(future.done() for future in futures)
    late = calls.ask(lambda: None)
    calls.close()
    assert isinstance(late.exception(), Busy)
    with pytest.raises(Busy, match="closed"):
        calls.ask(lambda: None)


# ── opening and closing ──────────────────────────────────────────────────────


def test_a_port_that_is_taken_is_one_sentence(capfd: pytest.CaptureFixture[str]):
    with closing(socket.socket()) as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        with pytest.raises(DataError) as caught:
            Remotes(RemoteOptions(port=port))
    assert f"port {port}" in str(caught.value) and "--remote 0" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_package_is_one_sentence(monkeypatch: pytest.MonkeyPatch):
    import sys

    monkeypatch.delitem(sys.modules, "playground.studio.remote.server", raising=False)
    monkeypatch.setitem(sys.modules, "aiohttp", None)
    with pytest.raises(ContextError) as caught:
        Remotes(RemoteOptions(port=0))
    assert str(caught.value).endswith(install_command("remote"))


@pytest.mark.parametrize(
    "words",
    [["--remote", "70000"], ["--remote", "0", "--token", "short"], ["--token", "long-enough-for-a-token"]],
)
def test_wrong_options_are_one_sentence(words: list[str], capfd: pytest.CaptureFixture[str]):
    assert cli.main(["live", *words]) == 2
    complaint = capfd.readouterr().err
    assert complaint.startswith("error: ") and complaint.count("\n") == 1


def test_closing_frees_the_port_and_ends_the_thread(remote: Harness):
    server = remote.open(port=0).server
    remote.remotes.close()
    assert remote.threads() == set()
    with closing(socket.socket()) as again:
        again.bind(("127.0.0.1", server.guard.port))


def test_importing_the_playground_imports_no_server():
    import subprocess
    import sys

    code = (
        "import playground, playground.studio.remote.remotes, sys;"
        "print(sorted({'aiohttp', 'mido', 'pythonosc'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_closing_ends_open_sockets_and_requests_that_wait(remote: Harness):
    import threading
    import time

    url = opened(remote)
    closed: list[object] = []
    listening = threading.Event()

    def listen() -> None:
        async def go() -> None:
            async with aiohttp.ClientSession() as client, client.ws_connect(f"{url}events") as events:
                await until(events, "state")
                listening.set()
                async for _ in events:
                    pass
                closed.append(events.close_code)

        asyncio.run(go())

    def ask() -> None:
        closed.append(fetched(f"{url}state")[0])

    listener = threading.Thread(target=listen, daemon=True)
    listener.start()
    remote.until(listening.is_set)
    asker = threading.Thread(target=ask, daemon=True)
    asker.start()
    while not remote.remotes.calls:
        time.sleep(0.001)
    start = time.monotonic()
    remote.remotes.close()
    listener.join(5)
    asker.join(5)
    assert remote.threads() == set() and time.monotonic() - start < 4
    assert set(closed) == {1001, 503}


def test_bytes_that_are_no_http_and_bugs_print_nothing(
    remote: Harness,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    caplog: pytest.LogCaptureFixture,
):
    url = opened(remote)
    server = remote.remotes.server
    for data in (b"\xff" * 200, b"GET / HTTP/9.9\r\n\r\n", b"GET " + b"a" * 100_000 + b" HTTP/1.1\r\n\r\n"):
        with closing(socket.create_connection(("127.0.0.1", server.guard.port))) as other:
            other.sendall(data)
            other.settimeout(5)
            with suppress(ConnectionError):
                while other.recv(4096):
                    pass

    def fails(*_: object) -> None:
        raise ZeroDivisionError("as a bug would")

    monkeypatch.setattr(Controls, "state", fails)
    status, text = remote.during(lambda: fetched(f"{url}state"))
    assert status == 500 and "ZeroDivisionError" in json.loads(text)["error"]
    assert capfd.readouterr() == ("", "") and caplog.records == []


# ── controls hostile ──────────────────────────────────────────────────────────


PATHS = [
    "height.level",
    "height.sun",
    "height.kind",
    "height.rocks",
    "height.tint",
    "height.grass",
    "height.fire",
]
PATHS += [
    "relief",
    "extent",
    "height",
    "",
    ".",
    "height.",
    "..",
    "height.level.x",
    "no.such",
    "view.lowest",
    "x" * 999,
]


@pytest.fixture
def harness(tmp_path: Path, any_engine: Engine) -> Iterator[Harness]:
    made = Harness(any_engine, write_sketch(tmp_path / "hills"))
    yield made
    made.close()


def anything(chance: random.Random, depth: int = 0) -> Any:
    """Return a value as JSON may hold one."""
    simple = [
        None,
        True,
        False,
        0,
        1,
        -1,
        10**30,
        0.5,
        1e308,
        float("inf"),
        "",
        "0.5",
        "flat",
        "#12",
        "1,2",
        "\0",
        "😀",
    ]
    if depth > 2 or chance.random() < 0.6:
        return chance.choice(simple)
    if chance.random() < 0.5:
        return [anything(chance, depth + 1) for _ in range(chance.randrange(5))]
    return {chance.choice([*PATHS, "azimuth", "elevation"]): anything(chance, depth + 1) for _ in range(3)}


@pytest.mark.always
@pytest.mark.parametrize("seed", range(4))
def test_what_is_asked_by_chance_ends_in_a_sentence_at_worst(harness: Harness, seed: int):
    chance, controls = random.Random(seed), Controls(harness.bench)
    addresses = Addresses(controls)
    refused = 0
    for _ in range(400):
        name = chance.choice([*controls.names, "set", "set", "st"])
        value = anything(chance)
        if name == "set" and chance.random() < 0.8:
            value = {chance.choice(PATHS): anything(chance) for _ in range(chance.randrange(3))}
        try:
            controls.do({name: value})
        except PlaygroundError as error:
            refused += 1
            assert "\n" not in str(error) and len(str(error)) < 2000
        arguments = [anything(chance) for _ in range(chance.randrange(4))]
        words = chance.choice([*PATHS, "playground.time", "playground.preset", "playground.x"])
        addresses.receive("/" + words.replace(".", "/"), arguments)
    controls.reset("height.grass")  # it may name a file that is not there, as in the panel
    harness.frame()
    assert refused > 50 and harness.session.error is None and controls.parameters()


@pytest.mark.parametrize(
    ("source", "what"),
    [("", "computes frame 5 of 36,001"), ("height", "makes height, 5 of 36,001")],
)
def test_a_picture_that_is_not_there_yet_is_said_once(harness: Harness, source: str, what: str):
    harness.frame()
    harness.session.catch_up.behind, harness.session.catch_up.source = (5, 36_001), source
    with pytest.raises(PictureNotReady) as met:
        Controls(harness.bench).picture()
    assert str(met.value) == f"there is no picture yet: the window {what}"


# ── shares ────────────────────────────────────────────────────────────────────


SLIDER = Widget("slider", -2.0, 6.0)
ALL: list[tuple[Parameter, Value]] = [
    (Parameter("a", "float", 0.0, SLIDER), 1.0),
    (Parameter("a", "float", 0.0, SLIDER, step=0.5), 1.0),
    (Parameter("a", "float", 1.0, Widget("log_slider", 0.01, 100.0)), 1.0),
    (Parameter("a", "int", 0, Widget("slider", -3, 12)), 1),
    (Parameter("a", "uint", 0, Widget("slider", 0, 9999)), 1),
    (Parameter("a", "ivec2", (0, 0), Widget("slider", 0, 8)), (1, 2)),
    (Parameter("a", "vec3", (0.0,) * 3, SLIDER), (0.0, 1.0, 2.0)),
    (Parameter("a", "vec2", (0.0, 0.0), Widget("direction")), (135.0, 25.0)),
    (Parameter("a", "vec4", (0.0,) * 4, Widget("colour")), (0.5, 0.25, 0.125, 1.0)),
    (Parameter("a", "vec2", (0.0, 0.0), Widget("point", 0.0, 1.0)), (0.5, 0.5)),
    (Parameter("a", "vec2", (0.0, 2.0), Widget("point", axes=((-1.0, 1.0), (2.0, 9.0)))), (0.0, 3.0)),
    (Parameter("a", "vec3", (0.0,) * 3, Widget("colour", raw=True)), (0.5, 0.25, 0.125)),
    (Parameter("a", "float", 0.0, Widget("angle", -360.0, 360.0)), 0.0),
    (Parameter("a", "int", 0, Widget("menu", choices=("x", "y", "z"))), 1),
    (Parameter("a", "bool", False, Widget("checkbox")), False),
]


@pytest.mark.parametrize(("parameter", "value"), ALL, ids=lambda item: getattr(item, "type", ""))
def test_every_fraction_gives_valid_value_at_its_position(parameter: Parameter, value: Value):
    choices = len(parameter.widget.choices) or (2 if parameter.type == "bool" else 0)
    for part, step in itertools.product(range(len(part_names(parameter)) or 1), range(0, 128, 7)):
        share = step / 127
        made = with_fraction(parameter, value, share, part)
        assert coerce(parameter, made) == made
        assert type(made) is type(value) or parameter.type == "bool"
        back = value_fraction(parameter, made, part)
        ends = range_of(parameter, part) or (0.0, 1.0)
        whole = parameter.type.startswith(("i", "u"))
        grain = 1.0 if whole else parameter.step or 0.0
        allowed = 0.5 / choices + 1e-9 if choices else 0.5 * grain / (ends[1] - ends[0]) + 1e-4
        if parameter.type == "bool":
            allowed = 0.5
        assert abs(back - share) <= allowed, (share, made, back)
        if isinstance(value, tuple) and isinstance(made, tuple):
            assert [n for at, n in enumerate(made) if at != part] == [
                n for at, n in enumerate(value) if at != part
            ]


def test_the_ends_are_those_of_the_range():
    for parameter, value in ALL:
        if parameter.widget.kind in ("slider", "log_slider", "angle", "point"):
            low, high = range_of(parameter) or (0, 0)
            for share, end in ((0.0, low), (1.0, high), (-1.0, low), (2.0, high)):
                made = with_fraction(parameter, value, share)
                assert (made[0] if isinstance(made, tuple) else made) == end


def test_steps_are_counted_from_the_lower_end():
    parameter = Parameter("a", "float", 0.0, Widget("slider", 0.25, 1.25), step=0.5)
    assert {with_fraction(parameter, 0.25, n / 127) for n in range(128)} == {0.25, 0.75, 1.25}


def test_what_has_no_range_is_refused_in_a_sentence():
    check_range(ALL[0][0], "a")
    for parameter, why in (
        (Parameter("a", "float", 0.0), "no range"),
        (Parameter("a", "sampler2D", "", Widget("file")), "names a file"),
    ):
        with pytest.raises(ParameterError, match=why):
            check_range(parameter, "height.a")


# ── how to ────────────────────────────────────────────────────────────────────


PAGE = DOCS / "how-to" / "remotes.md"
SKETCH = """format = 1
size = 17
[[pass]]
name = "height"
use = "generation/white_noise"
[[pass]]
name = "light"
use = "lighting/l_dot_n"
[view]
use = "view/terrain"
set = { grid = 9 }
[[preset]]
name = "evening"
set = { "light.sun" = [250.0, 12.0] }
"""


@pytest.fixture
def how_to_harness(tmp_path: Path, any_engine: Engine) -> object:
    (tmp_path / "land").mkdir()
    (tmp_path / "land" / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    made = Harness(any_engine, tmp_path / "land")
    yield made
    made.close()


def block(language: str, holds: str) -> Block:
    (result,) = [b for b in blocks_of(PAGE) if b.language == language and holds in b.text]
    return result


def runs(how_to_harness: Harness, text: str, folder: Path, *words: str) -> str:
    command = [sys.executable, "-W", "error", "-c", text, *words]

    def run() -> subprocess.CompletedProcess[str]:
        return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60)

    done = how_to_harness.during(run)
    assert done.returncode == 0, done.stderr
    return str(done.stdout)


def test_the_script_by_http(how_to_harness: Harness, tmp_path: Path) -> None:
    server = how_to_harness.open(port=0).server
    printed = runs(how_to_harness, block("python", "urlopen").text, tmp_path, server.url)
    assert how_to_harness.value("light.sun") == (250.0, 12.0) and "light.sun 250,12" in printed
    with Image.open(tmp_path / "evening.png") as picture:
        assert picture.size == (640, 360)


def test_the_script_by_websocket(how_to_harness: Harness, tmp_path: Path) -> None:
    server = how_to_harness.open(port=0).server
    before = how_to_harness.value("light.sun")
    printed = runs(how_to_harness, block("python", "aiohttp").text, tmp_path, server.url)
    events = [json.loads(line) for line in printed.splitlines()]
    assert events[0]["event"] == "state" and events[-1] == {"ok": True, "id": "done"}
    assert how_to_harness.value("light.sun") == before, "the stream of values is one step, undone at the end"


def test_the_script_by_osc(how_to_harness: Harness, tmp_path: Path) -> None:
    osc = how_to_harness.open(osc=("127.0.0.1", 0)).osc
    assert osc is not None and osc.source is not None
    text = block("python", "SimpleUDPClient").text.replace("9000", str(osc.source[1]))
    runs(how_to_harness, text, tmp_path)
    how_to_harness.until(lambda: how_to_harness.value("light.sun") == (250.0, 12.0))


def test_what_to_do_and_the_controllers_are_as_shown(how_to_harness: Harness, tmp_path: Path) -> None:
    how_to_harness.open(port=0)
    wishes = json.loads(block("json", "preset").text)
    from playground.studio.remote.controls import Controls

    controls = Controls(how_to_harness.bench)
    assert list(wishes) == controls.names
    controls.do(wishes)
    file = tmp_path / "a.controllers"
    file.write_text(block("toml", "controller").text, encoding="utf-8")
    (binding,) = read_bindings(file)
    assert (binding.path, binding.part, binding.source.number) == ("light.sun", "elevation", 21)


def test_a_packed_sketch_leaves_its_controllers_behind(how_to_harness: Harness, tmp_path: Path) -> None:
    from zipfile import ZipFile

    from playground.publish.pack import pack

    (tmp_path / "land" / "sketch.controllers").write_text("format = 1\n", encoding="utf-8")
    assert how_to_harness.session.sketch is not None
    names = ZipFile(pack(how_to_harness.session.sketch, tmp_path / "land.zip")).namelist()
    assert any(name.endswith("sketch.toml") for name in names)
    assert not any("controllers" in name for name in names)
