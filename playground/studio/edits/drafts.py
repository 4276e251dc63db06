"""The drafts of a sketch being worked on: what its files say, the user's edits, what is wrong. Draws nothing.

There are at most two. ``shown`` is the last one that drew well; ``coming`` is what was
saved or chosen since: it goes through the sandbox (where there is one), is then drawn,
and only then replaces ``shown``. If it fails, its error is reported and ``shown`` stays.
``Session`` draws them.

User edits change ``shown`` at once, and ``coming`` as well. A technique or a new data file that
the user chooses has to be checked first: it joins what is coming, so that a save and several
choices are checked together. If that fails, the latest choice is left out, a note says why, and the
rest is checked again. While another sketch is opened, edits change the one that is shown.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import reduce
from pathlib import Path

from playground.allowed_files import Signature, noting_places, reading_unsaved
from playground.engine.sandbox import SandboxReport, TrySketch
from playground.engine.sketch_warnings import newly_shadowed
from playground.errors import ParameterError, PlaygroundError
from playground.paths import shown as shown_path
from playground.shader.parameter import shortest
from playground.sketch.assign import TERRAIN_KEYS
from playground.sketch.find import find
from playground.sketch.flatten import omitted
from playground.sketch.load import load_with
from playground.sketch.model import Camera, Sketch, Value
from playground.sketch.replace_technique import with_texts
from playground.studio.edits.edits import Draft, Edits, StoredEdits, first_draft, reload_draft, stored, taken
from playground.studio.edits.history import CHECKED, Key, State, applied, changes_between, edits_of, state_of
from playground.studio.edits.technique_cache import TechniqueCache
from playground.studio.language import tr
from playground.studio.picture.gestures import suns_of, turned_sun
from playground.studio.reload.dependencies import watched
from playground.studio.reload.stages import (
    Checks,
    DrawnState,
    ReloadStage,
    Sandbox,
    explained,
    missing_file_error,
    refusal,
)

Change = Callable[[Draft], Draft]
"""Returns a draft with something edited; may raise ``PlaygroundError``."""


@dataclass(frozen=True)
class Choice:
    """One change of the user, and what of it has to be checked."""

    change: Change
    keys: frozenset[Key]  # all that it sets
    # Techniques, sources and files, by what they are for; None: the file's own again.
    chosen: Mapping[Key, object]

    @property
    def use(self) -> str:
        """The technique or source that is chosen; empty where it is the file's, or a data file."""
        return next((str(use) for (kind, _), use in self.chosen.items() if kind in CHECKED and use), "")

    @property
    def label(self) -> str:
        """What is chosen, for a message: "height: ./dunes"."""
        named = {
            path: value if kind in CHECKED or value is None else Path(str(value)).name
            for (kind, path), value in self.chosen.items()
        }
        return ", ".join(f"{path}: {value or tr('what the file says')}" for path, value in named.items())


def choice_of(change: Change, before: Edits, after: Edits) -> Choice:
    """Return a change with what it sets; ``chosen`` is empty where that needs no check."""
    old, new = changes_between(before, after)
    chosen = {
        key: value
        for key, value in new.items()
        if key[0] in CHECKED or isinstance(value, str) or isinstance(old[key], str)
    }
    return Choice(change, frozenset(new), chosen)


_NAMED = 2  # files that are named of those saved at once


class Drafts:
    """What is shown of a sketch's files, what is coming, and the user's edits."""

    def __init__(
        self,
        path: str | Path,
        checks: Checks,
        drawn: DrawnState,
        *,
        start: StoredEdits | None = None,
        plain: bool = False,
        dialect: str = "",
    ) -> None:
        self.path = find(path or "").absolute()  # the current folder may be deleted meanwhile
        self.shown: Draft | None = None
        self.coming: Draft | None = None
        self.stage = ReloadStage.NONE
        self.revision = 0  # counts what may change the picture
        self.notes: deque[str] = deque(maxlen=32)  # messages for the user; removed when they are shown
        self.read_at = 0.0  # [s since the epoch] when the files were last read
        self.places: dict[Path, Signature | None] = {}  # where files were looked for, and what was there
        self.texts: Mapping[str, str] = {}  # replace shaders' files, by absolute path
        self.unsaved: dict[Path, str] = {}  # are read in place of what is on disk, by absolute path
        self.plain = plain  # every technique in its canonical form
        self.draw_error: PlaygroundError | None = None  # of what is shown
        self.opening = False  # another sketch is coming than the one that is shown
        self.opened = 0  # how often ``open`` was called
        self.started = 0.0  # when what is coming began to be read
        self.sandbox_seconds = 0.0  # [s] that the sandbox took for it
        self.reads = 0  # how often what is shown was replaced by what its files say now
        self.read_changes: State = {}  # what that took from the edits last, and not the user
        self.sandboxed = checks.sandbox is not None
        self.checks = checks
        self._drawn = drawn
        self._start = start or StoredEdits()
        self._techniques = TechniqueCache()
        self._techniques.dialect = dialect
        self._subject = self.path.name  # what is read, or checked
        self._saved: Draft | None = None  # what is coming, without what the user has chosen meanwhile
        self._choices: list[Choice] = []  # of the user, that are checked with what is coming, in order
        self._aside: Sketch | None = None  # what the sandbox got last, where that is not what is coming
        self._coming_notes: list[str] = []
        self._load_error: PlaygroundError | None = None  # of the files as they were read last
        self._check_error: PlaygroundError | None = None  # of what is coming

    # ── state ────────────────────────────────────────────────────────────────

    @property
    def shown_path(self) -> Path:
        """The file of the sketch that is shown; before the first good one, of the one that is open."""
        return Path(self.shown.file.file) if self.opening and self.shown is not None else self.path

    @property
    def sketch(self) -> Sketch | None:
        """The sketch that is shown; None before the first good one."""
        return self.shown.sketch if self.shown else None

    @property
    def error(self) -> PlaygroundError | None:
        """What is wrong just now."""
        return self._check_error or self._load_error or self.draw_error

    @property
    def latest(self) -> Draft | None:
        """What is shown, or what will be shown of the same sketch if it proves good."""
        return self.coming if self._is_checked else self.shown

    @property
    def _is_checked(self) -> bool:
        """Whether a new state of the sketch that is shown is being checked."""
        return not self.opening and self.stage in (ReloadStage.SANDBOX, ReloadStage.DRAW)

    @property
    def testing(self) -> bool:
        """Whether an answer of the sandbox is awaited."""
        return self.stage is ReloadStage.SANDBOX

    @property
    def checking(self) -> tuple[str, float] | None:
        """What the sandbox checks, a file or a technique, and for how long [s]; None if nothing."""
        return (self._subject, self.checks.now() - self.started) if self.testing else None

    @property
    def files(self) -> frozenset[Path]:
        """Every file worth watching: of the drafts, those that an error points at, and where others may come.

        See ``dependencies.watched``.
        """
        drafts = [draft for draft in (self.shown, self.coming) if draft is not None]
        errors = [e for e in (self._load_error, self._check_error, self.draw_error) if e is not None]
        sketches = [sketch for draft in drafts for sketch in (draft.sketch, draft.file)]
        return watched(self.path, sketches, errors, self.places)

    @property
    def stored(self) -> StoredEdits:
        """What ``open`` takes to restore the edits of the sketch that is open; it may not be shown yet."""
        draft = self.coming if self.opening else self.latest or self.coming
        return self._start if draft is None else stored(draft)

    # ── files ────────────────────────────────────────────────────────────────

    def reload(self, changed: Iterable[Path] = ()) -> None:
        """Read the files again; what is new in them is shown once it has proved good.

        ``changed``: the files that were saved, where that is known.
        """
        self._begin(_listed(changed) or self.path.name)
        self.read_at = time.time()
        if self.stage is ReloadStage.FAILED:
            self._choices = []
        shown = None if self.opening else self.shown
        old = None if self.opening else self.shown or self.coming
        try:
            with reading_unsaved(self.unsaved), noting_places() as self.places:
                loaded = with_texts(load_with(self._techniques.begin(), self.path), self.texts)
            loaded = loaded.plainly(self.plain)
            draft, notes = reload_draft(old, loaded) if old else first_draft(loaded, self._start)
        except Exception as error:
            self._load_error = missing_file_error(self.path) or explained(error, self.path)
            self._saved = self._check_error = None
            self._propose([])
            return
        self._load_error = self._check_error = None
        self._saved = draft
        if shown is not None and loaded == shown.file:
            self.draw_error = None
            self.revision += 1  # the texts are the same, but an image may have changed
            is_new = self.sandboxed and self._drawn.reads_new_data(shown.sketch)
            self._saved, notes = shown if is_new else None, []
        elif shown is not None:
            notes += map(str, newly_shadowed(shown.file, draft.sketch))
        variants = self.checks.variants
        not_run = () if old is None else omitted(old.base, variants)
        notes += [note for note in omitted(draft.base, variants) if note not in not_run]
        self._propose(notes)

    def open(
        self,
        path: Path,
        *,
        keep: bool = False,
        start: StoredEdits | None = None,
        texts: Mapping[str, str] | None = None,
    ) -> None:
        """Open another sketch; the picture stays until that one has proved good.

        ``keep``: it is a copy of this one, and the user's edits go on. ``start``: the edits of the
        other; ``texts`` replace some of its files.
        """
        file = find(path).absolute()
        self._techniques.dialect = ""
        if not keep:
            self._leave_out(tr("another sketch is opened"), self._choices if self._is_checked else [])
            self._start, self._choices = start or StoredEdits(), []
        self.path, self.texts, self.opening = file, texts or {}, not keep
        self.opened += 1
        self.reload()

    def stay(self) -> None:
        """Read the files of the sketch that is shown again, and open no other."""
        if self.shown is not None:
            self.path, self.texts, self.opening = Path(self.shown.file.file), {}, False
            self.reload()

    def read_as(self, texts: Mapping[str, str]) -> None:
        """Replace shaders' files by texts, by absolute path; nothing is written."""
        if texts != self.texts:
            self.texts = dict(texts)
            self.reload()

    def take_typed(self, path: Path, text: str | None) -> None:
        """Read a text in place of what a file holds, which stays; None: the file itself again.

        What it says is shown once it has proved good, as if it had been saved.
        """
        before = self.unsaved.get(path)
        for place in {path, path.resolve()}:  # a reader follows links to some files
            if text is None:
                self.unsaved.pop(place, None)
            else:
                self.unsaved[place] = text
        if text != before:
            self.reload([path])

    def run_plain(self, plain: bool) -> None:
        """Run every technique in its canonical form, or fast variants again where they are verified."""
        if plain != self.plain:
            self.plain = plain
            self.reload()

    def choose(self, pass_name: str, use: str) -> None:
        """Fill a pass with another technique, once that has proved good."""
        self._change(lambda draft: draft.choose(pass_name, use))

    def feed(self, channel: str, source: str, /, **values: Value) -> None:
        """Feed a channel from another source, with ``values`` of its parameters, once it has proved good."""
        self._change(lambda draft: draft.feed(channel, source, **values))

    def show(self, draft: Draft) -> None:
        """Show a draft of this sketch that was drawn before; what is saved since goes on being checked."""
        self.revision += 1
        self.shown, self._choices = draft, []
        if self._is_checked:
            notes: list[str] = []
            if self._saved is not None:
                self._saved, notes = reload_draft(draft, self._saved.file)
            self._propose(notes)

    def note_read(self, edits: Edits) -> None:
        """Take in that the files were read, which left these of the edits that are shown."""
        self.reads += 1
        _, self.read_changes = changes_between(self.shown.edits if self.shown else Edits(), edits)

    def drawn_well(self) -> None:
        """Replace what is shown by what was coming: it has been drawn."""
        assert self.coming is not None
        if self.shown is None or self.shown.file is not self.coming.file:
            self.note_read((self._saved or self.coming).edits)
        self.shown, self.opening = self.coming, False
        self.notes.extend(self._coming_notes)
        self._drop_coming()
        self._check_error = self.draw_error = None

    def failed(self, error: Exception) -> None:
        """Report why what is coming cannot be shown; where it is more than one thing, check the rest."""
        error_explained, checked = explained(error, self.path), [c for c in self._choices if c.chosen]
        if checked and (self._saved is not None or len(checked) > 1):
            self._choices.remove(checked[-1])
            self._leave_out(error_explained.diagnostics[0].message, checked[-1:])
            self._propose(self._coming_notes)
        else:
            self.stage, self._check_error = ReloadStage.FAILED, error_explained

    def report(self, error: Exception) -> None:
        """Report why what is shown cannot be drawn any more."""
        self.draw_error = explained(error, self.path)

    def _begin(self, subject: str) -> None:
        self.started, self._subject = self.checks.now(), subject

    def _propose(self, notes: list[str]) -> None:
        """Check what was saved together with what the user has chosen since, if there is either."""
        draft, choices, self._choices = self._saved or self.shown, self._choices, []
        for choice in choices:
            assert draft is not None  # a user who chooses is shown something
            try:
                draft = choice.change(draft)
                self._choices.append(choice)
            except PlaygroundError as error:
                self._leave_out(error.diagnostics[0].message, [choice])
        if draft is None or not (self._saved or any(choice.chosen for choice in self._choices)):
            self._drop_coming()
            return
        self.coming, self._coming_notes = draft, notes
        self._check_error, self.sandbox_seconds = None, 0.0
        if self.checks.sandbox is None or not self._drawn.needs_drawing(draft.sketch):
            self.stage = ReloadStage.DRAW
            return
        self.stage, self._aside = ReloadStage.SANDBOX, None
        self._submit(self.checks.sandbox, draft.sketch)

    def _leave_out(self, why: str, choices: Iterable[Choice]) -> None:
        """Say that choices of the user are not taken."""
        self.notes.extend(
            tr("{label} is not taken: {why}", label=choice.label, why=why) for choice in choices
        )

    def _drop_coming(self) -> None:
        self.coming, self.stage, self._coming_notes = None, ReloadStage.NONE, []
        self._saved, self._choices = None, []

    # ── the sandbox ──────────────────────────────────────────────────────────

    def check_aside(self, sketch: Sketch) -> SandboxReport | None:
        """Return what the sandbox says of a sketch drawn besides this one; None while it is not known.

        What is coming goes first.
        """
        sandbox = self.checks.sandbox
        if sandbox is None:
            return SandboxReport(True)
        if self.testing:
            return None
        if self._aside is not sketch:
            self._aside = sketch
            self._submit(sandbox, sketch)
        report = sandbox.poll()
        if report is not None:
            self._aside = None
        return report

    def take_report(self) -> None:
        """Take in the answer of the sandbox, if one is awaited and there."""
        report = self.checks.sandbox.poll() if self.checks.sandbox is not None else None
        if report is None:
            return
        error = refusal(report)
        if error is None:
            self.stage, self.sandbox_seconds = ReloadStage.DRAW, report.seconds
        else:
            self.failed(error)

    def _submit(self, sandbox: Sandbox, sketch: Sketch) -> None:
        sandbox.submit(TrySketch(sketch, time=self.checks.sketch_time(), drivers=(self.checks.driver,)))

    # ── user edits ───────────────────────────────────────────────────────────

    def set(self, path: str, value: object) -> None:
        """Set a parameter by its path; a value that it does not take becomes a note."""
        if self.shown is None:
            return
        try:
            edited = self.shown.with_value(path, value)
        except ParameterError as error:
            self.notes.append(str(error))
            return
        value_before = edited.edits.values[-1][1]
        self._change(lambda draft: draft.with_edits(draft.edits.with_value(path, value_before)), edited)

    def set_all(self, values: Mapping[str, Value]) -> None:
        """Set several parameters at once; those that are locked, gone or do not take theirs stay."""
        if self.shown is not None:
            free = [(p, v) for p, v in values.items() if p not in self.shown.edits.locked]
            fit = {p: v for p, value in free if (v := taken(self.shown.base, p, value)) is not None}
            self._edit(
                lambda edits: replace(
                    edits, values=(*(v for v in edits.values if v[0] not in fit), *fit.items())
                )
            )

    def shorten_values(self) -> None:
        """Write edited values in the fewest digits that a shader reads as the same numbers."""

        def shortened(edits: Edits) -> Edits:
            return replace(
                edits, values=tuple((p, v if p in TERRAIN_KEYS else shortest(v)) for p, v in edits.values)
            )

        if self.shown is not None and shortened(self.shown.edits) != self.shown.edits:
            self._edit(shortened)

    def unset(self, *paths: str) -> None:
        """Reset parameters to the file's values."""
        self._change(lambda draft: reduce(Draft.without, paths, draft))

    def lock(self, path: str, locked: bool) -> None:
        """Lock a parameter against presets, randomising and reloads, or unlock it."""
        self._edit(lambda edits: edits.with_lock(path, locked))

    def restore(self, edits: Edits) -> bool:
        """Replace the edits: values and camera at once, techniques once they have proved good.

        Returns whether they are taken; a note or the error says why not.
        """
        if self.latest is None:
            return False
        edits_before = self.latest.edits
        _, changes = changes_between(edits_before, edits)

        def change(draft: Draft) -> Draft:
            """Make the changes between the two; on the edits that were known, exactly those wanted."""
            target = (
                edits
                if draft.edits == edits_before
                else edits_of(applied(state_of(draft.edits, {}), changes))
            )
            return draft.with_all(target)

        return self._change(change)

    def apply(self, changes: State) -> bool:
        """Make changes to the edits, None being what the file says; as ``restore``, which returns the same.

        Each draft gets all of them: what is coming may already have one that what is shown has not.
        """
        return self._change(
            lambda draft: draft.with_all(edits_of(applied(state_of(draft.edits, {}), changes)))
        )

    def restore_with_save(self, edits: Edits) -> None:
        """Replace values and camera in what was just saved; what is shown stays until that is drawn."""
        if self._is_checked and self._saved is not None:
            edits_saved = self._saved.edits
            kept = replace(edits, techniques=edits_saved.techniques, channels=edits_saved.channels)
            self._saved = self._saved.with_edits(kept)
            self.coming = self._saved
            for choice in self._choices:
                self.coming = choice.change(self.coming)
        else:
            self.restore(edits)

    def set_camera(self, camera: Camera | None) -> None:
        """Set the camera; None: the file's."""
        self._edit(lambda edits: replace(edits, camera=camera))

    def move_suns(self, across: float, up: float) -> None:
        """Move every sun of the sketch by so much of the picture's height, to the right and upwards."""
        if self.sketch is not None:
            for path, sun in suns_of(self.sketch).items():
                self.set(path, turned_sun(sun, across, up))

    def reset_values(self) -> None:
        """Reset all that is not locked, and every pass, to what the file says."""
        if self.shown is not None:
            locked = set(self.shown.edits.locked)
            left = tuple(v for v in self.shown.edits.values if v[0] in locked)
            self.restore(replace(self.shown.edits, values=left, techniques=(), channels=()))

    def _edit(self, change: Callable[[Edits], Edits]) -> None:
        self._change(lambda draft: draft.with_edits(change(draft.edits)))

    def _change(self, change: Change, edited: Draft | None = None) -> bool:
        """Change what is shown, and what is coming; what is new to the driver is checked first.

        ``edited`` is what is shown with the change, where that is known. Returns whether it is taken.
        """
        shown = self.shown
        if shown is None:
            return False
        self.revision += 1
        coming = self.coming if self._is_checked or self._choices else None
        saved = self._saved if self._is_checked else None
        try:
            edited = edited or change(shown)
            changed = change(coming) if coming is not None else edited
            saved = change(saved) if saved is not None else None
        except PlaygroundError as error:
            self._check_error = explained(error, self.path)
            return False
        made = choice_of(change, shown.edits, edited.edits)
        is_new = self._is_new(shown, edited) if made.chosen else False
        choice = choice_of(change, coming.edits, changed.edits) if coming is not None else made
        if is_new and not choice.chosen:
            choice = made  # it is being checked already
        if self.opening and is_new:
            self._leave_out(
                tr("{shown_path} is being opened, and not shown yet", shown_path=shown_path(self.path)),
                [choice],
            )
            return False
        if self.stage is ReloadStage.FAILED and not self.opening:
            if is_new or (choice.chosen and self._choices):
                if self._saved is not None:
                    self._load_error = self._check_error  # the files are still wrong
                self._drop_coming()  # another is chosen in place of what has failed
                self._check_error = coming = None
        if not is_new:
            self.shown = edited
            self._saved = saved or self._saved
        if is_new or (choice.chosen and coming is not None):
            if not is_new:  # it takes back what is being checked
                self._choices = [other for other in self._choices if not other.keys <= choice.keys]
            if is_new or any(other.keys & choice.keys for other in self._choices):  # else it is shown already
                self._choices.append(choice)
            self._begin(choice.use or self.path.name)
            self._propose(self._coming_notes)
        elif self._is_checked:
            self.coming = changed
            if any(other.keys & choice.keys for other in self._choices):  # it comes after them
                left = [other for other in self._choices if other.chosen or not other.keys <= choice.keys]
                self._choices = [*left, choice]
        return True

    def _is_new(self, shown: Draft, edited: Draft) -> bool:
        """Say whether a choice has to be checked first: a technique, or data that was never drawn with."""
        if edited.edits.techniques != shown.edits.techniques or edited.edits.channels != shown.edits.channels:
            return True
        return self.sandboxed and self._drawn.reads_new_data(edited.sketch)


def _listed(files: Iterable[Path]) -> str:
    """Return the names of files in a few words: "terrain.glsl", "terrain.glsl, wave.glsl and 2 more"."""
    names = sorted({path.name for path in files})
    more = tr(" and {value} more", value=len(names) - _NAMED) if len(names) > _NAMED else ""
    return ", ".join(names[:_NAMED]) + more
