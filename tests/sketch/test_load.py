"""Sketches from TOML: what each says, each mistake with file and line, and nothing from outside."""

from __future__ import annotations

import os
import pickle
import random
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tifffile

from playground.allowed_files import ELEVATIONS
from playground.errors import DataError, ParameterError, PlaygroundError, ShaderError, SketchError
from playground.paths import SKETCHES
from playground.shader.parameter import coerce
from playground.sketch.find import find, shipped_names, shipped_sketches
from playground.sketch.load import elevation_text, is_technique, load, load_with
from playground.sketch.model import VARIANTS, Camera, Kernel, TerrainSettings, kernels_of
from playground.sketch.replace_technique import with_texts
from playground.sketch.techniques import Techniques, WithLibrary, shipped_techniques
from playground.sketch.toml_text import TomlPlaces
from playground.sketch.variants import active_variant, trusted

from ..cases import each
from ..loading import library
from ..loading import load as load_once
from ..sketch_texts import passes
from .conftest import PASS, TAIL, TERRAIN, VIEW

IMAGE = """\
#pragma kernel(output = "height:r32f")
uniform sampler2D picture;  //! file("")
float kernel(ivec2 texel) { return texelFetch(picture, texel, 0).r; }
"""


# What a sketch says


def test_a_whole_sketch(folder):
    sketch = folder.sketch(
        head="""\
format = 1
title = "A slope"
size = [65, 33]
extent = 1000
relief = 250.5
base_elevation = -10
""",
        body="""
[[pass]]
name = "height"
use = "./terrain"
size = "size // 2"
set = { rise = 0.25 }
""",
        tail="""
[view]
use = "./look"
samples = 2
camera = { azimuth = 10, target = [1, 2, 3.5] }
[[preset]]
name = "steep"
set = { "height.rise" = 2, relief = 900, size = 17 }
[[shot]]
name = "from-here"
size = [64, 36]
time = 2
preset = "steep"
samples = 1
camera = { elevation = 80 }
set = { height.rise = 1.5 }
""",
    )
    assert (sketch.name, sketch.title, sketch.terrain.size, sketch.terrain.extent) == (
        "s",
        "A slope",
        (65, 33),
        (1000.0, 1000.0),
    )
    assert (sketch.terrain.relief, sketch.terrain.base_elevation, sketch.picture.samples) == (250.5, -10.0, 2)
    assert sketch.camera == Camera(azimuth=10.0, target=(1.0, 2.0, 3.5))
    height, view = sketch.graph.passes
    assert (height.name, height.size, height.values, height.line) == (
        "height",
        ("size.x // 2", "size.y // 2"),
        (("rise", 0.25),),
        8,
    )
    assert (view.name, view.use) == ("view", "./look")
    shot = sketch.shot("from-here")
    assert (shot.size, shot.time, shot.preset, shot.samples) == ((64, 36), 2.0, "steep", 1)
    assert shot.camera == Camera(azimuth=10.0, elevation=80.0, target=(1.0, 2.0, 3.5))
    seen = sketch.for_shot(shot)
    assert (seen.terrain.relief, seen.terrain.size, seen.picture.samples) == (900.0, (17, 17), 1)
    assert dict(seen.overrides) == {"height.rise": 1.5}
    assert [Path(p).name for p in sketch.files] == ["s.toml", "terrain.glsl", "look.glsl"]


def test_what_is_absent_has_its_default(folder):
    sketch = folder.sketch()
    assert sketch.terrain == TerrainSettings()
    assert (sketch.camera, sketch.picture.samples, sketch.shots, sketch.presets) == (Camera(), 4, (), ())
    assert sketch.title == sketch.name == "s"
    plain = folder.sketch(tail="")
    assert plain.graph.passes[-1].use == "view/map"
    assert plain.graph.passes[-1].inputs == (("shown", "height"),)


def test_a_folder_with_sketch_toml_has_the_folder_s_name(folder):
    folder.write("sketch.toml", "format = 1\n" + PASS + TAIL)
    assert load(folder.path).name == "mine"
    assert load(folder.path / "sketch.toml").folder == str(folder.path)


def test_a_sketch_that_is_a_link_has_the_folder_it_lies_in(folder, tmp_path: Path):
    folder.write("s.toml", "format = 1\n" + PASS + TAIL)
    (tmp_path / "link.toml").symlink_to(folder.path / "s.toml")
    assert load(tmp_path / "link.toml").folder == str(folder.path)


def test_any_line_ends_and_mark(folder):
    text = ("format = 1\n" + PASS + TAIL).replace("\n", "\r\n")
    (folder.path / "s.toml").write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert load(folder.path / "s.toml").graph.passes[0].line == 2


def test_dotted_keys_and_tables_are_paths(folder):
    folder.write("inner.toml", "[[pass]]\nname = 'shape'\nuse = './terrain'\n")
    body = '[[pass]]\nname = "height"\nuse = "./inner"\n'
    for name in (
        'set = { "shape.rise" = 0.5 }',
        "set = { shape.rise = 0.5 }",
        "[pass.set.shape]\nrise = 0.5",
    ):
        assert folder.sketch(body + name + "\n").graph.passes[0].values == (("shape.rise", 0.5),)
    folder.refused(
        "'shape.rise' is set twice", 5, body=body + 'set = { "shape.rise" = 0.5, shape = { rise = 1 } }\n'
    )


# Values that travel


def test_a_sketch_is_hashable_and_crosses_to_a_child_process(folder):
    sketch = folder.sketch(tail=TAIL + '[[shot]]\nname = "one"\nset = { height.rise = 1 }\n')
    again = load(folder.path / "s.toml")
    assert sketch == again and hash(sketch) == hash(again) and {sketch: 1}[again] == 1
    other = sketch.with_values({"height.rise": 1.0})
    assert other != sketch and len({sketch, again, other}) == 2
    back = pickle.loads(pickle.dumps(other))
    assert back == other and hash(back) == hash(other)
    code = (
        "import pickle, sys; s = pickle.load(sys.stdin.buffer);"
        "s = s.with_values({'height.rise': 1.5}).for_shot(s.shot('one'));"
        "sys.stdout.buffer.write(pickle.dumps((s, hash(s) is not None)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], input=pickle.dumps(sketch), capture_output=True, check=True
    )
    child, _ = pickle.loads(done.stdout)
    assert child == sketch.with_values({"height.rise": 1.0})


def test_every_shipped_sketch_loads_and_is_a_value():
    other = WithLibrary(Techniques())  # it reads the library for itself
    result = {}

    @each("name", shipped_sketches())
    def check(name):
        result[name] = sketch = load_once(name)
        assert sketch.title and hash(sketch) == hash(load_with(other, name))
        for shot in sketch.shots:
            sketch.for_shot(shot)

    check()
    assert pickle.loads(pickle.dumps(result)) == result


# Names


def test_what_ships_is_listed_and_found():
    assert "jacksboro" in shipped_sketches()
    techniques = shipped_techniques()
    assert {"generation/heightmap", "view/terrain", "texturing/height_blend"} <= set(techniques)
    assert not {"noise/hash", "colour/encode"} & set(techniques)
    assert set(techniques) <= set(shipped_names())
    assert find("jacksboro") == SKETCHES / "jacksboro.toml"
    assert library().keys() == set(techniques), "each can be read"


def test_a_shipped_name_wins_over_a_folder_that_holds_no_sketch(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "jacksboro").mkdir()
    assert find("jacksboro") == SKETCHES / "jacksboro.toml"
    (tmp_path / "jacksboro" / "sketch.toml").write_text("")
    assert find("jacksboro").parent.name == "jacksboro"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("jacksborro", "did you mean 'jacksboro'"),
        ("../sketches/jacksboro", "no file and no shipped sketch"),
        ("README.md", "no file and no shipped sketch|a sketch is a .toml"),
        ("a\0b", "no file"),
        ("x" * 5000, "no file"),
        ("~nobody-of-that-name/x", "no file"),
        ("nothing/at/all.toml", "no file"),
    ],
)
def test_what_is_not_found_is_one_sentence(name, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SketchError, match=words):
        find(name)


def test_a_file_of_another_kind_or_an_empty_folder_is_refused(tmp_path):
    (tmp_path / "notes.txt").write_text("")
    with pytest.raises(SketchError, match=r"a sketch is a \.toml, a shader ends in"):
        find(tmp_path / "notes.txt")
    with pytest.raises(SketchError, match=r"holds no sketch\.toml"):
        find(tmp_path)


# One technique alone


def test_a_kernel_alone_takes_its_place_in_jacksboro(folder):
    result = load(folder.path / "terrain.glsl")
    stage = load("jacksboro")
    assert [p.name for p in result.graph.passes] == [p.name for p in stage.graph.passes]
    height = result.graph.find("height")
    assert height is not None and isinstance(height.technique, Kernel) and height.technique.title == "A slope"
    assert (result.name, result.title, result.camera) == ("terrain", "A slope", stage.camera)


def test_what_stays_of_jacksboro_keeps_its_files(folder):
    folder.write("light.glsl", TERRAIN.replace("height:r32f", "light:r16f"))
    result = load(folder.path / "light.glsl")
    paths = [str(v) for _, v in result.overrides]
    assert paths and all(Path(p).is_absolute() and Path(p).is_file() for p in paths)


def test_other_outputs_are_shown_from_above(folder):
    folder.write("odd.glsl", TERRAIN.replace("height:r32f", "oddity:r32f"))
    result = load(folder.path / "odd.glsl")
    assert [p.name for p in result.graph.passes[-2:]] == ["oddity", "view"]
    assert result.graph.passes[-1].inputs == (("shown", "oddity"),)
    assert load(folder.path / "look.glsl").graph.passes[-1].technique.title == ""


def test_a_technique_alone(folder):
    path = folder.write("t.toml", "[[pass]]\nname='a'\nuse='./terrain'\n[parameters]\nsteep='a.rise'\n")
    assert is_technique(path) and not is_technique(folder.write("s.toml", "format = 1\n" + PASS + TAIL))
    assert not is_technique(folder.write("bad.toml", "= 1"))
    result = load(path).with_values({"height.steep": 1.0})
    assert result.name == "t" and len(load("generation/layered_noise").graph.passes) > 2


def test_a_plain_shader_is_the_whole_picture(folder):
    path = folder.write("p.frag", "#version 330\n// Plain\nout vec4 c;\nvoid main() { c = vec4(1); }\n")
    result = load(path)
    assert [p.name for p in result.graph.passes] == ["view"] and result.picture.samples == 1


def test_a_library_file_and_a_lonely_variant_are_sentences(folder):
    with pytest.raises(SketchError, match="a library file"):
        load(folder.write("lib.glsl", "float f;\n"))
    with pytest.raises(SketchError, match=r"in place of only\.glsl or only\.toml, which is missing"):
        load(folder.write("only.comp", '#pragma compute(groups = "1, 1")\n'))
    folder.write("terrain.comp", '#pragma compute(groups = "1, 1")\nuniform float rise;\n')
    assert load(folder.path / "terrain.comp").graph.find("height").technique.variants[0].kind == "compute"


PLAIN_COMPUTE = """#version 430
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba8, binding = 0) uniform image2D picture;
void main() { imageStore(picture, ivec2(gl_GlobalInvocationID.xy), vec4(1.0)); }
"""


@pytest.mark.parametrize("name", ["terrain.comp", "sketch.comp"])
def test_a_plain_shader_of_any_name_opens_itself(folder, name):
    folder.sketch('[[pass]]\nname = "height"\nuse = "generation/fbm"\n')
    result = load(folder.write(name, PLAIN_COMPUTE))
    assert result.file.endswith(name) and result.graph.passes[0].technique.kind == "plain_compute"


# Mistakes


def test_a_preset_of_a_vanished_parameter_sets_the_rest(folder):
    tail = TAIL + "[[preset]]\nname = 'p'\n[preset.set]\nheight.rize = 1\nheight.rise = 0.25\n"
    sketch = folder.sketch(tail=tail + "relief = 20.0\n")
    (warning,) = sketch.warnings
    assert warning.message == (
        "preset 'p' leaves out height.rize: no parameter 'height.rize' in sketch s; "
        "did you mean 'height.rise'?"
    )
    assert (warning.line, warning.severity) == (10, "warning")
    assert dict(sketch.with_preset("p").presets[0].values) == {"height.rise": 0.25, "relief": 20.0}


def test_a_mistake_in_toml_itself_shows_the_line(folder):
    error = folder.refused("not TOML", 3, head="format = 1\ntitle = 'x'\nsize = 3 4\n")
    assert "size = 3 4" in str(error) and error.diagnostics[0].column == 10
    folder.refused("not TOML", None, head='format = 1\ntitle = """x\n')
    (folder.path / "s.toml").write_bytes(b"format = 1\n# \xff\n")
    with pytest.raises(SketchError, match="not UTF-8"):
        load(folder.path / "s.toml")


def test_a_mistake_in_a_kernel_is_reported_in_the_kernel(folder):
    folder.write("terrain.glsl", TERRAIN.replace("slider(0, 2)", "slidr(0, 2)"))
    folder.refused("no widget 'slidr'", 3, file="terrain.glsl")


def test_an_export_s_targets_have_one_type(folder):
    folder.write(
        "two.glsl", TERRAIN.replace("uniform float rise = 0.5;  //! slider(0, 2)", "uniform int n = 1; //!")
    )
    text = "[[pass]]\nname='a'\nuse='./terrain'\n[[pass]]\nname='b'\nuse='./two'\n"
    text += "[parameters]\nx=['a.rise', 'b.n']\n"
    folder.write("t.toml", text.replace("float(texel.x)", "1"))
    folder.refused(
        "types of their own: a.rise float, b.n int", 8, file="t.toml", body=PASS.replace("terrain", "t")
    )


def test_two_files_of_one_name_are_refused(folder):
    folder.write("terrain.toml", "[[pass]]\nname = 'a'\nuse = './look'\n")
    error = folder.refused("is both", 4)
    assert "terrain.toml" in str(error) and "terrain.glsl" in str(error)


def test_techniques_that_use_each_other_are_a_circle(folder):
    folder.write("a.toml", "[[pass]]\nname = 'x'\nuse = './b'\n")
    folder.write("b.toml", "[[pass]]\nname = 'x'\nuse = './a'\n")
    error = folder.refused("use each other in a circle", 3, file="b.toml", body=PASS.replace("terrain", "a"))
    assert str(error).count("a.toml") == 2


def test_a_few_lines_cannot_nest_millions(folder):
    for i in range(14):
        inner = f"./t{i + 1}" if i < 13 else "./terrain"
        folder.write(f"t{i}.toml", "".join(f"[[pass]]\nname = '{n}'\nuse = '{inner}'\n" for n in "abcd"))
    folder.refused("1000 is the most", None, file="t9.toml", body=PASS.replace("terrain", "t0"))
    for i in range(20):
        folder.write(f"t{i}.toml", f"[[pass]]\nname = 'a'\nuse = './t{i + 1}'\n")
    folder.refused("nest more than 16 deep", None, file="t15.toml", body=PASS.replace("terrain", "t0"))


def test_one_technique_in_two_passes_is_read_once(folder):
    sketch = folder.sketch(PASS + PASS.replace('"height"', '"again"'))
    assert sketch.graph.passes[0].technique is sketch.graph.passes[1].technique


# Nothing from outside


@pytest.mark.parametrize(
    "use",
    [
        "./../terrain",
        "../terrain",
        "/tmp/land",
        "./",
        ".",
        "./.",
        "..",
        "./..",
        "./link",
        "./linked/secret",
        "./a\\u0000b",
        "/",
    ],
)
def test_a_technique_stays_in_the_folder_and_the_library(folder, tmp_path: Path, use):
    for name in ("terrain.glsl", "secret.glsl", "mine.glsl", ".glsl"):
        (tmp_path / name).write_text(TERRAIN)
    (folder.path / "link.glsl").symlink_to(tmp_path / "secret.glsl")
    (folder.path / "linked").symlink_to(tmp_path)
    folder.refused("lies outside", 4, body=f'[[pass]]\nname = "height"\nuse = "{use}"\n')


def test_a_fast_variant_stays_there_too(folder, tmp_path: Path):
    (tmp_path / "terrain.comp").write_text('#pragma compute(groups = "1, 1")\n')
    (folder.path / "terrain.comp").symlink_to(tmp_path / "terrain.comp")
    with pytest.raises(SketchError, match="lies outside"):
        folder.sketch()


def test_a_technique_in_a_folder_below_uses_the_files_there(folder):
    folder.write("below/t.toml", "[[pass]]\nname = 'a'\nuse = './terrain'\n")
    folder.write("below/terrain.glsl", TERRAIN.replace("a slope", "below"))
    sketch = folder.sketch(PASS.replace("terrain", "below/t"))
    assert sketch.graph.passes[0].technique.passes[0].technique.title == "Below"
    folder.write("below/t.toml", "[[pass]]\nname = 'a'\nuse = './../terrain'\n")
    assert folder.sketch(PASS.replace("terrain", "below/t"))


OUTSIDE = [
    "/etc/hostname",
    "../secret.png",
    "a/../../secret.png",
    "C:/x.png",
    "C:x.png",
    "//host/x.png",
    "~/x.png",
    "link.png",
    "linked/secret.png",
    "\\\\x.png",
]


@pytest.mark.parametrize("path", OUTSIDE)
def test_a_sketch_s_own_files_stay_in_its_folder(folder, tmp_path: Path, path):
    (tmp_path / "secret.png").write_bytes(b"")
    (folder.path / "link.png").symlink_to(tmp_path / "secret.png")
    (folder.path / "linked").symlink_to(tmp_path)
    folder.write("terrain.glsl", IMAGE)
    folder.refused(
        "lies outside the sketch's own folder and glsl/", 5, body=PASS + f'set = {{ picture = "{path}" }}\n'
    )
    for key in ("shot", "preset"):
        tail = TAIL + f'[[{key}]]\nname = "a"\nset = {{ height.picture = "{path}" }}\n'
        folder.refused("lies outside", 9, tail=tail)
    folder.write("t.toml", PASS + f'set = {{ picture = "{path}" }}\n')
    folder.refused("lies outside", 4, file="t.toml", body=PASS.replace("terrain", "t"))
    folder.write("terrain.glsl", IMAGE.replace('file("")', f'file("{path}")'))
    folder.refused("lies outside", 2, file="terrain.glsl")
    with pytest.raises(PlaygroundError, match="lies outside"):
        load(folder.path / "terrain.glsl")


@pytest.mark.parametrize(
    "path", ["a.png", "deep/er/a.png", "x/../a.png", "sketches/data/jacksboro_fault_dem.npz", "none.png", ""]
)
def test_files_inside_may_be_named_whether_or_not_they_are_there(folder, path):
    folder.write("a.png", "")
    folder.write("terrain.glsl", IMAGE)
    assert folder.sketch(PASS + f'set = {{ picture = "{path}" }}\n').graph.passes[0].values == (
        ("picture", path),
    )


def test_what_the_user_types_may_lie_anywhere(folder, tmp_path: Path):
    folder.write("terrain.glsl", IMAGE)
    sketch = folder.sketch()
    for path in (str(tmp_path / "secret.png"), tmp_path / "secret.png"):
        assert dict(sketch.with_values({"height.picture": path}).overrides) == {"height.picture": str(path)}


# Anything at all


@pytest.mark.slow
@pytest.mark.parametrize("seed", [7, pytest.param(107, marks=pytest.mark.slow)])
def test_mutated_sketches_raise_nothing_but_sentences(folder, seed):
    rng = random.Random(seed)
    folder.write("t.toml", "[[pass]]\nname = 'a'\nuse = './terrain'\n[parameters]\nsteep = 'a.rise'\n")
    folder.write("back.glsl", TERRAIN + "uniform sampler2D before; //! input\n")
    valid = """\
format = 1
title = "x"
size = [65, 33]
relief = 10.5
[[pass]]
name = "height"
use = "./t"
set = { steep = 0.5, "a.rise" = 0.25 }
size = ["size.x", "2 * 4"]
[[pass]]
name = "water"
use = "./back"
repeat = "2 + 1"
feedback = { before = "height" }
inputs = { before = "height.a:height" }
[view]
use = "./look"
camera = { azimuth = 20.0, target = [1, 2, 3] }
samples = 2
[[preset]]
name = "p"
set = { height.steep = 1, size = 9 }
[[shot]]
name = "s"
size = [64, 36]
steps = { water = 2 }
set = { "height.a.rise" = 1.5 }
preset = "p"
"""
    path = folder.write("s.toml", valid)
    load(path)
    words = [*"[]{}='.,1-#é\\\n", "[[", '"', '"' * 3, "nan", "true", "./", "height"]
    loaded = 0
    for _ in range(625):
        text = valid
        for _ in range(rng.randint(1, 3)):
            at = rng.randrange(len(text))
            match rng.randrange(3):
                case 0:
                    text = text[:at] + text[at + rng.randint(1, 12) :]
                case 1:
                    text = text[:at] + rng.choice(words) + text[at:]
                case _:
                    lines = text.split("\n")
                    rng.shuffle(lines) if rng.random() < 0.1 else lines.insert(
                        rng.randrange(len(lines)), rng.choice(lines)
                    )
                    text = "\n".join(lines)
        path.write_text(text)
        try:
            hash(load(path))
            loaded += 1
        except PlaygroundError as error:
            assert error.diagnostics[0].file and "\n" not in error.diagnostics[0].message
    assert loaded > 2


@pytest.mark.parametrize(
    ("head", "words"),
    [
        ("relief = 0x" + "f" * 5000, "relief = a number of thousands of digits"),
        ("relief = 1" + "0" * 5000, "not TOML"),
        ("x = " + "[" * 3000, "not TOML"),
        ("view.use = './look'\nview.camera = { distance = 1" + "0" * 400 + " }", "distance = 1000"),
    ],
    ids=range(4),
)
def test_a_monstrous_number_or_nesting_is_named(folder, head, words):
    folder.refused(words, head=f"format = 1\n{head}\n", tail="")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "a." * 3000 + "b = 1",
        "format = 1\nset." + "a." * 3000 + "b = 1",
        "format = 1\n[[pass]]\nname='a'\nuse='./terrain'\nset." + "a." * 3000 + "b = 1\n",
        "format = 1\n[[pass]]\nname='a'\nuse='./terrain'\ninputs." + "a." * 3000 + "b = 1\n",
        "format = 1\n[[pass]]\nname='a'\nuse='./" + "a" * 100_000 + "'\n",
        "format = 1\n[[pass]]\nname='a'\nuse='./" + "a/" * 10_000 + "b'\n",
        "format = 1\n[[pass]]\nname='a'\nuse='./terrain'\nsize='" + "(" * 100_000 + "'\n",
        "format = 1\n[[pass]]\nname='a'\nuse='./terrain'\nsize=" + "9" * 4000 + "\n",
        "format = 1\n[[pass]]\nname='a'\nuse='./terrain'\nset = { rise = " + "9" * 4000 + " }\n",
    ],
    ids=range(10),
)
def test_monsters_are_one_sentence(folder, text):
    with pytest.raises(PlaygroundError):
        load(folder.write("s.toml", text))


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may read everything")
def test_a_file_that_may_not_be_read_is_a_sentence(folder):
    path = folder.write("s.toml", "format = 1\n")
    path.chmod(0)
    with pytest.raises(SketchError, match="cannot be read"):
        load(path)


def test_the_kinds_of_error():
    assert issubclass(ParameterError, SketchError) and issubclass(ShaderError, PlaygroundError)
    with pytest.raises(ParameterError):
        coerce(load().graph.passes[0].technique.parameters[0], 3)
    assert not issubclass(DataError, SketchError)


# ── An elevation file that is opened alone: the sketch around it, and how it is found


@pytest.fixture
def dem(tmp_path):
    path = tmp_path / 'a "b" `c` é.TIF'
    tifffile.imwrite(path, np.arange(12, dtype=np.float32).reshape(3, 4))
    return path


def test_dem_sketch_names_its_file_and_leaves_terrain_to_it(dem):
    sketch = load(dem)
    assert (sketch.file, sketch.folder, sketch.name) == (str(dem), str(dem.parent), dem.stem)
    assert sketch.terrain == TerrainSettings()
    height = sketch.graph.find("height")
    assert dict(height.values) == {"elevation": dem.name, "longest": 1025, "no_data": 1}
    assert [spec.name for spec in sketch.graph.passes if spec.name in ("colour", "light", "view")]
    assert {spec.line for spec in sketch.graph.passes} == {0}, "no line of the file says any of it"
    assert not sketch.warnings


def test_saved_beside_the_file_its_text_is_the_same_sketch(dem):
    saved = dem.with_suffix(".toml")
    saved.write_text(elevation_text(dem, dem.name), "utf-8")
    alone, again = load(dem), load(saved)
    assert [(p.name, p.use, p.values, p.inputs) for p in alone.graph.passes] == [
        (p.name, p.use, p.values, p.inputs) for p in again.graph.passes
    ]
    assert (alone.camera, alone.main, alone.title) == (again.camera, again.main, again.title)


@pytest.mark.parametrize("ending", ELEVATIONS)
def test_every_ending_of_elevations_is_found(tmp_path, ending):
    path = tmp_path / f"land{ending}"
    path.write_bytes(b"")
    assert find(path) == path and load(path).name == "land"


def test_what_is_neither_says_what_is(tmp_path):
    (tmp_path / "a.pdf").write_bytes(b"%PDF")
    with pytest.raises(SketchError, match=r"an elevation file in \.png, \.tif, .*\.hgt"):
        find(tmp_path / "a.pdf")


@pytest.mark.room("dialects")
def test_a_dialect_is_for_shaders(dem):
    with pytest.raises(SketchError, match="--dialect is for a shader file"):
        load(dem, dialect="isf")


# ── A sketch with other texts in place of its files': what follows the texts, and what stays itself


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


# ── Lines of TOML keys: against a document made with its line numbers known ──


TEXT = '''\
# a comment = 1
format = 1
"quoted key" = 2
a.b."c.d" = 3
text = """
not = "a key"
[[not.a.table]]
"""
raw = \'\'\'x = "1"
y = 2\'\'\'
list = [1, 0.5,
  # comment, ]
  { deep = 1, other = [2, 3] }, "]",
  4]

[[pass]]
name = "one"   # name = 7
set = { sun = { azimuth = 1.5, elevation = 2 }, "detail.frequency" = 3, x.y = 4 }
  [pass.inputs]
  height = "a"
[[pass]]
name = "two"
[ pass . set ]
smoothing = 1979-05-27T07:32:00
[[pass.inner]]
z = 1
[[pass.inner]]
z = 2
[view]
use = "x#y" # end
camera.azimuth = 1'''


def expected() -> dict[tuple[str | int, ...], int]:
    return {
        ("format",): 2,
        ("quoted key",): 3,
        ("a", "b", "c.d"): 4,
        ("text",): 5,
        ("raw",): 9,
        ("list",): 11,
        ("list", 0): 11,
        ("list", 1): 11,
        ("list", 2): 13,
        ("list", 2, "deep"): 13,
        ("list", 2, "other"): 13,
        ("list", 2, "other", 0): 13,
        ("list", 2, "other", 1): 13,
        ("list", 3): 13,
        ("list", 4): 14,
        ("pass", 0): 16,
        ("pass", 0, "name"): 17,
        ("pass", 0, "set"): 18,
        ("pass", 0, "set", "sun"): 18,
        ("pass", 0, "set", "sun", "azimuth"): 18,
        ("pass", 0, "set", "sun", "elevation"): 18,
        ("pass", 0, "set", "detail.frequency"): 18,
        ("pass", 0, "set", "x", "y"): 18,
        ("pass", 0, "inputs"): 19,
        ("pass", 0, "inputs", "height"): 20,
        ("pass", 1): 21,
        ("pass", 1, "name"): 22,
        ("pass", 1, "set"): 23,
        ("pass", 1, "set", "smoothing"): 24,
        ("pass", 1, "inner", 0): 25,
        ("pass", 1, "inner", 0, "z"): 26,
        ("pass", 1, "inner", 1): 27,
        ("pass", 1, "inner", 1, "z"): 28,
        ("view",): 29,
        ("view", "use"): 30,
        ("view", "camera", "azimuth"): 31,
    }


def test_every_key_has_its_line():
    assert TomlPlaces(TEXT).lines == expected()


def test_a_place_without_a_line_has_that_of_what_is_around_it():
    lines = TomlPlaces(TEXT)
    assert lines.line(("pass", 0, "set", "nothing", "there")) == 18
    assert lines.line(("pass", 7, "name")) == 16  # the first of the list
    assert lines.line(("nothing", 7, "name")) == 0
    assert lines.line(()) == 0


@pytest.mark.parametrize(
    "text",
    [
        "",
        "\n\n",
        "[",
        "[[",
        "[[pass]",
        "a",
        "a =",
        "a = [",
        "a = {",
        "= 1",
        'a = "',
        "[]",
        "a.=1",
        "]",
        "}",
        "a = [}",
    ],
)
def test_what_is_not_toml_loses_its_own_line_alone(text):
    text = f"first = 1\n{text}\n[[pass]]\nuse = 'x'\n"
    places = TomlPlaces(text)
    assert places.lines["first",] == 1 and places.pairs["first",].value == len("first = ")
    if not text.split("\n")[1].startswith("[[pass]"):  # where the line is the beginning of a header
        [place] = [path for path in places.pairs if path[0] == "pass"]
        pair = places.pairs[place]
        assert text[pair.key : pair.end] == "use = 'x'"


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, pytest.param(102, marks=pytest.mark.slow)])
def test_any_text_ends_soon_and_raises_nothing(seed):
    rng = random.Random(seed)
    for _ in range(750):
        letters = list(TEXT)
        for _ in range(rng.randint(1, 12)):
            at = rng.randrange(len(letters))
            letters[at : at + rng.randint(0, 3)] = rng.choice(
                ["", "[", '"', "'''", "{", "=", "\n", "\\", "}"]
            )
        TomlPlaces("".join(letters))
    TomlPlaces("a = " + "[" * 100_000)
    TomlPlaces("a = [" + "1, " * 100_000 + "]")
    TomlPlaces("a = {" + "b = {" * 50_000)
    TomlPlaces("a = [\n" * 20_000)
