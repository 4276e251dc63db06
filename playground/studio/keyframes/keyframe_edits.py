"""Edit keyframes: add one here, move it, ease it, delete it; each is in the sketch's file at once.

A new keyframe takes the camera and the chosen parameters as they are now, at the time of the
clock; what it takes is no user edit any more, so that the keyframes move it. Each step can be
undone, which writes the file as well.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path

from playground.errors import ParameterError
from playground.sketch.assign import TERRAIN_KEYS, resolve, value_of, values_of
from playground.sketch.keyframes import EASES
from playground.sketch.model import Camera, Keyframe, Sketch
from playground.studio.actions import rounded
from playground.studio.edits.edits import Edits, leaves
from playground.studio.edits.undo import Undo
from playground.studio.language import numeral, tr, tr_label
from playground.studio.notices import Notices
from playground.studio.save.sketch_file import save_keyframes
from playground.studio.session import Session

STEP = 0.01
"""[s] Times are rounded to it."""


@dataclass
class KeyframeEdits:
    """Those of one session."""

    session: Session
    notices: Notices
    undo: Undo

    @property
    def keyframes(self) -> tuple[Keyframe, ...]:
        """The keyframes that the sketch's file has, by time."""
        draft = self.session.shown
        return draft.file.keyframes if draft is not None else ()

    @property
    def changed_paths(self) -> list[str]:
        """The edited parameters that a keyframe can set."""
        draft = self.session.shown
        return [path for path in draft.applied if path not in TERRAIN_KEYS] if draft is not None else []

    def add_here(self, paths: Collection[str], *, camera: bool = True) -> bool:
        """Add a keyframe of the camera and of parameters at the clock's time, or add them to the one there.

        Returns whether that worked; else a notice says why not.
        """
        session, draft = self.session, self.session.shown
        if draft is None or session.sketch is None:
            self.notices.say(tr("there is no sketch to add a keyframe to yet"))
            return False
        if not camera and not paths:
            self.notices.say(tr("choose what the keyframe sets: the camera, or a parameter"))
            return False
        time = _rounded_time(session.clock.time)
        keyframes = self.keyframes
        now = session.sketch.at(time)
        values = values_of(now)
        try:
            named = {_name_for(draft.file, keyframes, path): value_of(now, path, values) for path in paths}
        except ParameterError as error:
            self.notices.say(str(error))
            return False
        seen = self._camera(draft.file, now) if camera else {}
        here = next((keyframe for keyframe in keyframes if keyframe.time == time), None)
        base = here or Keyframe(time)
        made = replace(
            base,
            camera=tuple((dict(base.camera) | seen).items()),
            values=tuple((dict(base.values) | named).items()),
        )
        keyed = {target.path for path in paths for target in resolve(draft.base.graph, path)}
        left = tuple(v for v in draft.edits.values if not keyed & leaves(draft.base, v[0]))
        edits = replace(draft.edits, values=left, camera=None if camera else draft.edits.camera)
        others = [keyframe for keyframe in keyframes if keyframe is not here]
        return self._write([*others, made], tr("Keyframe at {time} s", time=numeral(time)), edits)

    def move(self, index: int, time: float) -> bool:
        """Move a keyframe to another time [s]; its place among the others follows."""
        keyframes, time = self.keyframes, _rounded_time(time)
        if any(keyframe.time == time for number, keyframe in enumerate(keyframes) if number != index):
            self.notices.say(tr("there is a keyframe at {time} s already", time=numeral(time)))
            return False
        return self._replace(
            index, tr("Keyframe to {time} s", time=numeral(time)), replace(keyframes[index], time=time)
        )

    def set_ease(self, index: int, ease: str) -> bool:
        """Set how the values go on from a keyframe: one of ``EASES``."""
        if ease not in EASES:
            raise ValueError(f"ease '{ease}': expected {', '.join(EASES)}")
        return self._replace(
            index, tr("Keyframe: {ease}", ease=tr_label(ease)), replace(self.keyframes[index], ease=ease)
        )

    def delete(self, index: int) -> bool:
        """Delete a keyframe."""
        return self._replace(
            index, tr("Delete the keyframe at {time} s", time=numeral(self.keyframes[index].time))
        )

    def _replace(self, index: int, name: str, *instead: Keyframe) -> bool:
        keyframes = self.keyframes
        return self._write([*keyframes[:index], *instead, *keyframes[index + 1 :]], name)

    def _write(self, keyframes: Sequence[Keyframe], name: str, edits: Edits | None = None) -> bool:
        """Write keyframes into the file and replace the edits, as one step."""
        draft = self.session.shown
        if draft is None:
            return False
        file = draft.file
        return self.undo.write(name, lambda: save_keyframes(file, keyframes), Path(file.file), edits)

    def _camera(self, file: Sketch, now: Sketch) -> dict[str, float | tuple[float, ...]]:
        """Return the camera as a keyframe says it; in metres, unless the others show the whole terrain."""
        camera, plan, keyframes = rounded(now.camera), self.session.plan, file.keyframes
        far = [
            dict(keyframe.camera)["distance"] for keyframe in keyframes if "distance" in dict(keyframe.camera)
        ]
        if (
            camera.distance == 0.0
            and not (far and all(distance == 0.0 for distance in far))
            and plan is not None
        ):
            camera = replace(camera, distance=round(plan.eye.distance, 2))
        parts = {part.name: getattr(camera, part.name) for part in fields(Camera)}
        named = {name for keyframe in keyframes for name, _ in keyframe.camera}
        if parts["target"] is None and "target" in named and plan is not None:
            parts["target"] = tuple(round(float(n), 2) for n in plan.eye.target)
        if parts["field_of_view"] == file.camera.field_of_view and "field_of_view" not in named:
            del parts["field_of_view"]  # it never changes
        return {name: value for name, value in parts.items() if value is not None}


def summary(keyframe: Keyframe) -> str:
    """Return what a keyframe sets, in a few words."""
    parts = [tr("camera")] if keyframe.camera else []
    return ", ".join([*parts, *(path for path, _ in keyframe.values)])


def _name_for(file: Sketch, keyframes: Sequence[Keyframe], path: str) -> str:
    """Return the name that keyframes have for a parameter already, else its own."""
    if path in TERRAIN_KEYS:
        raise ParameterError(f"'{path}' is of the terrain; keyframes set parameters and the camera")
    mine = leaves(file, path)
    if not mine:
        raise ParameterError(f"'{path}' is of a technique chosen here; save that into the sketch first")
    names = dict.fromkeys(name for keyframe in keyframes for name, _ in keyframe.values)
    return next((name for name in names if mine & leaves(file, name)), path)


def _rounded_time(time: float) -> float:
    return round(max(round(time / STEP) * STEP, 0.0), 2)
