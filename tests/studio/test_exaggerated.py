"""A terrain shown higher than it is, against closed forms: slopes, shadows, the sea; and no data changes."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.engine.camera import look, pan
from playground.engine.engine import Engine
from playground.engine.exaggeration import LARGEST, exaggeration
from playground.paths import GLSL
from playground.shader.kernel import TerrainKernel
from playground.sketch.find import shipped_sketches
from playground.sketch.load import load
from playground.sketch.model import Camera, Kernel, kernels_of
from playground.sketch.techniques import name_of, read_technique
from playground.studio.picture.view import View
from playground.studio.session import Session

from ..sketch_texts import SMALL_VIEW, passes, use
from .session_desk import OpenSession

N, EXTENT, RELIEF, SUN = 65, 64.0, 8.0, 45.0
HEAD = f"format = 1\nsize = {N}\nextent = {EXTENT}\nrelief = {RELIEF}\nbase_elevation = 100.0\n"
KERNEL = """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return %s; }
"""
FILES = {
    "plane.glsl": KERNEL % "float(texel.x) / float(size.x - 1)",
    "wall.glsl": KERNEL % "texel.x < 32 ? 0.0 : texel.x < 34 ? 1.0 : 0.0",
    "own.glsl": """#pragma kernel(output = "rise:r32f")
uniform sampler2D height; //! input
float kernel(ivec2 texel) { return relief; }
""",
    "prepares.glsl": """#pragma kernel(output = "prepared:r32f", relief = "shown")
uniform sampler2D height; //! input
float kernel(ivec2 texel) { return relief; }
""",
    "dips.glsl": """#pragma kernel(output = "dips:r32f", relief = "true")
uniform sampler2D height; //! input
uniform vec2 dip = vec2(90.0, 45.0); //! direction
float kernel(ivec2 texel) { return relief + 0.0 * towards_dip.z; }
""",
    "lit.glsl": """#pragma kernel(output = "lit:r32f")
uniform sampler2D height; //! input
uniform vec2 sun = vec2(90.0, 45.0); //! direction
float kernel(ivec2 texel) { return relief * towards_sun.z; }
""",
    "on_plane.toml": HEAD
    + passes(
        height="./plane",
        light=use("lighting/l_dot_n", sun={"azimuth": 270.0, "elevation": SUN}, gain=1.0),
        lines=use("view/contours", interval=1.0),
        rise="./own",
        lit="./lit",
        prepared="./prepares",
        dips="./dips",
    )
    + SMALL_VIEW,
    "on_wall.toml": HEAD
    + passes(
        height="./wall",
        light=use("lighting/ray_cast", sun={"azimuth": 90.0, "elevation": SUN}, gain=1.0),
    )
    + SMALL_VIEW,
}


def opened(open_session: OpenSession, path: Path) -> Session:
    session: Session = open_session(path)
    assert session.frame((48, 32)) is not None, session.error
    return session


def read(session: Session, ref: str) -> NDArray[np.float32]:
    values = session.read_values(ref)
    assert values is not None, session.notes
    return values


@pytest.mark.parametrize("factor", [1.0, 2.0, 3.0])
def test_a_plane_is_lit_by_the_normal_of_what_is_seen(
    open_session: OpenSession, folder: Path, factor: float
) -> None:
    session = opened(open_session, folder / "on_plane.toml")
    session.exaggerate(factor)
    slope = factor * RELIEF / EXTENT  # rises to the east; the sun is in the west
    sun = math.radians(SUN)
    received = (slope * math.cos(sun) + math.sin(sun)) / math.hypot(slope, 1.0)
    assert read(session, "light:light")[20:40, 20:40, 0] == pytest.approx(received, rel=2e-3)


@pytest.mark.parametrize("factor", [1.0, 2.0])
def test_a_wall_twice_as_high_throws_a_shadow_twice_as_long(
    open_session: OpenSession, folder: Path, factor: float
) -> None:
    session = opened(open_session, folder / "on_wall.toml")
    session.exaggerate(factor)
    visible = read(session, "light:light")[32, :32, 3]
    assert np.count_nonzero(visible < 0.5) == pytest.approx(factor * RELIEF, abs=1)


def test_no_data_changes_and_nothing_is_made_again(open_session: OpenSession, folder: Path) -> None:
    session = opened(open_session, folder / "on_plane.toml")
    refs = ("height:height", "lines:colour", "rise:rise")
    before = [read(session, ref) for ref in refs]
    runs = dict(session.engine.runs)
    session.exaggerate(3.0)
    session.frame((48, 32))
    assert all(np.array_equal(read(session, ref), old) for ref, old in zip(refs, before, strict=True))
    assert session.engine.runs["height"] == runs["height"]
    assert session.shown is not None and session.shown.sketch == session.shown.file
    assert session.plan is not None and session.plan.terrain.relief == RELIEF


def test_a_kernel_of_ones_own_follows_if_light_has_a_direction(
    open_session: OpenSession, folder: Path
) -> None:
    session = opened(open_session, folder / "on_plane.toml")
    session.exaggerate(2.0)
    assert read(session, "rise:rise")[0, 0] == RELIEF
    assert read(session, "lit:lit")[0, 0] == pytest.approx(2 * RELIEF * math.sin(math.radians(45.0)))
    assert read(session, "prepared:prepared")[0, 0] == 2 * RELIEF
    assert read(session, "dips:dips")[0, 0] == RELIEF


def test_a_fast_variant_is_given_the_relief_of_its_kernel() -> None:
    for path in sorted(GLSL.rglob("*.comp")):
        canonical = read_technique(name_of(path), GLSL, GLSL)
        kernels = [kernel for _, kernel in kernels_of(canonical) if kernel.reads("relief")]
        for variant in canonical.variants:
            for _, fast in kernels_of(variant.technique):
                if fast.reads("relief"):
                    assert {shows(fast)} == {shows(k) for k in kernels}, path


def shows(kernel: Kernel) -> bool:
    return isinstance(kernel, TerrainKernel) and kernel.shows_relief


@pytest.mark.parametrize("factor", [1.0, 2.5])
def test_the_eye_goes_on_looking_at_the_same_place(factor: float) -> None:
    view, camera = View(), Camera(azimuth=350.0, target=(10.0, 20.0, 30.0))
    view.exaggeration, view.turned = factor, 20.0
    seen = view.seen(camera)
    assert seen == Camera(azimuth=10.0, target=(10.0, 20.0, 30.0 * factor))
    assert view.unseen(seen, camera) == camera
    eye = look(seen, (100.0, 100.0), 40.0 * factor, (320, 180))
    panned = view.unseen(pan(seen, eye, 0.1, 0.0), camera)
    assert panned.target is not None and panned.target[2] == pytest.approx(30.0)
    assert panned.target[:2] != (10.0, 20.0) and panned.azimuth == camera.azimuth
    assert view.seen(Camera(azimuth=5.0)).target is None


def test_the_sea_stays_at_its_shore() -> None:
    given = exaggeration(2.0)
    assert given is not None
    draw = read_technique("view/sea", GLSL, GLSL)
    assert isinstance(draw, Kernel)
    terrain = {"relief": 800.0, "base_elevation": 200.0}
    replaced = given.given(draw, {"sea_level": 320.0}, terrain)
    shore = (320.0 - 200.0) / 800.0  # the height of the shore
    assert 320.0 - replaced["base_elevation"] == pytest.approx(shore * replaced["relief"])


def test_factors_have_bounds() -> None:
    assert exaggeration(1.0) is None
    largest = exaggeration(1e9)
    assert largest is not None and largest.factor == LARGEST


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped_sketches())
def test_no_height_of_a_shipped_sketch_changes(any_engine: Engine, name: str) -> None:
    """By what textures depend on; what erodes and what flows depends on true metres as well."""
    runner, sketch, results = any_engine.runner, load(name), []
    for factor in (1.0, 2.0):
        runner.exaggeration = exaggeration(factor)
        plan = any_engine.plan(sketch, size=(160, 90))
        runner.set_frame(plan)
        keys = any_engine.keys_of(plan)
        results.append({step.path: keys.result(step.path) for step in plan.walk()})
    for step in plan.walk():
        if results[0][step.path] != results[1][step.path]:
            assert "height" not in {output.name for output in step.kernel.outputs}, step.path
            assert not name_of(Path(step.kernel.path)).startswith(("erosion/", "water/fill")), step.path
