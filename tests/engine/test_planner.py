"""Plans: renewed like those made from nothing, and the sizes that a sketch writes."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.data.values import write_values
from playground.engine import planner as planner_module
from playground.engine.cache import Cache
from playground.engine.engine import Engine
from playground.engine.plan import Plan, PlanRequest, every_node
from playground.engine.planner import make_plan, planned
from playground.errors import DataError, PlaygroundError
from playground.sketch.assign import resolve, shown_parameters
from playground.sketch.model import Sketch, Value

from ..loading import load
from ..plans import plans_made_whole
from ..sketch_texts import map_of, passes

SIZE = (64, 36)
SKETCHES = (
    "jacksboro",
    "mixed",
    "fault_formation",
    "splat_many",
    "diamond_square_steps",
    "sun_flight",
    "delaunay",
)


def facts_of(plan: Plan) -> list[object]:
    """Return all that a plan says; matrices by their numbers."""
    eye = plan.eye.clip_from_world.tolist(), plan.eye.position, plan.eye.target
    return [
        plan.sketch,
        list(every_node(plan.nodes)),
        plan.terrain,
        eye,
        plan.frame_size,
        plan.time,
        plan.lacking,
    ]


def other_values(sketch: Sketch) -> list[tuple[str, Value]]:
    """Return a value for each parameter with a range or choices, other than its default."""
    result: list[tuple[str, Value]] = []
    for shown in shown_parameters(sketch):
        parameter, widget = shown.parameter, shown.parameter.widget
        if parameter.name == "packing":
            continue  # another than the file has
        if parameter.type == "bool":
            result.append((shown.path, not parameter.default))
        elif widget.kind == "menu":
            result.append((shown.path, (int(parameter.default) + 1) % len(widget.choices)))  # type: ignore[arg-type]
        elif (
            parameter.type in ("float", "int", "uint") and widget.high is not None and widget.low is not None
        ):
            middle = (widget.low + widget.high) / 2
            result.append((shown.path, middle if parameter.type == "float" else int(middle)))
    return result


@pytest.fixture
def wholes(monkeypatch) -> list[Sketch]:
    """Give the sketches whose plans were made from nothing."""
    return plans_made_whole(monkeypatch)


def plan_of(sketch: Sketch, time: float = 0.0) -> Plan:
    return planned(sketch, PlanRequest(SIZE, time))


@pytest.mark.parametrize("name", SKETCHES)
def test_a_renewed_plan_is_the_one_made_from_nothing(name, wholes):
    sketch = load(name)
    plan_of(sketch)
    for number, (path, value) in enumerate(other_values(sketch)[:40]):
        changed = sketch.with_values({path: value})
        time = 0.5 * (number % 3)
        from_nothing = make_plan(changed, PlanRequest(SIZE, time))
        assert facts_of(plan_of(changed, time)) == facts_of(from_nothing), path
    assert len(wholes) <= 1 + 2 * number, "some were renewed"


@pytest.mark.slow
def test_a_slider_that_no_size_names_plans_no_pass(monkeypatch, wholes):
    nodes: Counter[str] = Counter()
    plan_node = planner_module.Planning.plan_node

    def counting(self, node):
        nodes[node.path] += 1
        return plan_node(self, node)

    monkeypatch.setattr(planner_module.Planning, "plan_node", counting)
    sketch = load("")
    first = plan_of(sketch)
    assert set(nodes) == {step.path for step in first.walk()} and max(nodes.values()) == 1
    nodes.clear()
    for azimuth in range(20):
        second = plan_of(sketch.with_values({"light.sun": (100.0 + azimuth, 20.0)}))
    assert not nodes and len(wholes) == 1
    moved = {
        step.path for step, before in zip(second.walk(), first.walk(), strict=True) if step is not before
    }
    sun = {target.path.rpartition(".")[0] for target in resolve(sketch.graph, "light.sun")}
    assert moved == sun, "only passes that have the value are other ones"


def test_a_value_that_a_count_names_plans_anew(wholes):
    sketch = load("fault_formation")
    first = plan_of(sketch)
    counts = [path for path in first.basis.named if path.startswith("height.")]
    assert counts, "its number of faults is the number of its steps"
    for path in counts:
        more = sketch.with_values({path: 7})
        plan = plan_of(more)
        assert facts_of(plan) == facts_of(make_plan(more, PlanRequest(SIZE))) != facts_of(first)
    assert len(wholes) == 1 + 2 * len(counts)


def test_another_file_of_the_terrain_plans_anew(tmp_path):

    def rise(side: int) -> None:
        write_values(
            tmp_path / "rise.npy", np.linspace(0, 1, side * side, dtype=np.float32).reshape(side, side)
        )

    rise(9)
    (tmp_path / "sketch.toml").write_text(
        'format = 1\n[[pass]]\nname = "height"\n'
        'use = "generation/heightmap"\nset = { elevation = "rise.npy" }\n'
    )
    sketch = load(tmp_path)
    assert plan_of(sketch).terrain.size == (9, 9)
    rise(17)
    assert plan_of(sketch).terrain.size == (17, 17)
    Path(tmp_path / "rise.npy").unlink()
    with pytest.raises(DataError, match="there is no such file"):
        plan_of(sketch)


@pytest.mark.slow
def test_what_is_used_is_weighed_twice_a_frame_at_most(ctx, monkeypatch):
    weighed: Counter[str] = Counter()
    weigh = Cache.weigh

    def counting(self, key):
        weighed[key] += 1
        weigh(self, key)

    sketch = load("")
    with Engine(ctx) as engine:
        engine.render(sketch, size=SIZE)
        monkeypatch.setattr(Cache, "weigh", counting)
        engine.render(sketch.with_values({"light.sun": (130.0, 20.0)}), size=SIZE)
        passes = len(list(engine.record.plan.walk()))
        # What ran is weighed as it is put away as well, once more where something stood under its key.
        assert sum(weighed.values()) <= passes + 2 * len(engine.record.ran)
        weighed.clear()
        engine.render(sketch.with_values({"light.sun": (130.0, 20.0)}), size=SIZE)
        assert engine.record.ran == [] and sum(weighed.values()) <= passes


# ── Sizes as a sketch writes them: of passes, of what feeds an input, and of fast variants


TERRAIN = """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return float(texel.x + 100 * texel.y); }
"""
ROWS = """#pragma kernel(output = "rows:r32f")
uniform sampler2D height; //! input
float kernel(ivec2 texel) {
    float total = 0.0;
    for (int x = 0; x < textureSize(height, 0).x; x++) total += texelFetch(height, ivec2(x, texel.y), 0).r;
    return total;
}
"""
ALL = """#pragma kernel(output = "total:r32f")
uniform sampler2D rows; //! input
float kernel(ivec2 texel) {
    float total = 0.0;
    for (int y = 0; y < textureSize(rows, 0).y; y++) total += texelFetch(rows, ivec2(0, y), 0).r;
    return total;
}
"""
SUM = (
    passes(rows=("./rows", 'size = [1, "height.size.y"]'), total=("./all", "size = 1"))
    + '[inputs]\nheight = "rows.height"\n'
)
VARIANT = """// The same sum at once.
#pragma compute(groups = "1, 1", local = "1, 1")
uniform sampler2D height; //! input
void main() {
    ivec2 whole = textureSize(height, 0);
    float total = 0.0;
    for (int y = 0; y < whole.y; y++) {
        for (int x = 0; x < whole.x; x++) total += texelFetch(height, ivec2(x, y), 0).r;
    }
    imageStore(out_total, ivec2(0), vec4(total));
}
"""
SKETCH = (
    "format = 1\nsize = [17, 9]\n"
    + passes(
        terrain=("./terrain", 'size = ["size.x // 2", "size.y + 3"]'),
        sum=("./sum", 'inputs = { height = "terrain" }'),
    )
    + map_of("sum")
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in {"terrain.glsl": TERRAIN, "rows.glsl": ROWS, "all.glsl": ALL, "sum.toml": SUM}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return tmp_path


def total(engine: Engine, folder: Path) -> float:
    terrain = engine.read(load(folder), "terrain")
    assert terrain.shape == (12, 8)
    return float(terrain.astype(np.float64).sum())


def test_an_expression_names_the_size_of_what_feeds_an_input(engine: Engine, folder: Path):
    sketch = load(folder)
    assert engine.read(sketch, "sum.rows").shape == (12, 1)
    result = engine.read(sketch, "sum")
    assert result.shape == (1, 1)
    assert float(result[0, 0]) == total(engine, folder)


@pytest.mark.usefixtures("trusted_variants")
def test_compute_variant_has_size_of_replaced_pass(engine: Engine, folder: Path):
    (folder / "sum.comp").write_text(VARIANT, encoding="utf-8")
    sketch = load(folder)
    result = engine.read(sketch, "sum")
    stood_in = engine.driver == "compute"
    assert ("sum" in engine.runs) == stood_in
    assert result.shape == (1, 1)
    assert float(result[0, 0]) == total(engine, folder)


@pytest.mark.usefixtures("trusted_variants")
def test_pass_replaced_by_compute_variant_can_still_be_read(engine: Engine, folder: Path):
    (folder / "sum.comp").write_text(VARIANT, encoding="utf-8")
    assert engine.read(load(folder), "sum.rows").shape == (12, 1)


def test_a_size_may_ask_for_compute_shaders(ctx, tmp_path: Path):
    (tmp_path / "flat.glsl").write_text(
        '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.5; }\n',
        encoding="utf-8",
    )
    (tmp_path / "sketch.toml").write_text(
        'format = 1\n[[pass]]\nname = "height"\nuse = "./flat"\nsize = "17 if compute else 9"\n',
        encoding="utf-8",
    )
    for driver in ("fragment", "auto"):
        notices: list[str] = []
        with Engine(ctx, driver=driver, notice=notices.append) as engine:
            has = engine.info.compute and driver != "fragment"
            for _ in range(2):
                assert engine.read(load(tmp_path), "height").shape == ((17, 17) if has else (9, 9))
        assert len(notices) == (0 if has else 1)
        assert has or notices[0].startswith(
            "the sketch does without compute shaders, which are not here: see "
        )


# ── A pass may be as large as the picture that a parameter reads ─────────────


PHOTO = (
    "format = 1\n"
    + passes(photo=("foreign/image", 'set = { image = "a.png" }', "size = SIZE"))
    + map_of("photo")
)


def picture(path: Path, width: int, height: int) -> None:
    write_png(path, np.full((height, width, 4), 255, np.uint8))


def size_of(engine: Engine, folder: Path) -> tuple[int, int]:
    engine.draw(load(folder), size=(8, 8))
    assert engine.record.plan is not None
    return engine.record.plan.step("photo").size  # type: ignore[union-attr]


@pytest.mark.parametrize(
    "size, expected",
    [
        ('"photo.image.size"', (24, 16)),
        ('["photo.image.size.x // 2", "photo.image.size.y + 1"]', (12, 17)),
    ],
)
def test_a_size_names_the_picture(
    tmp_path: Path, any_engine: Engine, size: str, expected: tuple[int, int]
) -> None:
    picture(tmp_path / "a.png", 24, 16)
    (tmp_path / "sketch.toml").write_text(PHOTO.replace("SIZE", size), "utf-8")
    assert size_of(any_engine, tmp_path) == expected


def test_it_follows_the_file_and_the_value(tmp_path: Path, any_engine: Engine) -> None:
    picture(tmp_path / "a.png", 24, 16)
    picture(tmp_path / "b.png", 5, 7)
    (tmp_path / "sketch.toml").write_text(PHOTO.replace("SIZE", '"photo.image.size"'), "utf-8")
    sketch = load(tmp_path)
    for file, expected in (("a.png", (24, 16)), ("b.png", (5, 7)), ("a.png", (24, 16))):
        any_engine.draw(sketch.with_values({"photo.image": file}), size=(8, 8))
        assert any_engine.record.plan is not None
        assert any_engine.record.plan.step("photo").size == expected  # type: ignore[union-attr]
    picture(tmp_path / "a.png", 9, 9)
    any_engine.draw(sketch, size=(8, 8))
    assert any_engine.record.plan.step("photo").size == (9, 9)  # type: ignore[union-attr]


def test_a_file_that_is_missing_or_no_picture_is_named(tmp_path: Path, any_engine: Engine) -> None:
    (tmp_path / "sketch.toml").write_text(PHOTO.replace("SIZE", '"photo.image.size"'), "utf-8")
    with pytest.raises(PlaygroundError, match="no such file"):
        size_of(any_engine, tmp_path)
    (tmp_path / "a.png").write_bytes(b"none")
    with pytest.raises(PlaygroundError, match=r"a\.png"):
        size_of(any_engine, tmp_path)


def test_a_parameter_that_reads_no_picture_has_no_size(tmp_path: Path) -> None:
    (tmp_path / "sketch.toml").write_text(PHOTO.replace("SIZE", '"photo.images.size"'), "utf-8")
    with pytest.raises(PlaygroundError, match=r"photo\.images\.size"):
        load(tmp_path)
