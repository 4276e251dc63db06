"""What would kill the driver kills the sandbox's worker, and the next request works."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import textwrap
import threading
import time
from dataclasses import replace
from pathlib import Path

import pytest

from playground import cli
from playground.engine.planner import smallest_terrain
from playground.engine.sandbox import Sandbox, SandboxReport, TryLibrary, TrySketch, TryTrace, reading_seconds
from playground.errors import SandboxCrash, SandboxTimeout, ShaderError

from ..loading import load
from ..sketch_texts import passes

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 90.0  # [s] for what happens soon on any machine that is not busy
GOOD = """#pragma kernel(output = "a:r32f")
float kernel(ivec2 texel) { return float(texel.x); }
"""
# Each macro doubles the one before: 2**18 additions from a few hundred bytes.
DOUBLING = "\n".join(["#define M0 x"] + [f"#define M{i} M{i - 1} + M{i - 1}" for i in range(1, 19)])
CRASH = f"""#pragma kernel(output = "a:r32f")
{DOUBLING}
float kernel(ivec2 texel) {{ float x = float(texel.x); return M18; }}
"""
# llvmpipe stops every loop after 65,535 iterations, nested ones together: slowness takes many in a row,
# and to be slower than any limit here, the whole again and again.
LOOP = "for (int i = 0; i < 65000; i++) x = fract(sin(x) * 43758.5);"
SLOW = f"""#pragma kernel(output = "a:r32f", repeat = "1000")
float kernel(ivec2 texel) {{
    float x = float(texel.x);
    {LOOP * 60}
    return x;
}}
"""


def is_alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def is_gone(pid: int) -> bool:
    """Wait until a process is gone; say whether it is."""
    end = time.monotonic() + PATIENCE
    while is_alive(pid) and time.monotonic() < end:
        time.sleep(0.02)
    return not is_alive(pid)


def wait(sandbox: Sandbox) -> SandboxReport:
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if (report := sandbox.poll()) is not None:
            return report
        time.sleep(0.005)
    raise AssertionError("no answer")


@pytest.fixture(scope="module")
def sandbox():
    with Sandbox(limit_seconds=PATIENCE) as made:
        yield made


@pytest.mark.slow
def test_a_good_sketch_is_good_by_both_drivers(sandbox, folder):
    report = sandbox.run(TrySketch(folder.one(GOOD), drivers=("fragment", "compute")))
    assert report.ok, report.error
    assert report.error is None


def test_the_worker_is_warm(sandbox, folder):
    """The same process answers, mistakes between or not: only its first answer waits for a context."""
    sandbox.run(TrySketch(folder.one(GOOD)))
    pid = sandbox.pids[0]
    assert not sandbox.run(TrySketch(folder.one(GOOD.replace("texel.x", "wrong")))).ok
    assert sandbox.run(TrySketch(folder.one(GOOD.replace("texel.x", "texel.y")))).ok
    assert sandbox.pids[0] == pid


def test_a_mistake_comes_back_with_its_place(sandbox, folder):
    report = sandbox.run(TrySketch(folder.one(GOOD.replace("texel.x", "wrong"))))
    assert not report.ok
    assert isinstance(report.error, ShaderError)
    assert report.error.diagnostics[0].line == 2
    assert sandbox.run(TrySketch(folder.one(GOOD))).ok


def test_it_tries_the_smallest_terrain_that_is_accepted(sandbox, folder):
    """A kernel that takes powers of two only is tried small: whole, its two textures take 8 GiB."""
    kernel = GOOD.replace('r32f"', 'rgba32f", accepts = "2**n", repeat = "log2(size.x)"')
    kernel = kernel.replace("float kernel", "vec4 kernel").replace("float(texel.x)", "vec4(1)")
    sketch = folder.one(kernel, size="size = 16384")
    assert smallest_terrain(sketch) == (64, 64)
    report = sandbox.run(TrySketch(sketch))
    assert report.ok, report.error


COUNTS = """#pragma kernel(output = "a:r32f")
uniform sampler2D own;  //! input("zero")
float kernel(ivec2 texel) { return texelFetch(own, texel, 0).r + 1.0; }
"""
AFTER = """#pragma kernel(output = "b:r32f")
uniform sampler2D count;  //! input
float kernel(ivec2 texel) { return texelFetch(count, texel, 0).r + 1.0; }
"""
COUNTING = passes(counted=("./counts", 'repeat   = "frames"', 'feedback = { own = "a" }'))


@pytest.mark.parametrize("wrong", [False, True])
def test_late_time_of_stateful_sketch_is_tried_at_earlier_time(sandbox, folder, wrong):
    """Its 900,000 frames take minutes; what comes after them is drawn all the same."""
    folder.write("counts.glsl", COUNTS)
    folder.write("after.glsl", AFTER.replace("1.0", "1.0 / 0.0") if wrong else AFTER)
    view = '[view]\nuse = "./after"\ninputs = { count = "counted" }\n'
    sketch = load(folder.write("sketch.toml", f"format = 1\nsize = 8\n{COUNTING}{view}"))
    late = TrySketch(sketch, time=15_000.0, refuses="all")
    report = sandbox.run(late)
    assert report.ok is not wrong, report.error
    assert report.seconds < 20.0, "as long as all frames"


def test_unpicklable_request_is_reported_and_next_one_works(sandbox, folder):
    report = sandbox.run(replace(TrySketch(folder.one(GOOD)), drivers=lambda: None))
    assert not report.ok
    assert re.fullmatch(r"the sandbox failed: \w+: .*(pickle|local object).*", str(report.error))
    assert sandbox.run(TrySketch(folder.one(GOOD))).ok


def test_a_library_file_is_compiled_alone(sandbox, folder):
    good = folder.write("lib.glsl", "float twice(float x) { return 2.0 * x; }\n")
    bad = folder.write("bad.glsl", "float twice(float x) {\n return 2.0 * y; }\n")
    assert sandbox.run(TryLibrary(str(good), str(folder.path))).ok
    report = sandbox.run(TryLibrary(str(bad), str(folder.path)))
    assert report.error is not None
    assert report.error.diagnostics[0].line == 2


def test_what_crashes_the_compiler_kills_the_worker_only(sandbox, folder):
    report = sandbox.run(TrySketch(folder.one(CRASH)))
    assert not report.ok
    assert isinstance(report.error, SandboxCrash)
    assert sandbox.run(TrySketch(folder.one(GOOD))).ok


def at_work(sandbox: Sandbox, request: TrySketch) -> int:
    """Submit a request, wait until the child is in the middle of a pass, and return its process."""
    task = sandbox.submit(request)
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        assert sandbox.poll() is None
        if task.progress is not None:
            return sandbox.pids[0]
        time.sleep(0.005)
    raise AssertionError("it did not begin")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "message"),
    [
        ("SIGSEGV", "pass 'a' crashed the driver or its compiler in the sandbox (SIGSEGV)"),
        ("SIGKILL", "pass 'a' was killed by the system in the sandbox (SIGKILL); did memory run out?"),
    ],
)
def test_a_crash_says_how_and_where(sandbox, folder, number, message):
    assert sandbox.run(TrySketch(folder.one(GOOD))).ok
    os.kill(at_work(sandbox, TrySketch(folder.one(SLOW))), signal.Signals[number])
    report = wait(sandbox)
    assert isinstance(report.error, SandboxCrash)
    assert report.error.diagnostics[0].message == message
    assert report.error.diagnostics[0].file == str(folder.path / "one.glsl")
    assert sandbox.run(TrySketch(folder.one(GOOD))).ok


@pytest.mark.slow
def test_a_worker_that_died_is_replaced_before_it_is_needed(sandbox, folder):
    report = sandbox.run(TrySketch(folder.one(CRASH)))
    assert isinstance(report.error, SandboxCrash)
    pid = sandbox.pids[0]
    assert is_alive(pid)
    assert sandbox.run(TrySketch(folder.one(GOOD))).ok
    assert sandbox.pids[0] == pid


@pytest.mark.slow
def test_a_worker_that_dies_idle_costs_nobody_an_answer(sandbox, folder):
    """It is dead when it is handed something, or dies just then: another is asked."""
    assert sandbox.run(TrySketch(folder.one(GOOD))).ok
    os.kill(sandbox.pids[0], signal.SIGKILL)
    report = sandbox.run(TrySketch(folder.one(GOOD)))
    assert report.ok, report.error


@pytest.mark.slow
@pytest.mark.parametrize(("kills", "is_tried"), [(1, True), (2, True), (99, False)])
def test_a_worker_killed_while_it_starts_is_tried_again(folder, kills, is_tried):
    request, killed = TrySketch(folder.one(GOOD), (32, 32)), []

    def kill() -> None:
        for pid in sandbox.pids:
            if len(killed) < kills and pid not in killed:
                killed.append(pid)
                os.kill(pid, signal.SIGKILL)

    with Sandbox() as sandbox:
        sandbox.while_waiting = kill
        report = sandbox.run(request)
        assert report.ok is is_tried
        if not is_tried:
            assert len(killed) == 3, "an end is put to it"
            assert "starting the process that draws crashed: the process was ended" in str(report.error)


MONSTERS = {
    "thirty macros, each twice the one before": "\n".join(
        ["#define M0 x"] + [f"#define M{i} M{i - 1} + M{i - 1}" for i in range(1, 31)]
    )
    + "\nfloat run(float x) { return M30; }",
    "twenty thousand lines, one after the other": "float run(float x) {\n"
    + "\n".join(f"x = fract(x * 1.{i} + {i}.5);" for i in range(20000))
    + "\nreturn x; }",
    "an array of a gigabyte": "float big[250000000];\n"
    "float run(float x) { big[int(x) * 1000] = 1.0; return big[int(x) * 77]; }",
}


@pytest.mark.always
@pytest.mark.slow
@pytest.mark.parametrize("name", MONSTERS)
def test_pathological_shader_is_stopped_or_crashes_and_next_runs(folder, name):
    kernel = GOOD.replace("float kernel", f"{MONSTERS[name]}\nfloat kernel").replace(
        "float(texel.x)", "run(float(texel.x))"
    )
    with Sandbox(limit_seconds=PATIENCE, memory_bytes=2**30) as sandbox:
        assert sandbox.run(TrySketch(folder.one(GOOD))).ok
        sandbox.limit_seconds = 1.5
        report = sandbox.run(TrySketch(folder.one(kernel)))
        assert isinstance(report.error, SandboxTimeout | SandboxCrash), report
        assert report.error.diagnostics[0].message.startswith("pass 'a' ")
        sandbox.limit_seconds = PATIENCE
        assert sandbox.run(TrySketch(folder.one(GOOD))).ok


def test_a_long_text_is_no_mistake(sandbox, folder):
    lines = "\n".join(f"float f{i}(float x) {{ return fract(x * 1.{i}); }}" for i in range(2000))
    report = sandbox.run(TrySketch(folder.one(GOOD.replace("float kernel", f"{lines}\nfloat kernel"))))
    assert report.ok, report.error


def test_what_takes_too_long_is_stopped(sandbox, folder, monkeypatch):
    assert sandbox.run(TrySketch(folder.one(GOOD))).ok
    pid = sandbox.pids[0]
    with monkeypatch.context() as patch:
        patch.setattr(sandbox, "limit_seconds", 0.7)
        report = sandbox.run(TrySketch(folder.one(SLOW)))
    assert isinstance(report.error, SandboxTimeout)
    assert "pass 'a' took longer than 0.7 s in the sandbox, in processor time" in str(report.error)
    assert "it is slow, or a loop does not end" in str(report.error)
    assert report.error.diagnostics[0].file.endswith("one.glsl")
    assert is_gone(pid)
    assert sandbox.run(TrySketch(folder.one(GOOD))).ok


def test_a_trace_is_tried_and_its_refusal_told(sandbox, folder):
    sketch = folder.one(GOOD)
    assert sandbox.run(TryTrace(sketch, "a")).ok
    assert sandbox.run(TryTrace(sketch, "a", "all")).ok
    assert "'b'" in str(sandbox.run(TryTrace(sketch, "b")).error)
    assert "'steps'" in str(sandbox.run(TryTrace(sketch, "a", "steps")).error)


@pytest.mark.slow
def test_check_takes_a_limit_and_names_it_where_it_is_passed(folder, capsys):
    path = folder.write("slow.glsl", SLOW)
    assert cli.main(["check", "--limit", "0.1", str(path)]) == 1
    result = capsys.readouterr().out
    assert "took longer than 0.1 s" in result and "--limit 0.2 gives it more time" in result
    assert "endless" not in result
    assert cli.main(["check", "--limit", "300", str(folder.write("good.glsl", GOOD))]) == 0


@pytest.mark.slow
def test_the_pass_that_takes_too_long_is_the_one_that_is_named(sandbox, folder, monkeypatch):
    """A driver draws later than it is called: the quick passes after a slow one are not to blame."""
    reads = "uniform sampler2D from; //! input\n"
    after = GOOD.replace("float kernel", f"{reads}float kernel").replace(
        "float(texel.x)", "texelFetch(from, texel, 0).r"
    )
    folder.write("slow.glsl", SLOW.replace("1000", "1"))  # one draw, which is only queued
    folder.write("after.glsl", after)
    sketch = folder.sketch(
        passes(slow=("./slow", "size = 257"), after=("./after", 'inputs = { from = "slow" }'))
    )
    assert sandbox.run(TrySketch(folder.one(GOOD))).ok
    with monkeypatch.context() as patch:
        patch.setattr(sandbox, "limit_seconds", 0.7)
        report = sandbox.run(TrySketch(sketch, drivers=("fragment", "auto")))
    assert isinstance(report.error, SandboxTimeout)
    assert "pass 'slow' took longer than 0.7 s by the fragment driver" in str(report.error)
    assert report.error.diagnostics[0].file.endswith("slow.glsl")


@pytest.mark.slow
def test_submit_never_waits_and_the_newest_wins(folder):
    # Large requests: a pipe that is not read would fill.
    padding = "\n".join(f"// {i} {'x' * 100}" for i in range(3000))
    wrong = [
        TrySketch(folder.one(GOOD.replace("texel.x", f"wrong{number}") + padding)) for number in range(20)
    ]
    with Sandbox(limit_seconds=PATIENCE) as sandbox:
        assert sandbox.run(TrySketch(folder.one(GOOD))).ok
        pid = sandbox.pids[0]
        at_work(sandbox, TrySketch(folder.one(SLOW)))
        for request in wrong:
            sandbox.submit(request)
        assert sandbox.busy and sandbox.pids[0] == pid and is_alive(pid), "nothing waited for the child"
        report = wait(sandbox)
        assert "wrong19" in str(report.error), "within the limit: the child that hung was killed for it"
        assert sandbox.pids[0] != pid and is_gone(pid)
        assert not sandbox.busy
        assert sandbox.poll() is None


@pytest.mark.slow
def test_slow_worker_has_spare_ready_to_replace_it(folder):
    with Sandbox(limit_seconds=3600.0) as sandbox:
        assert sandbox.run(TrySketch(folder.one(GOOD))).ok
        first = at_work(sandbox, TrySketch(folder.one(SLOW)))
        end = time.monotonic() + PATIENCE
        while len(sandbox.pids) < 2 and time.monotonic() < end:
            assert sandbox.poll() is None
            time.sleep(0.005)
        spare = sandbox.pids[1]
        sandbox.submit(TrySketch(folder.one(GOOD)))
        assert wait(sandbox).ok
        assert sandbox.pids[0] == spare and is_gone(first)
    assert is_gone(spare)


def test_an_older_answer_is_not_given(folder, sandbox):
    sandbox.run(TrySketch(folder.one(GOOD)))
    sandbox.submit(TrySketch(folder.one(GOOD.replace("texel.x", "older"))))
    sandbox.submit(TrySketch(folder.one(GOOD)))
    assert wait(sandbox).ok


@pytest.mark.slow
def test_memory_has_a_limit(folder):
    hungry = (
        GOOD.replace('r32f"', 'rgba32f"')
        .replace("float kernel", "vec4 kernel")
        .replace("float(texel.x)", "vec4(1)")
    )
    body = '[[pass]]\nname = "a"\nuse = "./one"\nsize = 8192\n'
    with Sandbox(limit_seconds=PATIENCE, memory_bytes=600 * 2**20) as sandbox:
        folder.write("one.glsl", hungry)
        report = sandbox.run(TrySketch(folder.sketch(body)))
        assert not report.ok, "a texture of 1 GiB"
        assert sandbox.run(TrySketch(folder.one(GOOD))).ok


@pytest.mark.slow
def test_close_leaves_no_process(folder):
    sandbox = Sandbox()
    sandbox.start()
    while not sandbox.pids:
        time.sleep(0.005)
    (pid,) = sandbox.pids
    sandbox.close()
    assert is_gone(pid)
    with Sandbox(limit_seconds=PATIENCE) as busy:
        busy.run(TrySketch(folder.one(GOOD)))
        pid = busy.pids[0]
        busy.submit(TrySketch(folder.one(SLOW)))
    assert is_gone(pid), "what it was at would have taken it an hour"
    assert not busy.busy


def run_script(folder: Path, text: str) -> subprocess.Popen[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(text)],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
        # A job that a shell began in the background is deaf to Ctrl-C, and so are its children.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


SCRIPT = """
from functools import partial
from playground import cli
from playground.engine import sandbox
from playground.engine.sandbox import Sandbox, TrySketch
from playground.engine.process import pool
from playground.sketch.load import load
pool._GRACE, pool.max_wall_seconds = 8.0, lambda _: 0.01  # [s] after which a process ends by itself
sandbox.Pool = partial(pool.Pool, ends_with_parent=PIPE)
with Sandbox(limit_seconds=90.0) as sandbox:
    sandbox.start()
    print(sandbox.run(TrySketch(load("good_sketch.toml"))).ok, sandbox.pids[0], flush=True)
    sandbox.run(TrySketch(load("slow_sketch.toml")))
"""


@pytest.fixture
def two(folder):
    folder.write("good.glsl", GOOD)
    folder.write("slow.glsl", SLOW)
    for name in ("good", "slow"):
        folder.write(
            f"{name}_sketch.toml", f'format = 1\nsize = 17\n[[pass]]\nname = "a"\nuse = "./{name}"\n'
        )
    return folder.path


@pytest.mark.always
@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "pipe"),
    [
        (signal.SIGINT, False),
        (signal.SIGKILL, True),
        pytest.param(signal.SIGKILL, False, marks=pytest.mark.slow),
    ],
)
def test_a_parent_that_is_stopped_leaves_no_worker(two, number, pipe):
    """Ctrl-C ends it at once, and so does a killed parent's pipe; without one it ends by its own clock."""
    with run_script(two, SCRIPT.replace("PIPE", str(pipe))) as parent:
        assert parent.stdout is not None
        ok, pid = parent.stdout.readline().split()
        time.sleep(0.3)
        os.kill(parent.pid, number)
        parent.wait(PATIENCE)
    try:
        assert ok == "True"
        assert is_gone(int(pid))
    finally:
        if is_alive(int(pid)):
            os.kill(int(pid), signal.SIGKILL)


@pytest.mark.slow
def test_no_module_of_the_user_s_folder_is_run(two):
    """A sketch is data: what lies in its folder is never imported, under any name."""
    for name in ("numpy", "struct", "playground"):
        (two / f"{name}.py").write_text('open("was_run", "w").close()\nraise SystemExit(3)\n')
    # As the command does: the folder where it is started is not where modules are looked for.
    text = f"import sys\nsys.path[:] = [{str(ROOT)!r}, *(p for p in sys.path if p)]\n" + SCRIPT
    text = text.replace("PIPE", "True").replace('    sandbox.run(TrySketch(load("slow_sketch.toml")))\n', "")
    with run_script(two, text) as parent:
        out, _ = parent.communicate(timeout=180)
    assert out.startswith("True")
    assert not (two / "was_run").exists()


@pytest.mark.slow
def test_an_answer_is_announced(tmp_path: Path) -> None:
    path = tmp_path / "a.glsl"
    path.write_text("float twice(float x) { return 2.0 * x; }\n", encoding="utf-8")
    announced = threading.Event()
    with Sandbox() as sandbox:
        sandbox.on_answer = announced.set
        sandbox.submit(TryLibrary(str(path), str(tmp_path)))
        assert announced.wait(PATIENCE)
        report = sandbox.poll()
        assert report is not None and report.ok


def test_large_data_files_are_given_the_time_to_be_read(tmp_path):
    (tmp_path / "sketch.toml").write_text(
        'format = 1\n[[pass]]\nname = "height"\nuse = "generation/heightmap"\nset = { elevation = "a.npy" }\n'
        '[view]\nuse = "view/map"\ninputs = { shown = "height" }\n'
    )
    assert reading_seconds(TrySketch(load(tmp_path))) == 0.0, "there is no file"
    for size, seconds in ((2**20, 0.0), (2**28, 16.0), (2**40, 120.0)):
        with (tmp_path / "a.npy").open("wb") as file:
            file.truncate(size)
        assert reading_seconds(TrySketch(load(tmp_path))) == seconds
