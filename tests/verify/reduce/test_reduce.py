"""What is left of a sketch that fails is small, still fails in the same way, and says how to see it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from playground.cli import main
from playground.data.image_files import write_png
from playground.errors import SketchError
from playground.sketch.variants import NAME
from playground.verify.reduce import initial_case
from playground.verify.reduce.candidate import (
    CandidateProcess,
    Differs,
    DrawResult,
    DrawTask,
    DriverFailure,
    FailureKind,
    NotFinite,
    OffReference,
    Probe,
    Refused,
    Side,
)
from playground.verify.reduce.case import inline_sketch, record_text
from playground.verify.reduce.search import Search
from playground.verify.shots.references import reference_path

from ...loading import load
from ...shipped import of_each_kind

ROOT = Path(__file__).resolve().parents[3]
HEIGHT = '#pragma kernel(output = "height:r32f")\n'
PASS = '[[pass]]\nname = "height"\nuse = "./one"\n'


@pytest.fixture(scope="module")
def worker():
    with CandidateProcess(software=True, limit=60.0) as made:
        yield made


@pytest.fixture(scope="module")
def cached_worker():
    """Give a process that takes from Mesa's cache what is compiled already, for texts that compile."""
    environment = {"MESA_SHADER_CACHE_DISABLE": "false"}
    with CandidateProcess(software=True, limit=60.0, environment=environment) as made:
        yield made


@pytest.fixture
def warm(worker, monkeypatch):
    """Let the command draw in the process that is there, which it does not close."""
    monkeypatch.setattr(initial_case, "CandidateProcess", lambda **_: nullcontext(worker))


@pytest.fixture
def sketch(tmp_path, monkeypatch):
    """Write a sketch of a kernel, and go to its folder."""

    def write(kernel: str, body: str = PASS, name: str = "one.glsl", size: str = "size = 9") -> Path:
        folder = tmp_path / "terrain"
        folder.mkdir(exist_ok=True)
        (folder / name).write_text(kernel, encoding="utf-8")
        (folder / "sketch.toml").write_text(f"format = 1\n{size}\n{body}", encoding="utf-8")
        monkeypatch.chdir(tmp_path)
        return folder / "sketch.toml"

    return write


def shrink(
    path: Path,
    failure: FailureKind,
    worker: CandidateProcess,
    folder: Path,
    target: str = "height",
    frame: tuple[int, int] = (8, 8),
    tries: int = 0,
) -> Search:
    """Reduce a sketch to the end, or for so many tries."""
    folder.mkdir(exist_ok=True)
    case = inline_sketch(load(path), frame=frame).looking_at(target)
    probe = Probe(failure, [worker], folder, 60.0)
    finding = probe.find(case)
    assert finding is not None, "it fails to begin with"
    search = Search(case, finding, probe, tries=tries)
    assert search.run() or tries
    return search


def text_of(search: Search, name: str = "height") -> str:
    return next(item.text for item in search.best.live if item.name == name)


# ── what is not a number ─────────────────────────────────────────────────────


def layered(layers: int) -> str:
    """Return a kernel of many functions, with one line that makes NaN west of a meridian."""
    functions = "\n".join(
        f"float layer_{i}(vec2 place) {{\n    // hills of their own\n    float x = place.x * {i}.5;\n"
        f"    float y = place.y / {i}.25;\n    return 0.5 + 0.25 * sin(x + y);\n}}\n"
        for i in range(1, layers + 1)
    )
    calls = "\n    ".join(f"h += gain * layer_{i}(place);" for i in range(1, layers + 1))
    return f"""// terrain.glsl -- many layers, one of them wrong.
{HEIGHT}
uniform float gain = 0.5;  //! slider(0, 4) step(0.1) How much of each
uniform vec3 tint = vec3(1.0, 0.5, 0.25);  //! colour
{functions}
float kernel(ivec2 texel) {{
    vec2 place = vec2(texel) / vec2(size - 1);
    float h = 0.0;
    {calls}
    h += 0.1 * sqrt(place.x - 0.4);
    return h * tint.r;
}}
"""


@pytest.mark.slow
@pytest.mark.parametrize("layers", [1, pytest.param(16, marks=pytest.mark.slow)])
def test_of_many_lines_the_one_that_makes_nan_stays(sketch, worker, tmp_path, layers):
    text = layered(layers)
    assert layers == 1 or text.count("\n") > 100
    search = shrink(sketch(text), NotFinite(), worker, tmp_path / "scratch")
    left = text_of(search)
    assert "sqrt(place.x - 0.4)" in left or "sqrt(texel.x - 0.4)" in left
    assert search.best.lines <= 5, left
    assert search.best.settings == 0
    assert search.confirmed() is not None


DIVIDED = """    float apart = float(texel.x - 6) * float(texel.x - 6);
    if (texel.x == 6) apart = 1.0;
    float h = apart / apart;
    if (texel.y > 4) h += sqrt(-1.0 - h);
"""
WAVES = "    float h = 0.25 * sin(float(texel.x));\n    if (texel.y > 4) h += sqrt(h - 2.0);\n"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("anywhere", "body", "stays", "goes"),
    [(False, DIVIDED, ("sqrt", "texel.y"), ("texel.x",)), (True, WAVES, ("sqrt",), ("texel.y", "sin"))],
)
def test_a_nan_elsewhere_counts_only_where_it_may(sketch, worker, tmp_path, anywhere, body, stays, goes):
    """Without the line that keeps the divisor from zero there is NaN too, at another texel."""
    path = sketch(f"{HEIGHT}\nfloat kernel(ivec2 texel) {{\n{body}    return h;\n}}\n")
    left = text_of(shrink(path, NotFinite(anywhere=anywhere), worker, tmp_path / "scratch"))
    assert all(word in left for word in stays) and not any(word in left for word in goes)


def results(values) -> list[DrawResult]:
    return [DrawResult("drawn", values=np.array(values, np.float32))]


def test_not_finite_means_the_same_kind_in_no_new_place():
    failure = NotFinite()
    nan, inf = np.nan, np.inf
    before = failure.finding(results([[1, nan], [1, nan]]))
    assert before is not None
    assert failure.finding(results([[1, 2], [1, 2]])) is None
    for values, same in (
        ([[1, nan], [1, nan]], True),
        ([[1, 1], [1, nan]], True),
        ([[nan, nan], [1, 1]], False),
        ([[nan, nan], [nan, nan]], False),
        ([[1, inf], [1, inf]], False),
        ([[1, nan, 1]], True),  # another size: only the kind can be compared
    ):
        after = failure.finding(results(values))
        assert after is not None
        assert failure.same(before, after) == same, values


# ── what the compiler refuses ────────────────────────────────────────────────


@pytest.mark.slow
def test_a_compile_error_in_an_include_is_isolated(sketch, worker, tmp_path):
    path = sketch(
        f'#include "noise/hash.glsl"\n#include "own.glsl"\n{HEIGHT}float kernel(ivec2 t) {{\n'
        "    float h = 0.5;\n    if (t.x > 3) h = bent(vec2(t));\n    return h;\n}\n"
    )
    (path.parent / "own.glsl").write_text(
        "float straight(float x) { return x; }\n"
        "float bent(vec2 p) {\n    vec3 wide = vec3(p, 1.0);\n    return straight(wobble(wide.xy));\n}\n"
    )
    search = shrink(path, Refused("wobble"), worker, tmp_path / "scratch")
    assert "wobble" in text_of(search)
    assert search.best.lines <= 7
    assert set(search.best.texts()) == {"sketch.toml", "height.glsl"}
    assert "#include" not in text_of(search)


def test_another_message_is_another_failure():
    failure = Refused("undeclared")
    before = failure.finding([DrawResult("shader", ("`x' undeclared", "wrong type"))])
    assert before is not None
    for messages, same in (
        (("`x' undeclared",), True),
        (("`x' undeclared", "wrong type"), True),
        (("`y' undeclared",), False),
        (("`x' undeclared", "syntax error"), False),
    ):
        after = failure.finding([DrawResult("shader", messages)])
        assert after is not None
        assert failure.same(before, after) == same, messages
    assert failure.finding([DrawResult("shader", ("syntax error",))]) is None
    assert failure.finding([DrawResult("refused", ("`x' undeclared",))]) is None


# ── two ways to draw ─────────────────────────────────────────────────────────

VARIANT = """#pragma compute(groups = "(size.x + 7) // 8, (size.y + 7) // 8")
void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (texel.x >= size.x || texel.y >= size.y) return;
    float h = sin(float(texel.x) * 0.7) * 0.25;
    if (texel.x > 5) h += 0.125;
    imageStore(out_height, texel, vec4(h, 0.0, 0.0, 1.0));
}
"""


@pytest.mark.slow
def test_where_a_fast_variant_disagrees_only_its_defect_stays(sketch, worker, tmp_path):
    path = sketch(f"{HEIGHT}float kernel(ivec2 texel) {{ return sin(float(texel.x) * 0.7) * 0.25; }}\n")
    (path.parent / "one.comp").write_text(VARIANT)
    (path.parent / NAME).write_text(
        record_text({"one.comp": ((path.parent / "one.glsl").read_text(), VARIANT)})
    )
    if not worker.info.compute:
        pytest.skip("no compute shaders here")
    failure = Differs((Side(driver="fragment"), Side(driver="compute")), ("fragment", "compute"))
    search = shrink(path, failure, worker, tmp_path / "scratch")
    variant = search.best.live[-1].variant
    assert "if (texel.x > 5) h" in variant
    assert "sin" not in variant
    assert "sin" not in text_of(search)


def test_a_difference_is_of_the_same_kind_where_it_is_as_large():
    failure = Differs((Side(), Side()), ("one", "other"))

    def found(one, other):
        return failure.finding(results(one) + results(other))

    wide, last = found([[1, 2]], [[1, 2.5]]), found([[1, 2]], [[1, 2.0000002]])
    assert wide is not None
    assert last is not None
    assert wide.kind == "differs widely in places"
    assert last.kind == "differs in the last bits"
    assert not failure.same(wide, last)
    assert found([[1, np.nan]], [[1, np.nan]]) is None
    assert "not finite by one" in found([[1, np.nan]], [[1, 2]]).kind
    assert not failure.same(wide, found([[1, 2]], [[1.5, 2]])), "where they agreed they must agree"
    assert failure.finding(
        [DrawResult("drawn", values=np.zeros((1, 1), np.float32)), DrawResult("crash")]
    ).kind.startswith("only by other: crash")


@pytest.mark.slow
def test_two_environments_that_differ(sketch, tmp_path, capsys):
    """Mesa leaves an extension out where the environment says so, and its macro with it."""
    path = sketch(
        f"{HEIGHT}float kernel(ivec2 texel) {{\n    float h = float(texel.x) * 0.25;\n"
        "#ifdef GL_ARB_shading_language_packing\n    h += 0.5;\n#endif\n    return h + 1.0;\n}\n"
    )
    option = "MESA_EXTENSION_OVERRIDE=-GL_ARB_shading_language_packing"
    status = main(
        ["--software", "reduce", str(path), "--against", option, "--pass", "height", "--timeout", "60"]
    )
    assert status == 0, capsys.readouterr().err
    folder = tmp_path / "terrain-reduced"
    text = (folder / "height.glsl").read_text()
    assert "#ifdef GL_ARB_shading_language_packing" in text
    assert text.count("\n") <= 8
    readme = (folder / "README.txt").read_text()
    assert f"{option.partition('=')[0]}=-GL_ARB" in readme
    assert "Renderer 2:" in readme


# ── a shot ───────────────────────────────────────────────────────────────────

SHOT = '[[shot]]\nname = "noon"\nsize = [32, 18]\n'
BANDS = f"""{HEIGHT}uniform float rise = 0.5;  //! slider(0, 4)
float kernel(ivec2 texel) {{
    float h = rise * float(texel.x) / float(size.x);
    if (texel.x > 4 && texel.y > 4) {{
        h += 0.125;
    }}
    return h;
}}
"""
MAP = f'{PASS}[view]\nuse = "view/map"\ninputs = {{ shown = "height" }}\n{SHOT}'


@pytest.mark.slow
def test_reduced_shot_off_reference_keeps_edited_constant(sketch, worker, warm, tmp_path, capsys):
    path = sketch(BANDS, MAP)
    shot = load(path).shots[0]
    good = worker.draw(DrawTask(sketch=load(path), ref="", driver="auto", frame=shot.size))
    assert good.values is not None
    reference = reference_path(load(path), "noon", worker.info.slug)
    reference.parent.mkdir(parents=True)
    write_png(reference, good.values)
    assert main(["--software", "reduce", str(path), "--shot", "noon"]) == 2
    assert "is as its reference" in capsys.readouterr().err
    sketch(BANDS.replace("0.125", "0.375"), MAP)
    bad = worker.draw(DrawTask(sketch=load(path), ref="", driver="auto", frame=shot.size))
    search = shrink(
        path,
        OffReference(bad.values, [good.values], 1),
        worker,
        tmp_path / "scratch",
        "view",
        shot.size,
        tries=60,
    )
    assert "0.375" in text_of(search)
    assert search.best.lines < inline_sketch(load(path), frame=(8, 8)).lines
    assert search.finding.where.sum() == search.confirmed().where.sum() > 0


# ── the command ──────────────────────────────────────────────────────────────

MAGIC = (
    f"{HEIGHT}float magic(float x) {{ return x; }}\nfloat kernel(ivec2 t) {{ return magic(0.5) + 1.0; }}\n"
)
GREP = f"{sys.executable} -ISc \"import sys; sys.exit('magic(0.5)' in open('height.glsl').read())\""


def run(*arguments: str) -> int:
    return main(["reduce", *arguments])


@pytest.mark.slow
def test_a_command_judges_and_the_folder_says_how(sketch, tmp_path, capsys):
    path = sketch(MAGIC)
    assert run(str(path), "--pass", "height", "--command", GREP) == 0
    folder = tmp_path / "terrain-reduced"
    assert sorted(capsys.readouterr().out.split()) == sorted(
        f"terrain-reduced/{name}" for name in ("README.txt", "height.glsl", "reduced.json", "sketch.toml")
    )
    assert "magic(0.5)" in (folder / "height.glsl").read_text()
    assert (folder / "height.glsl").read_text().count("\n") == 3
    assert "Nothing more goes" in (folder / "README.txt").read_text()
    assert json.loads((folder / "reduced.json").read_text())["sketch"] == "terrain"
    # Once more, over what is our own; a note in it stays.
    (folder / "note.txt").write_text("mine")
    assert run(str(path), "--pass", "height", "--command", GREP) == 0
    assert (folder / "note.txt").read_text() == "mine"


def test_user_folder_is_refused_before_drawing(sketch, tmp_path, capsys):
    path = sketch(MAGIC)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("mine")
    assert run(str(path), "-o", "mine") == 2
    message = capsys.readouterr().err
    assert "nothing is overwritten" in message
    assert len(message.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--nan", "--drivers"], "only one thing can be what fails"),
        (["--anywhere"], "--anywhere is for --nan"),
        (["--error", "("], "no regular expression"),
        (["--against", "LP"], "expected ENV=VALUE"),
        (["--plain", "--nan"], "--plain is for what the compiler refuses"),
        (["--shot", "noon"], "no shot 'noon'"),
        (["--command", "exit 0"], "the command says that all is well"),
        (["--command", "exit 0", "--pass", "hight"], "did you mean 'height'"),
        (["--command", "kill -9 $$"], "expected 0 where all is well"),
        (["--shot", "one", "--set", "height.x=1"], "no shot"),
    ],
)
def test_a_mistake_is_one_sentence(sketch, capsys, options, message):
    assert run(str(sketch(MAGIC)), *options) == 2
    err = capsys.readouterr().err
    assert message in err
    assert "Traceback" not in err


def test_what_does_not_fail_is_refused(sketch, warm, capsys):
    assert main(["--software", "reduce", str(sketch(MAGIC)), "--pass", "height", "--timeout", "60"]) == 2
    assert "terrain does not fail: it compiles and draws" in capsys.readouterr().err


def test_ctrl_c_keeps_the_smallest_so_far(sketch, tmp_path, monkeypatch, capsys):
    find, tried = Probe.find, []

    def interrupted(probe, case):
        tried.append(case)
        if len(tried) == 14:
            raise KeyboardInterrupt
        return find(probe, case)

    path = sketch(MAGIC)
    monkeypatch.setattr(Probe, "find", interrupted)
    assert run(str(path), "--pass", "height", "--command", GREP) == 130
    text = (tmp_path / "terrain-reduced" / "height.glsl").read_text()
    assert "magic(0.5)" in text
    assert text.count("\n") < inline_sketch(load(path), frame=(8, 8)).looking_at("height").lines
    assert "stopped before" in (tmp_path / "terrain-reduced" / "README.txt").read_text()


def test_a_limit_of_tries_is_respected(sketch, tmp_path, capsys):
    assert run(str(sketch(MAGIC)), "--pass", "height", "--command", GREP, "--tries", "3") == 0
    assert "in 3 tries" in capsys.readouterr().err


# ── what kills the driver ────────────────────────────────────────────────────

# 2^17 terms in few lines: each is a candidate, and each crash costs a process.
SIXTEEN = "\n".join(f"#define M{i} " + " + ".join([f"M{i - 1}"] * 16) for i in range(1, 5))
TERMS = f"#define M0 x + x\n{SIXTEEN}"
LOOP = "\n    for (int i = 0; i < 65000; i++) x = fract(sin(x) * 43758.5);"


@pytest.mark.slow
def test_a_crash_of_the_compiler_stays(sketch, worker, tmp_path):
    path = sketch(
        f"{HEIGHT}uniform float gain = 1.0;\n{TERMS}\nfloat other(float x) {{ return x * gain; }}\n"
        "float kernel(ivec2 texel) { float x = float(texel.x); float y = other(x); return M4 + y; }\n"
    )
    before = worker.started
    search = shrink(path, DriverFailure("crash"), worker, tmp_path / "scratch")
    assert worker.started > before
    assert "M4" in text_of(search)
    assert "other" not in text_of(search)
    assert search.best.settings == 0


@pytest.mark.slow
def test_a_hang_stays(sketch, tmp_path):
    """llvmpipe stops a loop after 65,535 iterations, so it takes many of them to be slow.

    The process has answered once before: its first answer may take a minute.
    """
    with CandidateProcess(software=True, limit=1.0) as impatient:
        plain = sketch(f"{HEIGHT}float kernel(ivec2 texel) {{ return 1.0; }}\n")
        impatient.draw(DrawTask(sketch=str(plain), ref="", driver="fragment", frame=(8, 8)))
        path = sketch(
            f"{HEIGHT}float other(float x) {{ return x * 0.5; }}\nfloat kernel(ivec2 texel) {{\n"
            f"    float x = float(texel.x);{LOOP * 60}\n    return other(x);\n}}\n",
            size="size = 65",
        )
        folder = tmp_path / "scratch"
        folder.mkdir()
        case = inline_sketch(load(path), frame=(8, 8)).looking_at("height")
        probe = Probe(DriverFailure("hang"), [impatient], folder, 1.0)
        finding = probe.find(case)
        assert finding is not None
        search = Search(case, finding, probe, tries=12)
        search.run()
    assert search.best.lines < case.lines
    assert "65000" in text_of(search)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl-C is sent otherwise there")
def test_ctrl_c_from_a_terminal_keeps_the_smallest(sketch, tmp_path):
    path = sketch(layered(16))
    with subprocess.Popen(
        [sys.executable, "-m", "playground", "--software", "reduce", str(path), "--nan", "--pass", "height"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as process:
        assert process.stderr is not None
        assert "NaN in places" in process.stderr.readline()
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=120)
    assert process.returncode == 130
    assert "height.glsl" in out
    assert "sqrt" in (tmp_path / "terrain-reduced" / "height.glsl").read_text()


WITH_VARIANTS = ("soft_cone", "fault_formation", "splat")
NOT_INLINED = {
    **dict.fromkeys(("desert", "fluid", "hydraulic"), "a loop of several passes"),
    **dict.fromkeys(
        ("alpine", "eroded_mountains", "rivers", "stream_power", "thermal"), "has a size for each step"
    ),
    **dict.fromkeys(("channels", "flood", "from_elsewhere"), "another tool's shader among other passes"),
}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(n, marks=[] if n in WITH_VARIANTS else [pytest.mark.slow])
        for n in sorted({*of_each_kind(), *WITH_VARIANTS} - NOT_INLINED.keys())
    ],
)
def test_inlined_shipped_sketch_has_same_passes(name, tmp_path):
    case = inline_sketch(load(name), frame=(64, 36))
    Probe(NotFinite(), [], tmp_path, 1.0).write(case)
    again = inline_sketch(load(tmp_path / "sketch.toml"), frame=(64, 36))
    assert [pass_.name for pass_ in again.passes] == [item.name for item in case.live]
    assert [pass_.text for pass_ in again.passes] == [item.text for item in case.live]
    assert [pass_.size for pass_ in again.passes] == [item.size for item in case.live]
    assert [dict(pass_.values) for pass_ in again.passes] == [dict(item.values) for item in case.live]
    assert [dict(pass_.inputs) for pass_ in again.passes] == [dict(item.inputs) for item in case.live]


@pytest.mark.parametrize("name", NOT_INLINED)
@pytest.mark.room("dialects")
def test_what_cannot_be_inlined_is_one_sentence(name):
    with pytest.raises(SketchError, match=NOT_INLINED[name]):
        inline_sketch(load(name), frame=(64, 36))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["soft_cone", "diamond_square", "splat"])
def test_a_shipped_sketch_inlined_draws_the_same_picture(name, cached_worker, tmp_path):
    sketch = load(name).with_values({"size": 65})
    frame = (64, 36)
    case = inline_sketch(sketch, frame=frame)
    Probe(NotFinite(), [], tmp_path, 1.0).write(case)
    whole = cached_worker.draw(DrawTask(sketch=sketch, ref="", driver="fragment", frame=frame))
    again = str(tmp_path / "sketch.toml")
    flat = cached_worker.draw(DrawTask(sketch=again, ref="", driver="fragment", frame=frame))
    assert whole.kind == flat.kind == "drawn", flat.details
    np.testing.assert_array_equal(flat.values, whole.values)
