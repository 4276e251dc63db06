"""No two techniques draw the same numbers: each adds a salt of its own, found here in the library."""

import re
from itertools import combinations
from zlib import crc32

import numpy as np
import pytest

from playground.data import delaunay
from playground.paths import GLSL

SALT = re.compile(r'^const uint \w*SALT = 0x([0-9a-f]{8})u;  // CRC-32 of "([^"]+)"$', re.M)
DRAWS = re.compile(
    r"\b(hash3|random|random_pair|random_signed|lattice_seed|seed_of_layer|perlin|simplex|\w+_periodic)\("
)
FILES = [path for end in ("glsl", "comp") for path in sorted(GLSL.rglob(f"*.{end}"))]
WINDOW = 2**20
"""Seeds go up to 9999, times 64 in some materials, and each has some numbers more for its layers."""

UNSALTED = "generation/first_height"
"""The first lesson's kernel: those who write their first one have not met salts. It has none."""

TERRAINS = [
    "first_height",
    "diamond_square",
    "midpoint_displacement",
    "triangle_subdivision",
    "layered_noise",
    "white_noise",
    "fourier",
    "fbm",
    "gradient_noise",
    "circles",
    "fault_formation",
]


def salts():
    files = [(m[2], int(m[1], 16)) for path in FILES for m in SALT.finditer(path.read_text(encoding="utf-8"))]
    return [*files, ("delaunay", delaunay.SALT)]


def test_a_salt_is_the_checksum_of_its_name():
    assert len(salts()) > 25
    for name, number in salts():
        assert number == crc32(name.encode()), name


def test_all_salts_differ_by_more_than_seeds_do():
    """A salted seed of one technique is never one of another's."""
    assert len({name for name, _ in salts()}) == len(salts())
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


@pytest.fixture
def terrains(any_engine, make_sketch):
    def make(size, seed):
        result = {}
        for name in TERRAINS:
            sketch = make_sketch(
                f'[[pass]]\nname = "a"\nuse = "generation/{name}"\nset = {{ seed = {seed} }}\n', size=size
            )
            result[name] = any_engine.read(sketch, "a").astype(np.float64)
        return result

    return make


def bumps(terrain):
    """Return how far each texel is above the mean of the four around it."""
    around = terrain[1:-1, :-2] + terrain[1:-1, 2:] + terrain[:-2, 1:-1] + terrain[2:, 1:-1]
    return (terrain[1:-1, 1:-1] - around / 4).ravel()


def test_techniques_of_one_seed_know_nothing_of_each_other(terrains):
    """White noise, the halved terrains and layers shared their numbers, texel by texel."""
    sums = {}
    for seed in (0, 7, 4242):
        result = {name: bumps(terrain) for name, terrain in terrains(65, seed).items()}
        for first, other in combinations(TERRAINS, 2):
            r = np.corrcoef(result[first], result[other])[0, 1]
            sums.setdefault((first, other), []).append(r)
    for pair, each in sums.items():
        assert abs(np.mean(each)) < 0.1, (pair, each)
