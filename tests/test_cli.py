"""The command line as a user meets it: what it prints where, its exit status, its sentences.

Where the process itself is tested (its modules, signals, pipes and driver) one is started;
everything else is called here, which is faster.
"""

from __future__ import annotations

import json
import os
import re
import signal
import struct
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import tifffile

import playground
from playground import cli
from playground.cli import main
from playground.data.image_files import read_png, read_samples
from playground.doctor import where_to_show
from playground.engine import sandbox
from playground.engine.camera import look
from playground.engine.engine import Engine
from playground.engine.frame import reduced
from playground.errors import DataError
from playground.paths import DEFAULT_SKETCH, GLSL
from playground.sketch.assign import values_of
from playground.sketch.find import shipped_sketches
from playground.sketch.load import load
from playground.sketch.model import DEFAULT_PICTURE
from playground.sketch.templates import make_sketch
from playground.sketch.variants import NAME
from playground.verify.check import find_files

from .sketch_texts import map_of_height, passes
from .variants import trust

ROOT = Path(__file__).resolve().parent.parent
COMMANDS = ["live", "render", "fly", "export", "check", "list", "doctor", "new"]
COMMANDS += ["shots", "shots list", "shots mutants", "cache", "cache show", "cache clear"]
COMMANDS += ["library", "library add", "library list", "library remove"]

PLAIN_FRAGMENT = """#version 330
uniform vec3 iResolution;
uniform float iTime;
out vec4 fragColor;
void main() {
    fragColor = vec4(gl_FragCoord.xy / iResolution.xy, iTime / 4.0, 1.0);
}
"""
PLAIN_COMPUTE = """#version 430
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba8, binding = 0) uniform writeonly image2D picture;
uniform vec2 u_resolution;
uniform float u_time;
void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    imageStore(picture, texel, vec4((vec2(texel) + 0.5) / u_resolution, u_time / 4.0, 1.0));
}
"""
SLOPE = """// slope.glsl -- a slope that rises to the east, or as steep as its parameter.
#pragma kernel(output = "height:r32f")
uniform float rise = 1.0;  //! slider(0, 4) unit("m") How high the eastern edge is
float kernel(ivec2 texel) { return rise * float(texel.x) / float(size.x - 1); }
"""
SLOPE_SKETCH = (
    'format = 1\ntitle = "A slope"\nsize = 33\n'
    + map_of_height("./slope", channel="red")
    + """[[preset]]
name = "half"
set = { "height.rise" = 0.5 }
[[shot]]
name = "dark"
size = [66, 33]
set = { "height.rise" = 0.25 }
"""
)

Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run the command here, in an empty folder and with no display."""
    for variable in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(variable, raising=False)
    # On a busy machine a draw that ends may take longer than a user is made to wait.
    monkeypatch.setattr(sandbox, "Sandbox", partial(sandbox.Sandbox, limit_seconds=120.0))

    def called(*arguments: str, cwd: Path = tmp_path) -> subprocess.CompletedProcess[str]:
        monkeypatch.chdir(cwd)
        capsys.readouterr()
        status = cli.main(arguments)
        return subprocess.CompletedProcess(arguments, status, *capsys.readouterr())

    return called


@pytest.fixture
def slope(tmp_path: Path) -> Path:
    folder = tmp_path / "slope"
    folder.mkdir()
    (folder / "slope.glsl").write_text(SLOPE)
    (folder / "sketch.toml").write_text(SLOPE_SKETCH)
    return folder


def well(done: subprocess.CompletedProcess[str]) -> subprocess.CompletedProcess[str]:
    assert done.returncode == 0, done.stderr
    return done


# ── what it must not cost ────────────────────────────────────────────────────


@pytest.mark.slow
def test_what_only_prints_loads_no_opengl():
    code = (
        "import sys; from playground.cli import main\n"
        "for words in sys.argv[1:]:\n"
        "    status = main(words.split())\n"
        "    loaded = [n for n in ('moderngl', 'glfw', 'PIL') if n in sys.modules]\n"
        "    print(words, status, loaded, file=sys.stderr)\n"
    )
    commands = ["--version", "--help", "render --help", "list --json"]
    done = subprocess.run(
        [sys.executable, "-c", code, *commands], cwd=ROOT, capture_output=True, text=True, timeout=180
    )
    assert done.stderr.splitlines() == [f"{words} 0 []" for words in commands]


# ── help ─────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("command", [None, *COMMANDS])
def test_every_help_has_examples_and_fits_eighty_columns(
    command: str | None, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("COLUMNS", "80")
    assert cli.main([*(command or "").split(), "--help"]) == 0
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= 80
    assert re.search(rf"Examples: *\n\s+playground{f' {command}' if command else ''}\b", out)


def test_every_help_example_uses_existing_command_and_options(capsys: pytest.CaptureFixture[str]):
    helps = {}
    for command in COMMANDS:
        cli.main([*command.split(), "--help"])
        helps[command] = capsys.readouterr().out
    for text in helps.values():
        for line in re.findall(r"^\s+playground (\w+.*)$", text.partition("Examples:")[2], re.MULTILINE):
            words = line.split("|")[0].split()
            command = " ".join(words[:2]) if " ".join(words[:2]) in helps else words[0]
            for word in words:
                if word.startswith("--"):
                    assert f" {word} " in helps[command], line


def test_the_version_is_the_packages(run: Run):
    assert well(run("--version")).stdout == f"playground {playground.__version__}\n"


def test_completion_offers_the_shipped_sketches(run: Run, monkeypatch: pytest.MonkeyPatch):
    def completed(words: str) -> set[str]:
        monkeypatch.setenv("_PLAYGROUND_COMPLETE", "complete_bash")
        monkeypatch.setenv("COMP_WORDS", f"playground render {words}")
        monkeypatch.setenv("COMP_CWORD", str(1 + len(words.split(" "))))
        return set(run().stdout.split())

    assert set(shipped_sketches()) <= completed("")
    assert "light.sun=" in completed("--set light.su")


# ── mistakes ─────────────────────────────────────────────────────────────────


def test_a_mistake_in_a_shader_names_its_line(run: Run, slope: Path):
    (slope / "slope.glsl").write_text(SLOPE.replace("return rise *", "return ryse *"))
    done = run("render", "slope")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("error: slope/slope.glsl:4:")
    assert "Traceback" not in done.stderr


def test_a_file_that_is_not_there_is_one_sentence(run: Run):
    done = run("render", "jacksboro", "--set", "height.elevation=nowhere.npz")
    assert (done.returncode, done.stdout) == (2, "")
    assert re.fullmatch(r"error: nowhere\.npz: .*there is no such file.*\n", done.stderr)


def test_live_without_a_display_says_what_to_do(run: Run):
    done = run("live")
    assert done.returncode == 2
    assert re.fullmatch(r"error: There is no screen to open a window on\. .*\n", done.stderr)


def _receive_interrupts() -> None:
    """Receive SIGINT, which a background job of a shell and its children ignore."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.slow
def test_control_c_ends_with_130_and_no_words(tmp_path: Path):
    process = subprocess.Popen(
        [sys.executable, "-m", "playground", "check", str(GLSL)],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=_receive_interrupts,
    )  # fmt: skip
    assert process.stdout is not None
    process.stdout.readline()  # the first file is checked: it is in the middle of its work
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=180)
    assert (process.returncode, error) == (130, b"")


# ── colour ───────────────────────────────────────────────────────────────────


@pytest.mark.skipif(sys.platform == "win32", reason="there is no pty")
@pytest.mark.parametrize("no_colour", [False, True])
def test_colour_is_for_terminals_that_want_it(no_colour: bool, monkeypatch: pytest.MonkeyPatch):
    import pty

    parent, child = pty.openpty()
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    if no_colour:
        monkeypatch.setenv("NO_COLOR", "1")
    with os.fdopen(child, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        assert cli.main(["rendre"]) == 2
        text = os.read(parent, 4096).decode()
    os.close(parent)
    assert ("\033[" in text) is not no_colour
    assert re.sub(r"\033\[[\d;]*m", "", text).startswith("error: no command 'rendre'")


@pytest.mark.slow
def test_a_pipe_gets_no_colour_and_one_line_a_row(capsys: pytest.CaptureFixture[str]):
    assert cli.main(["list", "sketches"]) == 0
    out = capsys.readouterr().out
    assert "\033" not in out
    assert [line.split("\t")[0] for line in out.splitlines()] == shipped_sketches()


# ── render ───────────────────────────────────────────────────────────────────


@pytest.mark.slow  # ./play does so every day, in tests/docs/test_commands.py
def test_bare_headless_command_renders_default_to_free_name(run: Run, tmp_path: Path):
    taken = tmp_path / f"{DEFAULT_SKETCH}.png"
    taken.write_text("mine")
    done = well(run())
    assert done.stdout == f"{DEFAULT_SKETCH}-2.png\n"
    assert "no display" in done.stderr
    assert taken.read_text() == "mine"
    assert read_png(tmp_path / f"{DEFAULT_SKETCH}-2.png")[0].shape == (720, 1280, 4)


def test_render_prints_path_alone_and_never_overwrites_unasked(run: Run, slope: Path, tmp_path: Path):
    names = [well(run("render", "slope", "--size", "48x32")).stdout for _ in range(2)]
    assert names == ["slope.png\n", "slope-2.png\n"]
    done = well(run("render", "slope", "--size", "20x10", "-o", "slope.png"))
    assert (done.stdout, done.stderr) == ("slope.png\n", "")
    assert read_png(tmp_path / "slope.png")[0].shape == (10, 20, 4)


def test_a_picture_is_drawn_larger_and_reduced(run: Run, slope: Path, tmp_path: Path):
    well(run("render", "slope", "-o", "large.png", "--size", "128x72"))
    well(run("render", "slope", "-o", "fine.png", "--size", "64x36", "--supersample", "2"))
    large, fine = (read_png(tmp_path / name)[0] for name in ("large.png", "fine.png"))
    np.testing.assert_array_equal(fine, reduced(large, 2))


def test_settings_presets_and_shots_are_seen_in_the_picture(run: Run, slope: Path, tmp_path: Path):
    def eastern(*arguments: str) -> tuple[tuple[int, ...], int]:
        well(run("render", "slope", *arguments, "-o", "east.png"))
        picture, _ = read_png(tmp_path / "east.png")
        return picture.shape, int(picture[..., 0].max())

    assert eastern("--size", "33x33", "--set", "height.rise=0.5") == ((33, 33, 4), 128)
    assert eastern("--size", "33x33", "--preset", "half") == ((33, 33, 4), 128)
    assert eastern("--shot", "dark") == ((33, 66, 4), 64)
    assert eastern("--shot", "dark", "--size", "33x33", "--set", "height.rise=1") == ((33, 33, 4), 255)


@pytest.mark.parametrize("ending", ["npy", "png", "tif"])
def test_texture_writes_the_pass_s_own_values(ending: str, run: Run, slope: Path, tmp_path: Path):
    path = tmp_path / f"values.{ending}"
    well(run("render", "slope", "--texture", "height", "-o", path.name))
    expected = np.broadcast_to(np.arange(33, dtype=np.float32) / 32, (33, 33))
    if ending == "png":
        samples = read_samples(path)
        assert samples.dtype == np.uint16
        np.testing.assert_array_equal(samples[..., 0], np.rint(expected * 65535))
    else:
        samples = np.load(path) if ending == "npy" else tifffile.imread(path)
        assert samples.dtype == np.float32
        np.testing.assert_array_equal(samples, expected)


def test_clamped_values_are_noted_and_still_written(run: Run, slope: Path, tmp_path: Path):
    done = well(run("render", "slope", "--texture", "height", "--set", "height.rise=2", "-o", "high.png"))
    assert done.stdout == "high.png\n"
    assert "clamped" in done.stderr


def test_a_plain_fragment_shader_runs_unchanged(run: Run, tmp_path: Path):
    (tmp_path / "toy.frag").write_text(PLAIN_FRAGMENT)
    well(run("render", "toy.frag", "--size", "8x4", "--time", "2"))
    picture, _ = read_png(tmp_path / "toy.png")
    red = np.rint((np.arange(8) + 0.5) / 8 * 255)
    np.testing.assert_allclose(picture[..., 0], np.broadcast_to(red, (4, 8)), atol=1)
    np.testing.assert_allclose(
        picture[:, 0, 1], np.rint((3.5 - np.arange(4)) / 4 * 255), atol=1
    )  # north on top
    np.testing.assert_allclose(picture[..., 2], 127.5, atol=1)


def test_a_plain_compute_shader_runs_unchanged(run: Run, tmp_path: Path):
    (tmp_path / "toy.comp").write_text(PLAIN_COMPUTE)
    well(run("render", "toy.comp", "--size", "16x8", "--time", "2"))
    picture, _ = read_png(tmp_path / "toy.png")
    red = (np.arange(16) + 0.5) / 16 * 255
    np.testing.assert_allclose(picture[..., 0], np.broadcast_to(red, (8, 16)), atol=1)
    np.testing.assert_allclose(picture[..., 2], 127.5, atol=1)


def test_standard_output_takes_the_png_and_nothing_else(
    slope: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfdbinary: pytest.CaptureFixture[bytes]
):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["render", "slope", "--size", "8x4", "-o", "-"]) == 0
    out = capfdbinary.readouterr().out
    assert out.startswith(b"\x89PNG") and out.endswith(b"IEND\xaeB`\x82")
    assert struct.unpack(">II", out[16:24]) == (8, 4)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["slope"]


def test_profile_names_every_pass_and_its_clock(run: Run, slope: Path):
    done = well(run("render", "slope", "--size", "32x32", "--profile"))
    assert done.stdout == "slope.png\n"
    assert re.search(r"height\s.*33 x 33.*\b1\b.*\d\.\d\d", done.stderr)
    assert re.search(r"clock: (wall clock|GPU timer)", done.stderr)


def test_files_are_named_from_the_current_folder(run: Run, tmp_path: Path):
    np.save(tmp_path / "mine.npy", np.tile(np.linspace(0, 9, 40, dtype=np.float32), (30, 1)))
    arguments = ("--set", "height.elevation=mine.npy", "--texture", "height", "-o", "out.npy")
    well(run("render", "generation/heightmap", *arguments))
    assert np.load(tmp_path / "out.npy").shape == (30, 40)


IN_ONE_PROCESS = """
import contextlib, io, json, sys
from playground.cli import main
for words in sys.argv[1:]:
    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        status = main(words.split())
    print(json.dumps([status, out.getvalue(), error.getvalue()]))
"""


@pytest.mark.slow
def test_without_compute_everything_but_compute_works(slope: Path, tmp_path: Path):
    (tmp_path / "toy.comp").write_text(PLAIN_COMPUTE)
    commands = ["doctor", "render slope --size 16x16", "render slope --driver compute"]
    environ = os.environ | {"PYTHONPATH": str(ROOT), "MESA_GL_VERSION_OVERRIDE": "4.1"}
    done = subprocess.run(
        [sys.executable, "-c", IN_ONE_PROCESS, *commands, "check --json slope toy.comp"],
        cwd=tmp_path, env=environ, capture_output=True, text=True, timeout=180,
    )  # fmt: skip
    doctor, render, compute, check = map(json.loads, well(done).stdout.splitlines())
    if "OpenGL 4.1" not in doctor[1]:
        pytest.skip("this driver cannot pretend to be older")
    assert render[0] == 0, render
    assert compute == [2, "", "error: this context is OpenGL 4.1; compute needs 4.3\n"]
    assert check[0] == 0, check
    reports = [json.loads(line) for line in check[1].splitlines()]
    assert [(r["ok"], r["skipped"]) for r in reports] == [(True, ["compute"])] * 3


# ── check ────────────────────────────────────────────────────────────────────


def test_check_finds_what_is_wrong_and_where(run: Run, slope: Path, tmp_path: Path):
    files = {
        "slope/broken.glsl": SLOPE.replace("return rise", "return ryse"),
        "slope/library.glsl": "float twice(float x) { return 2.0 * x; }\n",
        "slope/bad_library.glsl": "float twice(float x) { return 2.0 * y; }\n",
        "slope/uses.glsl": SLOPE.replace("#pragma", '#include "bad_library.glsl"\n#pragma'),
        "slope/other.toml": SLOPE_SKETCH.replace("./slope", "./slop"),
        "slope/reads.glsl": '#pragma kernel(output = "colour:rgba8")\nuniform sampler2D height; //! input\n'
        "vec4 kernel(ivec2 texel) { return texelFetch(height, texel, 0); }\n",
        "slope/toy.frag": PLAIN_FRAGMENT,
        "slope/toy.fs": PLAIN_FRAGMENT,
        "slope/toy.comp": PLAIN_COMPUTE,
        "slope/bad.frag": PLAIN_FRAGMENT.replace("iTime / 4.0", "iTime / 4.0.0"),
        "slope/pyproject.toml": "[project]\nname = 'not ours'\n",
        "slope/.hidden/broken.glsl": "float f(",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    done = run("check", "--json", "slope")
    assert (done.returncode, done.stderr) == (1, "")
    reports = {r["path"]: r for r in map(json.loads, done.stdout.splitlines())}
    assert set(reports) == {name for name in files if "pyproject" not in name and ".hidden" not in name} | {
        "slope/slope.glsl",
        "slope/sketch.toml",
    }
    wrong = {
        path: {(e["file"], e["line"]) for e in r["errors"]} for path, r in reports.items() if not r["ok"]
    }
    assert wrong == {
        "slope/broken.glsl": {("slope/broken.glsl", 4)},
        "slope/bad_library.glsl": {("slope/bad_library.glsl", 1)},
        "slope/uses.glsl": {("slope/bad_library.glsl", 1)},
        "slope/other.toml": {("slope/other.toml", 6)},
        "slope/bad.frag": {("slope/bad.frag", 6)},
    }
    assert all(set(e) == {"file", "line", "column", "message"} for r in reports.values() for e in r["errors"])
    assert all(r["errors"] or r["ok"] for r in reports.values())

    done = run("check", *(f"slope/{name}.glsl" for name in ("slope", "broken", "bad_library", "uses")))
    assert done.returncode == 1
    assert re.search(r"^ok +slope/slope\.glsl$", done.stdout, re.MULTILINE)
    assert re.search(r"^FAILED +slope/broken\.glsl\n +slope/broken\.glsl:4:", done.stdout, re.MULTILINE)
    places = re.findall(r"slope/bad_library\.glsl:1:.*", done.stdout)
    assert places and len(set(places)) == len(places), "each is printed once"
    assert re.search(
        r"^FAILED +slope/uses\.glsl\n +\d errors? of slope/bad_library\.glsl, printed above$",
        done.stdout,
        re.MULTILINE,
    )
    assert done.stdout.endswith("4 files checked, 3 failed\n")


@pytest.mark.slow
def test_check_tries_both_drivers(run: Run, tmp_path: Path):
    (tmp_path / "half.glsl").write_text(
        '#pragma kernel(output = "height:r32f")\n'
        "float kernel(ivec2 texel) { return float(texel.x); }\n"
        "#if __VERSION__ >= 430\nfloat broken() { return nothing; }\n#endif\n"
    )
    done = run("check", "--json", "half.glsl")
    assert done.returncode == 1
    assert json.loads(done.stdout)["errors"][0]["line"] == 4


@pytest.mark.slow
def test_check_takes_a_compute_variant_with_its_kernel(run: Run, tmp_path: Path):
    (tmp_path / "fill.glsl").write_text(
        '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.5; }\n'
    )
    (tmp_path / "fill.comp").write_text(
        '#pragma compute(groups = "(size.x + 7) // 8, (size.y + 7) // 8")\nvoid compute() { nonsense; }\n'
    )
    done = run("check", "--json", ".")
    reports = {r["path"]: r for r in map(json.loads, done.stdout.splitlines())}
    assert done.returncode == 1
    assert set(reports) == {"fill.glsl", "fill.comp"}
    assert {e["file"] for e in reports["fill.comp"]["errors"]} == {"fill.comp"}


@pytest.mark.slow
def test_a_file_of_each_kind_that_ships_passes(run: Run):
    names = ["noise/hash.glsl", "generation/white_noise.glsl", "lighting/l_dot_n.glsl", "view/map.glsl"]
    names += ["generation/multiply.toml", "sketches/diamond_square.toml"]
    names += ["generation/diamond_square.toml", "generation/diamond_square.comp"]
    done = well(run("check", "--json", *(str(GLSL / name) for name in names)))
    assert len(done.stdout.splitlines()) == len(names)


@pytest.mark.slow
def test_what_ships_passes(run: Run):
    """Every file of some folders; the sketches are drawn as tests of their own."""
    folders = [GLSL / name for name in ("generation", "texturing", "view")]
    done = well(run("check", "--json", *map(str, folders), str(GLSL / "sketches" / "jacksboro.toml")))
    assert len(done.stdout.splitlines()) > 20


def test_a_file_is_checked_once_however_often_it_is_named(slope: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(slope)
    files = find_files(["slope.glsl", slope, "./slope.glsl"])
    assert sorted(path.name for path, _ in files) == ["sketch.toml", "slope.glsl"]
    with pytest.raises(
        DataError, match=r"slop\.glsl: there is no such file or folder; did you mean 'slope\.glsl'"
    ):
        find_files(["slop.glsl"])


# ── list ─────────────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_list_as_json_holds_every_sketch_and_technique(capsys: pytest.CaptureFixture[str]):
    assert cli.main(["list", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert [s["name"] for s in result["sketches"]] == shipped_sketches()
    names = {t["name"]: t for t in result["techniques"]}
    assert "noise/hash" not in names  # a library file
    sun = {p["path"]: p for p in names["lighting/l_dot_n"]["parameters"]}["sun"]
    assert (sun["type"], sun["widget"], sun["default"]) == ("vec2", "direction", [135.0, 25.0])
    assert names["lighting/l_dot_n"]["outputs"] == ["light"]
    assert not [e for group in result.values() for e in group if e["error"]]


def test_list_of_one_sketch_prints_its_parameters(
    slope: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.chdir(slope.parent)
    assert cli.main(["list", "slope"]) == 0
    rows = [line.split("\t") for line in capsys.readouterr().out.splitlines()]
    assert rows[0] == ["height.rise", "float", "1", "0 to 4", "m", "How high the eastern edge is"]
    assert ["view.channel", "int", "red", "colour, red, green, blue, alpha"] == rows[1][:4]


def test_list_of_a_folder_lists_its_techniques(capsys: pytest.CaptureFixture[str]):
    assert cli.main(["list", "lighting"]) == 0
    names = [line.split("\t")[0] for line in capsys.readouterr().out.splitlines()]
    assert "lighting/l_dot_n" in names and all(name.startswith("lighting/") for name in names)


# ── doctor ───────────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_doctor_prints_the_context_as_text_and_as_json(run: Run):
    done = well(run("doctor"))
    assert re.search(r"^context +OpenGL \d\.\d$", done.stdout, re.MULTILINE)
    health = json.loads(well(run("doctor", "--json")).stdout)
    assert health["ok"] and health["context"]["version_code"] >= 330
    assert health["packages"]["numpy"] == np.__version__
    assert health["limits"]["texture, texels a side"] >= 4096
    assert health["display"] == ""


@pytest.mark.slow
def test_doctor_without_context_advises_and_exits_1(run: Run):
    done = run("doctor", "--json", "--device", "99")
    assert done.returncode == 1
    health = json.loads(done.stdout)
    assert not health["ok"] and health["context"] is None
    if sys.platform.startswith("linux"):
        assert "--device 99: there is no such EGL device" in health["trouble"]
    done = run("--device", "99", "doctor")
    assert done.returncode == 1
    assert done.stderr.startswith("error: ")


@pytest.mark.parametrize(
    ("system", "environ", "shown"),
    [
        ("linux", {}, ""),
        ("linux", {"DISPLAY": ":0"}, "X11 :0"),
        ("linux", {"WAYLAND_DISPLAY": "wayland-1", "DISPLAY": ":0"}, "Wayland wayland-1"),
        ("darwin", {}, "the desktop"),
        ("darwin", {"SSH_CONNECTION": "there"}, ""),
        ("win32", {"CI": "true"}, ""),
        ("win32", {"CI": "false"}, "the desktop"),
    ],
)
def test_where_a_window_would_open(system: str, environ: dict[str, str], shown: str):
    assert where_to_show(environ, system) == shown


# ── new ──────────────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_new_sketch_passes_check_renders_and_is_not_overwritten(run: Run, tmp_path: Path):
    done = well(run("new", "my-land"))
    made = [tmp_path / line for line in done.stdout.split()]
    assert [p.name for p in made] == ["my_land.glsl", "sketch.toml"]
    for command in ("playground live my-land", "playground render my-land", "playground check my-land"):
        assert command in done.stderr
    assert 'title  = "My land"' in (tmp_path / "my-land/sketch.toml").read_text()

    well(run("check", "my-land"))
    assert well(run("render", ".", "--size", "160x90", cwd=tmp_path / "my-land")).stdout == "my-land.png\n"
    picture, _ = read_png(tmp_path / "my-land/my-land.png")
    assert picture[..., :3].std() > 15  # terrain, not one colour
    well(run("render", "my-land", "--texture", "height", "-o", "height.npy"))
    height = np.load(tmp_path / "height.npy")
    assert 0 <= height.min() < 0.3 and 0.6 < height.max() <= 1

    (tmp_path / "my-land/my_land.glsl").write_text("mine")
    assert run("new", "my-land").returncode == 2
    assert (tmp_path / "my-land/my_land.glsl").read_text() == "mine"


def test_messages_name_the_program_as_it_was_started(run: Run, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("PLAYGROUND_PROGRAM", "../my land/play")
    for words in (["new", "hills"], ["check"], ["jacksboro"]):
        message = run(*words).stderr
        assert "'../my land/play' " in message and "playground " not in message


# ── Long names ───────────────────────────────────────────────────────────────

LONG = "x" * 200_000
QUOTED_WHOLE = {
    "a.glsl": f'#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {LONG}; }}\n',
    "b.glsl": f'#pragma kernel(output = "height:r32f", {LONG} = "1")\n',
    "c.glsl": f'#include "{LONG}"\n#pragma kernel(output = "height:r32f")\n',
    "d.frag": f"#version 330\nout vec4 c;\nvoid main() {{ c = vec4(1.0); {LONG}(); }}\n",
    "e.toml": f'format = 1\n[[pass]]\nname = "a"\nuse = "{LONG}"\n',
    "f.toml": f"format = 1\n{LONG} = 1\n",
}


@pytest.mark.parametrize("name", QUOTED_WHOLE)
def test_a_long_name_is_shortened_in_the_middle(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path(name).write_text(QUOTED_WHOLE[name], encoding="utf-8")
    assert cli.main(["render", name, "-o", "x.png", "--size", "32x18"]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].startswith(f"error: {name}:") or name == "c.glsl"
    assert max(map(len, lines)) < 1000
    assert any("characters left out" in line for line in lines) or name in ("a.glsl", "d.frag")
    with pytest.raises(playground.PlaygroundError) as caught:
        playground.render(name, size=(32, 18))
    assert max(len(line) for line in str(caught.value).split("\n")) < 1000


@pytest.mark.parametrize("before", [[], ["render"], ["render", "l_dot_n", "-o", "x.png", "--size"]])
@pytest.mark.parametrize("name", [LONG[:1000], LONG[:100_000]])
def test_a_long_word_of_a_command_is_shortened(before, name, capsys):
    assert cli.main([*before, name]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ") and "Traceback" not in line and len(line) < 1000


def test_of_a_message_of_many_lines_the_middle_is_left_out():
    error = DataError("\n".join(["first", *["| of a driver's log"] * 5000, "last"]))
    lines = str(error).split("\n")
    assert len(lines) < 300 and lines[0] == "first" and lines[-1] == "last"
    assert any("lines left out" in line for line in lines)
    assert str(DataError("short\nas it is")) == "short\nas it is"


# ── Fast variants on the command line: what is printed, ``--plain``, and the commands that verify th


KERNEL = """// terrain.glsl -- a slope.
#pragma kernel(output = "height:r32f")
uniform float rise = 1.0;  //! slider(0, 4) How high the eastern edge is
float kernel(ivec2 texel) { return rise * float(texel.x) / float(size.x - 1); }
"""
FAST = 'agrees = "1e-6"\n' + passes(height="./same") + '[parameters]\nrise = "height.rise"\n'
SKETCH = "format = 1\nsize = 33\n" + map_of_height(channel="red")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A sketch whose kernel has a fast variant, verified; the current folder holds its folder."""
    folder = tmp_path / "terrain"
    folder.mkdir()
    for name, text in {"terrain.glsl": KERNEL, "same.glsl": KERNEL, "terrain.fast.toml": FAST}.items():
        (folder / name).write_text(text)
    (folder / "sketch.toml").write_text(SKETCH)
    trust(folder)
    monkeypatch.chdir(tmp_path)
    return folder


def drawn(capsys: pytest.CaptureFixture[str], *more: str) -> tuple[np.ndarray, list[str]]:
    """Return the picture, and the lines on standard error."""
    assert main(["render", "terrain", "-o", "terrain.png", "--size", "64x48", *more]) == 0
    return read_png(Path("terrain.png"))[0], capsys.readouterr().err.splitlines()


def test_edited_kernel_shows_and_reports_left_out_variant(folder, capsys):
    before, notes = drawn(capsys)
    assert notes == []
    (folder / "terrain.glsl").write_text(KERNEL.replace("rise *", "0.2 * rise *"))
    after, notes = drawn(capsys)
    assert (after != before).any()
    (line,) = notes
    assert line.startswith(
        "note: terrain.fast.toml is left out, the plain form runs: terrain.glsl has changed"
    )
    again, notes = drawn(capsys, "--plain")
    np.testing.assert_array_equal(again, after)
    assert notes == []


@pytest.mark.slow
def test_check_says_it_and_tries_it_all_the_same(folder, capsys):
    (folder / "terrain.glsl").write_text(KERNEL.replace("rise *", "0.2 * rise *"))
    assert main(["check", "--json", "terrain"]) == 0
    reports = {Path(r["path"]).name: r for r in map(json.loads, capsys.readouterr().out.splitlines())}
    assert set(reports) == {"terrain.glsl", "same.glsl", "terrain.fast.toml", "sketch.toml"}
    noted = {name for name, report in reports.items() if report["notes"]}
    assert noted == {"terrain.glsl", "terrain.fast.toml", "sketch.toml"}
    (folder / "same.glsl").write_text(KERNEL.replace("rise *", "nonsense *"))
    assert main(["check", "terrain/terrain.fast.toml"]) == 1
    assert "nonsense" in capsys.readouterr().out
    assert main(["check", "--plain", "terrain/terrain.glsl", "terrain/sketch.toml"]) == 0
    assert "note" not in capsys.readouterr().out


def test_renew_records_agreeing_variants_and_refuses_rest(folder, capsys):
    (folder / NAME).unlink()
    assert main(["variants", "list", "terrain"]) == 0
    assert "never verified" in capsys.readouterr().out
    assert main(["variants", "verify", "terrain"]) == 0
    assert "ok      terrain/terrain.fast.toml: height" in capsys.readouterr().out
    assert not (folder / NAME).exists(), "verify writes nothing"
    assert main(["variants", "renew", "terrain/terrain.fast.toml"]) == 0
    assert str(folder / NAME) in capsys.readouterr().out and (folder / NAME).exists()
    assert drawn(capsys)[1] == []
    (folder / "same.glsl").write_text(KERNEL.replace("rise *", "0.9 * rise *"))
    assert main(["variants", "renew", "terrain"]) == 1
    out = capsys.readouterr().out
    assert (
        "FAILED  terrain/terrain.fast.toml: height differs by" in out and "1 variant of 1 not verified" in out
    )
    assert json.loads((folder / NAME).read_text())["variants"] == {}


@pytest.mark.slow
def test_variants_that_ship_are_named_as_techniques_are(capsys):
    assert main(["variants", "list", "generation/fault_formation", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["variant"].rpartition("/")[2] for row in rows] == ["sum.comp", "sum.fast.toml"]
    assert main(["variants", "list", "glsl/generation/fourier.comp"]) == 0
    assert "fourier.comp" in capsys.readouterr().out


@pytest.mark.slow
def test_every_shipped_sketch_runs_its_fast_variants():
    """None of those that ship is left out: the record is that of the texts."""
    from playground.sketch.load import load_with
    from playground.sketch.techniques import Techniques
    from playground.sketch.variants import unverified

    assert (GLSL / NAME).is_file()
    reader = Techniques()
    assert {name: unverified(load_with(reader, name)) for name in shipped_sketches()} == dict.fromkeys(
        shipped_sketches(), ()
    )


@pytest.mark.slow
def test_technique_with_own_folder_is_selected_by_its_name(capsys):
    assert main(["variants", "list", "generation/diamond_square"]) == 0
    assert "generation/diamond_square.comp" in capsys.readouterr().out
    assert main(["variants", "list", "glsl/generation/fourier"]) == 0
    assert "generation/fourier.comp" in capsys.readouterr().out


# ── The sketch that `playground new` makes: its first picture shows all of the terrain, and little e


def test_the_first_view_of_a_new_sketch_shows_all_of_the_terrain(engine: Engine, tmp_path: Path) -> None:
    sketch = load(make_sketch(tmp_path / "hills"))
    extent, relief = sketch.terrain.extent, sketch.terrain.relief
    assert extent is not None and relief is not None
    height = engine.read(sketch, "height") * relief
    rows, columns = height.shape
    east, north = np.linspace(0, extent[0], columns), np.linspace(0, extent[1], rows)
    grid = np.stack([*np.meshgrid(east, north), height], axis=-1)
    foot = -values_of(sketch)["view.land.skirt"] * extent[0]  # type: ignore[operator]
    corners = [[x, y, foot] for x in (0, extent[0]) for y in (0, extent[1])]
    places = np.concatenate([grid.reshape(-1, 3), corners]).astype(float)
    matrix = look(sketch.camera, extent, relief, DEFAULT_PICTURE).clip_from_world.astype(float)
    clip = np.concatenate([places, np.ones((len(places), 1))], axis=1) @ matrix.T
    across, up = (clip[:, axis] / clip[:, 3] for axis in (0, 1))
    assert np.abs(across).max() < 0.95 and np.abs(up).max() < 0.95, "nothing is cut, its cut front included"
    assert up.max() > 0.7 and np.abs(across).max() > 0.8, "it fills most of the picture"
