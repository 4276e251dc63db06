"""A sketch with other texts in place of its files': what follows the texts, and what stays itself."""

from __future__ import annotations

from dataclasses import replace

import pytest

from playground.errors import DataError, ShaderError
from playground.sketch.model import VARIANTS, kernels_of
from playground.sketch.replace_technique import with_texts
from playground.sketch.variants import active_variant, trusted

from ..sketch_texts import passes
from .conftest import TERRAIN, VIEW

NESTED = passes(height="./hill")
HILL = 'title = "A hill"\n' + passes(slope="./terrain")


def kernels(sketch):
    return {kernel.name.rpartition("/")[2]: kernel for _, kernel in kernels_of(sketch.graph)}


def test_a_main_parameter_that_a_text_lacks_is_one_no_more(folder):
    sketch = folder.sketch(head='format = 1\nmain = ["height.rise"]\n')
    assert with_texts(sketch, {str(folder.path / "terrain.glsl"): TERRAIN}).main == ("height.rise",)
    steep = TERRAIN.replace("rise", "climb")
    assert with_texts(sketch, {str(folder.path / "terrain.glsl"): steep}).main == ()


def test_override_text_replaces_file_and_its_declarations(folder):
    sketch = folder.sketch()
    steep = TERRAIN.replace("rise", "climb").replace("0.5", "0.75")
    result = with_texts(sketch, {str(folder.path / "terrain.glsl"): steep})
    before, after = kernels(sketch), kernels(result)
    assert [(p.name, p.default) for p in before["terrain"].parameters] == [("rise", 0.5)]
    assert [(p.name, p.default) for p in after["terrain"].parameters] == [("climb", 0.75)]
    assert "climb * float" in after["terrain"].source.code
    assert after["look"] is before["look"], "what no text is of stays itself"
    assert (folder.path / "terrain.glsl").read_text(encoding="utf-8") == TERRAIN


def test_an_included_text_changes_every_kernel_that_includes_it(folder):
    file = folder.write("share.glsl", "const float SHARE = 0.5;\n")
    folder.write("terrain.glsl", '#include "share.glsl"\n' + TERRAIN)
    folder.write("look.glsl", '#include "share.glsl"\n' + VIEW)
    result = with_texts(folder.sketch(), {str(file): "const float SHARE = 0.25;\n"})
    assert ["SHARE = 0.25;" in kernel.source.code for kernel in kernels(result).values()] == [True, True]


def test_a_text_is_found_inside_a_technique_of_several_passes(folder):
    folder.write("hill.toml", HILL)
    sketch = folder.sketch(NESTED)
    result = with_texts(sketch, {str(folder.path / "terrain.glsl"): TERRAIN.replace("0.5", "0.75")})
    assert kernels(result)["terrain"].parameters[0].default == 0.75
    assert kernels(sketch)["terrain"].parameters[0].default == 0.5


def test_texts_that_a_sketch_does_not_use_change_nothing(folder):
    sketch = folder.sketch()
    assert with_texts(sketch, {}) is sketch
    assert with_texts(sketch, {str(folder.path / "other.glsl"): "not GLSL"}) == sketch


def test_variant_is_disabled_unless_override_equals_file(folder):
    file = folder.write("terrain.comp", '#pragma compute(groups = "1, 1")\nuniform float rise = 0.5;\n')
    sketch = folder.sketch()
    sketch = replace(sketch, graph=trusted(sketch.graph))

    def runs(texts):
        kernel = kernels(with_texts(sketch, texts))["terrain"]
        return active_variant(kernel, VARIANTS) is not None

    kernel_file = str(folder.path / "terrain.glsl")
    assert runs({kernel_file: TERRAIN})
    assert runs({kernel_file: TERRAIN + "// the same\n"})
    assert not runs({kernel_file: TERRAIN.replace("0.5", "0.75")})
    assert not runs({str(file): file.read_text() + "float more;\n"})


def test_a_text_that_is_no_kernel_is_refused_in_a_sentence(folder):
    sketch, file = folder.sketch(), str(folder.path / "terrain.glsl")
    with pytest.raises(DataError, match="no kernel is left of this text"):
        with_texts(sketch, {file: "float f() { return 1.0; }\n"})
    with pytest.raises(ShaderError, match=r"no file 'nowhere\.glsl' to include"):
        with_texts(sketch, {file: '#include "nowhere.glsl"\n' + TERRAIN})
