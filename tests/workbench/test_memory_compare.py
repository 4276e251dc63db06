"""What is compared is compared again after the window was closed; what is A is tried before it is drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.engine.sandbox import SandboxReport, TrySketch
from playground.engine.textures import read_picture
from playground.errors import SandboxTimeout
from playground.sketch.assign import values_of
from playground.sketch.model import DEFAULT_PICTURE
from playground.workbench.autosave import Autosave
from playground.workbench.edits import Edits
from playground.workbench.framing import framed
from playground.workbench.inspect.compare import Compare, Mode
from playground.workbench.memory import Compared, Memory, Remembered
from playground.workbench.session import Session

SIZE = (48, 32)
TERRAIN = """#pragma kernel(output = "height:r32f")
uniform float level = 0.25; //! slider(0, 1)
float kernel(ivec2 texel) { return level * float(texel.x) / float(size.x); }
"""
SKETCH = 'format = 1\nsize = 33\n[[pass]]\nname = "height"\nuse = "./terrain"\n[view]\nuse = "view/terrain"\n'


class SlowSandbox:
    """Answers when a test says so."""

    def __init__(self) -> None:
        self.requests: list[TrySketch] = []
        self.answer: SandboxReport | None = None

    def submit(self, request: TrySketch) -> None:
        self.requests.append(request)

    def poll(self) -> SandboxReport | None:
        found, self.answer = self.answer, None
        return found


class Desk:
    """One window after another on a sketch."""

    def __init__(self, folder: Path, engine: Engine) -> None:
        self.folder, self.engine = folder, engine
        self.sandbox = SlowSandbox()
        (folder / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
        (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
        self.open()

    def open(self) -> None:
        memory = Memory(self.folder / "sketch.toml", self.folder / "state")
        found, complaint = memory.read()
        assert complaint == ""
        self.found = found.compared
        self.sandbox = SlowSandbox()
        self.session = Session(self.engine, self.folder, start=found.start, sandbox=self.sandbox)
        self.compare = Compare(self.session)
        self.autosave = Autosave(self.session, memory, found, compare=self.compare)
        self.session.frame(SIZE)
        self.answer(SandboxReport(True))

    def answer(self, report: SandboxReport) -> None:
        self.sandbox.answer = report
        self.frame()

    def frame(self) -> None:
        picture = self.session.frame(SIZE)
        if picture is not None:
            self.compare.follow(picture)
        self.autosave.look((900, 600))

    def first(self) -> NDArray[np.uint8]:
        assert self.compare.picture is not None
        return read_picture(self.compare.picture)

    def close(self) -> None:
        self.autosave.close()
        self.compare.release()
        self.session.release()


@pytest.fixture
def desk(tmp_path: Path, any_engine: Engine):
    made = Desk(tmp_path, any_engine)
    yield made
    made.close()


def compare_something(desk: Desk) -> None:
    desk.session.drafts.set("height.level", 0.75)
    desk.frame()
    desk.compare.keep()
    desk.compare.mode, desk.compare.split, desk.compare.gain = Mode.DIFFERENCE, 0.25, 16.0
    desk.session.drafts.set("height.level", 0.5)
    desk.frame()
    desk.close()


def test_a_is_there_again_once_it_has_been_tried(desk: Desk) -> None:
    compare_something(desk)
    desk.open()
    assert isinstance(desk.found, Compared) and desk.found.mode == "difference"
    desk.frame()
    assert not desk.compare.on and desk.autosave.waits, "it waits for the sandbox"
    assert values_of(desk.sandbox.requests[-1].sketch)["height.level"] == 0.75
    desk.answer(SandboxReport(True))
    desk.frame()
    compare = desk.compare
    assert (compare.mode, compare.split, compare.gain) == (Mode.DIFFERENCE, 0.25, 16.0)
    assert desk.session.sketch is not None
    alone = desk.session.sketch.with_values({"height.level": 0.75})
    if desk.session.is_preview:
        desk.session.read()
        desk.frame()
    expected = desk.engine.render(framed(alone, 0.0, DEFAULT_PICTURE, SIZE), size=SIZE).array
    np.testing.assert_array_equal(desk.first()[..., :3], expected[..., :3])
    assert values_of(desk.session.sketch)["height.level"] == 0.5


def test_an_a_that_fails_the_sandbox_is_never_drawn(desk: Desk) -> None:
    compare_something(desk)
    desk.open()
    desk.frame()
    draws = desk.compare.draws
    desk.answer(SandboxReport(False, SandboxTimeout("pass 'height' took longer than 10 s in the sandbox")))
    desk.frame()
    assert not desk.compare.on and desk.compare.draws == draws
    assert any("A of the last session is left out: pass 'height' took" in note for note in desk.session.notes)
    desk.close()
    desk.open()
    assert desk.found is None, "it is not requested again"


def test_closed_before_the_sandbox_has_answered_it_is_still_remembered(desk: Desk) -> None:
    compare_something(desk)
    for _ in range(2):
        desk.open()
        desk.frame()
        assert desk.found is not None and not desk.compare.on
        desk.close()


def test_a_of_a_sketch_that_is_left_meanwhile_is_not_compared_with_the_other(desk: Desk) -> None:
    compare_something(desk)
    other = desk.folder / "other"
    other.mkdir()
    for name in ("sketch.toml", "terrain.glsl"):
        (other / name).write_bytes((desk.folder / name).read_bytes())
    memory = Memory(other / "sketch.toml", desk.folder / "state")
    assert memory.claim()
    memory.write(Remembered(compared=Compared(Edits((("height.level", 0.625),)))))
    memory.close()
    desk.open()
    desk.frame()
    assert desk.sandbox.requests and not desk.compare.on
    desk.autosave.open(other)
    desk.answer(SandboxReport(True))
    assert desk.session.path == other / "sketch.toml" and not desk.session.drafts.opening
    for _ in range(2):
        desk.answer(SandboxReport(True))
        desk.frame()
    stored = desk.compare.stored
    assert stored is not None and stored.path == other / "sketch.toml"
    assert Path(stored.draft.file.file).parent == other
    assert dict(stored.draft.edits.values) == {"height.level": 0.625}


def test_a_save_goes_before_what_is_only_compared(desk: Desk) -> None:
    compare_something(desk)
    desk.open()
    desk.frame()
    before = len(desk.sandbox.requests)
    (desk.folder / "terrain.glsl").write_text(
        TERRAIN.replace("float(texel.x)", "float(texel.y)"), encoding="utf-8"
    )
    desk.session.drafts.reload()
    desk.frame()
    assert len(desk.sandbox.requests) == before + 1 and desk.session.drafts.testing
    desk.answer(SandboxReport(True))
    assert not desk.session.drafts.testing and not desk.compare.on
    desk.frame()
    desk.answer(SandboxReport(True))
    desk.frame()
    assert desk.compare.on and desk.session.error is None


def test_nothing_compared_is_nothing_remembered(desk: Desk) -> None:
    desk.session.drafts.set("height.level", 0.75)
    desk.compare.keep()
    desk.compare.end()
    desk.frame()
    desk.close()
    desk.open()
    assert desk.found is None and not desk.compare.on
