"""The channels of other tools' shaders: what feeds them, what may, and what is saved of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.errors import PlaygroundError
from playground.paths import GLSL
from playground.sketch.assign import values_of
from playground.sketch.load import load
from playground.sketch.model import Sketch
from playground.sketch.save import save
from playground.studio.channels.channels import channels, source_of, sources, with_source
from tests.data.films import own_film

pytestmark = pytest.mark.room("dialects")

TWO = """void mainImage(out vec4 c, in vec2 p) {
    c = texelFetch(iChannel0, ivec2(0), 0) + texelFetch(iChannel1, ivec2(0), 0);
}
"""
ONE = """void mainImage(out vec4 c, in vec2 p) {
    c = vec4(iChannelResolution[0].xy / 255.0, 0.0, 1.0) + 0.0 * texture(iChannel0, p);
}
"""
PART = "void mainImage(out vec4 c, in vec2 p) { c = texelFetch(iChannel0, ivec2(p), 0); }\n"
NONE = "void main() { gl_FragColor = vec4(1.0); }\n"
LAND = '[[pass]]\nname = "land"\nuse = "generation/white_noise"\nsize = 16\n'
PHOTO = '[[pass]]\nname = "photo"\nuse = "foreign/image"\nsize = [8, 4]\nset = { image = "a.png" }\n'
CUBES = ["cube_faces", "sky_box"]
STAND_INS = [
    f"foreign/{file.stem}"
    for file in sorted((GLSL / "foreign").glob("*.glsl"))
    if 'output = "channel_texels:' in file.read_text("utf-8") and file.stem not in CUBES
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in {"two": TWO, "one": ONE, "part": PART, "none": NONE}.items():
        (tmp_path / f"{name}.frag").write_text(text, "utf-8")
    write_png(tmp_path / "a.png", np.full((30, 40, 4), (0, 255, 0, 255), np.uint8))
    return tmp_path


def sketch(folder: Path, view: str, *passes: str) -> Sketch:
    (folder / "sketch.toml").write_text(f"format = 1\n{''.join(passes)}[view]\n{view}\n", "utf-8")
    return load(folder)


def pixel(engine: Engine, shown: Sketch) -> tuple[int, ...]:
    return tuple(int(n) for n in engine.render(shown, size=(4, 4)).array[0, 0, :3])


def test_a_shader_opened_alone_has_its_channels(folder: Path) -> None:
    result = channels(load(folder / "two.frag"))
    assert [(c.path, c.source) for c in result] == [
        ("view.iChannel0", "foreign/noise"),
        ("view.iChannel1", "foreign/noise"),
    ]
    assert channels(load(folder / "none.frag")) == () and channels(load()) == ()


def test_a_sketch_of_a_view_alone_is_the_shader_s_picture(folder: Path, any_engine: Engine) -> None:
    assert pixel(any_engine, sketch(folder, 'use = "./none"')) == (255, 255, 255)
    with pytest.raises(PlaygroundError, match="no passes"):
        sketch(folder, 'use = "view/terrain"')


FILTER = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "inputImage", "TYPE": "image"}]}*/
void main() { gl_FragColor = IMG_THIS_PIXEL(inputImage); }
"""


def test_filter_image_stand_in_has_picture_size(folder: Path, any_engine: Engine) -> None:
    (folder / "filter.fs").write_text(FILTER, "utf-8")
    result = load(folder / "filter.fs")
    for source in ("foreign/picture", "foreign/noise", "foreign/black"):
        any_engine.render(with_source(result, "view.inputImage", source), size=(12, 7))
        assert any_engine.record.plan is not None
        assert any_engine.record.plan.step("inputImage").size == (12, 7)  # type: ignore[union-attr]


CUBE = """uniform samplerCube iChannel0;
void mainImage(out vec4 c, in vec2 p) { c = texture(iChannel0, vec3(1.0)); }
"""


def test_a_cube_is_fed_from_what_has_six_faces(folder: Path, any_engine: Engine) -> None:
    (folder / "cube.frag").write_text(CUBE, "utf-8")
    result = load(folder / "cube.frag")
    assert sources(result, "view.iChannel0") == ["foreign/black", "foreign/cube_faces", "foreign/sky_box"]
    for source in sources(result, "view.iChannel0"):
        any_engine.render(with_source(result, "view.iChannel0", source), size=(4, 4))
        assert any_engine.record.plan is not None
        wide, high = any_engine.record.plan.step("iChannel0").size  # type: ignore[union-attr]
        assert high == 6 * wide


def test_each_source_has_the_size_of_its_kind(folder: Path, any_engine: Engine) -> None:
    result = load(folder / "two.frag")
    sizes = {"keys": (256, 3), "spectrum": (512, 2), "sound": (512, 2), "microphone": (512, 2)}
    sizes |= {"video": (160, 90), "camera": (640, 480), "noise": (256, 256)}
    for name, size in sizes.items():
        any_engine.render(with_source(result, "view.iChannel0", f"foreign/{name}"), size=(4, 4))
        plan = any_engine.record.plan
        assert plan is not None and plan.step("iChannel0").size == size  # type: ignore[union-attr]


KEEPS = """uniform sampler2D backbuffer;
uniform sampler2D u_tex0;
void main() { gl_FragColor = texture2D(backbuffer, vec2(0.5)) + texture2D(u_tex0, vec2(0.5)); }
"""


def test_the_frame_before_is_no_channel(folder: Path) -> None:
    (folder / "keeps.frag").write_text(KEEPS, "utf-8")
    assert [c.path for c in channels(load(folder / "keeps.frag"))] == ["view.u_tex0"]
    assert [c.path for c in channels(sketch(folder, 'use = "./keeps"'))] == ["view.u_tex0"]


def test_channels_are_in_the_order_of_their_numbers(folder: Path) -> None:
    text = "void main() { gl_FragColor = texture2D(u_tex2, vec2(0)) + texture2D(u_tex0, vec2(0)); }\n"
    (folder / "main.frag").write_text("uniform sampler2D u_tex2;\n" + text, "utf-8")
    assert [c.name for c in channels(load(folder / "main.frag"))] == ["u_tex0", "u_tex2"]


def test_channel_sources_are_stand_ins_and_every_other_pass(folder: Path) -> None:
    assert sources(load(folder / "two.frag"), "view.iChannel0") == STAND_INS
    wired = sketch(folder, 'use = "./two"\ninputs = { iChannel0 = "photo" }', LAND, PHOTO)
    assert [(c.path, c.source) for c in channels(wired)] == [
        ("view.iChannel0", "foreign/image"),
        ("view.iChannel1", "foreign/noise"),
    ]
    assert sources(wired, "view.iChannel0") == [*STAND_INS, "land"]
    assert sources(wired, "view.iChannel1") == [*STAND_INS, "land", "photo"]


def test_a_pass_that_reads_the_shader_may_not_feed_it(folder: Path) -> None:
    after = '[[pass]]\nname = "after"\nuse = "./part"\ninputs = { iChannel0 = "first" }\n'
    first = '[[pass]]\nname = "first"\nuse = "./two"\nsize = 8\n'
    result = sketch(folder, 'use = "./part"\ninputs = { iChannel0 = "after" }', first, after)
    assert "after" not in sources(result, "first.iChannel0") and "view" not in sources(
        result, "first.iChannel0"
    )
    assert "first" in sources(result, "view.iChannel0")
    with pytest.raises(PlaygroundError, match="circle"):
        with_source(result, "first.iChannel0", "after")


@pytest.mark.parametrize("alone", [True, False])
def test_each_source_is_what_the_shader_then_reads(folder: Path, any_engine: Engine, *, alone: bool) -> None:
    shown = load(folder / "two.frag") if alone else sketch(folder, 'use = "./two"')
    black = with_source(
        with_source(shown, "view.iChannel0", "foreign/black"), "view.iChannel1", "foreign/black"
    )
    assert pixel(any_engine, black) == (0, 0, 0)
    image = with_source(black, "view.iChannel1", "foreign/image").with_values(
        {"iChannel1.image": str(folder / "a.png")}
    )
    assert pixel(any_engine, image) == (0, 255, 0)
    noise = with_source(black, "view.iChannel1", "foreign/noise")
    first = with_source(black, "view.iChannel0", "foreign/noise")
    assert pixel(any_engine, noise) != pixel(any_engine, first), "the noise of each channel is its own"
    assert source_of(image, "view.iChannel1") == "foreign/image"


def test_a_picture_keeps_its_size(folder: Path, any_engine: Engine) -> None:
    image = with_source(load(folder / "one.frag"), "view.iChannel0", "foreign/image").with_values(
        {"iChannel0.image": str(folder / "a.png")}
    )
    assert pixel(any_engine, image)[:2] == (40, 30)
    back = with_source(image, "view.iChannel0", "foreign/noise")
    assert dict(back.overrides) == {}


def test_a_pass_that_others_read_stays_as_it_is(folder: Path) -> None:
    both = 'use = "./two"\ninputs = { iChannel0 = "photo", iChannel1 = "photo" }'
    shown = sketch(folder, both, PHOTO)
    changed = with_source(shown, "view.iChannel1", "foreign/noise")
    photo = changed.graph.find("photo")
    assert photo is not None and photo.use == "foreign/image"
    assert [(c.path, c.source) for c in channels(changed)] == [
        ("view.iChannel0", "foreign/image"),
        ("view.iChannel1", "foreign/noise"),
    ]


def test_two_shaders_with_the_same_channel_are_fed_apart(folder: Path) -> None:
    first = '[[pass]]\nname = "first"\nuse = "./part"\nsize = 8\n'
    shown = sketch(folder, 'use = "./two"', first)
    changed = with_source(shown, "first.iChannel0", "foreign/picture")
    assert source_of(changed, "first.iChannel0") == "foreign/picture"
    assert source_of(changed, "view.iChannel0") == "foreign/noise"


def test_what_is_no_channel_or_no_source_is_named(folder: Path) -> None:
    shown = load(folder / "two.frag")
    with pytest.raises(PlaygroundError, match=r"no channel 'view\.iChannel7'.*view\.iChannel"):
        with_source(shown, "view.iChannel7", "foreign/noise")
    with pytest.raises(PlaygroundError, match="no technique 'foreign/nois'"):
        with_source(shown, "view.iChannel0", "foreign/nois")
    with pytest.raises(PlaygroundError, match="no pass 'photo'"):
        with_source(shown, "view.iChannel0", "photo")


SOUND = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "heard", "TYPE": "audioFFT", "MAX": 32},
  {"NAME": "waves", "TYPE": "audio"}]}*/
void main() { gl_FragColor = texelFetch(heard, ivec2(0), 0) + texelFetch(waves, ivec2(0), 0); }
"""


def test_a_sound_takes_the_place_of_a_made_up_one(folder: Path) -> None:
    (folder / "a.fs").write_text(SOUND, "utf-8")
    result = load(folder / "a.fs")
    for name, content, size in (("heard", "spectrum", ("32", "1")), ("waves", "waves", ("256", "1"))):
        fed = with_source(result, f"view.{name}", "foreign/sound").graph.find(name)
        assert fed is not None and fed.size == size
        menu = fed.technique.parameter("content").widget.choices
        assert menu[dict(fed.values)["content"]] == content


def test_a_channel_of_several_passes_is_one(folder: Path) -> None:
    head = '/*{"INPUTS": [{"NAME": "inputImage", "TYPE": "image"}], "PASSES": [{"TARGET": "a"}, {}]}*/\n'
    (folder / "b.fs").write_text(
        f"{head}void main() {{ gl_FragColor = IMG_THIS_PIXEL(inputImage); }}\n", "utf-8"
    )
    result = load(folder / "b.fs")
    (channel,) = channels(result)
    assert (channel.path, channel.source, channel.alone) == ("view.inputImage", "foreign/picture", True)
    fed = with_source(result, channel.path, "foreign/image")
    assert [(spec.name, spec.use) for spec in fed.graph.passes][:-1] == [("inputImage", "foreign/image")]


def test_a_film_brings_its_size_and_keys_theirs(folder: Path, any_engine: Engine) -> None:
    own_film(folder / "dance.mp4", count=2, size=(48, 36))
    film = with_source(load(folder / "one.frag"), "view.iChannel0", "foreign/video").with_values(
        {"iChannel0.video": str(folder / "dance.mp4")}
    )
    assert pixel(any_engine, film)[:2] == (48, 36)
    keys = with_source(film, "view.iChannel0", "foreign/keys")
    assert any_engine.read(keys, "iChannel0").shape == (3, 256)
    heard = with_source(film, "view.iChannel0", "foreign/sound")
    assert any_engine.read(heard, "iChannel0").shape == (2, 512)
    seen = with_source(film, "view.iChannel0", "foreign/camera")
    assert any_engine.read(seen, "iChannel0").shape == (480, 640, 4)


# ── What feeds a channel is written into the sketch's file, and read again ───


VIEW = 'format = 1  # ours\n\n[view]\nuse = "./two"\n'
LAND_PHOTO = """format = 1
[[pass]]
name = "land"   # a texture
use = "generation/white_noise"
size = 16
[[pass]]
name = "photo"
use = "foreign/image"
size = [8, 4]   # texels
set = { image = "a.png" }
[view]
use = "./two"
inputs = { iChannel0 = "photo" }
"""


def sources_in(sketch: Sketch) -> list[str]:
    return [channel.source for channel in channels(sketch)]


def parts(sketch: Sketch) -> object:
    return [(spec.name, spec.use, spec.size, spec.inputs) for spec in sketch.graph.passes]


def saved(folder: Path, text: str, *changes: tuple[str, str], **values: str) -> str:
    """Save a sketch of a text with other sources; return the new text, which says what was wanted."""
    file = folder / "sketch.toml"
    file.write_text(text, "utf-8")
    loaded = expected = load(file)
    for channel, source in changes:
        expected = with_source(expected, f"view.{channel}", source)
    expected = expected.with_values({name.replace("__", "."): value for name, value in values.items()})
    save(loaded, expected)
    again = load(file)
    assert sources_in(again) == sources_in(expected)
    assert parts(again) == parts(expected) and values_of(again) == values_of(expected)
    return file.read_text("utf-8")


def test_a_source_comes_as_a_new_pass_at_the_end(folder: Path) -> None:
    text = saved(folder, VIEW, ("iChannel1", "foreign/picture"))
    assert text == VIEW + (
        'inputs = { iChannel1 = "iChannel1" }\n\n'
        '[[pass]]\nname = "iChannel1"\nuse  = "foreign/picture"\nsize = [256, 256]\nset  = { number = 1 }\n'
    )


def test_an_image_has_its_own_size_and_its_file(folder: Path) -> None:
    text = saved(folder, VIEW, ("iChannel0", "foreign/image"), iChannel0__image="a.png")
    assert 'size = ["iChannel0.image.size.x", "iChannel0.image.size.y"]' in text
    assert 'image = "a.png"' in text


def test_another_source_replaces_the_one_there(folder: Path) -> None:
    text = saved(folder, LAND_PHOTO, ("iChannel0", "foreign/noise"))
    assert 'use = "foreign/noise"\nsize = [256, 256]   # texels\n' in text and "a.png" not in text


def test_a_video_has_its_own_size(folder: Path) -> None:
    text = saved(folder, LAND_PHOTO, ("iChannel0", "foreign/video"))
    assert 'use = "foreign/video"\nset = {}\n[view]' in text


def test_a_pass_is_wired_and_the_one_before_stays(folder: Path) -> None:
    text = saved(folder, LAND_PHOTO, ("iChannel0", "land"), ("iChannel1", "photo"))
    assert text == LAND_PHOTO.replace(
        '{ iChannel0 = "photo" }', '{ iChannel0 = "land", iChannel1 = "photo" }'
    )
