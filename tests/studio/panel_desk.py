"""A panel without a window: imgui with no screen, and a mouse and keys that a test moves."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import imgui_bundle
from imgui_bundle import ImVec2, imgui

from playground.engine.engine import Engine
from playground.studio import focus
from playground.studio.bench import Workbench
from playground.studio.code.panel import draw_code, draw_questions
from playground.studio.code.unsaved_texts import KeptTexts
from playground.studio.cursor import draw_cursor, feed
from playground.studio.drops import Drops
from playground.studio.interface import Preferences, WindowControls
from playground.studio.keymap_panel import draw_keymap
from playground.studio.keys import act_on_keys
from playground.studio.mouse import PictureMouse
from playground.studio.overlay import draw_drops, draw_inspection
from playground.studio.panel.panel import Panel
from playground.studio.panes import PaneLayout, draw_pane
from playground.studio.problems.panel import ErrorsList
from playground.studio.session import Session
from playground.studio.theme import Theme

from .watched import WIDGETS


class Bare:
    """A panel on a session, frame by frame, at 60 frames a second."""

    def __init__(
        self,
        engine: Engine,
        path: Path,
        size: tuple[int, int] = (1280, 720),
        scale: float = 1.0,
        kept: KeptTexts | None = None,
    ) -> None:
        self.context = imgui.create_context()
        io = imgui.get_io()
        io.set_ini_filename("")
        io.display_size = ImVec2(*size)
        io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
        io.config_input_trickle_event_queue = False
        self.theme = Theme(Path(imgui_bundle.__file__).parent / "assets" / "fonts")
        self.theme.rescale(scale)
        self.time = 0.0
        self.session = Session(engine, path)
        self.bench = Workbench(
            self.session,
            WindowControls(self._quit),
            folder=path,
            now=lambda: self.time,
            preferences=Preferences(panes={"terrain": 0.0}),  # folded, so that there is room for what follows
            kept=kept,
        )
        self.drops = Drops(self.bench.actions)
        self.panel = Panel()
        self.panes = PaneLayout(self.bench.panes)
        self.places: dict[str, tuple[float, float, float, float]] = {}  # by label: x, y, width, height
        self.labels: dict[int, str] = {}  # by imgui's number
        self._watched: list[tuple[object, str, object]] = []
        for name in WIDGETS:
            self.watch(imgui, name)
        self.clipboard = ""
        self.mouse_at = 0.0, 0.0  # that the window reports
        self.frame_size = 48, 32
        imgui.get_platform_io().platform_set_clipboard_text_fn = self._copied
        self.quits = False
        self.run_frames(3)

    def _quit(self) -> None:
        self.quits = True

    def watch(self, owner: object, name: str) -> None:
        """Remember where everything is drawn, by its label."""
        draw = getattr(owner, name)
        self._watched.append((owner, name, draw))
        setattr(owner, name, self._watched_form(draw))

    def _watched_form(self, draw: Callable[..., Any]) -> Callable[..., Any]:
        def watched(label: str, *rest: object) -> object:
            answer = draw(label, *rest)
            low, size = imgui.get_item_rect_min(), imgui.get_item_rect_size()
            self.places[label] = low.x, low.y, size.x, size.y
            self.labels[imgui.get_item_id()] = label
            return answer

        return watched

    def _copied(self, _: object, text: str) -> None:
        self.clipboard = text

    def run_frames(
        self,
        count: int = 1,
        around: Callable[[Callable[[], object]], object] | None = None,
        step: float = 1 / 60,
    ) -> None:
        """Draw frames, one every ``step`` [s]; ``around`` receives what draws the panel, to measure it."""
        for _ in range(count):
            self.time += step
            imgui.get_io().delta_time = step
            self.picture = self.session.frame(self.frame_size)
            feed(self.bench.interface.cursor, self.mouse_at)
            imgui.new_frame()
            focus.begin(self.bench.interface.focus)
            if around is None:
                self.draw()
            else:
                around(self.draw)
            self.act()
            self.bench.record(held=imgui.is_mouse_down(0) or imgui.is_mouse_down(1))
            self.bench.take_notes()
            imgui.render()
            for texture in imgui.get_platform_io().textures:
                texture.set_status(imgui.ImTextureStatus.ok)

    def point(self, label: str, across: float = 0.5) -> None:
        """Move the mouse over what has a label, to a fraction of its width."""
        self.run_frames()
        x, y, wide, high = self.places[label]
        imgui.get_io().add_mouse_pos_event(x + across * wide, y + high / 2)
        self.run_frames()

    def press(self, down: bool, button: int = 0) -> None:
        """Press a button of the mouse, or let it go."""
        imgui.get_io().add_mouse_button_event(button, down)
        self.run_frames()

    def click(self, label: str, across: float = 0.5, *, times: int = 1, button: int = 0) -> None:
        """Click on what has a label."""
        self.point(label, across)
        for _ in range(times):
            self.press(True, button)
            self.press(False, button)
        self.places.clear()
        if times > 1:
            self.run_frames(2)
        else:
            self.run_frames(4, step=0.11)  # the next click is no double one

    def drag(self, label: str, start: float, end: float) -> None:
        """Drag from one share of a widget's width to another."""
        self.point(label, start)
        self.press(True)
        for n in range(1, 6):
            x, y, wide, high = self.places[label]
            share = start + (end - start) * n / 5
            imgui.get_io().add_mouse_pos_event(x + share * wide, y + high / 2)
            self.run_frames()
        self.press(False)
        self.run_frames(4, step=0.25)

    def key(self, *keys: imgui.Key) -> None:
        """Press keys together, and let them go."""
        for down in (True, False):
            for key in keys if down else reversed(keys):
                imgui.get_io().add_key_event(key, down)
            self.run_frames(2)

    def type(self, text: str) -> None:
        """Type a text over what is selected."""
        for letter in text:
            imgui.get_io().add_input_character(ord(letter))
            self.run_frames()

    def draw(self) -> None:
        """Draw the panel, and what is over the window."""
        self.bench.inspection.begin()
        left = self.panel.draw(self.bench, self.theme)
        room = imgui.get_io().display_size
        area = left, 0.0, max(room.x - left, 1.0), room.y
        if self.bench.tabs:
            places = self.panes.place(left, self.bench.tabs, self.theme)
            self.panes.draw_strip(places, self.bench.tabs, self.theme)
            area = places.picture
        self.area = area
        draw_inspection(self.bench, self.picture, self.theme, area, self.frame_size[0] / area[2])
        draw_cursor(self.bench.interface.cursor, self.session, self.theme, area)
        draw_drops(self.drops, self.theme)
        draw_keymap(self.bench.interface, self.theme)

    def act(self) -> None:
        """Act on the keys."""
        act_on_keys(self.bench)

    def draw_pane(self, area: tuple[float, float, float, float] = (780.0, 0.0, 500.0, 720.0)) -> None:
        """Draw the code pane at a place, and the question on a file that is to be closed."""
        files, problems = self.bench.files, self.bench.problems
        draw_pane("code pane", area, lambda: draw_code(files, problems, self.theme, self.bench.tracing))
        draw_questions(files)

    def close(self) -> None:
        """End it; the engine is its owner's."""
        for owner, name, draw in self._watched:
            setattr(owner, name, draw)
        self.bench.inspection.release()
        self.session.release()
        imgui.destroy_context(self.context)


class PictureDesk(Bare):
    """A panel beside a picture as large as its place, and what reads the mouse over it."""

    def __init__(self, engine: Engine, path: Path) -> None:
        super().__init__(engine, path, (740, 300))
        self.hand = PictureMouse(self.bench)
        self.frame_size = int(self.area[2]), int(self.area[3])
        self.run_frames(3)

    def act(self) -> None:
        """Act on the keys, then on the mouse over the picture."""
        super().act()
        if self.frame_size[0] == self.area[2]:
            self.hand.act(self.area, 1.0)
            self.bench.tracing.update(self.picture)


OpenBare = Callable[..., Bare]


def errors_of(bench: Workbench) -> ErrorsList:
    """Return the list of errors of one frame."""
    return ErrorsList(bench.problems, bench.files, bench.session, bench.interface)
