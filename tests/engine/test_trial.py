"""What would kill the driver kills the trial's child, and the next request works."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from playground.engine.trial import Trial, TrialReport, TryLibrary, TrySketch
from playground.errors import ShaderError, TrialCrash, TrialTimeout

ROOT = Path(__file__).resolve().parents[2]
GOOD = """#pragma kernel(output = "a:r32f")
float kernel(ivec2 texel) { return float(texel.x); }
"""
# Each macro doubles the one before: 2**18 additions from a few hundred bytes.
DOUBLING = "\n".join(["#define M0 x"] + [f"#define M{i} M{i - 1} + M{i - 1}" for i in range(1, 19)])
CRASH = f"""#pragma kernel(output = "a:r32f")
{DOUBLING}
float kernel(ivec2 texel) {{ float x = float(texel.x); return M18; }}
"""
# llvmpipe stops every loop after 65,535 turns, nested ones together: slowness takes many in a row.
LOOP = "for (int i = 0; i < 65000; i++) x = fract(sin(x) * 43758.5);"
SLOW = f"""#pragma kernel(output = "a:r32f")
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


def gone_within(pid: int, seconds: float) -> bool:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if not is_alive(pid):
            return True
        time.sleep(0.02)
    return False


def wait(trial: Trial, seconds: float = 30.0) -> TrialReport:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if (report := trial.poll()) is not None:
            return report
        time.sleep(0.005)
    raise AssertionError("no answer")


@pytest.fixture(scope="module")
def trial():
    with Trial(limit_seconds=3.0) as made:
        yield made


def test_a_good_sketch_is_good_by_both_drivers(trial, folder):
    report = trial.run(TrySketch(folder.one(GOOD), drivers=("fragment", "compute")))
    assert report.ok, report.error
    assert report.error is None


def test_the_second_answer_is_fast(trial, folder):
    trial.run(TrySketch(folder.one(GOOD)))
    start = time.perf_counter()
    assert trial.run(TrySketch(folder.one(GOOD.replace("texel.x", "texel.y")))).ok
    assert time.perf_counter() - start < 1.0, "the child is warm"


def test_a_mistake_comes_back_with_its_place(trial, folder):
    report = trial.run(TrySketch(folder.one(GOOD.replace("texel.x", "wrong"))))
    assert not report.ok
    assert isinstance(report.error, ShaderError)
    assert report.error.diagnostics[0].line == 2
    assert trial.run(TrySketch(folder.one(GOOD))).ok


def test_it_tries_the_smallest_land_that_is_accepted(trial, folder):
    """A kernel that takes powers of two only, in a sketch of 4096 texels a side, is tried small."""
    kernel = GOOD.replace('r32f"', 'r32f", accepts = "2**n", repeat = "log2(size.x)"')
    report = trial.run(TrySketch(folder.one(kernel, size="size = 4096")))
    assert report.ok, report.error
    assert report.seconds < 2.0


def test_a_library_file_is_compiled_alone(trial, folder):
    good = folder.write("lib.glsl", "float twice(float x) { return 2.0 * x; }\n")
    bad = folder.write("bad.glsl", "float twice(float x) {\n return 2.0 * y; }\n")
    assert trial.run(TryLibrary(str(good), str(folder.path))).ok
    report = trial.run(TryLibrary(str(bad), str(folder.path)))
    assert report.error is not None
    assert report.error.diagnostics[0].line == 2


def test_what_crashes_the_compiler_kills_the_child_only(trial, folder):
    report = trial.run(TrySketch(folder.one(CRASH)))
    assert not report.ok
    assert isinstance(report.error, TrialCrash)
    assert trial.run(TrySketch(folder.one(GOOD))).ok


def test_a_crash_says_how(trial, folder):
    assert trial.run(TrySketch(folder.one(GOOD))).ok
    trial.submit(TrySketch(folder.one(SLOW)))
    time.sleep(0.2)
    os.kill(trial._child.pid, signal.SIGSEGV)
    report = wait(trial)
    assert isinstance(report.error, TrialCrash)
    assert "SIGSEGV" in str(report.error)
    assert trial.run(TrySketch(folder.one(GOOD))).ok


def test_what_takes_too_long_is_stopped(folder):
    with Trial(limit_seconds=0.7) as trial:
        assert trial.run(TrySketch(folder.one(GOOD))).ok
        pid = trial._child.pid
        start = time.monotonic()
        report = trial.run(TrySketch(folder.one(SLOW)))
        assert isinstance(report.error, TrialTimeout)
        assert "longer than 0.7 s" in str(report.error)
        assert time.monotonic() - start < 5.0
        assert gone_within(pid, 1.0)
        assert trial.run(TrySketch(folder.one(GOOD))).ok


def test_submit_never_waits_and_the_newest_wins(folder):
    # Large requests: a pipe that nobody reads would fill.
    padding = "\n".join(f"// {i} {'x' * 100}" for i in range(3000))
    wrong = [
        TrySketch(folder.one(GOOD.replace("texel.x", f"wrong{number}") + padding)) for number in range(20)
    ]
    with Trial(limit_seconds=4.0) as trial:
        assert trial.run(TrySketch(folder.one(GOOD))).ok
        trial.submit(TrySketch(folder.one(SLOW)))
        start = time.monotonic()
        for request in wrong:
            trial.submit(request)
        assert time.monotonic() - start < 3.0, "it waited for the child"
        assert trial.busy
        report = wait(trial)
        assert "wrong19" in str(report.error)
        assert not trial.busy
        assert trial.poll() is None


def test_an_older_answer_is_not_given(folder, trial):
    trial.run(TrySketch(folder.one(GOOD)))
    trial.submit(TrySketch(folder.one(GOOD.replace("texel.x", "older"))))
    trial.submit(TrySketch(folder.one(GOOD)))
    assert wait(trial).ok


def test_memory_has_a_limit(folder):
    hungry = (
        GOOD.replace('r32f"', 'rgba32f"')
        .replace("float kernel", "vec4 kernel")
        .replace("float(texel.x)", "vec4(1)")
    )
    body = '[[pass]]\nname = "a"\nuse = "./one"\nsize = 8192\n'
    with Trial(limit_seconds=20.0, memory_bytes=600 * 2**20) as trial:
        folder.write("one.glsl", hungry)
        report = trial.run(TrySketch(folder.sketch(body)))
        assert not report.ok, "a texture of 1 GiB"
        assert trial.run(TrySketch(folder.one(GOOD))).ok


def test_close_leaves_no_process(folder):
    trial = Trial()
    trial.start()
    pid = trial._child.pid
    trial.close()
    assert gone_within(pid, 2.0)
    with Trial(limit_seconds=60.0) as busy:
        busy.run(TrySketch(folder.one(GOOD)))
        pid = busy._child.pid
        busy.submit(TrySketch(folder.one(SLOW)))
        start = time.monotonic()
    assert time.monotonic() - start < 2.0
    assert gone_within(pid, 1.0)
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
from playground.engine import trial as module
from playground.engine.trial import Trial, TrySketch
from playground.sketch.load import load
module._FIRST_EXTRA = 1.0
with Trial(limit_seconds=LIMIT) as trial:
    print(trial.run(TrySketch(load("good_sketch.toml"))).ok, trial._child.pid, flush=True)
    trial.run(TrySketch(load("slow_sketch.toml")))
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


@pytest.mark.parametrize(("number", "limit"), [(signal.SIGINT, 60.0), (signal.SIGKILL, 1.5)])
def test_a_parent_that_is_stopped_leaves_no_child(two, number, limit):
    """Ctrl-C ends the child at once; a killed parent's child, hung as it is, ends by its own clock."""
    with run_script(two, SCRIPT.replace("LIMIT", str(limit))) as parent:
        assert parent.stdout is not None
        ok, pid = parent.stdout.readline().split()
        time.sleep(0.3)
        os.kill(parent.pid, number)
        parent.wait(5.0)
    try:
        assert ok == "True"
        assert gone_within(int(pid), 2.0 if number == signal.SIGINT else 6.0)
    finally:
        if is_alive(int(pid)):
            os.kill(int(pid), signal.SIGKILL)


def test_no_module_of_the_user_s_folder_is_run(two):
    """A sketch is data: what lies beside it is never imported, whatever its name."""
    for name in ("numpy", "struct", "playground"):
        (two / f"{name}.py").write_text('open("was_run", "w").close()\nraise SystemExit(3)\n')
    # As the command does: the folder where it is started is not where modules are looked for.
    text = f"import sys\nsys.path[:] = [{str(ROOT)!r}, *(p for p in sys.path if p)]\n" + SCRIPT
    text = text.replace("LIMIT", "20.0").replace('    trial.run(TrySketch(load("slow_sketch.toml")))\n', "")
    with run_script(two, text) as parent:
        out, _ = parent.communicate(timeout=180)
    assert out.startswith("True")
    assert not (two / "was_run").exists()
