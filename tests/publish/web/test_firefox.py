"""Sketches have the engine's bits in Firefox as well, on the same renderer."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import moderngl
import pytest

from playground.engine.engine import Engine
from playground.publish.web.page_data import page_data

from .firefox import MISSING, Firefox
from .pages import MISSING as MISSING_PAGES
from .pages import Pages
from .test_every_sketch import SIZE, small

pytestmark = pytest.mark.slow

SKETCHES = (
    "diamond_square",  # a kernel that repeats
    "fourier",  # steps that read each other
    "geomipmap",  # tiles, chosen by texels that are read back
    "height_blend_image",  # image files
    "horizon_maps",  # textures of 16 bits, which Firefox lacks
    "life",  # a state from frame to frame
    "splat_many",  # 16 textures at once
    "sun_flight",  # keyframes
    "triplanar",  # mipmaps
    "wireframe",  # draws over draws
)


@pytest.fixture(scope="module")
def written() -> dict[str, Any]:
    return page_data([small(name) for name in SKETCHES], frame=SIZE)


@pytest.fixture(scope="module")
def firefox(tmp_path_factory: pytest.TempPathFactory, written: dict[str, Any]) -> Iterator[Pages]:
    if missing := MISSING or MISSING_PAGES:
        pytest.skip(missing)
    with Pages(tmp_path_factory.mktemp("firefox"), browser=Firefox) as pages:
        pages.begin(written)
        yield pages


@pytest.fixture(scope="module")
def engine(shared_context: moderngl.Context, firefox: Pages) -> Iterator[Engine]:
    with Engine(shared_context, driver="fragment", notice=lambda _: None) as made:
        if "llvmpipe" not in made.info.renderer or "llvmpipe" not in firefox.renderer():
            pytest.skip("needs llvmpipe in the browser and in the engine")
        yield made


@pytest.mark.parametrize("name", SKETCHES)
def test_firefox_draws_a_sketch_as_the_engine_does(
    name: str, firefox: Pages, engine: Engine, written: dict[str, Any]
):
    firefox.open(written["sketches"][SKETCHES.index(name)])
    frame = engine.render(small(name), size=SIZE)
    assert firefox.picture(name).levels_off(frame.array) == 0
