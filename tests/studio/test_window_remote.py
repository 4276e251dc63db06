"""A real window that is driven by HTTP, WebSocket and OSC: what is drawn, how frames go on, how it ends.

    SOAK=10000 python -m pytest -m slow tests/studio/test_window_remote.py -s

prints what it measured.
"""

from __future__ import annotations

import asyncio
import json
import os
import re
import signal
import socket
import sys
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import aiohttp
import pytest
from pythonosc.udp_client import SimpleUDPClient

from .screen import HILLS, ON_LINUX, Program, Screen

COUNT = int(os.environ.get("SOAK", "2000"))
TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) {
    return level * (0.5 + 0.5 * sin(9.0 * float(texel.x) / float(size.x) + 1e-6 * time));
}
"""
SCREEN = 900, 560
FRAMES = """
import signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job of a shell ignores it
from playground import cli
from playground.engine.engine import Engine
from playground.studio.window import Window
Engine.__init__.__kwdefaults__["cache_bytes"] = 32 * 2**20  # soon full, as it would be after a while
ended, times = Window.end, open(sys.argv.pop(1), "w", buffering=1)
def end(self):
    ended(self)
    times.write(f"{time.monotonic()}\\n")
Window.end = end
sys.exit(cli.main(sys.argv[1:]))
"""

pytestmark = [*ON_LINUX, pytest.mark.slow]


@pytest.fixture(scope="module")
def screen(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    made = Screen(tmp_path_factory.mktemp("screen"), *SCREEN)
    yield made
    made.close()


class Driven:
    """A window, and the ways to drive it."""

    def __init__(self, screen: Screen, folder: Path) -> None:
        (folder / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
        (folder / "sketch.toml").write_text(HILLS, encoding="utf-8")
        self.frames = folder / "frames.txt"
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            self.osc = free.getsockname()
        words = ["live", str(folder), "--size", "800x500", "--remote", "0", "--osc", str(self.osc[1])]
        self.program = Program(
            screen, folder, [sys.executable, "-c", FRAMES, str(self.frames), *words], folder
        )
        self.program.wait(lambda now: now["draws"] > 0)
        result = re.search(r"http://\S+", self.program.complaint())
        assert result, self.program.complaint()
        self.url = result[0]

    def level(self) -> float:
        return float(self.program.now()["edited"].get("height.level", 0.5))

    def memory(self) -> float:
        """Return its resident memory [MiB]."""
        text = Path(f"/proc/{self.program.process.pid}/status").read_text("utf-8")
        result = re.search(r"VmRSS:\s*(\d+)", text)
        assert result
        return int(result[1]) / 1024

    def processor(self) -> float:
        """Return the processor time that it has used [s]: what other programs do meanwhile is not in it."""
        fields = Path(f"/proc/{self.program.process.pid}/stat").read_text("utf-8").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def intervals(self, since: float) -> list[float]:
        """Return the times between frames [s] since a moment."""
        times = [float(line) for line in self.frames.read_text("utf-8").splitlines()[:-1]]
        times = [at for at in times if at >= since]
        return sorted(b - a for a, b in pairwise(times))


@pytest.fixture
def driven(screen: Screen, tmp_path: Path) -> Iterator[Driven]:
    made = Driven(screen, tmp_path)
    yield made
    made.program.close()


def test_a_script_drives_a_window_and_ctrl_c_ends_it(driven: Driven) -> None:
    async def go() -> tuple[bytes, bytes, list[dict[str, Any]]]:
        async with aiohttp.ClientSession() as client:

            async def picture() -> bytes:
                async with client.get(f"{driven.url}picture.png") as answer:
                    assert answer.status == 200
                    return await answer.read()

            async with client.post(f"{driven.url}do", json={"playing": False, "time": 0}) as answer:
                assert (await answer.json())["time"] == 0.0
            before = await picture()
            async with client.post(f"{driven.url}do", json={"set": {"height.level": 0.9}}) as answer:
                assert answer.status == 200
            await asyncio.sleep(0.5)
            async with client.get(f"{driven.url}parameters") as answer:
                return before, await picture(), await answer.json()

    before, after, parameters = asyncio.run(go())
    assert before[:8] == after[:8] == b"\x89PNG\r\n\x1a\n" and before != after
    assert {parameter["path"]: parameter["value"] for parameter in parameters}["height.level"] == 0.9
    driven.program.wait(lambda now: now["edited"].get("height.level") == 0.9)
    driven.program.process.send_signal(signal.SIGINT)
    assert driven.program.ended() == 130, driven.program.complaint()
    with socket.socket() as again:
        again.bind(("127.0.0.1", int(driven.url.split(":")[2].split("/")[0])))


def test_a_flood_loses_no_last_value_and_frames_go_on(driven: Driven) -> None:
    async def idle() -> None:
        await asyncio.sleep(5)

    async def sockets(count: int, last: float) -> None:
        async with aiohttp.ClientSession() as client, client.ws_connect(f"{driven.url}events") as events:
            for n in range(count):
                await events.send_str(json.dumps({"set": {"height.level": (n % 1000) / 1000}}))
            await events.send_str(json.dumps({"id": "last", "set": {"height.level": last}}))
            while json.loads((await events.receive(timeout=120)).data).get("id") != "last":
                pass

    def by_osc(count: int, last: float) -> None:
        client = SimpleUDPClient(*driven.osc)
        for n in range(count):
            client.send_message("/height/level", (n % 1000) / 1000)
            if n % 100 == 99:
                time.sleep(0.05)
        for _ in range(20):
            client.send_message("/height/level", last)
            time.sleep(0.01)
        client.close()

    asyncio.run(sockets(COUNT // 2, 0.5))  # until the engine's cache is full
    figures = {}
    memory = driven.memory()
    for name, act, last in (
        ("at rest, time running", lambda: asyncio.run(idle()), None),
        (f"{COUNT} sets by WebSocket", lambda: asyncio.run(sockets(COUNT, 0.875)), 0.875),
        (f"{COUNT} messages by OSC", lambda: by_osc(COUNT, 0.625), 0.625),
    ):
        start, used = time.monotonic(), driven.processor()
        act()
        took, used = time.monotonic() - start, driven.processor() - used
        if last is not None:
            driven.program.wait(lambda now, last=last: now["edited"].get("height.level") == last)
        intervals = driven.intervals(start)
        middle, worst = intervals[len(intervals) // 2], intervals[int(len(intervals) * 0.99)]
        figures[name] = (took, len(intervals), middle * 1e3, worst * 1e3, used * 1e3)
    asyncio.run(sockets(COUNT, 0.25))
    driven.program.wait(lambda now: now["edited"].get("height.level") == 0.25)
    growth = driven.memory() - memory
    resting, *floods = figures
    a_frame = figures[resting][4] / figures[resting][1]
    for name, (took, count, middle, worst, used) in figures.items():
        print(f"{name}: {took:.1f} s, {count} frames, median {middle:.0f} ms, 99 % {worst:.0f} ms", end="")
        print(f", {used:.0f} ms of the processor; {a_frame:.1f} ms a frame at rest")
    print(f"memory: {memory:.0f} MiB before, {growth:+.1f} MiB after")
    for name in floods:
        _, count, _, _, used = figures[name]
        a_message = (used - count * a_frame) / COUNT  # what is left when the frames are paid for
        print(f"{name}: {a_message:.2f} ms of the processor a message")
        assert count > 3, f"frames go on: {name}"
        assert a_message < a_frame / 2, f"no message is drawn for itself: {name}"
    assert growth < 32, "values are kept once each, not one by one"
