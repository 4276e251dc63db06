"""The site builds without a warning, loads nothing from the network, and is searched in two languages."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from functools import partial
from html.parser import HTMLParser
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest

import playground
from playground.commands.entries import techniques as listed

from ..browser import MISSING, Browser

pytestmark = pytest.mark.slow
IN_A_BROWSER = pytest.mark.skipif(bool(MISSING), reason=MISSING)

FOUND = "document.querySelectorAll('.md-search-result__item').length"
ELSEWHERE = (
    "return performance.getEntriesByType('resource').map(e => e.name)"
    ".filter(name => !name.startsWith(location.origin) && !name.startsWith('file:'))"
)
NARROW, WIDE = 390, 1280  # pixels: a phone, a desk


class Loads(HTMLParser):
    """What a page loads by itself: all but the links that a reader follows."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        self.found += [values[name] for name in ("src", "srcset", "data", "poster") if name in values]
        if tag == "link" and values.get("rel") not in ("canonical", "next", "prev"):
            self.found.append(values.get("href", ""))


def test_nothing_is_loaded_from_the_network(site: Path):
    for page in site.rglob("*.html"):
        loads = Loads()
        loads.feed(page.read_text("utf-8"))
        assert not [url for url in loads.found if re.match(r"(?:\w+:)?//", url)], page
    for style in site.rglob("*.css"):
        assert not re.search(r"(?:@import|url\()\s*['\"]?(?:https?:)?//", style.read_text("utf-8")), style


MAX_SITE_BYTES = 28e6  # bytes: 24 MB now; with every page's whole navigation in each page it is 45 MB


def test_every_image_is_there_and_pages_stay_small(site: Path):
    for page in site.rglob("*.html"):
        for image in re.findall(r'<img [^>]*src="([^"]+)"', page.read_text("utf-8")):
            assert (page.parent / image).is_file(), (page, image)
    assert sum(path.stat().st_size for path in site.rglob("*") if path.is_file()) < MAX_SITE_BYTES


def test_the_search_knows_english_and_french(site: Path):
    index = json.loads((site / "search" / "search_index.json").read_text("utf-8"))
    assert index["config"]["lang"] == ["en", "fr"]
    assert list(site.rglob("lunr.fr.min.js"))
    texts = " ".join(entry["title"] + entry["text"] for entry in index["docs"])
    assert "penumbra" in texts and "pénombre" in texts and "playground render" in texts


def test_every_technique_and_public_name_has_its_place(site: Path):
    for entry in listed():
        assert (site / "reference" / "techniques" / f"{entry.name.replace('/', '-')}.html").is_file()
    text = (site / "reference" / "python.html").read_text("utf-8")
    for name in playground.__all__:
        assert f'id="playground.{name}"' in text or name == "__version__", name


def test_no_source_of_the_site_is_published(site: Path):
    assert not [path for path in site.rglob("*.py") if path.name in ("hooks.py", "pages.py")]


# In a real browser


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, form: str, *values: object) -> None:
        """Keep the test's output to itself."""


@pytest.fixture
def server(site: Path) -> Iterator[str]:
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(site))) as result:
        thread = Thread(target=result.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{result.server_port}"
        result.shutdown()
        thread.join()


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("profile")) as result:
        yield result


@IN_A_BROWSER
@pytest.mark.parametrize("word", ["penumbra", "pénombre"])
@pytest.mark.parametrize("kind", ["server", "folder"])
def test_a_word_is_found(kind: str, word: str, site: Path, server: str, browser: Browser):
    top = server if kind == "server" else site.as_uri()
    browser.visit(f"{top}/reference/glossary.html?q={word}")
    browser.wait(f"{FOUND} > 0")
    assert browser.run(ELSEWHERE) == []


@IN_A_BROWSER
@pytest.mark.parametrize("width", [NARROW, WIDE])
def test_no_page_is_wider_than_the_window(width: int, server: str, browser: Browser):
    browser.visit(f"{server}/index.html")
    browser.emulate("setDeviceMetricsOverride", width=width, height=800, deviceScaleFactor=1, mobile=False)
    browser.log()  # of the tests before
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
