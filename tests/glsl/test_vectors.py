"""texturing/vectors: a colour over the ground as far as a mask covers it, from files to the texture."""

from __future__ import annotations

import json

import numpy as np
import pytest

KERNEL = '#pragma kernel(output = "{0}")\n{1} kernel(ivec2 texel) {{ return {2}; }}\n'
GROUND = KERNEL.format("colour:rgba16f", "vec4", "vec4(0.25, 0.5, 0.75, 1.0)")
SHARES = KERNEL.format("mask:r32f", "float", "vec3(0.0, 0.5, 1.0)[min(texel.x / 3, 2)]")
OVER = (
    '[[pass]]\nname = "colour"\nuse = "./ground"\n[[pass]]\nname = "mask"\nuse = "./shares"\n'
    '[[pass]]\nname = "c"\nuse = "texturing/vectors/over"\nset = { tint = "#ff0000", strength = %s }\n'
)


@pytest.mark.parametrize("strength", [0.0, 0.4, 1.0])
def test_none_half_and_all_of_the_ground_is_hidden(any_engine, make_sketch, strength):
    sketch = make_sketch(OVER % strength, ground=GROUND, shares=SHARES, size=9)
    made = any_engine.read(sketch, "c").astype(float)
    ground, tint = np.array([0.25, 0.5, 0.75]), np.array([1.0, 0.0, 0.0])
    for column, share in ((1, 0.0), (4, 0.5), (7, 1.0)):
        part = share * strength
        np.testing.assert_allclose(made[:, column, :3], [(1 - part) * ground + part * tint] * 9, atol=1e-3)
    assert (made[..., 3] == 1.0).all()


def test_a_finer_mask_is_averaged_over_the_texels_of_the_colour(any_engine, make_sketch):
    # Seven in ten texels are covered, in no order that a level of detail could fall in with.
    seven = KERNEL.format("mask:r32f", "float", "float((texel.x * 7 + texel.y * 13) % 10 < 7)")
    text = (OVER % 1.0).replace('use = "./shares"', 'use = "./shares"\nsize = 65')
    made = any_engine.read(make_sketch(text, ground=GROUND, shares=seven, size=9), "c").astype(float)
    np.testing.assert_allclose(made[..., 0], 0.3 * 0.25 + 0.7, atol=0.1)


def test_a_file_is_laid_over_the_ground_where_it_lies(any_engine, make_sketch, tmp_path):
    south, north = np.meshgrid(np.arange(21), np.arange(31), indexing="ij")
    np.savez(
        tmp_path / "dem.npz",
        **{"elevation": south + north, "dx": 0.01, "dy": 0.01},
        **{"xmin": 10.0, "xmax": 10.3, "ymin": 46.8, "ymax": 47.0},
    )
    line = {"type": "LineString", "coordinates": [[10.15, 46.0], [10.15, 48.0]]}
    (tmp_path / "line.geojson").write_text(json.dumps(line))
    text = (
        '[[pass]]\nname = "colour"\nuse = "./ground"\n[[pass]]\nname = "c"\nuse = "texturing/vectors"\n'
        'inputs = { colour = "colour" }\n'
        'set = { vectors = "line.geojson", elevation = "dem.npz", width = 500.0, tint = "#ff0000" }\n'
    )
    made = any_engine.read(make_sketch(text, ground=GROUND, size=[31, 21]), "c").astype(float)
    np.testing.assert_allclose(made[:, [0, 7, 13, 17, 30], :3], [[[0.25, 0.5, 0.75]] * 5] * 21, atol=1e-3)
    # 500 m of 759 m a texel, at 46.9 degrees north.
    np.testing.assert_allclose(made[:, 15, 0], 0.25 + 0.75 * 500 / 762, atol=0.01)
