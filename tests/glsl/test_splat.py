"""texturing/splat: each layer by its weight in linear light, evenly or by the materials' heights."""

from __future__ import annotations

import numpy as np
import pytest

COLOUR = '#include "noise/hash.glsl"\n#pragma kernel(output = "colour:rgba16f")\n'
COLOUR += "vec4 kernel(ivec2 texel) {{ return {}; }}\n"
WEIGHTS = COLOUR.replace("colour:rgba16f", "weights:rgba32f")
NAMES = ("grass", "rock", "snow", "path")
FLAT = {
    name: COLOUR.format(f"vec4({0.1 * k + 0.05}, {0.2 * k + 0.1}, 0.5, 1.0)") for k, name in enumerate(NAMES)
}
GRAINY = {
    name: COLOUR.format(f"vec4(vec3({0.1 + 0.2 * k} * (0.5 + random(texel, {k}u))), 1.0)")
    for k, name in enumerate(NAMES)
}
TILES = "".join(f'[[pass]]\nname = "{name}"\nuse = "./{name}"\nsize = 64\n' for name in NAMES)
SPLAT = '[[pass]]\nname = "weights"\nuse = "./weights"\n' + TILES
SPLAT += '[[pass]]\nname = "colour"\nuse = "texturing/splat"\n{}'
SHARES = "s.x * s.y, (1.0 - s.x) * s.y, s.x * (1.0 - s.y), (1.0 - s.x) * (1.0 - s.y)"
PLANE = WEIGHTS.replace("return {}", f"vec2 s = vec2(texel) / vec2(size - 1); return vec4({SHARES})").format()


@pytest.mark.slow
def test_the_mixture_is_each_layer_by_its_weight_in_linear_light(engine, make_sketch):
    sketch = make_sketch(SPLAT.format("size = [40, 30]\n"), size=[17, 9], weights=PLANE, **FLAT)
    result = engine.read(sketch, "colour").astype(float)
    x, y = np.meshgrid(np.linspace(0, 1, 40), np.linspace(0, 1, 30))
    shares = np.stack([x * y, (1 - x) * y, x * (1 - y), (1 - x) * (1 - y)], axis=-1)
    layers = np.array([[0.1 * k + 0.05, 0.2 * k + 0.1, 0.5] for k in range(4)])
    np.testing.assert_allclose(result[..., :3], shares @ layers, atol=8e-4)
    assert (result[..., 3] == 1).all()


def test_the_means_are_those_of_the_tiles(any_engine, make_sketch):
    sketch = make_sketch(SPLAT.format(""), size=17, weights=PLANE, **GRAINY)
    result = any_engine.read(sketch, "colour.means").ravel()
    expected = [any_engine.read(sketch, name)[..., 1].astype(float).mean() for name in NAMES]
    np.testing.assert_allclose(result, expected, rtol=2e-3)


def test_by_heights_what_is_higher_comes_through(engine, make_sketch):
    value = 'size = 65\nset = {{ blend = "{}", contrast = 20.0, variety = 0, repeats = 1 }}\n'
    alike = WEIGHTS.format("vec4(0.5, 0.0, 0.5, 0.0)")
    make = {"size": 65, "extent": 640.0, "weights": alike, **GRAINY}
    # The plain form: odds of e to the 20 show whether layers were rounded as those that are read below.
    sketch = make_sketch(SPLAT.format(value.format("by heights")), **make).plainly()
    result = engine.read(sketch, "colour").astype(float)[..., 0]
    first, other = (engine.read(sketch, f"colour.{name}").astype(float)[..., 0] for name in ("grass", "snow"))
    means = engine.read(sketch, "colour.means").ravel().astype(float)
    lead = 20.0 * (other / means[2] - first / means[0])
    share = 1 / (1 + np.exp(-lead))
    np.testing.assert_allclose(result, (1 - share) * first + share * other, rtol=3e-3)
    even = engine.read(make_sketch(SPLAT.format(value.format("even")), **make), "colour")[..., 0]
    np.testing.assert_allclose(even, 0.5 * first + 0.5 * other, rtol=3e-3)
    # Nearly every texel now shows one of the two materials, and each still has about half the terrain.
    assert np.mean(np.abs(share - 0.5) > 0.25) > 0.5
    assert 0.4 < share.mean() < 0.6


def test_by_heights_a_material_alone_stays_as_it_is(any_engine, make_sketch):
    alone = WEIGHTS.format("texel.x < 33 ? vec4(1.0, 0.0, 0.0, 0.0) : vec4(0.0, 0.0, 0.0, 1.0)")
    value = 'set = { blend = "by heights", contrast = 20.0 }\n'
    sketch = make_sketch(SPLAT.format(value), size=65, weights=alone, **GRAINY)
    result = any_engine.read(sketch, "colour")
    np.testing.assert_array_equal(result[:, :33], any_engine.read(sketch, "colour.grass")[:, :33])
    np.testing.assert_array_equal(result[:, 33:], any_engine.read(sketch, "colour.path")[:, 33:])


def test_layers_may_repeat_each_as_often_as_it_likes(any_engine, make_sketch):
    half = {**FLAT, "rock": COLOUR.format("vec4(float(texel.x >= size.x / 2))")}
    alone = WEIGHTS.format("vec4(0.0, 1.0, 0.0, 0.0)")
    value = "set = { variety = 0, rock_repeats = 3, grass_repeats = 7 }\n"
    sketch = make_sketch(SPLAT.format(value), size=[241, 5], extent=[1000.0, 20.0], weights=alone, **half)
    row = any_engine.read(sketch, "colour")[2, :, 0]
    assert np.count_nonzero((row[:-1] < 0.5) & (row[1:] >= 0.5)) == 3


def test_a_layer_without_an_image_is_refused_in_one_sentence(make_sketch):
    from playground.errors import SketchError

    text = SPLAT.format("").replace('name = "path"', 'name = "track"')
    with pytest.raises(SketchError) as caught:
        make_sketch(text, weights=PLANE, track=FLAT["path"], **FLAT)
    assert "'colour' needs its input 'path' wired" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_fifth_layer_is_refused_in_one_sentence(make_sketch):
    from playground.errors import SketchError

    with pytest.raises(SketchError) as caught:
        make_sketch(SPLAT.format('inputs = { sand = "grass" }\n'), weights=PLANE, **FLAT)
    assert "texturing/splat has no input 'sand'" in str(caught.value)
    assert "\n" not in str(caught.value)
