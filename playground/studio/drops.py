"""Files dropped on the window: a sketch opens, an image, video or sound goes to what takes one.

An elevation file may do either: it opens, where no parameter of the sketch takes one.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from imgui_bundle import ImVec2, imgui

from playground.allowed_files import SHADERS, VECTORS, is_elevation
from playground.errors import PlaygroundError
from playground.shader.dialect import dialects
from playground.sketch.find import find, is_pack, unpacked_beside
from playground.sketch.model import Parameter, Sketch, Value
from playground.studio.actions import Commands
from playground.studio.channels.channel_list import MEDIA, Taker, in_words, takers
from playground.studio.panel.parameter_list import Item, items_of, shown_values
from playground.studio.theme import Theme
from playground.studio.widgets import IMAGES

_TITLE = "dropped"
_OWN = "Into a sketch of its own"
_FILES = (*IMAGES, *VECTORS, *(ending for endings in MEDIA.values() for ending in endings))
_VECTORS = "vectors"  # what a source of vector data calls its file


def opened_from(sketch: Path) -> tuple[Path, str]:
    """Return the file of a sketch to work on, and a notice for it: a zip is unpacked next to it.

    Raises ``SketchError`` or ``DataError`` for one that cannot be opened.
    """
    path = sketch.expanduser()
    return unpacked_beside(path) if is_pack(path) and path.is_file() else (find(sketch), "")


def _is_sketch(path: Path) -> bool:
    """Return whether a file or a folder opens as a sketch."""
    if path.is_dir():
        return (path / "sketch.toml").is_file() or dialects().image_of(path) is not None
    with suppress(PlaygroundError):
        return path.suffix == ".toml" or path.suffix in SHADERS or dialects().is_export(path)
    return False


def _is_terrain(path: Path) -> bool:
    """Return whether a file holds elevations, as a PNG seldom does."""
    return is_elevation(path) and path.suffix.lower() != ".png"


@dataclass
class Drops:
    """The files that were dropped on one window."""

    commands: Commands
    waiting: list[Path] = field(default_factory=list)  # files that the user is to choose a place for
    _asks: bool = False  # the choice is still to be shown
    _takers: dict[str, tuple[Taker, ...]] = field(default_factory=dict)  # by the ending of what waits
    _takers_of: Sketch | None = None

    def take(self, paths: list[Path]) -> None:
        """Take in dropped files: the first sketch opens, images, videos and sounds wait for a choice."""
        say = self.commands.notices.say
        for path in paths:
            if is_pack(path) and path.is_file():
                self._open_pack(path)
                return
            if _is_sketch(path):
                self.commands.open(path)
                return
        files = [path for path in paths if path.suffix.lower() in _FILES and path.is_file()]
        for path in paths:
            if path not in files:
                say(f"{path.name} is neither a sketch, a shader nor an image, a video or a sound")
        parameter_files = [path for path in files if self.parameters(path) or self.channels(path)]
        if files and not parameter_files and _is_terrain(files[0]):
            self.commands.open(files[0])
            return
        if files and not parameter_files:
            say(f"no parameter of this sketch takes a file like {files[0].name}, so it has no place in it")
        elif parameter_files:
            self.waiting, self._asks = parameter_files, True

    def parameters(self, file: Path) -> list[tuple[str, Parameter, Value]]:
        """Return the parameters that take a file, those a technique exports first; those of channels not.

        Each with its path and the file that it has now.
        """
        draft = self.commands.session.shown
        if draft is None:
            return []
        items, values = items_of(draft).values(), shown_values(draft).of
        kernels = dict(draft.base.graph.kernels)

        def takes(item: Item) -> bool:
            registry = kernels[item.leaf.rpartition(".")[0]].registry
            usual = VECTORS if item.parameter.name == _VECTORS else IMAGES
            return file.suffix.lower() in MEDIA.get(registry, usual)

        items_found = [item for item in items if item.parameter.widget.kind == "file" and takes(item)]
        feeders = {taker.channel.feeder for taker in self.channels(file) if taker.channel.alone}
        items_found = [item for item in items_found if item.path.partition(".")[0] not in feeders]
        items_found.sort(key=lambda item: not item.exported)
        return [(item.path, item.parameter, values[item.path]) for item in items_found]

    def channels(self, file: Path) -> tuple[Taker, ...]:
        """Return the channels of other tools' shaders that take a file."""
        draft, ending = self.commands.session.shown, file.suffix.lower()
        if draft is None:
            return ()
        if self._takers_of is not draft.base:
            self._takers_of, self._takers = draft.base, {}
        if ending not in self._takers:
            self._takers[ending] = takers(draft.base, ending)
        return self._takers[ending]

    def feed(self, taker: Taker) -> None:
        """Feed a channel from the file that waits."""
        file = str(self._next().resolve())
        self.commands.session.drafts.feed(taker.channel.path, taker.source, **{taker.parameter: file})

    def _next(self) -> Path:
        file, *self.waiting = self.waiting
        self._asks = bool(self.waiting)
        return file

    def open(self) -> None:
        """Open the elevation file that waits, in a sketch of its own."""
        self.commands.open(self._next())

    def put(self, path: str) -> None:
        """Put the file that waits into a parameter."""
        file = self._next()
        self.commands.set_all(f"{file.name} into {path}", {path: str(file.resolve())})

    def draw(self, look: Theme) -> None:
        """Draw the choice of what the file that waits is for."""
        if self._asks:
            self._asks = False
            imgui.open_popup(_TITLE)
        if not self.waiting:
            return
        room = imgui.get_main_viewport().size
        imgui.set_next_window_pos(ImVec2(room.x / 2, room.y / 2), imgui.Cond_.always, ImVec2(0.5, 0.5))
        if not imgui.begin_popup(_TITLE):
            self.waiting = []  # a click outside closed it
            return
        with look.font(look.bold):
            imgui.text_unformatted(f"Put {self.waiting[0].name} where?")
        draft = self.commands.session.shown
        if _is_terrain(self.waiting[0]) and imgui.selectable(_OWN, False)[0]:
            self.open()
        for taker in self.channels(self.waiting[0]) if self.waiting else ():
            if imgui.selectable(f"{taker.channel.path}##channel {taker.channel.path}", False)[0]:
                self.feed(taker)
                break
            if draft is not None:
                imgui.same_line(0, 2 * imgui.get_style().item_spacing.x)
                imgui.text_disabled(f"now {in_words(draft.base, taker.channel.source)}")
        for path, parameter, now in self.parameters(self.waiting[0]) if self.waiting else ():
            if imgui.selectable(f"{parameter.title}   {path}##{path}", False)[0]:
                self.put(path)
                break
            if now:
                imgui.set_item_tooltip(f"now {now}")
        imgui.end_popup()

    def _open_pack(self, path: Path) -> None:
        try:
            file, sentence = unpacked_beside(path)
        except PlaygroundError as error:
            self.commands.notices.say(str(error))
            return
        self.commands.notices.say(sentence)
        self.commands.open(file)
