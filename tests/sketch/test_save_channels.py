"""What feeds a channel is written into the sketch's file, and read again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.sketch.assign import values_of
from playground.sketch.load import load
from playground.sketch.model import Sketch
from playground.sketch.save import save
from playground.studio.channels.channels import channels, with_source

pytestmark = pytest.mark.room("dialects")

TWO = """void mainImage(out vec4 c, in vec2 p) {
    c = texelFetch(iChannel0, ivec2(0), 0) + texelFetch(iChannel1, ivec2(0), 0);
}
"""
VIEW = 'format = 1  # ours\n\n[view]\nuse = "./two"\n'
PHOTO = """format = 1
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


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "two.frag").write_text(TWO, "utf-8")
    write_png(tmp_path / "a.png", np.full((30, 40, 4), 255, np.uint8))
    return tmp_path


def sources(sketch: Sketch) -> list[str]:
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
    assert sources(again) == sources(expected)
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
    text = saved(folder, PHOTO, ("iChannel0", "foreign/noise"))
    assert 'use = "foreign/noise"\nsize = [256, 256]   # texels\n' in text and "a.png" not in text


def test_a_video_has_its_own_size(folder: Path) -> None:
    text = saved(folder, PHOTO, ("iChannel0", "foreign/video"))
    assert 'use = "foreign/video"\nset = {}\n[view]' in text


def test_a_pass_is_wired_and_the_one_before_stays(folder: Path) -> None:
    text = saved(folder, PHOTO, ("iChannel0", "land"), ("iChannel1", "photo"))
    assert text == PHOTO.replace('{ iChannel0 = "photo" }', '{ iChannel0 = "land", iChannel1 = "photo" }')
