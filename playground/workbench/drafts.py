"""The drafts of a sketch being worked on: what its files say, the user's edits, what is wrong. Draws nothing.

There are at most two. ``shown`` is the last one that drew well; ``coming`` is what was
saved or chosen since: it goes through the sandbox (where there is one), is then drawn,
and only then replaces ``shown``. If it fails, its error is reported and ``shown`` stays.
``workbench.session`` draws them.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from playground.engine.sandbox import SandboxReport, TrySketch
from playground.errors import ContextError, ParameterError, PlaygroundError
from playground.sketch.allowed_files import Signature, noting_places
from playground.sketch.assign import TERRAIN_KEYS
from playground.sketch.find import find
from playground.sketch.load import load_with
from playground.sketch.model import Camera, Sketch, Value
from playground.sketch.shadowed import newly_shadowed
from playground.sketch.technique_cache import KeptTechniques
from playground.sketch.text_overrides import with_texts
from playground.sketch.values import shortest
from playground.sketch.variants import left_out
from playground.workbench.dependencies import watched
from playground.workbench.edits import Draft, Edits, reload_draft, taken
from playground.workbench.reload_stages import ReloadStage, Sandbox, explained, missing_file_error
from playground.workbench.resume import StoredEdits, first_draft, stored
from playground.workbench.sun_drag import suns_of, turned

_NAMED = 2  # files that are named of those saved at once


class Drawn(Protocol):
    """What has been drawn already: it needs no sandbox."""

    def needs_drawing(self, sketch: Sketch) -> bool:
        """Say whether the driver would get anything that it has not drawn already."""

    def reads_new_data(self, sketch: Sketch) -> bool:
        """Say whether a sketch reads data that was never drawn with."""


@dataclass(frozen=True, kw_only=True)
class Checks:
    """Where and how a draft is checked before it is drawn."""

    driver: str
    variants: tuple[str, ...] = ()  # kinds of fast variants that can run
    sandbox: Sandbox | None = None
    now: Callable[[], float] = time.perf_counter  # [s] of any clock
    sketch_time: Callable[[], float] = lambda: 0.0  # [s] at which the sandbox draws


class Drafts:
    """What is shown of a sketch's files, what is coming, and the user's edits."""

    def __init__(
        self,
        path: str | Path,
        checks: Checks,
        drawn: Drawn,
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
        self.notes: deque[str] = deque(maxlen=32)  # sentences for a person; whoever shows them removes them
        self.read_at = 0.0  # [s since the epoch] when the files were last read
        self.places: dict[Path, Signature | None] = {}  # where files were looked for, and what was there
        self.texts: Mapping[str, str] = {}  # replace shaders' files, by absolute path
        self.plain = plain  # every technique in its canonical form
        self.draw_error: PlaygroundError | None = None  # of what is shown
        self.opening = False  # another sketch is coming than the one that is shown
        self.started = 0.0  # when what is coming began to be read
        self.sandbox_seconds = 0.0  # [s] that the sandbox took for it
        self.sandboxed = checks.sandbox is not None
        self._checks = checks
        self._drawn = drawn
        self._start = start or StoredEdits()
        self._techniques = KeptTechniques()
        self._techniques.dialect = dialect
        self._subject = self.path.name  # what is read, or checked
        self._new_file = False  # what is coming names a data file that the user chose
        self._aside: Sketch | None = None  # what the sandbox got last, where that is not what is coming
        self._coming_notes: list[str] = []
        self._file_error: PlaygroundError | None = None  # of what is coming

    # ── state ────────────────────────────────────────────────────────────────

    @property
    def sketch(self) -> Sketch | None:
        """The sketch that is shown; None before the first good one."""
        return self.shown.sketch if self.shown else None

    @property
    def error(self) -> PlaygroundError | None:
        """What is wrong just now."""
        return self._file_error or self.draw_error

    @property
    def testing(self) -> bool:
        """Whether an answer of the sandbox is awaited."""
        return self.stage is ReloadStage.SANDBOX

    @property
    def checking(self) -> tuple[str, float] | None:
        """What the sandbox checks, a file or a technique, and for how long [s]; None if nothing."""
        return (self._subject, self._checks.now() - self.started) if self.testing else None

    @property
    def files(self) -> frozenset[Path]:
        """Every file worth watching: of the drafts, those that an error points at, and where others may come.

        See ``dependencies.watched``.
        """
        drafts = [draft for draft in (self.shown, self.coming) if draft is not None]
        errors = [error for error in (self._file_error, self.draw_error) if error is not None]
        sketches = [sketch for draft in drafts for sketch in (draft.sketch, draft.file)]
        return watched(self.path, sketches, errors, self.places)

    @property
    def stored(self) -> StoredEdits:
        """What ``open`` takes to restore the edits of the sketch that is open; it may not be shown yet."""
        draft = self.coming if self.opening else self.shown or self.coming
        return self._start if draft is None else stored(draft)

    # ── files ────────────────────────────────────────────────────────────────

    def reload(self, changed: Iterable[Path] = ()) -> None:
        """Read the files again; what is new in them is shown once it has proved good.

        ``changed``: the files that were saved, where that is known.
        """
        self._begin(_listed(changed) or self.path.name)
        self.read_at = time.time()
        chosen = self._unproved
        old = None if self.opening else chosen or self.shown or self.coming
        try:
            with noting_places() as self.places:
                loaded = with_texts(load_with(self._techniques.begin(), self.path), self.texts)
            loaded = loaded.plainly(self.plain)
            draft, notes = reload_draft(old, loaded) if old else first_draft(loaded, self._start)
        except Exception as error:
            self._drop_coming()
            self._file_error = missing_file_error(self.path) or explained(error, self.path)
            return
        shown = None if self.opening else self.shown
        if chosen is None and shown is not None and loaded == shown.file:
            self._drop_coming()
            self._file_error = self.draw_error = None
            self.revision += 1  # the texts are the same, but an image may have changed
            if self.sandboxed and self._drawn.reads_new_data(shown.sketch):
                self._propose(shown, [])
            return
        if shown is not None:
            notes += map(str, newly_shadowed(shown.file, draft.sketch))
        variants = self._checks.variants
        known = () if old is None else left_out(old.base, variants)
        notes += [note for note in left_out(draft.base, variants) if note not in known]
        self._propose(draft, notes, new_file=chosen is not None)

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
        self.path, self.texts = find(path).absolute(), texts or {}
        self._techniques.dialect = ""
        if not keep:
            self._start, self.opening = start or StoredEdits(), True
        self.reload()

    def read_as(self, texts: Mapping[str, str]) -> None:
        """Replace shaders' files by texts, by absolute path; nothing is written."""
        if texts != self.texts:
            self.texts = dict(texts)
            self.reload()

    def run_plain(self, plain: bool) -> None:
        """Run every technique in its canonical form, or fast variants again where they are verified."""
        if plain != self.plain:
            self.plain = plain
            self.reload()

    def choose(self, pass_name: str, use: str) -> None:
        """Fill a pass with another technique, once that has proved good."""
        if self.shown is None:
            return
        chosen = self._unproved
        draft = chosen or self.shown
        self._begin(use)
        self._propose_made(lambda: draft.choose(pass_name, use), new_file=chosen is not None)

    def drawn_well(self) -> None:
        """Replace what is shown by what was coming: it has been drawn."""
        self.shown, self.opening = self.coming, False
        self.notes.extend(self._coming_notes)
        self._drop_coming()
        self._file_error = self.draw_error = None

    def failed(self, error: Exception) -> None:
        """Report why what is coming cannot be shown."""
        self.stage = ReloadStage.FAILED
        self._file_error = explained(error, self.path)

    def report(self, error: Exception) -> None:
        """Report why what is shown cannot be drawn any more."""
        self.draw_error = explained(error, self.path)

    def _begin(self, subject: str) -> None:
        self.started, self._subject = self._checks.now(), subject

    def _propose_made(self, make: Callable[[], Draft], *, new_file: bool = False) -> None:
        try:
            self._propose(make(), [], new_file=new_file)
        except PlaygroundError as error:
            self._file_error = explained(error, self.path)

    def _propose(self, draft: Draft, notes: list[str], *, new_file: bool = False) -> None:
        self.coming, self._coming_notes, self._new_file = draft, notes, new_file
        self._file_error, self.sandbox_seconds = None, 0.0
        if self._checks.sandbox is None or not self._drawn.needs_drawing(draft.sketch):
            self.stage = ReloadStage.DRAW
            return
        self.stage, self._aside = ReloadStage.SANDBOX, None
        self._submit(self._checks.sandbox, draft.sketch)

    def _drop_coming(self) -> None:
        self.coming, self.stage, self._coming_notes = None, ReloadStage.NONE, []

    # ── the sandbox ──────────────────────────────────────────────────────────

    def check_aside(self, sketch: Sketch) -> SandboxReport | None:
        """Return what the sandbox says of a sketch drawn besides this one; None while it is not known.

        What is coming goes first.
        """
        sandbox = self._checks.sandbox
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
        report = self._checks.sandbox.poll() if self._checks.sandbox is not None else None
        if report is None:
            return
        # Without a context the sandbox can check nothing; this one may well have what it takes.
        if report.ok or isinstance(report.error, ContextError):
            self.stage, self.sandbox_seconds = ReloadStage.DRAW, report.seconds
        else:
            self.failed(report.error or PlaygroundError("the sandbox failed without saying why"))

    def _submit(self, sandbox: Sandbox, sketch: Sketch) -> None:
        sandbox.submit(TrySketch(sketch, time=self._checks.sketch_time(), drivers=(self._checks.driver,)))

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
        known = edited.edits.values[-1][1]
        self._take(edited, lambda edits: edits.with_value(path, known))

    def set_all(self, values: Mapping[str, Value]) -> None:
        """Set several parameters at once; those that are locked, gone or do not take theirs stay."""
        if self.shown is not None:
            free = [(p, v) for p, v in values.items() if p not in self.shown.edits.locked]
            fit = {p: v for p, given in free if (v := taken(self.shown.base, p, given)) is not None}
            others = [(p, v) for p, v in self.shown.edits.values if p not in fit]
            self._edit(lambda edits: replace(edits, values=(*others, *fit.items())))

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
        draft = self.shown
        if draft is not None:
            for path in paths:
                draft = draft.without(path)
            left = draft.edits.values
            self._edit(lambda edits: replace(edits, values=left))

    def lock(self, path: str, locked: bool) -> None:
        """Lock a parameter against presets, randomising and reloads, or unlock it."""
        self._edit(lambda edits: edits.with_lock(path, locked))

    def restore(self, edits: Edits) -> None:
        """Replace the edits: values and camera at once, techniques once they have proved good."""
        shown = self.shown
        if shown is None:
            return
        if edits.techniques == shown.edits.techniques:
            self._edit(lambda old: replace(edits, techniques=old.techniques))
            return
        self._begin(self.path.name)
        self._propose_made(lambda: shown.with_techniques(edits.techniques).with_edits(edits))

    def set_camera(self, camera: Camera | None) -> None:
        """Set the camera; None: the file's."""
        self._edit(lambda edits: replace(edits, camera=camera))

    def move_suns(self, across: float, up: float) -> None:
        """Move every sun of the sketch by so much of the picture's height, to the right and upwards."""
        if self.sketch is not None:
            for path, sun in suns_of(self.sketch).items():
                self.set(path, turned(sun, across, up))

    def reset_values(self) -> None:
        """Reset all that is not locked, and every pass, to what the file says."""
        if self.shown is not None:
            locked = set(self.shown.edits.locked)
            left = tuple(v for v in self.shown.edits.values if v[0] in locked)
            self.restore(replace(self.shown.edits, values=left, techniques=()))

    def _edit(self, change: Callable[[Edits], Edits]) -> None:
        shown = self.shown
        self._take(shown.with_edits(change(shown.edits)) if shown is not None else None, change)

    def _take(self, edited: Draft | None, change: Callable[[Edits], Edits]) -> None:
        """Show an edited draft, and make the same change to what is coming."""
        self.revision += 1
        if self.sandboxed and self.shown is not None and edited is not None:
            if _names_another_file(self.shown, edited):
                self._drop_failed_file()
                if self._drawn.reads_new_data(edited.sketch):
                    draft = self.coming or self.shown
                    self._check_new_file(draft.with_edits(change(draft.edits)))
                    return
        self.shown = edited
        if self.coming is not None:
            edited = self.coming.with_edits(change(self.coming.edits))
            if self._new_file and _names_another_file(self.coming, edited):
                self._check_new_file(edited)  # what is checked, or has failed, is no longer what is chosen
            else:
                self.coming = edited

    @property
    def _unproved(self) -> Draft | None:
        """What is coming, while it is not known yet whether a data file that the user chose is good."""
        return self.coming if self._new_file and self.stage is not ReloadStage.FAILED else None

    def _check_new_file(self, draft: Draft) -> None:
        """Send data files that the user chose through the sandbox first."""
        self._begin(self.path.name)
        self._propose(draft, self._coming_notes, new_file=self._drawn.reads_new_data(draft.sketch))

    def _drop_failed_file(self) -> None:
        """Forget a data file that the user chose and that failed: another is chosen in its place."""
        if self._new_file and self.stage is ReloadStage.FAILED:
            self._drop_coming()
            self._file_error, self._new_file = None, False


def _names_another_file(before: Draft, edited: Draft) -> bool:
    """Say whether an edit sets another text, as the name of a file is one."""
    return any(isinstance(value, str) for _, value in {*edited.edits.values} ^ {*before.edits.values})


def _listed(files: Iterable[Path]) -> str:
    """Return the names of files in a few words: "terrain.glsl", "terrain.glsl, wave.glsl and 2 more"."""
    names = sorted({path.name for path in files})
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ", ".join(names[:_NAMED]) + more
