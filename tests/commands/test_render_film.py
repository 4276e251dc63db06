"""``playground render`` for films, numbered pictures, sweeps and large pictures, as a user meets it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import pytest

from playground import cli
from playground.data.image_files import read_png

from ..sketch_texts import LIT_NOISE, SMALL_VIEW, map_of_height, passes

ROOT = Path(__file__).resolve().parents[2]
SKETCH = (
    "format = 1\nsize = 33\n"
    + LIT_NOISE
    + SMALL_VIEW
    + """[[keyframe]]
time = 0.0
set = { "light.gain" = 1.0 }
[[keyframe]]
time = 0.5
set = { "light.gain" = 2.0 }
[[shot]]
name = "late"
time = 0.3
size = [48, 28]
"""
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "terrain.toml").write_text(SKETCH, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(capsys: pytest.CaptureFixture[str], *words: str) -> list[str]:
    status = cli.main(["render", "terrain.toml", *words])
    out, err = capsys.readouterr()
    assert status == 0, err
    return out.splitlines()


@pytest.mark.slow
def test_a_video(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("av")
    from playground.publish.video import count_pictures

    assert run(capsys, "--video", "a.mp4", "--size", "64x36", "--fps", "20") == ["a.mp4"]
    assert count_pictures(folder / "a.mp4") == (10, Fraction(20)), "to the last keyframe"
    run(capsys, "--video", "b.gif", "--shot", "late", "--seconds", "0.3", "--fps", "10")
    assert count_pictures(folder / "b.gif")[0] == 3
    assert run(capsys, "--video", "c.webm", "--sweep", "light.gain=1..3", "-n", "4", "--size", "64x36")
    assert count_pictures(folder / "c.webm") == (4, Fraction(4))


@pytest.mark.slow
def test_numbered_pictures_and_resume(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--frames", "3..5", "--fps", "10", "-o", "new/f%03d.png", "--size", "64x36")
    paths = [Path(line) for line in run(capsys, *words)]
    assert [path.as_posix() for path in paths] == ["new/f003.png", "new/f004.png", "new/f005.png"]
    (folder / "new" / "f004.png").unlink()
    before = paths[0].stat().st_mtime_ns
    assert cli.main(["render", "terrain.toml", *words, "--resume"]) == 0
    out, err = capsys.readouterr()
    assert out.count("\n") == 3 and "2 pictures kept, 1 drawn" in err
    assert paths[0].stat().st_mtime_ns == before and paths[1].is_file()
    assert [Path(p).name for p in run(capsys, "--frames", "0", "-o", "new", "--size", "64x36")] == [
        "00000.png"
    ]


def test_a_sheet(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "--sweep", "light.sun.elevation=5..60", "-n", "4", "--size", "64x36") == [
        "terrain-sweep.png"
    ]
    assert read_png(folder / "terrain-sweep.png")[0].shape[1] == 2 * 72 + 8
    run(capsys, "--sweep", "light.gain=1,2", "--sweep", "view.haze=0,1,2", "--size", "64x36", "-o", "b.png")
    assert read_png(folder / "b.png")[0].shape[0] > 3 * 36


def test_a_picture_larger_than_any_texture(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "--size", "17000x20", "-o", "wide.png") == ["wide.png"]
    pixels = read_png(folder / "wide.png")[0]
    assert pixels.shape == (20, 17000, 4) and pixels[..., :3].std() > 5


def test_help_has_examples(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["render", "--help"]) == 0
    out = capsys.readouterr().out
    assert "--sweep light.sun.elevation=5..60 -n 12" in out and "--video flight.mp4" in out


@pytest.fixture
def film(folder: Path) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-m", "playground", "render", "terrain.toml", "--video", "long.mp4"]
    process = subprocess.Popen(
        [*command, "--seconds", "9000", "--size", "64x36"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # As a terminal starts it, also where the tests run in the background, deaf to Ctrl-C.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    yield process
    process.kill()
    process.wait()
    for stream in (process.stdout, process.stderr):
        assert stream is not None
        stream.close()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals differ there")
def test_ctrl_c_leaves_a_shorter_video(folder: Path, film: subprocess.Popen[str]) -> None:
    pytest.importorskip("av")
    import time

    from playground.publish.video import count_pictures

    end = time.monotonic() + 120
    # The first bytes are in the file once some pictures are encoded; then it is well under way.
    while time.monotonic() < end and film.poll() is None:
        if any(part.stat().st_size > 0 for part in folder.glob(".long.mp4.*")):
            break
        time.sleep(0.05)
    time.sleep(0.1)
    film.send_signal(signal.SIGINT)
    out, err = film.communicate(timeout=120)
    assert (film.returncode, out) == (130, "") and "Traceback" not in err, err
    left = sorted(path.name for path in folder.iterdir())
    if "before the first" in err:  # on a machine so slow that no picture was drawn in time
        assert left == ["terrain.toml"]
        return
    assert err.startswith("stopped; the first ")
    (path,) = folder.glob("long-first-*.mp4")
    assert count_pictures(path)[0] == int(path.stem.rpartition("-")[2]) and len(left) == 2


CLEAR = """// clear.glsl -- seen through where it is low
#pragma kernel(output = "frame:rgba8")
uniform float alpha = 1.0; //! slider(0, 1)
vec4 kernel(ivec2 texel) { return vec4(0.5, 0.5, 0.5, texel.x == 0 ? alpha : 1.0); }
"""
CLEAR_SKETCH = (
    "format = 1\nsize = 9\n" + passes(height="generation/white_noise") + '[view]\nuse = "./clear"\n'
)


def test_what_drops_alpha_says_so(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("av")
    (tmp_path / "clear.glsl").write_text(CLEAR)
    (tmp_path / "sketch.toml").write_text(CLEAR_SKETCH)
    name, size = str(tmp_path / "sketch.toml"), ["--size", "16x16"]
    film = ["render", name, *size, "--video", str(tmp_path / "x.mp4"), "--seconds", "0.1"]
    sweep = ["render", name, *size, "--sweep", "view.alpha=0,1"]
    assert cli.main(film) == 0
    assert "opaque" not in capfd.readouterr().err
    (tmp_path / "clear.glsl").write_text(CLEAR.replace("alpha = 1.0", "alpha = 0.5"))
    assert cli.main(film) == 0
    assert "the video is opaque: the alpha of every picture was dropped" in capfd.readouterr().err
    assert cli.main([*sweep, "-o", str(tmp_path / "x.png")]) == 0
    assert "a sheet is opaque: the alpha of 1 of 2 pictures was dropped" in capfd.readouterr().err
    assert cli.main([*sweep, "--video", str(tmp_path / "y.mp4")]) == 0
    assert "the video is opaque: the alpha of 1 of 2 pictures was dropped" in capfd.readouterr().err


def test_a_picture_with_nan_in_it_says_which_pass(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    kernel = '// k\n#pragma kernel(output = "height:r32f")\nuniform float root = -1.0; //! slider(-1, 1)\n'
    kernel += "float kernel(ivec2 texel) { return texel == ivec2(3, 5) ? sqrt(root) : 0.5; }\n"
    (tmp_path / "k.glsl").write_text(kernel)
    (tmp_path / "sketch.toml").write_text("format = 1\nsize = 65\n" + map_of_height("./k"))
    words = ["render", str(tmp_path), "-o", str(tmp_path / "x.png"), "--size", "16x16"]
    assert cli.main(words) == 0
    assert "pass 'height', output 'height': NaN at texel (3, 5) from the south-west" in capfd.readouterr().err
    assert cli.main([*words, "--set", "height.root=1"]) == 0
    assert "NaN" not in capfd.readouterr().err
