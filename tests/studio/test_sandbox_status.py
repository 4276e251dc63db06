"""While a sandbox runs, the window knows for what and for how long."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.engine.sandbox import SandboxReport
from playground.studio.overlay import PATIENCE, checking_text
from playground.studio.reload.watcher import Follower
from playground.studio.session import Session

from .session_desk import FakeSandbox
from .test_session import SLOPE


class FakeWatcher:
    """A watcher that reports what a test sets."""

    def __init__(self) -> None:
        self.changed: set[Path] = set()

    def take(self) -> set[Path]:
        changed, self.changed = self.changed, set()
        return changed

    def follow(self, *_: object, **__: object) -> None:
        pass


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "inc").mkdir()
    for name, text in SLOPE.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_what_is_tried_is_named_and_timed(folder: Path, any_engine: Engine) -> None:
    clock, sandbox, watcher = [0.0], FakeSandbox(), FakeWatcher()
    session = Session(any_engine, folder, sandbox=sandbox, now=lambda: clock[0])
    follower = Follower(session, watcher)  # type: ignore[arg-type]
    try:
        clock[0] = 0.5
        assert session.drafts.checking == ("sketch.toml", 0.5)
        sandbox.answer = SandboxReport(True)
        session.frame((32, 32))
        assert session.drafts.checking is None

        (folder / "terrain.glsl").write_text(SLOPE["terrain.glsl"].replace("0.25", "0.5"), encoding="utf-8")
        watcher.changed = {folder / "terrain.glsl"}
        assert follower.take()
        clock[0] += 2.0
        assert session.drafts.checking == ("terrain.glsl", 2.0)
        (folder / "inc/tilt.glsl").write_text(SLOPE["inc/tilt.glsl"].replace("x)", "y)"), encoding="utf-8")
        watcher.changed = {folder / "terrain.glsl", folder / "inc" / "tilt.glsl", folder / "sketch.toml"}
        assert follower.take()
        subject = "sketch.toml, terrain.glsl and 1 more"
        assert session.drafts.checking == (subject, 0.0), "a newer save begins anew"
    finally:
        session.release()


def test_the_words() -> None:
    assert checking_text("terrain.glsl", PATIENCE) == "checking terrain.glsl …"
    assert checking_text("terrain.glsl", 3.9) == "checking terrain.glsl … 3 s"
