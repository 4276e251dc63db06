"""Models at the places of a list: where their points are, and what they are made of."""

import json

import numpy as np
import pytest

from playground.data.models import read_model
from playground.paths import GLSL

from ..data.test_models import PLACES, with_blob
from ..sketch_texts import passes

LIST = """
#pragma kernel(output = "tree:rgba32f, total:r32f")
uniform float total_of = 1.0;  //! slider(0, 4)
void kernel(ivec2 texel, out vec4 tree, out float total) {
    tree = texel.x == 0 ? vec4(500.0, 400.0, 20.0, 12.0) : vec4(600.0, 400.0, 20.0, 12.0);
    total = total_of;
}
"""
PASSES = (
    passes(
        list=("./list", "size = [2, 1]"),
        model=("objects/model", 'set = {{ model = "sketches/data/{name}.glb" }}'),
        seen=(
            "objects/seen",
            "size = [256, 256]",
            'inputs = {{ tree = "list:tree", total = "list:total" }}',
            "set = {{ {values} }}",
        ),
        height="generation/white_noise",
    )
    + """[view]
use = "view/terrain"
[view.camera]
azimuth = 160.0
elevation = 15.0
distance = 60.0
target = [500.0, 400.0, 26.0]
field_of_view = 20.0
"""
)


@pytest.mark.parametrize(("name", "kind"), [("conifer", "needles"), ("rock", "rock")])
def test_a_model_stands_on_its_place(kept, ctx, make_sketch, name, kind):
    text = PASSES.format(name=name, values=f'kind = "{kind}", tall = 1.0')
    sketch = make_sketch(text, size=33, extent=1000.0, relief=1.0, list=LIST)
    seen = kept.read(sketch, "seen", size=(256, 256)).copy()
    drawn = seen[seen[..., 3] >= 4].astype(np.float64)
    model = read_model(GLSL / "sketches" / "data" / f"{name}.glb").corners.astype(np.float64) * 12.0
    assert len(drawn) > 1000
    away = np.hypot(drawn[:, 0] - 500, drawn[:, 1] - 400)
    assert away.max() <= np.hypot(model[..., 0], model[..., 1]).max() + 1e-3
    assert abs(drawn[:, 2].max() - (20 + model[..., 2].max())) < 0.3, "a pixel is 0.1 m"
    # Turned about the upright, every point stays on one of the model's planes at its own height.
    kinds = (drawn[:, 3] - 4).astype(int) & 63
    assert set(kinds) <= set(range(32, 48) if kind == "needles" else range(48, 56)) and len(set(kinds)) > 1
    # Of the turns, one brings all points onto the surface.
    a, b, c = (model[:, k] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    some = drawn[:: len(drawn) // 60, :3] - [500, 400, 20]
    best = []
    for turn in np.linspace(0, 2 * np.pi, 721):
        back = some @ np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
        best.append(np.abs(back @ normals.T - (a * normals).sum(1)).min(1).max())
    assert min(best) < 0.06 < np.median(best)


@pytest.mark.parametrize("values", ["nearest = 100", "farthest = 40"])
def test_only_those_within_its_distances_are_drawn(kept, ctx, make_sketch, values):
    sketch = make_sketch(
        PASSES.format(name="rock", values=values), size=33, extent=1000.0, relief=1.0, list=LIST
    )
    assert not kept.read(sketch, "seen", size=(256, 256)).any()
    assert not kept.read(sketch.with_values({"list.total_of": 0.0}), "seen", size=(256, 256)).any()


BOTH = passes(
    both=(
        "trees/seen",
        "size = [256, 256]",
        'inputs = { tree = "list:tree", total = "list:total", initial = "seen" }',
        "set = { nearest = FROM }",
    )
)


@pytest.mark.parametrize("limit", [100, 40])
def test_a_tree_is_a_model_or_a_billboard_and_never_both(kept, ctx, make_sketch, limit):
    """The tree is about 60 m from the eye: as a model nearer than the limit, else as trees/seen has it."""
    text = PASSES.format(name="conifer", values=f'kind = "needles", farthest = {limit}')
    text = text.replace("[view]", BOTH.replace("FROM", str(limit)) + "[view]", 1)
    sketch = make_sketch(text, size=33, extent=1000.0, relief=1.0, list=LIST)
    model, both = (kept.read(sketch, name, size=(256, 256)).copy() for name in ("seen", "both"))
    assert (both[..., 3] >= 4).sum() > 500
    if limit == 100:
        np.testing.assert_array_equal(both, model)
    else:
        assert not model.any()


COVERED = passes(
    red="./red",
    ground=("scene/ground", "size = [33, 33]", 'inputs = { height = "height" }'),
    covered=(
        "scene/cover",
        "size = [256, 256]",
        'inputs = { seen = "seen", ground = "ground", colour = "red" }',
    ),
)


@pytest.mark.parametrize("name", ["rock", "conifer"])
def test_a_model_has_its_own_colour_whatever_the_ground_s_is(kept, ctx, make_sketch, name):
    """Rocks are as bright as the model's corners, to half a shade of sixteen; trees have the season's."""
    kind = {"rock": "rock", "conifer": "needles"}[name]
    text = PASSES.format(name=name, values=f'kind = "{kind}"').replace("[view]", COVERED + "[view]", 1)
    red = '#pragma kernel(output = "red:rgba16f")\nvec4 kernel(ivec2 t) { return vec4(1, 0, 0, 1); }\n'
    sketch = make_sketch(text, size=33, extent=1000.0, relief=1.0, list=LIST, red=red)
    seen = kept.read(sketch, "seen", size=(256, 256)).copy()
    result = kept.read(sketch, "covered", size=(256, 256))[seen[..., 3] >= 4, :3].astype(np.float64)
    lit = result @ [0.2126, 0.7152, 0.0722]
    assert len(result) > 1000 and (result[:, 1] > 0.5 * result[:, 0]).all(), "nothing of the red ground"
    if name == "rock":
        model = read_model(GLSL / "sketches" / "data" / "rock.glb").colours.astype(np.float64)
        shades = model @ [0.2126, 0.7152, 0.0722]
        assert shades.min() - 1 / 32 <= lit.min() < lit.max() <= shades.max() + 1 / 32
    else:
        assert (result[:, 1] > result[:, 0]).all() and 0.02 < lit.mean() < 0.06, "LOPEX93, needles"


def test_all_triangles_of_a_model_are_drawn(kept, ctx, make_sketch, tmp_path):
    """Of a thousand only the last has an area."""
    indices = np.zeros(3000, "<u2")
    indices[-3:] = 0, 1, 2
    result = with_blob(PLACES.tobytes() + indices.tobytes(), accessors__1__count=3000)
    result["bufferViews"][1]["byteLength"] = indices.nbytes
    path = tmp_path / "many.gltf"
    path.write_text(json.dumps(result))
    text = PASSES.format(name="rock", values="").replace("sketches/data/rock.glb", "./many.gltf")
    sketch = make_sketch(text, size=33, extent=1000.0, relief=1.0, list=LIST)
    assert (kept.read(sketch, "seen", size=(256, 256))[..., 3] >= 4).sum() > 500
