"""Files dropped on the window: a sketch opens, an image, video or sound goes to what takes one.

An elevation file may do either: it opens, where no parameter of the sketch takes one.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from playground.allowed_files import SHADERS, VECTORS, is_elevation
from playground.errors import PlaygroundError
from playground.shader.dialect import dialects
from playground.sketch.find import find, is_pack, unpacked_beside
from playground.sketch.model import Parameter, Sketch, Value
from playground.studio.actions import Actions
from playground.studio.channels.channels import IMAGES, MEDIA, Taker, takers
from playground.studio.language import tr
from playground.studio.panel.parameter_list import Item, items_of, shown_values

_FILES = (*IMAGES, *VECTORS, *(ending for endings in MEDIA.values() for ending in endings))
_VECTORS = "vectors"  # what a source of vector data calls its file


def opened_from(sketch: Path) -> tuple[Path, str]:
    """Return the file of a sketch to work on, and a notice for it: a zip is unpacked next to it.

    Raises ``SketchError`` or ``DataError`` for one that cannot be opened.
    """
    path = sketch.expanduser()
    return unpacked_beside(path) if is_pack(path) and path.is_file() else (find(sketch), "")


def is_sketch(path: Path) -> bool:
    """Return whether a file or a folder opens as a sketch."""
    if path.is_dir():
        return (path / "sketch.toml").is_file() or dialects().image_of(path) is not None
    with suppress(PlaygroundError):
        return path.suffix == ".toml" or path.suffix in SHADERS or dialects().is_export(path)
    return False


def is_terrain(path: Path) -> bool:
    """Return whether a file holds elevations, as a PNG seldom does."""
    return is_elevation(path) and path.suffix.lower() != ".png"


@dataclass
class Drops:
    """The files that were dropped on one window."""

    actions: Actions
    waiting: list[Path] = field(default_factory=list)  # files that the user is to choose a place for
    asks: bool = False  # the choice is still to be shown
    _takers: dict[str, tuple[Taker, ...]] = field(default_factory=dict)  # by the ending of what waits
    _takers_of: Sketch | None = None

    def take(self, paths: list[Path]) -> None:
        """Take in dropped files: the first sketch opens, images, videos and sounds wait for a choice."""
        say = self.actions.notices.say
        for path in paths:
            if is_pack(path) and path.is_file():
                self._open_pack(path)
                return
            if is_sketch(path):
                self.actions.open(path)
                return
        files = [path for path in paths if path.suffix.lower() in _FILES and path.is_file()]
        for path in paths:
            if path not in files:
                say(
                    tr(
                        "{path} is neither a sketch, a shader nor an image, a video or a sound",
                        path=path.name,
                    )
                )
        parameter_files = [path for path in files if self.parameters(path) or self.channels(path)]
        if files and not parameter_files and is_terrain(files[0]):
            self.actions.open(files[0])
            return
        if files and not parameter_files:
            say(
                tr(
                    "no parameter of this sketch takes a file like {name}, so it has no place in it",
                    name=files[0].name,
                )
            )
        elif parameter_files:
            self.waiting, self.asks = parameter_files, True

    def parameters(self, file: Path) -> list[tuple[str, Parameter, Value]]:
        """Return the parameters that take a file, those a technique exports first; those of channels not.

        Each with its path and the file that it has now.
        """
        draft = self.actions.session.shown
        if draft is None:
            return []
        items, values = items_of(draft).values(), shown_values(draft).of
        kernels = dict(draft.base.graph.kernels)

        def takes(item: Item) -> bool:
            registry = kernels[item.leaf.rpartition(".")[0]].registry
            usual = VECTORS if item.parameter.name == _VECTORS else IMAGES
            return file.suffix.lower() in MEDIA.get(registry, usual)

        file_items = [item for item in items if item.parameter.widget.kind == "file" and takes(item)]
        feeders = {taker.channel.feeder for taker in self.channels(file) if taker.channel.alone}
        file_items = [item for item in file_items if item.path.partition(".")[0] not in feeders]
        file_items.sort(key=lambda item: not item.exported)
        return [(item.path, item.parameter, values[item.path]) for item in file_items]

    def channels(self, file: Path) -> tuple[Taker, ...]:
        """Return the channels of other tools' shaders that take a file."""
        draft, ending = self.actions.session.shown, file.suffix.lower()
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
        self.actions.session.drafts.feed(taker.channel.path, taker.source, **{taker.parameter: file})

    def _next(self) -> Path:
        file, *self.waiting = self.waiting
        self.asks = bool(self.waiting)
        return file

    def open(self) -> None:
        """Open the elevation file that waits, in a sketch of its own."""
        self.actions.open(self._next())

    def put(self, path: str) -> None:
        """Put the file that waits into a parameter."""
        file = self._next()
        self.actions.set_all(tr("{file} into {path}", file=file.name, path=path), {path: str(file.resolve())})

    def _open_pack(self, path: Path) -> None:
        try:
            file, message = unpacked_beside(path)
        except PlaygroundError as error:
            self.actions.notices.say(str(error))
            return
        self.actions.notices.say(message)
        self.actions.open(file)
