"""What a book holds for a browser: the scenes as data, the scripts that hold them."""

from __future__ import annotations

import base64
import gzip
import json
import re

import pytest

from playground.course import model
from playground.course.book.build import prepare, write_book
from playground.course.book.html import LessonContext
from playground.course.book.live import (
    MAX_INLINE_LETTERS,
    Library,
    Scenes,
    beginning,
    block_data,
    lesson_data,
    live_book,
)
from playground.course.library import labels
from playground.course.read import read_lesson
from playground.course.scenes import bug_region, pictures_in, spelled_value
from playground.course.traces import Results
from playground.publish.web.blobs import packed_json
from playground.publish.web.parameter_data import row as row_data
from playground.publish.web.plan import sketch_data
from playground.publish.web.shared_data import SharedData
from playground.sketch.assign import shown_parameters

from ..loading import load
from ..sketch_texts import map_of, passes
from .conftest import SKETCHES

pytestmark = pytest.mark.slow


SCRIPT = re.compile(r'\(globalThis\.bookData\?\?=\{\}\)\["([\w/]+)"\]="([A-Za-z0-9+/=]+)";\n')


def held(path):
    """Read the data of a script as a page does."""
    name, text = SCRIPT.fullmatch(path.read_text(encoding="utf-8")).groups()
    return name, gzip.decompress(base64.b64decode(text))


def held_in(script):
    return json.loads(gzip.decompress(base64.b64decode(SCRIPT.fullmatch(script)[2])))


@pytest.fixture
def book(tmp_path, lesson, french, engine):
    folder = tmp_path / "book"
    write_book(prepare(folder, {"en": [lesson], "fr": [french]}, gallery=False), engine)
    return folder


@pytest.fixture(scope="module")
def sky_light():
    return read_lesson("sky_light", "en", SKETCHES)


@pytest.fixture(scope="module")
def of_sky_light(sky_light):
    library = Library()
    return library, lesson_data(sky_light, library)


@pytest.fixture(scope="module")
def delaunay():
    return live_book([read_lesson("delaunay", "en", SKETCHES)])


def scenes_of(block):
    return [block.scene] if isinstance(block, model.Break) else [p.scene for p in pictures_in(block)]


def written_alone(scene):
    """Return a scene's sketch as `sketch_data` writes it by itself, its kernels too."""
    steps = dict(scene.steps)
    return sketch_data(scene.sketch, SharedData(), frame=scene.pixels, time=scene.time, steps=steps)


@pytest.mark.parametrize(("name", "least"), [("sky_light", 16), ("delaunay", 16), ("", 8)])
def test_every_scene_is_its_sketch_with_its_setting(node, lesson, name, least):
    count, data = compare_scenes(node, read_lesson(name, "en", SKETCHES) if name else lesson)
    assert count >= least and len(data["sketches"]) < count / 3


def compare_scenes(node, lesson):
    """Settle each scene as a page does, and write its sketch by itself; return how many there are."""
    library = Library()
    data = json.loads(json.dumps(lesson_data(lesson, library)))
    kernels = json.loads(json.dumps(library.kernels))
    count = 0
    for name, block in data["blocks"].items():
        scenes = scenes_of(lesson.named[name])
        if block["kind"] == "steps":
            scenes = scenes[-1:]
        assert len(scenes) == len(block["scenes"])
        for scene, setting in zip(scenes, block["scenes"], strict=True):
            result = node.call(
                "book_data.js", "settled", data["sketches"][setting["sketch"]], setting, kernels
            )
            expected = json.loads(json.dumps(written_alone(scene)))
            for key in ("presets", "notes"):  # no figure offers them
                del result[key], expected[key]
            assert result == expected, (name, setting)
            count += 1
    return count, data


def test_the_lessons_of_a_book_share_texts_and_kernels(sky_light, of_sky_light):
    library, first = of_sky_light
    once = len(library.kernels), len(library.data()["files"])
    assert lesson_data(sky_light, library) == first
    assert (len(library.kernels), len(library.data()["files"])) == once
    assert once[0] == len({json.dumps(kernel) for kernel in library.kernels})


def test_a_sketch_that_no_page_can_run_stays_a_picture(lesson, monkeypatch):
    """And so does its block; the others are live."""
    from playground.course.book import live
    from playground.errors import SketchError

    whole = set(lesson_data(lesson, Library())["blocks"])

    def refuse(sketch, *others, **named):
        if dict(sketch.overrides).get("height.smoothing") == 0.9:
            raise SketchError("a compute shader")
        return sketch_data(sketch, *others, **named)

    monkeypatch.setattr(live, "sketch_data", refuse)
    assert whole - set(lesson_data(lesson, Library())["blocks"]) == {"smooth", "two"}


def test_blocks_of_each_kind(lesson, sky_light, of_sky_light):
    blocks = lesson_data(lesson, Library())["blocks"]
    assert {name: block["kind"] for name, block in blocks.items()} == {
        "land": "figure",
        "turns": "steps",
        "smooth": "slider",
        "two": "compare",
        "fault": "break",
    }
    assert blocks["land"]["rows"] == ["height.smoothing"]
    assert (blocks["turns"]["passes"], blocks["turns"]["iterations"]) == (
        ["height.raw", "phase"],
        [*range(6)],
    )
    assert (blocks["smooth"]["row"], blocks["smooth"]["values"]) == ("height.smoothing", [0.1, 0.5, 0.9])
    more = of_sky_light[1]["blocks"]
    assert more["clouds"]["kind"] == "exercise" and more["clouds"]["begin"] != more["clouds"]["scenes"][0]
    assert {"light.clouds", "view.exposure"} <= set(more["clouds"]["rows"])
    exercise = sky_light.named["clouds"]
    assert dict(beginning(exercise.scene).overrides) == {}


def test_degrees_stand_after_both_numbers_of_a_direction(node):
    slider = model.Slider(0, "", "sun", (model.Scene(load("jacksboro"), (32, 18)),), "light.sun")
    shown = next(
        shown_parameter
        for shown_parameter in shown_parameters(load("jacksboro"))
        if shown_parameter.path == "light.sun"
    )
    row = row_data(shown, (0.0, 0.0), ("light.sun",))
    for language, text in (("en", "110°, 10.5°"), ("fr", "110°, 10,5°")):
        assert spelled_value(slider, (110.0, 10.5), language) == text
        live = node.call("book_series.js", "spelled", row, (110.0, 10.5), language == "fr")
        numbers = [float(part.removesuffix("°").replace(",", ".")) for part in live.split(", ")]
        assert numbers == [110.0, 10.5] and live.count("°") == 2 and ("." in live) == (language == "en")


def test_a_colour_between_two_is_spelled_as_those_are(node):
    """However many digits its numbers have."""
    shown = next(
        shown_parameter
        for shown_parameter in shown_parameters(load("jacksboro"))
        if shown_parameter.path == "view.horizon"
    )
    row = row_data(shown, (0.0, 0.0, 0.0), ("view.horizon",))
    colour = (0.6120607621465106, 0.5431826535604307, 0.44618878000622914)
    encoded = [round(255 * (1.055 * part ** (1 / 2.4) - 0.055)) for part in colour]  # IEC 61966-2-1
    for comma in (False, True):
        result = node.call("book_series.js", "spelled", row, colour, comma)
        assert result == "#" + "".join(f"{byte:02x}" for byte in encoded)


def test_iterations_that_only_a_source_reads_stay_pictures(any_engine, tmp_path):
    """A page has what the source made of the last one."""
    (tmp_path / "spread.glsl").write_text(
        '#pragma kernel(output = "height:r32f", repeat = "4")\n'
        "float kernel(ivec2 t) { return previous(t) + fract(float(t.x * 7 + t.y * 5) / 11.0); }\n"
    )
    steps = passes(
        spread=("./spread",),
        free=("./spread",),
        noise=("generation/by_example", 'inputs = { example = "spread" }'),
    )
    (tmp_path / "sketch.toml").write_text("format = 1\nsize = 17\n" + steps + map_of("noise"))
    scenes = (model.Scene(load(tmp_path), (32, 18)),)
    blocks = [model.Steps(0, "", name, scenes, (name,), (1, 4)) for name in ("spread", "free")]
    block_datas = [block_data(block, Scenes(Library(any_engine))) for block in blocks]
    assert block_datas[0] is None and block_datas[1]["passes"] == ["free"]


def test_values_that_a_processor_makes_are_listed_ones(delaunay):
    """Between ten and twenty points of a triangulation a page knows of none."""
    block = held_in(delaunay.files["data/delaunay.js"])["blocks"]["points"]
    assert "row" not in block
    assert len({json.dumps(setting.get("data")) for setting in block["scenes"]}) == len(block["scenes"]) == 9


def test_lines_of_a_bug_are_put_back_as_in_the_window(lesson, node):
    library = Library()
    block, result = lesson.named["fault"], lesson_data(lesson, library)["blocks"]["fault"]
    region, text = bug_region(block), library.data()["files"][block.file]
    for lines in (region.broken, region.correct, "\n float a;\n\nint b;\n"):
        put = node.call("book_text.js", "withLines", text, result, lines)
        assert put.rstrip("\n") == region.with_lines(lines).rstrip("\n")


def test_the_scripts_hold_the_data(book, lesson):
    library = Library()
    data = json.loads(json.dumps(lesson_data(lesson, library)))
    name, shared = held(book / "glsl.js")
    shared = json.loads(shared)
    for language, say in shared.pop("say").items():
        assert say.items() <= labels("tasks", language).items() and "wrong_texture" in say
    assert name == "glsl" and shared == json.loads(json.dumps(library.data()))
    name, result = held(book / "data/small.js")
    result = json.loads(result)
    assert name == "data/small" and result.pop("blobs") == {} and result == data
    assert packed_json(data) == packed_json(json.loads(json.dumps(data)))


def test_nothing_says_where_it_was_made(book):
    for path in (book / "glsl.js", book / "data/small.js"):
        _, text = held(path)
        assert str(book.parent).encode() not in text
        assert not re.search(rb'"/[a-z]+/|[A-Z]:\\\\', text)
    _, shared = held(book / "glsl.js")
    assert not [file for file in json.loads(shared)["files"] if file.endswith(".toml")]


def test_small_blobs_are_inline_and_large_ones_separate_scripts(delaunay):
    own = [name for name in delaunay.files if re.fullmatch(r"data/[0-9a-f]{16}\.js", name)]
    assert all(len(delaunay.files[name]) > MAX_INLINE_LETTERS for name in own) and len(own) < 10
    blobs = held_in(delaunay.files["data/delaunay.js"])["blobs"]
    assert len(blobs) > 50 and all(len(text) <= MAX_INLINE_LETTERS for text in blobs.values())


def test_only_live_blocks_can_be_started(book, lesson, french):
    for language in ("en", "fr"):
        text = (book / language / "small.html").read_text(encoding="utf-8")
        named = re.findall(r'data-block="(\w+)"', text)
        assert sorted(named) == sorted(lesson_data(lesson, Library())["blocks"])
        assert 'data-lesson="small"' in text
    assert "data-block" not in (book / "en/index.html").read_text(encoding="utf-8")


def test_a_page_without_live_blocks_is_as_before(lesson):
    setting = LessonContext(lesson, {}, Results(), lambda picture: "", lambda link: {})
    assert setting.started(lesson.named["land"]) == {"data_block": None}


def test_pages_are_strict(book):
    """No script and no style stands in a page; what it loads is the book's."""
    for path in book.rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        head = text.index("<head>")
        policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]+)"', text)
        assert policy and policy.start() < text.index("<script") and policy.start() > head
        assert "default-src &#x27;none&#x27;" in policy[1] or "default-src 'none'" in policy[1]
        assert "unsafe" not in policy[1] and "*" not in policy[1]
        assert re.findall(r"<script[^>]*>", text) == re.findall(r'<script src="[./]*book\.js" defer>', text)
        assert not re.search(r"<style|\sstyle=|\son\w+=", text)


def test_a_setting_is_small(sky_light):
    scenes = Scenes(Library())
    block = sky_light.named["ground"]
    first, *rest = [scenes.setting(scene) for scene in block.scenes]
    assert set(first) == {"sketch"} and len(scenes.sketches) == 1
    assert all(set(setting) == {"sketch", "values", "shown"} for setting in rest)
