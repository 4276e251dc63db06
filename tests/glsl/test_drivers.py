"""One text, two drivers, the same bits: every kernel there is, under every choice of its menus.

A kernel's inputs are wired to random textures. Fast variants are ``test_fast_variants``'s.
"""

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.paths import GLSL
from playground.shader.expressions import accepted_sizes
from playground.sketch.model import Graph, Kernel, kernels_of
from playground.sketch.wiring import input_names, outputs_with_formats

from ..loading import library, load

RANDOM = """
#include "noise/hash.glsl"
#pragma kernel(output = "given:rgba32f")
uniform uint seed = 0u;
vec4 kernel(ivec2 texel) { return vec4(random_pair(texel, seed), random_pair(texel, seed + 1000u)); }
"""
SIZE = (37, 22)


KERNELS = [n for n, t in library().items() if isinstance(t, Kernel) and t.kind == "kernel"]


@pytest.fixture
def engines(ctx):
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx, driver="fragment") as fragment, Engine(ctx, driver="compute") as compute:
        yield fragment, compute


def sketch_of(folder, name):
    """Return a sketch of one technique, a random texture for each of its inputs."""
    technique = library()[name]
    (folder / "random.glsl").write_text(RANDOM)
    sizes = [k.accepts for _, k in kernels_of(technique) if k.accepts]
    size = SIZE
    if sizes:
        axes = accepted_sizes(sizes[0])
        size = tuple(min((s for s in axis if s >= 33), default=axis[-1]) for axis in axes)
    lines = [f"format = 1\nsize = {list(size)}\nextent = [700.0, 900.0]\nrelief = 150.0\n"]
    for seed, input_name in enumerate(input_names(technique)):
        lines.append(f'[[pass]]\nname = "in_{input_name}"\nuse = "./random"\nset = {{ seed = {seed} }}\n')
    wires = ", ".join(f'{input_name} = "in_{input_name}"' for input_name in input_names(technique))
    lines.append(f'[[pass]]\nname = "under_test"\nuse = "{name}"\ninputs = {{ {wires} }}\n')
    path = folder / "sketch.toml"
    path.write_text("".join(lines))
    return load(path)


def variants(sketch, technique):
    """Yield the sketch as it is, then with each other choice of each menu and checkbox."""
    yield "defaults", sketch
    if isinstance(technique, Graph):
        return
    for parameter in technique.parameters:
        choices = range(len(parameter.widget.choices)) if parameter.widget.kind == "menu" else ()
        if parameter.type == "bool":
            choices = (False, True)
        for choice in choices:
            if choice != parameter.default:
                yield (
                    f"{parameter.name} = {choice}",
                    sketch.with_values({f"under_test.{parameter.name}": choice}),
                )


def assert_same_bits(result, expected, what):
    assert result.shape == expected.shape, what
    nan = np.isnan(result) & np.isnan(expected)
    same = (result.view(np.uint32) == expected.view(np.uint32)) | nan
    assert same.all(), (
        f"{what}: {np.count_nonzero(~same)} of {same.size} numbers differ, first at {np.argwhere(~same)[0]}"
    )


def outputs_of(technique):
    return technique.outputs if isinstance(technique, Kernel) else outputs_with_formats(technique)


@pytest.mark.parametrize("name", KERNELS)
def test_both_drivers_give_the_same_bits(engines, tmp_path, name):
    technique = library()[name]
    sketch = sketch_of(tmp_path, name).plainly()
    fragment, compute = engines
    for what, variant in variants(sketch, technique):
        for output in outputs_of(technique):
            values = [
                engine.read(variant, f"under_test:{output.name}", time=1.5) for engine in (fragment, compute)
            ]
            assert_same_bits(values[1], values[0], f"{name}:{output.name} with {what}")


def test_nothing_is_left_out():
    texts = {
        p.relative_to(GLSL).with_suffix("").as_posix()
        for p in GLSL.rglob("*.glsl")
        if "#pragma kernel" in p.read_text()
    }
    assert {n for n in texts if not n.startswith("sketches/")} == set(KERNELS)
