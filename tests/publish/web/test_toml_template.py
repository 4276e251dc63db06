"""A page writes into a TOML text as Python would: however the file writes its tables."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from playground.paths import GLSL
from playground.publish.web.page_data import page_data
from playground.publish.web.toml_template import sketch_pieces
from playground.shader.parameter import shortest
from playground.sketch.assign import values_of
from playground.sketch.model import Camera

from ...loading import load
from .node import Node

PASS = '[[pass]]\nname = "height"\nuse = "generation/diamond_square"\n'
VIEW = '[view]\nuse = "view/terrain"\n'
STYLES = {
    "without anything": f"format = 1\n{PASS}",
    "without an end of line": f"format = 1\n{PASS}".rstrip("\n"),
    "in braces": f"""format = 1
size = 129
{PASS}set = {{ smoothing = 0.5 }} # rough
{VIEW}camera = {{ azimuth = 10 }}
""",
    "in empty braces": f"format = 1\n{PASS}set = {{}}\n{VIEW}camera = {{}}\nset = {{}}\n",
    "under headers": f"""format = 1
{PASS}  [pass.set] # values
  smoothing = 0.5

{VIEW}[view.camera]
elevation = 20
[view.set]
""",
    "by dotted keys": f"""format = 1
{PASS}set.smoothing = 0.5
set."raw.seed" = 4
{VIEW}camera.azimuth = 3
""",
    "the view first": f"format = 1\nrelief = 900\n{VIEW}\n{PASS}# the end\n",
    "with a shot": f"""format = 1
{PASS}{VIEW}
[[shot]]
name = "page"
set = {{ "height.smoothing" = 0.9 }}
""",
}
VALUES = [
    ["height.smoothing", 0.8125],
    ["height.corners", [0.1, 0.2, 0.30000001192092896, 0.4]],
    ["height.seed", 77],
    ["view.haze", 0.33000001311302185],
    ["view.haze_colour", [0.123, 0.456, 0.789]],
    ["view.tone", 1],
    ["view.sea", True],
    ["size", [65, 65]],
    ["relief", 777],
]
CAMERA = Camera(301.25, 12.5, 8000.0, (1.0, 2.0, 3.5), 50.0)
FILL = """async (pieces, values, camera, shown, load) => (await load("toml_fill.js")).fill(pieces, {
    values: new Map(values), camera, rows: new Map(shown.map((row) => [row.path, row])), use: () => null })"""


def written(node: Node, folder: Path, text: str, values: list[Any], camera: Camera | None) -> dict[str, Any]:
    """Save a sketch, and return what the page makes of its text."""
    (folder / "sketch.toml").write_bytes(text.encode())
    sketch = load(folder)
    shown = page_data([sketch])["sketches"][0]["shown"]
    rows = {row["path"] for row in shown} | {"size", "relief"}
    pieces = sketch_pieces(text, sketch, lambda path: Path(path).relative_to(GLSL).as_posix())
    assert "".join(
        piece if isinstance(piece, str) else piece.get("was", piece.get("use", "")) for piece in pieces
    ).startswith(text.replace("\r\n", "\n"))
    value = None if camera is None else {name: getattr(camera, name) for name in camera.__slots__}
    result = node.run(FILL, pieces, [pair for pair in values if pair[0] in rows], value, shown)
    return {**result, "values": {path: value for path, value in values if path in rows}}


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
@pytest.mark.parametrize("style", STYLES)
def test_what_is_filled_in_is_what_the_sketch_says(node: Node, tmp_path: Path, style: str, ends: str):
    text = STYLES[style].replace("\n", ends)
    result = written(node, tmp_path, text, VALUES, CAMERA)
    assert result["left"] == [] and len(result["values"]) > 4
    before = load(tmp_path)
    (tmp_path / "sketch.toml").write_text(result["text"], encoding="utf-8")
    after = load(tmp_path)
    assert after.camera == CAMERA
    arguments = {path: tuple(v) if isinstance(v, list) else v for path, v in result["values"].items()}
    expected = before.with_values(arguments)
    assert after.terrain == expected.terrain
    for path, value in values_of(expected).items():
        assert shortest(values_of(after)[path]) == shortest(value), path
    kept = [line for line in text.split(ends) if line.startswith("#") or "# " in line]
    assert all(line.partition("#")[2] in result["text"] for line in kept), "comments stay"


@pytest.mark.parametrize("style", STYLES)
def test_one_value_changes_no_other(node: Node, tmp_path: Path, style: str):
    result = written(node, tmp_path, STYLES[style], [["height.seed", 5]], None)
    before = load(tmp_path)
    (tmp_path / "sketch.toml").write_text(result["text"], encoding="utf-8")
    assert values_of(load(tmp_path)) == values_of(before.with_values({"height.seed": 5}))
    assert load(tmp_path).camera == before.camera


def test_a_direction_set_by_its_angles_has_no_place_and_is_said(node: Node, tmp_path: Path):
    light = (
        '[[pass]]\nname = "light"\nuse = "lighting/ray_cast"\nset.sun.azimuth = 100\nset.sun.elevation = 20\n'
    )
    values = [["light.sun", [10.0, 30.0]]]
    result = written(node, tmp_path, f"format = 1\n{PASS}{light}", values, None)
    assert result["left"] == ["light.sun"]
    (tmp_path / "sketch.toml").write_text(result["text"], encoding="utf-8")
    assert values_of(load(tmp_path)) == values_of(load(tmp_path))
