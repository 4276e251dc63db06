"""Passes are added, wired, deleted, duplicated and moved in a sketch's text, and all else stays as it was."""

from __future__ import annotations

import random
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from playground.errors import PlaygroundError, SketchError
from playground.paths import SKETCHES
from playground.sketch.edit_passes import (
    PassEdit,
    added,
    closes_circle,
    deleted,
    duplicated,
    moved,
    passed_on,
    put_on_wire,
    save_passes,
    unwired,
    wired,
    wires_of,
    without_muted,
)
from playground.sketch.flat import Ref, leaves_of
from playground.sketch.flatten import flatten
from playground.sketch.model import Sketch

from ..loading import load

TEXT = """# Hills under a sky.
format = 1
size   = 33
main   = ["height.seed", "light.sun"]  # what it is about

# The land.
[[pass]]
name = "height"
use  = "generation/fbm"
set  = { seed = 7 }

# Its colours, and
# nothing else.
[[pass]]
name = "colour"
use  = "texturing/height_blend"
[pass.set]
ragged = 25   # texels

[[pass]]
name = "light"
use  = "lighting/l_dot_n"

[view]
use    = "view/terrain"
camera = { azimuth = 30.0 }

[[preset]]
name = "noon"
set  = { "light.gain" = 2.0, "height.seed" = 3 }
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "land.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


def edited(path: Path, edit: PassEdit) -> Sketch:
    """Write an edit, and load the result."""
    sketch = load(path)
    before = path.read_bytes()
    save_passes(sketch, edit)
    assert path.read_bytes() != before
    return load(path)


def joined(sketch: Sketch) -> set[tuple[str, str]]:
    """Return the passes that read each other, by the kernels that run in them: slower, and independent."""
    flat = flatten(sketch)
    pairs = set()
    for leaf in leaves_of(flat.nodes):
        for _, source in leaf.inputs:
            if isinstance(source, Ref):
                pairs.add((source.path.partition(".")[0], leaf.path.partition(".")[0]))
    return {(giver, reader) for giver, reader in pairs if giver != reader}


@pytest.mark.parametrize("name", ["jacksboro", "mixed", "coast", "rivers", "trees", "by_example"])
def test_wires_are_those_of_the_kernels_inside(name: str) -> None:
    path = SKETCHES / f"{name}.toml"
    if not path.exists():
        pytest.skip("not shipped")
    sketch = load(path)
    wires = {(wire.giver, wire.reader) for wire in wires_of(sketch.graph) if wire.giver != wire.reader}
    assert wires == joined(sketch)


def test_a_pass_comes_behind_another_and_its_readers_read_it(file: Path) -> None:
    sketch = edited(file, added(load(file), "erosion/thermal", "height"))
    assert [spec.name for spec in sketch.graph.passes] == ["height", "thermal", "colour", "light", "view"]
    assert joined(sketch) == {
        ("height", "thermal"),
        *(("thermal", reader) for reader in ("colour", "light", "view")),
        ("colour", "view"),
        ("light", "view"),
    }
    text = file.read_text(encoding="utf-8")
    new = '[[pass]]\nname   = "thermal"\nuse    = "erosion/thermal"\ninputs = { height = "height" }\n'
    assert f"set  = {{ seed = 7 }}\n\n{new}\n# Its colours, and\n# nothing else.\n[[pass]]" in text
    without = text.replace(f"{new}\n", "")
    for line in ('inputs = { height = "thermal" }\n', 'inputs.height = "thermal"\n'):
        without = without.replace(line, "")
    assert without == TEXT


def test_a_pass_of_another_output_takes_no_reader_away(file: Path) -> None:
    sketch = edited(file, added(load(file), "lighting/horizons", "height"))
    assert ("height", "horizons") in joined(sketch) and ("height", "light") in joined(sketch)
    assert not any(giver == "horizons" for giver, _ in joined(sketch))


def test_a_new_pass_goes_on_one_wire_alone(file: Path) -> None:
    sketch = edited(file, added(load(file), "erosion/thermal", on=("light", "height")))
    assert ("height", "thermal") in joined(sketch) and ("thermal", "light") in joined(sketch)
    assert {("height", "colour"), ("height", "view")} <= joined(sketch)
    assert ("height", "light") not in joined(sketch) and ("thermal", "view") not in joined(sketch)
    for use, words in (("generation/fbm", "no input"), ("lighting/l_dot_n", "gives nothing")):
        with pytest.raises(SketchError, match=words):
            added(load(file), use, on=("colour", "height"))
    with pytest.raises(SketchError, match="nothing feeds 'mask'"):
        added(load(file), "erosion/thermal", on=("light", "mask"))


def test_a_pass_dropped_on_a_wire_goes_between(file: Path) -> None:
    """It leaves the place where it was, as if deleted there; by text, all but the wires stays."""
    edited(file, added(load(file), "erosion/thermal", "height"))
    edited(file, added(load(file), "generation/smooth", "thermal"))
    text = file.read_text(encoding="utf-8")
    sketch = edited(file, put_on_wire(load(file), "smooth", "thermal", "height"))
    assert {("height", "smooth"), ("smooth", "thermal"), ("thermal", "view")} <= joined(sketch)
    assert not {("thermal", "smooth"), ("smooth", "view"), ("height", "thermal")} & joined(sketch)
    kept = [line for line in file.read_text(encoding="utf-8").splitlines() if "inputs" not in line]
    assert kept == [line for line in text.splitlines() if "inputs" not in line]
    sketch = edited(file, put_on_wire(sketch, "smooth", "view", "height"))
    assert {("height", "thermal"), ("thermal", "smooth"), ("smooth", "view")} <= joined(sketch)
    assert ("thermal", "light") in joined(sketch), "the other readers stay where they are"


def test_a_pass_that_does_not_fit_a_wire_is_refused(file: Path) -> None:
    edited(file, added(load(file), "erosion/thermal", "height"))
    sketch = load(file)
    for name, reader, given, words in (
        ("height", "light", "height", "takes no input"),
        ("colour", "light", "height", "gives nothing that 'light' reads"),
        ("view", "light", "height", "gives nothing|itself"),
        ("thermal", "colour", "mask", "nothing feeds"),
        ("thermal", "thermal", "height", "itself"),
    ):
        with pytest.raises(SketchError, match=words):
            put_on_wire(sketch, name, reader, given)
    edited(file, duplicated(sketch, "height"))
    with pytest.raises(SketchError, match="takes no input"):
        put_on_wire(load(file), "height_2", "light", "height")


CIRCLE = """format = 1
size = 9
[[pass]]
name = "rock"
use = "generation/fbm"
[[pass]]
name = "sand"
use = "generation/fbm"
[[pass]]
name = "smooth"
use = "generation/smooth"
inputs = { height = "rock" }
[[pass]]
name = "both"
use = "./both"
inputs = { height = "sand", other = "smooth" }
[view]
use = "./shown"
inputs = { height = "both" }
"""
BOTH = """#pragma kernel(output = "height:r32f")
uniform sampler2D height; //! input
uniform sampler2D other; //! input
float kernel(ivec2 texel) { return texelFetch(height, texel, 0).r + texelFetch(other, texel, 0).r; }
"""


def test_a_pass_that_would_be_made_of_itself_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "two.toml"
    file.write_text(CIRCLE, encoding="utf-8")
    (tmp_path / "both.glsl").write_text(BOTH, encoding="utf-8")
    shown = BOTH.replace("uniform sampler2D other; //! input\n", "").replace(
        " + texelFetch(other, texel, 0).r", ""
    )
    (tmp_path / "shown.glsl").write_text(shown, encoding="utf-8")
    with pytest.raises(SketchError, match="never end"):
        put_on_wire(load(file), "both", "smooth", "height")
    sketch = edited(file, put_on_wire(load(file), "smooth", "both", "height"))
    assert {("sand", "smooth"), ("smooth", "both"), ("rock", "both")} <= joined(sketch)


def test_a_branch_leaves_the_readers(file: Path) -> None:
    sketch = edited(file, added(load(file), "erosion/thermal", "height", "height", between=False))
    assert joined(sketch) == joined(load(SKETCHES / "mixed.toml")) | {("height", "thermal")}


def test_a_name_that_is_taken_is_counted_on(file: Path) -> None:
    edited(file, added(load(file), "generation/smooth", "height"))
    sketch = edited(file, added(load(file), "generation/smooth", "smooth"))
    assert [spec.name for spec in sketch.graph.passes][:3] == ["height", "smooth", "smooth_2"]


def test_a_pass_at_the_end_changes_no_wire(file: Path) -> None:
    before = joined(load(file))
    sketch = edited(file, added(load(file), "generation/fbm"))
    assert sketch.graph.passes[-2].name == "fbm" and joined(sketch) == before


def test_without_a_view_in_the_file_the_picture_stays(file: Path) -> None:
    file.write_text('format = 1\n[[pass]]\nname = "a"\nuse = "generation/fbm"\n', encoding="utf-8")
    sketch = edited(file, added(load(file), "generation/white_noise"))
    assert joined(sketch) == {("a", "view")} and sketch.graph.passes[-1].use == "view/map"


def test_a_wire_is_written_with_its_pass_and_taken_away(file: Path) -> None:
    edited(file, added(load(file), "generation/fbm"))
    sketch = edited(file, wired(load(file), "fbm", "height", "light", "height"))
    assert ("fbm", "light") in joined(sketch) and ("height", "light") not in joined(sketch)
    assert 'use  = "lighting/l_dot_n"\ninputs = { height = "fbm" }\n' in file.read_text(encoding="utf-8")
    sketch = edited(file, unwired(load(file), "light", "height"))
    assert ("height", "light") in joined(sketch)


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda s: wired(s, "light", "light", "height", "height"), ["height", "input"]),
        (lambda s: wired(s, "nothing", "light", "view", "light"), ["nothing"]),
        (lambda s: wired(s, "light", "lihgt", "view", "light"), ["lihgt", "light"]),
        (lambda s: unwired(s, "light", "height"), ["light", "height", "name"]),
        (lambda s: deleted(s, "view"), ["view"]),
        (lambda s: deleted(s, "height"), ["colour", "height"]),
        (lambda s: duplicated(s, "view"), ["view"]),
        (lambda s: moved(s, "height", -1), ["height", "first"]),
        (lambda s: moved(s, "light", 1), ["light", "last"]),
        (lambda s: added(s, "erosion/nothing", "height"), ["erosion/nothing"]),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(
    file: Path, edit: Callable[[Sketch], PassEdit], words: list[str]
) -> None:
    with pytest.raises(PlaygroundError) as raised:
        edit(load(file))
    assert all(word in str(raised.value) for word in words)
    assert file.read_text(encoding="utf-8") == TEXT


def test_a_circle_is_refused(file: Path) -> None:
    for _ in range(2):
        edited(file, added(load(file), "generation/smooth", "height"))
    sketch = load(file)
    assert closes_circle(sketch.graph, "smooth", "smooth_2") and closes_circle(
        sketch.graph, "smooth", "smooth"
    )
    assert not closes_circle(sketch.graph, "height", "smooth")
    with pytest.raises(SketchError, match="made from"):
        wired(sketch, "smooth", "height", "smooth_2", "height")


def test_deleting_joins_what_was_before_to_what_is_behind(file: Path) -> None:
    first = file.read_text(encoding="utf-8")
    edited(file, added(load(file), "erosion/thermal", "height"))
    sketch = edited(file, deleted(load(file), "thermal"))
    assert joined(sketch) == joined(load(SKETCHES / "mixed.toml"))
    text = file.read_text(encoding="utf-8")
    assert [line for line in text.splitlines() if "inputs" not in line] == first.splitlines()


def test_deleting_takes_along_what_is_set_of_a_pass(file: Path) -> None:
    sketch = edited(file, deleted(load(file), "light"))
    assert sketch.main == ("height.seed",) and sketch.presets[0].values == (("height.seed", 3),)
    text = file.read_text(encoding="utf-8")
    assert "light" not in text.partition("[view]")[0] and "# what it is about" in text


def test_a_copy_has_what_its_original_sets_and_reads(file: Path) -> None:
    sketch = edited(file, duplicated(load(file), "colour"))
    copy, original = sketch.graph.find("colour_2"), sketch.graph.find("colour")
    assert copy is not None and original is not None and copy.values == original.values
    assert ("colour", "view") in joined(sketch) and ("height", "colour_2") in joined(sketch)
    text = file.read_text(encoding="utf-8")
    assert text.count("ragged = 25   # texels") == 2 and text.count("# Its colours") == 1


def test_moving_changes_the_order_and_no_wire(file: Path) -> None:
    before = joined(load(file))
    sketch = edited(file, moved(load(file), "light", -1))
    assert [spec.name for spec in sketch.graph.passes] == ["height", "light", "colour", "view"]
    assert joined(sketch) == before
    sketch = edited(file, moved(load(file), "light", 1))
    assert file.read_text(encoding="utf-8") == TEXT


def test_the_first_pass_may_go_behind_what_reads_it(file: Path) -> None:
    before = joined(load(file))
    sketch = edited(file, moved(load(file), "height", 1))
    assert [spec.name for spec in sketch.graph.passes][:2] == ["colour", "height"] and joined(
        sketch
    ) == before


def test_lines_end_as_before(file: Path) -> None:
    file.write_bytes(TEXT.replace("\n", "\r\n").encode())
    edits: tuple[Callable[[Sketch], PassEdit], ...] = (
        lambda s: added(s, "erosion/thermal", "height"),
        lambda s: duplicated(s, "thermal"),
        lambda s: moved(s, "light", -1),
        lambda s: deleted(s, "thermal"),
    )
    for edit in edits:
        save_passes(load(file), edit(load(file)))
        data = file.read_bytes()
        assert data.count(b"\n") == data.count(b"\r\n")


def test_passes_in_one_list_are_left_alone(file: Path) -> None:
    text = 'format = 1\npass = [{ name = "a", use = "generation/fbm" }]\n'
    file.write_text(text, encoding="utf-8")
    sketch = load(file)
    with pytest.raises(SketchError, match="list"):
        save_passes(sketch, duplicated(sketch, "a"))
    assert file.read_text(encoding="utf-8") == text


def test_a_muted_pass_lets_through_what_it_is_made_of(file: Path) -> None:
    for _ in range(2):
        edited(file, added(load(file), "erosion/thermal", "height"))
    sketch = load(file)
    plain = joined(load(SKETCHES / "mixed.toml"))
    for names in (("thermal", "thermal_2"), ("thermal_2", "thermal")):
        muted = joined(without_muted(sketch, names))
        assert {pair for pair in muted if pair[1] not in names} == plain
    one = joined(without_muted(sketch, ["thermal_2"]))
    assert ("thermal", "light") in one or ("thermal_2", "light") not in one
    assert without_muted(sketch, ["height"]) is sketch  # it is made of nothing
    assert passed_on(sketch.graph, "light", "light") is None  # light is no height


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted(SKETCHES.glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_sketches_stand_any_edits(path: Path, tmp_path: Path) -> None:
    shown = load(path)
    folder = tmp_path / path.stem
    folder.mkdir()
    copy = folder / "sketch.toml"
    shutil.copyfile(path, copy)
    try:
        load(copy)
    except PlaygroundError:
        pytest.skip("it needs files of its own")
    random_source, done = random.Random(path.stem), 0
    for _ in range(6):
        sketch = load(copy)
        name = random_source.choice([spec.name for spec in shown.graph.passes])
        kinds: tuple[Callable[[Sketch, str], PassEdit], ...] = (
            lambda file, name: added(file, "generation/smooth", name),
            deleted,
            duplicated,
            lambda file, name: moved(file, name, random_source.choice((-1, 1))),
        )
        text = copy.read_text(encoding="utf-8")
        try:
            save_passes(sketch, random_source.choice(kinds)(sketch, name))
        except PlaygroundError as error:
            assert copy.read_text(encoding="utf-8") == text and "\n" not in str(error).strip()
            assert "cannot be written into this file" not in str(error)
            continue
        done += 1
        assert copy.read_text(encoding="utf-8") != text
        load(copy)
