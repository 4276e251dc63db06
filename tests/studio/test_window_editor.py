"""A window and an editor beside it: what the window traces stands behind the lines in the editor."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.engine.trace.live_texel import live_file, read_live_texel
from playground.paths import NAME

from ..lsp.client import Editor
from ..lsp.test_traced import hints_when
from .screen import ON_LINUX, Screen
from .test_window_trace import FREE, TERRAIN, Traced, texel_at
from .test_window_trace import SCREEN as SCREEN

pytestmark = [*ON_LINUX, pytest.mark.slow]


def test_an_editor_shows_the_texel_of_the_window(screen: Screen, tmp_path: Path) -> None:
    window = Traced(screen, tmp_path)
    try:
        screen.do("mousemove", *FREE, "key", "m")
        window.wait(lambda now: now["map"])
        screen.do("key", "t")
        texel = window.traced(lambda trace: trace["exact"])["texel"]
        assert texel == texel_at(*FREE)
        state = tmp_path / "state"
        window.wait(lambda now: live_file(state / NAME).exists())
        live = read_live_texel(live_file(state / NAME))
        assert live is not None and [*live.texel] == texel and live.path == "height"
        uri = (window.folder / "terrain.glsl").as_uri()
        with Editor(window.folder, XDG_STATE_HOME=str(state)) as editor:
            editor.open(uri, TERRAIN)
            head = f"texel = ({texel[0]}, {texel[1]})"
            hints_when(editor, uri, lambda hints: hints.get(7) == head)
            screen.do("mousemove", FREE[0] - 100, FREE[1])
            moved = window.traced(lambda trace: trace["texel"] != texel)["texel"]
            hints_when(editor, uri, lambda hints: hints.get(7) == f"texel = ({moved[0]}, {moved[1]})")
            screen.do("key", "Escape")
            hints_when(editor, uri, lambda hints: not hints)
    finally:
        window.close()
    assert not live_file(state / NAME).exists()
