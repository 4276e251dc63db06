"""Images that are painted on are written on a thread: whole, the newest last, and none is lost."""

from __future__ import annotations

import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.engine.file_sources import read_numbers
from playground.errors import DataError
from playground.studio.actions import Commands
from playground.studio.edits.undo import Undo
from playground.studio.notices import Notices
from playground.studio.paint.layer import NUMBERS, LatestWrite
from playground.studio.paint.painting import Painting
from playground.studio.save.sketch_file import SketchFile
from playground.studio.session import Session

from .test_sculpted_sketch import PICTURE, PLACE, stroke
from .test_sculpted_sketch import painting as painting
from .test_sculpted_sketch import session as session


def test_newest_of_queued_writes_alone_is_written() -> None:
    event, may_end, seen = threading.Event(), threading.Event(), []
    writing = LatestWrite()

    def first() -> None:
        event.set()
        may_end.wait(10)
        seen.append(0)

    writing.give(first)
    assert event.wait(10) and writing.pending
    for number in (1, 2, 3):
        writing.give(lambda number=number: seen.append(number))  # type: ignore[misc]
    assert not seen, "nobody has waited for it"
    may_end.set()
    writing.wait()
    assert seen == [0, 3] and writing.writes == 2 and not writing.pending


def test_error_belongs_to_last_write_and_next_one_clears_it() -> None:
    writing, ended = LatestWrite(), threading.Event()
    writing.ended = ended.set

    def fail() -> None:
        raise DataError("no space left on device")

    for wrong, sentence in ((fail, "no space left"), (lambda: 1 / 0, "could not be written: division")):
        writing.give(wrong)
        with pytest.raises(DataError, match=sentence):
            writing.wait()
    writing.give(lambda: None)
    writing.wait()
    assert writing.error is None and ended.wait(10)


def test_each_write_is_reported_before_a_wait_for_it_ends() -> None:
    """What is called may be gone afterwards: the window that it wakes."""
    seen: list[tuple[int, bool]] = []
    writing = LatestWrite(lambda: seen.append((writing.writes, writing.pending)))
    for number in (1, 2, 3):
        writing.give(lambda: None)
        writing.wait()
        assert len(seen) == number
    assert seen == [(1, True), (2, True), (3, True)]


def test_a_stroke_s_end_waits_for_no_file(
    session: Session, painting: Painting, monkeypatch: pytest.MonkeyPatch
) -> None:
    stroke(painting, PLACE)
    layer = painting.layer
    assert layer is not None and layer.kind is NUMBERS
    before, may_write = layer.path.read_bytes(), threading.Event()
    write = layer.kind.write

    def slowly(path: Path, pixels: np.ndarray) -> None:
        assert may_write.wait(10)
        write(path, pixels)

    monkeypatch.setattr(layer, "kind", replace(layer.kind, write=slowly))
    for _ in range(3):
        painting.press(PLACE)
        painting.release()
        painting.undo()
        painting.redo()
    assert layer.saved and layer.holds() and layer.path.read_bytes() == before
    threading.Timer(0.05, may_write.set).start()
    expected = layer.pixels.copy()
    painting.press(PLACE)  # goes on while the file is written: what is written is a copy
    assert not layer.saved
    assert painting.settle() and layer.saved
    np.testing.assert_array_equal(read_numbers(layer.path, layer.size), layer.pixels)
    assert (layer.pixels != expected).any()
    painting.close()


def test_what_cannot_be_written_is_said_once_and_tried_again(
    session: Session, painting: Painting, tmp_path: Path
) -> None:
    stroke(painting, PLACE)
    layer = painting.layer
    assert layer is not None and layer.kind is NUMBERS
    moved = tmp_path.rename(tmp_path.with_name("moved"))
    session.notes.clear()
    stroke(painting, PLACE)
    for _ in range(3):
        painting.follow()
    assert sum("there is no folder" in note for note in session.notes) == 1
    assert not layer.saved and painting.layer is layer
    assert len(painting.close()) == 1, "nothing is lost without a word"
    moved.rename(tmp_path)
    assert painting.close() == [] and layer.saved
    np.testing.assert_array_equal(read_numbers(layer.path, layer.size), layer.pixels)


def test_saving_reports_a_painting_that_cannot_be_written(
    session: Session, painting: Painting, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stroke(painting, PLACE)
    layer, notices = painting.layer, Notices()
    assert layer is not None

    def fail(path: Path, pixels: np.ndarray) -> None:
        raise DataError("no space left on device")

    monkeypatch.setattr(layer, "kind", replace(NUMBERS, write=fail))
    stroke(painting, PLACE)
    session.notes.clear()
    assert not painting.settle()
    assert list(session.notes) == ["no space left on device"]
    file = SketchFile(session, notices)
    commands = Commands(session, notices, Undo(session, notices, painting, file), file, tmp_path)
    missed = "; what was painted last could not be written, and is not in it"
    acts = commands.save_values, commands.save_values, commands.save_a_copy
    for act, begins in zip(acts, ("saved 1 value into ", "nothing differs ", "saved a copy "), strict=True):
        act()
        session.frame(PICTURE)
        message = notices.items[-1].text
        assert message.startswith(begins) and message.endswith(missed), message
    monkeypatch.setattr(layer, "kind", NUMBERS)
    commands.save_values()
    assert not notices.items[-1].text.endswith(missed)
    assert painting.settle()
    painting.close()


ENDS = """
import sys
from pathlib import Path
import numpy as np
from playground.studio.paint.brush import Brush, Dab
from playground.studio.paint.layer import NUMBERS, Layer
layer = Layer(Path(sys.argv[1]), np.zeros((2000, 2000), np.float32), NUMBERS)
for _ in range(5):
    layer.begin()
    layer.paint(Dab((0.5, 0.5), (0.5, 0.5), (9.0, 9.0), Brush(radius=9.0, strength=1.0), 1.0))
    layer.save()
raise SystemExit(7)
"""


@pytest.mark.slow
def test_a_process_that_ends_has_written_the_last_state(tmp_path: Path) -> None:
    path = tmp_path / "last.tif"
    done = subprocess.run([sys.executable, "-c", ENDS, str(path)], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (7, "")
    assert read_numbers(path, (2000, 2000)).max() == pytest.approx(5.0), "a second's raise, five times"
    assert [file.name for file in tmp_path.iterdir()] == ["last.tif"]
