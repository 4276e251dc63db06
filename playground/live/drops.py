"""What becomes of a file that is dropped on the window: a sketch opens, an image is put where it fits."""

from __future__ import annotations

from pathlib import Path

from imgui_bundle import ImVec2, imgui

from playground.errors import PlaygroundError
from playground.live.theme import Theme
from playground.live.widgets import IMAGES
from playground.sketch.allowed_files import SHADERS
from playground.sketch.find import find
from playground.sketch.model import Parameter, Value
from playground.sketch.unpack import is_pack, unpacked_beside
from playground.workbench.actions import Actions
from playground.workbench.parameter_list import Listing

_TITLE = "dropped"


def take_dropped(actions: Actions, paths: list[Path]) -> None:
    """Do what files dropped on the window ask for: the first sketch opens, images wait for a choice."""
    for path in paths:
        if is_pack(path) and path.is_file():
            _open_pack(actions, path)
            return
        if (path / "sketch.toml").is_file() or path.suffix == ".toml" or path.suffix in SHADERS:
            actions.open(path)
            return
    images = [path for path in paths if path.suffix.lower() in IMAGES and path.is_file()]
    for path in paths:
        if path not in images:
            actions.say(f"{path.name} is neither a sketch, a shader nor an image")
    if images and not feeds(actions):
        actions.say(f"no parameter of this sketch takes a file, so {images[0].name} has no place in it")
    elif images:
        actions.dropped, actions.opening = images, _TITLE


def opened_from(sketch: Path) -> tuple[Path, str]:
    """Return the file of a sketch to be worked on, and what is to be said of it: a zip is unpacked beside it.

    Raises ``SketchError`` or ``DataError`` for one that cannot be opened.
    """
    path = sketch.expanduser()
    return unpacked_beside(path) if is_pack(path) and path.is_file() else (find(sketch), "")


def _open_pack(actions: Actions, path: Path) -> None:
    try:
        file, sentence = unpacked_beside(path)
    except PlaygroundError as error:
        actions.say(str(error))
        return
    actions.say(sentence)
    actions.open(file)


def feeds(actions: Actions) -> list[tuple[str, Parameter, Value]]:
    """Return the parameters that a file can be put into, those a technique shows before those inside.

    Each with its path and the file that it has now.
    """
    draft = actions.session.shown
    if draft is None:
        return []
    listing = Listing()
    items = [item for section in listing.sections(draft) for item in section.items]
    values = listing.values(draft).of
    found = [item for item in items if item.parameter.widget.kind == "file"]
    found.sort(key=lambda item: not item.exported)
    return [(item.path, item.parameter, values[item.path]) for item in found]


def put(actions: Actions, path: str) -> None:
    """Put the file that waits into a parameter."""
    file, *actions.dropped = actions.dropped
    actions.opening = _TITLE if actions.dropped else ""
    actions.set_all(f"{file.name} into {path}", {path: str(file.resolve())})


def draw_drops(actions: Actions, look: Theme) -> None:
    """Draw the choice of what the file that waits is for."""
    if actions.opening == _TITLE:
        actions.opening = ""
        imgui.open_popup(_TITLE)
    if not actions.dropped:
        return
    room = imgui.get_main_viewport().size
    imgui.set_next_window_pos(ImVec2(room.x / 2, room.y / 2), imgui.Cond_.always, ImVec2(0.5, 0.5))
    if not imgui.begin_popup(_TITLE):
        actions.dropped = []  # a click beside it
        return
    with look.font(look.bold):
        imgui.text_unformatted(f"Put {actions.dropped[0].name} where?")
    for path, parameter, now in feeds(actions):
        if imgui.selectable(f"{parameter.title}   {path}##{path}", False)[0]:
            put(actions, path)
            break
        if now:
            imgui.set_item_tooltip(f"now {now}")
    imgui.end_popup()
