"""The parameters that a sketch is about: read, checked, saved, and replaced with a technique."""

from __future__ import annotations

import pytest

from playground.paths import SKETCHES
from playground.sketch.assign import resolve
from playground.sketch.find import shipped_sketches
from playground.sketch.replace_technique import with_technique
from playground.sketch.save import save

from ..cases import each
from ..loading import load

HEAD = 'format = 1\nmain = ["height.rise"]  # what it is about\n'
OTHER = '#pragma kernel(output = "height:r32f")\nuniform float fall = 1.0;  //! slider(0, 2)\n'
OTHER += "float kernel(ivec2 texel) { return fall; }\n"


def test_a_sketch_lists_its_main_parameters(folder):
    assert folder.sketch(head=HEAD).main == ("height.rise",)
    assert folder.sketch().main == ()


@pytest.mark.parametrize(
    ("path", "words"), [("height.rize", "did you mean 'height.rise'"), ("relief", "no parameter 'relief'")]
)
def test_one_that_is_gone_is_left_out_with_a_warning(folder, path, words):
    sketch = folder.sketch(head=f'format = 1\nmain = ["{path}", "height.rise"]\n')
    (warning,) = sketch.warnings
    assert sketch.main == ("height.rise",)
    assert warning.message.startswith(f"main leaves out {path}: ") and words in warning.message
    assert warning.line == 2


def test_it_stays_when_a_value_is_saved(folder):
    file = folder.sketch(head=HEAD)
    save(file, file.with_values({"height.rise": 1.5}))
    assert load(file.file).main == ("height.rise",)
    assert HEAD in (folder.path / "s.toml").read_text(encoding="utf-8")


def test_parameter_missing_in_new_technique_leaves_main_list(folder):
    folder.write("other.glsl", OTHER)
    file = folder.sketch(head=HEAD)
    other = with_technique(file, "height", "./other")
    assert other.main == ()
    save(file, other)
    assert load(file.file).main == ()


def test_of_a_technique_opened_alone_all_its_own_are_main(folder):
    assert load(folder.path / "terrain.glsl").main == ("height.rise",)


@pytest.mark.slow
@each("name", sorted(shipped_sketches()))
def test_a_shipped_sketch_says_what_it_is_about(name):
    sketch = load(SKETCHES / f"{name}.toml")
    assert 1 <= len(sketch.main) <= 8, "a handful: the rest is in the passes"
    for path in sketch.main:
        assert resolve(sketch.graph, path)
