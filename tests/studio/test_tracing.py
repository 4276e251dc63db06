"""Tracing in a session: which texel, when, what is beside it, probes; the picture stays as it is."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from imgui_bundle import imgui
from imgui_bundle.imgui_color_text_edit import TextEditor

from playground.engine.engine import Engine
from playground.engine.non_finite import NotFinite
from playground.engine.sandbox import SandboxReport, TrySketch, TryTrace
from playground.engine.trace.probe import Probe, ProbeMap, map_of
from playground.errors import SandboxTimeout, ShaderError
from playground.studio.code.panel import typing
from playground.studio.inspect.inspector import texel_of_map
from playground.studio.keys import close_one, open_layers
from playground.studio.trace.panel import state_of, trace_tab
from playground.studio.trace.rows import Row, TraceView
from playground.studio.trace.tracing import Beside, Compared, Spot, Tracing, complaint
from playground.studio.trace.values_panel import spark_points, word_at

from ..sketch_texts import map_of_height
from .hand_traces import march_trace
from .panel_desk import Bare, OpenBare
from .session_desk import OpenSession

TERRAIN = """// terrain.glsl -- steps, and a hole
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float steps(float x) {
    float sum = 0.0;
    for (int i = 0; i < 4; i++)
        sum += x / float(i + 1);
    return sum;
}
float kernel(ivec2 texel) {
    float x = float(texel.x) - 2.0;
    float root = sqrt(x);
    return level * (texel.y > 3 ? root : steps(x));
}
"""
ADD, ROOT, RETURN = 7, 12, 13
FILES = {"terrain.glsl": TERRAIN, "sketch.toml": "format = 1\nsize = [9, 6]\n" + map_of_height()}
SIZE = 90, 60
HARMONIC = 1 + 1 / 2 + 1 / 3 + 1 / 4

DocPos = TextEditor.DocPos

Begin = Callable[..., Tracing]


class Compiler:
    """A sandbox that answers when a test says so."""

    def __init__(self) -> None:
        self.requests: list[TrySketch | TryTrace] = []
        self.answer: SandboxReport | None = None

    def submit(self, request: TrySketch | TryTrace) -> None:
        self.requests.append(request)

    def poll(self) -> SandboxReport | None:
        answer, self.answer = self.answer, None
        return answer


@pytest.fixture
def begin(folder: Path, open_session: OpenSession) -> Begin:
    """Give what begins to trace a session on the folder's sketch, shown as a map."""

    def begin(**options: object) -> Tracing:
        session = open_session(folder)
        session.frame(SIZE)
        session.show("height:height")
        tracing = Tracing(session, now=lambda: 0.0, **options)  # type: ignore[arg-type]
        tracing.toggle()
        return tracing

    return begin


def frame(tracing: Tracing, count: int = 1) -> None:
    for _ in range(count):
        tracing.session.frame(SIZE)
        tracing.session.picture.rest = 0.0
        tracing.update(tracing.session.picture.texture)


def pixel_of(texel: tuple[int, int]) -> tuple[int, int]:
    """Return a pixel at which the map shows a texel."""
    pixels = ((x, y) for y in range(SIZE[1]) for x in range(SIZE[0]))
    return next(pixel for pixel in pixels if texel_of_map(pixel, SIZE, (9, 6)) == texel)


def trace_at(tracing: Tracing, texel: tuple[int, int]) -> None:
    tracing.point(pixel_of(texel))
    frame(tracing, 3)
    assert tracing.view is not None and tracing.view.trace.texel == texel


def view_rows(tracing: Tracing) -> tuple[Row, ...]:
    assert tracing.view is not None
    return tracing.view.rows(tracing.caret.file)


def value(tracing: Tracing, line: int, name: str) -> str:
    assert tracing.view is not None
    (item,) = [item for item in tracing.view.rows(tracing.caret.file)[line - 1].items if item.name == name]
    return item.text


def test_the_texel_under_the_mouse_is_traced(begin: Begin) -> None:
    tracing = begin()
    trace_at(tracing, (5, 1))
    assert tracing.spot == Spot("height", (5, 1)) and Path(tracing.caret.file).name == "terrain.glsl"
    assert float(value(tracing, ADD, "sum")) == pytest.approx(3 * HARMONIC, rel=1e-3)
    assert tracing.view is not None and tracing.view.trace.is_exact
    trace_at(tracing, (4, 0))
    assert float(value(tracing, RETURN, "→")) == pytest.approx(0.5 * 2 * HARMONIC, rel=1e-3)


def test_nothing_is_traced_again_while_nothing_changes(begin: Begin) -> None:
    tracing = begin()
    trace_at(tracing, (5, 1))
    before = tracing.last.count
    frame(tracing, 5)
    assert tracing.last.count == before and tracing.patience > 1e9


def test_a_pinned_texel_stays_until_the_mouse_is_followed(begin: Begin) -> None:
    tracing = begin()
    tracing.pin_at(pixel_of((5, 1)), SIZE)
    tracing.point(pixel_of((0, 0)))
    frame(tracing, 3)
    assert tracing.spot == Spot("height", (5, 1)) and tracing.is_pinned
    tracing.follow()
    trace_at(tracing, (0, 0))


def test_values_follow_a_save_and_stand_beside_those_before(begin: Begin, folder: Path) -> None:
    tracing = begin()
    tracing.pin_at(pixel_of((5, 1)), SIZE)
    frame(tracing, 3)
    tracing.compare(Beside.SAVE)
    (folder / "terrain.glsl").write_text(TERRAIN.replace("float(i + 1)", "float(i + 2)"), encoding="utf-8")
    tracing.session.drafts.reload()
    frame(tracing, 4)
    assert float(value(tracing, ADD, "sum")) == pytest.approx(3 * (HARMONIC - 1 + 1 / 5), rel=1e-3)
    tracing.go_to_difference()
    assert tracing.view is not None and tracing.caret.line == ADD
    (item,) = [i for i in tracing.view.rows(tracing.caret.file)[ADD - 1].items if i.parts]
    assert (item.text, item.other) == ("1.5", "3"), "the first of the four sums"


def test_a_kept_trace_stands_beside_that_of_another_texel(begin: Begin) -> None:
    tracing = begin()
    trace_at(tracing, (5, 1))
    tracing.keep()
    trace_at(tracing, (6, 1))
    assert tracing.view is not None
    row = tracing.view.rows(tracing.caret.file)[ADD - 1]
    assert [item.other for item in row.items] == [f"{3 * HARMONIC:.4g}"]
    assert "kept" in state_of(tracing)[0]


def test_values_follow_a_parameter(begin: Begin) -> None:
    tracing = begin()
    trace_at(tracing, (3, 1))
    tracing.session.drafts.set("height.level", 1.0)
    frame(tracing, 3)
    assert float(value(tracing, RETURN, "→")) == pytest.approx(HARMONIC, rel=1e-3)


def test_a_number_that_is_not_finite_is_gone_to(begin: Begin) -> None:
    tracing = begin()
    tracing.toggle()
    tracing.trace_not_finite(NotFinite("height", "height", (1, 4), "NaN", 4, (9, 6)))
    tracing.point((0, 0))
    frame(tracing, 3)
    assert tracing.on and tracing.caret.line == ROOT and value(tracing, ROOT, "root") == "NaN"
    trace_at_finite = Spot("height", (5, 1))
    tracing.follow()
    tracing.point(pixel_of(trace_at_finite.texel))
    frame(tracing, 3)
    tracing.go_to_not_finite()
    assert "NaN" in tracing.message


def test_nothing_is_traced_before_the_sandbox_has_compiled_it(begin: Begin) -> None:
    compiler = Compiler()
    tracing = begin(sandbox=compiler)
    tracing.pin_at(pixel_of((5, 1)), SIZE)
    frame(tracing, 4)
    (request,) = compiler.requests
    assert isinstance(request, TryTrace) and request.path == "height"
    assert tracing.view is None and tracing.compiler.compiles == "height" and tracing.patience < 1
    compiler.answer = SandboxReport(True)
    frame(tracing, 2)
    assert tracing.view is not None and not tracing.compiler.compiles
    trace = tracing.last.count
    tracing.pin_at(pixel_of((6, 1)), SIZE)
    frame(tracing, 4)
    assert tracing.last.count > trace and len(compiler.requests) == 1, "another texel needs no compiler"


def test_what_the_sandbox_could_not_run_is_never_run_here(begin: Begin) -> None:
    compiler = Compiler()
    tracing = begin(sandbox=compiler)
    tracing.pin_at(pixel_of((5, 1)), SIZE)
    frame(tracing, 2)
    compiler.answer = SandboxReport(False, SandboxTimeout("pass 'height' took longer than 10 s"))
    for texel in (5, 1), (6, 1), (7, 1):
        tracing.pin_at(pixel_of(texel), SIZE)
        frame(tracing, 3)
        assert tracing.view is None and "10 s" in tracing.message
    tracing.record("kernel")
    frame(tracing, 2)
    assert tracing.compiler.compiles, "another text may do"


def test_a_trace_changes_neither_picture_nor_counters(begin: Begin) -> None:
    tracing = begin()
    session = tracing.session
    tracing.toggle()
    frame(tracing, 3)
    engine = session.engine

    def state() -> tuple[object, ...]:
        picture = session.read()
        assert picture is not None
        record = engine.record
        return picture.array.tobytes(), dict(engine.runs), session.draws, record.ran, record.texels

    before = state()
    tracing.toggle()
    for texel in (5, 1), (1, 4), (7, 3):
        trace_at(tracing, texel)
    assert state() == before and tracing.last.count >= 3


def test_a_probe_is_shown_as_a_map_with_its_own_range(begin: Begin) -> None:
    tracing = begin()
    trace_at(tracing, (5, 1))
    tracing.caret.line, tracing.probe.expression = ADD, "sum"
    tracing.show_probe()
    frame(tracing, 3)
    assert tracing.spot == Spot("height", (5, 1)) and tracing.is_pinned, "the texel stays"
    tracing.follow()
    shown = tracing.session.view.map
    assert isinstance(shown, ProbeMap) and not tracing.session.error
    assert shown.value("lowest") == pytest.approx(-2 * HARMONIC)  # x = -2 in the first column
    assert shown.value("highest") == pytest.approx(6 * HARMONIC)
    assert shown.ref not in tracing.session.refs
    trace_at(tracing, (6, 1))
    assert tracing.view is not None and len(tracing.view.trace.calls_of("k_see")) == 0
    tracing.toggle()
    assert tracing.session.view.map is None


def test_the_first_texel_where_a_condition_holds_is_traced(begin: Begin) -> None:
    tracing = begin()
    trace_at(tracing, (0, 0))
    tracing.caret.line, tracing.probe.expression = ADD, "sum > 3.9"  # x = 2: its sums are 2, 3, 3.67, 4.17
    tracing.show_probe(find=True)
    frame(tracing, 5)
    assert tracing.spot == Spot("height", (4, 0)) and tracing.is_pinned
    (row,) = [row for row in view_rows(tracing) if row.number == ADD]
    assert [item.event.iterations for item in row.items] == [(3,)], "in the iteration where it first held"
    mark = tracing.mark(SIZE)
    assert mark is not None
    pixel = int(mark[0] * SIZE[0]), int(mark[1] * SIZE[1])
    assert texel_of_map(pixel, SIZE, (9, 6)) == (4, 0), "a cross stands there"
    assert "run 4" in tracing.probe.message and "20 texels" in tracing.probe.message  # 5 columns, 4 rows
    tracing.probe.expression = "sum > 100.0"
    tracing.show_probe(find=True)
    frame(tracing, 5)
    assert "every texel" in tracing.probe.message and tracing.spot == Spot("height", (4, 0))


def test_another_sketch_begins_with_nothing_chosen(begin: Begin, tmp_path: Path) -> None:
    tracing = begin()
    tracing.pin_at(pixel_of((5, 1)), SIZE)
    frame(tracing, 3)
    tracing.keep()
    (tmp_path / "other").mkdir()
    for name, text in FILES.items():
        (tmp_path / "other" / name).write_text(text, encoding="utf-8")
    tracing.session.open(tmp_path / "other")
    frame(tracing, 3)
    assert not tracing.is_pinned and tracing.compared.kept is None and tracing.other() is None
    assert "nothing is kept" in state_of(tracing)[0]


@pytest.mark.parametrize(
    ("line", "expression", "named"), [(9, "x", "line"), (ADD, "sum = 1.0", "only reads")]
)
def test_what_is_no_probe_says_why(begin: Begin, line: int, expression: str, named: str) -> None:
    tracing = begin()
    trace_at(tracing, (0, 0))
    tracing.caret.line, tracing.probe.expression = line, expression
    tracing.show_probe()
    assert named in tracing.probe.message and not isinstance(tracing.session.view.map, ProbeMap)


@pytest.mark.parametrize(
    ("expression", "named"), [("mat2(sum)", "no number"), ("summ", "summ"), ("sum.xy", "xy")]
)
def test_a_probe_says_why_it_does_not_compile(
    begin: Begin, any_engine: Engine, expression: str, named: str
) -> None:
    tracing = begin()
    probe = Probe("height", str(Path(tracing.session.path).parent / "terrain.glsl"), ADD, expression)
    assert tracing.session.sketch is not None
    with pytest.raises(ShaderError) as raised:
        any_engine.render(map_of(tracing.session.sketch, probe).of(tracing.session.sketch), size=(16, 9))
    text = complaint(raised.value, probe)
    assert named in text and "k_see" not in text


def test_a_probe_that_does_not_compile_leaves_the_picture(begin: Begin) -> None:
    compiler = Compiler()
    tracing = begin(sandbox=compiler)
    tracing.pin_at(pixel_of((5, 1)), SIZE)
    frame(tracing, 2)
    compiler.answer = SandboxReport(True)
    frame(tracing, 2)
    tracing.caret.line, tracing.probe.expression = ADD, "summ"
    tracing.show_probe()
    assert isinstance(compiler.requests[-1], TrySketch)
    compiler.answer = SandboxReport(False, SandboxTimeout("'summ' undeclared"))
    frame(tracing, 2)
    assert "summ" in tracing.probe.message and not isinstance(tracing.session.view.map, ProbeMap)


# ── the pane and the strip ────────────────────────────────────────────────────


def draw_too(bare: Bare, trace: Callable[[], object] = lambda: None) -> None:
    """Draw the strip with the trace's tab, and the code pane beside the picture."""
    bench, draw = bare.bench, bare.draw
    bench.tabs.append(trace_tab(bench.tracing))

    def with_trace() -> None:
        bench.follow_files()
        draw()
        trace()
        bare.draw_pane((700.0, 0.0, 580.0, 470.0))

    bare.draw = with_trace  # type: ignore[method-assign]


@pytest.mark.parametrize("wide", [1280, 900])
def test_the_pane_draws_all_that_a_trace_may_have(open_bare: OpenBare, folder: Path, wide: int) -> None:
    """Calls, loops, a comparison, what is not finite; the cursor's line is the trace's, and back."""
    file = folder / "march.glsl"
    one, other = march_trace(file=str(file)), march_trace(3.0, file=str(file))
    file.write_text("\n".join(one.files[str(file)]), encoding="utf-8")
    bare = open_bare(folder, size=(wide, 720))
    tracing = bare.bench.tracing
    tracing.on, tracing.compared = True, Compared(Beside.KEPT, other)
    tracing.view = TraceView(one, other=other)
    tracing.probe.message = "the map shows far behind line 4"
    draw_too(bare)
    event = one.first_not_finite()
    assert event is not None
    tracing.go_to(event)
    bare.run_frames(6)
    current = bare.bench.files.current
    assert current is not None and current.text.path == file and current.view is not None
    editor = current.view.editor  # type: ignore[attr-defined]
    assert editor.get_main_cursor_position().line == event.line - 1 and not typing(bare.bench.files)
    bare.click("≠ First difference")
    bare.run_frames(3)
    assert tracing.caret.line in (4, 5) and editor.get_main_cursor_position().line == tracing.caret.line - 1
    bare.click("##call", 0.0)
    head = tracing.view.rows(str(file))[0].head
    assert tracing.view.selection.calls and head is not None and head.number == 1
    bare.click("##spark", 0.0)
    assert 0 in tracing.view.selection.iterations.values()
    rows = tracing.view.rows(str(file))
    tracing.caret.line, tracing.caret.is_asked = next(row.number for row in rows if row.loops), True
    bare.click("##iteration 0", 0.97)
    (loop,) = tracing.view.rows(str(file))[tracing.caret.line - 1].loops
    assert loop.chosen == loop.count - 1 > 0
    bare.click("##plotted 0")
    bare.click(loop.names[-1])
    (loop,) = tracing.view.rows(str(file))[tracing.caret.line - 1].loops
    assert loop.plotted == loop.names[-1] != loop.names[0]
    tracing.caret.line, tracing.caret.is_asked = 1, True
    bare.click("##call of line", 0.97)
    head = tracing.view.rows(str(file))[0].head
    assert head is not None and head.number == head.count > 1
    editor.select_region(DocPos(3, 8), DocPos(3, 11))
    bare.run_frames(2)
    assert (tracing.caret.line, tracing.probe.expression) == (4, "far")
    tracing.message, tracing.view = "a texel that is not there", None
    bare.run_frames(2)


def test_words_and_series_of_the_window() -> None:
    code = "    sum += march.foot * rows[i].x;"
    assert code[slice(*word_at(code, code.index("foot")))] == "march.foot"
    assert code[slice(*word_at(code, code.index("march")))] == "march"
    assert code[slice(*word_at(code, code.index("rows")))] == "rows"
    assert word_at(code, 0) == (0, 0)
    points = spark_points((1.0, None, float("nan"), 3.0), (0.0, 0.0, 30.0, 14.0))
    assert [x for x, _, _ in points] == [0.0, 10.0, 20.0, 30.0]
    assert [finite for _, _, finite in points] == [True, None, False, True]
    assert points[0][1] > points[-1][1], "y goes down"


def test_t_opens_the_pane_and_the_strip_and_esc_closes_them(bare: Bare) -> None:
    bench = bare.bench
    bench.session.show("height:height")
    bench.panes.show_code(False)
    bench.panes.show_strip(shown=False)
    draw_too(bare, lambda: bench.tracing.update(bare.picture))
    bare.run_frames(4)
    bare.key(imgui.Key.t)
    assert bench.tracing.on and "a click on the picture pins" in state_of(bench.tracing)[0]
    bench.tracing.choice.pin = 0.5, 0.3
    bare.run_frames(6)
    assert bench.panes.code_is_open and bench.panes.is_open("strip", narrow=False)
    assert bench.tracing.view is not None and "bit for bit" in state_of(bench.tracing)[0]
    assert bench.files.current is not None and str(bench.files.current.text.path) == bench.tracing.caret.file
    assert {"Keep", "##turn", "##probe"} <= set(bare.places)
    bare.click("Keep")
    assert bench.tracing.compared.beside is Beside.KEPT
    assert open_layers(bench) == ["trace"]
    close_one(bench)
    bare.run_frames()
    assert not bench.tracing.on and not bench.panes.code_is_open
    assert not bench.panes.is_open("strip", narrow=False)
