"""A pass may be as large as the picture that a parameter reads."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.errors import PlaygroundError

from ..loading import load
from ..sketch_texts import map_of, passes

SKETCH = (
    "format = 1\n"
    + passes(photo=("foreign/image", 'set = { image = "a.png" }', "size = SIZE"))
    + map_of("photo")
)


def picture(path: Path, width: int, height: int) -> None:
    write_png(path, np.full((height, width, 4), 255, np.uint8))


def size_of(engine: Engine, folder: Path) -> tuple[int, int]:
    engine.draw(load(folder), size=(8, 8))
    assert engine.record.plan is not None
    return engine.record.plan.step("photo").size  # type: ignore[union-attr]


@pytest.mark.parametrize(
    "size, expected",
    [
        ('"photo.image.size"', (24, 16)),
        ('["photo.image.size.x // 2", "photo.image.size.y + 1"]', (12, 17)),
    ],
)
def test_a_size_names_the_picture(
    tmp_path: Path, any_engine: Engine, size: str, expected: tuple[int, int]
) -> None:
    picture(tmp_path / "a.png", 24, 16)
    (tmp_path / "sketch.toml").write_text(SKETCH.replace("SIZE", size), "utf-8")
    assert size_of(any_engine, tmp_path) == expected


def test_it_follows_the_file_and_the_value(tmp_path: Path, any_engine: Engine) -> None:
    picture(tmp_path / "a.png", 24, 16)
    picture(tmp_path / "b.png", 5, 7)
    (tmp_path / "sketch.toml").write_text(SKETCH.replace("SIZE", '"photo.image.size"'), "utf-8")
    sketch = load(tmp_path)
    for file, expected in (("a.png", (24, 16)), ("b.png", (5, 7)), ("a.png", (24, 16))):
        any_engine.draw(sketch.with_values({"photo.image": file}), size=(8, 8))
        assert any_engine.record.plan is not None
        assert any_engine.record.plan.step("photo").size == expected  # type: ignore[union-attr]
    picture(tmp_path / "a.png", 9, 9)
    any_engine.draw(sketch, size=(8, 8))
    assert any_engine.record.plan.step("photo").size == (9, 9)  # type: ignore[union-attr]


def test_a_file_that_is_missing_or_no_picture_is_named(tmp_path: Path, any_engine: Engine) -> None:
    (tmp_path / "sketch.toml").write_text(SKETCH.replace("SIZE", '"photo.image.size"'), "utf-8")
    with pytest.raises(PlaygroundError, match="no such file"):
        size_of(any_engine, tmp_path)
    (tmp_path / "a.png").write_bytes(b"none")
    with pytest.raises(PlaygroundError, match=r"a\.png"):
        size_of(any_engine, tmp_path)


def test_a_parameter_that_reads_no_picture_has_no_size(tmp_path: Path) -> None:
    (tmp_path / "sketch.toml").write_text(SKETCH.replace("SIZE", '"photo.images.size"'), "utf-8")
    with pytest.raises(PlaygroundError, match=r"photo\.images\.size"):
        load(tmp_path)
