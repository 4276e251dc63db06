"""What a button or a key does to the sketch's values and files: presets, resets, saving, opening."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from playground.errors import PlaygroundError
from playground.files import new_name, read_regular, write_file
from playground.paths import GLSL, shown
from playground.sketch.assign import TERRAIN_KEYS, resolve, values_of
from playground.sketch.model import Camera, Value
from playground.sketch.pasted import keep_text
from playground.sketch.save import save, save_copy, save_preset, saved_text
from playground.studio.channels.channels import source_of
from playground.studio.edits.edits import Draft
from playground.studio.edits.history import History, Key
from playground.studio.edits.undo import Undo
from playground.studio.language import counted, tr
from playground.studio.notices import Notices
from playground.studio.save.sketch_file import SketchFile, save_presets
from playground.studio.save.sketch_of_shader import is_shader, save_as_sketch
from playground.studio.session import Session


@dataclass
class Actions:
    """Those of one session; copies go into ``folder``."""

    session: Session
    notices: Notices
    undo: Undo
    file: SketchFile
    folder: Path
    saved_picture: Path | None = None  # the last one
    opens: Callable[[Path], None] | None = None  # opens a sketch with its remembered edits
    _visited: list[Path] = field(default_factory=list)  # the sketches that were opened, in order
    _at: int = 0  # which of them is open now
    _missed: str = ""  # the end of a message about what is saved: what is not in it

    def open(self, path: Path) -> bool:
        """Open another sketch, with a history of its own; the one that is shown is read again.

        Returns False, with a notice, where that cannot be.
        """
        before = self.session.path
        if not self._open(path):
            return False
        if self.session.path != before:
            self._visits(before, self.session.path)
        return True

    def _visits(self, before: Path, path: Path) -> None:
        self._visited = [*(self._visited or [before])[: self._at + 1], path]
        self._at = len(self._visited) - 1

    def visit(self, by: int) -> None:
        """Open the sketch again that was open before this one (-1), or after it (1), with its edits."""
        if 0 <= self._at + by < len(self._visited):
            if self._open(self._visited[self._at + by]):
                self._at += by
        else:
            self.notices.say(
                tr("no other sketch was opened before this one")
                if by < 0
                else tr("no other sketch was opened after this one")
            )

    def _open(self, path: Path) -> bool:
        try:
            (self.opens or self.session.open)(path)
        except PlaygroundError as error:
            self.notices.say(str(error))
            return False
        if self.session.drafts.opening:
            self.undo.begin(History())
        return True

    def paste(self, text: str) -> None:
        """Open a shader's text as a new sketch: a new file in the folder, which a notice names."""
        try:
            path = keep_text(text, self.folder)
        except PlaygroundError as error:
            self.notices.say(tr("the clipboard: {error}", error=error))
            return
        if self.open(path):
            self.notices.say(
                tr("pasted as {path} in {parent}; Backspace goes back", path=path.name, parent=path.parent)
            )

    # ── many values at once ──────────────────────────────────────────────────

    def set_all(self, name: str, values: dict[str, Value]) -> None:
        """Set many parameters as one step, and say how many; locked ones stay."""
        draft = self.session.shown
        if draft is None:
            return
        locked = len(set(values) & set(draft.edits.locked))
        with self.undo.step(name):
            self.session.drafts.set_all(values)
        left = (
            tr("; {locked_parameters} left alone", locked_parameters=counted(locked, "locked parameter"))
            if locked
            else ""
        )
        changed = counted(len(values) - locked, "parameter")
        self.notices.say(tr("{name}: {value}", name=name, value=changed) + left)

    def apply_preset(self, name: str) -> None:
        """Set a preset's values, as one step."""
        sketch = self.session.sketch
        for preset in sketch.presets if sketch else ():
            if preset.name == name:
                self.set_all(tr("Preset {name}", name=name), dict(preset.values))

    def reset_values(self) -> None:
        """Reset all that is not locked to what the file says, as one step."""
        with self.undo.step(tr("Reset values")):
            self.session.reset_values()

    def reset(self, name: str, paths: list[str]) -> None:
        """Reset some parameters to the file's values, as one step; locked ones stay."""
        draft = self.session.shown
        if draft is not None:
            with self.undo.step(tr("Reset {name}", name=name)):
                self.session.drafts.unset(*(path for path in paths if path not in draft.edits.locked))

    # ── saving ───────────────────────────────────────────────────────────────

    def save_values(self) -> None:
        """Save values, camera and techniques into the sketch; where it is read-only, offer a copy.

        A shader or an elevation file that was opened alone has none: make one next to it.
        """
        draft = self._ready()
        if draft is None:
            return
        if is_shader(draft) and not Path(draft.file.file).is_relative_to(GLSL):
            self.save_a_copy()
            return
        if draft.sketch == draft.file:
            self.notices.say(tr("nothing differs from the file{missed}", missed=self._missed))
        elif self.file.write(lambda: save(draft.file, draft.sketch)):
            self.undo.history.saved(_values_in_file(draft))
            self.notices.say(
                tr(
                    "saved {summary} into {file}{missed}",
                    summary=_summary(draft),
                    file=shown(draft.file.file),
                    missed=self._missed,
                )
            )

    @property
    def copy_is(self) -> tuple[str, str]:
        """What ``save_a_copy`` is called in a menu, and where it writes."""
        draft = self.session.shown
        if draft is not None and is_shader(draft):
            shader = Path(draft.file.file).name
            return tr("Save a sketch"), tr(
                "A new sketch that uses {shader}, which stays as it is", shader=shader
            )
        return tr("Save a copy"), tr("A new folder in {folder}", folder=self.folder)

    def save_a_copy(self) -> None:
        """Save the sketch with the user's edits as a new one in the current folder, and go on with that.

        Of a shader or an elevation file that was opened alone, it is a sketch next to it that uses it.
        """
        draft = self._ready()
        if draft is None:
            return
        saved = None
        try:
            if is_shader(draft):
                saved = save_as_sketch(draft, self.folder)
            path = Path(saved.file.file) if saved else save_copy(draft.file, draft.sketch, self.folder)
        except PlaygroundError as error:
            self.notices.say(str(error))
            return
        self.undo.history.saved(_values_in_file(draft))
        what = (
            tr("{path} in {parent}", path=path.name, parent=path.parent)
            if saved
            else tr("a copy in {parent}", parent=path.parent)
        )
        self.notices.say(
            tr("saved {what}; from here on this is the sketch{missed}", what=what, missed=self._missed)
        )
        self._visits(self.session.path, path)
        self.session.open_copy(path, saved)

    def copy_technique(self, path: Path) -> Path | None:
        """Copy the technique of the library that a file is of into the sketch's folder; as one step.

        The passes that it fills are filled with the copy. Returns the file's copy; None, and a notice, where
        no pass's technique has it in its own folder, or it cannot be written.
        """
        draft = self.session.shown
        passes = draft.sketch.graph.passes if draft is not None else ()
        roots = {Path(s.technique.path): s.technique for s in passes if str(path) in s.technique.files}
        root = next((r for r in roots if path == r or path.is_relative_to(r.with_suffix(""))), None)
        if draft is None or root is None:
            self.notices.say(
                tr("{path} is a part of other files, and no technique of a pass by itself", path=path.name)
            )
            return None
        files = [root, *(f for f in map(Path, roots[root].files) if f.is_relative_to(root.with_suffix("")))]
        copies = {file: Path(draft.sketch.folder) / file.relative_to(root.parent) for file in files}
        taken = [copy for copy in copies.values() if copy.exists()]
        if taken:
            self.notices.say(
                tr("{name} is in the sketch's folder already; rename it, and copy again", name=taken[0].name)
            )
            return None
        try:
            for file, copy in copies.items():
                copy.parent.mkdir(parents=True, exist_ok=True)
                write_file(copy, read_regular(file))
        except (OSError, PlaygroundError) as error:
            self.notices.say(tr("{path} cannot be copied: {error}", path=path.name, error=error))
            return None
        with self.undo.step(tr("Copy {stem}", stem=root.stem)):
            for spec in passes:
                if spec.technique.path == str(root):
                    self.session.drafts.choose(spec.name, f"./{root.stem}")
        self.notices.say(
            tr(
                "copied {stem} into the sketch's folder; Ctrl+S has the sketch use it from now on",
                stem=root.stem,
            )
        )
        return copies[path]

    def has_preset(self, name: str) -> bool:
        """Return whether the sketch's file has a preset of that name."""
        draft = self.session.shown
        return draft is not None and any(preset.name == name.strip() for preset in draft.file.presets)

    def save_as_preset(self, name: str, *, replaces: bool = False) -> None:
        """Save the edited values as a preset of the sketch; only with ``replaces`` over one of that name."""
        draft = self._ready()
        if draft is None or not name.strip():
            return
        if self.has_preset(name) and not replaces:
            self.notices.say(tr("there is a preset {name}; Replace writes over it", name=name.strip()))
            return
        values = {path: value for path, value in draft.applied.items() if not isinstance(value, str)}
        if not values:
            self.notices.say(tr("no value is edited, so the preset would be empty"))
        elif self._write_step(
            draft,
            lambda: save_preset(draft.file, name.strip(), values),
            tr("Save the preset {name}", name=name.strip()),
        ):
            self.notices.say(
                tr(
                    "saved {values} as the preset {name}",
                    values=counted(len(values), "value"),
                    name=name.strip(),
                )
            )

    def move_preset(self, name: str, by: int) -> None:
        """Move a preset up (-1) or down (1) in the sketch's file, as one step; at the ends it stays."""
        draft = self.session.shown
        names = [preset.name for preset in draft.file.presets] if draft is not None else []
        if draft is None or name not in names or not 0 <= names.index(name) + by < len(names):
            return
        at, order = names.index(name), list(range(len(names)))
        order[at], order[at + by] = order[at + by], order[at]
        self._write_step(
            draft, lambda: save_presets(draft.file, order), tr("Move the preset {name}", name=name)
        )

    def delete_preset(self, name: str) -> None:
        """Delete a preset from the sketch's file, as one step; what it set stays set."""
        draft = self.session.shown
        names = [preset.name for preset in draft.file.presets] if draft is not None else []
        if draft is None or name not in names:
            return
        shots = [shot.name for shot in draft.file.shots if shot.preset == name]
        if shots:
            self.notices.say(
                tr("the preset {name} is not deleted: the shot {value} uses it", name=name, value=shots[0])
            )
            return
        order = [at for at, other in enumerate(names) if other != name]
        if self._write_step(
            draft, lambda: save_presets(draft.file, order), tr("Delete the preset {name}", name=name)
        ):
            self.notices.say(tr("deleted the preset {name}; Ctrl+Z brings it back", name=name))

    def _write_step(self, draft: Draft, act: Callable[[], None], name: str) -> bool:
        """Write into the sketch's file, as one step of the history; return whether that worked."""
        return self.undo.write(name, act, Path(draft.file.file))

    def copy_toml(self, copy: Callable[[str], None]) -> None:
        """Copy the sketch's text as it would be saved; ``copy`` puts a text on the clipboard."""
        draft = self._ready()
        if draft is None:
            return
        if is_shader(draft):
            self.notices.say(
                tr("{name} is no TOML; Save makes a sketch of it", name=Path(draft.file.file).name)
            )
            return
        file = Path(draft.file.file)
        try:
            text = saved_text(read_regular(file).decode("utf-8-sig"), draft.file, draft.sketch)
        except (OSError, UnicodeDecodeError) as error:
            self.notices.say(tr("{file} cannot be read: {error}", file=shown(draft.file.file), error=error))
            return
        copy(text)
        self.notices.say(tr("copied the sketch as TOML"))

    def save_picture(self) -> None:
        """Save the picture as a PNG that is new in the folder, and say where."""
        frame = self.session.read()
        if frame is None:
            self.notices.say(tr("there is no picture to save yet"))
            return
        stem = re.sub(r"[^\w.-]+", "-", frame.sketch).strip("-.") or "picture"
        try:
            with new_name(self.folder / f"{stem}.png") as path:
                frame.save(path, {"sketch": frame.sketch, "time": f"{frame.time:g}"})
        except PlaygroundError as error:
            self.notices.say(str(error))
            return
        self.saved_picture = path
        width, height = frame.size
        self.notices.say(
            tr(
                "saved {file}, {width} x {height} pixels, in {folder}",
                file=shown(path),
                width=width,
                height=height,
                folder=self.folder,
            )
        )

    def _ready(self) -> Draft | None:
        """Return what is to be saved, its numbers as the file will have them; None, and a notice, if none."""
        drafts = self.session.drafts
        if drafts.shown is None:
            self.notices.say(tr("there is no sketch to save yet"))
            return None
        written = self.undo.painting.settle()
        self._missed = "" if written else tr("; what was painted last could not be written, and is not in it")
        drafts.shorten_values()
        if drafts.shown.edits.camera is not None:
            drafts.set_camera(rounded(drafts.shown.edits.camera))
        self.undo.record(held=True)  # as part of the step that changed them
        return drafts.shown


def rounded(camera: Camera) -> Camera:
    """Return a camera of as many digits as a person would write: hundredths of degrees, centimetres."""
    return Camera(
        round(camera.azimuth, 2),
        round(camera.elevation, 2),
        round(camera.distance, 2),
        None if camera.target is None else tuple(round(n, 2) for n in camera.target),  # type: ignore[arg-type]
        round(camera.field_of_view, 2),
    )


def _values_in_file(draft: Draft) -> dict[Key, object]:
    """Return what the file sets for everything that is edited."""
    values = values_of(draft.base)
    result: dict[Key, object] = {}
    for path in draft.applied:
        if path in TERRAIN_KEYS:
            result["value", path] = getattr(draft.base.terrain, path)
        else:
            result["value", path] = values[resolve(draft.base.graph, path)[0].path]
    for name, _ in draft.edits.techniques:
        spec = draft.file.graph.find(name)
        result["technique", name] = spec.use if spec else None
    for channel, _ in draft.edits.channels:
        result["channel", channel] = source_of(draft.file, channel)
    result["camera", ""] = draft.file.camera
    return {key: value for key, value in result.items() if value is not None}


def _summary(draft: Draft) -> str:
    parts = [counted(len(draft.applied), "value")] if draft.applied else []
    parts += [counted(len(draft.edits.techniques), "technique")] if draft.edits.techniques else []
    parts += [counted(len(draft.edits.channels), "channel")] if draft.edits.channels else []
    parts += [tr("the camera")] if draft.edits.camera is not None else []
    return tr(" and ").join([", ".join(parts[:-1]), parts[-1]] if parts[1:] else parts)
