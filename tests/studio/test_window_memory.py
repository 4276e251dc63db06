"""A window that compiles ever new texts gives back what compiling has freed, each time that it rests."""

from __future__ import annotations

import sys
from pathlib import Path

from .screen import HILLS, ON_LINUX, Program, Screen

pytestmark = ON_LINUX
SCREEN = 640, 420
KERNEL = """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return 0.5 + 0.5 * sin(0.%d * float(texel.x)); }
"""
RUN = """
import sys
from playground.engine import programs
from playground.studio.app import run
trim_heap = programs.trim_heap
def noting():
    trim_heap()
    print("memory given back", file=sys.stderr, flush=True)
programs.trim_heap = noting
sys.exit(run(sys.argv[1], size=(640, 420), time_limit=300))
"""


def test_memory_is_given_back_after_each_save(screen: Screen, tmp_path: Path) -> None:
    terrain = tmp_path / "terrain.glsl"
    terrain.write_text(KERNEL % 1, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(HILLS, encoding="utf-8")
    window = Program(screen, tmp_path, [sys.executable, "-c", RUN, str(tmp_path)], tmp_path)

    def count() -> int:
        return window.complaint().count("memory given back")

    try:
        picture = None
        for text in range(1, 4):
            before = count()
            terrain.write_text(KERNEL % text, encoding="utf-8")
            drawn = window.wait(lambda now, old=picture: now["picture"] not in (None, "", old))
            picture = drawn["picture"]
            window.wait(lambda now, before=before: count() > before)
    finally:
        window.close()
