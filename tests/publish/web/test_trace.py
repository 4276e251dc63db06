"""A page traces a texel: the values that its shaders compute, of the runs that its pictures have."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.publish.export import export
from playground.publish.web.page_data import page_data
from playground.sketch.load import load
from playground.sketch.model import Sketch

from ...browser import MESA, Browser
from ...sketch_texts import map_of, passes
from .pages import MISSING, PageError, Pages
from .test_engine import CHAIN, FLOW, FLOWS, SEED, SLOPED, SPREAD

pytestmark = pytest.mark.slow

SIZE = (96, 64)
AT_REST = "document.querySelector('.stage')?.getAttribute('aria-busy') === 'false'"
LINES = """return Object.fromEntries([...document.querySelectorAll('.trace-line')].map((line) =>
  [line.querySelector('code').textContent.trim(), line.querySelector('.trace-values').textContent]))"""
MANY = """// Loops, calls, structs, matrices, arrays, and a number that is not finite.
#pragma kernel(output = "many:rg32f")
uniform float power = 3.0;  //! slider(0, 9)
struct Found { float level; ivec2 at; };
float squared(float x) { return x * x; }
Found search(vec2 from, out int steps) {
    Found found = Found(0.0, ivec2(0));
    for (steps = 0; steps < 3; steps++) {
        float weights[2] = float[2](from.x, float(steps));
        for (int inner = 0; inner <= steps; ++inner) { found.level += squared(weights[1]) + float(inner); }
        found.at.y = steps;
    }
    return found;
}
vec2 kernel(ivec2 texel) {
    int steps;
    mat2 turned = mat2(1.0, 2.0, 3.0, float(texel.x));
    Found found = search(vec2(texel), steps);
    float root = sqrt(-1.0 - float(texel.y)); // not finite
    bool is_odd = (texel.x & 1) == 1;
    if (is_odd) found.level = -found.level;
    uint bits = uint(texel.x) * 4000000000u;
    return vec2(found.level * power, float(bits) + turned[1].y);
}
"""


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Pages]:
    if MISSING:
        pytest.skip(MISSING)
    entry = Path(__file__).with_name("traced_engine.js")
    with Pages(tmp_path_factory.mktemp("page"), entry=entry) as result:
        yield result


def sketch_of(folder: Path, body: str, **files: str) -> Sketch:
    texts = {"seed.glsl": SEED, "spread.glsl": SPREAD, "sloped.glsl": SLOPED, "flow.glsl": FLOW}
    texts |= {"many.glsl": MANY} | {f"{name}.glsl": text for name, text in files.items()}
    own = "flow.initial" if "sampler2D initial" in texts["flow.glsl"] else "flow.water"
    texts["flows.toml"] = FLOWS.replace("flow.water", own)
    for name, text in texts.items():
        (folder / name).write_text(text, "utf-8")
    (folder / "s.toml").write_text(f"format = 1\nsize = [{SIZE[0]}, {SIZE[1]}]\n{body}", "utf-8")
    return load(folder / "s.toml")


def traced(pages: Pages, path: str, texel: tuple[int, int], iteration: int | None = None) -> dict[str, Any]:
    """Return the trace of a texel of the only sketch that is open, its numbers as Python has them."""
    script = """
    const isOdd = (value) => typeof value === "number" && !Number.isFinite(value);
    const plain = (key, value) => (isOdd(value) ? String(value) : value);
    try { return JSON.stringify(playground.traced(engine, figures.s, ...arguments), plain); }
    catch (error) { return JSON.stringify({ error: error.message, code: error.code }); }"""
    found = json.loads(pages.run(script, path, list(texel), iteration))
    if "error" in found:
        raise PageError({"message": found["error"], "code": found["code"]})
    return dict(found)


def open_page(pages: Pages, sketch: Sketch, engine: Engine, **state: Any) -> None:
    data = page_data([sketch], frame=SIZE, engine=engine, traces=True)
    pages.begin(data)
    pages.open(data["sketches"][0], "s")
    pages.picture("s", **state)


def values(trace: dict[str, Any], name: str) -> list[Any]:
    """Return all values of what is named so, in order."""
    return [event["value"] for event in trace["run"]["events"] if event["place"]["name"] == name]


def test_repeats_are_traced_at_any_iteration(pages: Pages, drawn: Engine, tmp_path: Path) -> None:
    sketch = sketch_of(tmp_path, CHAIN)
    open_page(pages, sketch, drawn)
    x, y = 17, 29
    steps = dict(drawn.steps(sketch, "spread", size=SIZE))
    for iteration in (0, 3, 5):
        trace = traced(pages, "spread", (x, y), iteration)
        assert (trace["iteration"], trace["total"], trace["isExact"]) == (iteration, 6, True)
        assert trace["outputs"] == [[steps[iteration + 1][y, x]]]
        (call,) = trace["run"]["calls"]
        assert (call["function"], call["file"], call["line"]) == ("kernel", "./spread.glsl", 5)
    assert traced(pages, "spread", (x, y))["iteration"] == 5
    before = pages.read("s", "spread", "soft")
    assert np.array_equal(before[..., 0], steps[6])  # what was traced changes nothing


def test_each_kind_of_value_is_read(pages: Pages, drawn: Engine, tmp_path: Path) -> None:
    sketch = sketch_of(tmp_path, passes(many="./many") + map_of("many", channel="red"))
    open_page(pages, sketch, drawn)
    trace = traced(pages, "many", (7, 5))
    assert trace["isExact"] and trace["isComplete"]
    levels = [found["members"][0][1] for found in values(trace, "found")]
    assert values(trace, "turned") == [[[1, 2], [3, 7]]]
    assert values(trace, "bits") == [7 * 4000000000 % 2**32]
    assert values(trace, "is_odd") == [True, True]  # where it is set, and as a condition
    assert values(trace, "root") == ["NaN"]
    assert [weights["elements"] for weights in values(trace, "weights")] == [[7, 0], [7, 1], [7, 2]]
    total, expected = 0.0, []
    for step in range(3):
        for inner in range(step + 1):
            total += step * step + inner
            expected.append(total)
    assert values(trace, "found.level") == [*expected, -total]
    assert levels[0] == 0.0 and trace["outputs"][0][0] == -total * 3.0
    inner = [
        e for e in trace["run"]["events"] if e["place"]["kind"] == "iteration" and e["value"] is not None
    ]
    assert [e["iterations"] for e in inner if e["place"]["name"] == "inner"] == [
        [step, number] for step in range(3) for number in range(step + 1)
    ]


def test_a_page_records_what_the_engine_does(pages: Pages, drawn: Engine, tmp_path: Path) -> None:
    """Of a fast variant's passes, repeats and included files: the same events with the same values."""
    body = passes(height="generation/diamond_square", many="./many") + map_of("height")
    sketch = sketch_of(tmp_path, body).with_values({"size": 33}).plainly()
    open_page(pages, sketch, drawn)
    for path, texel, iteration in (
        ("height.raw", (5, 4), 7),
        ("height.raw", (5, 4), 10),
        ("many", (30, 7), None),
    ):
        at: dict[str, Any] = {} if iteration is None else {"iteration": iteration}
        expected = drawn.trace(sketch, path, texel=texel, function="all", size=SIZE, **at)
        trace = traced(pages, path, texel, iteration)
        assert len(trace["run"]["events"]) == len(expected.events) > 5
        for ours, event in zip(trace["run"]["events"], expected.events, strict=True):
            place = ours["place"]
            assert (place["kind"], place["name"], place["line"]) == (event.kind, event.name, event.line)
            assert Path(event.path).as_posix().endswith(place["file"].removeprefix("./"))
            assert ours["iterations"] == list(event.iterations)
            assert plain(ours["value"]) == plain(event.value)


def plain(value: Any) -> Any:
    """Return a value of either side in one form."""
    if isinstance(value, dict):
        if "members" in value:
            return [plain(part) for _, part, _ in value["members"]]
        return [plain(part) for part in value.get("elements", value.values())]
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    return value if value is None or isinstance(value, bool) else str(float(value))


def test_passes_of_loops_are_traced(pages: Pages, drawn: Engine, tmp_path: Path) -> None:
    loop = passes(
        seed="./seed",
        water=("./flows", 'repeat = 4\nfeedback = { water = "water" }\ninputs = { water = "seed" }'),
    )
    sketch = sketch_of(tmp_path, loop + map_of("water"))
    open_page(pages, sketch, drawn)
    for iteration in (0, 2, 3):
        trace = traced(pages, "water.flow", (8, 9), iteration)
        after = drawn.read(sketch, "water", size=SIZE, steps={"water": iteration + 1})
        assert (trace["isExact"], trace["total"]) == (True, 4)
        assert trace["outputs"] == [[after[9, 8]]]


def test_repeats_inside_loops_are_traced_at_their_last(pages: Pages, drawn: Engine, tmp_path: Path) -> None:
    """The page chooses the loop's iteration."""
    again = FLOW.replace('"flow:r32f"', '"flow:r32f", repeat = "3"').replace(
        "sampler2D water", "sampler2D initial"
    )
    again = again.replace("texelFetch(water, texel, 0).r + more", "previous(texel) + more")
    wires = 'repeat = 4\nfeedback = { water = "water" }\ninputs = { water = "seed" }'
    sketch = sketch_of(
        tmp_path, passes(seed="./seed", water=("./flows", wires)) + map_of("water"), flow=again
    )
    open_page(pages, sketch, drawn)
    for iteration in (0, 3):
        trace = traced(pages, "water.flow", (8, 9), iteration)
        after = drawn.read(sketch, "water", size=SIZE, steps={"water": iteration + 1})
        assert (trace["isExact"], trace["total"]) == (True, 4)
        assert trace["outputs"] == [[after[9, 8]]]


TOY = """float level(vec2 p) { return length(p) - 0.5; }
void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    vec2 p = (fragCoord - 0.5 * iResolution.xy) / iResolution.y;
    float t = 0.0;
    for (int i = 0; i < 3; i++) t += level(p);
    fragColor = vec4(vec3(t) + fwidth(p.x), 1.0);
}
"""


def test_shaders_of_other_tools_are_traced(pages: Pages, drawn: Engine, tmp_path: Path) -> None:
    """By the names that the page gives them, with derivatives of the picture's own quads."""
    (tmp_path / "s.glsl").write_text(TOY)
    open_page(pages, load(tmp_path / "s.glsl"), drawn)
    for texel in ((7, 5), (40, 63)):
        trace = traced(pages, "view", texel)
        assert trace["isExact"]
        x, y = values(trace, "p")[0]
        assert (x, y) == pytest.approx(((texel[0] + 0.5 - 48) / 64, (texel[1] + 0.5 - 32) / 64), rel=1e-6)
        (color,) = values(trace, "fragColor")
        assert color[0] == pytest.approx(3 * (np.hypot(x, y) - 0.5) + 1 / 64, rel=1e-5)


def test_a_text_that_lost_the_context_is_not_tried_again(pages: Pages, drawn: Engine, tmp_path: Path) -> None:
    """A compiler that crashes leaves no message, and takes the context with it."""
    open_page(pages, sketch_of(tmp_path, CHAIN), drawn)
    pages.run("const p = engine.parts.programs; window.finish = p.finish; p.finish = () => false")
    for _ in "ab":
        with pytest.raises(PageError) as lost:
            traced(pages, "seed", (1, 1))
        assert lost.value.message["code"] == "lost"
        pages.run("engine.parts.programs.finish = window.finish")
    assert traced(pages, "spread", (1, 1))["isExact"]


def test_edited_texts_and_draws_have_no_trace(pages: Pages, drawn: Engine, tmp_path: Path) -> None:
    sketch = sketch_of(tmp_path, CHAIN)
    open_page(pages, sketch, drawn)
    assert traced(pages, "seed", (1, 1))["isExact"]
    edit = "return await figures.s.edit('./seed.glsl', arguments[0])"
    assert not pages.run(f"return (async () => {{ {edit} }})()", SEED.replace("43.7", "43.8"))["errors"]
    with pytest.raises(PageError, match=r"seed\.glsl") as refused:
        traced(pages, "seed", (1, 1))
    assert refused.value.message["code"] == "edited"
    assert traced(pages, "spread", (1, 1))["isExact"]  # its own text is as it was


def test_a_click_shows_values_beside_the_code(drawn: Engine, tmp_path: Path) -> None:
    """In the page that is exported, with its policy: by a key and the mouse, a loop by its slider."""
    sketch = sketch_of(tmp_path, passes(many="./many") + map_of("many", channel="red"))
    export(sketch, tmp_path / "page.html", trace=True, engine=drawn)
    with Browser(tmp_path / "profile", 1280, 900, MESA) as browser:
        browser.open((tmp_path / "page.html").as_uri())
        browser.wait(AT_REST)
        browser.run("const list = document.querySelector('.textures'); list.value = '0'; list.onchange()")
        browser.wait(AT_REST)
        browser.press("t")
        box = browser.run("return document.querySelector('canvas').getBoundingClientRect().toJSON()")
        x, y = round(box["x"] + box["width"] / 2), round(box["y"] + box["height"] / 2)
        click = [{"type": "pointerMove", "duration": 0, "x": x, "y": y}]
        click += [{"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}]
        browser.act({"type": "pointer", "id": "mouse", "actions": click})
        browser.wait("document.querySelector('.trace-line')")
        title = browser.run("return document.querySelector('.trace h2').textContent")
        column, row = map(int, re.findall(r"\d+", title))
        assert abs(column - SIZE[0] // 2) <= 1 and abs(row - SIZE[1] // 2) <= 1
        assert "bit for bit" in browser.run("return document.querySelector('.trace-said').textContent")
        lines = browser.run(LINES)
        assert lines["float root = sqrt(-1.0 - float(texel.y)); // not finite"] == "root = NaN !"
        assert lines["bool is_odd = (texel.x & 1) == 1;"] == f"is_odd = {'true' if column % 2 else 'false'}"
        browser.run(
            "const calls = document.querySelector('.trace select'); calls.value = '1'; calls.onchange()"
        )
        head = "for (steps = 0; steps < 3; steps++) {"
        assert browser.run(LINES)[head].endswith("1 of 3steps = 0")
        browser.run("const s = document.querySelector('.trace-loop input'); s.value = '2'; s.oninput()")
        assert browser.run(LINES)[head].endswith("3 of 3steps = 2")
        assert (
            browser.run(LINES)["float weights[2] = float[2](from.x, float(steps));"]
            == f"weights = [{column}, 2]"
        )
        assert not browser.log()
        if folder := os.environ.get("PAGE_PICTURES"):
            Path(folder, "trace.png").write_bytes(browser.picture())


def test_pages_without_traces_carry_none_of_it(drawn: Engine, tmp_path: Path) -> None:
    sketch = sketch_of(tmp_path, passes(many="./many") + map_of("many", channel="red"))
    sizes = [
        export(sketch, tmp_path / f"{with_traces}.html", trace=with_traces, engine=drawn).path.stat().st_size
        for with_traces in (False, True)
    ]
    assert 8_000 < sizes[1] - sizes[0] < 40_000
    kernels = [
        k
        for t in (False, True)
        for k in page_data([sketch], engine=drawn, traces=t)["sketches"][0]["kernels"]
    ]
    assert ["trace" in kernel for kernel in kernels] == [False] * (len(kernels) // 2) + [True] * (
        len(kernels) // 2
    )
