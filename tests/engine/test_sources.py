"""Sources: what the processor makes becomes a texture, when its files or inputs change, in its own time."""

from __future__ import annotations

import os
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from playground import memo
from playground.data import content_hash as hashes
from playground.data.content_hash import content_key
from playground.data.image_files import write_png
from playground.engine import file_sources, sources
from playground.engine.disk_cache import DiskCache
from playground.engine.disk_caching import DiskCaching
from playground.engine.engine import Engine
from playground.engine.painted_images import PaintedFiles
from playground.engine.process.worker import Cancelled
from playground.engine.sandbox import Sandbox, TrySketch
from playground.engine.source_kinds import Material, SourceKind, Terrain
from playground.engine.sources import source_kind
from playground.engine.unfinished import SourceUnfinished, SourceWorks
from playground.errors import DataError, PlaygroundError, SketchError
from playground.paths import GLSL
from playground.sketch.techniques import read_technique

from ..loading import load
from ..sketch_texts import map_of, passes

SOURCE = """#pragma source("elevation_file", output = "height:r32f")
uniform sampler2D elevation; //! file("heights.npy")
uniform ivec2 raw_size = ivec2(0);
uniform int packing = 0; //! menu("grey", "rgb")
uniform int no_data = 0; //! menu("refuse", "fill")
uniform int first_row = 0; //! menu("north", "south")
uniform vec2 metres = vec2(0.0);
"""


@pytest.fixture
def heightmap(folder):
    heights = np.linspace(100.0, 300.0, 5 * 7, dtype=np.float32).reshape(5, 7)  # row 0 in the north
    np.save(folder.path / "heights.npy", heights)
    folder.write("terrain.glsl", SOURCE)
    return folder, heights


def test_a_file_becomes_heights_row_0_in_the_south(any_engine, heightmap):
    folder, heights = heightmap
    sketch = folder.sketch('[[pass]]\nname = "height"\nuse = "./terrain"\n', size="")
    result = any_engine.read(sketch, "height")
    span = heights.max() - heights.min()
    np.testing.assert_allclose(result, (heights[::-1] - heights.min()) / span, atol=1e-6)
    plan = any_engine.record.plan
    assert plan is not None
    assert plan.terrain.size == (7, 5)


def test_the_sketch_may_ask_for_another_size(any_engine, heightmap):
    folder, _ = heightmap
    sketch = folder.sketch('[[pass]]\nname = "height"\nuse = "./terrain"\n', size="size = [13, 9]")
    result = any_engine.read(sketch, "height")
    assert result.shape == (9, 13)
    assert result.min() == pytest.approx(0.0, abs=1e-6)
    assert result.max() == pytest.approx(1.0, abs=1e-6)


def test_it_is_read_again_when_the_file_changes_and_not_before(any_engine, heightmap):
    folder, heights = heightmap
    sketch = folder.sketch('[[pass]]\nname = "height"\nuse = "./terrain"\n', size="")
    any_engine.texture(sketch, "height")
    any_engine.texture(sketch, "height")
    assert any_engine.record.ran == []
    np.save(folder.path / "heights.npy", heights[:, ::-1])
    result = any_engine.read(sketch, "height")
    assert any_engine.record.ran == ["height"]
    assert result[0, 0] > result[0, -1]


PASS = '[[pass]]\nname = "height"\nuse = "./terrain"\n'


def refused(any_engine, sketch) -> str:
    """Draw what is wrong; check that the error is at the sketch's pass, and return its sentence."""
    with pytest.raises(DataError) as caught:
        any_engine.read(sketch, "height")
    (result,) = caught.value.diagnostics
    assert (Path(result.file).name, result.line) == ("sketch.toml", 3), result
    return result.message


@pytest.mark.parametrize(
    "body", [PASS, '[[pass]]\nname = "height"\nuse = "./inner"\n'], ids=["source", "nested"]
)
def test_invalid_data_file_is_reported_at_its_pass(any_engine, heightmap, monkeypatch, body):
    folder, _ = heightmap
    monkeypatch.chdir(folder.path)
    folder.write("inner.toml", '[[pass]]\nname = "height"\nuse = "./terrain"\n')
    (folder.path / "heights.npy").write_bytes(b"nothing")
    message = refused(any_engine, folder.sketch(body, size=""))
    assert message.startswith("heights.npy: the file is damaged")
    holes = np.ones((4, 4), dtype=np.float32)
    holes[1, 1] = np.nan
    np.save(folder.path / "heights.npy", holes)
    message = refused(any_engine, folder.sketch(body, size=""))
    assert message.startswith("heights.npy: 1 of 16 texels have no data")
    assert message.endswith('expected none, or no_data = "fill"')
    (folder.path / "heights.npy").unlink()
    message = refused(any_engine, folder.sketch(body, size=""))
    assert "heights.npy: height" in message
    assert "there is no such file" in message


def test_invalid_image_is_reported_at_its_pass(any_engine, folder, monkeypatch):
    monkeypatch.chdir(folder.path)
    folder.write("grass.png", "no picture")
    folder.write(
        "terrain.glsl",
        '#pragma kernel(output = "height:r32f")\n'
        'uniform sampler2D grass;  //! file("grass.png")\n'
        "float kernel(ivec2 texel) { return texelFetch(grass, texel, 0).r; }\n",
    )
    assert refused(any_engine, folder.sketch(PASS)).startswith("grass.png: not a picture")


def test_source_without_terrain_info_defers_to_next_source(any_engine, heightmap):
    folder, _ = heightmap
    made = '[[pass]]\nname = "tin"\nuse = "generation/delaunay"\n'
    sketch = folder.sketch(f'{made}[[pass]]\nname = "height"\nuse = "./terrain"\n', size="")
    any_engine.texture(sketch, "height")
    assert any_engine.record.plan is not None and any_engine.record.plan.terrain.size == (7, 5)


# ── Sources: what an elevation file says of its terrain, and the heights it becomes


KIND = source_kind("elevation_file")
HEIGHTS = np.array([[10, 20, 30], [40, 60, 50]], np.uint8)  # first row first


@pytest.fixture
def values(tmp_path):
    np.save(tmp_path / "a.npy", HEIGHTS.astype(np.float32))

    def values_(**changes):
        defaults = {p.name: p.default for p in read_technique("generation/heightmap", GLSL, GLSL).parameters}
        return defaults | {"elevation": str(tmp_path / "a.npy")} | changes

    return values_


def test_the_kernel_declares_what_the_source_reads():
    parameters = read_technique("generation/heightmap", GLSL, GLSL).parameters
    assert {*KIND.parameters, *KIND.optional} == {p.name for p in parameters}
    menus = {p.name: p.widget.choices for p in parameters if p.widget.kind == "menu"}
    assert menus == {
        "packing": ("grey", "rgb"),
        "no_data": ("refuse", "fill"),
        "first_row": ("north", "south"),
    }
    assert all(name in KIND.parameters for name in KIND.files)


def test_triangulation_kernel_declares_parameters_of_its_source():
    kind = source_kind("delaunay")
    parameters = read_technique("generation/delaunay/triangulation", GLSL, GLSL).parameters
    assert set(kind.parameters) == {p.name for p in parameters}
    menus = {p.name: p.widget.choices for p in parameters if p.widget.kind == "menu"}
    assert menus == {
        "weights": ("equal", "random"),
        "method": ("destruction and construction", "flips"),
        "heights": ("random", "displaced"),
    }
    assert kind.describe({p.name: p.default for p in parameters}) == Terrain()
    made = kind.make({p.name: p.default for p in parameters}, (16, 8))
    assert {name: table.shape for name, table in made.items()} == dict.fromkeys(
        ("places", "triangles", "neighbours", "last"), (8, 16, 4)
    )


@pytest.mark.parametrize(("first_row", "south_first"), [(0, HEIGHTS[::-1]), (1, HEIGHTS)])
def test_the_first_row_is_north_unless_it_is_set_to_south(values, first_row, south_first):
    made = KIND.make(values(first_row=first_row), (3, 2))["height"]
    np.testing.assert_allclose(made, (south_first - 10.0) / 50.0, atol=1e-7)


@pytest.mark.parametrize("size", [(3, 2), (64, 33), (257, 300), (2, 2)])
def test_heights_stay_from_0_to_1_at_any_size(values, size):
    made = KIND.make(values(), size)["height"]
    assert made.shape == size[::-1] and made.dtype == np.float32
    assert made.min() >= 0.0 and made.max() <= 1.0


def test_a_steep_file_stays_in_its_range_too(values, tmp_path):
    steps = np.zeros((64, 64), np.float32)
    steps[::5] = 100.0
    np.save(tmp_path / "b.npy", steps)
    for size in ((300, 300), (129, 65), (50, 40)):
        made = KIND.make(values(elevation=str(tmp_path / "b.npy")), size)["height"]
        assert made.min() >= 0.0 and made.max() <= 1.0


def test_flat_terrain_is_0(values, tmp_path):
    np.save(tmp_path / "flat.npy", np.full((4, 4), 7.0))
    assert (KIND.make(values(elevation=str(tmp_path / "flat.npy")), (9, 9))["height"] == 0).all()


def test_user_metres_map_full_range_of_file_codes(values, tmp_path):
    from PIL import Image

    Image.fromarray(HEIGHTS).save(tmp_path / "a.png")
    terrain = KIND.describe(values(elevation=str(tmp_path / "a.png"), metres=(100.0, 355.0)))
    assert (terrain.size, terrain.extent) == ((3, 2), None)
    assert (terrain.base_elevation, terrain.relief) == pytest.approx((110.0, 50.0))  # a metre a grey
    silent = KIND.describe(values(elevation=str(tmp_path / "a.png")))
    assert (silent.base_elevation, silent.relief) == (None, None)


def test_a_file_is_read_anew_when_it_changes(values, tmp_path):
    first = KIND.make(values(), (3, 2))["height"]
    np.save(tmp_path / "a.npy", np.flip(HEIGHTS).astype(np.float64))
    assert not np.array_equal(KIND.make(values(), (3, 2))["height"], first)


def replaced(path):
    new = path.with_name("new.npy")
    np.save(new, np.flip(HEIGHTS).astype(np.float32))
    new.replace(path)


def rewritten(path):
    np.save(path, np.flip(HEIGHTS).astype(np.float32))


@pytest.mark.parametrize("large", [2**26, 1])
@pytest.mark.parametrize("change", [replaced, rewritten])
def test_a_file_of_the_same_size_and_time_is_read_anew(values, tmp_path, monkeypatch, change, large):
    monkeypatch.setattr("playground.data.content_hash.LARGE", large)
    file = tmp_path / "a.npy"
    an_hour_ago = file.stat().st_mtime_ns - 3600 * 10**9
    os.utime(file, ns=(an_hour_ago, an_hour_ago))
    first = KIND.make(values(), (3, 2))["height"]
    change(file)
    os.utime(file, ns=(an_hour_ago, an_hour_ago))
    np.testing.assert_array_equal(KIND.make(values(), (3, 2))["height"], np.flip(first))


def test_a_file_that_does_not_change_is_read_once(values, tmp_path, monkeypatch):
    file = tmp_path / "a.npy"
    os.utime(file, (0, 0))
    value = values()
    first = KIND.make(value, (3, 2))["height"]
    monkeypatch.setattr("playground.data.arrays.open_regular", None)
    np.testing.assert_array_equal(KIND.make(value, (3, 2))["height"], first)


def test_large_heights_are_freed_after_upload_and_stay_described(values, tmp_path, monkeypatch):
    os.utime(tmp_path / "a.npy", (0, 0))
    value = values()
    terrain, kept = KIND.describe(value), KIND.make(value, (3, 2))["height"]
    monkeypatch.setattr("playground.engine.file_sources.KEPT", 1)
    np.testing.assert_array_equal(KIND.make(value, (3, 2))["height"], kept)
    assert memo.SOURCES.count_of(file_sources.read_whole) == 0
    for module in ("arrays", "grid"):
        monkeypatch.setattr(f"playground.data.{module}.open_regular", None)
    assert KIND.describe(value) == terrain
    with pytest.raises(DataError):
        KIND.make(value, (3, 2))


def test_a_large_file_is_not_read_to_be_known(tmp_path, monkeypatch):
    file = tmp_path / "holes.npy"
    with file.open("wb") as handle:
        handle.truncate(2**31)
    monkeypatch.setattr("playground.data.content_hash.content_hash", None)
    text = content_key(file)
    os.utime(file, ns=(0, 0))
    assert content_key(file) != text


def test_a_missing_file_and_an_unknown_source_are_sentences(values, tmp_path):
    with pytest.raises(DataError, match="cannot be read"):
        KIND.describe(values(elevation=str(tmp_path / "none.npy")))
    with pytest.raises(SketchError, match="did you mean 'elevation_file'"):
        source_kind("elevation_fil")


# ── Sources with inputs: they get other passes' texels, run when these change, and may take their ti


RAMP = """#pragma kernel(output = "ramp:r32f")
uniform float rise = 1.0;  //! slider(0, 9)
uniform int unused = 1;    //! slider(0, 9)
float kernel(ivec2 texel) { return rise * float(texel.x + 10 * texel.y); }
"""
TURNED_SOURCE = """#pragma source("turned", output = "height:r32f", reads = "spacing, relief")
uniform sampler2D given;       //! input("black")
uniform float gain = 1.0;      //! slider(0, 9)
"""
BODY = (
    "relief = 70.0\nextent = [160.0, 320.0]\n"
    + passes(
        ramp=("./ramp", "size = [5, 3]"), height=("./source", "size = [9, 17]", 'inputs = { given = "ramp" }')
    )
    + map_of("height")
)


class Turned:
    """A source that is as slow as it is told."""

    def __init__(self) -> None:
        self.materials: list[Material] = []
        self.may_go_on = threading.Event()
        self.may_go_on.set()
        self.begun = threading.Event()
        self.cancelled = threading.Event()
        self.error: Exception | None = None
        self.seconds = 0.0

    def work(self, values, size, material):
        self.materials.append(material)
        self.begun.set()
        try:
            for done in range(4):
                material.report(done, 4)
                while not self.may_go_on.wait(0.002):
                    material.report(done, 4)
        except Cancelled:
            self.cancelled.set()
            raise
        time.sleep(self.seconds)
        if self.error is not None:
            raise self.error
        rise = material.inputs["given"].max() if "given" in material.inputs else -1.0
        return {"height": np.full(size[::-1], values["gain"] * rise, np.float32)}


@pytest.fixture
def turned(monkeypatch, folder):
    source = Turned()
    kind = SourceKind("the turned", ("gain",), inputs=("given",), work=source.work)
    monkeypatch.setitem(sources.SOURCES, "turned", kind)
    folder.write("ramp.glsl", RAMP)
    folder.write("source.glsl", TURNED_SOURCE)
    yield source
    source.may_go_on.set()


@pytest.fixture
def sketch(turned, folder):
    return folder.sketch(BODY)


@pytest.fixture
def patient(any_engine):
    """Give an engine that does not wait for sources."""
    any_engine.options.patience = 0.1
    yield any_engine
    any_engine.options.patience = None


def until_drawn(engine, sketch, most=500):
    """Draw as a window does, and return how often a source was not ready."""
    for times in range(most):
        try:
            return engine.read(sketch, "height"), times
        except SourceUnfinished:
            continue
    raise AssertionError("it never ends")


# ── what it gets ─────────────────────────────────────────────────────────────


def test_it_gets_the_texels_of_another_pass_and_the_terrain(any_engine, sketch, turned):
    assert any_engine.read(sketch, "height").max() == 24.0
    [material] = turned.materials
    expected = np.add.outer(10 * np.arange(3), np.arange(5))
    np.testing.assert_array_equal(material.inputs["given"], expected.astype(np.float32))
    assert material.spacing == (20.0, 20.0) and material.relief == 70.0


def test_what_is_not_wired_is_not_there(any_engine, folder, turned):
    sketch = folder.sketch(BODY.replace('inputs = { given = "ramp" }\n', ""))
    assert any_engine.read(sketch, "height").max() == -1.0


def test_it_runs_again_when_what_it_reads_changes_and_only_then(any_engine, sketch, turned):
    for values, runs in (
        ({}, 1),
        ({}, 1),
        ({"ramp.unused": 3}, 1),
        ({"ramp.rise": 2.0}, 2),
        ({"height.gain": 2.0}, 3),
        ({}, 3),  # cached
    ):
        result = any_engine.read(sketch.with_values(values), "height")
        assert len(turned.materials) == runs
        assert result.max() == 24.0 * values.get("ramp.rise", 1.0) * values.get("height.gain", 1.0)
    any_engine.read(sketch.with_values({"relief": 71.0}), "height")
    any_engine.read(sketch.with_values({"extent": (80.0, 320.0)}), "height")
    assert [(m.relief, m.spacing[0]) for m in turned.materials[3:]] == [(71.0, 20.0), (70.0, 10.0)]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("given;", "other;", "needs the inputs given; the file declares other"),
        ('"spacing, relief"', '"spacing, eyes"', "a source cannot read 'eyes'"),
        ('output = "height', 'output = "hight', "source 'turned' gives height, not 'hight'"),
        ("uniform float gain = 1.0;      //! slider(0, 9)\n", "", "needs the parameters gain"),
    ],
)
def test_a_wrong_header_has_a_sentence(any_engine, folder, turned, old, new, message):
    folder.write("source.glsl", TURNED_SOURCE.replace(old, new))
    with pytest.raises(PlaygroundError, match=message):
        any_engine.read(
            folder.sketch(BODY.replace("given =", "other =" if "other" in new else "given =")), "height"
        )


def test_a_source_without_inputs_may_declare_none(any_engine, folder, turned):
    write_png(folder.path / "a.png", np.zeros((4, 4, 4), np.uint8))
    text = '#pragma source("mask_file", output = "mask:rgba8")\nuniform sampler2D image; //! file("a.png")\n'
    folder.write(
        "source.glsl", text + "uniform ivec2 texels = ivec2(0);\nuniform sampler2D given; //! input\n"
    )
    with pytest.raises(PlaygroundError, match="needs no inputs; the file declares given"):
        any_engine.read(folder.sketch(BODY.replace('"height"', '"mask"')), "mask")


# ── its time ─────────────────────────────────────────────────────────────────


def test_a_window_draws_on_while_it_is_at_work(patient, sketch, turned):
    turned.may_go_on.clear()
    for _ in range(3):
        with pytest.raises(SourceUnfinished) as met:
            patient.read(sketch, "height")
    assert (met.value.path, met.value.done, met.value.total) == ("height", 0, 4)
    assert patient.read(sketch, "ramp").max() == 24.0, "what needs it not is drawn"
    turned.may_go_on.set()
    assert until_drawn(patient, sketch)[0].max() == 24.0
    assert len(turned.materials) == 1, "it was begun once"
    assert until_drawn(patient, sketch)[1] == 0, "and is cached"


def test_another_value_cancels_it(patient, sketch, turned):
    turned.may_go_on.clear()
    with pytest.raises(SourceUnfinished):
        patient.read(sketch, "height")
    with pytest.raises(SourceUnfinished):
        patient.read(sketch.with_values({"ramp.rise": 2.0}), "height")
    assert turned.cancelled.wait(5.0)
    turned.may_go_on.set()
    assert until_drawn(patient, sketch.with_values({"ramp.rise": 2.0}))[0].max() == 48.0


def test_another_sketch_and_the_engines_end_cancel_it(ctx, sketch, folder, turned):
    with Engine(ctx) as engine:
        engine.options.patience = 0.1
        turned.may_go_on.clear()
        with pytest.raises(SourceUnfinished):
            engine.read(sketch, "height")
        engine.read(folder.one(RAMP), "a")
        assert turned.cancelled.wait(5.0)
        turned.cancelled.clear()
        with pytest.raises(SourceUnfinished):
            engine.read(sketch, "height")
    assert turned.cancelled.wait(5.0)


def test_who_waits_gets_the_same(patient, sketch, turned):
    """A picture that is saved waits for the work that a window has begun."""
    turned.may_go_on.clear()
    with pytest.raises(SourceUnfinished):
        patient.read(sketch, "height")
    patient.options.patience = None
    seen = []

    def progress(*at):
        seen.append(at)
        turned.may_go_on.set()

    patient.runner.works.on_progress = progress
    assert patient.read(sketch, "height").max() == 24.0
    assert seen[0] == ("height", 0, 4) and len(turned.materials) == 1
    patient.read(sketch.with_values({"height.gain": 3.0}), "height")
    assert [at for at in seen if at[1] == 3], "and one that is begun in this thread tells as well"


@pytest.mark.parametrize("waits", [True, False])
def test_its_error_is_raised_at_its_pass(any_engine, sketch, turned, waits):
    turned.error = DataError("there is too little of it")
    any_engine.options.patience = None if waits else 0.1
    with pytest.raises(DataError, match="there is too little of it") as met:
        until_drawn(any_engine, sketch)
    assert met.value.diagnostics[0].file.endswith("sketch.toml") or "height" in str(met.value)
    any_engine.options.patience, turned.error = None, None
    assert any_engine.read(sketch, "height").max() == 24.0, "and the next time it is tried again"


def test_works_are_one_for_each_step():
    works, ran = SourceWorks(), []

    def task(name):
        def begin():
            ran.append(name)
            return lambda report: {"name": np.array([ord(name)])}

        return begin

    assert works.made("p", "1", task("a"))["name"] == ord("a")
    works.waits = False
    for path, key, name in (("p", "1", "b"), ("q", "1", "c"), ("q", "", "d")):
        while True:
            try:
                assert works.made(path, key, task(name))["name"] == ord(name)
                break
            except SourceUnfinished:
                continue
    assert ran == ["a", "b", "c", "d"]


def test_one_source_work_runs_per_step_despite_cancels():
    """One that does not look whether it is cancelled goes on to its end; no other begins meanwhile."""
    works, may_end, started = SourceWorks(), threading.Event(), []
    works.waits = False

    def task(name):
        def begin():
            started.append(name)

            def work(report):
                may_end.wait(10.0)
                return {"name": np.array([ord(name)])}

            return work

        return begin

    for name in "abcd":
        with pytest.raises(SourceUnfinished) as met:
            works.made("p", name, task(name))
        assert met.value.path == "p"
    works.keep(lambda _: "")
    with pytest.raises(SourceUnfinished):
        works.made("p", "e", task("e"))
    with pytest.raises(SourceUnfinished):
        works.made("q", "f", task("f"))
    assert started == ["a", "f"]
    may_end.set()
    for _ in range(100):
        try:
            assert works.made("p", "g", task("g"))["name"] == ord("g")
            break
        except SourceUnfinished:
            continue
    assert started == ["a", "f", "g"]


# ── where it is not made ─────────────────────────────────────────────────────


@pytest.mark.parametrize("waits", [True, False])
def test_it_is_cached_on_disk(ctx, sketch, turned, tmp_path, waits):
    """By what it takes, in whatever thread."""
    turned.seconds = 0.1
    for _ in range(2):
        with Engine(ctx) as engine:
            engine.disk_caching = DiskCaching(DiskCache(tmp_path / "cache"), floor=90.0)
            engine.options.patience = None if waits else 0.1
            until_drawn(engine, sketch)
            engine.disk_caching.finish(engine, engine.record.plan)
        assert len(turned.materials) == 1


@pytest.mark.slow
def test_the_sandbox_takes_no_time_for_it(tmp_path: Path):
    """Only shaders are tried there: terrain of pieces by the thousand is not made."""
    (tmp_path / "sketch.toml").write_text(
        'format = 1\nsize = 2049\n[[pass]]\nname = "height"\nuse = "generation/from_example"\n'
        'set = { candidates = 10000 }\nsize = 2049\n[view]\nuse = "view/map"\ninputs = { shown = "height" }\n'
    )
    with Sandbox(software=True) as sandbox:
        report = sandbox.run(TrySketch(load(tmp_path), refuses="any"))
    assert report.ok, report.error
    assert report.seconds < 5.0


# ── What the engine reads of a file to tell whether its textures are stale ───


def test_huge_file_staleness_is_checked_without_reading(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.r16"
    with path.open("wb") as handle:
        handle.truncate(2**27)  # sparse: it takes no room
    monkeypatch.setattr(hashes, "file_hash", None)
    before = PaintedFiles().content(path)
    assert PaintedFiles().content(path) == before
    with path.open("ab") as handle:
        handle.write(b"more")
    assert PaintedFiles().content(path) != before
