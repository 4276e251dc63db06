"""The sketch around an elevation file that is opened alone: its terrain, coloured, lit and framed.

It is a text, so that it can be saved as it is and edited. What the file tells, the sketch leaves to it: the
extent, the relief, the height above the sea.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from playground.sketch.model import PassSpec, Sketch
from playground.sketch.techniques import Techniques
from playground.sketch.toml_edit import text_of
from playground.sketch.toml_sketch import read_sketch
from playground.sketch.toml_table import TomlFile

SIDE = 1025
"""Texels of the terrain's longer side."""

_TEXT = """\
# @TITLE@, as `playground live @NAME@` opens it.
format = 1
title  = @TITLE_TEXT@
main   = ["height.longest", "light.sun", "weights.rock_slope", "weights.snow_from", "view.sea_level"]

# Extent, relief and the height above the sea are the file's. More texels are finer, and slower.
[[pass]]
name = "height"
use  = "generation/heightmap"
set  = { elevation = @FILE@, longest = @SIDE@, no_data = "fill" }

# Rock where it is steep; snow_from is a share of the relief: below 1 the highest places are white.
[[pass]]
name = "weights"
use  = "texturing/alpha_map"
set  = { rock_slope = 30, rock_fade = 12, snow_from = 1.2, snow_fade = 0.1, path = 0 }

[[pass]]
name = "grass"
use  = "texturing/grass"
size = 256
set  = { tint = "#66732f" }

[[pass]]
name = "rock"
use  = "texturing/rock"
size = 256
set  = { tint = "#827a6f" }

[[pass]]
name = "snow"
use  = "texturing/snow"
size = 256

[[pass]]
name = "path"
use  = "texturing/path"
size = 256

[[pass]]
name = "colour"
use  = "texturing/splat"

[[pass]]
name = "light"
use  = "lighting/ray_cast"
set  = { sun = { azimuth = 300.0, elevation = 32.0 }, ambient = 0.2 }

# The sea is drawn where the terrain lies below its level: a metre, since many files have it at 0.
[view]
use    = "view/terrain"
camera = { azimuth = 195.0, elevation = 30.0, field_of_view = 30.0 }

[view.set]
sea       = true
sea_level = 1
clarity   = 1.5
tone      = "film"
exposure  = 0.2
haze      = 0.03
horizon   = "#b4c8da"
zenith    = "#2f62a3"
nadir     = "#6f8397"
"""


def elevation_text(path: Path, file: str) -> str:
    """Return the TOML of a sketch around an elevation file, which it names ``file``."""
    name = re.sub(r"[^ -~]|`", "_", path.name)
    words = {
        "@TITLE@": name,
        "@NAME@": name,
        "@TITLE_TEXT@": text_of(path.stem),
        "@FILE@": text_of(file),
        "@SIDE@": str(SIDE),
    }
    return re.sub("|".join(words), lambda found: words[found[0]], _TEXT)


def elevation_sketch(path: Path, techniques: Techniques) -> Sketch:
    """Return the sketch around an elevation file; the file itself is not read yet."""
    sketch = read_sketch(TomlFile(path, path.parent, elevation_text(path, path.name)), techniques.read)
    # No line of the file itself says any of it.
    return replace(sketch, graph=replace(sketch.graph, passes=_without_lines(sketch.graph.passes)))


def _without_lines(passes: Sequence[PassSpec]) -> tuple[PassSpec, ...]:
    return tuple(replace(spec, line=0) for spec in passes)
