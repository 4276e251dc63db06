"""The drafts of a sketch being worked on: what its files say, what was set by hand, what is wrong.

There are at most two. ``shown`` is the last one that drew well; ``coming`` is what was
saved or chosen since: it is tried (in the trial child, where there is one), then drawn,
and only then takes the place of ``shown``. If it fails, its error is kept and ``shown``
stays. Who draws them is ``workbench.session``.
"""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from playground.engine.sandbox import SandboxReport, TrySketch
from playground.errors import ContextError, ParameterError, PlaygroundError
from playground.sketch.allowed_files import Signature, noting_places
from playground.sketch.assign import LAND
from playground.sketch.find import find
from playground.sketch.load import load_with
from playground.sketch.model import Camera, Sketch, Value
from playground.sketch.shadowed import newly_shadowed
from playground.sketch.technique_cache import KeptTechniques
from playground.sketch.text_overrides import with_texts
from playground.sketch.values import shortest
from playground.sketch.variants import left_out
from playground.workbench.clock import Clock
from playground.workbench.dependencies import watched
from playground.workbench.edit_merge import Said, said_by_files
from playground.workbench.edits import Draft, Edits, reload_draft, taken
from playground.workbench.reload_stages import Stage, Tester, explained, gone
from playground.workbench.resume import first_draft
from playground.workbench.sun_drag import suns_of, turned

_NAMED = 2  # files that are named of those saved at once


class Drafts(ABC):
    """What is shown of a sketch's files, what is coming, and what was set by hand."""

    def __init__(
        self,
        path: str | Path,
        *,
        driver: str,
        variants: Collection[str] = (),
        plain: bool = False,
        values: Mapping[str, Value] | None = None,
        edits: Edits | None = None,
        in_file: Mapping[str, Said] | None = None,
        camera_in_file: Camera | None = None,
        trial: Tester | None = None,
        now: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.path = find(path or "").absolute()  # the current folder may be deleted meanwhile
        self.clock = Clock()
        self.shown: Draft | None = None
        self.coming: Draft | None = None
        self.stage = Stage.NONE
        self.notes: deque[str] = deque(maxlen=32)  # sentences for a person; whoever shows them takes them out
        self.read_at = 0.0  # [s since the epoch] when the files were last read
        self.places: dict[Path, Signature | None] = {}  # where files were looked for, and what was there
        self.texts: Mapping[str, str] = {}  # what stands in for shaders' files, by absolute path
        edits = edits or Edits()
        for name, value in (values or {}).items():
            edits = edits.with_value(name, value)
        self._initial = edits  # set by hand in an earlier session; the values, on the command line
        self._in_file = {k: v for k, v in (in_file or {}).items() if k not in (values or {})}
        self._camera_in_file = camera_in_file
        self._another = False  # what is coming is another sketch than the one that is shown
        self._driver = driver
        self.plain = plain  # every technique in its canonical form
        self._variants = tuple(variants)  # kinds of fast variants that can run
        self._techniques = KeptTechniques()
        self._trial = trial
        self._now = now
        self._started = 0.0  # when what is coming began to be read
        self._subject = self.path.name  # what it is read, or tried, for
        self._trial_seconds = 0.0
        self._file_by_hand = False  # what is coming has a file that was chosen by hand
        self._own_files: set[Path] = set()  # written by this process itself, and so known to be good
        self._aside: Sketch | None = None  # what the trial was handed last, where that is not what is coming
        self._coming_notes: list[str] = []
        self._file_error: PlaygroundError | None = None  # of what is coming
        self._draw_error: PlaygroundError | None = None  # of what is shown
        self._revision = 0  # of what is to be seen

    # ── what they are ────────────────────────────────────────────────────────

    @property
    def sketch(self) -> Sketch | None:
        """The sketch that is shown; None before the first good one."""
        return self.shown.sketch if self.shown else None

    @property
    def error(self) -> PlaygroundError | None:
        """What is wrong just now."""
        return self._file_error or self._draw_error

    @property
    def testing(self) -> bool:
        """Whether an answer of the trial is awaited."""
        return self.stage is Stage.TRIAL

    @property
    def trying(self) -> tuple[str, float] | None:
        """What is tried just now, a file or a technique, and for how long [s]; None while nothing is."""
        return (self._subject, self._now() - self._started) if self.testing else None

    @property
    def leaves(self) -> bool:
        """Whether another sketch was opened, and the one before is still shown."""
        return self._another

    @property
    def files(self) -> frozenset[Path]:
        """Every file worth watching: of the drafts, those that an error points at, and where others may come.

        See ``files.watched``.
        """
        drafts = [draft for draft in (self.shown, self.coming) if draft is not None]
        errors = [error for error in (self._file_error, self._draw_error) if error is not None]
        sketches = [sketch for draft in drafts for sketch in (draft.sketch, draft.file)]
        return watched(self.path, sketches, errors, self.places)

    # ── files ────────────────────────────────────────────────────────────────

    def reload(self, changed: Iterable[Path] = ()) -> None:
        """Read the files again; what is new in them is shown once it has proved good.

        ``changed``: the files that were saved, where that is known.
        """
        self._subject = _listed(changed) or self.path.name
        self.read_at = time.time()
        self._started = self._now()
        try:
            with noting_places() as self.places:
                loaded = with_texts(load_with(self._techniques.begin(), self.path), self.texts)
            loaded = loaded.plainly(self.plain)
            chosen = self._chosen_by_hand
            old = None if self._another else chosen or self.shown or self.coming
            draft, notes = (
                reload_draft(old, loaded)
                if old
                else first_draft(loaded, self._initial, self._in_file, self._camera_in_file)
            )
        except Exception as error:
            self._drop_coming()
            self._file_error = gone(self.path) or explained(error, self.path)
            return
        if chosen is None and self.shown is not None and loaded == self.shown.file and not self._another:
            self._drop_coming()
            self._file_error = self._draw_error = None
            self._revision += 1  # the texts are the same, but an image may be another
            if self._trial is not None and self._reads_anew(self.shown.sketch):
                self._propose(self.shown, [])
            return
        if self.shown is not None and not self._another:
            notes = [*notes, *map(str, newly_shadowed(self.shown.file, draft.sketch))]
        known = () if old is None else left_out(old.base, self._variants)
        plain_forms = [note for note in left_out(draft.base, self._variants) if note not in known]
        self._propose(draft, [*notes, *plain_forms], by_hand=chosen is not None)

    def open(
        self,
        path: Path,
        *,
        keep: bool = False,
        edits: Edits | None = None,
        in_file: Mapping[str, Said] | None = None,
        camera_in_file: Camera | None = None,
        texts: Mapping[str, str] | None = None,
    ) -> None:
        """Open another sketch; the picture stays until that one has proved good.

        ``keep``: it is a copy of this one, and what is set by hand goes on. ``edits``: what is set
        by hand in the other; ``in_file`` and ``camera_in_file``: what its files said then; ``texts``:
        what stands in for some of them.
        """
        self.path, self.texts = find(path).absolute(), texts or {}
        if not keep:
            self._initial, self._in_file, self._another = edits or Edits(), dict(in_file or {}), True
            self._camera_in_file = camera_in_file
            self._forget_view()
        self.reload()

    def read_as(self, texts: Mapping[str, str]) -> None:
        """Have texts, by absolute path, stand in for shaders' files; nothing is written."""
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
        self._started, self._subject = self._now(), use
        try:
            chosen = self._chosen_by_hand
            self._propose((chosen or self.shown).choose(pass_name, use), [], by_hand=chosen is not None)
        except PlaygroundError as error:
            self._file_error = explained(error, self.path)

    def _propose(self, draft: Draft, notes: list[str], *, by_hand: bool = False) -> None:
        self.coming, self._coming_notes, self._file_by_hand = draft, notes, by_hand
        self._file_error, self._trial_seconds = None, 0.0
        if self._trial is None or not self._draws_anew(draft.sketch):
            self.stage = Stage.DRAW
            return
        self.stage, self._aside = Stage.TRIAL, None
        self._submit(self._trial, draft.sketch)

    def tried(self, sketch: Sketch) -> SandboxReport | None:
        """Return how the trial of a sketch ended that is seen beside this one; None while it is not known.

        What is coming goes first.
        """
        if self._trial is None:
            return SandboxReport(True)
        if self.stage is Stage.TRIAL:
            return None
        if self._aside is not sketch:
            self._aside = sketch
            self._submit(self._trial, sketch)
        report = self._trial.poll()
        if report is not None:
            self._aside = None
        return report

    def _submit(self, trial: Tester, sketch: Sketch) -> None:
        trial.submit(TrySketch(sketch, time=self.clock.time, drivers=(self._driver,)))

    @abstractmethod
    def _draws_anew(self, sketch: Sketch) -> bool:
        """Say whether the driver would be given anything that it has not drawn already."""

    @abstractmethod
    def _reads_anew(self, sketch: Sketch) -> bool:
        """Say whether a sketch reads data that was never drawn with."""

    @abstractmethod
    def _forget_view(self) -> None:
        """Forget what was shown of the sketch before: another one is opened."""

    def _drop_coming(self) -> None:
        self.coming, self.stage, self._coming_notes = None, Stage.NONE, []

    def set_by_hand(self) -> tuple[Edits, Mapping[str, Said], Camera | None]:
        """Return what ``open`` takes to bring back what is set by hand in the sketch that is open.

        It may not be shown yet. The edits, what the files say of each of their values, and what of
        the camera where another is set.
        """
        draft = self.coming if self._another else self.shown or self.coming
        if draft is None:  # it has not loaded yet
            return self._initial, self._in_file, self._camera_in_file
        said = said_by_files(draft.base, [path for path, _ in draft.edits.values])
        return draft.edits, said, draft.file.camera if draft.edits.camera is not None else None

    # ── edits by hand ────────────────────────────────────────────────────────

    def set(self, path: str, value: object) -> None:
        """Set a parameter by its path; one that it does not take becomes a note."""
        if self.sketch is None:
            return
        try:
            changed = self.sketch.with_values({path: value})
        except ParameterError as error:
            self.notes.append(str(error))
            return
        kept = dict(changed.overrides).get(path, value)
        self._edit(lambda edits: edits.with_value(path, kept))  # type: ignore[arg-type]

    def set_all(self, values: Mapping[str, Value]) -> None:
        """Set several parameters at once; those that are locked, gone or do not take theirs stay."""
        if self.shown is not None:
            free = [(p, v) for p, v in values.items() if p not in self.shown.edits.locked]
            fit = {p: v for p, given in free if (v := taken(self.shown.base, p, given)) is not None}
            others = [(p, v) for p, v in self.shown.edits.values if p not in fit]
            self._edit(lambda edits: replace(edits, values=(*others, *fit.items())))

    def tidy(self) -> None:
        """Write what is set by hand in the fewest digits that a shader reads as the same numbers."""

        def tidied(edits: Edits) -> Edits:
            return replace(edits, values=tuple((p, v if p in LAND else shortest(v)) for p, v in edits.values))

        if self.shown is not None and tidied(self.shown.edits) != self.shown.edits:
            self._edit(tidied)

    def unset(self, *paths: str) -> None:
        """Give parameters back the file's values."""
        draft = self.shown
        if draft is not None:
            for path in paths:
                draft = draft.without(path)
            left = draft.edits.values
            self._edit(lambda edits: replace(edits, values=left))

    def lock(self, path: str, locked: bool) -> None:
        """Lock a parameter against presets, chance and reloads, or let it go."""
        self._edit(lambda edits: edits.with_lock(path, locked))

    def restore(self, edits: Edits) -> None:
        """Take other edits for those of now: values and camera at once, techniques once they proved good."""
        if self.shown is None:
            return
        if edits.techniques == self.shown.edits.techniques:
            self._edit(lambda old: replace(edits, techniques=old.techniques))
            return
        self._started, self._subject = self._now(), self.path.name
        try:
            self._propose(self.shown.with_techniques(edits.techniques).with_edits(edits), [])
        except PlaygroundError as error:
            self._file_error = explained(error, self.path)

    def look(self, camera: Camera) -> None:
        """See the land from another camera."""
        self._edit(lambda edits: replace(edits, camera=camera))

    def apply_preset(self, name: str) -> None:
        """Set the values of one of the sketch's presets."""
        for preset in self.sketch.presets if self.sketch else ():
            if preset.name == name:
                self.set_all(dict(preset.values))

    def turn_suns(self, across: float, up: float) -> None:
        """Move every sun of the sketch by so much of the picture's height, to the right and upwards."""
        if self.sketch is not None:
            for path, sun in suns_of(self.sketch).items():
                self.set(path, turned(sun, across, up))

    def reset_camera(self) -> None:
        """See the land as the file says."""
        self._edit(lambda edits: replace(edits, camera=None))

    def reset_values(self) -> None:
        """Give all that is not locked, and every pass, back what the file says."""
        if self.shown is not None:
            locked = set(self.shown.edits.locked)
            left = tuple(v for v in self.shown.edits.values if v[0] in locked)
            self.restore(replace(self.shown.edits, values=left, techniques=()))

    def vouch_for(self, path: Path) -> None:
        """Take a file that this process writes itself for good: it needs no trial."""
        self._own_files.add(path)

    def _edit(self, change: Callable[[Edits], Edits]) -> None:
        self._revision += 1
        if self.shown is not None:
            edited = self.shown.with_edits(change(self.shown.edits))
            if _names_another(self.shown, edited) and self._trial is not None:
                self._drop_file_set_by_hand()
                if self._reads_anew(edited.sketch):
                    draft = self.coming or self.shown
                    self._try_by_hand(draft.with_edits(change(draft.edits)))
                    return
            self.shown = edited
        if self.coming is not None:
            edited = self.coming.with_edits(change(self.coming.edits))
            if self._file_by_hand and _names_another(self.coming, edited):
                self._try_by_hand(edited)  # what is tried, or has failed, is no longer what is chosen
            else:
                self.coming = edited

    @property
    def _chosen_by_hand(self) -> Draft | None:
        """What is coming, while it is not known yet whether a file that was chosen by hand is good."""
        return self.coming if self._file_by_hand and self.stage is not Stage.FAILED else None

    def _try_by_hand(self, draft: Draft) -> None:
        """Have the files that were chosen by hand tried first: what they do to a reader, nobody knows yet."""
        self._started, self._subject = self._now(), self.path.name
        self._propose(draft, self._coming_notes, by_hand=self._reads_anew(draft.sketch))

    def _drop_file_set_by_hand(self) -> None:
        """Forget a file that was chosen by hand and failed: another is chosen in its place."""
        if self._file_by_hand and self.stage is Stage.FAILED:
            self._drop_coming()
            self._file_error, self._file_by_hand = None, False

    def _hear_trial(self) -> None:
        if self.stage is not Stage.TRIAL or self._trial is None:
            return
        report = self._trial.poll()
        if report is None:
            return
        # Without a context the child can try nothing; this one may well have what it takes.
        if report.ok or isinstance(report.error, ContextError):
            self.stage = Stage.DRAW
            self._trial_seconds = report.seconds
            return
        self.stage = Stage.FAILED
        error = report.error or PlaygroundError("the trial failed without saying why")
        self._file_error = explained(error, self.path)


def _names_another(before: Draft, edited: Draft) -> bool:
    """Say whether an edit sets another text, as the name of a file is one."""
    return any(isinstance(value, str) for _, value in {*edited.edits.values} ^ {*before.edits.values})


def _listed(files: Iterable[Path]) -> str:
    """Return the names of files in a few words: "land.glsl", "land.glsl, wave.glsl and 2 more"."""
    names = sorted({path.name for path in files})
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ", ".join(names[:_NAMED]) + more
