"""The values of a texel beside the code: hints at lines' ends, iterations in the hover."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import playground
from playground.engine.trace.live_texel import LiveTexel, live_file, write_live_texel
from playground.engine.trace.model import Event
from playground.lsp.documents import Documents
from playground.lsp.highlight import influence
from playground.paths import NAME, SKETCHES
from playground.shader.outline import outline
from playground.sketch.assign import values_of
from playground.sketch.edited import root_for, shader_at
from playground.sketch.load import load
from playground.sketch.model import kernels_of

from .client import PATIENCE, Editor
from .test_language import place

KERNEL = """// hill.glsl -- sums.
// trace: 3 5
#pragma kernel(output = "height:r32f")
uniform float gain = 2.0;  //! slider(0, 4)
float twice(float x) {
    return 2.0 * x;
}
float kernel(ivec2 texel) {
    float sum = 0.0;
    for (int i = 0; i < 4; ++i) {
        sum += twice(float(i)) * gain;
    }
    if (texel.x > 2) sum += float(texel.y);
    return sum * 0.01;
}
"""
SKETCH = """format = 1
size = 33
extent = 320.0
relief = 100.0

[[pass]]
name = "height"
use = "./hill"
set = { gain = 0.5 }
"""


@pytest.fixture(scope="module")
def traced(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Editor]:
    folder = tmp_path_factory.mktemp("traced") / "work"
    folder.mkdir()
    (folder / "sketch.toml").write_text(SKETCH)
    (folder / "hill.glsl").write_text(KERNEL)
    with Editor(folder, XDG_STATE_HOME=str(folder.parent / "state")) as editor:
        yield editor


@pytest.fixture
def hill(traced: Editor) -> Iterator[str]:
    """A kernel's URI; what a test opened is closed again."""
    yield (traced.folder / "hill.glsl").as_uri()
    for uri in list(traced.versions):
        traced.close(uri)
        del traced.versions[uri]


def hints_when(editor: Editor, uri: str, fits: Callable[[dict[int, str]], bool]) -> dict[int, str]:
    """Wait until the hints of a text fit; return that of each line, from 1."""
    end = time.monotonic() + PATIENCE
    while not fits(result := hints_now(editor, uri)) and time.monotonic() < end:
        time.sleep(0.05)
    assert fits(result), result
    return result


def hints_now(editor: Editor, uri: str) -> dict[int, str]:
    whole = {"start": {"line": 0, "character": 0}, "end": {"line": 999, "character": 0}}
    result = editor.ask("textDocument/inlayHint", textDocument={"uri": uri}, range=whole)
    return {hint["position"]["line"] + 1: hint["label"] for hint in result or ()}


def opened(editor: Editor, uri: str) -> dict[int, str]:
    editor.open(uri, KERNEL)
    return hints_when(editor, uri, bool)


def said(editor: Editor) -> list[str]:
    shown = [note["params"] for note in editor.notes if note["method"] == "window/showMessage"]
    return [params["message"] for params in shown]


def test_a_comment_s_texel_has_its_values_at_the_ends_of_lines(traced: Editor, hill: str) -> None:
    """In the sketch of its folder the gain is 0.5: the sum of 2 i gain is 6, and 5 is added."""
    result = opened(traced, hill)
    assert result[9] == "sum = 0"
    assert result[10] == "i = 0 | 1 | 2 | 3"
    assert result[11] == "sum = 0 | 1 | 3 | 6"
    assert "sum = 11" in result[13] and "true" in result[13]
    assert result[14] == "→ 0.11"
    assert result[6] == "→ 0 | 2 | 4 | 6"
    assert not {1, 2, 3, 4, 12} & result.keys()
    hover = traced.at("hover", hill, *place(KERNEL, "sum +="))["contents"]["value"]
    for row in ("sum = 0    kernel, iteration 0", "sum = 6    kernel, iteration 3"):
        assert row in hover
    assert said(traced) == []


def test_a_line_that_is_typed_in_has_no_value_until_it_is_traced(traced: Editor, hill: str) -> None:
    opened(traced, hill)
    before = len(traced.notes)
    traced.type(hill, KERNEL.replace("    return sum * 0.01;", "    // one more\n    return sum * 0.02;"))
    soon = hints_now(traced, hill)
    assert 14 not in soon and 15 not in soon and soon[11] == "sum = 0 | 1 | 3 | 6"
    hints_when(traced, hill, lambda hints: hints.get(15) == "→ 0.22")
    traced.note(lambda message: message["method"] == "workspace/inlayHint/refresh", before)
    traced.type(hill, KERNEL.replace("// trace: 3 5\n", ""))
    hints_when(traced, hill, lambda hints: not hints)


def test_a_text_that_does_not_compile_has_diagnostics_alone(traced: Editor, hill: str) -> None:
    opened(traced, hill)
    traced.type(hill, KERNEL.replace("sum = 0.0;", "sum = 0.0"))
    hints_when(traced, hill, lambda hints: not hints)
    assert said(traced) == []


@pytest.mark.parametrize(
    ("comment", "words"),
    [
        ("// trace: 12", ("'12'", "X Y", "hill.glsl:2")),
        ("// trace: 99 1", ("99", "33")),
        ("// trace: 1 1 of nowhere", ("nowhere", "height")),
        ("// trace: 1 1 in no_such_sketch", ("no_such_sketch",)),
    ],
)
def test_what_cannot_be_traced_is_said_once(
    traced: Editor, hill: str, comment: str, words: tuple[str, ...]
) -> None:
    before = len(traced.notes)
    traced.open(hill, KERNEL.replace("// trace: 3 5", comment))
    note = traced.note(lambda message: message["method"] == "window/showMessage", before)
    assert all(word in note["params"]["message"] for word in words), note["params"]["message"]
    count = len(said(traced))
    before = len(traced.notes)
    traced.type(hill, KERNEL.replace("// trace: 3 5", comment) + "\n// more\n")
    traced.diagnostics(hill, 2, before)
    assert len(said(traced)) == count


@pytest.mark.slow
def test_the_window_s_texel_is_shown_in_every_file_of_its_pass(traced: Editor, hill: str) -> None:
    """The file that a window writes names pass, texel and values; an included file has hints, too."""
    library = traced.folder / "twice.glsl"
    library.write_text(
        "#ifndef TWICE\n#define TWICE\nfloat twice(float x) {\n    return 2.0 * x;\n}\n#endif\n"
    )
    head, _, tail = KERNEL.replace("// trace: 3 5\n", '#include "twice.glsl"\n').partition("float twice")
    text = head + tail.partition("}\n")[2]
    (traced.folder / "hill.glsl").write_text(text)
    sketch = str(traced.folder / "sketch.toml")
    live = LiveTexel(sketch, "height", (0, 4), size=(64, 36), values=(("height.gain", 3.0),))
    for uri, own in ((hill, text), (library.as_uri(), library.read_text())):
        traced.open(uri, own)
    file = live_file(traced.folder.parent / "state" / NAME)
    write_live_texel(live, file)
    hints_when(traced, hill, lambda hints: hints.get(8) == "sum = 0 | 6 | 18 | 36")
    hints_when(traced, library.as_uri(), lambda hints: hints.get(4) == "→ 0 | 2 | 4 | 6")
    write_live_texel(None, file)
    hints_when(traced, hill, lambda hints: not hints)
    library.unlink()


def test_shipped_texts_have_no_trace() -> None:
    folder: Path = SKETCHES.parent
    assert not [path for path in folder.rglob("*.glsl") if "// trace:" in path.read_text(encoding="utf-8")]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["diamond_square_steps", "rivers", "lighting_beams", "sun_disc"])
def test_all_values_that_a_uniform_changes_are_on_its_lines(name: str) -> None:
    """The truth is two traces of a texel, one of them with another value of the uniform."""
    changed = 0
    sketch = load(name).with_values({"size": 65})
    values = values_of(sketch)
    with playground.headless() as engine:
        for path, kernel in list(kernels_of(sketch.graph))[:6]:
            file = Path(kernel.path)
            for parameter in [
                p for p in kernel.parameters if p.type in ("float", "int") and p.file == kernel.path
            ]:
                own = f"{path}.{parameter.name}"
                other = values[own] + 1 if parameter.type == "int" else values[own] * 0.83 + 0.01
                try:
                    traces = [
                        engine.trace(sketch, path, texel=(5, 7), function="all", size=(64, 36), values=some)
                        for some in ({}, {own: other})
                    ]
                except playground.PlaygroundError:
                    continue  # a pass without a fragment shader, or a value that is out of its range
                shader = shader_at(file, file.read_text(encoding="utf-8"), root_for(file), Documents())
                at = next(each.at for each in outline(shader.text) if each.name == parameter.name)
                texts = dict(shader.files)
                lines = {
                    (str(place), texts[place].count("\n", 0, start) + 1 + more)
                    for place, start, end in influence(shader, parameter.name, at) or ()
                    for more in range(texts[place].count("\n", start, end) + 1)
                }
                one, two = (
                    {place: [repr(e.value) for e in events] for place, events in by_place(t).items()}
                    for t in traces
                )
                different = {place for place in one.keys() | two.keys() if one.get(place) != two.get(place)}
                assert {(file, line) for file, line, _ in different} <= lines, own
                changed += len(different)
    assert changed > 5


def by_place(trace: playground.Trace) -> dict[tuple[str, int, int], list[Event]]:
    places: dict[tuple[str, int, int], list[Event]] = {}
    for event in trace.events:
        if event.value is not None:
            places.setdefault((event.path, event.line, event.column), []).append(event)
    return places
