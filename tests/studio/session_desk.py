"""Two sketches, a session on one of them, and a sandbox that answers when a test says so."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from playground.engine.engine import Engine
from playground.engine.sandbox import SandboxReport, TrySketch
from playground.errors import SandboxCrash
from playground.sketch.assign import values_of
from playground.studio.bench import Workbench
from playground.studio.drops import Drops
from playground.studio.edits.autosave import Autosave, memory_of
from playground.studio.interface import WindowControls
from playground.studio.session import Session

from ..sketch_texts import map_of, passes

OpenSession = Callable[..., Session]
SIZE = (32, 24)
KERNEL = """#pragma kernel(output = "height:r32f", repeat = "4")
uniform float level = 0.25; //! slider(0, 1)
float kernel(ivec2 texel) { return 0.5 * previous(texel) + level * float(texel.x) / float(size.x); }
"""
ADD = """#pragma kernel(output = "sum:r32f")
uniform sampler2D height; //! input
uniform sampler2D data; //! input
float kernel(ivec2 texel) { return texelFetch(height, texel, 0).r + 0.01 * texelFetch(data, ivec2(0), 0).r; }
"""
SKETCH = (
    "format = 1\nsize = 9\nextent = 100.0\n"
    + passes(
        height="./hills",
        data=("generation/heightmap", 'set = { elevation = "a.npy" }'),
        sum="./add",
    )
    + map_of("sum")
)
GOOD, BAD = SandboxReport(True), SandboxReport(False, SandboxCrash("the driver crashed"))
LEVEL, ELEVATION = "height.level", "data.elevation"


class FakeSandbox:
    """A sandbox that answers when a test says so; ``latest`` is the one that was made last."""

    latest: FakeSandbox

    def __init__(self) -> None:
        type(self).latest = self
        self.requests: list[TrySketch] = []
        self.answer: SandboxReport | None = None

    def submit(self, request: TrySketch) -> None:
        self.requests.append(request)

    def poll(self) -> SandboxReport | None:
        answer, self.answer = self.answer, None
        return answer


class Harness:
    """Two sketches, "one" and "two", a session on the first, and its sandbox."""

    def __init__(self, folder: Path, engine: Engine, sketch: str = SKETCH) -> None:
        self.folder, self.engine, self.time = folder, engine, 0.0
        for name in ("one", "two"):
            (folder / name).mkdir()
            self.write(f"{name}/hills.glsl", KERNEL)
            self.write(f"{name}/dunes.glsl", KERNEL.replace("float(texel.x)", "float(texel.y)"))
            self.write(f"{name}/add.glsl", ADD)
            self.write(f"{name}/sketch.toml", sketch)
            for seed, file in enumerate(("a.npy", "b.npy")):
                np.save(folder / name / file, np.random.default_rng(seed).random((9, 9), np.float32))
        self.sessions: list[Session] = []
        self.start("one")

    def start(self, name: str) -> None:
        """Open a window on a sketch."""
        self.sandbox = FakeSandbox()
        memory = memory_of(self.folder / name / "sketch.toml", self.folder / "state")
        result, _ = memory.read()
        self.session = Session(
            self.engine, self.folder / name, start=result.start, sandbox=self.sandbox, now=lambda: self.time
        )
        self.sessions.append(self.session)
        self.drafts = self.session.drafts
        self.bench = Workbench(
            self.session, WindowControls(lambda: None), folder=self.folder, now=lambda: self.time
        )
        self.autosave = Autosave(self.session, memory, result, lambda: self.time)
        self.bench.actions.opens = self.autosave.open  # type: ignore
        self.drops = Drops(self.bench.actions)
        self.answer(GOOD)
        assert self.session.shown is not None

    def write(self, name: str, text: str) -> None:
        (self.folder / name).write_text(text, encoding="utf-8")

    def save(self, old: str, new: str, name: str = "one/sketch.toml") -> None:
        """Save a file as an editor does."""
        text = (self.folder / name).read_text(encoding="utf-8")
        assert old in text
        self.write(name, text.replace(old, new))
        self.drafts.reload()

    def frame(self) -> None:
        """Let a frame of the window pass, a second after the one before."""
        self.time += 1.0
        self.session.frame(SIZE)
        self.bench.undo.record()
        self.autosave.look((900, 600))
        self.autosave.write()

    def answer(self, report: SandboxReport) -> None:
        self.sandbox.answer = report
        self.frame()

    def close(self) -> None:
        self.autosave.close()

    def crash(self) -> None:
        """End the window without writing what it still has to; the system lets go of its lock."""
        self.autosave.latest = None
        self.autosave.close()

    @property
    def name(self) -> str:
        """The sketch that is shown."""
        return Path(self.session.shown.file.file).parent.name

    @property
    def level(self) -> object:
        assert self.session.sketch is not None
        return values_of(self.session.sketch)[LEVEL]

    @property
    def technique(self) -> str:
        spec = self.session.shown.base.graph.find("height")
        return spec.use

    @property
    def elevation(self) -> str:
        assert self.session.sketch is not None
        return Path(str(values_of(self.session.sketch)[ELEVATION])).name

    @property
    def size(self) -> object:
        assert self.session.sketch is not None and self.session.sketch.terrain.size is not None
        return self.session.sketch.terrain.size[0]

    def file(self, name: str) -> str:
        """The path of a data file of the sketch "one", as it is chosen."""
        return str(self.folder / "one" / name)

    @property
    def messages(self) -> str:
        self.bench.take_notes()
        return "; ".join(notice.text for notice in self.bench.notices.items)
