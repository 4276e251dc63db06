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
from playground.studio.compare.compare import Compare, Mode
from playground.studio.edits.autosave import Autosave
from playground.studio.edits.edits import Edits
from playground.studio.edits.memory import Compared, Memory, Remembered
from playground.studio.picture.view import framed
from playground.studio.session import Session

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
        sandbox_report, self.answer = self.answer, None
        return sandbox_report


class Harness:
    """One window after another on a sketch."""

    def __init__(self, folder: Path, engine: Engine) -> None:
        self.folder, self.engine = folder, engine
        self.sandbox = SlowSandbox()
        (folder / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
        (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
        self.open()

    def open(self) -> None:
        memory = Memory(self.folder / "sketch.toml", self.folder / "state")
        result, complaint = memory.read()
        assert complaint == ""
        self.found = result.compared
        self.sandbox = SlowSandbox()
        self.session = Session(self.engine, self.folder, start=result.start, sandbox=self.sandbox)
        self.compare = Compare(self.session)
        self.autosave = Autosave(self.session, memory, result, compare=self.compare)
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
def harness(tmp_path: Path, any_engine: Engine):
    made = Harness(tmp_path, any_engine)
    yield made
    made.close()


def compare_something(harness: Harness) -> None:
    harness.session.drafts.set("height.level", 0.75)
    harness.frame()
    harness.compare.keep()
    harness.compare.mode, harness.compare.split, harness.compare.gain = Mode.DIFFERENCE, 0.25, 16.0
    harness.session.drafts.set("height.level", 0.5)
    harness.frame()
    harness.close()


def test_a_is_there_again_once_it_has_been_tried(harness: Harness) -> None:
    compare_something(harness)
    harness.open()
    assert isinstance(harness.found, Compared) and harness.found.mode == "difference"
    harness.frame()
    assert not harness.compare.on and harness.autosave.waits, "it waits for the sandbox"
    assert values_of(harness.sandbox.requests[-1].sketch)["height.level"] == 0.75
    harness.answer(SandboxReport(True))
    harness.frame()
    compare = harness.compare
    assert (compare.mode, compare.split, compare.gain) == (Mode.DIFFERENCE, 0.25, 16.0)
    assert harness.session.sketch is not None
    alone = harness.session.sketch.with_values({"height.level": 0.75})
    if harness.session.is_preview:
        harness.session.read()
        harness.frame()
    expected = harness.engine.render(framed(alone, 0.0, DEFAULT_PICTURE, SIZE), size=SIZE).array
    np.testing.assert_array_equal(harness.first()[..., :3], expected[..., :3])
    assert values_of(harness.session.sketch)["height.level"] == 0.5


def test_an_a_that_fails_the_sandbox_is_never_drawn(harness: Harness) -> None:
    compare_something(harness)
    harness.open()
    harness.frame()
    draws = harness.compare.draws
    harness.answer(SandboxReport(False, SandboxTimeout("pass 'height' took longer than 10 s in the sandbox")))
    harness.frame()
    assert not harness.compare.on and harness.compare.draws == draws
    assert any(
        "A of the last session is left out: pass 'height' took" in note for note in harness.session.notes
    )
    harness.close()
    harness.open()
    assert harness.found is None, "it is not requested again"


def test_close_before_sandbox_answer_still_remembers_comparison(harness: Harness) -> None:
    compare_something(harness)
    for _ in range(2):
        harness.open()
        harness.frame()
        assert harness.found is not None and not harness.compare.on
        harness.close()


def test_comparison_of_left_sketch_is_not_applied_to_other(harness: Harness) -> None:
    compare_something(harness)
    other = harness.folder / "other"
    other.mkdir()
    for name in ("sketch.toml", "terrain.glsl"):
        (other / name).write_bytes((harness.folder / name).read_bytes())
    memory = Memory(other / "sketch.toml", harness.folder / "state")
    assert memory.claim()
    memory.write(Remembered(compared=Compared(Edits((("height.level", 0.625),)))))
    memory.close()
    harness.open()
    harness.frame()
    assert harness.sandbox.requests and not harness.compare.on
    harness.autosave.open(other)
    harness.answer(SandboxReport(True))
    assert harness.session.path == other / "sketch.toml" and not harness.session.drafts.opening
    for _ in range(2):
        harness.answer(SandboxReport(True))
        harness.frame()
    stored = harness.compare.stored
    assert stored is not None and stored.path == other / "sketch.toml"
    assert Path(stored.draft.file.file).parent == other
    assert dict(stored.draft.edits.values) == {"height.level": 0.625}


def test_a_save_goes_before_what_is_only_compared(harness: Harness) -> None:
    compare_something(harness)
    harness.open()
    harness.frame()
    before = len(harness.sandbox.requests)
    (harness.folder / "terrain.glsl").write_text(
        TERRAIN.replace("float(texel.x)", "float(texel.y)"), encoding="utf-8"
    )
    harness.session.drafts.reload()
    harness.frame()
    assert len(harness.sandbox.requests) == before + 1 and harness.session.drafts.testing
    harness.answer(SandboxReport(True))
    assert not harness.session.drafts.testing and not harness.compare.on
    harness.frame()
    harness.answer(SandboxReport(True))
    harness.frame()
    assert harness.compare.on and harness.session.error is None


def test_nothing_compared_is_nothing_remembered(harness: Harness) -> None:
    harness.session.drafts.set("height.level", 0.75)
    harness.compare.keep()
    harness.compare.end()
    harness.frame()
    harness.close()
    harness.open()
    assert harness.found is None and not harness.compare.on
