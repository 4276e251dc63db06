"""Look for numbers that are not finite while the picture rests, and say over it which pass made the first.

A pass is looked at in each turn of the window, so that none of them takes long; nothing is
looked at while a button is held or until the picture has rested for a moment. A picture
that goes on changing with time is looked at now and then: that takes one part in fifty of
the time at most.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

from imgui_bundle import ImVec2, imgui

from playground.engine.finite import NotFinite
from playground.errors import PlaygroundError, counted
from playground.live import theme
from playground.live.actions import Actions
from playground.live.theme import Theme

REST = 0.4  # [s] without a new picture before one is looked at
_SELDOM = 2.0  # [s] between looks at a picture that moves
_SHARE = 50  # the part of the time that they may take
_MAGENTA = (1.0, 0.42, 1.0)  # readable on dark ground; the texels themselves are as the map has them
_RING = 14.0  # [units of scale 1] radius of the mark around the first texel

Area = tuple[float, float, float, float]  # x, y from above, width, height, in the window's units


class FiniteWatch:
    """What was found in the picture, and the look that is under way."""

    def __init__(self, now: Callable[[], float] = time.perf_counter) -> None:
        self.found: tuple[NotFinite, ...] = ()  # of each pass that makes such numbers, in the order they ran
        self.looks = 0  # passes looked at so far
        self._now = now
        self._picture: tuple[object, int] = (None, -1)  # the engine, and how many pictures it had drawn
        self._since = 0.0  # when that picture was first seen
        self._going: Iterator[NotFinite | None] | None = None
        self._done = True
        self._coming: list[NotFinite] = []
        self._of: object = None  # the sketch that the last whole look was of
        self._spent = 0.0  # [s] of this look
        self._next = 0.0  # when a picture that moves may be looked at again

    @property
    def patience(self) -> float | None:
        """How long nothing needs to be done [s]; None where nothing is waited for."""
        if self._done:
            return None
        return 0.0 if self._going is not None else REST / 2

    def turn(self, actions: Actions, held: bool) -> None:
        """Look at one pass more, if it is time to; ``held``: a mouse button is down."""
        session, now = actions.session, self._now()
        if session.shown is None or session.plan is None:
            return
        picture = (session.engine, session.draws)
        moving = session.animated and session.clock.playing
        if picture != self._picture:
            if not moving or self._picture[0] is not session.engine:
                self._going = None
            self._picture, self._done = picture, False
            self._since = now
        if self._done or held or session.hasty or session.testing:
            return
        if now < self._next if moving else self._going is None and now - self._since < REST:
            return
        try:
            self._look(actions, to_the_end=moving)
        except PlaygroundError:  # whoever draws the sketch says so
            self._going, self._done = None, True

    def _look(self, actions: Actions, to_the_end: bool) -> None:
        session, start = actions.session, self._now()
        engine = session.engine
        assert session.plan is not None
        if self._going is None:
            if engine.plan is not session.plan:  # a texture was read since
                engine.recall(session.plan)
            self._going, self._coming, self._spent = engine.not_finite_by_pass(), [], 0.0
        for found in self._going:
            self.looks += 1
            if found is not None:
                self._coming.append(found)
            if not to_the_end:
                self._spent += self._now() - start
                return
        self._going, self._done = None, True
        if engine.plan is session.plan:
            self._take(actions)
        self._next = self._now() + max(_SELDOM, _SHARE * (self._spent + self._now() - start))

    def _take(self, actions: Actions) -> None:
        """Take what was found; of passes that a map does not need, what was found before stays."""
        session = actions.session
        assert session.plan is not None
        kept: list[NotFinite] = []
        if session.map is not None and self._of is session.sketch:
            ran = (step.path for step in session.plan.walk() if step.path in session.engine.results)
            there = {session.map.own_path(path) for path in ran}
            kept = [f for f in self.found if f.path not in there]
        self._of = session.sketch
        coming = self._coming
        if session.map is not None:
            found = [(f, session.map.own_path(f.path)) for f in coming]
            coming = [replace(f, path=path) for f, path in found if path]
        self.found = (*coming, *kept)


def said(found: tuple[NotFinite, ...]) -> str:
    """Return what was found as a sentence: the first, and of how many."""
    first = found[0]
    x, y = first.texel
    output = f", output '{first.output}'," if first.output != first.path.rpartition(".")[2] else ""
    text = f"pass '{first.path}'{output} makes {first.value} at texel ({x}, {y})"
    text += f", {counted(first.count, 'texel')}"
    return f"{text}; first of {len(found)} passes" if len(found) > 1 else text


def ref_of(first: NotFinite) -> str:
    """Return the texture that it is in, as a map takes it."""
    return f"{first.path}:{first.output}"


def place_in(first: NotFinite, area: Area) -> tuple[float, float]:
    """Return where a map over an area shows the first texel, in the window's units, y from above."""
    x, y, wide, high = area
    across, up = first.size
    worst = max(across / wide, up / high)
    east = (first.texel[0] + 0.5 - across / 2) / worst + wide / 2
    north = (first.texel[1] + 0.5 - up / 2) / worst + high / 2
    return x + east, y + high - north


def draw_not_finite(watch: FiniteWatch, actions: Actions, look: Theme, area: Area) -> None:
    """Draw the sentence in the picture's upper left corner; a click goes to the texture and back."""
    if not watch.found:
        return
    session, first = actions.session, watch.found[0]
    ref = ref_of(first)
    shows = session.map is not None and session.map.ref == ref
    if shows:
        centre = ImVec2(*place_in(first, area))
        draw = imgui.get_background_draw_list()
        draw.add_circle(centre, _RING * look.scale, theme.packed((0, 0, 0), 0.8), 0, 4 * look.scale)
        draw.add_circle(centre, _RING * look.scale, theme.packed(_MAGENTA), 0, 2 * look.scale)
    margin = 14 * look.scale
    imgui.set_next_window_pos(ImVec2(area[0] + margin, area[1] + margin))
    widest = max(min(area[2] - 2 * margin, 460 * look.scale), 80.0)
    imgui.set_next_window_size_constraints(ImVec2(0, 0), ImVec2(widest, area[3]))
    imgui.push_style_var(imgui.StyleVar_.window_rounding, 6 * look.scale)
    imgui.push_style_color(imgui.Col_.window_bg, theme.colour(theme.GROUND, 0.92))
    flags = imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_nav_inputs
    flags |= imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_saved_settings
    flags |= imgui.WindowFlags_.no_focus_on_appearing
    imgui.begin("not finite", None, flags)
    imgui.push_text_wrap_pos(widest - 2 * imgui.get_style().window_padding.x)
    imgui.text_colored(theme.colour(_MAGENTA), said(watch.found))
    imgui.pop_text_wrap_pos()
    if len(watch.found) > 1:
        imgui.set_item_tooltip("\n".join(map(str, watch.found)))
    else:
        imgui.set_item_tooltip(str(first))
    if shows:
        if imgui.small_button("Back to the picture"):
            actions.show(None)
    elif session.can_show(ref):
        if imgui.small_button("Show it"):
            actions.show(ref)
        imgui.set_item_tooltip("That texture from above, those texels in magenta")
    imgui.end()
    imgui.pop_style_color()
    imgui.pop_style_var()
