"""What the tests of sketches share: a folder that is written by a few words."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest

from playground.errors import PlaygroundError
from playground.sketch.load import load
from playground.sketch.model import Sketch

TERRAIN = """\
// terrain.glsl -- a slope.
#pragma kernel(output = "height:r32f")
uniform float rise = 0.5;  //! slider(0, 2) How steep
float kernel(ivec2 texel) { return rise * float(texel.x); }
"""
VIEW = """\
#pragma kernel(output = "frame:rgba8")
uniform sampler2D height;  //! input
vec4 kernel(ivec2 texel) { return vec4(texelFetch(height, texel, 0).r); }
"""
PASS = '[[pass]]\nname = "height"\nuse = "./terrain"\n'
TAIL = '[view]\nuse = "./look"\n'


class Folder:
    """A sketch's folder, with ``terrain.glsl`` and a view ``look.glsl`` in it."""

    def __init__(self, path: Path) -> None:
        self.path = path
        path.mkdir(exist_ok=True)
        self.write("terrain.glsl", TERRAIN)
        self.write("look.glsl", VIEW)

    def write(self, name: str, text: str) -> Path:
        target = self.path / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(textwrap.dedent(text), encoding="utf-8")
        return target

    def sketch(self, body: str = PASS, tail: str = TAIL, head: str = "format = 1\n") -> Sketch:
        return load(self.write("s.toml", head + textwrap.dedent(body) + textwrap.dedent(tail)))

    def refused(
        self, words: str, line: int | None = None, file: str = "s.toml", **parts: str
    ) -> PlaygroundError:
        """Load a sketch that is wrong; see that the error has these words and this line."""
        with pytest.raises(PlaygroundError) as caught:
            self.sketch(**parts)
        diagnostic = caught.value.diagnostics[0]
        assert words in diagnostic.message, diagnostic
        assert "\n" not in diagnostic.message
        assert Path(diagnostic.file).name == file
        if line is not None:
            assert diagnostic.line == line, diagnostic
        return caught.value


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    return Folder(tmp_path / "mine")
