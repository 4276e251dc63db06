"""Save what was set by hand: into the sketch, as a preset in it, as a copy, to the clipboard."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from playground.errors import PlaygroundError, counted
from playground.paths import shown
from playground.sketch.assign import TERRAIN_KEYS, resolve, values_of
from playground.sketch.model import Camera
from playground.sketch.save import ReadOnlySketch, save, save_copy, save_preset, saved_text
from playground.workbench.actions import Actions
from playground.workbench.edits import Draft
from playground.workbench.history import Key


def save_values(actions: Actions) -> None:
    """Save values, camera and techniques into the sketch; where it is read-only, offer a copy."""
    draft = _ready(actions)
    if draft is None:
        return
    if draft.sketch == draft.file:
        actions.say("nothing differs from the file")
        return
    if not _is_written(actions, lambda: save(draft.file, draft.sketch)):
        return
    actions.history.saved(_before(draft))
    actions.say(f"saved {_what(draft)} into {shown(draft.file.file)}")
    actions.session.drafts.reload()


def save_a_copy(actions: Actions) -> None:
    """Save the sketch with what is set by hand as a new one in the current folder, and go on with that."""
    draft = _ready(actions)
    if draft is None:
        return
    try:
        path = save_copy(draft.file, draft.sketch, actions.folder)
    except PlaygroundError as error:
        actions.say(str(error))
        return
    actions.history.saved(_before(draft))
    actions.say(f"saved a copy in {path.parent}; from here on this is the sketch")
    actions.session.drafts.open(path, keep=True)


def save_as_preset(actions: Actions, name: str) -> None:
    """Save the values set by hand as a preset of the sketch."""
    draft = _ready(actions)
    if draft is None or not name.strip():
        return
    values = {path: value for path, value in draft.applied.items() if not isinstance(value, str)}
    if not values:
        actions.say("no value is set by hand, so the preset would be empty")
        return
    if not _is_written(actions, lambda: save_preset(draft.file, name.strip(), values)):
        return
    actions.say(f"saved {counted(len(values), 'value')} as the preset {name.strip()}")
    actions.session.drafts.reload()


def _is_written(actions: Actions, write: Callable[[], None]) -> bool:
    """Write into the sketch's file; where that cannot be, offer a copy or say why."""
    try:
        write()
    except ReadOnlySketch as error:
        actions.offer, actions.opening = f"{str(error).rpartition(': ')[2].capitalize()}.", "offer"
    except PlaygroundError as error:
        actions.say(str(error))
    else:
        return True
    return False


def copy_toml(actions: Actions, copy: Callable[[str], None]) -> None:
    """Copy the sketch's text as it would be saved; ``copy`` puts a text on the clipboard."""
    draft = _ready(actions)
    if draft is None:
        return
    try:
        text = saved_text(Path(draft.file.file).read_bytes().decode("utf-8-sig"), draft.file, draft.sketch)
    except (OSError, UnicodeDecodeError) as error:
        actions.say(f"{shown(draft.file.file)} cannot be read: {error}")
        return
    copy(text)
    actions.say("copied the sketch as TOML")


def rounded(camera: Camera) -> Camera:
    """Return a camera of as many digits as a person would write: hundredths of degrees, centimetres."""
    return Camera(
        round(camera.azimuth, 2),
        round(camera.elevation, 2),
        round(camera.distance, 2),
        None if camera.target is None else tuple(round(n, 2) for n in camera.target),  # type: ignore[arg-type]
        round(camera.field_of_view, 2),
    )


def _ready(actions: Actions) -> Draft | None:
    """Return what is to be saved, its numbers as the file will have them; None, and a word, if none."""
    session = actions.session
    if session.shown is None:
        actions.say("there is no sketch to save yet")
        return None
    session.drafts.shorten_values()
    if session.shown.edits.camera is not None:
        session.drafts.set_camera(rounded(session.shown.edits.camera))
    actions.look_back(True)  # as part of the step that changed them
    return session.shown


def _before(draft: Draft) -> dict[Key, object]:
    """Return what the file said of everything that is set by hand."""
    values = values_of(draft.base)
    found: dict[Key, object] = {}
    for path in draft.applied:
        known = (
            getattr(draft.base, path)
            if path in TERRAIN_KEYS
            else values[resolve(draft.base.graph, path)[0].path]
        )
        found["value", path] = known
    for name, _ in draft.edits.techniques:
        spec = draft.file.graph.find(name)
        found["technique", name] = spec.use if spec else None
    found["camera", ""] = draft.file.camera
    return {key: value for key, value in found.items() if value is not None}


def _what(draft: Draft) -> str:
    parts = [counted(len(draft.applied), "value")] if draft.applied else []
    parts += [counted(len(draft.edits.techniques), "technique")] if draft.edits.techniques else []
    parts += ["the camera"] if draft.edits.camera is not None else []
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if parts[1:] else parts)
