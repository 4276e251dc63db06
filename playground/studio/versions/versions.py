"""The versions of the sketch that is open: kept when a saved text has drawn, looked at, gone back to.

What is saved and draws well becomes a version by itself, as does what is named. Looking at one shows it as a
draft: its texts are read in place of what the files hold, and nothing is written.
Going back writes the files, as one step of the history, after the present state has become a version itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.allowed_files import is_elevation, reading_unsaved, signature
from playground.errors import DataError, PlaygroundError
from playground.files import new_name, write_file
from playground.paths import GLSL
from playground.sketch.load import load_with
from playground.sketch.model import Sketch
from playground.sketch.save import save_copy
from playground.sketch.techniques import Techniques
from playground.studio.actions import Actions
from playground.studio.compare.compare import Compare, Mode, Stored
from playground.studio.edits.edits import Draft, file_values, first_draft, reload_draft
from playground.studio.edits.history import TEXT, Key, state_of
from playground.studio.language import tr
from playground.studio.reload.stages import ReloadStage
from playground.studio.save.sketch_file import contents_of
from playground.studio.versions.store import State, Version, VersionStore, hash_of_text, key_of

HELD = 0.25
"""[s] after which a version that is held is compared with."""
_LOOKS = 0.05  # [s] between questions to the sandbox about a version


@dataclass
class _Asked:
    """A version that is to be shown, once it has proved good."""

    version: Version
    draft: Draft
    show: Callable[[Draft], None]


@dataclass
class _Held:
    """A version that is held, and what was compared before."""

    version: Version
    since: float  # [s]
    compared: Stored | None
    mode: Mode
    split: float
    is_asked: bool = False
    is_shown: bool = False


class Versions:
    """Those of one session's sketch."""

    def __init__(
        self,
        actions: Actions,
        compare: Compare,
        *,
        folder: Path | None = None,
        is_left_out: Callable[[], bool] = lambda: False,
    ) -> None:
        self.actions = actions
        self.session = actions.session
        self.looked: Version | None = None  # the version that is shown as a draft
        self.selected = ""  # the key of the one that buttons are for
        self._compare = compare
        self._folder = folder
        self._is_left_out = is_left_out  # says whether what is shown is not the user's sketch
        self._store = VersionStore(self.session.drafts.shown_path, folder)
        self._kept_of: Sketch | None = None  # the files' text that was kept last, or could not be
        self._current = ""  # the key of the version that was kept, or gone back to, last
        self._hashes: tuple[tuple[str, str], ...] = ()  # of that
        self._asked: _Asked | None = None
        self._before: tuple[Draft, dict[str, int]] | None = None  # what looking took the place of
        self._looked_draft: Draft | None = None
        self._is_reported = False
        self._held: _Held | None = None

    # ── state ────────────────────────────────────────────────────────────────

    @property
    def items(self) -> tuple[Version, ...]:
        """All versions, the oldest first."""
        return self._store.versions()

    @property
    def current(self) -> str:
        """The key of the version whose texts are those of the files."""
        return self._current

    @property
    def is_looking(self) -> bool:
        """Whether a version is shown, or about to be, in place of what is worked on."""
        return self.looked is not None

    @property
    def chosen(self) -> Version | None:
        """The version that buttons are for: the selected one, else none."""
        return next((version for version in self.items if version.key == self.selected), None)

    @property
    def patience(self) -> float:
        """How long nothing needs to be done here [s]."""
        waits = self._asked is not None or (self._held is not None and not self._held.is_asked)
        return _LOOKS if waits else math.inf

    def picture(self, version: Version) -> Path:
        """Return the file of a version's picture; it may be missing."""
        return self._store.picture(version)

    # ── keeping ──────────────────────────────────────────────────────────────

    def update(self, *, idle: bool) -> None:
        """Go on after a frame: show what has proved good, keep what was saved; ``idle``: there is time."""
        session = self.session
        if session.drafts.shown_path != self._store.sketch:
            self._switch()
        self._go_on()
        if self._looked_draft is not None and (
            session.shown is None or session.shown.file is not self._looked_draft.file
        ):
            self._end_look()  # a save came meanwhile
        shown = session.shown
        if not idle or shown is None or shown.file is self._kept_of or self.is_looking:
            return
        if not session.is_idle or session.error is not None or self._is_left_out():
            return
        texts = self._texts_as_read(shown)
        if texts is not None:
            self._kept_of = shown.file
            self._keep(texts, shown)

    def keep(self, name: str) -> bool:
        """Keep the present state under a name; return whether that is done."""
        self.leave()
        shown = self.session.shown
        if shown is None or not self.session.draws:
            self._say(tr("there is no picture to keep yet"))
            return False
        texts = self._texts_as_read(shown)
        if texts is None:
            self._say(tr("what is in the files is not drawn yet; name it once it is shown"))
            return False
        return self._keep(texts, shown, name=name.strip(), always=True)

    def rename(self, version: Version, name: str) -> None:
        """Name a version, so that it is kept for ever; with "" it goes when there are too many."""
        with self._reported():
            self._store.rename(version.key, name.strip())

    def remove(self, version: Version) -> None:
        """Remove a version."""
        if self.looked is not None and self.looked.key == version.key:
            self.leave()
        with self._reported():
            self._store.remove(version.key)

    def _keep(
        self, texts: Mapping[str, bytes], draft: Draft, *, name: str = "", always: bool = False
    ) -> bool:
        """Keep a state; what fails is said once, or ``always``. Return whether it is kept."""
        main = _relative(Path(draft.file.file), Path(draft.file.folder))
        try:
            kept = self._store.keep(
                main, texts, _state_of(draft, self.session.view.steps), pixels=self._pixels(), name=name
            )
        except PlaygroundError as error:
            if always or not self._is_reported:
                self._is_reported = True
                self._say(tr("no version is kept: {error}", error=error))
            return False
        finally:
            self._take_complaint()
        self._current, self._hashes = kept.key, kept.texts
        return True

    def _pixels(self) -> NDArray[np.uint8] | None:
        try:
            frame = self.session.read()
        except PlaygroundError:
            return None
        return None if frame is None else frame.array

    def _texts_as_read(self, draft: Draft) -> dict[str, bytes] | None:
        """Return what the sketch's own files hold; None where that is not what is shown."""
        drafts = self.session.drafts
        texts = {}
        for name, path in own_texts(draft.file).items():
            now, noted = signature(path), drafts.places.get(path)
            if now is None or (noted != now if noted else now.latest > drafts.read_at * 1e9):
                return None
            data = _contents(path)
            if data is None or path in drafts.unsaved or str(path) in drafts.texts:
                return None
            texts[name] = data
        return texts

    # ── looking, comparing ───────────────────────────────────────────────────

    def look(self, version: Version) -> None:
        """Show a version as a draft, once it has proved good; nothing is written."""
        self._ask(version, self._show)

    def step(self, by: int) -> None:
        """Look at the version before (-1) or after (1) what is shown; after the last is the present."""
        items = self.items
        keys = [version.key for version in items]
        if self.selected in keys:
            at = keys.index(self.selected)
        else:
            at = len(keys) - (bool(keys) and keys[-1] == self._current)
        if at + by >= len(keys):
            self.leave()
        elif at + by < 0:
            self._say(tr("there is no version before this one"))
        else:
            self.look(items[at + by])

    def compare(self, version: Version) -> None:
        """Compare what is shown with a version: it becomes A."""
        self._ask(version, lambda draft: self._compare.keep_state(draft, dict(version.state.steps)))

    def select(self, version: Version) -> None:
        """Have buttons and keys be for a version, without showing it."""
        self.selected = version.key

    def hold(self, version: Version | None = None) -> None:
        """Show a version in place of what is shown until ``let_go``: call it as long as it is held.

        It is shown once it has been held for a moment, so that a click is none. By default it is the selected
        one, else the one before the present.
        """
        if self._held is None:
            kept = [item for item in self.items if item.key != self._current]
            version = version or self.chosen or (kept[-1] if kept else None)
            if version is not None and self.session.shown is not None:
                compare = self._compare
                self._held = _Held(
                    version, self.actions.notices.now(), compare.stored, compare.mode, compare.split
                )
        elif not self._held.is_asked and self.actions.notices.now() - self._held.since >= HELD:
            self._held.is_asked = True
            with self._reported():
                draft = self._draft_of(self._held.version)
                self._asked = _Asked(self._held.version, draft, self._show_held)
                self._go_on()

    def let_go(self) -> bool:
        """End what ``hold`` shows, and compare as before; return whether it was more than a click."""
        held, self._held = self._held, None
        if held is None or not held.is_asked:
            return False
        if self._asked is not None and self._asked.show == self._show_held:
            self._asked = None
        if held.is_shown:
            if held.compared is not None:
                self._compare.resume(held.compared)
            else:
                self._compare.end()
            self._compare.mode, self._compare.split = held.mode, held.split
        return True

    def _show_held(self, draft: Draft) -> None:
        if self._held is not None:
            self._held.is_shown = True
            self._compare.keep_state(draft, dict(self._held.version.state.steps))
            self._compare.mode, self._compare.split = Mode.DIVIDER, 1.0

    def leave(self) -> None:
        """Show again what looking took the place of."""
        self._asked, self.selected = None, ""
        if self._before is None:
            return
        (draft, steps), session = self._before, self.session
        self._keep_edited()
        self._forget_look()
        self._show_draft(draft, steps)
        session.redraw()

    def _ask(self, version: Version, show: Callable[[Draft], None]) -> None:
        self.selected = version.key
        session = self.session
        if session.shown is None or session.drafts.opening:
            return
        if session.drafts.stage not in (ReloadStage.NONE, ReloadStage.FAILED):
            self._say(tr("what was saved is being checked; look again in a moment"))
            return
        with self._reported():
            self._asked = _Asked(version, self._draft_of(version), show)
            self._go_on()

    def _go_on(self) -> None:
        """Show the version that was asked for, once the sandbox has drawn it."""
        asked, session = self._asked, self.session
        if asked is None:
            return
        report = session.drafts.check_aside(asked.draft.sketch)
        if report is None:
            return
        self._asked = None
        if not report.ok:
            self._say(tr("this version does not draw any more: {error}", error=report.error))
        elif session.shown is not None and not session.drafts.opening:
            asked.show(asked.draft)
            if asked.show == self._show:
                self.looked = asked.version

    def _show(self, draft: Draft) -> None:
        session = self.session
        assert session.shown is not None and self._asked is None
        if self._before is None:
            self.actions.undo.record()
            self._before = session.shown, dict(session.view.steps)
        version = self.chosen
        self._looked_draft = draft
        self._show_draft(draft, dict(version.state.steps) if version else {})

    def _show_draft(self, draft: Draft, steps: Mapping[str, int]) -> None:
        self.session.drafts.show(draft)
        self.session.view.steps.clear()
        self.session.view.steps.update(steps)
        self.session.redraw()
        self.actions.undo.settle()  # no step: nothing of it is the user's work

    def _end_look(self) -> None:
        """Go on with what was saved meanwhile, and with the edits that looking took the place of."""
        before, session = self._before, self.session
        self._keep_edited()
        self._forget_look()
        self.selected = ""
        if before is None or session.shown is None or session.drafts.opening:
            return
        draft, notes = reload_draft(before[0], session.shown.file)
        session.notes.extend(notes)
        session.drafts.restore(draft.edits)
        for path, step in before[1].items():
            session.stop_at(path, step)
        self.actions.undo.settle()

    def _keep_edited(self) -> None:
        """Keep what was edited over the version that is looked at, as a version of its own."""
        looked, shown, before = self.looked, self.session.shown, self._looked_draft
        if looked is None or shown is None or before is None or shown.edits == before.edits:
            return
        if shown.file is not before.file:
            return  # what was saved since has taken them in
        with self._reported():
            texts, state = self._store.texts(looked), _state_of(shown, self.session.view.steps)
            self._store.keep(looked.main, texts, state, pixels=self._pixels())
            self._say(tr("what you changed over that version is kept as another"))

    def _forget_look(self) -> None:
        self.looked = self._before = self._looked_draft = None

    def _draft_of(self, version: Version) -> Draft:
        """Return a version as it is drawn; raise ``PlaygroundError`` where it cannot be read any more."""
        present = self._before[0] if self._before is not None else self.session.shown
        assert present is not None
        file = present.file
        if version.texts != self._hashes or file is not self._kept_of:
            file = self._loaded(version)
        return first_draft(file, version.state.start)[0]

    def _loaded(self, version: Version) -> Sketch:
        texts: dict[Path, str] = {}
        for name, data in self._store.texts(version).items():
            path = self._path(name)
            texts[path] = texts[path.resolve()] = _decoded(data)
        with reading_unsaved(texts):
            loaded = load_with(Techniques(), self._path(version.main))
        return loaded.plainly(self.session.drafts.plain)

    # ── going back, going on from ────────────────────────────────────────────

    def go_back(self, version: Version) -> bool:
        """Write a version's files and edits, as one step; the present state becomes a version first.

        Return whether that is done; else a notice says why, and nothing has changed.
        """
        self.leave()
        session, undo = self.session, self.actions.undo
        shown = session.shown
        if shown is None or session.drafts.opening:
            return False
        with self._reported():
            wanted = self._store.texts(version)
            own, drafts = own_texts(shown.file), session.drafts
            now = {name: data for name, path in own.items() if (data := _contents(path)) is not None}
            for name in wanted.keys() - now.keys():  # a file that what is shown no longer uses
                data = contents_of(self._path(name))
                now |= {name: data} if data not in (None, wanted[name]) else {}
            typed = {
                name: drafts.unsaved[path].encode() for name, path in own.items() if path in drafts.unsaved
            }
            self._keep_present(now | typed, shown)
            for name in typed:
                drafts.take_typed(own[name], None)
            changed = [name for name, data in wanted.items() if _contents(self._path(name)) != data]
            before: dict[Key, object] = dict(state_of(shown.edits, session.view.steps))
            after: dict[Key, object] = dict(state_of(version.state.edits, dict(version.state.steps)))
            keys = {*before, *after}
            before, after = {k: before.get(k) for k in keys}, {k: after.get(k) for k in keys}
            for name in changed:
                key = TEXT, str(self._path(name))
                before[key], after[key] = now.get(name), wanted[name]
            if before == after:
                if not typed:
                    self._say(tr("this version is what is shown"))
                return bool(typed)
            if not undo.perform(before, after, tr("Back to {version}", version=title_of(version))):
                return False
            self._current, self._hashes, self._kept_of = version.key, version.texts, None
            return True
        return False

    def as_new_sketch(self, version: Version) -> bool:
        """Write a version as a sketch of its own in the folder for copies, and open it."""
        self.leave()
        with self._reported():
            texts = self._store.texts(version)
            if version.main not in texts:
                self._say(tr("an elevation file has no text; Save makes a sketch of it"))
                return False
            if Path(version.main).suffix != ".toml":
                with new_name(self.actions.folder / Path(version.main).name) as path:
                    write_file(path, texts[version.main])
            else:
                draft = self._draft_of(version)
                own = {name: data for name, data in texts.items() if name != version.main}
                main = _decoded(texts[version.main])
                path = save_copy(draft.file, draft.sketch, self.actions.folder, main=main, texts=own)
            if self.actions.open(path):
                self._say(tr("the version is a sketch of its own: {path}; Backspace goes back", path=path))
                return True
        return False

    def _keep_present(self, texts: Mapping[str, bytes], draft: Draft) -> None:
        """Keep what is about to be written over, unless it is a version already; raise ``DataError``."""
        main = _relative(Path(draft.file.file), Path(draft.file.folder))
        state = _state_of(draft, self.session.view.steps)
        hashes = tuple((name, hash_of_text(data)) for name, data in sorted(texts.items()))
        if all(row.key != key_of(main, hashes, state) for row in self.items):
            self._store.keep(main, texts, state, pixels=self._pixels())

    # ── parts ────────────────────────────────────────────────────────────────

    def _switch(self) -> None:
        """Go on with the versions of another sketch: the one that is shown."""
        self._store = VersionStore(self.session.drafts.shown_path, self._folder)
        self._forget_look()
        self._asked, self._kept_of, self._current, self._hashes = None, None, "", ()
        self._is_reported, self.selected = False, ""

    def _path(self, name: str) -> Path:
        return self._sketch_folder() / name

    def _sketch_folder(self) -> Path:
        shown = self.session.shown
        return Path(shown.file.folder) if shown is not None else self._store.sketch.parent

    @contextmanager
    def _reported(self) -> Iterator[None]:
        """Put what goes wrong in the block on the screen."""
        try:
            yield
        except PlaygroundError as error:
            self._say(str(error))
        finally:
            self._take_complaint()

    def _take_complaint(self) -> None:
        if self._store.complaint:
            self._say(self._store.complaint)
            self._store.complaint = ""

    def _say(self, text: str) -> None:
        self.actions.notices.say(text)


def own_texts(sketch: Sketch) -> dict[str, Path]:
    """Return a sketch's own texts, by their names relative to its folder; none of what ships.

    Of a sketch that ships itself they are its file and those beside it. An elevation file is no text.
    """
    folder, main = Path(sketch.folder), Path(sketch.file)
    files = [main, *(Path(name) for name in sketch.files)]
    own = [path for path in files if path.is_relative_to(folder) and (folder != GLSL or path == main)]
    return {_relative(path, folder): path for path in own if _is_text(path)}


def title_of(version: Version) -> str:
    """Return what a version is called: its name, else when it was kept."""
    from datetime import datetime

    at = datetime.fromtimestamp(version.at)
    is_today = at.date() == datetime.now().date()
    return version.name or at.strftime("%H:%M:%S" if is_today else "%Y-%m-%d %H:%M")


def _is_text(path: Path) -> bool:
    """Return whether a name is that of a text file: a kernel inside another text has none of its own."""
    return path.is_file() and not is_elevation(path)


def _relative(path: Path, folder: Path) -> str:
    return path.relative_to(folder).as_posix() if path.is_relative_to(folder) else path.name


def _contents(path: Path) -> bytes | None:
    try:
        return contents_of(path)
    except DataError:
        return None


def _decoded(data: bytes) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _state_of(draft: Draft, steps: Mapping[str, int]) -> State:
    edits = draft.edits
    return State(
        edits,
        tuple(sorted(file_values(draft.base, [path for path, _ in edits.values]).items())),
        draft.file.camera if edits.camera is not None else None,
        tuple(sorted(steps.items())),
    )
