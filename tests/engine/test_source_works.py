"""Sources with inputs: they get other passes' texels, run when these change, and may take their time."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.engine import sources
from playground.engine.disk_cache import DiskCache
from playground.engine.disk_caching import DiskCaching
from playground.engine.engine import Engine
from playground.engine.process.worker import Cancelled
from playground.engine.sandbox import Sandbox, TrySketch
from playground.engine.source_kinds import Material, SourceKind
from playground.engine.unfinished import SourceUnfinished, SourceWorks
from playground.errors import DataError, PlaygroundError

from ..loading import load
from ..sketch_texts import map_of, passes

RAMP = """#pragma kernel(output = "ramp:r32f")
uniform float rise = 1.0;  //! slider(0, 9)
uniform int unused = 1;    //! slider(0, 9)
float kernel(ivec2 texel) { return rise * float(texel.x + 10 * texel.y); }
"""
SOURCE = """#pragma source("turned", output = "height:r32f", reads = "spacing, relief")
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
    folder.write("source.glsl", SOURCE)
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
    folder.write("source.glsl", SOURCE.replace(old, new))
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
