"""A sketch loaded with cached techniques is the sketch loaded without, after any saves."""

from __future__ import annotations

import os
import random
import time
from pathlib import Path

import pytest

from playground.allowed_files import noting_places
from playground.errors import PlaygroundError, SketchError
from playground.sketch.load import load as load_fresh
from playground.sketch.load import load_with
from playground.sketch.model import kernels_of
from playground.studio.edits.technique_cache import TechniqueCache

KERNEL = """#include "part.glsl"
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return part(); }
"""
PART = "float part() { return 1.0; }\n"
INNER = '[[pass]]\nname = "one"\nuse = "./k"\n[outputs]\nheight = "one"\n'
OUTER = '[[pass]]\nname = "two"\nuse = "./inner"\n[outputs]\nheight = "two"\n'
SKETCH = 'format = 1\n[[pass]]\nname = "height"\nuse = "./outer"\n[[pass]]\nname = "again"\nuse = "./k"\n'


class Files:
    """A sketch's folder, whose files all rested before they are read."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._saved = time.time() - 1e6

    def save(self, name: str, text: str) -> None:
        """Save a file as it was a while ago, and later than all saves before."""
        self._saved += 1.0
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        os.utime(path, (self._saved, self._saved))


@pytest.fixture
def files(tmp_path: Path) -> Files:
    made = Files(tmp_path)
    for name, text in (
        ("part.glsl", PART),
        ("k.glsl", KERNEL),
        ("inner.toml", INNER),
        ("outer.toml", OUTER),
        ("sketch.toml", SKETCH),
    ):
        made.save(name, text)
    return made


def code_in(sketch) -> list[str]:
    return [kernel.source.code for _, kernel in kernels_of(sketch.graph)]


def test_what_rests_is_the_same_object_in_the_next_reading(files: Files):
    techniques = TechniqueCache()
    first = load_with(techniques.begin(), files.folder)
    second = load_with(techniques.begin(), files.folder)
    for name in ("height", "again", "view"):
        assert first.graph.find(name).technique is second.graph.find(name).technique


def test_a_save_of_what_is_included_deep_inside_is_seen(files: Files):
    techniques = TechniqueCache()
    view = load_with(techniques.begin(), files.folder).graph.find("view").technique
    files.save("part.glsl", PART.replace("1.0", "2.0"))
    sketch = load_with(techniques.begin(), files.folder)
    assert sum("return 2.0;" in code for code in code_in(sketch)) == 2
    assert sketch.graph.find("view").technique is view, "nothing of it was saved"


@pytest.mark.parametrize(
    ("name", "text", "other"),
    [
        ("part.glsl", PART, PART.replace("1.0", "2.0")),
        ("k.glsl", KERNEL, KERNEL.replace("part();", "trap();")),
        ("inner.toml", INNER, INNER.replace("one", "xyz")),
        ("outer.toml", OUTER, OUTER.replace("two", "abc")),
    ],
)
def test_a_save_that_keeps_inode_size_and_times_is_seen(files: Files, name: str, text: str, other: str):
    """As ``cp -p`` does, ``unzip -o`` of packed versions, and a save in one tick of a coarse clock."""
    path = files.folder / name
    techniques = TechniqueCache()
    load_with(techniques.begin(), files.folder)
    before = path.stat()
    assert len(text) == len(other)
    path.write_text(other, encoding="utf-8")
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    after = path.stat()
    assert (before.st_ino, before.st_size, before.st_mtime_ns) == (
        after.st_ino,
        after.st_size,
        after.st_mtime_ns,
    )
    assert load_with(techniques.begin(), files.folder) == load_fresh(files.folder)
    path.write_text(text, encoding="utf-8")
    assert load_with(techniques.begin(), files.folder) == load_fresh(files.folder)


def test_a_save_that_changes_times_alone_keeps_a_technique(files: Files):
    techniques = TechniqueCache()
    first = load_with(techniques.begin(), files.folder)
    for path in files.folder.iterdir():
        path.touch()
    second = load_with(techniques.begin(), files.folder)
    assert first.graph.find("height").technique is second.graph.find("height").technique


def test_a_file_that_comes_where_another_was_looked_for_is_seen(files: Files):
    techniques = TechniqueCache()
    load_with(techniques.begin(), files.folder)
    files.save("inner.glsl", KERNEL)
    with pytest.raises(SketchError, match="remove one"):
        load_with(techniques.begin(), files.folder)
    (files.folder / "inner.toml").unlink()
    assert load_with(techniques.begin(), files.folder) == load_fresh(files.folder)


def test_cached_load_notes_same_places_as_full_load(files: Files):
    techniques = TechniqueCache()
    with noting_places() as anew:
        load_fresh(files.folder)
    for _ in range(2):
        with noting_places() as places:
            load_with(techniques.begin(), files.folder)
        assert places == anew


def test_cached_techniques_may_nest_no_deeper(files: Files):
    def chain(first: int, last: int) -> None:
        for level in range(first, last):
            files.save(f"n{level}.toml", INNER.replace("./k", f"./n{level + 1}"))

    chain(0, 10)
    files.save("n10.toml", INNER)
    files.save("sketch.toml", SKETCH.replace("./outer", "./n0"))
    techniques = TechniqueCache()
    load_with(techniques.begin(), files.folder)
    chain(20, 29)
    files.save("n29.toml", INNER.replace("./k", "./n0"))
    files.save("sketch.toml", SKETCH.replace("./outer", "./n20"))
    with pytest.raises(SketchError, match="nest more than"):
        load_with(techniques.begin(), files.folder)


def test_cycle_through_cached_technique_is_found(files: Files):
    techniques = TechniqueCache()
    load_with(techniques.begin(), files.folder)
    files.save("inner.toml", INNER.replace("./k", "./outer"))
    with pytest.raises(SketchError, match="circle"):
        load_with(techniques.begin(), files.folder)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_after_any_saves_it_gives_what_a_reading_anew_gives(files: Files, seed: int):
    rng = random.Random(seed)
    texts = {
        "part.glsl": [PART, PART.replace("1.0", "2.0"), "float part( { }\n"],
        "k.glsl": [
            KERNEL,
            KERNEL.replace("part()", "2.0 * part()"),
            KERNEL.replace("part.glsl", "gone.glsl"),
        ],
        "inner.toml": [INNER, INNER.replace("one", "other"), INNER.replace("./k", "./outer")],
        "outer.toml": [OUTER, OUTER.replace("./inner", "./k"), "format = "],
        "sub.glsl": ["// nothing\n"],
        "k.comp": ['#pragma compute(groups = "1, 1")\nvoid main() {}\n'],
    }
    techniques = TechniqueCache()
    for _ in range(60):
        name = rng.choice(list(texts))
        if rng.random() < 0.25:
            (files.folder / name).unlink(missing_ok=True)
        else:
            files.save(name, rng.choice(texts[name]))
        with noting_places() as places:
            seen = result_of(lambda: load_with(techniques.begin(), files.folder))
        with noting_places() as expected:
            assert seen == result_of(lambda: load_fresh(files.folder))
        assert expected.keys() <= places.keys()


def result_of(loading):
    try:
        return loading()
    except PlaygroundError as error:
        return str(error)
