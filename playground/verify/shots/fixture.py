"""The ``shot`` fixture: draw sketches apart from the test's process, compare pictures of any origin.

A test's references are in the folder of its file, as ``screenshots/<test file>/<renderer>/<name>.png``:
``screenshots/test_land.py/llvmpipe/dawn.png``. The folder's name ends in ``.py``, so that no
sketch can have the same.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.engine.context import ContextInfo, context_info
from playground.engine.engine import Engine
from playground.engine.frame import Frame
from playground.engine.textures import read_picture
from playground.errors import DataError, PlaygroundError
from playground.paths import shown
from playground.sketch.find import find
from playground.sketch.load import load
from playground.sketch.model import Given, Graph, Shot, Sketch, tolerance_of
from playground.verify.shots.adapters import MaskOfTest, PictureFromTest, levels_of, picture_from
from playground.verify.shots.checking import (
    add_check,
    add_failure,
    checker_of,
    expect_check,
    fail_for_what_is_left,
)
from playground.verify.shots.compare import Light
from playground.verify.shots.names import name_of_test, one_spelling, why_no_name
from playground.verify.shots.plugin_constants import USED
from playground.verify.shots.suite import RenderedShot, ShotCase, film_of

if TYPE_CHECKING:
    import moderngl

    By = Engine | moderngl.Context | ContextInfo | str

_HERE = str(Path(__file__).parent)


class ShotFixture:
    """What a test in Python draws and compares pictures with."""

    def __init__(self, node: pytest.Item) -> None:
        self._node = node
        self._checker = checker_of(node.config)
        self._names: dict[str, str] = {}  # as they were given, by the one spelling of each
        # By id of the frame, which is held so that its id stays its own.
        self._drawn: dict[int, tuple[Frame, ContextInfo, ShotCase]] = {}
        self._started = time.perf_counter()
        self._is_cleared = False
        expect_check(node)

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
        own = self._case(Shot(name_of_test(self._node.nodeid)))
        mistake: PlaygroundError
        try:
            loaded = sketch if isinstance(sketch, Sketch) else load(self._find(sketch))
            base_shot = loaded.shot(shot) if shot else Shot(self._node.name)
            prepared = loaded.for_shot(base_shot).with_values(values or {})
            shot_wanted = Shot(
                shot or "render",
                size or base_shot.size,
                base_shot.time if time is None else float(time),
                steps=tuple({**dict(base_shot.steps), **(steps or {})}.items()),
            )
            renderer = self._checker.renderer(self._node, own)
            self._forget_earlier(own)
            frame = self._checker.renderer_process.render(ShotCase(prepared, shot_wanted))
        except PlaygroundError as error:
            mistake = error
        else:
            self._drawn[id(frame)] = (frame, renderer, ShotCase(prepared, shot_wanted))
            return frame
        finally:
            self._checker.show_what_was_printed(self._node)
        add_check(self._node)  # it may be what the test expects
        # Without the frames it came through, which say nothing of the test's own mistake.
        raise self._checker.raised(self._node, own, mistake) from None

    def check(
        self,
        picture: object,
        name: str = "",
        *,
        by: By | None = None,
        tone: str = "",
        tolerance: Given | None = None,
        reason: str = "",
        mask: object = None,
        allow_blank: bool = False,
    ) -> bool:
        """Compare a picture with its reference of that name, which ``--shots-update`` writes.

        A picture that differs, or is none, fails the test when that ends, so that all of its checks
        are made; returned is whether this one passed.

        ``picture`` is a frame, or what holds a picture: an array (height, width, 3 or 4) or grey, top
        row first, of uint8, uint16, or floats from 0 to 1; an image of Pillow; a framebuffer or texture
        of moderngl; a window of moderngl-window; a figure of matplotlib; what has ``snapshot()``,
        ``to_rgba()`` or ``__array__``. ``tone`` says what floats outside 0..1 mean: "clip", "srgb" or
        "reinhard" (the last two of linear light).

        ``by`` is what drew it: an engine, a moderngl context, or, for what OpenGL has no part in, a name
        for the folder of references. Frames of ``shot.render``, what moderngl drew, and figures know it.
        ``name`` is letters, digits, _ and -, once in a test; without one it is made of the test's own.
        A picture of one colour fails, unless ``allow_blank``.

        ``tolerance`` is "rounding", "edges" or "noise", levels of 255, or ``{"levels": 6, "share": 0.01}``;
        ``reason`` says why it is needed. ``mask`` is what is not compared: a rectangle (x, y, width, height)
        in pixels from the top left, the path of a PNG or an array that is light there, a texture of the
        sketch that ``shot.render`` has drawn, as "water:foam", or a list of such.

        Of an engine's last frame, what went into it is looked at too: a number that is not finite in a
        texture fails. An earlier frame of the engine is refused with ``ValueError``, as are a name
        that cannot be or is taken, a tolerance without a reason, and what is no mask.
        """
        __tracebackhide__ = True
        add_check(self._node)
        start, self._started = self._started, time.perf_counter()
        own, name = not name, name or name_of_test(self._node.nodeid)
        self._refuse_name(name, own)
        hides = MaskOfTest(mask)
        allowed = tolerance_of(tolerance, reason)
        case = self._case(Shot(name, tolerance=allowed, mask=hides.named, allow_blank=allow_blank))
        try:
            rendered, info = self._rendered(case, picture, by, tone)
        except DataError as error:
            return self._refuse_picture(case, error, start)
        rendered = replace(rendered, masks=(*hides.arrays, *self._textures(picture, hides.textures)))
        return self._hold(case, rendered, info, own, start)

    def animation(
        self,
        frames: Iterable[object],
        name: str = "",
        *,
        times: Iterable[float] = (),
        by: By | None = None,
        tone: str = "",
        tolerance: Given | None = None,
        reason: str = "",
        mask: object = None,
        allow_blank: bool = False,
    ) -> bool:
        """Compare a few frames of a film as one picture, a contact strip, each frame by itself.

        ``frames`` are two pictures or more of one size, as `check` takes them, not all the same;
        frames of an engine have to be drawn one after another, by a generator. ``times`` are
        in seconds, for the message on the first that fails; frames of ``shot.render`` have theirs.
        Otherwise as `check`; ``mask`` hides the same of each frame, and is no texture.
        """
        __tracebackhide__ = True
        add_check(self._node)
        start, self._started = self._started, time.perf_counter()
        own, name = not name, name or name_of_test(self._node.nodeid)
        self._refuse_name(name, own)
        hides = MaskOfTest(mask)
        if hides.textures:
            raise ValueError(f"mask = {hides.textures[0]!r}: a texture cannot mask an animation")
        allowed = tolerance_of(tolerance, reason)
        case = self._case(Shot(name, tolerance=allowed, mask=hides.named, allow_blank=allow_blank))
        seconds = [float(moment) for moment in times]
        taken_frames, labels, renderers = [], [], []
        for number, frame in enumerate(frames):
            try:
                rendered, info = self._rendered(case, frame, by, tone)
            except DataError as error:
                return self._refuse_picture(case, DataError(f"frame {number + 1}: {error}"), start)
            taken_frames.append(rendered)
            renderers.append(info)
            moment = frame.time if isinstance(frame, Frame) else None
            moment = seconds[number] if number < len(seconds) else moment
            labels.append("" if moment is None else f"at {moment:g} s")
        if seconds and len(seconds) != len(labels):
            raise ValueError(f"times: {len(seconds)} for {len(labels)} frames")
        try:
            strip = film_of(taken_frames, labels, hides.arrays)
        except DataError as error:
            return self._refuse_picture(case, error, start)
        if len(set(renderers)) > 1:
            raise ValueError("the frames of an animation are drawn by one renderer; these are not")
        return self._hold(case, strip, renderers[0], own, start)

    def _rendered(
        self, case: ShotCase, picture: object, by: By | None, tone: str
    ) -> tuple[RenderedShot, ContextInfo]:
        """Return a picture with all that is known of how it was drawn, and what drew it."""
        __tracebackhide__ = True
        test_picture = None if isinstance(picture, Frame) else picture_from(picture)
        info = self._renderer_of(case, picture, test_picture, by)
        drawer = by or (test_picture.context if test_picture else None)
        return _drawn_by(picture, _rendered(picture, test_picture, tone), drawer), info

    def _refuse_picture(self, case: ShotCase, error: DataError, start: float) -> bool:
        """Record for the test's end that what was given is no picture; return False."""
        self._forget_earlier(case)
        self._names[one_spelling(case.shot.name)] = case.shot.name
        self._fail(self._checker.record_missing(self._node, case, error, start))
        return False

    def _hold(
        self, case: ShotCase, rendered: RenderedShot, info: ContextInfo, own: bool, start: float
    ) -> bool:
        """Compare a picture with its reference, and record the failure for the test's end."""
        __tracebackhide__ = True
        name = case.shot.name
        self._forget_earlier(case)
        self._names[one_spelling(name)] = name
        if refusal := self._checker.claim(self._node, case, info, own):
            raise ValueError(refusal)
        self._node.user_properties.append((USED, f"{info.slug}/{name}"))
        failure = self._checker.failure(self._node, case, rendered, info, start)
        if failure:
            self._fail(failure)
        return not failure

    def _fail(self, failure: str) -> None:
        first, _, rest = failure.partition("\n")
        add_failure(self._node, f"{first}\n    checked at  {self._place()}\n{rest}".rstrip())

    def finish(self) -> None:
        """Fail for pictures that were checked after the test itself."""
        fail_for_what_is_left(self._node)

    def _place(self) -> str:
        """Return the line of the test that called this fixture, as "test_land.py:12"."""
        frame = sys._getframe(1)
        while frame.f_back is not None and frame.f_code.co_filename.startswith(_HERE):
            frame = frame.f_back
        return f"{shown(frame.f_code.co_filename)}:{frame.f_lineno}"

    def _textures(self, picture: object, names: tuple[str, ...]) -> tuple[Light, ...]:
        """Return the textures that hide parts of a frame that `render` gave."""
        __tracebackhide__ = True
        if not names:
            return ()
        if id(picture) not in self._drawn:
            raise ValueError(f"mask = {names[0]!r}: only a frame of shot.render has textures of its sketch")
        case = self._drawn[id(picture)][2]
        masked = ShotCase(case.sketch, replace(case.shot, mask=names))
        try:
            return self._checker.renderer_process.render(masked).masks
        except PlaygroundError as error:
            mistake = error
        # Without the frames it came through, which say nothing of the test's own mistake.
        raise type(mistake)(f"mask: {mistake}")

    def _find(self, sketch: str | Path) -> Path:
        """Return where a sketch is: in the test file's folder, or where a command would find it."""
        neighbour = self._node.path.parent / Path(sketch).expanduser()
        return find(neighbour if neighbour.exists() else sketch)

    def _refuse_name(self, name: str, own: bool) -> None:
        __tracebackhide__ = True
        if why := why_no_name(name):
            raise ValueError(f"name = {name!r}: {why}")
        before = self._names.get(one_spelling(name))
        if before is not None:
            if own:
                raise ValueError("a second picture without a name in this test: give each one of its own")
            same = "" if before == name else f" (the same file as {before!r} on macOS and Windows)"
            raise ValueError(
                f"a second picture named {name!r} in this test{same}: each needs a name of its own"
            )

    def _case(self, shot: Shot) -> ShotCase:
        """Return what a picture is checked as: a shot of the test file."""
        # References only need a sketch's name and its place.
        file = self._node.path
        return ShotCase(Sketch(file.name, str(file), str(file.parent), Graph(file.name, str(file), ())), shot)

    def _forget_earlier(self, case: ShotCase) -> None:
        """Remove, once, the records that this test has left in earlier runs."""
        if not self._is_cleared:
            self._is_cleared = True
            self._checker.recorder.forget_earlier(self._node, case)

    def _renderer_of(
        self, case: ShotCase, picture: object, test_picture: PictureFromTest | None, by: By | None
    ) -> ContextInfo:
        __tracebackhide__ = True
        tool = test_picture and test_picture.tool
        if isinstance(by, str):  # a folder that is named is used with any OpenGL
            named = ContextInfo(0, by, "", tool.version if tool else "", 0)
            if not by or named.slug != by:
                raise ValueError(f"by = {by!r}: a folder's name is lower-case letters, digits and -")
            return named
        if by is None and tool:
            return tool
        if by is None and test_picture and test_picture.context:
            by = test_picture.context
        if by is None:
            if id(picture) not in self._drawn:
                raise TypeError(
                    "what drew this picture is not known: say by=engine, by=context (moderngl's), "
                    "or by='a name' for the folder of its references"
                )
            return self._drawn[id(picture)][1]
        if isinstance(by, ContextInfo):
            return self._checker.expect(self._node, case, by)
        info = by.info if isinstance(by, Engine) else context_info(by)
        return self._checker.expect(self._node, case, info)


def _drawn_by(picture: object, rendered: RenderedShot, by: By | None) -> RenderedShot:
    """Return a picture with what is known of how it was drawn."""
    if by is None:  # drawn by the renderer process, which has looked, or not by OpenGL
        return rendered
    rendered = replace(rendered, gl_error=_error_left(by))
    if not isinstance(by, Engine):
        return rendered
    last = _last_picture(by)
    if last is not None and np.array_equal(last, rendered.array):
        return replace(rendered, not_finite=str(by.not_finite() or ""), drawn=by.drawn())
    if isinstance(picture, Frame):
        raise ValueError(
            "this is not the last frame of its engine, so what went into it cannot be looked at any more: "
            "check each frame before the engine draws the next one or is released"
        )
    return rendered


def _last_picture(engine: Engine) -> NDArray[np.uint8] | None:
    """Return the picture that an engine drew last; None where it has none."""
    if engine.record.plan is None:
        return None
    view = next(iter(engine.record.plan.flat.outputs["view"].values()))
    result = engine.record.results.get(view.path)
    if result is None:
        return None
    with engine.borrowed():
        return read_picture(result.textures[view.output])


def _error_left(by: By) -> str:
    """Return the OpenGL error that drawing has left behind; "" for none."""
    if isinstance(by, str | ContextInfo):
        return ""
    error = (by.ctx if isinstance(by, Engine) else by).error
    return "" if error == "GL_NO_ERROR" else error


def _rendered(picture: object, test_picture: PictureFromTest | None, tone: str) -> RenderedShot:
    """Return a picture as the renderer process gives it, with what is wrong with its numbers."""
    if test_picture is None:
        assert isinstance(picture, Frame)
        if tone:
            raise DataError(f"tone = {tone!r} is for floats; a frame is of uint8")
        if isinstance(picture, RenderedShot):
            return picture
        return RenderedShot(picture.array, picture.sketch, picture.time)
    pixels, wrong = levels_of(test_picture.values, tone)
    return RenderedShot(pixels, not_finite=wrong, fonts=test_picture.fonts, tone=tone)
