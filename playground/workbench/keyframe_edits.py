"""Keyframes by hand: add one here, move it, ease it, delete it; each is in the sketch's file at once.

A new keyframe takes the camera and the chosen parameters as they are seen now, at the time
of the clock; what it takes is no longer set by hand, so that the keyframes move it. Each
step can be undone, which writes the file as well.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import fields, replace

from playground.errors import ParameterError, PlaygroundError
from playground.sketch.assign import TERRAIN_KEYS, resolve, value_of, values_of
from playground.sketch.keyframes import EASES
from playground.sketch.model import Camera, Keyframe, Sketch
from playground.sketch.save import ReadOnlySketch
from playground.sketch.save_keyframes import save_keyframes
from playground.workbench.actions import Actions
from playground.workbench.edits import Edits
from playground.workbench.history import KEYFRAMES, Key, state_of
from playground.workbench.save_commands import rounded

STEP = 0.01
"""[s] Times are rounded to it."""


def keyframes_of(actions: Actions) -> tuple[Keyframe, ...]:
    """Return the keyframes that the sketch's file has, by time."""
    draft = actions.session.shown
    return draft.file.keyframes if draft is not None else ()


def changed_paths(actions: Actions) -> list[str]:
    """Return the parameters that are set by hand and that a keyframe can set."""
    draft = actions.session.shown
    return [path for path in draft.applied if path not in TERRAIN_KEYS] if draft is not None else []


def add_here(actions: Actions, paths: Collection[str], *, camera: bool = True) -> bool:
    """Add a keyframe of the camera and of some parameters at the clock's time, or add them to the one there.

    Returns whether that was done; else it was said why not.
    """
    session, draft = actions.session, actions.session.shown
    if draft is None or session.sketch is None:
        actions.say("there is no sketch to add a keyframe to yet")
        return False
    if not camera and not paths:
        actions.say("choose what the keyframe sets: the camera, or a parameter")
        return False
    time = _rounded_time(session.clock.time)
    known = keyframes_of(actions)
    now = session.sketch.at(time)
    values = values_of(now)
    try:
        named = {_name_for(draft.file, known, path): value_of(now, path, values) for path in paths}
    except ParameterError as error:
        actions.say(str(error))
        return False
    seen = _camera_of(actions, draft.file, now) if camera else {}
    here = next((keyframe for keyframe in known if keyframe.time == time), None)
    base = here or Keyframe(time)
    made = replace(
        base,
        camera=tuple((dict(base.camera) | seen).items()),
        values=tuple((dict(base.values) | named).items()),
    )
    taken = {target.path for path in paths for target in resolve(draft.base.graph, path)}
    edits = draft.edits
    kept = tuple(v for v in edits.values if not taken & _leaves(draft.base, v[0]))
    edits = replace(edits, values=kept, camera=None if camera else edits.camera)
    others = [keyframe for keyframe in known if keyframe is not here]
    return _write(actions, [*others, made], f"Keyframe at {time:g} s", edits)


def move(actions: Actions, index: int, time: float) -> bool:
    """Move a keyframe to another time [s]; its place among the others follows."""
    known, time = keyframes_of(actions), _rounded_time(time)
    if any(keyframe.time == time for number, keyframe in enumerate(known) if number != index):
        actions.say(f"there is a keyframe at {time:g} s already")
        return False
    moved = replace(known[index], time=time)
    return _write(actions, [*known[:index], moved, *known[index + 1 :]], f"Keyframe to {time:g} s")


def set_ease(actions: Actions, index: int, ease: str) -> bool:
    """Say how the values go on from a keyframe: one of ``EASES``."""
    known = keyframes_of(actions)
    if ease not in EASES:
        raise ValueError(f"ease '{ease}': expected {', '.join(EASES)}")
    eased = replace(known[index], ease=ease)
    return _write(actions, [*known[:index], eased, *known[index + 1 :]], f"Keyframe: {ease}")


def delete(actions: Actions, index: int) -> bool:
    """Take a keyframe out."""
    known = keyframes_of(actions)
    return _write(
        actions, [*known[:index], *known[index + 1 :]], f"Delete the keyframe at {known[index].time:g} s"
    )


def put_back(actions: Actions, keyframes: Sequence[Keyframe]) -> bool:
    """Write keyframes of an undo or redo; that is no step."""
    draft = actions.session.shown
    return draft is not None and _saved(actions, draft.file, keyframes)


def said(keyframe: Keyframe) -> str:
    """Return what a keyframe sets, in a few words."""
    parts = ["camera"] if keyframe.camera else []
    return ", ".join([*parts, *(path for path, _ in keyframe.values)])


def _write(actions: Actions, keyframes: Sequence[Keyframe], name: str, edits: Edits | None = None) -> bool:
    """Write keyframes into the file and take other edits for those of now, as one step."""
    session, draft = actions.session, actions.session.shown
    if draft is None:
        return False
    actions.look_back(False)
    known = draft.file.keyframes
    if not _saved(actions, draft.file, keyframes):
        return False
    before: dict[Key, object] = {(KEYFRAMES, ""): known}
    after: dict[Key, object] = {(KEYFRAMES, ""): tuple(sorted(keyframes, key=lambda k: k.time))}
    if edits is not None and edits != draft.edits:
        old, new = state_of(draft.edits, {}), state_of(edits, {})
        for key in {*old, *new}:
            if old.get(key) != new.get(key):
                before[key], after[key] = old.get(key), new.get(key)
        if session.drafts.coming is not None:  # what is shown stays as it is until the keyframe is in it
            techniques = session.drafts.coming.edits.techniques
            session.drafts.coming = session.drafts.coming.with_edits(replace(edits, techniques=techniques))
        else:
            session.drafts.restore(edits)
    actions.history.record(before, after, name, now=actions.now())
    if session.shown is not None:
        actions.history.settle(session.shown.edits, session.view.steps)
    return True


def _saved(actions: Actions, file: Sketch, keyframes: Sequence[Keyframe]) -> bool:
    try:
        save_keyframes(file, keyframes)
    except ReadOnlySketch as error:
        actions.offer, actions.opening = f"{str(error).rpartition(': ')[2].capitalize()}.", "offer"
        return False
    except PlaygroundError as error:
        actions.say(str(error))
        return False
    actions.session.drafts.reload()
    return True


def _camera_of(actions: Actions, file: Sketch, now: Sketch) -> dict[str, float | tuple[float, ...]]:
    """Return the camera as a keyframe says it; in metres, unless the others see the whole land."""
    camera, plan, known = rounded(now.camera), actions.session.plan, file.keyframes
    far = [dict(keyframe.camera)["distance"] for keyframe in known if "distance" in dict(keyframe.camera)]
    if camera.distance == 0.0 and not (far and all(one == 0.0 for one in far)) and plan is not None:
        camera = replace(camera, distance=round(plan.eye.distance, 2))
    parts = {part.name: getattr(camera, part.name) for part in fields(Camera)}
    named = {name for keyframe in known for name, _ in keyframe.camera}
    if parts["target"] is None and "target" in named and plan is not None:
        parts["target"] = tuple(round(float(n), 2) for n in plan.eye.target)
    if parts["field_of_view"] == file.camera.field_of_view and "field_of_view" not in named:
        del parts["field_of_view"]  # nobody changes it
    return {name: value for name, value in parts.items() if value is not None}


def _name_for(file: Sketch, known: Sequence[Keyframe], path: str) -> str:
    """Return the name that keyframes have for a parameter already, else its own."""
    if path in TERRAIN_KEYS:
        raise ParameterError(f"'{path}' is the land's; keyframes set parameters and the camera")
    mine = _leaves(file, path)
    if not mine:
        raise ParameterError(f"'{path}' is of a technique chosen by hand; save that into the sketch first")
    names = dict.fromkeys(name for keyframe in known for name, _ in keyframe.values)
    return next((name for name in names if mine & _leaves(file, name)), path)


def _leaves(sketch: Sketch, path: str) -> set[str]:
    try:
        return {target.path for target in resolve(sketch.graph, path)}
    except ParameterError:
        return set()


def _rounded_time(time: float) -> float:
    return round(max(round(time / STEP) * STEP, 0.0), 2)
