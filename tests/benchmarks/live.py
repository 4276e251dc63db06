"""Measure what a save costs in a live session, and that none is missed: ``python tests/benchmarks/live.py``.

Save to new picture, by a watcher, a trial child and an engine as in the window, at
1025²: for a texturing kernel, an included library file and a value in the sketch. Each
text is new to the driver. Beside the seconds on the wall stands the processor's time of
both processes, which a busy machine does not stretch as much.
"""

from __future__ import annotations

import argparse
import gc
import os
import resource
import statistics
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path

from rich.console import Console
from rich.table import Table

from playground.engine.engine import Engine
from playground.engine.trial import Trial
from playground.gpu.context import open_context
from playground.live.follow import Follower
from playground.live.session import Session
from playground.live.watch import Watcher
from playground.paths import GLSL

SIZE = (1280, 720)
LIMITS = "200 / 400 ms"
KERNEL = "texturing/height_blend/mix"
PAUSE = 0.15  # [s] between saves: longer than a file system's clock and the watcher's batch


class Bench:
    """A sketch in a folder, and a session that follows it."""

    def __init__(self, folder: Path, engine: Engine, trial: Trial | None, size: int = 1025) -> None:
        self.folder, self.engine, self.trial = folder, engine, trial
        self.kernel, self.include, self.sketch = folder / "mine.glsl", folder / "own.glsl", folder / "sketch.toml"
        text = (GLSL / f"{KERNEL}.glsl").read_text(encoding="utf-8")
        marked = text.replace("return vec4(", "return own() * EDIT * vec4(", 1)
        if marked == text or "vec4 kernel(" not in text:
            raise SystemExit(f"{KERNEL}.glsl has changed: this benchmark cannot edit it any more")
        head = '#include "own.glsl"\nconst float EDIT = {edit};\nvec4 kernel('
        self.kernel_text = marked.replace("vec4 kernel(", head, 1)
        self.include_text = "float own() {{ return {edit}; }}\n"
        uses = [("height", "generation/diamond_square", "")]
        for ground in ("grass", "rock", "snow"):
            uses += [(f"{ground}_tile", f"texturing/{ground}", "size = 512"), (ground, "texturing/tiled", "")]
        uses += [("colour", "./mine", ""), ("light", "lighting/ray_cast", "")]
        passes = [f'[[pass]]\nname = "{name}"\nuse = "{use}"\n{more}\n' for name, use, more in uses]
        view = '[view]\nuse = "view/terrain"\nset = {{ sky = {edit} }}\n'
        if "uniform float sky" not in "".join(p.read_text("utf-8") for p in (GLSL / "view").rglob("*.glsl")):
            view = '[view]\nuse = "view/terrain"\n[[preset]]\nname = "none"\nset = {{ }}\n'
        self.sketch_text = f"format = 1\nsize = {size}\nrelief = {{edit}}\n" + "".join(passes) + view
        self.number = 0
        for file, text in ((self.kernel, self.kernel_text), (self.include, self.include_text)):
            file.write_text(text.format_map({"edit": "1.0"}), encoding="utf-8")
        self.sketch.write_text(self.sketch_text.format_map({"edit": "1800.0"}), encoding="utf-8")
        self.woken = threading.Event()
        self.session = Session(engine, self.sketch, trial=trial)
        self.watcher = Watcher(self.woken.set, (".glsl", ".toml"))
        self.follower = Follower(self.session, self.watcher)
