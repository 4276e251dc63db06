"""The ``shot`` fixture: draw sketches apart from the test's process, compare pictures of any origin.

A test's references are in the folder of its file, as ``screenshots/<test file>/<renderer>/<name>.png``:
``screenshots/test_land.py/llvmpipe/dawn.png``. The folder's name ends in ``.py``, so that no
sketch can have the same.
"""

from __future__ import annotations

import re
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.engine.frame import Frame
from playground.errors import DataError, PlaygroundError
from playground.gpu.context import ContextInfo, context_info
from playground.gpu.textures import read_picture
from playground.shots.checking import checker_of
from playground.shots.plugin_constants import USED
from playground.shots.suite import RenderedShot, ShotCase
from playground.sketch.find import find
from playground.sketch.load import load
from playground.sketch.model import Graph, Shot, Sketch

if TYPE_CHECKING:
    import moderngl

    By = Engine | moderngl.Context | ContextInfo | str


class ShotFixture:
    """What a test in Python draws and compares pictures with."""

    def __init__(self, node: pytest.Item) -> None:
        self._node = node
        self._checker = checker_of(node.config)
        self._names: set[str] = set()
        self._drawn: dict[int, tuple[Frame, ContextInfo]] = {}  # frames held, so that their ids stay theirs
        self._started = time.perf_counter()
        self._begun = False

    def render(
        self,
        sketch: Sketch | str | Path,
        *,
        shot: str = "",
        size: tuple[int, int] | None = None,
        time: float | None = None,
        values: Mapping[str, object] | None = None,
        steps: Mapping[str, int] | None = None,
    ) -> Frame:
        """Draw a sketch in a process of its own, with the expected renderer, and return the frame.

        ``sketch`` may be a path from the test file's folder. ``shot`` is one of its shots to begin
        with; ``size`` in pixels (640 × 360), ``time`` in seconds, ``values`` of parameters by path
        and ``steps`` of repeated passes go over what that says.

        A crash raises ``SandboxCrash``, a draw that hangs ``SandboxTimeout``, a mistake in the sketch
        another ``PlaygroundError``; the next picture is drawn all the same. Skips the test, or
        fails it where ``CI`` is set, without the expected renderer.
        """
        __tracebackhide__ = True
        own = self._case(re.sub(r"[./\\\0]", "-", self._node.name))
        mistake: PlaygroundError
        try:
            found = sketch if isinstance(sketch, Sketch) else load(self._find(sketch))
            begun = found.shot(shot) if shot else Shot(self._node.name)
            prepared = found.for_shot(begun).with_values(values or {})
            wanted = Shot(
                shot or "render",
                size or begun.size,
                begun.time if time is None else float(time),
                steps=tuple({**dict(begun.steps), **(steps or {})}.items()),
            )
            renderer = self._checker.renderer(self._node, own)
            self._begin(own)
            frame = self._checker.renderer_process.render(ShotCase(prepared, wanted))
        except PlaygroundError as error:
            mistake = error
        else:
            self._drawn[id(frame)] = (frame, renderer)
            return frame
        finally:
            self._checker.show_what_was_printed(self._node)
        # Without the frames it came through, which say nothing of the test's own mistake.
        raise self._checker.raised(self._node, own, mistake) from None

    def check(self, picture: Frame | NDArray[Any], name: str, *, by: By | None = None) -> None:
        """Fail the test unless the picture is its reference of that name, or ``--shots-update`` writes it.

        ``picture`` is a frame, or an array (height, width, 3 or 4), top row first: uint8, or
        floats of which 0..1 are shown. ``by`` is what drew it: an engine, a moderngl context,
        or, for what OpenGL has no part in, a name for the folder of references. Frames of
        ``shot.render`` know it. ``name`` is letters, digits, _ and -, once in a test.

        Of an engine's last frame, what went into it is looked at too: a number that is not finite
        in a texture fails. An earlier frame of the engine is refused with ``ValueError``.
        """
        __tracebackhide__ = True
        start, self._started = self._started, time.perf_counter()
        self._refuse_name(name)
        case = self._case(name)
        info = self._renderer_of(case, picture, by)
        self._begin(case)
        self._names.add(name)
        self._node.user_properties.append((USED, f"{info.slug}/{name}"))
        self._checker.hold(self._node, case, _drawn_by(picture, by), info, start)

    def _find(self, sketch: str | Path) -> Path:
        """Return where a sketch is: in the test file's folder, or where a command would find it."""
        neighbour = self._node.path.parent / Path(sketch).expanduser()
        return find(neighbour if neighbour.exists() else sketch)

    def _refuse_name(self, name: str) -> None:
        if not re.fullmatch(r"[\w-]+", name):
            raise ValueError(f"name = {name!r}: a picture needs a name of letters, digits, _ and -")
        if name in self._names:
            raise ValueError(f"a second picture named {name!r} in this test: each needs a name of its own")

    def _case(self, name: str) -> ShotCase:
        """Return what a picture of that name is checked as: a shot of the test file."""
        # References only need a sketch's name and its place.
        file = self._node.path
        return ShotCase(
            Sketch(file.name, str(file), str(file.parent), Graph(file.name, str(file), ())), Shot(name)
        )

    def _begin(self, case: ShotCase) -> None:
        """Remove, once, the records that this test has left in earlier runs."""
        if not self._begun:
            self._begun = True
            self._checker.recorder.forget_earlier(self._node, case)

    def _renderer_of(self, case: ShotCase, picture: object, by: By | None) -> ContextInfo:
        if isinstance(by, str):  # a folder that is named is used with any OpenGL
            if not by or ContextInfo(0, by, "", "", 0).slug != by:
                raise ValueError(f"by = {by!r}: a folder's name is lower-case letters, digits and -")
            return ContextInfo(0, by, "", "", 0)
        if by is None:
            frame, info = self._drawn.get(id(picture), (None, None))
            if frame is None or info is None:
                raise TypeError(
                    "what drew this picture is not known: say by=engine, by=context (moderngl's), "
                    "or by='a name' for the folder of its references"
                )
            return info
        if isinstance(by, ContextInfo):
            return self._checker.expect(self._node, case, by)
        info = by.info if isinstance(by, Engine) else context_info(by)
        return self._checker.expect(self._node, case, info)


def _drawn_by(picture: Frame | NDArray[Any], by: By | None) -> RenderedShot:
    """Return a picture as the renderer process gives it, with all that is known of how it was drawn."""
    rendered = _rendered(picture)
    if by is None:  # drawn by the renderer process, which has looked
        return rendered
    rendered = replace(rendered, gl_error=_error_left(by))
    if not isinstance(by, Engine):
        return rendered
    last = _last_picture(by)
    if last is not None and np.array_equal(last, rendered.array):
        return replace(rendered, not_finite=str(by.not_finite() or ""), drawn=by.internal.drawn())
    if isinstance(picture, Frame):
        raise ValueError(
            "this is not the last frame of its engine, so what went into it cannot be looked at any more: "
            "check each frame before the engine draws the next one or is released"
        )
    return rendered


def _last_picture(engine: Engine) -> NDArray[np.uint8] | None:
    """Return the picture that an engine drew last; None where it has none."""
    if engine.internal.plan is None:
        return None
    view = next(iter(engine.internal.plan.flat.outputs["view"].values()))
    result = engine.internal.results.get(view.path)
    if result is None:
        return None
    with engine.internal.borrowed():
        return read_picture(result.textures[view.output])


def _error_left(by: By) -> str:
    """Return the OpenGL error that drawing has left behind; "" for none."""
    if isinstance(by, str | ContextInfo):
        return ""
    error = (by.ctx if isinstance(by, Engine) else by).error
    return "" if error == "GL_NO_ERROR" else error


def _rendered(picture: Frame | NDArray[Any]) -> RenderedShot:
    """Return a picture as the renderer process gives it, with what is wrong with its numbers."""
    if isinstance(picture, RenderedShot):
        return picture
    if isinstance(picture, Frame):
        return RenderedShot(picture.array, picture.sketch, picture.time)
    array = np.asarray(picture)
    if array.ndim != 3 or array.shape[2] not in (3, 4) or 0 in array.shape:
        raise DataError(f"a picture is an array (height, width, 3 or 4); found {array.shape}")
    wrong = ""
    if np.issubdtype(array.dtype, np.floating):
        bad = int(np.count_nonzero(~np.isfinite(array).all(axis=2)))
        if bad:
            wrong = f"{bad} of {array.shape[0] * array.shape[1]} pixels are not finite numbers"
            array = np.where(np.isfinite(array), array, 0.0)
        array = np.rint(np.clip(array, 0.0, 1.0) * 255.0).astype(np.uint8)
    if array.dtype != np.uint8:
        raise DataError(f"a picture is of uint8, or of floats from 0 to 1; found {array.dtype}")
    if array.shape[2] == 3:
        array = np.concatenate([array, np.full((*array.shape[:2], 1), 255, np.uint8)], axis=2)
    return RenderedShot(np.ascontiguousarray(array), not_finite=wrong)
