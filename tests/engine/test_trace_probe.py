"""A probe: an expression at a line as a map, against NumPy; the pass itself stays as it was."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.engine.planner import smallest_terrain
from playground.engine.trace.probe import Probe, map_of, probed
from playground.errors import PlaygroundError
from playground.sketch.find import shipped_sketches
from playground.sketch.load import load
from playground.sketch.model import Sketch

from ..sketch_texts import map_of_height

KERNEL = """#pragma kernel(output = "height:r32f")
float doubled(float x) { return 2.0 * x; }
float kernel(ivec2 texel) {
    float x = doubled(float(texel.x));
    float sum = 0.0;
    for (int i = 0; i < 4; i++) {
        sum += x * float(i);
        if (sum > 6.0)
            break;
    }

    if (texel.y == 1) return -sum;
    return sum / 100.0;
}
"""
HEAD, X, LOOP, ADD, LEAVE, BREAK, LAST = 3, 4, 6, 7, 8, 9, 13
X_OF = 2.0 * np.broadcast_to(np.arange(5.0, dtype=np.float32), (3, 5))


def sketch_of(folder: Path, **texts: str) -> Sketch:
    for name, text in texts.items():
        (folder / f"{name}.glsl").write_text(text, encoding="utf-8")
    (folder / "sketch.toml").write_text("format = 1\nsize = [5, 3]\n" + map_of_height(), encoding="utf-8")
    return load(folder)


def seen(
    engine: Engine, sketch: Sketch, line: int, expression: str, path: str = "height", file: str = ""
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return what a probe saw, (ny, nx, 4), and its hits, (ny, nx, 2)."""
    file = file or str(Path(sketch.folder) / "terrain.glsl")
    changed, probe, hits = probed(sketch, Probe(path, file, line, expression))
    return engine.read(changed, f"{path}:{probe}"), engine.read(changed, f"{path}:{hits}")


def sums() -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the sum at the loop's end, and how often it ran, by a loop in Python."""
    total, runs = np.zeros((3, 5), np.float32), np.zeros((3, 5), np.float32)
    for at in np.ndindex(3, 5):
        for i in range(4):
            total[at] += X_OF[at] * i
            runs[at] += 1
            if total[at] > 6:
                break
    return total, runs


def test_a_probe_has_the_value_of_the_last_run_and_their_number(any_engine: Engine, tmp_path: Path) -> None:
    sketch = sketch_of(tmp_path, terrain=KERNEL)
    values, hits = seen(any_engine, sketch, ADD, "sum")
    total, runs = sums()
    np.testing.assert_array_equal(values[..., 0], total)
    np.testing.assert_array_equal(hits[..., 0], runs)


def test_a_condition_says_in_which_run_it_first_held(any_engine: Engine, tmp_path: Path) -> None:
    values, hits = seen(any_engine, sketch_of(tmp_path, terrain=KERNEL), ADD, "sum >= 4.0")
    first = [[0, 3, 2, 2, 2]] * 3  # x = 0, 2, 4, 6, 8: sums 0 2 6 | 0 4 | 0 6 | 0 8
    np.testing.assert_array_equal(hits[..., 1], first)
    np.testing.assert_array_equal(values[..., 0], np.not_equal(first, 0))


@pytest.mark.parametrize(
    ("line", "expression", "expected"),
    [
        (HEAD, "texel", np.moveaxis(np.mgrid[0:3, 0:5][::-1], 0, -1)),
        (X, "vec3(x, -x, 1.0)", np.stack([X_OF, -X_OF, np.ones_like(X_OF)], -1)),
        (LAST, "texel.y == 0", np.array([[1] * 5, [0] * 5, [0] * 5])),  # line 13 runs in the rows 0 and 2
        (2, "x", X_OF / 2),
    ],
)
def test_a_probe_stands_at_any_line(
    any_engine: Engine, tmp_path: Path, line: int, expression: str, expected: NDArray[np.float32]
) -> None:
    values, _ = seen(any_engine, sketch_of(tmp_path, terrain=KERNEL), line, expression)
    expected = expected if expected.ndim == 3 else expected[..., None]
    np.testing.assert_array_equal(values[..., : expected.shape[2]], expected)


@pytest.mark.parametrize(
    ("line", "expression"), [(LOOP, "i"), (LEAVE, "sum"), (BREAK, "i"), (12, "sum"), (LAST, "x")]
)
def test_the_pass_itself_stays_as_it_was(
    any_engine: Engine, tmp_path: Path, line: int, expression: str
) -> None:
    sketch = sketch_of(tmp_path, terrain=KERNEL)
    before = any_engine.read(sketch, "height")
    changed, probe, _ = probed(sketch, Probe("height", str(tmp_path / "terrain.glsl"), line, expression))
    np.testing.assert_array_equal(any_engine.read(changed, "height"), before)
    assert np.isfinite(any_engine.read(changed, f"height:{probe}")).all()


def test_a_line_that_never_runs_has_no_hits(any_engine: Engine, tmp_path: Path) -> None:
    values, hits = seen(any_engine, sketch_of(tmp_path, terrain=KERNEL), LAST, "sum + 1.0")
    assert (hits[1] == 0).all() and (values[1] == 0).all()
    assert (hits[[0, 2], :, 0] == 1).all()


def test_a_repeated_pass_is_probed_in_its_last_step(any_engine: Engine, tmp_path: Path) -> None:
    text = """#pragma kernel(output = "height:r32f", repeat = "3")
float kernel(ivec2 texel) {
    float before = previous(texel);
    return 0.25 * float(texel.x) + 0.5 * before;
}
"""
    values, _ = seen(any_engine, sketch_of(tmp_path, terrain=text), 3, "before")
    x = 0.25 * np.arange(5.0)
    np.testing.assert_allclose(values[0, :, 0], x + 0.5 * x)  # after two of its three steps


def test_a_pass_of_several_outputs(any_engine: Engine, tmp_path: Path) -> None:
    text = """#pragma kernel(output = "height:r32f, probe:rg32f")
void kernel(ivec2 texel, out float height, out vec2 probe) {
    height = float(texel.x);
    probe = vec2(texel);
}
"""
    values, _ = seen(any_engine, sketch_of(tmp_path, terrain=text), 4, "height + probe.y")
    np.testing.assert_array_equal(values[..., 0], np.add.outer(np.arange(3), np.arange(5)))


@pytest.mark.parametrize("entry", ["mainImage(out vec4 colour, in vec2 place)", "main()"])
def test_a_shader_of_another_tool(any_engine: Engine, tmp_path: Path, entry: str) -> None:
    head = "" if "Image" in entry else "#version 330\nout vec4 colour;\n"
    text = (
        f"{head}void {entry} {{\n    vec2 half_place = gl_FragCoord.xy / 2.0;\n    colour = vec4(0.5);\n}}\n"
    )
    file = tmp_path / "toy.frag"
    file.write_text(text, encoding="utf-8")
    sketch, line = load(file), text[: text.index("half_place")].count("\n") + 1
    before = any_engine.render(sketch, size=(8, 6)).array
    changed, probe, _ = probed(sketch, Probe("view", str(file), line, "half_place"))
    np.testing.assert_array_equal(any_engine.render(changed, size=(8, 6)).array, before)
    values = any_engine.read(changed, f"view:{probe}", size=(8, 6))
    np.testing.assert_allclose(values[0, :, 0], (np.arange(8) + 0.5) / 2)


def test_a_map_shows_a_probe_of_a_pass_inside_a_technique(any_engine: Engine) -> None:
    sketch = load("jacksboro")
    flat = any_engine.plan(sketch, (64, 36)).flat
    inner = next(leaf for leaf in flat.leaves if leaf.path.startswith("view") and leaf.kernel.kind == "draw")
    lines = [line for line in inner.kernel.source.lines if "vec4 fragment(" in line.code]
    shown = map_of(sketch, Probe(inner.path, lines[0].file, lines[0].number, "1.0"))
    frame = any_engine.render(shown.of(sketch), size=(64, 36))
    assert len(np.unique(frame.array[..., 0])) > 1, "where the terrain is, and where it is not"


def test_a_pass_of_a_fast_variant_is_probed_where_it_runs(any_engine: Engine) -> None:
    sketch = load("soft_cone").with_values({"size": 65})
    leaves = any_engine.plan(sketch, (64, 36)).walk()
    step = next(step for step in leaves if step.path == "light.visibility.fast.visibility")
    line = next(line for line in step.kernel.source.lines if "float kernel(" in line.code)
    changed, probe, _ = probed(sketch, Probe(step.path, line.file, line.number, "vec2(texel)"))
    place = Probe(step.path, line.file, line.number, "").place
    values = any_engine.read(changed, f"{place}:{probe}")
    np.testing.assert_array_equal(
        values[..., 0], np.broadcast_to(np.arange(values.shape[1]), values.shape[:2])
    )
    before, after = (any_engine.read(s, "light.visibility") for s in (sketch, changed))
    np.testing.assert_allclose(after, before, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped_sketches())
def test_each_shipped_pass_takes_a_probe_and_stays_as_it_was(any_engine: Engine, name: str) -> None:
    sketch = load(name)
    sketch = sketch.with_values({"size": smallest_terrain(sketch)}).with_picture(samples=1).plainly()
    plan = any_engine.plan(sketch, (48, 32))
    for leaf in plan.flat.leaves:
        step = plan.step(leaf.path)
        if step is not None and step.repeat == 0:
            continue  # it never runs, as a glow of strength 0
        entry = {"kernel": "kernel", "plain_fragment": "main|mainImage"}.get(leaf.kernel.kind, "")
        heads = [line for line in leaf.kernel.source.lines if re.search(rf"\b({entry})\s*\(", line.code)]
        line = heads[0] if entry and heads else None
        if line is None or getattr(leaf.kernel, "visits", ""):  # whose step gives few texels
            continue
        ref = f"{leaf.path}:{leaf.kernel.outputs[0].name}"
        before = any_engine.read(sketch, ref, size=(48, 32))
        changed, probe, _ = probed(sketch, Probe(leaf.path, line.file, line.number, "1.0"))
        np.testing.assert_array_equal(any_engine.read(changed, ref, size=(48, 32)), before, leaf.path)
        values = any_engine.read(changed, f"{leaf.path}:{probe}", size=(48, 32))
        assert (values[..., 0] == 1.0).all(), leaf.path


@pytest.mark.parametrize(
    ("line", "expression", "named"),
    [
        (11, "x", "nearest is line 12"),
        (ADD, "sum = 3.0", "only reads"),
        (ADD, "i++", "only reads"),
        (ADD, "sum; discard", "single expression"),
        (ADD, "sum +", "no expression"),
        (ADD, "", "empty"),
        (900, "x", "not in this pass"),
    ],
)
def test_what_is_no_probe_is_refused(tmp_path: Path, line: int, expression: str, named: str) -> None:
    sketch = sketch_of(tmp_path, terrain=KERNEL)
    with pytest.raises(PlaygroundError, match=named):
        probed(sketch, Probe("height", str(tmp_path / "terrain.glsl"), line, expression))


def test_a_pass_that_is_not_there_is_refused(tmp_path: Path) -> None:
    sketch = sketch_of(tmp_path, terrain=KERNEL)
    with pytest.raises(PlaygroundError, match="height"):
        probed(sketch, Probe("heigth", str(tmp_path / "terrain.glsl"), X, "x"))
    with pytest.raises(PlaygroundError, match="source"):
        probed(load("jacksboro"), Probe("height", "x.glsl", 1, "x"))


def test_an_unknown_name_is_the_driver_s_to_report(any_engine: Engine, tmp_path: Path) -> None:
    with pytest.raises(PlaygroundError) as raised:
        seen(any_engine, sketch_of(tmp_path, terrain=KERNEL), ADD, "summ")
    (diagnostic,) = raised.value.diagnostics[:1]
    assert diagnostic.line == ADD and "summ" in str(raised.value)
