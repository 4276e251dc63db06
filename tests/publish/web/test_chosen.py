"""Where a program draws, what is chosen is written into programs; pictures keep their bits."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.engine.software import specialise
from playground.publish.web.page_data import page_data
from playground.shader.wrap import FRAGMENT, wrap

from ...cases import each
from ...loading import load
from ...shipped import FEW_SKETCHES
from ...sketch_texts import map_of, passes
from .node import Node
from .pages import Pages
from .test_every_sketch import SIZE, small
from .texts import kernels

CHOICES = """#pragma kernel(output = "height:r32f")
uniform sampler2D under;      //! input("white")
uniform int shape = 0;        //! menu("flat", "steep", "ridged")
uniform bool doubled = false; //! checkbox
uniform bool flash = false;   //! button
float kernel(ivec2 texel) {
    float found = float(texel.x) / float(size.x) * texelFetch(under, texel, 0).r;
    if (shape == 1) found *= found;
    if (shape == 2) found = abs(2.0 * found - 1.0);
    if (wired_under) found += 0.125;
    return doubled || flash ? 0.5 * found : found;
}
"""
WAIT = "return engine.parts.programs.wait(figures[arguments[0]].programs())"
USED = """const { gl } = engine.parts.context, use = gl.useProgram, used = new Set();
gl.useProgram = (program) => { used.add(program); use.call(gl, program); };
engine.parts.cache.clear();
figures.toy.render();
gl.useProgram = use;
const all = figures.toy.programs().filter(({ texts }) => texts[1].includes("float found"));
const written = /(uniform|const) +int +shape( = .)?/;
const declared = ({ texts: [, text] }) => written.exec(text)[0].replace(/ +/g, " ");
return [all.map(declared).sort(), all.filter(({ program }) => used.has(program)).map(declared)]"""
AFTER = """async (around, states, load) => {
  const { createChosen } = await load("kernels.js"), asked = [];
  const programs = {
    ask: () => asked[asked.push({ state: states[asked.length], chosen: new Map() }) - 1],
    touch: () => {}, isDone: ({ state }) => state !== "asked", finish: ({ state }) => state === "ready",
  };
  const general = { texts: ["", "uniform int shape;"], chosen: new Map() };
  const kernel = { kind: around.kind ?? "kernel", inputs: [], parameters: [
    { name: "shape", type: "int", widget: "menu" }] };
  const chosen = createChosen(around, programs, 2);
  return around.shapes.map((shape) => {
    const step = { kernel, values: { shape }, size: [1, 1] };
    const found = chosen.of({ step, inputs: new Map() }, general);
    return [found === general, asked.length, general.chosen.size];
  });
}"""


@pytest.mark.slow
def test_choices_are_written_as_the_engine_writes_them(node: Node):
    cases = []
    for name, kernel in kernels().items():
        if kernel.kind == "plain_fragment":
            continue
        choices = [(p.name, number) for number, p in enumerate(kernel.parameters)]
        choices += [(f"wired_{each.name}", 1) for each in kernel.inputs] + [("k_unwired", 0)]
        cases.append((name, wrap(kernel, FRAGMENT), choices))
    script = """async (cases, load) => {
      const { withChoices } = await load("kernels.js");
      return cases.map(([text, choices]) => withChoices(text, choices));
    }"""
    stages = [
        (name, stage.text, specialise(wrapped, choices).stages[kind].text, choices)
        for name, wrapped, choices in cases
        for kind, stage in wrapped.stages.items()
    ]
    result = node.run(script, [(text, choices) for _, text, _, choices in stages])
    for (name, _, expected, _), text in zip(stages, result, strict=True):
        assert text == expected, name
    assert sum(expected != text for _, text, expected, _ in stages) > 20


@each("around", [{"software": False, "parallel": True}, {"software": True, "parallel": None},
                 {"software": True, "parallel": True, "kind": "plain_fragment"}])  # fmt: skip
def test_values_are_not_inlined_if_useless_or_blocking(node: Node, around: dict[str, object]):
    assert node.run(AFTER, {**around, "shapes": [0, 0, 0]}, []) == 3 * [[True, 0, 0]]


def test_inlined_program_is_used_once_ready_and_rebuilt_if_lost(node: Node):
    around = {"software": True, "parallel": True, "shapes": [0, 0, 0, 0]}
    assert node.run(AFTER, around, ["ready"]) == [[True, 0, 1], *3 * [[False, 1, 1]]]
    assert node.run(AFTER, around, ["asked"]) == [[True, 0, 1], *3 * [[True, 1, 1]]]
    assert node.run(AFTER, around, ["failed"]) == [[True, 0, 1], *3 * [[True, 1, 1]]]
    gone = node.run(AFTER, around, ["gone", "ready"])
    assert gone == [[True, 0, 1], [True, 1, 1], *2 * [[False, 2, 1]]]


def test_few_choices_are_remembered(node: Node):
    around = {"software": True, "parallel": True, "shapes": list(range(20))}
    assert node.run(AFTER, around, [])[-1] == [True, 0, 8]


@pytest.mark.slow
def test_what_is_drawn_often_has_a_program_for_what_is_chosen(pages: Pages, drawn: Engine, tmp_path: Path):
    (tmp_path / "height.glsl").write_text(CHOICES, "utf-8")
    body = passes(height="./height") + map_of("height")
    (tmp_path / "toy.toml").write_text(f"format = 1\nsize = 33\n{body}", "utf-8")
    sketch = load(tmp_path / "toy.toml")
    pages.begin(data := page_data([sketch], frame=(24, 20)), often=3)
    pages.open(data["sketches"][0])
    for number, name in ((0, "flat"), (1, "steep"), (0, "flat")):
        frame = drawn.render(sketch.with_values({"height.shape": name}), size=(24, 20))
        for _ in range(3):
            pages.run("engine.parts.cache.clear()")  # or nothing would be drawn
            assert pages.picture("toy", values={"height.shape": number}).levels_off(frame.array) == 0
        pages.run(WAIT, "toy")
    now = "const int shape = 0"
    assert pages.run(USED) == [[now, "const int shape = 1", "uniform int shape"], [now]]


@pytest.mark.slow
@pytest.mark.parametrize("name", (*FEW_SKETCHES, "eroded_mountains", "hydraulic", "soft_cone", "triplanar"))
def test_a_sketch_has_its_bits_with_its_choices_written_in(name: str, pages: Pages, drawn: Engine):
    sketch = small(name)
    pages.begin(data := page_data([sketch], frame=SIZE), often=1)
    pages.open(data["sketches"][0])
    expected = drawn.render(sketch, size=SIZE).array
    for _ in range(2):
        assert pages.picture(name).levels_off(expected) == 0
        pages.run(WAIT, name)
        pages.run("engine.parts.cache.clear()")
