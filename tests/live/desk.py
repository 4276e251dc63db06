"""A panel without a window: imgui with no screen, and a mouse and keys that a test moves."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import imgui_bundle
from imgui_bundle import ImVec2, imgui

from playground.engine.engine import Engine
from playground.live.actions import Actions
from playground.live.keys import act_on_keys
from playground.live.panel import Panel
from playground.live.session import Session
from playground.live.theme import Theme

KEYS = {"/": imgui.Key.slash, "Enter": imgui.Key.enter, "Esc": imgui.Key.escape}


class Bare:
    """A panel on a session, turn by turn, at 60 turns a second."""

    def __init__(
        self, engine: Engine, path: Path, size: tuple[int, int] = (1280, 720), scale: float = 1.0
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
        self.actions = Actions(self.session, lambda: None, path, now=lambda: self.time)
        self.panel = Panel()
        self.clipboard = ""
        imgui.get_platform_io().platform_set_clipboard_text_fn = self._copied
        self.turn(3)

    def _copied(self, _: object, text: str) -> None:
        self.clipboard = text

    def turn(self, count: int = 1, around: Callable[[Callable[[], object]], object] | None = None) -> None:
        """Let turns pass; ``around`` is given the drawing of the panel, to measure it."""
        for _ in range(count):
            self.time += 1 / 60
            imgui.get_io().delta_time = 1 / 60
            self.session.frame((48, 32))
            imgui.new_frame()
            if around is None:
                self.draw()
            else:
                around(self.draw)
            act_on_keys(self.actions)
            self.actions.look_back(imgui.is_mouse_down(0) or imgui.is_mouse_down(1))
            self.actions.take_notes()
            imgui.render()
            for texture in imgui.get_platform_io().textures:
                texture.set_status(imgui.ImTextureStatus.ok)

    def draw(self) -> None:
        """Draw the panel."""
        self.panel.draw(self.actions, self.theme)

    def close(self) -> None:
        """End it; the engine is its owner's."""
        self.session.release()
        imgui.destroy_context(self.context)
