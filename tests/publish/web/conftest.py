"""One Node process, one page in a browser and one engine for each module of tests."""

from __future__ import annotations

from collections.abc import Iterator

import moderngl
import pytest

from playground.engine.engine import Engine
from tests.publish.web import node as processes

from .pages import MISSING, Pages


@pytest.fixture(scope="module")
def node() -> Iterator[processes.Node]:
    """Give a Node process that calls the runtime's modules."""
    if processes.MISSING:
        pytest.skip(processes.MISSING)
    with processes.Node() as result:
        yield result


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Pages]:
    """Give a page with the runtime in it, in a browser on the engine's own renderer."""
    if MISSING:
        pytest.skip(MISSING)
    with Pages(tmp_path_factory.mktemp("page")) as result:
        yield result


@pytest.fixture(scope="session")
def exporting(shared_context: moderngl.Context) -> Iterator[Engine]:
    """Give an engine that draws what sources are made of, as each export has one."""
    with Engine(shared_context, notice=lambda _: None) as made:
        yield made


@pytest.fixture(scope="module")
def drawn(shared_context: moderngl.Context, pages: Pages) -> Iterator[Engine]:
    """Give an engine that draws as pages do: by fragment shaders, on the renderer that they are on."""
    with Engine(shared_context, driver="fragment", notice=lambda _: None) as made:
        if "llvmpipe" not in made.info.renderer or "llvmpipe" not in pages.renderer():
            pytest.skip("needs llvmpipe in the browser and in the engine")
        yield made
