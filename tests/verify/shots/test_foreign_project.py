"""A project that has no sketch: its own moderngl code, a bare .frag, a figure; pytest as its user runs it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from playground.data.image_files import read_png

pytestmark = pytest.mark.slow  # each run of pytest is a process of its own, as a user's

WAVES = '''
"""Draw waves: moderngl, and nothing of the playground."""
import moderngl

SOURCE = """#version 330
uniform float height;
out vec4 colour;
void main() {
    float up = gl_FragCoord.y / 48.0;
    float wave = 0.5 + 0.3 * height * sin(gl_FragCoord.x / 6.0);
    colour = up < wave ? vec4(0.2, 0.4, 0.6, 1.0) : vec4(0.8, 1.0, 1.0, 1.0);
}"""
CORNERS = """#version 330
void main() { gl_Position = vec4(gl_VertexID % 2 * 4 - 1, gl_VertexID / 2 * 4 - 1, 0, 1); }"""

def draw(height=1.0):
    context = moderngl.create_context(standalone=True, backend="egl")
    program = context.program(vertex_shader=CORNERS, fragment_shader=SOURCE)
    program["height"] = height
    target = context.simple_framebuffer((64, 48))
    target.use()
    context.vertex_array(program, []).render(vertices=3)
    return target
'''

THREE_LINES = """from waves import draw
def test_waves(shot):
    shot.check(draw())
"""

FRAG = """uniform float amount; // 0.5
void mainImage(out vec4 colour, vec2 at) {
    colour = vec4(at / iResolution.xy, amount, 1.0);
}
"""

FIGURE = """
import matplotlib.figure

def test_profile(shot):
    figure = matplotlib.figure.Figure(figsize=(2, 1.5), dpi=60)
    figure.subplots().plot([0, 1, 0.5], label="height")
    figure.axes[0].set_title("Profile")
    shot.check(figure, "profile")
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    if not sys.platform.startswith("linux"):
        pytest.skip("the reference renderer, Mesa's llvmpipe, is chosen by name on Linux")
    (tmp_path / "waves.py").write_text(WAVES)
    (tmp_path / "test_waves.py").write_text(THREE_LINES)
    (tmp_path / "conftest.py").write_text("")
    return tmp_path


def pytest_in(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run pytest as a user does: the plugin is found by itself."""
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("PYTEST", "CI"))}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments]
    return subprocess.run(
        command,
        cwd=folder,
        env=clean | {"GALLIUM_DRIVER": "llvmpipe", "LIBGL_ALWAYS_SOFTWARE": "1", "PYTHONPATH": "."},
        text=True,
        capture_output=True,
        timeout=120,
        check=False,
    )


def test_a_foreign_projects_first_shot_is_three_lines(project: Path) -> None:
    first = pytest_in(project)
    assert "test_waves.py/waves: missing: " in first.stdout and first.returncode == 1
    assert pytest_in(project, "--shots-update").returncode == 0
    pixels, text = read_png(project / "screenshots/test_waves.py/llvmpipe/waves.png")
    assert pixels[0, 0].tolist() == [204, 255, 255, 255] and pixels[-1, 0].tolist() == [51, 102, 153, 255]
    assert "llvmpipe" in text["renderer"]
    assert pytest_in(project).returncode == 0
    (project / "test_waves.py").write_text(THREE_LINES.replace("draw()", "draw(0.8)"))
    changed = pytest_in(project)
    assert changed.returncode == 1 and "test_waves.py/waves: differs: " in changed.stdout
    assert (project / "shots-report/index.html").is_file()


def test_a_bare_frag_and_a_figure_are_checked_too(project: Path) -> None:
    (project / "tint.frag").write_text(FRAG)
    call = 'shot.check(shot.render("tint.frag", size=(32, 24), values={"view.amount": 0.25}))'
    (project / "test_waves.py").write_text(f"def test_tint(shot):\n    {call}\n{FIGURE}")
    assert pytest_in(project, "--shots-update").returncode == 0
    tint = read_png(project / "screenshots/test_waves.py/llvmpipe/tint.png")[0]
    assert tint[0, 0].tolist() == [4, 250, 64, 255]  # (0.5/32, 23.5/24, 0.25), times 255
    pixels, text = read_png(project / "screenshots/test_waves.py/matplotlib-agg/profile.png")
    assert pixels.shape == (90, 120, 4)
    assert text["fonts"] == "DejaVuSans.ttf" and "FreeType" in text["version"]
    assert pytest_in(project).returncode == 0
    (project / "test_waves.py").write_text(FIGURE.replace("0.5]", "0.6]"))
    assert "test_waves.py/profile: differs: " in pytest_in(project).stdout
