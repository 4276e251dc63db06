"""What is changed in a page opens again from its zip, and gives the page's picture."""

from __future__ import annotations

import io
import random
import zipfile
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

import moderngl
import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.paths import GLSL
from playground.publish.web.page_data import page_data
from playground.shader.parameter import shortest
from playground.sketch.assign import values_of
from playground.sketch.find import read_pack, unpacked
from playground.sketch.model import Camera, Sketch, kernels_of
from playground.sketch.replace_technique import with_texts

from ...loading import load
from ...shipped import EACH_KIND
from .node import Node

ZIP = """async (page, made, store, load) => {
    const { versionFiles } = await load("my_version.js"), { zip } = await load("zip.js");
    const sketch = page.sketches[0], rows = new Map(sketch.shown.map((row) => [row.path, row]));
    const given = { ...made, rows, values: new Map(made.values), steps: new Map(made.steps) };
    const { shared } = page, { pack } = sketch;
    const { files, aside } = await versionFiles(pack, sketch, shared, given);
    return { bytes: await zip(files, { store }), aside };
}"""
CAMERA = Camera(123.5, 17.25, 9000.125, (100.5, 200.0, -3.0), 41.0)
CAMERA_DATA = asdict(CAMERA)


@cache
def page_of(path: Path | str, engine: Engine | None = None) -> dict[str, Any]:
    return page_data([load(path)], frame=(160, 90), packed=True, engine=engine)


def version(
    node: Node, folder: Path, page: dict[str, Any], store: bool = False, **made: Any
) -> tuple[Path, list[str]]:
    """Return the zip that the page saves, and what it has no place for."""
    nothing = {"texts": {}, "values": [], "camera": None, "time": 0, "steps": [], "frame": [160, 90]}
    result = node.run(ZIP, page, {**nothing, **made}, store)
    path = folder / "my-version.zip"
    path.write_bytes(result["bytes"].tobytes())
    return path, result["aside"]


def opened(path: Path, folder: Path) -> Sketch:
    return load(unpacked(path, folder / "cache"))


def settings(page: dict[str, Any]) -> list[list[Any]]:
    """Return other values for some rows, within their ranges."""
    pick, values = random.Random(1), []
    rows = [row for row in page["sketches"][0]["shown"] if not row["locked"] and row["exported"]]
    for row in pick.sample(rows, min(len(rows), 6)):
        value, whole = row["value"], row["type"][0] in "iu"
        if row["widget"] == "menu":
            values.append([row["path"], pick.randrange(len(row["choices"]))])
        elif isinstance(value, bool):
            values.append([row["path"], not value])
        elif isinstance(value, (int, float, list)):
            ranges = row["ranges"]
            numbers = []
            for at in range(len(value) if isinstance(value, list) else 1):
                low, high = ranges[min(at, len(ranges) - 1)] if ranges else (None, None)
                if row["widget"] == "direction":
                    low, high = (0, 360) if at == 0 else (1, 89)
                elif row["widget"] == "colour":
                    low, high = 0, 1
                if low is None or high is None:
                    break
                number = (
                    pick.randint(int(low), int(high)) if whole else float(np.float32(pick.uniform(low, high)))
                )
                numbers.append(number)
            else:
                values.append([row["path"], numbers if isinstance(value, list) else numbers[0]])
    return values


@pytest.mark.parametrize("name", EACH_KIND)
def test_an_unchanged_version_says_what_the_sketch_says(
    node: Node, tmp_path: Path, exporting: Engine, name: str
):
    path, aside = version(node, tmp_path, page_of(name, exporting))
    opened_sketch, expected = opened(path, tmp_path), load(name)
    assert not aside
    assert [(s.name, s.use, s.inputs, s.size, s.repeat) for s in opened_sketch.graph.passes] == [
        (s.name, s.use, s.inputs, s.size, s.repeat) for s in expected.graph.passes
    ]
    assert opened_sketch.camera == expected.camera and opened_sketch.main == expected.main
    text = next(iter(read_pack(path).files))
    assert text.startswith(f"{name}/")


@pytest.mark.parametrize("name", EACH_KIND)
def test_values_and_the_camera_come_back_exactly(node: Node, tmp_path: Path, exporting: Engine, name: str):
    sketch, page = load(name), page_of(name, exporting)
    values = settings(page)
    path, aside = version(node, tmp_path, page, values=values, camera=CAMERA_DATA)
    opened_sketch = opened(path, tmp_path)
    target = sketch.with_values({key: tuple(v) if isinstance(v, list) else v for key, v in values})
    said, expected = values_of(opened_sketch), values_of(target)
    assert not aside
    for key in expected:
        if not isinstance(expected[key], str):
            assert shortest(said[key]) == shortest(expected[key]), key
    assert opened_sketch.camera == CAMERA


def test_terrain_time_and_steps_are_in_the_toml(node: Node, tmp_path: Path):
    values = [["size", [257, 257]], ["relief", 1234.5], ["base_elevation", -20], ["extent", [5000, 4000.5]]]
    path, _ = version(
        node, tmp_path, page_of("diamond_square"), values=values, time=2.5, steps=[["height.raw", 7]]
    )
    opened_sketch = opened(path, tmp_path)
    assert (opened_sketch.terrain.size, opened_sketch.terrain.extent) == ((257, 257), (5000.0, 4000.5))
    assert (opened_sketch.terrain.relief, opened_sketch.terrain.base_elevation) == (1234.5, -20.0)
    shot = opened_sketch.shot("page")
    assert (shot.size, shot.time, shot.steps) == ((160, 90), 2.5, (("height.raw", 7),))


def test_what_keyframes_steer_is_in_a_shot(node: Node, tmp_path: Path):
    sketch = load("sun_flight")
    row = next(r for r in page_of("sun_flight")["sketches"][0]["shown"] if r["widget"] == "direction")
    path, _ = version(
        node,
        tmp_path,
        page_of("sun_flight"),
        values=[[row["path"], [77.0, 7.0]]],
        camera=CAMERA_DATA,
        time=3.0,
    )
    opened_sketch = opened(path, tmp_path)
    steered = opened_sketch.for_shot(opened_sketch.shot("page")).at(3.0)
    expected = sketch.with_values({row["path"]: (77.0, 7.0)}).with_camera(CAMERA).at(3.0)
    assert steered.camera == expected.camera
    assert values_of(steered)[row["targets"][0]] == values_of(expected)[row["targets"][0]]


def library_files(name: str) -> list[str]:
    """Return a few texts that a sketch's passes read: kernels, and the one that most of them include.

    Those that fast variants alone read are left out: no file of the sketch names them.
    """
    sources = [kernel.source for _, kernel in kernels_of(load(name).graph)]
    read = [file for source in sources for file in {source.path, *(to for *_, to in source.includes)}]
    texts = {f"{GLSL}/{file}": file for file in page_of(name)["shared"]["files"] if ":" not in file}
    there = [texts[file] for file in read if file in texts and file.endswith((".glsl", ".frag"))]
    files = sorted(set(there))
    return sorted({files[0], files[len(files) // 2], files[-1], max(files, key=there.count)})


@pytest.mark.slow
@pytest.mark.parametrize("name", ["delaunay", "diamond_square", "jacksboro", "sun_flight"])
def test_an_edited_text_is_that_of_every_pass_that_reads_it(node: Node, tmp_path: Path, name: str):
    page, sketch = page_of(name), load(name)
    for number, file in enumerate(library_files(name)):
        text = f"{page['shared']['files'][file]}\n#define MY_EDIT {number}\n"
        path, aside = version(node, tmp_path, page, texts={file: text})
        target = with_texts(sketch, {str((GLSL / file).resolve()): text})
        kernels, expected = dict(kernels_of(opened(path, tmp_path).graph)), dict(kernels_of(target.graph))
        assert kernels.keys() == expected.keys() and not aside
        assert all(kernels[leaf].source.canonical == expected[leaf].source.canonical for leaf in expected), (
            file
        )
        assert any("MY_EDIT" in kernel.source.names for kernel in kernels.values())


def test_text_of_fast_variants_alone_is_reported_aside(node: Node, tmp_path: Path):
    page, file = page_of("jacksboro"), "terrain/blocks.glsl"
    _, aside = version(node, tmp_path, page, texts={file: f"{page['shared']['files'][file]}\n"})
    assert aside == [file]


@pytest.mark.room("dialects")
def test_text_read_by_no_sketch_file_is_reported_aside(node: Node, tmp_path: Path):
    page = page_of("flood")
    rewritten = next(file for file in page["shared"]["files"] if ":" in file)
    path, aside = version(node, tmp_path, page, texts={rewritten: "void main() {}", "nowhere.glsl": "x"})
    assert aside == [rewritten, "nowhere.glsl"]
    with zipfile.ZipFile(path) as archive:
        assert "void main() {}" in [archive.read(name).decode() for name in archive.namelist()]
        assert rewritten in archive.read("flood/settings.txt").decode()
    assert opened(path, tmp_path).name == "flood"


def test_oversized_page_data_is_listed_in_zip(node: Node):
    script = """async (page, leftOut, load) => {
        const { versionFiles } = await load("my_version.js"), { shared, sketches: [sketch] } = page;
        const pack = { ...sketch.pack, leftOut };
        const made = { texts: {}, values: new Map(), rows: new Map(), camera: null, time: 0 };
        const given = { ...made, steps: new Map(), frame: [9, 9] };
        const { files } = await versionFiles(pack, sketch, shared, given);
        return files.get(`${pack.folder}/settings.txt`) ?? "";
    }"""
    page = page_of("diamond_square")
    assert node.run(script, page, []) == ""
    assert node.run(script, page, ["films/long.mp4", "b.tif"]).split("\n")[1:] == [
        "films/long.mp4",
        "b.tif",
        "",
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "file", "old", "new"),
    [
        ("diamond_square", "generation/diamond_square/raw.glsl", "return total", "return 0.5 * total"),
        ("diamond_square", "noise/hash.glsl", "bits >> 8u", "bits >> 9u"),
        ("from_elsewhere", "sketches/from_elsewhere/sand.frag", "vec3(", "0.5 * vec3("),
    ],
)
def test_an_edit_gives_the_picture_that_it_gives_in_place(
    node: Node, tmp_path: Path, ctx: moderngl.Context, name: str, file: str, old: str, new: str
):
    page, sketch = page_of(name), load(name)
    text = page["shared"]["files"][file].replace(old, new)
    path, _ = version(node, tmp_path, page, texts={file: text})
    with Engine(ctx, driver="fragment") as engine:
        before = engine.render(sketch, size=(160, 90)).array
        expected = engine.render(
            with_texts(sketch, {str((GLSL / file).resolve()): text}), size=(160, 90)
        ).array
        array = engine.render(opened(path, tmp_path), size=(160, 90)).array
    assert (np.asarray(array) == np.asarray(expected)).all()
    assert (np.asarray(array) != np.asarray(before)).any()


def test_the_zip_is_read_by_python_and_always_the_same(node: Node, tmp_path: Path):
    files = {"b/ä.txt": "ß\n" * 500, "a.txt": "", "b/a.glsl": "float x;\n", "B.bin": "x" * 70_000}
    script = """async (files, store, load) =>
        (await load("zip.js")).zip(new Map(Object.entries(files)), { store })"""
    for store in (False, True):
        data = node.run(script, files, store).tobytes()
        assert data == node.run(script, dict(reversed(files.items())), store).tobytes()
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            assert archive.testzip() is None
            assert archive.namelist() == sorted(files)
            assert {n: archive.read(n).decode() for n in files} == files
            entry = archive.getinfo("B.bin")
            assert entry.date_time == (1980, 1, 1, 0, 0, 0) and entry.external_attr >> 16 == 0o100644
            assert (entry.compress_size < 1000) == (not store)


def test_a_checksum_is_zlib_s(node: Node):
    import zlib

    data = np.frombuffer(random.Random(2).randbytes(5000), "u1")
    assert node.call("zip.js", "crc32", data) == zlib.crc32(data.tobytes())
