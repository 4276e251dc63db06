"""A page draws what the engine draws, runs only what is stale, and says what is wrong."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.publish.web.page_data import page_data
from playground.sketch.load import load
from playground.sketch.model import Sketch

from ...sketch_texts import map_of, passes
from .pages import PageError, Pages

Made = Callable[..., Sketch]
Exported = dict[str, Any]

SIZE = (96, 64)
SEED = """#pragma kernel(output = "height:r32f")
uniform float level = 0.5;  //! slider(0, 2)
uniform int seed = 3;       //! slider(0, 9)
float kernel(ivec2 texel) { return level * fract(sin(float(texel.x * 7 + texel.y * 13 + seed)) * 43.7); }
"""
SPREAD = """// Each iteration takes the mean of a texel and its neighbours.
#pragma kernel(output = "soft:r32f", repeat = "count")
uniform sampler2D initial;  //! input
uniform int count = 6;     //! slider(0, 20)
float kernel(ivec2 texel) {
    return 0.5 * previous(texel) + 0.25 * (previous(texel + ivec2(1, 0)) + previous(texel - ivec2(0, 1)));
}
"""
SLOPED = """#pragma kernel(output = "sloped:rg16f")
uniform sampler2D field;    //! input(linear)
uniform float steep = 1.0;  //! slider(0, 4)
vec2 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.75) / vec2(size);
    float here = textureLod(field, place, 0.0).r;
    return steep * vec2(here, here - textureLod(field, place + 0.3 / vec2(size), 0.0).r);
}
"""
CHAIN = passes(
    seed="./seed",
    spread=("./spread", 'inputs = { initial = "seed" }'),
    sloped=("./sloped", 'inputs = { field = "spread" }'),
) + map_of("sloped")
STATE = """#pragma kernel(output = "state:r32f")
uniform sampler2D own;     //! input("zero")
uniform float rate = 3.7;  //! slider(3, 4)
float kernel(ivec2 texel) {
    float x = texelFetch(own, texel, 0).r;
    return time == 0.0 ? 0.25 + 0.5 * float(texel.x * 7 + texel.y * 3) / 200.0 : rate * x * (1.0 - x);
}
"""
FLOW = """#pragma kernel(output = "flow:r32f")
uniform sampler2D water;  //! input
uniform sampler2D rough;  //! input
float kernel(ivec2 texel) {
    float more = 0.1 * texelFetch(rough, texel, 0).r + 0.01 * float(iteration);
    return 0.5 * texelFetch(water, texel, 0).r + more;
}
"""
FLOWS = (
    passes(rough="./seed", flow=("./flow", 'inputs = { rough = "rough" }'))
    + '[inputs]\nwater = ["flow.water"]\n[outputs]\nwater = "flow:flow"\n'
)
GROWS = passes(state="./state") + '[inputs]\nown = "state.own"\n[outputs]\nstate = "state:state"\n'


@pytest.fixture
def sketch(tmp_path: Path) -> Made:
    def made(body: str, **files: str) -> Sketch:
        texts = {"seed.glsl": SEED, "spread.glsl": SPREAD, "sloped.glsl": SLOPED, "state.glsl": STATE}
        texts |= {"flow.glsl": FLOW, "flows.toml": FLOWS, "grows.toml": GROWS}
        for name, text in texts.items():
            (tmp_path / name).write_text(files.get(name.split(".")[0], text), "utf-8")
        (tmp_path / "toy.toml").write_text(f"format = 1\nsize = 33\n{body}", "utf-8")
        return load(tmp_path / "toy.toml")

    return made


def begun(
    pages: Pages, *sketches: Sketch, size: tuple[int, int] = SIZE, **options: Any
) -> list[dict[str, Any]]:
    data = page_data(sketches, frame=size)
    pages.begin(data, **options)
    for item in data["sketches"]:
        pages.open(item)
    return list(data["sketches"])


def test_sketches_of_each_kind_are_drawn_with_the_engines_bits(pages: Pages, drawn: Engine):
    """A terrain with levels of detail, mixed image files, steps of a lattice."""
    names = ("geomipmap", "height_blend_image", "diamond_square_steps")
    sketches = [load(name).with_values({"size": "65"} if name == "geomipmap" else {}) for name in names]
    begun(pages, *sketches, size=(160, 90))
    for item in sketches:
        picture = pages.picture(item.name)
        assert picture.levels_off(drawn.render(item, size=(160, 90)).array) == 0
        assert len(np.unique(picture.pixels)) > 16


def test_what_runs_is_what_the_engine_would_run(pages: Pages, drawn: Engine, sketch: Made):
    whole = sketch(CHAIN)
    begun(pages, whole)
    drawn.cache.clear()
    for changes in (
        {},
        {"sloped.steep": 2.5},
        {"seed.seed": 5},
        {"spread.count": 3},
        {"spread.count": 9},
        {},
    ):
        frame = drawn.render(whole.with_values(changes), size=SIZE)
        picture = pages.picture(whole.name, values=changes)
        assert picture.levels_off(frame.array) == 0
        assert picture.ran == drawn.record.ran
    assert pages.picture(whole.name).ran == []


def test_a_repeat_stops_early_and_goes_on(pages: Pages, drawn: Engine, sketch: Made):
    whole = sketch(CHAIN)
    begun(pages, whole)
    for count in (0, 2, 5, 4, 6):
        steps = {"spread": count}
        frame = drawn.render(whole, size=SIZE, steps=steps)
        assert pages.picture(whole.name, steps=steps).levels_off(frame.array) == 0
    lattice = load("diamond_square_steps")
    begun(pages, lattice, size=(160, 90))
    [path] = pages.run("return Object.keys(figures.diamond_square_steps.sketch.steps)") or ["height"]
    for count in (1, 2, 4):
        frame = drawn.render(lattice, size=(160, 90), steps={path: count})
        assert pages.picture(lattice.name, steps={path: count}).levels_off(frame.array) == 0


def test_a_loop_feeds_back(pages: Pages, drawn: Engine, sketch: Made):
    loop = '[[pass]]\nname = "rain"\nuse = "./flows"\ninputs = { water = "seed" }\nrepeat = "7"\n'
    whole = sketch(passes(seed="./seed") + loop + 'feedback = { water = "water" }\n' + map_of("rain"))
    begun(pages, whole)
    drawn.cache.clear()
    for steps in ({}, {"rain": 3}, {"rain": 5}, {"rain": 0}):
        frame = drawn.render(whole, size=SIZE, steps=steps)
        picture = pages.picture(whole.name, steps=steps)
        assert picture.levels_off(frame.array) == 0
        assert picture.ran == drawn.record.ran


def test_a_repeat_ends_once_it_has_settled(pages: Pages, drawn: Engine, sketch: Made):
    """Two outputs, one of them integers in a texture of bytes; without ``until`` a million steps."""
    header = '#pragma kernel(output = "soft:r32f, rest:rgba8", repeat = "1000000", until = "unchanged")\n'
    body = "    rest = vec4(0.0, 0.0, 0.0, previous_rest(texel).a + 1.0 / 255.0);\n"
    far = "max(previous_soft(texel - ivec2(1, 0)), previous_soft(texel - ivec2(0, 1)))"
    kernel = f"void kernel(ivec2 texel, out float soft, out vec4 rest) {{\n{body}"
    kernel += f"    soft = max(previous_soft(texel), 0.999 * {far});\n}}\n"
    text = header + "uniform sampler2D initial_soft;  //! input\n" + kernel
    chain = CHAIN.replace("initial = ", "initial_soft = ").replace(
        'field = "spread"', 'field = "spread:soft"'
    )
    whole = sketch(chain, spread=text)
    begun(pages, whole)
    drawn.cache.clear()
    frame = drawn.render(whole, size=SIZE)
    assert 255 < drawn.record.iterations["spread"] < 300
    assert pages.picture(whole.name).levels_off(frame.array) == 0


def test_levels_of_a_loop_have_their_own_sizes_and_counts(pages: Pages, drawn: Engine, sketch: Made):
    flow = FLOW.replace("water, texel, 0", "water, texel * textureSize(water, 0) / size, 0")
    more = 'inputs = { rough = "rough" }\nrepeat = "iterations - iteration"\nfeedback = { water = "flow" }\n'
    whole = sketch(
        passes(seed="./seed")
        + '[[pass]]\nname = "rain"\nuse = "./flows"\ninputs = { water = "seed" }\nrepeat = 4\n'
        + 'size = "(size.x - 1) // 2 ** (iterations - 1 - iteration) + 1"\nfeedback = { water = "water" }\n'
        + map_of("rain"),
        flow=flow,
        flows=FLOWS.replace('inputs = { rough = "rough" }\n', more),
    )
    begun(pages, whole)
    drawn.cache.clear()
    for changes, steps in (({}, {}), ({"seed.level": 0.25}, {}), ({}, {"rain": 2}), ({}, {"rain.flow": 3})):
        frame = drawn.render(whole.with_values(changes), size=SIZE, steps=steps)
        picture = pages.picture(whole.name, values=changes, steps=steps)
        assert picture.levels_off(frame.array) == 0
        assert picture.ran == drawn.record.ran


def test_a_loop_that_counts_frames_goes_on_and_back(pages: Pages, drawn: Engine, sketch: Made):
    loop = '[[pass]]\nname = "grow"\nuse = "./grows"\nrepeat = "frames"\nfeedback = { own = "state" }\n'
    whole = sketch(loop + map_of("grow"))
    begun(pages, whole)
    for frame in (0, 5, 30, 31, 12, 13, 29):
        time = frame / 60
        picture = pages.picture(whole.name, time=time)
        assert picture.levels_off(drawn.render(whole, size=SIZE, time=time).array) == 0
        assert picture.ran == drawn.record.ran


def test_work_in_slices_gives_the_same_and_an_estimate(pages: Pages, drawn: Engine, sketch: Made):
    whole = sketch(CHAIN)
    begun(pages, whole)
    assert not pages.run("return figures.toy.estimate().isKnown")
    assert pages.picture(whole.name, soon=1).levels_off(drawn.render(whole, size=SIZE).array) == 0
    assert pages.run("return figures.toy.estimate().milliseconds") == 0  # nothing is stale
    assert pages.picture(whole.name, soon=1, values={"seed.seed": 8}).ran
    estimate = pages.run("figures.toy.state.values = { 'seed.seed': 9 }; return figures.toy.estimate()")
    assert estimate["isKnown"] and estimate["milliseconds"] > 0


@pytest.mark.slow
def test_large_passes_are_cut_into_bands(pages: Pages, drawn: Engine, sketch: Made):
    """What was never measured begins with a band of it; the bits are those of one draw."""
    whole = sketch(CHAIN).with_values({"size": "700"})
    begun(pages, whole)
    frame = drawn.render(whole, size=SIZE)
    assert pages.picture(whole.name, soon=0.25).levels_off(frame.array) == 0
    np.testing.assert_array_equal(
        pages.read(whole.name, "spread", "soft")[..., 0], drawn.read(whole, "spread")
    )


def test_figures_draw_in_between_each_others_slices(pages: Pages, drawn: Engine, sketch: Made):
    whole = sketch(CHAIN)
    [data] = begun(pages, whole)
    pages.open(data, "other")
    script = """const { toy, other } = figures, states = [{ "seed.seed": 4 }, { "seed.seed": 5 }];
    [toy.state.values, other.state.values] = states;
    const both = [toy.renderSoon(0.25), other.renderSoon(0.25)];
    await new Promise((resume) => setTimeout(resume, 1));
    other.state.values = { "seed.seed": 6 };
    other.render();
    return (await both[0]).ran.length"""
    assert pages.run(f"return (async () => {{ {script} }})()") == 4
    for name, seed in (("toy", 4), ("other", 6)):
        frame = drawn.render(whole.with_values({"seed.seed": seed}), size=SIZE)
        picture = pages.picture(name)
        assert picture.ran == []
        assert picture.levels_off(frame.array) == 0


def test_two_figures_of_one_loop_run_at_once(pages: Pages, drawn: Engine, sketch: Made):
    """Both are at the same state of the loop: the one that comes to it later takes it over."""
    loop = '[[pass]]\nname = "grow"\nuse = "./grows"\nrepeat = "frames"\nfeedback = { own = "state" }\n'
    whole = sketch(loop + map_of("grow"))
    [data] = begun(pages, whole)
    pages.open(data, "other")
    script = """const { toy, other } = figures;
    toy.state.time = 1;
    const soon = toy.renderSoon(0.25);
    await new Promise((resume) => setTimeout(resume, 3));
    other.state.time = 0.5;
    other.render();
    return (await soon).milliseconds"""
    pages.run(f"return (async () => {{ {script} }})()")
    for name, time in (("toy", 1.0), ("other", 0.5)):
        assert pages.picture(name, time=time).levels_off(drawn.render(whole, size=SIZE, time=time).array) == 0


def test_a_later_call_overtakes_one_in_slices(pages: Pages, drawn: Engine, sketch: Made):
    whole = sketch(CHAIN)
    begun(pages, whole)
    script = """const player = figures.toy, first = player.renderSoon(1);
    player.state.values = { "seed.seed": 7 };
    const second = await player.renderSoon(1);
    return [await first, second.ran.length]"""
    assert pages.run(f"return (async () => {{ {script} }})()") == [None, 4]
    assert pages.picture(whole.name).ran == []


def test_an_edited_text_is_drawn_and_a_wrong_one_told_by_line(pages: Pages, drawn: Engine, sketch: Made):
    whole = sketch(CHAIN)
    [data] = begun(pages, whole)
    file = next(kernel["file"] for kernel in data["kernels"] if kernel["file"].endswith("sloped.glsl"))
    edit = "return figures.toy.edit(arguments[0], arguments[1])"
    before = pages.picture(whole.name)
    wrong = pages.run(edit, file, SLOPED.replace("float here =", "float her ="))
    assert wrong["programs"] == 1
    assert [(item["file"], item["line"]) for item in wrong["errors"]] == [(file, 7)]
    assert "here" in wrong["errors"][0]["message"]
    again = pages.picture(whole.name)
    assert again.ran == []
    assert again.levels_off(before.pixels) == 0
    text = SLOPED.replace("0.75", "0.25").replace("0.3", "0.9")
    assert pages.run(edit, file, text) == {"errors": [], "programs": 1}
    picture = pages.picture(whole.name)
    assert picture.ran == ["sloped", "view"]
    assert picture.levels_off(drawn.render(sketch(CHAIN, sloped=text), size=SIZE).array) == 0
    assert picture.levels_off(before.pixels) > 0


@pytest.mark.slow
def test_a_context_that_was_lost_comes_back(pages: Pages):
    item = load("geomipmap").with_values({"size": "65"})
    begun(pages, item, size=(160, 90))
    before = pages.picture("geomipmap")
    lost = """const gl = engine.parts.context.gl, losing = gl.getExtension("WEBGL_lose_context");
    losing.loseContext();
    let code = "";
    await new Promise((resume) => setTimeout(resume, 50));
    try { figures.geomipmap.render(); } catch (error) { ({ code } = error); }
    const back = new Promise((resume) => engine.canvas.addEventListener("webglcontextrestored", resume));
    losing.restoreContext();
    await back;
    await engine.restore();
    return code"""
    assert pages.run(f"return (async () => {{ {lost} }})()") == "context-lost"
    again = pages.picture("geomipmap")
    assert again.levels_off(before.pixels) == 0
    assert len(again.ran) == len(before.ran)


@pytest.mark.slow
def test_a_device_that_filters_no_floats_is_filtered_by_hand(pages: Pages, sketch: Made):
    toy, land = sketch(CHAIN), load("geomipmap").with_values({"size": "65"})
    begun(pages, toy, land, size=(160, 90))
    pictures = {name: pages.picture(name) for name in (toy.name, land.name)}
    begun(pages, toy, land, size=(160, 90), without=["OES_texture_float_linear"])
    for name, before in pictures.items():
        now = pages.picture(name)
        assert now.levels_off(before.pixels) <= 3
        assert len(np.unique(now.pixels)) > 16


def test_floats_that_are_not_filtered_have_levels_all_the_same(pages: Pages, sketch: Made):
    """Shown from above, a texture is read with mipmaps: its levels are 16-bit floats there."""
    whole = sketch(passes(seed="./seed") + map_of("seed"))
    begun(pages, whole, size=(24, 20))
    before = pages.picture(whole.name)
    begun(pages, whole, size=(24, 20), without=["OES_texture_float_linear"])
    now = pages.picture(whole.name)
    assert now.levels_off(before.pixels) <= 3
    assert len(np.unique(now.pixels)) > 16


def test_any_texture_is_shown_from_above(pages: Pages, drawn: Engine, sketch: Made):
    """Its levels are made where the sketch itself reads none."""
    whole = sketch(CHAIN)
    begun(pages, whole, size=(24, 20))
    before = pages.picture(whole.name)
    shown = {"path": "seed", "output": "height", "values": {}}
    other = sketch(CHAIN.replace(map_of("sloped"), map_of("seed")))
    assert pages.picture(whole.name, map=shown).levels_off(drawn.render(other, size=(24, 20)).array) == 0
    assert pages.picture(whole.name, map=None).levels_off(before.pixels) == 0


def test_page_draws_loaded_programs_without_compiler_wait(pages: Pages, sketch: Made):
    """The map of a texture, its levels, and what shows a picture on a canvas."""
    begun(pages, sketch(CHAIN))
    script = """const { gl, parallel } = engine.parts.context, waited = [];
    const ask = gl.getProgramParameter.bind(gl);
    gl.getProgramParameter = (program, what) => {
      const waits = what === gl.LINK_STATUS && !ask(program, parallel.COMPLETION_STATUS_KHR);
      if (waits) waited.push(program);
      return ask(program, what);
    };
    const player = figures.toy;
    player.render();
    player.state.map = { path: "seed", output: "height", values: {} };
    await player.load();
    player.render();
    player.drawTo(document.createElement("canvas").getContext("2d"));
    return [!!parallel, waited.length]"""
    assert pages.run(f"return (async () => {{ {script} }})()") == [True, 0]


def test_a_device_without_16_bits_rounds_to_them(pages: Pages, sketch: Made):
    """Numbers beyond 0 to 1 stop there, as they do in the format itself."""
    sixteen = SEED.replace("r32f", "r16").replace("0.5;", "1.7;")
    whole = sketch(CHAIN, seed=sixteen)
    begun(pages, whole)
    before = pages.read(whole.name, "seed", "height")
    begun(pages, whole, without=["EXT_texture_norm16"])
    now = pages.read(whole.name, "seed", "height")
    assert (now == 1).any() and (now < 1).any()
    np.testing.assert_allclose(now, before, rtol=0, atol=1.01 / 65535)  # drivers round as they like


def test_a_device_that_cannot_draw_floats_is_told(pages: Pages, sketch: Made):
    data = page_data([sketch(CHAIN)], frame=SIZE)
    with pytest.raises(PageError) as caught:
        pages.begin(data, without=["EXT_color_buffer_float"])
    assert caught.value.message["code"] == "no-float-targets"
    assert caught.value.message["sentence"].endswith(".")


@pytest.mark.slow
def test_nothing_is_left_behind_by_a_thousand_changes(pages: Pages, sketch: Made):
    begun(pages, sketch(CHAIN))
    script = """const player = figures.toy, { state } = player, canvas = document.createElement("canvas");
    const context2d = canvas.getContext("2d");
    const change = (n) => {
      state.values = { "seed.seed": n % 9, "spread.count": n % 7, "sloped.steep": 1 + n / 1000 };
      state.terrain = { ...player.sketch.terrain, size: n % 10 ? [33, 33] : [17 + n % 3, 33] };
      player.render();
      player.drawTo(context2d);
    };
    for (let n = 0; n < 600; n++) change(n);
    const before = engine.counts(), bytes = engine.bytes();
    for (let n = 0; n < 1000; n++) change(n);
    return [before, engine.counts(), bytes, engine.bytes()]"""
    before, after, bytes_before, bytes_after = pages.run(script)
    assert all(after[kind] <= before[kind] * 1.05 + 2 for kind in after), (before, after)
    assert bytes_after <= 1.05 * bytes_before


@pytest.mark.slow
def test_a_closed_engine_has_released_everything(pages: Pages, sketch: Made):
    begun(pages, sketch(CHAIN), load("geomipmap").with_values({"size": "65"}))
    for name in ("toy", "geomipmap"):
        pages.picture(name)
    left = pages.run("engine.close(); return engine.counts()")
    assert set(left.values()) == {0}


def test_figures_share_programs_and_passes(pages: Pages, sketch: Made):
    whole = sketch(CHAIN)
    [data] = begun(pages, whole)
    pages.picture(whole.name)
    programs = pages.run("return engine.counts().Program")
    pages.open(data, "second")
    assert pages.run("return engine.counts().Program") == programs
    assert pages.picture("second").ran == []
