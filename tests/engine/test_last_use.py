"""A frame that none follows keeps no texture longer than a pass reads it, and is the same frame."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.engine import Engine

from ..sketch_texts import passes

GROUND = """#pragma kernel(output = "height:r32f")
uniform float bumps = 3.0; //! slider(0, 9)
float kernel(ivec2 texel) { return 0.5 + 0.5 * sin(bumps * float(texel.x) + 0.2 * float(texel.y)); }
"""
RAISED = """#pragma kernel(output = "height:r32f")
uniform sampler2D before; //! input
float kernel(ivec2 texel) { float h = texelFetch(before, texel, 0).r; return WHAT; }
"""
SHOWN = """#pragma kernel(output = "frame:rgba8")
uniform sampler2D height; //! input("linear", "mipmap")
vec4 kernel(ivec2 texel) { return vec4(textureLod(height, (vec2(texel) + 0.5) / vec2(size), 1.0).rrr, 1.0); }
"""
CHAIN = passes(
    first="./ground",
    twin="./ground",
    second=("./raised", 'inputs = { before = "first:height" }'),
    third=("./raised", 'inputs = { before = "second:height" }'),
    both=("./raised", 'inputs = { before = "third:height" }'),
    last=("./raised", 'inputs = { before = "both:height" }'),
)


@pytest.fixture
def chain(folder):
    def of(what: str = "0.9 * h"):
        folder.write("ground.glsl", GROUND)
        folder.write("raised.glsl", RAISED.replace("WHAT", what))
        folder.write("shown.glsl", SHOWN)
        return folder.sketch(CHAIN + '[view]\nuse = "./shown"\ninputs = { height = "last:height" }\n')

    return of


def once(engine: Engine) -> Engine:
    engine.options.keeps, engine.options.looks_early = False, True
    return engine


def test_last_use_release_keeps_picture_and_frees_read_textures(ctx, chain):
    with Engine(ctx) as usual, Engine(ctx) as engine:
        expected = usual.render(chain(), size=(40, 30))
        render = once(engine).render(chain(), size=(40, 30))
        np.testing.assert_array_equal(render.array, expected.array)
        assert set(usual.record.results) == {"first", "second", "third", "both", "last", "view"}
        assert set(engine.record.results) == {"view"}
        assert engine.cache.bytes == 40 * 30 * 4
        # A texture that was given back was written by a later pass: two hold what five passes gave.
        assert engine.runner.pool.made < usual.runner.pool.made


def test_equal_passes_share_texture_until_last_read(ctx, folder):
    folder.write("ground.glsl", GROUND)
    folder.write("raised.glsl", RAISED.replace("WHAT", "0.9 * h"))
    two = RAISED.replace("uniform", "uniform sampler2D other; //! input\nuniform", 1)
    folder.write("two.glsl", two.replace("WHAT", "0.5 * h + 0.25 * texelFetch(other, texel, 0).r"))
    folder.write("shown.glsl", SHOWN)
    text = passes(
        first="./ground",
        twin="./ground",
        low=("./raised", 'inputs = { before = "first:height" }'),
        sum=("./two", 'inputs = { before = "low:height", other = "twin:height" }'),
    )
    sketch = folder.sketch(text + '[view]\nuse = "./shown"\ninputs = { height = "sum:height" }\n')
    with Engine(ctx) as usual, Engine(ctx) as engine:
        expected = usual.render(sketch, size=(20, 20)).array
        np.testing.assert_array_equal(once(engine).render(sketch, size=(20, 20)).array, expected)


def test_frames_may_follow_all_the_same(ctx, chain):
    sketch = chain()
    with Engine(ctx) as usual, Engine(ctx) as engine:
        once(engine)
        for bumps in (3.0, 4.0, 3.0):
            changed = sketch.with_values({"first.bumps": bumps})
            expected = usual.render(changed, size=(24, 24)).array
            np.testing.assert_array_equal(engine.render(changed, size=(24, 24)).array, expected)


def test_what_was_not_finite_in_a_texture_that_is_gone_is_told(ctx, chain):
    broken = chain("texel == ivec2(3, 2) ? uintBitsToFloat(0x7fc00000u) : h")
    with Engine(ctx) as usual, Engine(ctx) as engine:
        usual.render(broken, size=(16, 16))
        once(engine).render(broken, size=(16, 16))
        assert engine.record.results.keys() == {"view"}
        expected = [str(not_finite) for not_finite in usual.not_finite_by_pass()]
        assert [str(not_finite) for not_finite in engine.not_finite_by_pass()] == expected
        assert "pass 'second', output 'height'" in str(engine.not_finite())


def test_mipmapped_texture_keeps_no_base_level_framebuffer(ctx, chain):
    with Engine(ctx) as engine:
        engine.render(chain(), size=(16, 16))
        assert engine.record.results["last"].mipmapped
        assert engine.record.results["last"]._framebuffer is None
        assert engine.record.results["both"]._framebuffer is not None


def test_terrain_under_the_eye_stays(ctx, folder):
    folder.write("ground.glsl", GROUND)
    sketch = folder.sketch(
        passes(height="./ground") + '[view]\nuse = "view/terrain"\nset = { grid = 9 }\n'
        "camera = { elevation = 1, distance = 0.3 }\n"
    )
    with Engine(ctx) as usual, Engine(ctx) as engine:
        usual.warnings.report = engine.warnings.report = lambda _: None
        expected = usual.render(sketch, size=(32, 18)).array
        assert usual.eye_height.raised_by > 0
        np.testing.assert_array_equal(once(engine).render(sketch, size=(32, 18)).array, expected)
