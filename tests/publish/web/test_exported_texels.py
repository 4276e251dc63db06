"""What a page has as bytes is what the engine has as textures; what depends on it is locked."""

from __future__ import annotations

import base64
import gzip
import io
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest

from playground.data.image_files import read_image, write_png
from playground.engine.engine import Engine
from playground.engine.plan import PlanRequest
from playground.engine.planner import make_plan
from playground.engine.textures import split_format
from playground.paths import SKETCHES
from playground.publish.web.page_data import page_data
from playground.publish.web.plan import KINDS
from playground.shader.colours import srgb_to_linear
from playground.sketch.assign import shown_parameters
from playground.sketch.model import Sketch
from tests import browser as browsers

from ...loading import load
from ...sketch_texts import map_of, passes

KINDS_OF_NUMBERS = {"f1": np.uint8, "nu2": np.uint16, "f2": np.float16, "f4": np.float32}


def bytes_of(page: dict[str, Any], key: str) -> bytes:
    return gzip.decompress(base64.b64decode(page["shared"]["blobs"][key]))


@pytest.mark.parametrize("name", ["delaunay_flips", "from_example", "jacksboro", "splat_mask"])
def test_a_source_has_the_engines_texels(any_engine: Engine, name: str):
    sketch = load(name)
    page = page_data([sketch], engine=any_engine)
    sources = [node for node in page["sketches"][0]["nodes"] if node.get("data")]
    assert sources
    for node in sources:
        for texture in node["data"]:
            components, kind = split_format(texture["format"])
            data = np.frombuffer(bytes_of(page, texture["blob"]), KINDS_OF_NUMBERS[kind])
            width, height = texture["size"]
            result = data.reshape(height, width, components).astype(np.float32)
            if data.dtype.kind == "u":
                result /= np.float32(np.iinfo(data.dtype).max)
            expected = any_engine.read(sketch, f"{node['path']}:{texture['output']}")
            np.testing.assert_array_equal(result.reshape(expected.shape), expected)


SKETCH = """format = 1
[view]
use = "./view"
set = { photo = "photo.png" }
"""
VIEW = """#pragma kernel(output = "colour:rgba8")
uniform sampler2D photo;  //! file("photo.png")
vec4 kernel(ivec2 texel) { return texelFetch(photo, texel, 0); }
"""


@pytest.mark.parametrize("opaque", [True, False])
def test_an_image_has_the_texels_of_its_file(tmp_path: Path, opaque: bool):
    pixels = np.random.default_rng(3).integers(0, 256, (37, 53, 4), np.uint8)
    pixels[..., 3] = 255 if opaque else pixels[..., 3]
    write_png(tmp_path / "photo.png", pixels)
    page = view_of(tmp_path)
    [(key, image)] = page["shared"]["images"].items()
    assert page["sketches"][0]["values"]["view.photo"] == key
    assert image["size"] == [53, 37] and image["kind"] == "srgb8"
    data = bytes_of(page, image["blob"])
    if opaque:
        assert image["file"] == "image/webp"
        elements = np.array(PIL.Image.open(io.BytesIO(data)).convert("RGBA"))
    else:
        assert "file" not in image
        elements = np.frombuffer(data, np.uint8).reshape(37, 53, 4)[::-1]
    np.testing.assert_array_equal(elements, pixels)


def test_an_image_of_16_bits_has_the_engines_half_floats(tmp_path: Path):
    from playground.data.image_files import encode_samples

    samples = np.random.default_rng(4).integers(0, 65_536, (5, 7, 3), np.uint16)
    (tmp_path / "photo.png").write_bytes(encode_samples(samples))
    page = view_of(tmp_path)
    [image] = page["shared"]["images"].values()
    assert image["kind"] == "rgba16f"
    result = np.frombuffer(bytes_of(page, image["blob"]), np.float16).reshape(5, 7, 4)[::-1]
    linear = srgb_to_linear(read_image(tmp_path / "photo.png").pixels[..., :3].astype(np.float64))
    np.testing.assert_array_equal(result[..., :3], linear.astype(np.float16))
    assert (result[..., 3] == 1).all()


def view_of(folder: Path) -> dict[str, Any]:
    (folder / "view.glsl").write_text(VIEW)
    (folder / "sketch.toml").write_text(SKETCH)
    return page_data([load(folder)])


# ── locks ────────────────────────────────────────────────────────────────────


def rows(name: str) -> dict[str, dict[str, Any]]:
    return {row["path"]: row for row in page_data([load(name)])["sketches"][0]["shown"]}


def test_file_terrain_has_fixed_size_and_computed_terrain_any():
    made, computed = (page_data([load(name)])["sketches"][0] for name in ("jacksboro", "fbm"))
    assert made["terrain"]["locked"].startswith("The elevation file's terrain was made in this size")
    assert computed["terrain"]["locked"] == ""
    assert any("elevation" in note for note in made["notes"])


def test_a_sources_own_parameters_are_locked_and_no_others():
    values = rows("delaunay_flips")
    source = {row["path"] for row in values.values() if "triangulation" in row["locked"]}
    assert source and all(values[path]["locked"] for path in source)
    assert [path for path, row in values.items() if not row["locked"]]


@pytest.mark.slow
def test_what_a_source_was_made_of_is_locked_with_it(any_engine: Engine):
    """A page does not draw the passes that only the source read, and says why they cannot be changed."""
    [data] = page_data([load("from_example")], engine=any_engine)["sketches"]
    result = {row["path"]: row["locked"] for row in data["shown"]}
    assert result["pieces.follow"] == "The terrain was made when the page was exported."
    assert result["ridges.texels"].endswith("was made when the page was exported.")
    assert not result["light.sun"] and not result["view.exposure"]
    [node] = [node for node in data["nodes"] if node["path"] == "pieces"]
    assert node["inputs"] == []
    assert data["terrain"]["locked"] == "The terrain was made in this size when the page was exported."
    why = "The terrain was made by this when the page was exported."
    assert data["terrain"]["lockedMetres"] == {"extent": why, "relief": why}


def test_kernels_that_a_source_reads_are_locked(any_engine: Engine, tmp_path: Path):
    """However far behind it, and round a loop."""
    (tmp_path / "base.glsl").write_text(BASE)
    (tmp_path / "more.glsl").write_text(
        '#pragma kernel(output = "height:r32f")\nuniform sampler2D before;  //! input("zero")\n'
        "uniform sampler2D base;  //! input\nuniform float gain = 1.0;  //! slider(0, 4) How much\n"
        "float kernel(ivec2 t) { return gain * texelFetch(base, t, 0).r + texelFetch(before, t, 0).r; }\n"
    )
    (tmp_path / "spread.glsl").write_text(
        '#pragma kernel(output = "height:r32f", repeat = "5")\nuniform sampler2D base;  //! input\n'
        "float kernel(ivec2 t) { return previous(t) + texelFetch(base, t, 0).r; }\n"
    )
    text = "format = 1\nsize = 17\n" + passes(
        first=("./base",),
        other=("./base",),
        spread=("./spread", 'inputs = { base = "first" }'),
        free=("./spread", 'inputs = { base = "first" }'),
        looped=("./more", 'inputs = { base = "spread" }', "repeat = 3", 'feedback = { before = "height" }'),
        noise=("generation/by_example", 'inputs = { example = "looped" }'),
    )
    (tmp_path / "sketch.toml").write_text(text + map_of("noise"))
    [data] = page_data([load(tmp_path)], engine=any_engine)["sketches"]
    result = {row["path"]: row["locked"] for row in data["shown"]}
    made = "The table of ranks was made of this when the page was exported."
    assert (result["first.rise"], result["looped.gain"], result["other.rise"]) == (made, made, "")
    assert result["noise.widest"] == "The table of ranks was made when the page was exported."
    assert result["noise.seed"] == ""
    stopped = {path: item["locked"] for path, item in data["passes"].items() if "locked" in item}
    assert stopped == {"spread": made, "looped": made}, "their iterations would change nothing"


def test_inputs_of_kernel_before_source_are_locked_or_noted(any_engine: Engine, tmp_path: Path):
    (tmp_path / "sea.glsl").write_text(
        '#pragma kernel(output = "height:r32f")\n'
        "float kernel(ivec2 t) { return base_elevation + fract(time) + float(t.x); }\n"
    )
    text = passes(sea=("./sea",), noise=("generation/by_example", 'inputs = { example = "sea" }'))
    (tmp_path / "sketch.toml").write_text("format = 1\nsize = 17\n" + text + map_of("noise"))
    [data] = page_data([load(tmp_path)], time=1.5, engine=any_engine)["sketches"]
    why = "The table of ranks was made by this when the page was exported."
    assert data["terrain"]["lockedMetres"]["base_elevation"] == why
    [note] = [note for note in data["notes"] if note.startswith("sea: ")]
    assert note == "sea: the table of ranks was made of this at 1.5 s, so that it does not move in a page"


BASE = """#pragma kernel(output = "height:r32f")
uniform float rise = 1.0;  //! slider(0, 4) How high
uniform float start = 0.0;  //! slider(0, 4) From where
float kernel(ivec2 texel) { return start + rise * float(texel.x); }
"""
PASS = '[[pass]]\nname = "base"\nuse = "./{}"\n[parameters]\nrise = "base.rise"\n'


@pytest.fixture
def inner(tmp_path: Path, trusted_variants: None) -> Sketch:
    """Return a sketch of a technique whose fast variant lacks a parameter that is inside."""
    (tmp_path / "base.glsl").write_text(BASE)
    (tmp_path / "quick.glsl").write_text(
        "".join(BASE.splitlines(True)[:2] + BASE.splitlines(True)[3:]).replace("start + ", "")
    )
    (tmp_path / "around.toml").write_text(PASS.format("base"))
    (tmp_path / "around.fast.toml").write_text('agrees = "1e-5"\n' + PASS.format("quick"))
    (tmp_path / "sketch.toml").write_text("format = 1\n" + passes(height="./around") + map_of("height"))
    return load(tmp_path)


@pytest.mark.parametrize("name", ["inner", "circles", "fault_formation", "layered_noise"])
def test_parameters_needing_another_plan_are_locked_alone(name: str, inner: Sketch):
    """Set each parameter: where a fast variant gives way to its technique, other passes run."""
    sketch = inner if name == "inner" else load(name)
    result = {row["path"]: row for row in page_data([sketch])["sketches"][0]["shown"]}

    def run_with(values: dict[str, object]) -> list[str]:
        plan = make_plan(sketch.with_values(values), PlanRequest(frame_size=(64, 36), variants=KINDS))
        return [step.path for step in plan.walk()]

    usual = run_with({})
    assert any(".fast." in path for path in usual)
    locked = set()
    for shown in shown_parameters(sketch):
        row = result[shown.path]
        needs_another = run_with({shown.path: row["value"]}) != usual
        assert bool(row["locked"]) == needs_another, shown.path
        locked |= {shown.path} if needs_another else set()
    if name == "inner":
        assert locked == {"height.base.start"}
        assert result["height.base.start"]["locked"].startswith("A faster form of height runs in this page")


def test_a_fixed_image_is_not_locked_away_from_its_sentence():
    values = rows("drape")
    [why] = {row["locked"] for row in values.values() if row["widget"] == "file" and "image" in row["locked"]}
    assert why == "The image was chosen when the page was exported."


# ── in a browser ─────────────────────────────────────────────────────────────

DECODE = """
const bytes = Uint8Array.from(atob(arguments[0]), (one) => one.charCodeAt(0));
createImageBitmap(new Blob([bytes], { type: "image/webp" }),
    { premultiplyAlpha: "none", colorSpaceConversion: "none" }).then((bitmap) => {
  const gl = document.createElement("canvas").getContext("webgl2");
  const { width, height } = bitmap;
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  const target = [gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D];
  gl.framebufferTexture2D(...target, gl.getParameter(gl.TEXTURE_BINDING_2D), 0);
  const texels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, texels);
  let text = "";
  for (let at = 0; at < texels.length; at += 8192) {
    text += String.fromCharCode(...texels.subarray(at, at + 8192));
  }
  window.decoded = btoa(text);
});
"""


@pytest.mark.slow
@pytest.mark.skipif(bool(browsers.MISSING), reason=browsers.MISSING)
def test_a_browser_decodes_an_image_to_the_engines_texels(tmp_path: Path):
    page = page_data([load("drape")])
    [image] = [item for item in page["shared"]["images"].values() if item.get("file")]
    [file] = (SKETCHES / "data").glob("jacksboro_from_above.jpg")
    expected = read_image(file).pixels
    with browsers.Browser(tmp_path / "profile") as browser:
        browser.open("data:text/html,decode")
        browser.run(DECODE, base64.b64encode(bytes_of(page, image["blob"])).decode())
        result = base64.b64decode(browser.wait("window.decoded"))
    np.testing.assert_array_equal(np.frombuffer(result, np.uint8).reshape(expected.shape), expected)
