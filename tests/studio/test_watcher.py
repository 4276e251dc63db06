"""Every way of saving is seen, with real files; what changes nothing is not."""

from __future__ import annotations

import os
import shutil
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.allowed_files import signature
from playground.studio.reload.watcher import Watcher

from .saves import SAVES, Save, save_by_rename, save_in_place

LIMIT = 30.0  # [s]


def pause() -> None:
    """Let a moment pass between the steps of a save."""
    time.sleep(0.01)


class Watched:
    """Two files in two folders, and a watcher on them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.file = folder / "terrain.glsl"
        self.include = folder / "inc" / "deep" / "noise.glsl"
        self.include.parent.mkdir(parents=True)
        self.file.write_text("one", encoding="utf-8")
        self.include.write_text("one", encoding="utf-8")
        self.woken = threading.Event()
        self.watcher = Watcher(self.woken.set, also=(".glsl",))
        self.watcher.follow([self.file, self.include])
        self.watcher.start()
        time.sleep(0.1)  # the kernel's watches are being set up

    def sees(self, *expected: Path) -> bool:
        paths: set[Path] = set()
        end = time.monotonic() + LIMIT
        while not set(expected) <= paths and time.monotonic() < end:
            self.woken.wait(0.02)
            self.woken.clear()
            paths |= self.watcher.take()
        return set(expected) <= paths

    def is_idle(self) -> bool:
        """Wait until nothing is reported for a while: a file may be reported half-written."""
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            if self.sees_nothing():
                return True
        return False

    def sees_nothing(self, seconds: float = 1.0) -> bool:
        time.sleep(seconds)
        return not self.watcher.take()


@pytest.fixture
def watched(tmp_path: Path) -> Iterator[Watched]:
    made = Watched(tmp_path)
    yield made
    made.watcher.stop()


@pytest.mark.parametrize("save", SAVES, ids=lambda save: save.__name__)
def test_every_way_of_saving_is_seen_again_and_again(watched: Watched, save: Save) -> None:
    for number in range(3):
        save(watched.file, f"text {number}".encode(), pause)
        assert watched.sees(watched.file)
    save(watched.include, b"another text", pause)
    assert watched.sees(watched.include)


def test_a_second_save_within_50_ms_is_seen(watched: Watched) -> None:
    for number in range(4):
        save_in_place(watched.file, f"first {number}".encode())
        time.sleep(0.02)
        save_in_place(watched.file, f"second {number}".encode())
        seen = ""
        end = time.monotonic() + LIMIT
        while seen != f"second {number}" and time.monotonic() < end:
            if watched.watcher.take():
                seen = watched.file.read_text(encoding="utf-8")
            time.sleep(0.005)
        assert seen == f"second {number}"


@pytest.mark.slow
def test_saving_what_was_there_is_no_change(watched: Watched) -> None:
    for save in SAVES:
        save(watched.file, b"one", pause)
    watched.file.touch()
    (watched.folder / "notes.txt").write_text("nobody follows this", encoding="utf-8")
    assert watched.sees_nothing()


@pytest.mark.slow
def test_a_change_that_is_undone_before_it_is_taken_is_none(watched: Watched) -> None:
    save_in_place(watched.file, b"two")
    assert watched.woken.wait(LIMIT)
    watched.woken.clear()
    save_in_place(watched.file, b"one")
    assert watched.sees_nothing()
    save_in_place(watched.file, b"two")
    assert watched.sees(watched.file)


def test_a_deleted_file_is_a_change_and_so_is_its_return(watched: Watched) -> None:
    watched.file.unlink()
    assert watched.sees(watched.file)
    save_in_place(watched.file, b"back")
    assert watched.sees(watched.file)


def test_a_new_shader_next_to_a_watched_one_is_reported(watched: Watched) -> None:
    new = watched.folder / "new.glsl"
    save_in_place(new, b"new")
    assert watched.sees(new)


@pytest.mark.slow
def test_what_is_followed_may_change_at_any_time(watched: Watched) -> None:
    other = watched.folder / "other" / "sketch.toml"
    other.parent.mkdir()
    save_in_place(other, b"one")
    watched.watcher.follow([watched.file, other])
    save_in_place(other, b"two")
    assert watched.sees(other) and watched.is_idle()
    save_in_place(watched.include, b"nobody follows it any more")
    assert watched.sees_nothing()
    save_in_place(watched.file, b"two")
    assert watched.sees(watched.file)


def test_a_change_between_reading_and_following_is_not_lost(watched: Watched) -> None:
    other = watched.folder / "late.toml"
    read_at = time.time()
    time.sleep(0.06)
    save_in_place(other, b"saved while it was being read")
    watched.watcher.follow([watched.file, other], read_at=read_at)
    assert watched.sees(other)


@pytest.mark.slow
def test_what_a_reader_saw_and_was_never_reported_is_reported(watched: Watched) -> None:
    """It was away for a moment, just when another save had it read: deleted and created is no change."""
    watched.watcher.follow([watched.file, watched.include], read={watched.file: None})
    assert watched.sees(watched.file)
    now = signature(watched.file)
    time.sleep(0.06)  # so that its time is not that of this very moment
    watched.watcher.follow([watched.file, watched.include], read={watched.file: now})
    assert watched.sees_nothing()


def test_old_dated_save_during_read_is_not_lost(watched: Watched) -> None:
    other = watched.folder / "late.toml"
    save_in_place(other, b"one")
    read_at, read = time.time() + 1.0, {other: signature(other)}
    temporary = watched.folder / "unpacked.tmp"
    save_in_place(temporary, b"from an archive")
    os.utime(temporary, (1e9, 1e9))
    temporary.replace(other)
    watched.watcher.follow([watched.file, other], read_at=read_at, read=read)
    assert watched.sees(other)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system's folders hold files alone")
@pytest.mark.parametrize("kind", ["fifo", "zero"])
def test_what_is_no_file_is_reported_and_saves_after_it_as_well(watched: Watched, kind: str) -> None:
    watched.file.unlink()
    if kind == "fifo":
        os.mkfifo(watched.file)
    else:
        watched.file.symlink_to("/dev/zero")
    assert watched.sees(watched.file)
    watched.watcher.follow([watched.include])
    watched.watcher.follow([watched.file, watched.include])  # which waits for no writer
    watched.file.unlink()
    save_in_place(watched.file, b"two")
    assert watched.sees(watched.file)
    save_in_place(watched.file, b"three")
    assert watched.sees(watched.file)


def test_a_save_that_keeps_inode_size_and_time_is_seen(watched: Watched) -> None:
    before = watched.file.stat()
    save_in_place(watched.file, b"two")
    os.utime(watched.file, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert watched.sees(watched.file)


@pytest.mark.slow
def test_a_folder_that_vanishes_and_returns_is_found_again(watched: Watched) -> None:
    shutil.rmtree(watched.include.parent)
    assert watched.sees(watched.include)
    watched.include.parent.mkdir()
    save_in_place(watched.include, b"back")
    assert watched.sees(watched.include)
    save_in_place(watched.include, b"and changed")
    assert watched.sees(watched.include)


@pytest.mark.skipif(os.name == "nt", reason="links need a right of their own on Windows")
def test_a_file_behind_a_link_is_followed(watched: Watched) -> None:
    real = watched.folder / "elsewhere" / "real.glsl"
    real.parent.mkdir()
    save_in_place(real, b"one")
    link = watched.folder / "link.glsl"
    link.symlink_to(real)
    watched.watcher.follow([link])
    time.sleep(0.1)
    save_by_rename(real, b"two")
    assert watched.sees(link)


def test_nothing_runs_before_it_is_started(tmp_path: Path) -> None:
    before = threading.active_count()
    watcher = Watcher()
    watcher.follow([tmp_path / "a.glsl"])
    assert threading.active_count() == before
    watcher.stop()
