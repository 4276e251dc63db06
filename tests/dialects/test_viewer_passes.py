"""glslViewer's passes: each the text with its macro; floods and pyramids against slower truths."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from playground.engine.sketch_warnings import warnings_of_kernel
from playground.sketch.warnings import warnings_of_sketch

from ..loading import load
from .drawing import notes

HEAD = "uniform vec2 u_resolution;\n"
PASSES = """void main() {{
    vec2 st = gl_FragCoord.xy / u_resolution;
#if defined({define})
    gl_FragColor = {value};
#else
    gl_FragColor = {picture};
#endif
}}
"""


def text_of(define, value, picture, head=""):
    return HEAD + head + PASSES.format(define=define, value=value, picture=picture)


@pytest.fixture
def read(any_engine, folder):
    """Return what a pass of a text writes, row 0 below."""

    def read_(text, name, size=(24, 16)):
        sketch = load(folder.write("t.frag", text))
        return any_engine.read(sketch, f"view.{name}", size=size) if name else sketch

    return read_


@pytest.fixture
def picture(any_engine, folder):
    def picture_(text, size=(24, 16), time=0.0):
        render = any_engine.render(load(folder.write("t.frag", text)), size=size, time=time)
        return render.array[::-1] / 255.0  # row 0 below

    return picture_


# ── buffers ──────────────────────────────────────────────────────────────────


def test_a_buffer_that_no_pass_writes_reads_black_and_is_named(read, picture):
    text = text_of(
        "BUFFER_0",
        "vec4(1.0)",
        "texture2D(u_buffer0, st) + texture2D(u_buffer7, st)",
        "uniform sampler2D u_buffer7;\n",
    )
    kernel = read(text, "").graph.find("view").technique.find("view").technique
    assert ("u_buffer7", "it reads black") in kernel.unfed
    np.testing.assert_allclose(picture(text)[0, 0], 1.0)


@pytest.mark.parametrize("define", ["BUFFER_3", "DOUBLE_BUFFER_3", "PYRAMID_3", "FLOOD_3"])
def test_a_pass_that_nothing_reads_is_named(read, define):
    name = define.lower().replace("_3", "3")
    sampler = {"DOUBLE_BUFFER_3": "u_doubleBuffer3"}.get(define, f"u_{name}")
    used = text_of(define, "vec4(1.0)", f"texture2D({sampler}, st)")
    assert warnings_of_sketch(read(used, "")) == ()
    (note,) = warnings_of_sketch(read(text_of(define, f"texture2D({sampler}, st)", "vec4(st, 0.0, 1.0)"), ""))
    assert re.match(
        rf"the picture reads nothing of {name}\b|the picture reads nothing of {name}_", note.message
    )
    assert note.message.endswith(": what the picture does not need is not drawn")


def test_a_parameter_of_several_passes_is_one(read):
    text = text_of("BUFFER_0", "vec4(gain)", "texture2D(u_buffer0, st) * gain", "uniform float gain = 0.5;\n")
    assert [p.name for p in read(text, "").graph.find("view").technique.parameters] == ["gain"]
    alone = text.replace("* gain", "* 2.0")  # one pass reads it, all declare it
    result = read(alone, "")
    assert [p.name for p in result.graph.find("view").technique.parameters] == ["gain"]
    assert not [w.message for _, kernel in result.graph.kernels for w in warnings_of_kernel(kernel)]
    none = read(alone.replace("vec4(gain)", "vec4(1.0)"), "").graph.kernels
    assert any("nothing reads 'gain'" in w.message for _, kernel in none for w in warnings_of_kernel(kernel))


# ── post-processing and background ───────────────────────────────────────────


@pytest.mark.parametrize("frames", [1, 2, 5])
@pytest.mark.parametrize("define", ["DOUBLE_BUFFER_0", "BUFFER_0"])
def test_a_buffer_reads_the_scene_of_the_frame_before(picture, define, frames):
    mixed = "mix(texture2D(u_doubleBuffer0, st), texture2D(u_scene, st), 0.25)"
    text = f"""uniform vec2 u_resolution;
uniform sampler2D u_doubleBuffer0, u_buffer0, u_scene;
void main() {{
    vec2 st = gl_FragCoord.xy / u_resolution;
    gl_FragColor = vec4(st, 0.6, 1.0);
#if defined({define})
    gl_FragColor = {mixed if define.startswith("D") else "texture2D(u_scene, st)"};
#elif defined(POSTPROCESSING)
    gl_FragColor = texture2D(u_{"doubleBuffer0" if define.startswith("D") else "buffer0"}, st);
#endif
}}
"""
    scene = np.round(255 * np.dstack([*np.meshgrid((np.arange(24) + 0.5) / 24, (np.arange(16) + 0.5) / 16)]))
    scene = scene / 255
    kept = np.zeros_like(scene)
    for frame in range(frames):
        before = scene if frame else np.zeros_like(scene)
        kept = 0.75 * kept + 0.25 * before if define.startswith("D") else before
    result = picture(text, time=(frames - 0.5) / 60)[..., :2]
    np.testing.assert_allclose(result, kept, atol=1.01 / 255)


SHADOWS = """uniform vec2 u_resolution;
void main() {
    float shade = texture2D(LIGHT_SHADOWMAP, gl_FragCoord.xy / LIGHT_SHADOWMAP_SIZE).r;
    gl_FragColor = vec4(gl_FragCoord.xy / u_resolution, shade, 1.0);
}
"""


@pytest.mark.parametrize("passes", [False, True])
def test_unguarded_shadow_map_reads_black_and_is_named(picture, read, passes):
    post = "#ifdef POSTPROCESSING\nvoid main() { gl_FragColor = texture2D(u_scene, vec2(0.5)); }\n#else\n"
    text = f"{post}{SHADOWS}#endif\n" if passes else SHADOWS
    assert (picture(text)[..., 2] == 0).all()
    kernels = [kernel for _, kernel in read(text, "").graph.kernels]
    assert any(("LIGHT_SHADOWMAP", "it reads black") in kernel.unfed for kernel in kernels)
    asked = text.replace("float shade =", "float shade = 1.0;\n#ifdef LIGHT_SHADOWMAP\n    shade =")
    asked = asked.replace("_SIZE).r;", "_SIZE).r;\n#endif")
    assert (picture(asked)[..., 2] == 1).all(), "a text that asks for it does without"


# ── floods ───────────────────────────────────────────────────────────────────

FLOOD_TEXT = """#elif defined(FLOOD_ALGORITHM)
    float jump = exp2(float(u_floodTotal - u_floodIndex - 1));
    vec4 best = vec4(0.0);
    float least = 1e9;
    for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
            vec4 seed = texture2D(u_floodSrc, st + vec2(x, y) * jump / u_resolution);
            float far = distance(seed.xy, st);
            if (seed.xy != vec2(0.0) && far <= least) { least = far; best = seed; }
        }
    }
    gl_FragColor = best;
"""
FLOOD_HEAD = """uniform sampler2D u_flood0, u_floodSrc, u_tex0;
uniform int u_floodIndex, u_floodTotal;
float chance(vec2 p) { return fract(sin(dot(floor(p), vec2(12.9898, 78.233))) * 43758.5453); }
"""
SIZES = [(64, 64), (100, 37), (31, 90), (1, 1), (3, 2)]


def flood_text(own):
    text = text_of(
        "FLOOD_0",
        "chance(gl_FragCoord.xy) < 0.02 || floor(gl_FragCoord.xy) == vec2(0.0) ? vec4(st, st) : vec4(0.0)",
        "texture2D(u_flood0, st)",
        FLOOD_HEAD,
    )
    return text.replace("#else", f"{FLOOD_TEXT}#else") if own else text


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("own", [False, True])
def test_a_flood_finds_the_nearest_seed(read, size, own):
    text, (width, height) = flood_text(own), size
    seeds, result = read(text, "flood0_seeds", size), read(text, "flood0", size)
    there = (seeds[..., :2] != 0).any(-1)
    assert there.any()
    truth = distance_transform_edt(~there, sampling=(1 / height, 1 / width))  # shares of the picture
    y, x = np.mgrid[:height, :width]
    places = np.stack([(x + 0.5) / width, (y + 0.5) / height], -1)
    distances = np.hypot(*np.moveaxis(result[..., :2].astype(np.float64) - places, -1, 0))
    near = 1e-6  # of single precision
    assert (distances >= truth - near).all(), "nearer than any seed"
    wrong = distances > truth + near
    assert wrong.mean() < 0.01  # Rong and Tan 2006: fewer than 1 % for seeds at random
    np.testing.assert_array_equal(result[there], seeds[there])  # a seed is its own
    known_names = {tuple(seed) for seed in seeds[there].tolist()}
    assert all(tuple(item) in known_names for item in result.reshape(-1, 4).tolist())


def test_the_rounds_of_a_flood_are_as_many_as_its_size_needs(read):
    head = FLOOD_HEAD
    text = text_of("FLOOD_0", "vec4(1.0)", "texture2D(u_flood0, st)", head).replace(
        "#else",
        "#elif defined(FLOOD_ALGORITHM)\n    gl_FragColor = texture2D(u_floodSrc, st)\n"
        "        + vec4(float(u_floodTotal), 1.0, 0.0, 0.0);\n#else",
    )
    for size, rounds in {(8, 8): 4, (9, 4): 5, (2, 33): 7, (1, 1): 1}.items():
        np.testing.assert_array_equal(
            read(text, "flood0", size)[0, 0], [1 + rounds * rounds, 1 + rounds, 1, 1]
        )


@pytest.mark.parametrize("own", [False, True])
def test_a_flood_of_a_share_of_the_picture(read, own):
    text = flood_text(own).replace(
        "uniform sampler2D u_flood0, u_floodSrc,",
        "uniform sampler2D u_flood0; // 0.5\nuniform sampler2D u_floodSrc,",
    )
    seeds, result = read(text, "flood0_seeds", (64, 40)), read(text, "flood0", (64, 40))
    assert result.shape == (20, 32, 4) and (result[..., :2] != 0).all()
    there = (seeds[..., :2] != 0).any(-1)
    np.testing.assert_array_equal(result[there], seeds[there])


# ── pyramids ─────────────────────────────────────────────────────────────────

H1, H2, G = np.array([0.1507, 0.6836, 1.0334, 0.6836, 0.1507]), 0.0270, np.array([0.0312, 0.7753, 0.0312])


def divided(sums):
    alpha = sums[..., 3:]
    return np.where(
        alpha == 0, sums, np.concatenate([sums[..., :3] / np.where(alpha == 0, 1, alpha), alpha * 0 + 1], -1)
    )


def weighed(image, rows, columns, weights, clamped):
    """Sum an image's texels around places, by the outer product of weights; outside there is nothing."""
    total, reach = np.zeros((len(rows), len(columns), 4)), len(weights) // 2
    for dy in range(-reach, reach + 1):
        for dx in range(-reach, reach + 1):
            y, x = rows + dy, columns + dx
            inside = ((y >= 0) & (y < image.shape[0]))[:, None] & ((x >= 0) & (x < image.shape[1]))[None]
            some = image[np.clip(y, 0, image.shape[0] - 1)][:, np.clip(x, 0, image.shape[1] - 1)]
            weight = weights[dy + reach] * weights[dx + reach]
            total += weight * some * (1.0 if clamped else inside[..., None])
    return total


def pyramid(foot):
    """Return a pyramid's result by NumPy, in double precision."""
    height, width = foot.shape[:2]
    levels = max(min(int(np.log2(min(width, height))) - 1, 12), 0)
    downs = [foot]
    for level in range(1, levels + 1):
        rows, columns = np.arange(max(height >> level, 1)), np.arange(max(width >> level, 1))
        downs.append(divided(weighed(downs[-1], rows * 2 + 1, columns * 2 + 1, H1, False)))
    above = downs[-1]
    for level in reversed(range(levels)):
        own = downs[level]
        rows, columns = np.arange(own.shape[0]), np.arange(own.shape[1])
        coarse = H2 * weighed(above, rows // 2, columns // 2, H1, False)
        above = divided(weighed(own, rows, columns, G, True) + coarse)
    return above, levels


PYRAMID_TEXT = """#elif defined({macro})
    if (!{begins}Upscaling) {{
        for (int y = -2; y <= 2; ++y) for (int x = -2; x <= 2; ++x) {{
            ivec2 p = ivec2(gl_FragCoord.xy) * 2 + 1 + ivec2(x, y);
            if (p == clamp(p, ivec2(0), textureSize({begins}Tex0, 0) - 1))
                gl_FragColor += texelFetch({begins}Tex0, p, 0) * h1(x) * h1(y);
        }}
    }} else {{
        for (int y = -1; y <= 1; ++y) for (int x = -1; x <= 1; ++x) {{
            ivec2 p = clamp(ivec2(gl_FragCoord.xy) + ivec2(x, y), ivec2(0), textureSize({begins}Tex0, 0) - 1);
            gl_FragColor += texelFetch({begins}Tex0, p, 0) * g(x) * g(y);
        }}
        for (int y = -2; y <= 2; ++y) for (int x = -2; x <= 2; ++x) {{
            ivec2 p = ivec2(gl_FragCoord.xy) / 2 + ivec2(x, y);
            if (p == clamp(p, ivec2(0), textureSize({begins}Tex1, 0) - 1))
                gl_FragColor += texelFetch({begins}Tex1, p, 0) * 0.0270 * h1(x) * h1(y);
        }}
    }}
    if (gl_FragColor.a != 0.0) gl_FragColor = vec4(gl_FragColor.rgb / gl_FragColor.a, 1.0);
"""
PYRAMID_HEAD = """uniform sampler2D {begins}0, {begins}Tex0, {begins}Tex1;
uniform bool {begins}Upscaling;
float h1(int i) {{ return abs(i) == 2 ? 0.1507 : abs(i) == 1 ? 0.6836 : 1.0334; }}
float g(int i) {{ return i == 0 ? 0.7753 : 0.0312; }}
float chance(vec2 p) {{ return fract(sin(dot(floor(p), vec2(12.9898, 78.233))) * 43758.5453); }}
"""


def pyramid_text(begins, macro, own):
    holes = "chance(gl_FragCoord.xy) < 0.1 ? vec4(st, chance(gl_FragCoord.yx), 1.0) : vec4(0.0)"
    head = PYRAMID_HEAD.format(begins=begins)
    text = text_of(f"{macro}_0", holes, f"texture2D({begins}0, st)", head)
    text = text.replace("vec2 st =", "gl_FragColor = vec4(0.0);\n    vec2 st =")
    algorithm = PYRAMID_TEXT.format(begins=begins, macro=f"{macro}_ALGORITHM")
    return text.replace("#else", f"{algorithm}#else") if own else text


@pytest.mark.parametrize("size", [(32, 32), (50, 33), (17, 70), (5, 4), (3, 2)])
@pytest.mark.parametrize(
    ("begins", "macro", "own"),
    [
        ("u_pyramid", "PYRAMID", False),
        ("u_pyramid", "PYRAMID", True),
        ("u_convolutionPyramid", "CONVOLUTION_PYRAMID", True),
        ("u_pyramid", "CONVOLUTION_PYRAMID", True),
    ],
)
def test_a_pyramid_is_that_of_numpy(read, size, begins, macro, own):
    text = pyramid_text(begins, macro, own)
    foot, result = read(text, "pyramid0_foot", size), read(text, "pyramid0", size)
    expected, levels = pyramid(foot.astype(np.float64))
    # Each level adds at most 34 products of numbers below 1.1 and divides: single precision, by level.
    np.testing.assert_allclose(result, expected, atol=2 * max(levels, 1) * 40 * 2**-23)
    if levels > 2:
        assert (result[..., 3] == 1).mean() > 0.99 and (foot[..., 3] == 0).mean() > 0.8, "holes are filled"


def test_each_level_is_told_which_it_is(read):
    text = text_of(
        "PYRAMID_0", "vec4(1.0)", "texture2D(u_pyramid0, st)", "uniform sampler2D u_pyramidTex0;\n"
    ).replace(
        "#else",
        "#elif defined(PYRAMID_ALGORITHM)\n    gl_FragColor = vec4(float(u_pyramidDepth), "
        "float(u_pyramidTotalDepth), float(u_pyramidUpscaling), texture2D(u_pyramidTex0, st).a);\n#else",
    )
    for size, total in {(64, 48): 4, (33, 200): 4, (8, 8): 2}.items():
        for level in range(total):
            np.testing.assert_array_equal(
                read(text, f"pyramid0_down{level}", size)[0, 0, :3], [level, total, 0]
            )
            up = "pyramid0" if level == 0 else f"pyramid0_up{level}"
            np.testing.assert_array_equal(read(text, up, size)[0, 0, :3], [level, total, 1])


def test_a_pyramid_of_a_share_of_the_picture(read):
    text = pyramid_text("u_pyramid", "PYRAMID", False).replace(
        "uniform sampler2D u_pyramid0, u_pyramidTex0",
        "uniform sampler2D u_pyramid0; // 0.5\nuniform sampler2D u_pyramidTex0",
    )
    assert read(text, "pyramid0", (64, 40)).shape == (20, 32, 4)


def test_sampler_of_algorithm_pass_is_not_unfed_elsewhere(folder):
    head = "uniform sampler2D u_pyramid0, u_pyramidTex0;\nuniform sampler2D u_pyramidTex1;\n"
    head += "uniform bool u_pyramidUpscaling;\nuniform int u_pyramidDepth;\n"
    body = """void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
#if defined(PYRAMID_0)
    gl_FragColor = vec4(st, 0.0, 1.0);
#elif defined(PYRAMID_ALGORITHM)
    gl_FragColor = texture2D(u_pyramidTex0, st);
    if (u_pyramidUpscaling && u_pyramidDepth > 0) gl_FragColor += texture2D(u_pyramidTex1, st);
#else
    gl_FragColor = texture2D(u_pyramid0, st);
#endif
}
"""
    sketch = load(folder.write("t.frag", HEAD + head + body))
    messages = [w.message for _, kernel in sketch.graph.kernels for w in warnings_of_kernel(kernel)]
    assert [*messages, *notes(sketch)] == []
    lonely = load(folder.write("t.frag", HEAD + head + "uniform bool u_idle;\n" + body))
    messages = {w.message for _, kernel in lonely.graph.kernels for w in warnings_of_kernel(kernel)}
    assert messages == {"nothing reads 'u_idle', so it has no effect"}
