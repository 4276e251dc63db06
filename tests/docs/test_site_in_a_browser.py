"""The site in a real browser: search in two languages, from a server and a folder; no page too wide."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest

from ..report.browser import MISSING, Browser

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(MISSING), reason=MISSING)]

FOUND = "document.querySelectorAll('.md-search-result__item').length"
ELSEWHERE = (
    "return performance.getEntriesByType('resource').map(e => e.name)"
    ".filter(name => !name.startsWith(location.origin) && !name.startsWith('file:'))"
)
NARROW, WIDE = 390, 1280  # pixels: a phone, a desk


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, form: str, *values: object) -> None:
        """Keep the test's output to itself."""


@pytest.fixture
def server(site: Path) -> Iterator[str]:
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(site))) as found:
        thread = Thread(target=found.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{found.server_port}"
        found.shutdown()
        thread.join()


@pytest.mark.parametrize("word", ["penumbra", "pénombre"])
@pytest.mark.parametrize("kind", ["server", "folder"])
def test_a_word_is_found(kind: str, word: str, site: Path, server: str, tmp_path: Path):
    top = server if kind == "server" else site.as_uri()
    with Browser(tmp_path / "profile") as browser:
        browser.open(f"{top}/reference/glossary.html?q={word}")
        browser.wait(f"{FOUND} > 0")
        assert browser.run(ELSEWHERE) == []


@pytest.mark.parametrize("width", [NARROW, WIDE])
def test_no_page_is_wider_than_the_window(width: int, site: Path, server: str, tmp_path: Path):
    with Browser(tmp_path / "profile", width) as browser:
        browser.emulate(
            "setDeviceMetricsOverride", width=width, height=800, deviceScaleFactor=1, mobile=False
        )
        for page in (
            "index",
            "reference/commands",
            "reference/configuration",
            "reference/gallery",
            "reference/python",
            "reference/techniques/lighting-night",
            "tutorials/first-kernel",
        ):
            browser.open(f"{server}/{page}.html")
            assert browser.run("return document.documentElement.scrollWidth") <= width, page
            assert browser.log() == [], page
