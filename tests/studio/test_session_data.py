"""Images and elevation files are read by the sandbox first: what it does not survive is not loaded here."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from playground import memo
from playground.data import elevation
from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.engine.sandbox import SandboxReport
from playground.errors import SandboxCrash
from playground.sketch.model import Camera
from playground.studio.compare.compare import Compare
from playground.studio.graph.graph import Thumbnails
from playground.studio.inspect.inspector import Inspector
from playground.studio.reload.stages import ReloadStage
from playground.studio.session import Session

from ..sketch_texts import map_of, passes
from .session_desk import FakeSandbox

SIZE = (32, 32)
SKETCH = (
    "format = 1\nextent = 100.0\n"
    + passes(height=("generation/heightmap", 'set = { elevation = "terrain.npy" }'))
    + map_of("height")
)


@pytest.fixture
def read(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """Give the names of the elevation files that this process has read."""
    names: list[str] = []

    def reading(self: elevation.ElevationFile) -> elevation.Elevation:
        names.append(self.path.name)
        return whole(self)

    whole = elevation.ElevationFile.read
    monkeypatch.setattr(elevation.ElevationFile, "read", reading)
    memo.SOURCES.clear()
    yield names
    memo.SOURCES.clear()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, slope in (("terrain.npy", 1.0), ("other.npy", 2.0)):
        np.save(tmp_path / name, slope * np.outer(np.ones(9), np.arange(9)).astype(np.float32))
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return tmp_path


@pytest.fixture
def session(folder: Path, any_engine: Engine, read: list[str]) -> Iterator[Session]:
    made = Session(any_engine, folder, sandbox=FakeSandbox())
    yield made
    made.release()


def answer(session: Session, report: SandboxReport) -> None:
    sandbox = session.drafts._checks.sandbox
    assert isinstance(sandbox, FakeSandbox)
    sandbox.answer = report
    session.frame(SIZE)


def test_the_first_picture_s_file_is_read_by_the_sandbox_first(session: Session, read: list[str]) -> None:
    session.frame(SIZE)
    assert session.drafts.testing and read == []
    answer(session, SandboxReport(True))
    assert session.sketch is not None and set(read) == {"terrain.npy"}


def test_resaved_file_is_tried_and_unread_if_sandbox_dies(
    session: Session, folder: Path, read: list[str]
) -> None:
    answer(session, SandboxReport(True))
    read.clear()
    np.save(folder / "terrain.npy", np.eye(11, dtype=np.float32))
    session.drafts.reload()
    assert session.drafts.testing and read == []
    answer(session, SandboxReport(False, SandboxCrash("ran out of memory")))
    session.drafts.set_camera(Camera(azimuth=12.0))
    assert session.frame(SIZE) is not None, "the last good picture stays"
    assert session.drafts.stage is ReloadStage.FAILED and "ran out of memory" in str(session.error)
    assert read == []
    session.drafts.reload()
    assert session.drafts.testing, "it is tried again, not believed"
    answer(session, SandboxReport(True))
    assert session.error is None and read == ["terrain.npy"]
    session.drafts.reload()
    assert not session.drafts.testing, "nothing of it is new by now"


@pytest.mark.parametrize("name", ["other.npy", "gone.npy"])
def test_a_file_chosen_by_hand_is_tried_first(
    session: Session, folder: Path, read: list[str], name: str
) -> None:
    answer(session, SandboxReport(True))
    read.clear()
    session.drafts.set("height.elevation", str(folder / name))
    assert session.drafts.testing and read == []
    answer(session, SandboxReport(False, SandboxCrash("the decoder crashed")))
    assert "the decoder crashed" in str(session.error) and read == []
    session.frame(SIZE)
    assert read == [], "what is shown stays as it was"
    session.drafts.set("height.elevation", str(folder / "terrain.npy"))
    session.frame(SIZE)
    assert session.error is None and not session.drafts.testing and session.drafts.stage is ReloadStage.NONE


def test_a_file_chosen_by_hand_is_drawn_once_it_proved_good(
    session: Session, folder: Path, read: list[str]
) -> None:
    answer(session, SandboxReport(True))
    before = session.draws
    session.drafts.set("height.elevation", str(folder / "other.npy"))
    session.drafts.set("view.channel", "red")
    answer(session, SandboxReport(True))
    assert session.error is None and session.draws > before and "other.npy" in read
    assert session.shown is not None
    assert dict(session.shown.edits.values)["height.elevation"] == str(folder / "other.npy")
    assert "view.channel" in dict(session.shown.edits.values)


@pytest.mark.parametrize("when", ["during its check", "after it"])
def test_a_file_that_is_taken_back_has_no_verdict(session: Session, folder: Path, when: str) -> None:
    answer(session, SandboxReport(True))
    bad = SandboxReport(False, SandboxCrash("the decoder crashed"))
    session.drafts.set("height.elevation", str(folder / "other.npy"))
    if when == "after it":
        answer(session, bad)
        assert session.drafts.stage is ReloadStage.FAILED
    session.drafts.unset("height.elevation")
    answer(session, bad)  # of a sketch that nobody wants any more
    assert session.error is None and session.drafts.stage is ReloadStage.NONE
    assert session.shown is not None and not session.shown.edits.values


def test_a_file_that_was_only_touched_is_no_other(session: Session, folder: Path) -> None:
    answer(session, SandboxReport(True))
    before = session.draws
    path = folder / "terrain.npy"
    data = path.read_bytes()
    path.unlink()
    path.write_bytes(data)
    os.utime(path, ns=(10**18, 10**18))
    session.drafts.set_camera(Camera(azimuth=12.0))
    session.frame(SIZE)
    assert session.draws > before, "the picture does not wait for a check that nobody requested"
    session.drafts.reload()
    assert not session.drafts.testing


def test_other_values_wait_for_nothing(session: Session) -> None:
    answer(session, SandboxReport(True))
    session.drafts.set("view.channel", "red")
    assert not session.drafts.testing


@pytest.mark.slow
def test_the_sandbox_says_what_is_wrong_with_a_bomb(folder: Path, any_engine: Engine) -> None:
    from playground.engine.sandbox import Sandbox, TrySketch
    from playground.sketch.load import load

    with (folder / "terrain.npy").open("wb") as file:  # 2 GiB of holes, by columns: not to be read by rows
        np.lib.format.write_array_header_1_0(
            file, {"descr": "<f8", "fortran_order": True, "shape": (16384, 16384)}
        )
        file.truncate(file.tell() + 8 * 16384**2)
    with Sandbox(memory_bytes=2**30) as sandbox:
        report = sandbox.run(TrySketch(load(folder)))
        assert not report.ok and report.error is not None
        assert "there is not enough memory to read it" in str(report.error)
        assert "terrain.npy" in str(report.error)
        write_png(folder / "fine.png", np.zeros((4, 4, 3), np.uint8))
        np.save(folder / "terrain.npy", np.eye(9, dtype=np.float32))
        assert sandbox.run(TrySketch(load(folder))).ok, "the same child goes on"


def test_nothing_reads_picture_while_new_data_is_checked(session: Session, folder: Path) -> None:
    answer(session, SandboxReport(True))
    picture = session.frame(SIZE)
    assert picture is not None and session.is_idle
    inspector, thumbnails, compare = Inspector(session), Thumbnails(session), Compare(session)
    assert inspector.at((5, 5), picture) is not None
    assert not thumbnails.refresh(["height:height"], 1.0) and thumbnails.made == 1
    compare.keep()
    compare.follow(picture)
    np.save(folder / "terrain.npy", np.full((9, 9), 0.25, np.float32))
    assert session.awaits_data and not session.is_idle
    assert inspector.at((6, 6), picture) is None
    made, draws = thumbnails.made, compare.draws
    thumbnails.refresh(["view:view"], 2.0)
    session.view.framed_for = (64, 32)
    compare.follow(picture)
    assert (thumbnails.made, compare.draws) == (made, draws)
    session.drafts.reload()
    answer(session, SandboxReport(True))
    assert session.is_idle and inspector.at((6, 6), picture) is not None
    for made_there in (inspector, thumbnails, compare):
        made_there.release()
