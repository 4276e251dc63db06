"""Versions: each good save is kept once, within bounds; one that is gone back to loses nothing."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.errors import DataError
from playground.sketch.assign import values_of
from playground.sketch.model import Camera
from playground.studio.bench import Workbench
from playground.studio.edits.edits import Edits
from playground.studio.interface import WindowControls
from playground.studio.versions import store as store_module
from playground.studio.versions.store import State, VersionStore
from playground.studio.versions.versions import HELD, Versions

from .session_desk import BAD, GOOD, KERNEL, LEVEL, Harness, OpenSession

PIXELS = np.full((90, 160, 3), 128, np.uint8)


def state(level: float) -> State:
    return State(Edits(((LEVEL, level),)))


@pytest.fixture
def kept(tmp_path: Path) -> VersionStore:
    """Give the versions of a sketch, none so far."""
    return VersionStore(tmp_path / "sketch.toml", tmp_path / "state")


def keep(kept: VersionStore, text: str, level: float = 0.0, at: float = 0.0, **more: object) -> str:
    texts = {"sketch.toml": text.encode(), "hills.glsl": b"kernel"}
    return kept.keep("sketch.toml", texts, state(level), at=at, **more).key  # type: ignore[arg-type]


# ── the folder ───────────────────────────────────────────────────────────────


def test_what_is_kept_is_read_again(kept: VersionStore, tmp_path: Path) -> None:
    key = keep(kept, "a\r\n\N{SNOWMAN}", 0.5, at=7.0, pixels=PIXELS, name="first")
    (version,) = VersionStore(tmp_path / "sketch.toml", tmp_path / "state").versions()
    assert (version.key, version.at, version.name, version.state) == (key, 7.0, "first", state(0.5))
    assert kept.texts(version) == {"sketch.toml": "a\r\n\N{SNOWMAN}".encode(), "hills.glsl": b"kernel"}
    assert kept.picture(version).stat().st_size > 100


def test_the_same_is_kept_once_and_a_text_is_stored_once(kept: VersionStore) -> None:
    first = keep(kept, "a", at=1.0, name="named")
    assert keep(kept, "b", at=2.0) != first
    assert keep(kept, "a", 0.25, at=3.0) != first, "other values are another version"
    assert keep(kept, "a", at=4.0) == first
    assert [(v.at, v.name) for v in kept.versions()] == [(2.0, ""), (3.0, ""), (4.0, "named")]
    assert len(list((kept.folder / "texts").iterdir())) == 3, "a, b and the kernel"


def test_the_oldest_without_a_name_goes_first(tmp_path: Path) -> None:
    kept = VersionStore(tmp_path / "s.toml", tmp_path, most=3)
    for number in range(6):
        keep(kept, str(number), at=number, pixels=PIXELS, name="kept for ever" if number == 1 else "")
    assert [version.at for version in kept.versions()] == [1, 4, 5]
    assert len(list((kept.folder / "texts").iterdir())) == 4
    assert len(list((kept.folder / "pictures").iterdir())) == 3


def test_bytes_are_bounded(tmp_path: Path) -> None:
    kept = VersionStore(tmp_path / "s.toml", tmp_path, most_bytes=10_000)
    for number in range(8):
        keep(kept, f"{number}" * 3000, at=number)
    assert [version.at for version in kept.versions()] == [5, 6, 7]
    assert sum(f.stat().st_size for f in (kept.folder / "texts").iterdir()) <= 10_000
    with pytest.raises(DataError, match="larger"):
        keep(kept, "x" * 20_000)
    assert len(kept.versions()) == 3


def test_names_do_not_take_all_the_room(tmp_path: Path) -> None:
    kept = VersionStore(tmp_path / "s.toml", tmp_path, most=2)
    first = keep(kept, "0", name="a")
    keep(kept, "1", name="b")
    third = keep(kept, "2")
    with pytest.raises(DataError, match="names"):
        kept.rename(third, "c")
    kept.rename(first, "")
    kept.rename(third, "c")
    assert [version.name for version in kept.versions()] == ["b", "c"]


def test_a_list_that_cannot_be_read_is_set_aside_whole(kept: VersionStore) -> None:
    keep(kept, "a")
    (kept.folder / "versions.json").write_text('{"format": 1, "versions": [{"key"', encoding="utf-8")
    assert kept.versions() == ()
    aside = kept.folder.with_name(kept.folder.name + ".unread")
    assert len(list((aside / "texts").iterdir())) == 2
    assert str(aside) in kept.complaint
    keep(kept, "b")
    assert len(kept.versions()) == 1


def test_another_format_is_left_to_those_who_know_it(kept: VersionStore) -> None:
    keep(kept, "a")
    path = kept.folder / "versions.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"format": 2}), encoding="utf-8")
    assert kept.versions() == ()
    assert "format 2" in kept.complaint


def test_a_damaged_text_is_refused(kept: VersionStore) -> None:
    keep(kept, "a")
    (version,) = kept.versions()
    damaged = kept.folder / "texts" / dict(version.texts)["sketch.toml"]
    damaged.write_bytes(b"b")
    with pytest.raises(DataError, match="damaged"):
        kept.texts(version)
    damaged.unlink()
    with pytest.raises(DataError, match="cannot be read"):
        kept.texts(version)


def test_two_windows_keep_versions_of_one_sketch(kept: VersionStore, tmp_path: Path) -> None:
    other = VersionStore(tmp_path / "sketch.toml", tmp_path / "state")
    for number in range(4):
        keep((kept, other)[number % 2], str(number), at=number)
    assert [version.at for version in kept.versions()] == [0, 1, 2, 3]
    assert kept.versions() == other.versions()
    with kept._locked(), pytest.raises(DataError, match="another window"):
        keep(other, "later")


# ── a session ────────────────────────────────────────────────────────────────


@pytest.fixture
def versions(harness: Harness) -> Versions:
    """Give the versions of the sketch "one"; the state that it was opened in is kept."""
    made = Versions(harness.bench.actions, harness.bench.inspection.compare, folder=harness.folder / "kept")
    harness.bench.versions = made
    made.update(idle=True)
    assert len(made.items) == 1
    return made


def save(harness: Harness, old: str, new: str, name: str = "one/hills.glsl") -> None:
    """Save a file, let it draw, and have it kept."""
    harness.save(old, new, name)
    harness.answer(GOOD)
    harness.frame()
    harness.bench.versions.update(idle=True)


def ask(harness: Harness, versions: Versions) -> None:
    """Let the sandbox draw the version that is asked for."""
    harness.sandbox.answer = GOOD
    versions.update(idle=True)
    harness.frame()


def test_a_good_save_is_kept_and_a_bad_one_is_not(harness: Harness, versions: Versions) -> None:
    save(harness, "0.5 *", "0.25 *")
    assert len(versions.items) == 2
    harness.save("0.25 *", "0.125 *", "one/hills.glsl")
    versions.update(idle=True)
    assert len(versions.items) == 2, "the sandbox has not drawn it"
    harness.answer(BAD)
    versions.update(idle=True)
    assert len(versions.items) == 2
    save(harness, "0.125 *", "0.5 *")
    assert len(versions.items) == 2, "it is the first again"
    first = versions.items[-1]
    assert first.key == versions.current
    assert versions.picture(first).is_file()
    assert dict(first.texts).keys() == {"sketch.toml", "hills.glsl", "add.glsl"}


def test_looking_writes_nothing_and_ends_where_it_began(harness: Harness, versions: Versions) -> None:
    save(harness, "level = 0.25", "level = 0.5")
    text = (harness.folder / "one/hills.glsl").read_text()
    harness.drafts.set(LEVEL, 0.75)
    harness.frame()
    before, steps = harness.session.shown, len(harness.bench.undo.history.steps)
    versions.look(versions.items[0])
    assert harness.session.shown is before, "not before the sandbox has drawn it"
    ask(harness, versions)
    assert versions.looked == versions.items[0]
    assert harness.level == 0.25
    assert (harness.folder / "one/hills.glsl").read_text() == text
    versions.update(idle=True)
    assert len(versions.items) == 2, "what is looked at is not kept again"
    versions.leave()
    harness.frame()
    assert (harness.session.shown, harness.level) == (before, 0.75)
    assert len(harness.bench.undo.history.steps) == steps


def test_steps_go_through_the_versions_and_end_in_the_present(harness: Harness, versions: Versions) -> None:
    for before, after in (("0.25", "0.5"), ("0.5", "0.75")):
        save(harness, f"level = {before}", f"level = {after}")
    seen = []
    for by in (-1, -1, -1, 1, 1, 1):
        versions.step(by)
        ask(harness, versions)
        seen.append((harness.level, versions.is_looking))
    assert seen == [(0.5, True), (0.25, True), (0.25, True), (0.5, True), (0.75, True), (0.75, False)]
    assert "no version before" in harness.messages


def test_what_is_edited_while_looking_is_kept_as_another(harness: Harness, versions: Versions) -> None:
    save(harness, "level = 0.25", "level = 0.5")
    versions.look(versions.items[0])
    ask(harness, versions)
    harness.drafts.set(LEVEL, 0.875)
    harness.frame()
    versions.leave()
    harness.frame()
    assert harness.level == 0.5
    assert dict(versions.items[-1].state.edits.values) == {LEVEL: 0.875}
    assert len(versions.items) == 3


def test_a_save_ends_looking(harness: Harness, versions: Versions) -> None:
    save(harness, "level = 0.25", "level = 0.5")
    versions.look(versions.items[0])
    ask(harness, versions)
    save(harness, "level = 0.5", "level = 0.625")
    assert not versions.is_looking
    assert harness.level == 0.625


def test_values_that_looking_hid_are_there_again_after_a_save(harness: Harness, versions: Versions) -> None:
    save(harness, "level = 0.25", "level = 0.5")
    harness.drafts.set(LEVEL, 0.75)
    harness.frame()
    steps = len(harness.bench.undo.history.steps)
    versions.look(versions.items[0])
    ask(harness, versions)
    assert harness.level == 0.25
    save(harness, "0.5 *", "0.25 *")
    harness.frame()
    assert (harness.level, versions.is_looking) == (0.75, False)
    assert len(harness.bench.undo.history.steps) == steps


def test_a_version_that_does_not_draw_is_not_shown(harness: Harness, versions: Versions) -> None:
    save(harness, "level = 0.25", "level = 0.5")
    versions.look(versions.items[0])
    harness.sandbox.answer = BAD
    versions.update(idle=True)
    assert not versions.is_looking
    assert harness.level == 0.5
    assert "does not draw" in harness.messages


def test_going_back_is_one_step_and_loses_nothing(harness: Harness, versions: Versions) -> None:
    kernel, sketch = harness.folder / "one/hills.glsl", harness.folder / "one/sketch.toml"
    first = versions.items[0]
    save(harness, "level = 0.25", "level = 0.5")
    save(harness, "size = 9", "size = 10", "one/sketch.toml")
    harness.drafts.set(LEVEL, 0.75)
    harness.frame()
    texts = kernel.read_bytes(), sketch.read_bytes()
    steps = len(harness.bench.undo.history.steps)
    assert versions.go_back(first)
    harness.answer(GOOD)
    harness.frame()
    assert kernel.read_text() == KERNEL
    assert (harness.level, harness.size) == (0.25, 9)
    assert len(harness.bench.undo.history.steps) == steps + 1
    assert "new value" not in harness.messages
    present = versions.items[-1]
    assert dict(present.state.edits.values) == {LEVEL: 0.75}, "the present state was kept first"
    harness.bench.undo.undo()
    harness.answer(GOOD)
    harness.frame()
    assert (kernel.read_bytes(), sketch.read_bytes()) == texts
    assert (harness.level, harness.size) == (0.75, 10)
    harness.bench.undo.redo()
    harness.answer(GOOD)
    harness.frame()
    assert kernel.read_text() == KERNEL
    assert (harness.level, harness.size) == (0.25, 9)


def test_going_back_keeps_what_is_wrong_in_the_files(harness: Harness, versions: Versions) -> None:
    harness.save("return", "retrun", "one/hills.glsl")
    harness.answer(BAD)
    assert versions.go_back(versions.items[0])
    broken = versions._store.texts(versions.items[-1])["hills.glsl"]
    assert b"retrun" in broken
    assert (harness.folder / "one/hills.glsl").read_text() == KERNEL


def test_what_is_typed_and_not_saved_is_kept_before_going_back(harness: Harness, versions: Versions) -> None:
    kernel = harness.folder / "one/hills.glsl"
    first = versions.items[0]
    harness.drafts.take_typed(kernel, KERNEL.replace("level = 0.25", "level = 0.5"))
    harness.answer(GOOD)
    harness.frame()
    versions.update(idle=True)
    assert harness.level == 0.5
    assert len(versions.items) == 1, "it is not saved"
    assert versions.go_back(first)
    harness.answer(GOOD)
    harness.frame()
    assert (harness.level, kernel.read_text()) == (0.25, KERNEL)
    assert b"level = 0.5" in versions._store.texts(versions.items[-1])["hills.glsl"]


def test_an_undo_does_not_write_over_what_was_saved_since(harness: Harness, versions: Versions) -> None:
    first = versions.items[0]
    save(harness, "level = 0.25", "level = 0.5")
    versions.go_back(first)
    harness.answer(GOOD)
    save(harness, "level = 0.25", "level = 0.875")
    harness.bench.undo.undo()
    assert "changed meanwhile" in harness.messages
    assert "0.875" in (harness.folder / "one/hills.glsl").read_text()


def test_a_full_disk_is_said_once_and_refuses_to_go_back(
    harness: Harness, versions: Versions, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(path: Path, _: bytes) -> None:
        raise DataError("cannot be written: No space left on device", file=path)

    first = versions.items[0]
    monkeypatch.setattr(store_module, "write_file", full)
    said = []
    monkeypatch.setattr(harness.bench.notices, "say", said.append)
    save(harness, "level = 0.25", "level = 0.5")
    save(harness, "level = 0.5", "level = 0.625")
    assert len([text for text in said if "No space" in text]) == 1
    assert not versions.go_back(first)
    assert "0.625" in (harness.folder / "one/hills.glsl").read_text()
    assert len([text for text in said if "No space" in text]) == 2


def test_a_version_is_compared_as_a(harness: Harness, versions: Versions) -> None:
    save(harness, "level = 0.25", "level = 0.5")
    versions.compare(versions.items[0])
    ask(harness, versions)
    compare = harness.bench.inspection.compare
    assert compare.on
    assert harness.level == 0.5
    compare.follow(harness.session.frame((32, 24)))
    assert compare.draws == 1
    compare.release()


def test_a_version_is_compared_with_as_long_as_it_is_held(harness: Harness, versions: Versions) -> None:
    save(harness, "level = 0.25", "level = 0.5")
    compare, now = harness.bench.inspection.compare, [0.0]
    harness.bench.notices.now = lambda: now[0]
    versions.hold()
    now[0] = HELD / 2
    versions.hold()
    assert not versions.let_go() and not compare.on, "a click"
    versions.hold()
    now[0] += HELD
    versions.hold()
    ask(harness, versions)
    assert compare.on and compare.split == 1.0 and compare.stored is not None
    assert dict(values_of(compare.stored.draft.sketch))["height.level"] == 0.25
    assert versions.let_go() and not compare.on and compare.split == 0.5 and not versions.is_looking


def test_what_was_compared_before_a_hold_is_again_after_it(harness: Harness, versions: Versions) -> None:
    save(harness, "level = 0.25", "level = 0.5")
    compare, now = harness.bench.inspection.compare, [0.0]
    harness.bench.notices.now = lambda: now[0]
    compare.keep()
    compare.split, before = 0.25, compare.stored
    versions.hold(versions.items[0])
    now[0] += HELD
    versions.hold(versions.items[0])
    assert versions.let_go(), "before the sandbox has drawn it"
    versions.update(idle=True)
    assert compare.stored is before and compare.split == 0.25
    versions.hold(versions.items[0])
    now[0] += HELD
    versions.hold(versions.items[0])
    ask(harness, versions)
    assert compare.stored is not before
    versions.let_go()
    assert compare.stored is before and compare.split == 0.25
    compare.release()


def test_texts_values_and_camera_of_a_version_come_back(harness: Harness, versions: Versions) -> None:
    drafts, kernel = harness.session.drafts, harness.folder / "one" / "hills.glsl"
    text, camera = kernel.read_bytes(), Camera(12.345678901, 33.3, 777.25, (1.5, 2.0, 0.1 + 0.2), 41.0)
    drafts.set("height.level", 0.1 + 0.2)
    drafts.set_camera(camera)
    harness.session.stop_at("height", 2)
    harness.frame()
    assert versions.keep("first")
    first = next(version for version in versions.items if version.name == "first")
    drafts.set("height.level", 0.75)
    drafts.set_camera(None)
    save(harness, "0.5 *", "0.25 *")
    assert versions.go_back(first)
    harness.answer(GOOD)
    harness.frame()
    shown = harness.session.shown
    assert shown is not None and kernel.read_bytes() == text
    assert shown.edits.camera == camera and dict(shown.edits.values) == {"height.level": 0.1 + 0.2}
    assert harness.session.view.steps == {"height": 2}


def test_a_name_is_kept_and_can_be_taken_away(harness: Harness, versions: Versions) -> None:
    harness.drafts.set(LEVEL, 0.75)
    harness.frame()
    assert versions.keep("  the ridge ")
    (_, named) = versions.items
    assert (named.name, dict(named.state.edits.values)) == ("the ridge", {LEVEL: 0.75})
    versions.rename(named, "")
    assert versions.items[-1] == replace(named, name="")
    versions.remove(named)
    assert len(versions.items) == 1


def test_a_version_becomes_a_sketch_of_its_own(harness: Harness, versions: Versions) -> None:
    first = versions.items[0]
    save(harness, "level = 0.25", "level = 0.5")
    assert versions.as_new_sketch(first)
    harness.answer(GOOD)
    new = harness.session.path.parent
    assert new not in (harness.folder / "one", harness.folder / "two")
    assert (new / "hills.glsl").read_text() == KERNEL
    assert (new / "a.npy").is_file()
    assert harness.level == 0.25
    versions.update(idle=True)
    assert len(versions.items) == 1, "it has versions of its own"


def test_an_elevation_file_alone_has_versions_of_its_values(
    tmp_path: Path, open_session: OpenSession
) -> None:
    np.save(tmp_path / "hills.npy", np.random.default_rng(1).random((9, 9), np.float32))
    session = open_session(tmp_path / "hills.npy")
    session.frame((32, 24))
    session.read()  # in full
    bench = Workbench(session, WindowControls(lambda: None), folder=tmp_path)
    versions = Versions(bench.actions, bench.inspection.compare, folder=tmp_path / "kept")
    versions.update(idle=True)
    (version,) = versions.items
    assert version.texts == ()
    session.drafts.set_camera(Camera(azimuth=10.0))
    session.frame((32, 24))
    assert versions.go_back(version)
    assert session.shown is not None and session.shown.edits.camera is None
    assert not versions.as_new_sketch(version)
