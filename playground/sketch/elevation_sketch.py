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

_TEXT = Path(__file__).with_suffix(".toml")


def elevation_text(path: Path, file: str) -> str:
    """Return the TOML of a sketch around an elevation file, which it names ``file``."""
    name = re.sub(r"[^ -~]|`", "_", path.name)
    words = {
        "@TITLE@": name,
        "@NAME@": name,
        '"@TITLE_TEXT@"': text_of(path.stem),
        '"@FILE@"': text_of(file),
    }
    return re.sub("|".join(words), lambda found: words[found[0]], _TEXT.read_text(encoding="utf-8"))


def elevation_sketch(path: Path, techniques: Techniques) -> Sketch:
    """Return the sketch around an elevation file; the file itself is not read yet."""
    sketch = read_sketch(TomlFile(path, path.parent, elevation_text(path, path.name)), techniques.read)
    # No line of the file itself says any of it.
    return replace(sketch, graph=replace(sketch.graph, passes=_without_lines(sketch.graph.passes)))


def _without_lines(passes: Sequence[PassSpec]) -> tuple[PassSpec, ...]:
    return tuple(replace(spec, line=0) for spec in passes)
