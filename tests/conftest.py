"""What every test shares: one headless context, checked for OpenGL errors around each test."""

from __future__ import annotations

import gc
import os
import re
from collections import Counter
from collections.abc import Generator, Iterator
from pathlib import Path

import moderngl
import numpy as np
import pytest

from playground.engine.context import open_context, open_contexts, release_context
from playground.engine.engine import Engine
from playground.rooms import ROOMS

from .spread import Spread

# Where Mesa puts compiled shaders without this variable, named so that a test or a process of one with
# a home or caches of its own finds there what is compiled already: that takes most of a cold run.
MESA_CACHE = os.environ.get("XDG_CACHE_HOME") or str(Path("~/.cache").expanduser())
os.environ.setdefault("MESA_SHADER_CACHE_DIR", MESA_CACHE)
os.environ.pop("PLAYGROUND_PROGRAM", None)  # of ./play test: messages are the same however tests are started

pytest_plugins = ["pytester"]

ROOT = Path(__file__).resolve().parent.parent
OTHER_ROOMS = "(?=studio|publish|verify|course|flight|lsp)"  # that tests of another room may import from
ROOM_IMPORT = re.compile(
    rf"^(?:(?:from|import) playground\.|from (?:tests|\.)\.+{OTHER_ROOMS})(\w+)", re.MULTILINE
)
OBJECTS = (
    moderngl.Texture,
    moderngl.TextureCube,
    moderngl.Texture3D,
    moderngl.TextureArray,
    moderngl.Framebuffer,
    moderngl.Renderbuffer,
    moderngl.Buffer,
    moderngl.VertexArray,
    moderngl.Program,
    moderngl.ComputeShader,
    moderngl.Sampler,
)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--seed",
        metavar="HASH",
        default="",
        help="sample the cases of tests that have many by this seed; the commit's hash by default",
    )
    parser.addoption(
        "--half",
        type=int,
        choices=(1, 2),
        help="run one half of the test functions, chosen by the seed: for two Pythons that share a run",
    )
    parser.addoption(
        "--all", action="store_true", help="run every case of every test, slow ones too unless -m is given"
    )


def pytest_configure(config: pytest.Config) -> None:
    every_case = config.getoption("--all")
    if every_case and config.option.markexpr == "not slow":
        config.option.markexpr = ""
    half = config.getoption("--half")
    config.pluginmanager.register(Spread(config.getoption("--seed"), every_case, config.args, half=half))


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Leave out a file of tests that imports from a room that has been removed (``playground/rooms.py``)."""
    if (
        collection_path.suffix != ".py"
        or not collection_path.is_file()
        or not collection_path.is_relative_to(ROOT / "tests")
    ):
        return None
    names = set(ROOM_IMPORT.findall(collection_path.read_text("utf-8")))
    return True if names - {path.stem for path in (ROOT / "playground").iterdir()} else None


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip what needs a room that is not there."""
    for marker in item.iter_markers("room"):
        if marker.args[0] not in ROOMS:
            pytest.skip(f"needs playground/{marker.args[0]}")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect without looking for garbage: nothing of thousands of tests is any, and they stay."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.fixture(autouse=True)
def _strict_numbers() -> Iterator[None]:
    with np.errstate(all="raise"):
        yield


@pytest.fixture(autouse=True)
def _released_contexts() -> Iterator[None]:
    """See that a test releases the contexts that it opens; a dropped one may be collected by any thread."""
    before = open_contexts()
    yield
    assert open_contexts() <= before, "a context that this test opened was not released"


@pytest.fixture
def trusted_variants(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let fast variants run though they are not verified: what is tested is how they run."""
    monkeypatch.setattr("playground.sketch.variants.is_verified", lambda technique, variant: True)


@pytest.fixture(scope="session")
def shared_context() -> Iterator[moderngl.Context]:
    """Give one headless context for the whole session."""
    ctx = open_context()
    yield ctx
    release_context(ctx)


@pytest.fixture
def ctx(shared_context: moderngl.Context) -> Iterator[moderngl.Context]:
    """Give the context, and see that the test leaves no OpenGL error behind."""
    shared_context.__enter__()  # a test before may have opened another, which then was the current one
    assert shared_context.error == "GL_NO_ERROR"
    yield shared_context
    shared_context.__enter__()
    assert shared_context.error == "GL_NO_ERROR"


@pytest.fixture(params=["fragment", "compute"])
def engine(request: pytest.FixtureRequest, ctx: moderngl.Context) -> Iterator[Engine]:
    """Give an engine of each driver."""
    if request.param == "compute" and ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx, driver=request.param) as made:
        yield made


@pytest.fixture
def any_engine(ctx: moderngl.Context) -> Iterator[Engine]:
    """Give an engine that chooses its drivers itself."""
    with Engine(ctx) as made:
        yield made


@pytest.fixture
def alive(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """Count moderngl objects that are made and not yet released."""
    gc.freeze()  # what thousands of tests before have left is not searched again and again
    count: Counter[str] = Counter()
    names = {"texture": "Texture", "framebuffer": "Framebuffer", "renderbuffer": "Renderbuffer"}
    names |= {"depth_renderbuffer": "Renderbuffer", "buffer": "Buffer", "vertex_array": "VertexArray"}
    names |= {"texture_cube": "TextureCube", "texture3d": "Texture3D", "texture_array": "TextureArray"}
    names |= {"program": "Program", "compute_shader": "ComputeShader", "sampler": "Sampler"}
    for function, kind in names.items():
        real = getattr(moderngl.Context, function)

        def made(self, *arguments, _real=real, _kind=kind, **named):
            result = _real(self, *arguments, **named)
            count[_kind] += 1
            return result

        monkeypatch.setattr(moderngl.Context, function, made)
    for kind in OBJECTS:
        real = kind.release

        def gone(self, _real=real, _kind=kind.__name__):
            if not isinstance(getattr(self, "mglo", None), moderngl.InvalidObject):
                count[_kind] -= 1
            _real(self)

        monkeypatch.setattr(kind, "release", gone)
    return count
