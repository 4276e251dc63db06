"""A soak: hundreds of saves as editors make them, good and hostile; the last good one is always shown.

    SOAK=300 python -m pytest -m slow tests/studio/test_window_soak.py -s

prints what it counted. ``SOAK_SEED`` chooses another order.
"""

from __future__ import annotations

import os
import random
import sys
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from .saves import SAVES, save_through_a_link
from .screen import ON_LINUX, Program, Screen

COUNT = int(os.environ.get("SOAK", "60"))
SEED = int(os.environ.get("SOAK_SEED", "1"))
RUN = """
import sys
from playground.studio.app import run
sys.exit(run(sys.argv[1], size=(640, 420), time_limit=3000))
"""
TERRAIN = """// terrain.glsl -- hills
#include "wave.glsl"
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) {{ return 0.1 * float({n}) * wave(vec2(texel)); }}
"""
WAVE = """// wave.glsl -- a wave
float wave(vec2 p) {{ return 0.5 + 0.5 * sin(0.{n} * p.x) * cos(0.2 * p.y); }}
"""
SKETCH = """format = 1
title = "Soak"
size = 33
extent = 1000.0
relief = 20{n}.0
[[pass]]
name = "height"
use = "./terrain"
[view]
use = "view/map"
inputs = {{ shown = "height" }}
set = {{ lowest = 0.0, highest = 0.{n} }}
"""
FILES = {"terrain.glsl": TERRAIN, "wave.glsl": WAVE, "sketch.toml": SKETCH}
GOOD = 5
"""Good texts of each file: with the other two as they began, each gives a picture of its own."""

DOUBLING = "#define A0 x+x\n" + "".join(f"#define A{n + 1} A{n}+A{n}\n" for n in range(24))
HOSTILE: dict[str, tuple[bytes, ...]] = {
    "shader": (
        b"",
        b"\0\0\0\0",
        b"\xff\xfe\x00\x01 not UTF-8",
        b"#version 330\nvoid main() {",
        b'#include "terrain.glsl"\n#include "wave.glsl"\n',
        b'#include "gone.glsl"\n',
        b"this is no GLSL at all",
        b"/* never closed",
        b"#if 1\n",
        b"float wave(vec2 p) { return q; }\nfloat kernel(ivec2 t) { return q; }",
        b'#pragma kernel(output = "height:r99f")\nfloat kernel(ivec2 t) { return 1.0; }',
        b"(" * 40000,
        f"{DOUBLING}float wave(vec2 p) {{ float x = p.x; return A24; }}".encode(),
    ),
    "sketch.toml": (
        b"",
        b"format = ",
        b"format = 1\n",
        b"format = 99\n",
        b"\xff\xfe",
        b"\0" * 4096,
        b"[[pass]]\nname = 7\n",
        b"a = " + b"[" * 3000,
        SKETCH.format(n=1).replace("./terrain", "./gone").encode(),
        SKETCH.format(n=1).replace("size = 33", "size = -1").encode(),
        SKETCH.format(n=1).replace("size = 33", 'size = "height.size.x"').encode(),
        SKETCH.format(n=1).replace("view/map", "view/nothing").encode(),
    ),
}

pytestmark = [*ON_LINUX, pytest.mark.slow]
STYLES = (*SAVES, save_through_a_link)


SCREEN = 640, 420  # [pixels]


@pytest.fixture
def window(screen: Screen, tmp_path: Path) -> Iterator[Program]:
    home = tmp_path / "sketch"
    home.mkdir()
    for name, text in FILES.items():
        (home / name).write_text(text.format(n=1), encoding="utf-8")
    made = Program(screen, tmp_path, [sys.executable, "-c", RUN, str(home)], tmp_path)
    try:
        made.wait(lambda now: now["draws"] > 0)
        yield made
    finally:
        made.close()


def test_window_survives_every_save_and_shows_last_good_one(window: Program, tmp_path: Path) -> None:
    rng, home = random.Random(SEED), tmp_path / "sketch"
    names = learned(window, home)

    def pause() -> None:
        time.sleep(rng.uniform(0.0, 0.3))

    assert len(set(names.values())) == len(FILES) * (GOOD - 1) + 1, "each good text has its own picture"
    counts: Counter[str] = Counter()
    good = window.now()["picture"]
    for _ in range(COUNT):
        save, name = rng.choice(STYLES), rng.choice(list(FILES))
        path = home / name
        if rng.random() < 0.5:
            kind = "sketch.toml" if name == "sketch.toml" else "shader"
            save(path, rng.choice(HOSTILE[kind]), pause)
            counts[f"hostile, {save.__name__}"] += 1
            if rng.random() < 0.7:
                now = window.wait(lambda now: now["error"] and now["stage"] in ("NONE", "FAILED"))
                assert now["picture"] == good, (save.__name__, name, now["error"])
                counts["hostile, waited for"] += 1
            else:
                time.sleep(rng.uniform(0.0, 0.3))
            rng.choice(STYLES)(path, FILES[name].format(n=1).encode(), pause)
            good = settled(window, names[name, 1])
        else:
            number = rng.randint(1, GOOD)
            save(path, FILES[name].format(n=number).encode(), pause)
            counts[f"good, {save.__name__}"] += 1
            good = settled(window, names[name, number])
            rng.choice(STYLES)(path, FILES[name].format(n=1).encode(), pause)
            good = settled(window, names[name, 1])
        counts["good, shown"] += 1
    log = window.complaint()
    counts["deaths"] = int(window.process.poll() is not None)
    counts["tracebacks"] = log.count("Traceback")
    print("\n" + "\n".join(f"{count:5} {what}" for what, count in sorted(counts.items())))
    assert counts["deaths"] == 0 and counts["tracebacks"] == 0, log[-4000:]


def learned(window: Program, home: Path) -> dict[tuple[str, int], str]:
    """Return the picture of each good text of each file, with the other files as they began."""
    first = window.now()["picture"]
    names = {(name, 1): first for name in FILES}
    for name, text in FILES.items():
        before = first
        for number in [*range(2, GOOD + 1), 1]:
            (home / name).write_text(text.format(n=number), encoding="utf-8")
            now = window.wait(
                lambda now, old=before: now["picture"] != old and now["stage"] == "NONE" and not now["error"]
            )
            before = now["picture"]
            if number > 1:
                names[name, number] = before
        assert before == first
    return names


def settled(window: Program, picture: str) -> str:
    """Wait until the window shows a good picture, and nothing is wrong; return it."""
    now = window.wait(lambda now: now["picture"] == picture and now["stage"] == "NONE" and not now["error"])
    return str(now["picture"])
