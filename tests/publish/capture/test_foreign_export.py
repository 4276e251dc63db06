"""Another tool's shader leaves for a third: read here, written in another form, read and drawn again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import PlaygroundError
from playground.publish.export import export

from ...loading import load
from ...sketch_texts import passes
from .test_shader_export import FRAME, HEAD, ROUNDING, apart, refusal

pytestmark = pytest.mark.room("dialects")

TOY = """// toy.frag -- a Shadertoy text.
uniform float amount; // a parameter
#define TURN(a) mat2(cos(a), sin(a), -sin(a), cos(a))
float ring(vec2 p, float r) { return abs(length(p) - r); }
void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    vec2 p = (2.0 * fragCoord - iResolution.xy) / iResolution.y;
    p *= TURN(iTime + 0.1 * float(iFrame % 7));
    fragColor = vec4(ring(p, 0.5), fract(p) + 0.0 * iMouse.xy, 0.0);
}
"""
BOOK = """#ifdef GL_ES
precision mediump float;
#endif
uniform vec2 u_resolution;
uniform float u_time;
varying vec2 vUv;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution.xy;
    gl_FragColor = vec4(st.x, abs(sin(u_time)), vUv.y, 1.0);
}
"""
PLAIN = """#version 330
uniform vec2 u_resolution;
uniform float waves = 3.0;  //! slider(1, 9) How many
out vec3 picture;
void main() { picture = vec3(0.5 + 0.5 * sin(waves * gl_FragCoord.xy / u_resolution * 6.28), 0.25); }
"""
FILTER = """// A filter of what iChannel0 reads.
void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    vec2 size = iChannelResolution[0].xy;
    fragColor = 1.0 - texelFetch(iChannel0, ivec2(fragCoord * size / iResolution.xy), 0);
}
"""
FILES = {"toy.frag": TOY, "book.frag": BOOK, "plain.glsl": PLAIN, "filter.frag": FILTER}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "out").mkdir()
    text = HEAD + '[[pass]]\nname = "toy"\nuse = "./toy"\nsize = "view.size"\n[view]\nuse = "./filter"\n'
    text += 'inputs = { iChannel0 = "toy" }\n'
    (tmp_path / "filtered.toml").write_text(text)
    text = HEAD + passes(picture="./toy", height="foreign/height") + '[view]\nuse = "./plain"\n'
    (tmp_path / "terrain.toml").write_text(text)
    return tmp_path


@pytest.mark.parametrize("ending", ["fs", "json", "frag", "glsl"])
@pytest.mark.parametrize("name", ["toy.frag", "book.frag", "plain.glsl"])
def test_one_pass_leaves_in_every_form(folder: Path, any_engine: Engine, name: str, ending: str) -> None:
    path = folder / "out" / f"again.{ending}"
    done = export(folder / name, path, engine=any_engine)
    first, other = (any_engine.render(load(p), size=FRAME, time=1.25).array for p in (folder / name, path))
    assert apart(first[..., :3], other[..., :3]) <= ROUNDING
    stays = any("the mouse stays behind: iMouse" in warning for warning in done.warnings)
    assert stays == (name == "toy.frag" and ending in ("fs", "glsl"))


@pytest.mark.parametrize("ending", ["fs", "json"])
def test_a_filter_of_another_s_picture_leaves_with_it(folder: Path, any_engine: Engine, ending: str) -> None:
    path = folder / "out" / f"again.{ending}"
    export(folder / "filtered.toml", path, engine=any_engine)
    files = folder / "filtered.toml", path
    first, other = (any_engine.render(load(p), size=FRAME, time=0.5).array for p in files)
    assert apart(first[..., :3], other[..., :3]) <= ROUNDING


@pytest.mark.parametrize("ending", ["fs", "json"])
def test_heights_of_another_s_picture_leave(folder: Path, any_engine: Engine, ending: str) -> None:
    path = folder / "out" / f"again.{ending}"
    export(folder / "terrain.toml", path, texture="height", engine=any_engine)
    sketch = load(folder / "terrain.toml").with_values({"size": FRAME})
    values = np.clip(any_engine.read(sketch, "height").astype(np.float64), 0, 1)
    expected = np.repeat(np.floor(values * 255 + 0.5).astype(np.uint8)[..., None], 3, axis=2)
    again = any_engine.render(load(path), size=FRAME).array[::-1, :, :3]
    assert apart(expected, again) <= ROUNDING


def test_an_isf_s_functions_stay(folder: Path, any_engine: Engine) -> None:
    body = "void main() { gl_FragColor = vec4(isf_FragNormCoord, 0.0, 1.0); }\n"
    (folder / "own.fs").write_text('/*{"ISFVSN": "2", "INPUTS": []}*/\n' + body)
    result = refusal(any_engine, folder / "own.fs", folder / "out" / "again.json")
    assert "is own.fs, whose own tool gives it functions" in result[0]


def test_a_stand_in_s_size_is_told(folder: Path, any_engine: Engine) -> None:
    (folder / "noisy.frag").write_text(
        FILTER.replace("texelFetch(iChannel0, ivec2(", "texture(iChannel0, (").replace(
            "iResolution.xy), 0)", "iResolution.xy))"
        )
    )
    with pytest.raises(PlaygroundError, match="'iChannel0' has 256 x 256 texels"):
        export(folder / "noisy.frag", folder / "out" / "again.json", engine=any_engine)
