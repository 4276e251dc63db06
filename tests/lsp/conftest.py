"""An editor with one server for all tests of a file, and a folder of a kernel, its library and its sketch."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from .client import Editor

LIBRARY = """// shade.glsl -- how a value is shaded.
#ifndef SHADE
#define SHADE

// The share of a value that is left after a loss.
float kept_of(float value, float loss) {
    return value * (1.0 - loss);
}
#endif
"""
KERNEL = """// hill.glsl -- one hill, as high as its size.
#include "shade.glsl"
#pragma kernel(output = "height:r32f", repeat = "rounds")

uniform int rounds = 1;                      //! slider(1, 8) How often
uniform vec3 tint = vec3(0.2, 0.5, 1.0);     //! colour Tint of the hill
uniform int shape = 0;                       //! menu("round", "sharp") Form of the hill
uniform vec2 sun = vec2(135.0, 30.0);        //! direction Where the light is

float kernel(ivec2 texel) {
    float far = length(vec2(texel) / vec2(size) - 0.5);
    return kept_of(tint.x * towards_sun.z, far) + float(shape + iteration);
}
"""
SKETCH = """format = 1
size = 33
extent = 320.0
relief = 100.0
main = ["height.rounds"]

[[pass]]
name = "height"
use = "./hill"
set = { rounds = 2, tint = "#336699" }

[[preset]]
name = "sharp"
set = { "height.shape" = "sharp", "height.rounds" = 3 }

[[shot]]
name = "sharp"
preset = "sharp"
size = [64, 36]
"""


def written(folder: Path) -> Path:
    """Return a folder of three files."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in (("shade.glsl", LIBRARY), ("hill.glsl", KERNEL), ("sketch.toml", SKETCH)):
        (folder / name).write_text(text, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def editor(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Editor]:
    folder = tmp_path_factory.mktemp("lsp")
    with Editor(written(folder / "work"), XDG_STATE_HOME=str(folder / "state")) as result:
        yield result


@pytest.fixture
def folder(editor: Editor) -> Iterator[Path]:
    """The editor's folder, its files as they were; what a test opened is closed again."""
    yield editor.folder
    for uri in list(editor.versions):
        editor.close(uri)
        del editor.versions[uri]
    written(editor.folder)


@pytest.fixture
def hill(editor: Editor, folder: Path) -> str:
    """Open the kernel, and give its URI."""
    uri = (folder / "hill.glsl").as_uri()
    editor.open(uri, KERNEL)
    return uri


@pytest.fixture
def sketch(editor: Editor, folder: Path) -> str:
    """Open the sketch, and give its URI."""
    uri = (folder / "sketch.toml").as_uri()
    editor.open(uri, SKETCH, "toml")
    return uri
