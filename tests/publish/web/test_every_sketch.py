"""Every shipped sketch has the engine's bits in a page on the same renderer, whatever is set."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.plan import PlanRequest
from playground.engine.planner import make_plan
from playground.engine.sources import source_kind
from playground.errors import PlaygroundError
from playground.publish.web.page_data import page_data
from playground.publish.web.plan import KINDS
from playground.sketch.find import shipped_sketches
from playground.sketch.model import Sketch

from ...browser import SWIFTSHADER
from ...loading import load
from .pages import MISSING, Pages
from .random_settings import Settings, random_settings

pytestmark = pytest.mark.slow

SIZE = (192, 108)
LAND = 65
SIZES = [(65, 65), (33, 33), (65, 33), (64, 64), (50, 39)]
SETTINGS = 2
OTHER_SIZE, OTHER_LAND = (320, 180), 129  # large enough that shares of pixels mean something
OTHER_RENDERER = ("geomipmap", "fbm_curves", "contours_map", "diamond_square", "fourier", "triplanar",
                  "lighting_hill", "height_blend", "wireframe", "splat")  # fmt: skip


def small(name: str, land: int = LAND) -> Sketch:
    """Return a sketch with a small terrain, where its size is free."""
    sketch = load(name)
    try:
        smaller = sketch.with_values({"size": str(land)})
        make_plan(smaller, PlanRequest(frame_size=SIZE, variants=KINDS))
    except PlaygroundError:
        return sketch
    return smaller


@pytest.fixture(scope="module")
def written(exporting: Engine) -> dict[str, Any]:
    """Give all sketches as one page has them, which shares their texts and images."""
    return page_data([small(name) for name in shipped_sketches()], frame=SIZE, engine=exporting)


@pytest.fixture(scope="module")
def begun(pages: Pages, drawn: Engine, written: dict[str, Any]) -> Callable[..., Pages]:
    """Give what opens a page of all sketches on a device without some extensions, unless that is open.

    Two processes that share these tests take them in any order.
    """
    now: list[tuple[str, ...]] = []

    def begin(*without: str) -> Pages:
        if now != [without]:
            pages.begin(written, without=list(without))
            now[:] = [without]
        return pages

    return begin


@pytest.fixture
def every(begun: Callable[..., Pages]) -> Pages:
    """Give a page that has all sketches' texts and images."""
    return begun()


@pytest.mark.parametrize("name", shipped_sketches())
def test_a_page_draws_a_sketch_as_the_engine_does(
    name: str, every: Pages, drawn: Engine, written: dict[str, Any]
):
    sketch, data = small(name), next(item for item in written["sketches"] if item["name"] == name)
    every.open(data)
    for settings in [Settings(frame=SIZE), *settings_of(sketch, data)]:
        try:
            frame = drawn.render(
                settings.of(sketch), size=settings.frame, time=settings.time, steps=settings.steps
            )
        except PlaygroundError:
            continue  # a setting that the sketch refuses: test_plan sees to that
        picture = every.picture(name, **settings.state(data))
        assert picture.levels_off(frame.array) == 0, settings
    every.run("figures[arguments[0]].close()", name)


@pytest.fixture
def unfiltered(begun: Callable[..., Pages]) -> Pages:
    """Give the page on a device that filters no textures of floats, as many phones."""
    return begun("OES_texture_float_linear")


@pytest.mark.parametrize("name", shipped_sketches())
def test_device_without_float_filter_draws_within_3_levels(
    name: str, unfiltered: Pages, drawn: Engine, written: dict[str, Any]
):
    data = next(item for item in written["sketches"] if item["name"] == name)
    unfiltered.open(data)
    frame = drawn.render(small(name), size=SIZE)
    bound = 3 if reads_filtered_floats(data) else 0
    off = np.abs(unfiltered.picture(name).pixels.astype(int) - frame.array).max(axis=-1)
    # What stands on filtered heights is elsewhere by a rounding, and its outline by a pixel here and there.
    positioned = any("instances" in kernel for kernel in data["kernels"])
    assert np.count_nonzero(off > bound) <= (1e-3 * off.size if positioned else 0)
    unfiltered.run("figures[arguments[0]].close()", name)


def test_most_sketches_read_floats_with_a_filter(written: dict[str, Any]):
    """Or the test before shows little."""
    assert sum(map(reads_filtered_floats, written["sketches"])) >= 58


def reads_filtered_floats(data: dict[str, Any]) -> bool:
    """Whether a sketch reads a texture of 32-bit floats, as a pass makes it, with a linear filter."""
    steps = steps_of(data["nodes"])
    kernels = {step["path"]: data["kernels"][step["kernel"]] for step in steps}
    fed = {
        (loop["path"], name): last for loop in loops_of(data["nodes"]) for name, _, last in loop["feedback"]
    }
    for step in steps:
        wired = dict(step["inputs"])
        for each in kernels[step["path"]]["inputs"]:
            of = wired.get(each["name"]) or {}
            of = fed.get((of.get("loop"), of.get("name")), of)
            if each["sampling"]["filter"] == "linear" and of.get("path") in kernels:
                outputs = {item["name"]: item["format"] for item in kernels[of["path"]]["outputs"]}
                if outputs[of["output"]].endswith("32f"):
                    return True
    return False


def settings_of(sketch: Sketch, data: dict[str, Any]) -> Iterator[Settings]:
    """Yield settings at random, the same in every run, in sizes that are drawn at once."""
    chance = random.Random(sketch.name)
    plan = make_plan(sketch, PlanRequest(frame_size=SIZE, variants=KINDS))
    sources = [step.kernel.registry for step in plan.walk() if step.kernel.kind == "source"]
    for _ in range(SETTINGS):
        settings = random_settings(chance, data, plan)
        settings.frame = SIZE
        if any(source_kind(name).moment for name in sources):
            settings.time = 0.0  # a page has the texels of the moment of its export
        if "size" in settings.terrain:
            settings.terrain["size"] = chance.choice(SIZES)
        yield settings


def test_another_renderer_differs_in_its_rounding_only(
    tmp_path_factory: pytest.TempPathFactory, drawn: Engine
):
    """SwiftShader rounds otherwise: less than 0.4 of a level in the mean, in few pixels by much."""
    if MISSING:
        pytest.skip(MISSING)
    data = page_data([small(name, OTHER_LAND) for name in OTHER_RENDERER], frame=OTHER_SIZE)
    with Pages(tmp_path_factory.mktemp("swiftshader"), SWIFTSHADER) as pages:
        pages.begin(data)
        for item in data["sketches"]:
            pages.open(item)
            frame = drawn.render(small(item["name"], OTHER_LAND), size=OTHER_SIZE)
            difference = np.abs(pages.picture(item["name"]).pixels.astype(int) - frame.array)[..., :3]
            assert difference.mean() < 0.4, item["name"]
            assert (difference.max(axis=2) > 8).mean() < 0.02, item["name"]


def loops_of(nodes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the loops among some nodes, and those inside them."""
    loops = [node for node in nodes if "body" in node]
    return loops + [inside for loop in loops for inside in loops_of(loop["body"])]


def steps_of(nodes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the passes among some nodes, and those inside their loops."""
    values: list[dict[str, Any]] = []
    for node in nodes:
        values += steps_of(node["body"]) if "body" in node else [node]
    return values
