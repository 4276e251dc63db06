"""The contract of every dialect, over the cases of tests/foreign_cases.

A case says what must come of it: ``draws`` are pictures, each with its ``size``, ``time`` and values
(``set``) and what its channels are (``is``), levels from 0 to 255 or an expression of ``x`` and ``y``, the
place in the picture from 0 to 1; ``within`` is the tolerance, half a level by default. ``parameters`` are
defaults by name, ``widgets`` and ``lines`` theirs; ``inputs`` shapes, ``sizes`` those of passes, ``passes``
their names, ``warnings`` parts of each message. Of a refusal, ``error`` are parts of the message.
"""

from __future__ import annotations

import re

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import PlaygroundError, ShaderError
from playground.publish.large import strips
from playground.shader.wrap import FRAGMENT, wrap
from playground.sketch.model import ForeignShader, kernels_of
from playground.verify.reduce.case import inline_sketch

from ..cases import each
from ..foreign_cases import CASES, EVERY, REFUSALS, RESULTS
from ..loading import load
from .drawing import SIZE, colours, drawn, kernels, notes

DEPRECATED = re.compile(
    r"\b(?:varying|attribute|gl_FragColor|gl_FragData|gl_FragDepthEXT"
    r"|(?:texture|shadow)(?:[123]D|Cube|2DRect)\w*)\b"
)


@pytest.mark.parametrize("case", EVERY, ids=str)
def test_a_shader_is_deterministic_at_a_time(any_engine, ctx, folder, case):
    path = case.write(folder.path)
    first = drawn(any_engine, path, 1.0)
    assert colours(first) > 1
    assert ctx.error == "GL_NO_ERROR"
    any_engine.cache.clear()
    drawn(any_engine, path, 2.0)
    np.testing.assert_array_equal(drawn(any_engine, path, 1.0), first)
    with Engine(ctx) as fresh:
        np.testing.assert_array_equal(drawn(fresh, path, 1.0), first)


@pytest.mark.parametrize("case", EVERY, ids=str)
def test_a_mistake_is_at_its_own_line(any_engine, folder, case):
    for wrong, place, line in case.mistakes():
        with pytest.raises(ShaderError) as caught:
            drawn(any_engine, wrong.write(folder.path))
        diagnostic = caught.value.diagnostics[0]
        assert (diagnostic.file.rpartition("/")[2], diagnostic.line) == (place, line)
        assert "not_declared" in diagnostic.message and "not_declared" in diagnostic.excerpt


@pytest.mark.parametrize("case", EVERY, ids=str)
def test_the_driver_gets_no_deprecated_name(folder, case):
    stages = [
        stage.text
        for kernel in kernels(case.write(folder.path))
        for stage in wrap(kernel, FRAGMENT, 450).stages.values()
    ]
    assert stages and not [word for text in stages for word in DEPRECATED.findall(text)]


@pytest.mark.parametrize("case", EVERY, ids=str)
def test_a_sketch_has_the_files_and_the_state_of_its_shader(folder, case):
    sketch = load(case.write(folder.path))
    names = {path.rpartition("/")[2] for path in sketch.files}
    assert names >= {name.rpartition("/")[2] for name in case.files}, "packing takes them"
    state = sketch.graph.find("view").repeat == "frames"
    assert state == case.expected.get("stateful", False)


WHOLE = ["main book", "main varying", "main viewer_buffers", "isf given", "isf inputs", "isf with_vertex_1"]
WHOLE += ["shadertoy toy", "shadertoy toy_declares", "shadertoy common", "shadertoy cube"]
WHOLE += ["shadertoy code_uniforms"]
NEEDS_ALL = ["main viewer_flood", "main viewer_pyramid", "main viewer_post", "main sandbox_trails"]
NEEDS_ALL += ["shadertoy buffer", "shadertoy feedback"]


@pytest.mark.parametrize("name", WHOLE)
def test_a_picture_drawn_in_parts_is_that_drawn_whole(any_engine, folder, name):
    sketch = load(named(name).write(folder.path))
    whole = any_engine.render(sketch, size=SIZE, time=0.25).array
    parts = np.concatenate(list(strips(any_engine, sketch, SIZE, tile=(20, 8), time=0.25)))
    np.testing.assert_allclose(parts.astype(int), whole, atol=1)


@pytest.mark.parametrize("name", NEEDS_ALL)
def test_what_needs_the_whole_picture_is_refused_in_parts(any_engine, folder, name):
    sketch = load(named(name).write(folder.path))
    with pytest.raises(PlaygroundError, match=r"cannot be drawn in parts: .*; choose a smaller picture"):
        list(strips(any_engine, sketch, SIZE, tile=(20, 8), time=0.1))


def named(name):
    family, _, name = name.partition(" ")
    return CASES[family][name]


@pytest.mark.parametrize("name", ["toy", "varying", "viewer"])
def test_a_shader_is_reduced_in_its_author_s_words(folder, name):
    case, _ = named(f"{'shadertoy' if name == 'toy' else 'main'} {name}").with_mistake()
    (item,) = inline_sketch(load(case.write(folder.path)), frame=SIZE).passes
    assert item.name == "shader" and "not_declared" in item.text
    assert set(item.text.splitlines()) <= set(case.files[f"{name}.frag"].splitlines())


@pytest.mark.parametrize("name", ["viewer_ripples", "viewer_pyramid", "viewer_conditions", "viewer_flood"])
def test_a_text_of_passes_is_reduced_whole(folder, name):
    case, _ = CASES["main"][name].with_mistake()
    (item,) = inline_sketch(load(case.write(folder.path)), frame=SIZE).passes
    lines = case.files[f"{name}.frag"].splitlines()
    assert item.text.splitlines() == [line for line in lines if line.strip()]


# ── what more must come of a shader ──────────────────────────────────────────


@pytest.mark.parametrize(
    "case", [case for case in (*RESULTS.values(), *EVERY) if "draws" in case.expected], ids=str
)
def test_a_picture_is_as_its_case_computes_it(any_engine, folder, case):
    path = case.write(folder.path)
    for draw in case.expected["draws"]:
        width, height = draw.get("size", SIZE)
        values = {name: tuple(v) if isinstance(v, list) else v for name, v in draw.get("set", {}).items()}
        picture = drawn(any_engine, path, draw.get("time", 0.0), (width, height), **values)
        column, row = np.arange(width), np.arange(height)[::-1, None]
        place = {"np": np, "x": (column + 0.5) / width, "y": (row + 0.5) / height, "column": column}
        for channel, level in enumerate(draw["is"]):
            expected = eval(level, place) if isinstance(level, str) else level
            off = np.abs(picture[..., channel] - expected).max()
            assert off <= draw.get("within", 0.5 + 2e-3), (draw, channel, picture[0, 0])


@each("case", [*RESULTS.values(), *(case for case in EVERY if case.expected)], ids=str)
def test_a_shader_declares_what_its_case_says(any_engine, tmp_path, case):
    wants = case.expected
    sketch = load(case.write(tmp_path / case.name))
    technique = sketch.graph.find("view").technique
    if "parameters" in wants:
        result = {p.name: p for p in technique.parameters}
        defaults = {k: tuple(v) if isinstance(v, list) else v for k, v in wants["parameters"].items()}
        assert {name: p.default for name, p in result.items()} == defaults
    for name, line in wants.get("lines", {}).items():
        assert [p.line for p in technique.parameters if p.name == name] == [line]
    for name, kind in wants.get("widgets", {}).items():
        assert [p.widget.kind for p in technique.parameters if p.name == name] == [kind]
    if "inputs" in wants:
        assert {item.name: item.shape for item in technique.inputs} == wants["inputs"]
    if "passes" in wants:
        assert [spec.name for spec in technique.passes] == wants["passes"]
    if "title" in wants:
        assert sketch.title == wants["title"]
    if "helpers" in wants:
        assert any(bool(kernel.helpers) for _, kernel in kernels_of(technique)) == wants["helpers"]
    if "sizes" in wants:
        steps = [s for s in any_engine.plan(sketch, (64, 36)).walk() if isinstance(s.kernel, ForeignShader)]
        assert {s.path: [*s.size, s.kernel.outputs[0].format] for s in steps} == wants["sizes"]
    if "stateful" in wants:
        assert (sketch.graph.find("view").repeat == "frames") == wants["stateful"]
    if "warnings" in wants:
        result = notes(sketch)
        assert len(result) == len(wants["warnings"]), result
        for note, parts in zip(result, wants["warnings"], strict=True):
            assert all(part in note.message for part in ([parts] if isinstance(parts, str) else parts)), note
        assert "warning_lines" not in wants or [note.line for note in result] == wants["warning_lines"]


@pytest.mark.parametrize("case", REFUSALS.values(), ids=str)
def test_a_refusal_names_what_is_wrong_and_where(any_engine, folder, case):
    with pytest.raises(PlaygroundError) as caught:
        drawn(any_engine, case.write(folder.path), size=(8, 8))
    (diagnostic, *more), wants = caught.value.diagnostics, case.expected
    assert not more or "not_declared" in diagnostic.message, "one message, but for a driver's"
    assert all(part in diagnostic.message for part in wants["error"]), diagnostic.message
    assert "\n" not in diagnostic.message and diagnostic.file.endswith(wants.get("file", ""))
    if "line" in wants:
        assert diagnostic.line == wants["line"]
    if "column" in wants:
        assert diagnostic.column == wants["column"]
    assert len(diagnostic.chain) == wants.get("chain", len(diagnostic.chain))
