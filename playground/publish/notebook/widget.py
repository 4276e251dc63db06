"""Pictures of sketches in a notebook, which the browser draws, or else the kernel, and how they are saved."""

from __future__ import annotations

import io
from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar
from weakref import WeakSet

import anywidget
import numpy as np
import traitlets
from numpy.typing import NDArray
from PIL import Image

from playground.api import parameters
from playground.data.image_files import encode_png
from playground.engine.engine import Engine
from playground.errors import DataError, ParameterError, PlaygroundError, nearest
from playground.publish.notebook.engine_thread import on_engine, release_engine
from playground.publish.notebook.saved import STATE, saved_figure, shipped_runtime
from playground.publish.web.blobs import packed_json
from playground.publish.web.bundle import read_bundle
from playground.publish.web.page_data import page_data
from playground.publish.web.parameter_data import parameters_data, presets_data, tracks_data
from playground.publish.web.plan import FORMAT
from playground.shader.parameter import spell
from playground.sketch.assign import TERRAIN_KEYS, check_value, values_of
from playground.sketch.load import opened
from playground.sketch.model import Camera, Sketch, Value
from playground.sketch.toml_sketch import camera_of
from playground.sketch.toml_table import CAMERA
from playground.sketch.traits import is_animated

BROWSER = "browser"
KERNEL = "kernel"


class LiveWidget(anywidget.AnyWidget):
    """A figure that the browser's runtime draws, or else the kernel; both have the same values.

    ``page`` is what the runtime needs (gzip in base64), "" where no page can run the figure. ``picture`` is
    a PNG: what is shown until something is drawn, and where there are no widgets. ``mistake`` is a message
    under the picture, "" for none. ``drawn_by`` is "browser" or "kernel" once the figure is shown, and
    ``why`` says why it is the kernel.
    """

    _esm = read_bundle("notebook.js")
    _css = read_bundle("notebook.css")

    kind = traitlets.Unicode("block").tag(sync=True)
    page = traitlets.Unicode("").tag(sync=True)
    language = traitlets.Unicode("en").tag(sync=True)
    picture = traitlets.Bytes(b"").tag(sync=True)
    alt = traitlets.Unicode("").tag(sync=True)
    mistake = traitlets.Unicode("").tag(sync=True)
    drawn_by = traitlets.Unicode("").tag(sync=True)
    why = traitlets.Unicode("").tag(sync=True)

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        """Show the figure, or its picture, where no widgets can be: in a saved notebook, on a page."""
        bundle = super()._repr_mimebundle_(**kwargs)
        if bundle is None:
            return None
        data, metadata = bundle if isinstance(bundle, tuple) else (bundle, {})
        shown = {**data, "image/png": b64encode(self.picture).decode()}
        if self.page:
            state = self.get_state([name for name in STATE if name in self.keys])
            shown["text/html"] = str(saved_figure(state, self.picture, shipped_runtime()))
        return shown, metadata


# ── the page of a sketch ───────────────────────────────────────────────────────


MAX_PAGE_LETTERS = 24 * 2**20
"""Letters of a page that a notebook is given: it is sent to the browser, and saved in the notebook."""


def browser_page(
    sketches: Sequence[Sketch], size: tuple[int, int], engine: Engine
) -> tuple[str, list[frozenset[str]]]:
    """Return sketches as a page, packed, for a picture of ``size`` pixels; and the paths fixed in each.

    Raises ``PlaygroundError`` for any mistake in a sketch, for what no page can run, and for what is too
    large.
    """
    data = page_data(sketches, frame=size, engine=engine)
    page = packed_json(data)
    if len(page) > MAX_PAGE_LETTERS:
        millions = [round(number / 2**20) for number in (len(page), MAX_PAGE_LETTERS)]
        raise PlaygroundError(f"its data take {millions[0]} MB; a notebook is given {millions[1]} at most")
    fixed = [
        frozenset(row["path"] for row in sketch_data["shown"] if row["locked"] or row["widget"] == "file")
        for sketch_data in data["sketches"]
    ]
    return page, fixed


def kernel_outline(sketches: Sequence[Sketch], size: tuple[int, int], engine: Engine) -> str:
    """Return what can be dragged of sketches, packed; raise ``PlaygroundError`` for any mistake in one."""
    return packed_json({"sketches": [_outline(sketch, size, engine) for sketch in sketches]})


def _outline(sketch: Sketch, size: tuple[int, int], engine: Engine) -> dict[str, Any]:
    terrain = engine.plan(sketch, size).terrain
    values = values_of(sketch)
    rows = parameters_data(sketch, values, _unlocked)
    return {
        "format": FORMAT,
        "name": sketch.name,
        "title": sketch.title,
        "frame": list(size),
        "time": 0.0,
        "steps": {},
        "terrain": {
            "size": list(terrain.size or ()),
            "extent": list(terrain.extent or ()),
            "relief": terrain.relief,
            "base_elevation": terrain.base_elevation,
            "locked": "",
        },
        "camera": asdict(sketch.camera),
        "kernels": [],
        "nodes": [],
        "passes": {},
        "values": values,
        "shown": rows,
        "presets": presets_data(sketch, rows, _as_it_is)[0],
        "tracks": tracks_data(sketch, _unlocked, _as_it_is)[0],
        "duration": sketch.duration,
        "moves": is_animated(sketch),
        "rules": [],
        "textures": [],
        "choices": [],
        "notes": [],
    }


def _unlocked(_path: str, _targets: tuple[str, ...]) -> str:
    return ""


def _as_it_is(_path: str, value: Value) -> Value:
    return value


# ── pictures of sketches ───────────────────────────────────────────────────────


AUTO = "auto"
DRAWERS = (AUTO, BROWSER, KERNEL)
_SIDE = (16, 4096)  # pixels a side of a picture, least and most
_MAX_SECONDS = 1e9
_JPEG = 85  # quality while something moves; at rest it is a PNG
_MAX_SLIDERS = 8  # sliders of a sketch that does not name its main parameters

Values = Mapping[str, Value]

open_widgets: WeakSet[SketchesWidget] = WeakSet()


class _ByPath(traitlets.TraitType[Any, Any]):
    """Values by path, read-only; setting some leaves the others as they are."""

    def __init__(self) -> None:
        super().__init__(MappingProxyType({}))
        self.tag(sync=True, to_json=lambda value, _: dict(value))

    def validate(self, obj: SketchesWidget, value: object) -> Values:
        """Return all values of that side, with those given among them; raise ``ParameterError``."""
        assert self.name
        if not isinstance(value, Mapping) or not all(isinstance(path, str) for path in value):
            raise ParameterError(f"{self.name}: expected values by path, as {{'light.sun': (250, 12)}}")
        return obj.taken(self.name, value)


class _View(traitlets.TraitType[Any, Any]):
    """A camera, or a mapping of its values; None is the sketch's own."""

    def __init__(self) -> None:
        super().__init__(None, allow_none=True)
        self.tag(sync=True, to_json=lambda camera, _: camera and asdict(camera))

    def validate(self, obj: SketchesWidget, value: object) -> Camera:
        """Return the camera; raise ``ParameterError`` for one that cannot be."""
        return _camera(value)


class _Seconds(traitlets.TraitType[Any, Any]):
    """A finite time, 0 or later."""

    def __init__(self) -> None:
        super().__init__(0.0)
        self.tag(sync=True)

    def validate(self, obj: SketchesWidget, value: object) -> float:
        """Return the time as a number; raise ``ParameterError`` for one that cannot be."""
        return _seconds(value)


class _Size(traitlets.TraitType[Any, Any]):
    """Width and height of a picture in pixels."""

    def __init__(self) -> None:
        super().__init__((640, 360))
        self.tag(sync=True, to_json=lambda size, _: list(size))

    def validate(self, obj: SketchesWidget, value: object) -> tuple[int, int]:
        """Return width and height; raise ``DataError`` for a size that cannot be."""
        return _pixels(value)


class SketchesWidget(LiveWidget):
    """Pictures of sketches whose values, camera and time are the same here and in the browser.

    ``camera`` is None where the sketch's own is shown; ``time`` is in seconds; ``playing`` says whether time
    goes on, in the browser. Each trait can be set, and followed with ``observe``.
    """

    SIDES: ClassVar[tuple[str, ...]] = ()  # names of the traits with the values, one for each sketch

    kind = traitlets.Unicode("sketch").tag(sync=True)
    outline = traitlets.Unicode("").tag(sync=True)  # in place of ``page``, where the kernel draws
    draws = traitlets.Enum(DRAWERS, AUTO).tag(sync=True)
    sides = traitlets.List(traitlets.Unicode()).tag(sync=True)
    names = traitlets.List(traitlets.Unicode()).tag(sync=True)  # of the pictures, where there are several
    rows = traitlets.List(traitlets.Unicode()).tag(sync=True)  # paths of the sliders
    swipe = traitlets.Bool(False).tag(sync=True)
    size = _Size()  # [pixels] of a picture at rest
    camera = _View()
    time = _Seconds()
    playing = traitlets.Bool(False).tag(sync=True)

    def __init__(
        self,
        sketches: Sequence[Sketch],
        *,
        size: tuple[int, int] = (640, 360),
        sliders: Sequence[str] | None = None,
        draws: str = AUTO,
        language: str = "en",
        **traits: Any,
    ) -> None:
        if draws not in DRAWERS:
            raise DataError(f"draws = '{draws}': expected one of {', '.join(DRAWERS)}")
        size = _pixels(size)
        self._sliders = sliders
        made = self._made(sketches, size, draws)
        self._take(sketches)
        super().__init__(sides=list(self.SIDES), size=size, draws=draws, language=language, **traits, **made)
        self.observe(self._remade, names=list(self.SIDES))
        self.on_msg(self.receive)
        open_widgets.add(self)

    def set_state(self, sync_data: object) -> None:
        """Take the state of a browser; raise ``ParameterError`` for what is none."""
        if not isinstance(sync_data, Mapping):
            raise ParameterError(f"the state of a widget is a mapping, not {type(sync_data).__name__}")
        for name in sync_data:
            if name not in self.keys:
                public = [key for key in self.keys if not key.startswith("_")]
                raise ParameterError(f"a widget has no '{name}'{nearest(str(name), public)}")
        super().set_state(sync_data)

    # ── values ─────────────────────────────────────────────────────────────────

    def taken(self, side: str, values: Mapping[str, object]) -> Values:
        """Set values of a side's sketch and return all of them, by path; raise ``ParameterError``."""
        at = self.SIDES.index(side)
        sketch, now = self._now[at], self._values[at]
        if terrain := [path for path in values if path in TERRAIN_KEYS]:
            change = f"widget.sketch.with_values({{'{terrain[0]}': …}})"
            raise ParameterError(f"{terrain[0]} is the terrain's own, no slider: widget.sketch = {change}")
        checked = {path: check_value(sketch, path, value) for path, value in values.items()}
        news = {path: value for path, value in checked.items() if path not in now or value != now[path]}
        if news:
            self._now[at] = sketch.with_values(news)
            self._values[at] = _all_values(self._now[at])
        return MappingProxyType(self._values[at])

    def on_change(self, act: Callable[[dict[str, Value]], object]) -> Callable[[], None]:
        """Call a function with what has changed, by path, after every change; return what ends that.

        Changes come from sliders and from Python alike. ``observe(f, "camera")`` follows the other traits.
        """

        def changed(change: Any) -> None:
            old, new = change["old"], change["new"]
            act({path: value for path, value in new.items() if path not in old or old[path] != value})

        self.observe(changed, names=list(self.SIDES))
        return lambda: self.unobserve(changed, names=list(self.SIDES))

    def _take(self, sketches: Sequence[Sketch]) -> None:
        self._base = list(sketches)  # as the page has them
        self._now = list(sketches)  # with the values that are shown
        self._values = list(map(_all_values, sketches))

    def _as_shown(self, at: int) -> Sketch:
        return self._now[at] if self.camera is None else self._now[at].with_camera(self.camera)

    # ── the page ───────────────────────────────────────────────────────────────

    def _show(self, sketches: Callable[[], Sequence[Sketch]]) -> None:
        """Show other sketches; what is wrong with one is said, and the last good picture stays."""
        try:
            sketches_shown = sketches()
            made = self._made(sketches_shown, self.size, self.draws)
        except PlaygroundError as error:
            self.mistake = str(error)
            return
        self._take(sketches_shown)
        with self.hold_sync():
            self.mistake, self.camera = "", None
            for name, value in made.items():
                setattr(self, name, value)

    def _made(self, sketches: Sequence[Sketch], size: tuple[int, int], draws: str) -> dict[str, Any]:
        """Return the traits that some sketches give; raise ``PlaygroundError`` for a mistake in one."""
        rows = list(dict.fromkeys(path for sketch in sketches for path in self._rows_of(sketch)))
        if self._sliders is None and len(sketches) > 1:  # what was set of one, for one, is what differs
            set_of_one = [path for sketch in sketches for path, _ in sketch.overrides if path not in rows]
            rows += dict.fromkeys(set_of_one)

        def work(engine: Engine) -> dict[str, Any]:
            frames = [engine.render(sketch, size=size, time=self.time).array for sketch in sketches]
            made = {"page": "", "outline": "", "why": "", "picture": encode_png(np.hstack(frames))}
            fixed = [frozenset[str]()] * len(sketches)
            if draws == KERNEL:
                made["why"] = "draws = 'kernel'"
            else:
                try:
                    made["page"], fixed = browser_page(sketches, size, engine)
                except PlaygroundError as error:
                    if draws == BROWSER:
                        raise
                    made["why"] = str(error)
            if not made["page"]:
                made["outline"] = kernel_outline(sketches, size, engine)
            self._fixed = fixed
            return made

        alt = " | ".join(sketch.title or sketch.name for sketch in sketches)
        return {"alt": alt, "rows": rows, **{side: {} for side in self.SIDES}, **on_engine(work)}

    def _rows_of(self, sketch: Sketch) -> Sequence[str]:
        shown_parameters = parameters(sketch)
        if self._sliders is None:
            main = [path for path in sketch.main if path in shown_parameters]
            return main or [path for path in shown_parameters if path.count(".") == 1][:_MAX_SLIDERS]
        for path in self._sliders:
            if path not in shown_parameters:
                raise ParameterError(
                    f"no parameter '{path}' in sketch {sketch.name}{nearest(path, shown_parameters)}"
                )
        return self._sliders

    def _remade(self, change: Any) -> None:
        """Make the page again where what has changed is fixed in it: what a source gives, for one."""
        old, new = change["old"], change["new"]
        fixed = self._fixed[self.SIDES.index(change["name"])]
        if any(old.get(path) != new[path] for path in fixed):
            camera, now = self.camera, list(self._now)
            self._show(lambda: now)
            self.camera = camera

    # ── pictures that the kernel draws ─────────────────────────────────────────

    def receive(self, _: object, content: Any, _buffers: object) -> None:
        """Answer a message of the browser that requests an image."""
        asked = content.get("draw")
        if asked is None:
            return
        answer, buffers = {"drawn": asked["id"], "error": ""}, []
        try:
            buffers = [self._drawn(asked)]
        except Exception as error:
            answer["error"] = str(error)
            if not isinstance(error, PlaygroundError):
                raise
        finally:
            self.send(answer, buffers)  # what the browser waits for before it asks for another

    def _drawn(self, asked: Mapping[str, Any]) -> bytes:
        values = {path: tuple(v) if isinstance(v, list) else v for path, v in asked["values"].items()}
        sketch = self._base[asked["side"]].with_values(values).with_camera(_camera(asked["camera"]))
        width, height = (min(max(int(side), 1), _SIDE[1]) for side in asked["size"])
        time = _seconds(asked["time"])
        frame = on_engine(lambda engine: engine.render(sketch, size=(width, height), time=time))
        return _sent(frame.array, moving=asked["moving"])

    def close(self) -> None:
        """End the widget, in every browser; with the last one the engine's memory is released."""
        was_open = self in open_widgets
        super().close()
        open_widgets.discard(self)
        self.page, self.outline, self.picture = "", "", b""
        if was_open and not open_widgets:
            release_engine()


class SketchWidget(SketchesWidget):
    """A sketch as an interactive picture; ``widget[path]`` and ``widget.values`` are its parameters."""

    SIDES = ("values",)

    values = _ByPath()

    @property
    def sketch(self) -> Sketch:
        """The sketch as it is shown, with its values and its camera; set another, or a name or path."""
        return self._as_shown(0)

    @sketch.setter
    def sketch(self, sketch: Sketch | str | Path) -> None:
        """Show another sketch; a mistake in it is said in ``mistake``, and the last good picture stays."""
        self._show(lambda: [opened(sketch)])

    def __getitem__(self, path: str) -> Value:
        values: Values = self.values
        if path not in values:
            raise ParameterError(f"no parameter '{path}'{nearest(path, values)}")
        return values[path]

    def __setitem__(self, path: str, value: object) -> None:
        self.values = {path: value}


class CompareWidget(SketchesWidget):
    """Two sketches next to each other; ``left`` and ``right`` are their parameters, by path."""

    SIDES = ("left", "right")

    left = _ByPath()
    right = _ByPath()

    @property
    def sketches(self) -> tuple[Sketch, Sketch]:
        """The sketches as they are shown; set others, or names or paths."""
        return self._as_shown(0), self._as_shown(1)

    @sketches.setter
    def sketches(self, sketches: tuple[Sketch | str | Path, Sketch | str | Path]) -> None:
        """Show two others; a mistake in one is said in ``mistake``, and the last good pictures stay."""
        self._show(lambda: [opened(side) for side in sketches])


def _all_values(sketch: Sketch) -> dict[str, Value]:
    return {path: value for path, (_, value) in parameters(sketch).items()}


def _camera(value: object) -> Camera:
    values = asdict(value) if isinstance(value, Camera) else value
    if not isinstance(values, Mapping):
        raise ParameterError(f"camera = {spell(value)}: expected a Camera or its values by name")
    for key in values:
        if key not in CAMERA:
            raise ParameterError(f"camera: no '{key}'{nearest(str(key), CAMERA)}")
    if isinstance(target := values.get("target"), tuple):
        values = {**values, "target": list(target)}
    return camera_of(values, Camera(), lambda _, message: ParameterError(f"camera: {message}"))


def _pixels(pixels: object) -> tuple[int, int]:
    low, high = _SIDE
    sides = pixels if isinstance(pixels, list | tuple) else ()
    if len(sides) != 2 or not all(type(side) is int and low <= side <= high for side in sides):
        raise DataError(f"size = {spell(pixels)}: expected two whole numbers of pixels from {low} to {high}")
    return sides[0], sides[1]


def _seconds(value: object) -> float:
    if type(value) not in (int, float) or not 0 <= value <= _MAX_SECONDS:  # type: ignore[operator]
        raise ParameterError(f"time = {spell(value)}: expected seconds from 0 to {_MAX_SECONDS:g}")
    return float(value)  # type: ignore[arg-type]


def _sent(picture: NDArray[np.uint8], *, moving: bool) -> bytes:
    """Return a picture as a browser is sent it: small and soon while something moves, exact at rest."""
    stream = io.BytesIO()
    if moving:
        Image.fromarray(picture[..., :3]).save(stream, "JPEG", quality=_JPEG)
    else:
        Image.fromarray(picture).save(stream, "PNG", compress_level=1)
    return stream.getvalue()
