"""NaN as a person meets it: the message over the picture leads to the texture, and goes once it is fixed."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from ..sketch_texts import map_of_height
from .screen import ON_LINUX, Program, Screen, script

WIDTH, HEIGHT = 800, 500
SHOW_IT = 386, 52  # the button, at scale 1
RUN = script((800, 500))
TERRAIN = """// terrain.glsl -- hills with a hole
#pragma kernel(output = "height:r32f")
uniform float root = -1.0; //! slider(-1, 1)
float kernel(ivec2 texel) { return texel / 4 == ivec2(3, 5) ? sqrt(root) : 0.5; }
"""
SKETCH = "format = 1\nsize = 33\n" + map_of_height()

pytestmark = [*ON_LINUX, pytest.mark.slow]


SCREEN = WIDTH, HEIGHT  # [pixels]


def test_the_words_lead_to_the_texels_in_magenta(screen: Screen, tmp_path: Path) -> None:
    (tmp_path / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    program = Program(screen, tmp_path, [sys.executable, "-c", RUN, str(tmp_path)], tmp_path)
    try:
        result = program.wait(lambda now: now["not_finite"])["not_finite"]
        assert "pass 'height', output 'height': NaN at texel (12, 20)" in result[0]
        screen.do("mousemove", *SHOW_IT, "sleep", 1, "click", 1)
        program.wait(lambda now: now["map"] == "height:height")
        pixels = screen.pixels()[:, 340:]
        magenta = (pixels == np.array([255, 0, 255])).all(axis=2).sum()
        assert magenta > 1000, "sixteen texels of a map of 33, on half a thousand pixels"
        (tmp_path / "terrain.glsl").write_text(TERRAIN.replace("= -1.0", "= 1.0"), encoding="utf-8")
        program.wait(lambda now: not now["not_finite"])
    finally:
        program.close()
