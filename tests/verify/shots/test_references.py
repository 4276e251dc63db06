"""Where references live, what they say, how they are written, and which of them nothing uses."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from playground import paths
from playground.engine.context import ContextInfo
from playground.errors import DataError
from playground.sketch.find import home_of
from playground.sketch.model import Graph, Shot, Sketch
from playground.verify.shots.references import (
    accepted,
    fingerprint_of,
    read_reference,
    reference_path,
    stale_references,
    write_reference,
)

from ...loading import load

LLVMPIPE = ContextInfo(450, "llvmpipe (LLVM 15.0.6, 256 bits)", "Mesa/X.org", "4.5 Mesa 22.3.6", 4)
PICTURE = np.arange(4 * 6 * 4, dtype=np.uint8).reshape(4, 6, 4)


def sketch_in(folder: Path, name: str = "hills", shots: tuple[str, ...] = ("dawn", "dusk")) -> Sketch:
    """Return a sketch without passes: references only need its names and its place."""
    file = folder / f"{name}.toml"
    file.touch()
    graph = Graph(name, str(file), ())
    return Sketch(name, str(file), str(folder), graph, shots=tuple(Shot(shot) for shot in shots))


def put(home: Path, *names: str) -> list[Path]:
    for name in names:
        (home / name).parent.mkdir(parents=True, exist_ok=True)
        (home / name).write_bytes(b"x")
    return [home / name for name in names]


def test_they_are_next_to_a_users_sketch_by_its_name(tmp_path: Path) -> None:
    sketch = sketch_in(tmp_path)
    assert reference_path(sketch, "dawn", "llvmpipe") == tmp_path / "screenshots/hills/llvmpipe/dawn.png"
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "sketch.toml").write_text(
        'format = 1\nsize = 17\n[[pass]]\nname = "height"\nuse = "generation/diamond_square"\n'
    )
    assert reference_path(load(folder), "a", "llvmpipe") == folder / "screenshots/mine/llvmpipe/a.png"


def test_shipped_sketches_have_theirs_in_the_checkout(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    shipped = sketch_in(tmp_path)
    monkeypatch.setattr(paths, "SKETCHES", tmp_path)
    monkeypatch.setattr(paths, "CHECKOUT", tmp_path / "repository")
    assert home_of(shipped) == tmp_path / "repository" / "screenshots"
    monkeypatch.setattr(paths, "CHECKOUT", None)
    with pytest.raises(DataError, match="in the repository; an installed package has none"):
        home_of(shipped)


def test_a_reference_comes_back_as_written_and_says_who_drew_it(tmp_path: Path) -> None:
    sketch = sketch_in(tmp_path)
    path, removed = write_reference(sketch, "dawn", LLVMPIPE, PICTURE)
    assert path == reference_path(sketch, "dawn", "llvmpipe")
    assert removed == []
    reference = read_reference(path)
    np.testing.assert_array_equal(reference.pixels, PICTURE)
    assert reference.fingerprint == fingerprint_of(LLVMPIPE, (6, 4))
    assert reference.text["sketch"] == "hills"
    assert reference.text["shot"] == "dawn"
    assert reference.text["tool"].startswith("terrain-shader-playground ")


def test_further_ones_are_accepted_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    sketch = sketch_in(tmp_path)
    home = home_of(sketch) / "hills" / "llvmpipe"
    assert accepted(sketch, "dawn", "llvmpipe") == []
    expected = put(home, "dawn.png", "dawn.2.png", "dawn.3.png", "dawn.10.png")
    put(home, "dawn.1.png", "dawn.02.png", "dawn.x.png", "dawn-2.png", "dawn2.png", "my-dawn.png")
    put(home.parent / "nvidia-h200", "dawn.4.png")
    assert accepted(sketch, "dawn", "llvmpipe") == expected


def test_new_reference_removes_further_ones_of_its_shot_alone(tmp_path: Path) -> None:
    sketch = sketch_in(tmp_path)
    home = home_of(sketch) / "hills"
    second, third = put(home / "llvmpipe", "dawn.2.png", "dawn.3.png")
    others = [*put(home / "llvmpipe", "dusk.png", "dusk.2.png"), *put(home / "softpipe", "dawn.2.png")]
    path, removed = write_reference(sketch, "dawn", LLVMPIPE, PICTURE)
    assert removed == [second, third]
    assert accepted(sketch, "dawn", "llvmpipe") == [path]
    assert all(file.exists() for file in others)


def test_a_write_that_fails_leaves_the_old_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sketch = sketch_in(tmp_path)
    path, _ = write_reference(sketch, "dawn", LLVMPIPE, PICTURE)

    def full(*_: object) -> None:
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(DataError, match="No space left"):
        write_reference(sketch, "dawn", LLVMPIPE, 255 - PICTURE)
    monkeypatch.undo()
    assert [file.name for file in path.parent.iterdir()] == ["dawn.png"]
    np.testing.assert_array_equal(read_reference(path).pixels, PICTURE)


NAMES = "hills/llvmpipe/noon hills/llvmpipe/noon.2 hills/llvmpipe/dawn.1 hills/llvmpipe/dawn.old hills/dawn"
STALE = f"{NAMES} hills/llvmpipe/more/dawn dawn gone/llvmpipe/dawn".split()


def test_what_no_shot_uses_is_stale(tmp_path: Path) -> None:
    sketch = sketch_in(tmp_path)
    assert stale_references([sketch]) == []
    home = home_of(sketch)
    used = put(
        home, *(f"hills/{name}.png" for name in ("llvmpipe/dawn", "llvmpipe/dawn.2", "nvidia-h200/dusk"))
    )
    assert stale_references([sketch]) == []
    stale = put(home, *(f"{name}.png" for name in STALE))
    assert stale_references([sketch]) == sorted(stale)
    assert stale_references([sketch_in(tmp_path, shots=())]) == sorted([*stale, *used])


def test_another_sketch_of_the_folder_keeps_its_own(tmp_path: Path) -> None:
    hills, lakes = sketch_in(tmp_path), sketch_in(tmp_path, "lakes", ("noon",))
    stale = put(home_of(hills), "hills/llvmpipe/noon.png", "lakes/llvmpipe/dawn.png")
    put(home_of(hills), "hills/llvmpipe/dawn.png", "lakes/llvmpipe/noon.png")
    assert stale_references([hills]) == stale[:1]
    assert stale_references([lakes]) == stale[1:]
    assert stale_references([hills, lakes]) == stale


def test_of_shipped_sketches_a_removed_one_leaves_stale_ones(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    sketches = tmp_path / "glsl" / "sketches"
    sketches.mkdir(parents=True)
    monkeypatch.setattr(paths, "SKETCHES", sketches)
    monkeypatch.setattr(paths, "CHECKOUT", tmp_path)
    hills = sketch_in(sketches)
    sketch_in(sketches, "lakes")
    put(home_of(hills), "hills/llvmpipe/dawn.png", "lakes/llvmpipe/any.png")
    stale = put(home_of(hills), "removed/llvmpipe/dawn.png")
    assert stale_references([hills]) == stale
