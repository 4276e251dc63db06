"""Programs: compiled once, with errors in the kernel's own lines; only active uniforms are set."""

from __future__ import annotations

import pytest

from playground.engine.gl_calls import QUERY, WALL, Timer
from playground.engine.programs import Programs, compile_library, compile_wrapped
from playground.engine.tuning import Tuning
from playground.errors import ShaderError
from playground.shader.complaints import explain
from playground.shader.header import parse_kernel
from playground.shader.source import read_source
from playground.shader.wrap import FRAGMENT, wrap

KERNEL = """#pragma kernel(output = "a:r32f")
uniform float amount = 1.0;
uniform uint large = 4000000000u;
uniform bool switched = true;
uniform float idle;
float kernel(ivec2 texel) {
    return switched ? amount + float(large) : 0.0;
}
"""


@pytest.fixture
def kernel(tmp_path):
    def make(text: str = KERNEL):
        path = tmp_path / "k.glsl"
        path.write_text(text)
        return parse_kernel("k", read_source(path, (tmp_path,)))

    return make


@pytest.fixture
def programs(ctx):
    made = Programs(ctx, Tuning())
    made.frame += 1
    yield made
    made.release()


def test_a_text_is_compiled_once(programs, kernel):
    first = programs.get(kernel(), FRAGMENT)
    assert programs.get(kernel(), FRAGMENT) is first, "another object, the same text"
    assert programs.compiled == 1
    assert programs.get(kernel("// only a remark\n" + KERNEL), FRAGMENT) is not first
    assert list(programs.compile_times) == [kernel().path]
    assert programs.compile_times[kernel().path] > 0


def test_a_kernel_is_wrapped_once(programs, kernel, monkeypatch):
    import playground.engine.programs as module

    calls = []
    monkeypatch.setattr(module, "wrap", lambda *a: (calls.append(a), wrap(*a))[1])
    item = kernel()
    for _ in range(5):
        programs.get(item, FRAGMENT)
    assert len(calls) == 1


def test_what_the_driver_dropped_is_not_set(programs, kernel):
    program = programs.get(kernel(), FRAGMENT)
    assert "amount" in program.uniforms
    assert "idle" not in program.uniforms
    program.set("idle", 3.0)
    program.set("never_was", 3.0)
    program.set("amount", 0.25)
    program.set("large", 2**32 - 1)
    program.set("switched", False)
    assert program.uniforms["amount"].value == 0.25
    assert program.uniforms["large"].value == 2**32 - 1
    assert not program.uniforms["switched"].value


def test_programs_of_this_frame_stay_however_many(programs, kernel):
    used = [programs.get(kernel(KERNEL.replace("0.0", f"{i}.0")), FRAGMENT) for i in range(80)]
    assert len(programs) == 80
    assert len({id(p) for p in used}) == 80
    programs.frame += 1
    programs.get(kernel(KERNEL.replace("0.0", "1000.0")), FRAGMENT)
    assert len(programs) == 64


def test_a_wrong_text_is_reported_in_its_own_lines(ctx, kernel):
    with pytest.raises(ShaderError) as caught:
        compile_wrapped(ctx, wrap(kernel(KERNEL.replace("amount +", "amont +")), FRAGMENT))
    assert caught.value.diagnostics[0].line == 7
    assert ctx.error == "GL_NO_ERROR"


def test_a_wrong_text_is_tried_again(programs, kernel):
    wrong = kernel(KERNEL.replace("amount +", "amont +"))
    for _ in range(2):
        with pytest.raises(ShaderError):
            programs.get(wrong, FRAGMENT)
    assert len(programs) == 0


def test_a_link_error_has_at_least_its_file(kernel):
    wrapped = wrap(kernel(), FRAGMENT)
    text = (
        "GLSL Linker failed\n\nProgram\n=======\n"
        "error: fragment shader varying x not written by vertex shader\n"
    )
    error = explain(text, wrapped)
    assert error.diagnostics[0].file.endswith("k.glsl")
    assert "varying x" in error.diagnostics[0].message


def test_a_driver_that_gives_no_reason_is_reported_so(kernel):
    error = explain("GLSL Compiler failed\n\nfragment_shader\n===============\n", wrap(kernel(), FRAGMENT))
    assert "gave no reason" in str(error)
    assert error.diagnostics[0].file.endswith("k.glsl")


def test_compile_error_in_wrapper_lines_names_missing_kernel(kernel):
    wrapped = wrap(kernel(), FRAGMENT)
    last = wrapped.stages["fragment"].text.count("\n")
    log = (
        f"GLSL Compiler failed\n\nfragment_shader\n===============\n"
        f"0:{last}(3): error: no function with name 'kernel'\n"
    )
    first = explain(log, wrapped).diagnostics[0]
    assert first.line == 8 or first.line == 7
    assert "the file needs float kernel(ivec2 texel)" in first.message


def test_a_library_file_is_compiled_alone(ctx, tmp_path):
    good, bad = tmp_path / "good.glsl", tmp_path / "bad.glsl"
    good.write_text("float f(float x) { return x; }\n")
    bad.write_text("float f(float x) { return y; }\n")
    compile_library(ctx, read_source(good, (tmp_path,)))
    with pytest.raises(ShaderError) as caught:
        compile_library(ctx, read_source(bad, (tmp_path,)))
    assert caught.value.diagnostics[0].line == 1


def test_a_timer_adds_up_and_is_never_nested(ctx):
    software = "llvmpipe" in ctx.info["GL_RENDERER"]
    timer = Timer(ctx, queries=not software)
    assert timer.clock == (WALL if software else QUERY)
    times: dict[str, float] = {}
    for _ in range(2):
        with timer.measure(times, "a"):
            ctx.finish()
    assert times["a"] >= 0.0
    with (
        pytest.raises(RuntimeError, match="one stretch at a time"),
        timer.measure(times, "b"),
        timer.measure(times, "c"),
    ):
        pass
    with timer.measure(times, "d"):
        pass
    assert set(times) == {"a", "d"}
