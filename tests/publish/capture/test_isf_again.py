"""What leaves as an ISF shader comes back by our own reader: the same picture, the same widgets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.publish.export import export

from ...loading import load

pytestmark = pytest.mark.room("dialects")

KERNEL = """#pragma kernel(output = "height:r32f")
uniform int mode = 9;                 //! menu("soft", "hard", "none") values(-3, 9, 40)
uniform vec2 place = vec2(0.0, 3.0);  //! point(-1, 1, 2, 4)
uniform vec4 tint = vec4(0.25, 0.5, 1.0, 1.0);  //! colour("raw")
uniform vec3 lit = vec3(0.25, 0.5, 1.0);        //! colour
uniform bool go;                      //! button
uniform float level = 0.5;            //! slider(0, 2)
float kernel(ivec2 texel) {
    float east = float(texel.x) / float(size.x);
    float found = float(mode) / 80.0 + east * level * tint.g * lit.r + place.y * 0.05;
    return go ? 1.0 - found : found;
}
"""
SKETCH = """format = 1
size = [32, 18]
[[pass]]
name = "height"
use = "./k"
[view]
use = "view/map"
inputs = { shown = "height" }
set = { lowest = 0.0, highest = 1.0 }
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "k.glsl").write_text(KERNEL)
    (tmp_path / "s.toml").write_text(SKETCH)
    return tmp_path / "s.toml"


CHANGES = [{}, {"mode": "soft"}, {"mode": "none"}, {"place": (0.5, 4.0)}, {"tint": (0.1, 0.9, 0.1, 1.0)},
           {"lit": "#c08040"}, {"go": True}, {"level": 1.75}]  # fmt: skip


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_widgets_do_the_same_there(any_engine: Engine, path: Path, changes: dict[str, object]) -> None:
    out = path.with_name("out.fs")
    export(path, out, texture="height", engine=any_engine)
    again = load(out)
    names = {p.name.removeprefix("height_"): p for p in again.graph.find("view").technique.parameters}  # type: ignore[union-attr]
    values = {f"view.{names[name].name}": value for name, value in changes.items()}
    sketch = load(path).with_values({f"height.{name}": value for name, value in changes.items()})
    expected = np.clip(any_engine.read(sketch, "height"), 0.0, 1.0)
    array = any_engine.render(again.with_values(values), size=(32, 18)).array[::-1, :, 0]
    np.testing.assert_allclose(array / 255.0, expected, atol=1.5 / 255.0)
    kinds = {name: p.widget.kind for name, p in names.items()}
    assert {
        "mode": "menu",
        "place": "point",
        "tint": "colour",
        "lit": "colour",
        "go": "button",
    }.items() <= kinds.items()
    assert names["mode"].widget.values == (-3, 9, 40)
    assert names["place"].widget.axes == ((-1.0, 1.0), (2.0, 4.0))
