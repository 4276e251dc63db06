"""The first number that is not finite: its pass, output and texel, wherever it hides; no false alarm."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import moderngl
import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.non_finite import NotFinite, not_finite_in
from playground.verify.shots.suite import render_shot, shots_of

from ...cases import each
from ...loading import load
from ...sketch_texts import map_of_height, passes

NAN, INFINITY = "uintBitsToFloat(0x7fc00000u)", "uintBitsToFloat(0x7f800000u)"

SOUND = """// sound.glsl -- a slope.
#pragma kernel(output = "height:r32f")
uniform float gain = 1.0;  //! slider(0, 4) Steeper
float kernel(ivec2 texel) { return gain * float(texel.x + texel.y) / 64.0; }
"""

HEADER = """// ill.glsl -- what is given on, but at one texel.
#pragma kernel(output = "OUTPUT")
uniform sampler2D height;  //! input
uniform ivec2 at = ivec2(5, 3);
"""
ILL = f"""{HEADER}float kernel(ivec2 texel) {{
    return texel == at ? VALUE : texelFetch(height, texel, 0).r;
}}
"""
PAIR = f"""{HEADER}void kernel(ivec2 texel, out float even, out vec4 odd) {{
    even = texelFetch(height, texel, 0).r;
    odd = texel == at ? vec4(0.0, 1.0, VALUE, VALUE) : vec4(even);
}}
"""
AFTER = """// after.glsl -- hides what it reads, but not everywhere.
#pragma kernel(output = "after:rg16f")
uniform sampler2D shown;  //! input
vec2 kernel(ivec2 texel) { return vec2(texelFetch(shown, texel, 0).r, 0.5); }
"""
BYTES = """// bytes.glsl -- a picture of bytes.
#pragma kernel(output = "frame:rgba8")
uniform sampler2D shown;  //! input
uniform float broken = 0.0;  //! slider(0, 1) Whether it makes a number that is none
vec4 kernel(ivec2 texel) {
    float value = texelFetch(shown, texel & 15, 0).r;
    if (!(abs(value) < 1e30)) value = 0.0;
    if (broken > 0.5 && texel == ivec2(2, 9)) value = VALUE;
    return vec4(vec3(value), 1.0);
}
"""

SKETCH = (
    "format = 1\nsize = 16\n"
    + passes(
        terrain="./sound",
        middle=("./ill", 'inputs = { height = "terrain" }'),
        end=("./after", 'inputs = { shown = "middle" }'),
    )
    + '[view]\nuse = "./bytes"\ninputs = { shown = "end" }\n'
)


@pytest.fixture(params=["fragment", "compute"])
def drawing(request: pytest.FixtureRequest, ctx: moderngl.Context) -> Iterator[Engine]:
    if request.param == "compute" and ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx, driver=request.param) as made:
        yield made


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write(tmp_path, "middle:r32f", ILL, "1.0")
    (tmp_path / "sound.glsl").write_text(SOUND)
    (tmp_path / "after.glsl").write_text(AFTER)
    (tmp_path / "bytes.glsl").write_text(BYTES.replace("VALUE", "0.0"))
    (tmp_path / "chain.toml").write_text(SKETCH)
    return tmp_path


def write(folder: Path, output: str, text: str, value: str) -> None:
    (folder / "ill.glsl").write_text(text.replace("OUTPUT", output).replace("VALUE", value))


def found_in(engine: Engine, folder: Path, values: dict[str, object] | None = None) -> NotFinite | None:
    engine.render(load(folder / "chain.toml").with_values(values or {}), size=(32, 16))
    return engine.not_finite()


def slow(values: np.ndarray) -> tuple[tuple[int, int] | None, int]:
    """Return the first texel with a number that is not finite, and how many texels have one."""
    wrong = [
        (x, y)
        for y in range(values.shape[0])
        for x in range(values.shape[1])
        if not all(math.isfinite(v) for v in np.atleast_1d(values[y, x]).tolist())
    ]
    return (wrong[0] if wrong else None), len(wrong)


@each("dtype", ["f2", "f4"])
@each("shape", [(9, 7), (9, 7, 2), (5, 6, 4)])
@each("seed", range(6))
def test_agrees_with_looking_at_every_number(dtype: str, shape: tuple[int, ...], seed: int) -> None:
    rng = np.random.default_rng(seed)
    bits = rng.integers(0, 256, (*shape, int(dtype[1])), dtype=np.uint8).reshape(*shape[:-1], -1)
    values = bits.view(dtype).reshape(shape)  # numbers of every kind, those that are none among them
    if seed % 2:
        with np.errstate(all="ignore"):
            values = np.where(np.isfinite(values), values, np.dtype(dtype).type(1.0))
        values[4, 3] = [np.nan, np.inf, -np.inf][seed // 2]
    first, count = slow(values)
    not_finite = not_finite_in(values)
    assert (not_finite is None) == (count == 0)
    if not_finite is not None:
        assert (not_finite.texel, not_finite.count, not_finite.size) == (first, count, (shape[1], shape[0]))
        assert not_finite.value in ("NaN", "infinity", "-infinity")
    if seed % 2 and not_finite is not None:
        assert not_finite.value == ["NaN", "infinity", "-infinity"][seed // 2]


def test_the_largest_and_the_smallest_numbers_are_finite() -> None:
    for dtype in (np.float16, np.float32):
        info = np.finfo(dtype)
        values = np.array([[info.max, info.min, info.tiny, info.smallest_subnormal, -0.0]], dtype)
        assert not_finite_in(values) is None
    assert not_finite_in(np.full((2, 2), 255, np.uint8)) is None


def test_what_is_finite_is_no_alarm(drawing: Engine, folder: Path) -> None:
    assert found_in(drawing, folder) is None
    assert drawing._finite_check.looked_at == 4  # three textures of floats, and the picture of bytes beneath


NAMES = {NAN: "NaN", INFINITY: "infinity", f"-{INFINITY}": "-infinity"}


@pytest.mark.parametrize("output", ["middle:r32f", "middle:r16f", "middle:r8", "middle:r16"])
@pytest.mark.parametrize("value", [*NAMES, "1e9"])
def test_the_first_pass_in_running_order_is_named(
    drawing: Engine, folder: Path, value: str, output: str
) -> None:
    """Half floats too, and what a texture of bytes hides, beneath which large numbers are finite."""
    write(folder, output, ILL, value)
    result = found_in(drawing, folder)
    if value == "1e9":
        assert result is None or output == "middle:r16f", "drivers round it to infinity, or to the largest"
        return
    assert result == NotFinite("middle", "middle", (5, 3), NAMES[value], 1, (16, 16))
    assert str(result) == (
        f"pass 'middle', output 'middle': {NAMES[value]} at texel (5, 3) from the south-west corner; "
        "1 of 256 texels are not finite"
    )


def test_the_second_output_is_named(drawing: Engine, folder: Path) -> None:
    assert drawing.not_finite() is None, "nothing is drawn yet"
    write(folder, "even:r32f, odd:rgba32f", PAIR, NAN)
    (folder / "chain.toml").write_text(SKETCH.replace('shown = "middle"', 'shown = "middle:even"'))
    result = found_in(drawing, folder)
    assert result is not None
    assert (result.path, result.output, result.texel) == ("middle", "odd", (5, 3))


def test_large_textures_are_looked_at_in_bands(
    drawing: Engine, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(folder, "middle:r32f", ILL.replace("texel == at", "texel.y > 2 && texel.x == 5"), NAN)
    monkeypatch.setattr("playground.engine.textures.BAND", 5 * 16 * 4)
    assert found_in(drawing, folder) == NotFinite("middle", "middle", (5, 3), "NaN", 13, (16, 16))


def test_what_the_view_hides_is_found(drawing: Engine, folder: Path) -> None:
    (folder / "bytes.glsl").write_text(BYTES.replace("VALUE", NAN))
    assert found_in(drawing, folder, {"view.broken": 0.0}) is None
    before = drawing.render(load(folder / "chain.toml"), size=(32, 16)).array
    result = found_in(drawing, folder, {"view.broken": 1.0})
    assert result == NotFinite("view", "frame", (2, 9), "NaN", 1, (32, 16))
    np.testing.assert_array_equal(drawing.render(load(folder / "chain.toml"), size=(32, 16)).array, before)


def test_a_plain_shader_of_bytes_is_looked_beneath(ctx: moderngl.Context, tmp_path: Path) -> None:
    text = "#version 330\nuniform float time;\nout vec4 colour;\n"
    text += "void main() { colour = vec4(gl_FragCoord.x < 4.0 ? log(time - 1.0) : 0.5); }\n"
    (tmp_path / "plain.frag").write_text(text)
    with Engine(ctx) as engine:
        engine.render(load(tmp_path / "plain.frag"), size=(8, 4), time=2.0)
        assert engine.not_finite() is None
        engine.render(load(tmp_path / "plain.frag"), size=(8, 4), time=1.0)
        not_finite = engine.not_finite()
    assert not_finite is not None
    assert (not_finite.path, not_finite.value, not_finite.count) == ("view", "-infinity", 16)


def test_only_what_ran_anew_is_looked_at_again(drawing: Engine, folder: Path) -> None:
    assert found_in(drawing, folder) is None
    assert found_in(drawing, folder) is None
    assert drawing._finite_check.looked_at == 0
    assert found_in(drawing, folder, {"view.broken": 0.25}) is None
    assert drawing._finite_check.looked_at == 1
    assert found_in(drawing, folder, {"terrain.gain": 0.5}) is None
    assert drawing._finite_check.looked_at == 4


def test_what_is_cached_is_still_reported(drawing: Engine, folder: Path) -> None:
    write(folder, "middle:r32f", ILL, NAN)
    for broken in (0.0, 0.25, 0.25):
        result = found_in(drawing, folder, {"view.broken": broken})
        assert result is not None
        assert result.path == "middle"
    assert found_in(drawing, folder, {"middle.at": (99, 99)}) is None


def test_steps_that_continue_in_place_are_looked_at_again(ctx: moderngl.Context, tmp_path: Path) -> None:
    (tmp_path / "line.glsl").write_text(
        "// line.glsl -- one texel in each step, of which the third is not finite.\n"
        '#pragma kernel(output = "height:r32f", repeat = "count", visits = "1, 1")\n'
        "uniform int count = 6;  //! slider(1, 9) Steps\n"
        "ivec2 visit(ivec2 cell) { return ivec2(iteration, 0); }\n"
        "float kernel(ivec2 texel) {\n"
        "    if (texel != ivec2(iteration, 0)) return previous(texel);\n"
        f"    return iteration == 2 ? {INFINITY} : 0.5;\n"
        "}\n"
    )
    (tmp_path / "chain.toml").write_text("format = 1\nsize = 16\n" + map_of_height("./line", channel="red"))
    with Engine(ctx) as engine:
        for steps, ill in ((1, False), (2, False), (3, True), (4, True), (2, False)):
            engine.render(load(tmp_path / "chain.toml"), size=(16, 16), steps={"height": steps})
            not_finite = engine.not_finite()
            assert (not_finite is not None) is ill, steps
            assert not_finite is None or (not_finite.path, not_finite.texel) == ("height", (2, 0))


def test_gaps_that_a_source_fills_are_no_alarm(ctx: moderngl.Context, tmp_path: Path) -> None:
    terrain = np.add.outer(np.arange(16.0), np.arange(16.0)).astype(np.float32)
    terrain[4:6, 7] = np.nan
    np.save(tmp_path / "terrain.npy", terrain)
    (tmp_path / "hills.toml").write_text(
        "format = 1\nrelief = 100.0\nextent = 1000.0\n"
        '[[pass]]\nname = "height"\nuse = "generation/heightmap"\n'
        'set = { elevation = "terrain.npy", no_data = "fill" }\n[view]\nuse = "view/terrain"\n'
    )
    with Engine(ctx) as engine:
        engine.render(load(tmp_path / "hills.toml"), size=(32, 16))
        assert engine.not_finite() is None


def test_a_shot_that_is_taken_says_so(drawing: Engine, folder: Path) -> None:
    (folder / "chain.toml").write_text(f'{SKETCH}[[shot]]\nname = "one"\nsize = [32, 16]\n')
    (case,) = shots_of([folder / "chain.toml"])
    assert render_shot(drawing, case).not_finite == ""
    write(folder, "middle:r32f", ILL, NAN)
    (case,) = shots_of([folder / "chain.toml"])
    assert render_shot(drawing, case).not_finite.startswith("pass 'middle', output 'middle': NaN")


def test_it_leaves_no_object_and_no_error_behind(
    alive: Counter[str], ctx: moderngl.Context, folder: Path
) -> None:
    grown = []
    for looks in (False, True):
        with Engine(ctx) as engine:
            for broken in range(8):
                if broken == 4:  # by now everything that the check allocates exists
                    before = Counter(alive)
                engine.render(
                    load(folder / "chain.toml").with_values({"view.broken": broken / 10}), size=(32, 16)
                )
                if looks:
                    engine.not_finite()
            grown.append(Counter(alive) - before)
            assert ctx.error == "GL_NO_ERROR"
        assert +alive == Counter()
    assert grown[0] == grown[1] != Counter()  # each of the pictures is cached
