"""What holds for every technique that makes terrain, found in the folder and by the rows of a table."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from itertools import combinations
from zlib import crc32

import numpy as np
import pytest

from playground.data import delaunay
from playground.engine.engine import Engine
from playground.engine.planner import repeats_of
from playground.errors import PlaygroundError, SketchError
from playground.paths import GLSL
from playground.sketch.assign import shown_parameters, value_of, values_of
from playground.sketch.find import is_part
from playground.sketch.model import Parameter, Sketch, Value
from playground.sketch.wiring import input_names, is_optional, output_names

from ..loading import library
from ..sketch_texts import passes, use
from .conftest import BOTH_TEXTS

NEEDS_A_FILE = {"generation/heightmap"}
MADE = [
    name
    for name in library()
    if name.startswith("generation/") and name not in NEEDS_A_FILE and not is_part(name)
]
SIZES = [(1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (33, 33), (2, 9), (13, 6)]


def outputs(name: str) -> list[str]:
    return list(output_names(library()[name]))


@pytest.fixture
def sketch_of(make_sketch) -> Callable[..., Sketch]:
    def make(name: str, size: tuple[int, int] = (33, 33), **values: object) -> Sketch:
        result = library()[name]
        expected = [input_name for input_name in input_names(result) if not is_optional(result, input_name)]
        wires = {item: f"feed_{i}" for i, item in enumerate(expected)}
        feeds = {f"feed_{i}": use("generation/white_noise", seed=i) for i in range(len(expected))}
        return make_sketch(passes(**feeds, a=use(name, inputs=wires, **values)), size=size)

    return make


def taken(any_engine: Engine, sketch: Sketch, name: str) -> dict[str, np.ndarray] | None:
    """Return every output; None where the technique does not take the size, and says which it takes."""
    try:
        return {output: any_engine.read(sketch, f"a:{output}").copy() for output in outputs(name)}
    except PlaygroundError as error:
        assert "the nearest it takes" in str(error), str(error)
        return None


def fitting(any_engine: Engine, sketch_of: Callable[..., Sketch], name: str, **values: object) -> Sketch:
    for size in ((33, 33), (32, 32)):
        sketch = sketch_of(name, size, **values)
        if taken(any_engine, sketch, name) is not None:
            return sketch
    raise AssertionError(f"{name} takes neither 33 nor 32 texels a side")


def parameters(sketch: Sketch) -> dict[str, Parameter]:
    """Return the parameters that a technique shows, by path."""
    return {s.path: s.parameter for s in shown_parameters(sketch) if s.exported and s.path.startswith("a.")}


def extremes(parameter: Parameter) -> Iterator[Value]:
    widget = parameter.widget
    if widget.kind == "menu":
        yield from range(len(widget.choices))
    elif parameter.type == "bool":
        yield from (False, True)
    elif widget.low is not None and widget.high is not None:
        whole = parameter.type[0] in "iu"
        for end in (widget.low, widget.high):
            number = int(end) if whole else float(end)
            count = len(parameter.default) if isinstance(parameter.default, tuple) else 0
            yield (number,) * count if count else number


def looks_normalised(sketch: Sketch, values: dict[str, np.ndarray]) -> bool:
    if "a.normalise" not in parameters(sketch) or "height" not in values:
        return False
    return value_of(sketch, "a.normalise", values_of(sketch)) == 2


def assert_good(sketch: Sketch, values: dict[str, np.ndarray], what: str) -> None:
    for output, array in values.items():
        assert np.isfinite(array).all(), f"{what}: {output} holds what is no number"
    if looks_normalised(sketch, values):
        low, high = values["height"].min(), values["height"].max()
        assert (low, high) in ((0.0, 1.0), (0.0, 0.0)), f"{what}: heights from {low} to {high}"


ONE_HAS_NO_STEP = "generation/first_height"
"""The first lesson's kernel: it divides by ``size - 1``, and its readers have not met ``max``."""


@pytest.mark.parametrize("name", MADE)
def test_every_size_is_taken_or_refused_with_those_nearest(any_engine, sketch_of, name):
    accepted = 0
    for size in SIZES:
        if name == ONE_HAS_NO_STEP and 1 in size:
            continue
        sketch = sketch_of(name, size)
        values = taken(any_engine, sketch, name)
        if values is not None:
            accepted += 1
            assert_good(sketch, values, f"{name} at {size}")
    assert accepted >= 2


@pytest.mark.parametrize("name", MADE)
def test_every_parameter_may_go_to_its_ends(any_engine, sketch_of, name):
    """Each alone, and all of them together."""
    sketch = fitting(any_engine, sketch_of, name)
    cases = [{path: value} for path, p in parameters(sketch).items() for value in extremes(p)]
    for end in (0, -1):
        ends = {p: list(extremes(q))[end] for p, q in parameters(sketch).items() if list(extremes(q))}
        cases.append({path: value for path, value in ends.items() if path != "a.normalise"})
    for case in cases:
        changed = sketch.with_values(case)
        values = taken(any_engine, changed, name)
        if "a.normalise" in case:
            assert values is not None and all(np.isfinite(v).all() for v in values.values())
        elif values is not None:
            assert_good(changed, values, f"{name} with {case}")


@pytest.mark.parametrize("name", MADE)
def test_a_seed_names_one_terrain(ctx, any_engine, sketch_of, name):
    sketch = fitting(any_engine, sketch_of, name)
    first = taken(any_engine, sketch, name)
    with Engine(ctx) as another:
        again = taken(another, sketch, name)
    assert first is not None and again is not None
    for output in first:
        np.testing.assert_array_equal(first[output], again[output])
    seeds = [path for path in parameters(sketch) if path.endswith("seed")]
    for path in seeds:
        other = taken(any_engine, sketch.with_values({path: 1234}), name)
        assert other is not None
        assert not np.array_equal(other[outputs(name)[0]], first[outputs(name)[0]]), path


@pytest.mark.parametrize("name", MADE)
def test_every_repeat_can_be_stopped_at_every_turn(any_engine, sketch_of, name):
    sketch = fitting(any_engine, sketch_of, name)
    repeats = {path: whole for path, whole in repeats_of(sketch).items() if path.startswith("a")}
    for path, whole in repeats.items():
        last = any_engine.read(sketch, path).copy()
        for turn in sorted({0, 1, whole // 2, max(whole - 1, 0), whole}):
            state = any_engine.read(sketch, path, steps={path: turn})
            assert np.isfinite(state).all()
            if turn == whole:
                np.testing.assert_array_equal(state, last)


NORMALISED = {
    "circles": "raw",
    "delaunay": "tin",
    "diamond_square": "raw",
    "fault_formation": "",  # a filter comes between
    "fbm": "sum",
    "fourier": "",
    "gradient_noise": "sum",
    "layered_noise": "sum",
    "layered_noise_tiled": "mix",
    "midpoint_displacement": "raw",
    "mixed": "mix",
    "mixed_tiled": "mix",
    "multiply": "",
    "triangle_subdivision": "raw",
}
"""The pass whose heights are normalised, by technique: held against NumPy where each technique is."""


@BOTH_TEXTS
@pytest.mark.parametrize("name", NORMALISED)
def test_heights_are_normalised_as_by_numpy(engine, sketch_of, name):
    """By default from lowest to highest; diamond-square's stay, or its smoothing would mean nothing."""
    use = f"generation/{name}"

    def heights(ref="a", **values):
        return engine.read(fitting(engine, sketch_of, use, **values), ref).astype(np.float64)

    raw = heights(normalise="none")
    if NORMALISED[name]:
        inner = heights(f"a.{NORMALISED[name]}", normalise="none")
        np.testing.assert_allclose(raw, inner, atol=1e-5 if engine.driver == "auto" else 0)
    stretched = (raw - raw.min()) / np.ptp(raw)
    np.testing.assert_allclose(heights(normalise="minmax"), stretched, atol=4e-6)
    np.testing.assert_allclose(heights(normalise="max"), raw / raw.max(), atol=4e-6)
    np.testing.assert_array_equal(
        heights(), heights(normalise="none" if name == "diamond_square" else "minmax")
    )


def test_the_table_has_every_technique_that_normalises():
    having = {
        name.removeprefix("generation/")
        for name in MADE
        if any(p.name == "normalise" for p in library()[name].parameters)
    }
    assert set(NORMALISED) == having


NOTHING = [
    ("circles", {"iterations": 0}),
    ("circles", {"smallest": 0.0, "largest": 0.0}),
    ("fault_formation", {"iterations": 0}),
    ("fbm", {"octaves": 0}),
    ("gradient_noise", {"octaves": 0}),
    *(("gradient_noise", {"octaves": 0, "shape": shape}) for shape in ("ridged", "billow", "warped")),
    *(("layered_noise", {"octaves": 0, "overflow": way}) for way in ("divide", "clamp", "wrap")),
    *(("layered_noise", {"persistence": 0.0, "overflow": way}) for way in ("divide", "clamp", "wrap")),
    ("midpoint_displacement", {"size": (2, 2)}),  # which has no middle
]


@BOTH_TEXTS
@pytest.mark.parametrize(("name", "values"), NOTHING, ids=str)
def test_nothing_to_add_is_flat_terrain(engine, sketch_of, name, values):
    for normalise in ("none", "max", "minmax"):
        flat = engine.read(sketch_of(f"generation/{name}", normalise=normalise, **values), "a")
        np.testing.assert_array_equal(flat, 0)


@pytest.mark.parametrize("name", ["diamond_square", "midpoint_displacement", "triangle_subdivision"])
def test_a_size_it_cannot_halve_is_refused_with_the_nearest(any_engine, engine, sketch_of, name):
    for each in (any_engine, engine):
        with pytest.raises(SketchError, match="65 x 65 or 129 x 129"):
            each.read(sketch_of(f"generation/{name}", (100, 100)), "a")


# ── sizes: a preview at 257² shows the terrain of 2049² ──────────────────────

ALIKE = {
    "diamond_square": 0.99,
    "midpoint_displacement": 0.99,
    "triangle_subdivision": 0.99,
    "layered_noise": 0.99,
    "fourier": 0.99,
    "circles": 0.99,
    "delaunay": 0.99,
    "fault_formation": 0.99,
    "fbm": 0.95,  # a larger size adds octaves
    "gradient_noise": 0.95,
    "mixed": 0.95,
    "mixed_tiled": 0.95,
    "layered_noise_tiled": 0.95,
}
"""The correlation of a terrain with a larger one, read at its texels."""
OTHERS = [
    ("layered_noise", {"random_layers": "independent", "octaves": 4, "persistence": 0.5}),
    ("mixed", {"persistence": 0.2, "shape_range": "none", "normalise": "none"}),
    ("mixed_tiled", {"persistence": 0.2, "tiles": 8, "seams": "left"}),
    ("layered_noise_tiled", {"octaves": 3, "persistence": 0.5}),
    ("diamond_square", {"normalise": "minmax", "random": "positive", "smoothing": 0.9}),
    ("fourier", {"roughness": 1.5, "normalise": "none"}),
]


@pytest.fixture
def terrain_of(any_engine, single):
    def terrain(name, size, **values):
        return any_engine.read(single(f"generation/{name}", size, **values), "terrain").astype(np.float64)

    return terrain


def likeness(small, large, step=0):
    step = step or (len(large) - 1) // (len(small) - 1)
    return np.corrcoef(small.ravel(), large[::step, ::step].ravel())[0, 1]


@pytest.mark.parametrize("seed", [7, 1234])
@pytest.mark.parametrize("sizes", [(65, 129), (129, 513), (257, 513)], ids=str)
@pytest.mark.parametrize("name", ALIKE)
def test_a_seed_is_one_terrain_at_every_size(terrain_of, name, sizes, seed):
    """As it comes, normalised or not; a terrain of 33 texels or fewer has no room for its details."""
    small, large = (terrain_of(name, size, seed=seed) for size in sizes)
    assert likeness(small, large) >= ALIKE[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", ALIKE)
def test_a_preview_shows_the_terrain_of_2049(terrain_of, name):
    assert likeness(terrain_of(name, 257, seed=3), terrain_of(name, 2049, seed=3)) >= ALIKE[name]


@pytest.mark.parametrize(("name", "values"), OTHERS, ids=str)
def test_with_any_parameters(terrain_of, name, values):
    assert likeness(terrain_of(name, 129, **values), terrain_of(name, 257, **values)) >= 0.95


def test_halved_terrains_agree_to_the_last_bits(terrain_of):
    """What a coarse level makes, a finer one does not touch: the same points, the same heights."""
    for name in ("diamond_square", "midpoint_displacement", "triangle_subdivision"):
        small, large = (terrain_of(name, size, normalise="none") for size in (65, 257))
        np.testing.assert_allclose(small, large[::4, ::4], atol=2e-6)


@pytest.mark.parametrize(
    ("name", "small", "large", "step"),
    [
        ("fourier", 64, 128, 2),
        ("fourier", 128, 512, 4),
        ("fourier", (257, 129), (513, 257), 2),
        ("layered_noise", (257, 129), (513, 257), 2),
    ],
)
def test_a_power_of_two_and_a_long_terrain(terrain_of, name, small, large, step):
    assert likeness(terrain_of(name, small), terrain_of(name, large), step) >= 0.99


def test_white_noise_is_texel_by_texel(terrain_of):
    """By its definition it has no shape that a larger size could keep."""
    assert abs(likeness(terrain_of("white_noise", 129), terrain_of("white_noise", 257))) < 4 / 129


# ── salts: no two techniques draw the same numbers ───────────────────────────

SALT = re.compile(r'^const uint \w*SALT = 0x([0-9a-f]{8})u;  // CRC-32 of "([^"]+)"$', re.M)
DRAWS = re.compile(
    r"\b(hash3|random|random_pair|random_signed|lattice_seed|seed_of_layer|perlin|simplex|\w+_periodic)\("
)
FILES = [path for end in ("glsl", "comp") for path in sorted(GLSL.rglob(f"*.{end}"))]
WINDOW = 2**20
"""Seeds go up to 9999, times 64 in some materials, and each has some numbers more for its layers."""
UNSALTED = "generation/first_height"
"""The first lesson's kernel: those who write their first one have not met salts. It has none."""
DRAWN = [
    *("first_height", "white_noise", "diamond_square", "midpoint_displacement", "triangle_subdivision"),
    *("layered_noise", "fourier", "fbm", "gradient_noise", "circles", "fault_formation"),
]


def salts():
    files = [(m[2], int(m[1], 16)) for path in FILES for m in SALT.finditer(path.read_text(encoding="utf-8"))]
    return [*files, ("delaunay", delaunay.SALT)]


def test_salts_are_checksums_and_differ_by_more_than_seeds_do():
    """A salted seed of one technique is never one of another's."""
    assert len({name for name, _ in salts()}) == len(salts()) > 25
    for name, number in salts():
        assert number == crc32(name.encode()), name
    for (first, a), (other, b) in combinations([*salts(), (UNSALTED, 0)], 2):
        apart = (a - b) % 2**32
        assert min(apart, 2**32 - apart) > WINDOW, (first, other)


@pytest.mark.slow
def test_whoever_draws_has_a_salt():
    """Kernels, not the library that they include; the technique's name begins as the file's does."""
    seen = 0
    for path in FILES:
        text = path.read_text(encoding="utf-8")
        name = path.relative_to(GLSL).with_suffix("").as_posix()
        if name.startswith("noise/") or name == UNSALTED or "#pragma" not in text:
            continue
        if not DRAWS.search(re.sub(r"//.*", "", text)):
            continue
        seen += 1
        assert re.search(r"\b\w*SALT\b|\bseed_of_layer\(", text), f"{name} draws without a salt"
    assert seen > 20


def bumps(terrain):
    """Return how far each texel is above the mean of the four around it."""
    around = terrain[1:-1, :-2] + terrain[1:-1, 2:] + terrain[:-2, 1:-1] + terrain[2:, 1:-1]
    return (terrain[1:-1, 1:-1] - around / 4).ravel()


def test_techniques_of_one_seed_know_nothing_of_each_other(terrain_of):
    """White noise, the halved terrains and layers shared their numbers, texel by texel."""
    sums = {}
    for seed in (0, 7, 4242):
        result = {name: bumps(terrain_of(name, 65, seed=seed)) for name in DRAWN}
        for first, other in combinations(DRAWN, 2):
            r = np.corrcoef(result[first], result[other])[0, 1]
            sums.setdefault((first, other), []).append(r)
    for pair, each in sums.items():
        assert abs(np.mean(each)) < 0.1, (pair, each)
