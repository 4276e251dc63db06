"""One HTML file: what people wrote is text in it, what runs is named by its hash, the bytes are the same."""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
import re
from html.parser import HTMLParser
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from playground.publish.web.blobs import packed
from playground.publish.web.bundle import read_bundle
from playground.publish.web.page import Poster, page_html
from playground.publish.web.page_data import page_data
from tests import browser as browsers

from ...loading import load
from .node import Node
from .pages import parts_of

EVIL = "</script></title><img src=x onerror=\"document.body.dataset.broken='1'\"><!--<script>"
POSTER = Poster(
    base64.b64decode("R0lGODlhAQABAIAAAAAAAP///yH5BAEAAAAALAAAAAABAAEAAAIBRAA7"), "image/gif", (1, 1)
)
SCRIPT = "document.documentElement.dataset.ran = 'yes';\n"
STYLE = "body { color: rgb(1, 2, 3) }\n"
KERNEL = f"""// {EVIL}
#pragma kernel(output = "colour:rgba8")
uniform float a = 0.5;  //! slider(0, 1) label("{EVIL.replace('"', "'")}") group("<b>") {EVIL}
vec4 kernel(ivec2 texel) {{ return vec4(a); }}
"""
TOML = f"""format = 1
title  = '''{EVIL}'''
[view]
use = "./<b>&evil"
[[preset]]
name = '''{EVIL}'''
set  = {{ "view.a" = 0.25 }}
"""


@pytest.fixture
def evil(tmp_path: Path) -> dict[str, Any]:
    folder = tmp_path / "<img src=x onerror=alert(1)>"
    folder.mkdir()
    (folder / "<b>&evil.glsl").write_text(KERNEL)
    (folder / "sketch.toml").write_text(TOML)
    return page_data([load(folder)])


def page_of(data: dict[str, Any]) -> str:
    return page_html(data, POSTER, script=SCRIPT, style=STYLE)


class Elements(HTMLParser):
    """The elements of a page, and the texts of those that hold no markup."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.inside = ""
        self.texts: dict[str, str] = {}
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))
        self.inside = dict(attrs).get("id") or dict(attrs).get("data-blob") or tag

    def handle_endtag(self, tag: str) -> None:
        self.inside = ""

    def handle_data(self, data: str) -> None:
        self.texts[self.inside] = self.texts.get(self.inside, "") + data

    def handle_comment(self, data: str) -> None:
        raise AssertionError(f"a comment: {data}")


def test_what_people_wrote_is_text(evil: dict[str, Any]):
    page = Elements(page_of(evil))
    expected = "html head meta meta meta meta meta meta title link style body"
    expected += " main img noscript p p p script script"
    assert [tag for tag, _ in page.found] == expected.split()
    assert page.texts["title"] == EVIL
    [image] = [value for tag, value in page.found if tag == "img"]
    assert image["alt"] == EVIL and set(image) == {"id", "src", "alt", "width", "height"}
    _, data, _ = parts_of(page.texts["playground-packed"])
    assert json.loads(data)["sketches"][0]["title"] == EVIL


def test_nothing_in_the_data_can_end_its_element(evil: dict[str, Any]):
    evil["shared"]["blobs"][EVIL] = packed(data := 99 * bytes(range(256)) + EVIL.encode())
    page = Elements(page_of(evil))
    assert [value["data-blob"] for _, value in page.found if "data-blob" in value] == [EVIL]
    assert gzip.decompress(base64.b64decode(page.texts[EVIL])) == data


def test_the_policy_names_what_runs_and_allows_nothing_else(evil: dict[str, Any]):
    page = Elements(page_of(evil))
    [policy] = [value["content"] for _, value in page.found if value.get("http-equiv")]
    assert policy
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))

    def digest(text: str) -> str:
        return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"

    style, _, script = parts_of(page.texts["playground-packed"])
    assert (style, script) == (STYLE, SCRIPT)
    assert rules == {
        "default-src": "'none'",
        "script-src": f"{digest(page.texts['script'])} {digest(SCRIPT)}",
        "style-src": f"{digest(page.texts['style'])} {digest(STYLE)}",
        "img-src": "data: blob:",
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    assert not [value for _, value in page.found if any(name.startswith("on") for name in value)]


def test_it_is_read_as_it_was_written(node: Node, evil: dict[str, Any]):
    evil["shared"]["blobs"][EVIL] = packed(b"elevation")
    texts = Elements(page_of(evil)).texts
    script = """async (texts, keys, load) => {
        const { unpacked, unpackedText } = await load("packed.js");
        const { readPage } = await load("packed.js");
        const data = (await unpackedText(texts["playground-packed"])).split("\\0")[1];
        const elements = keys.map((key) => ({ dataset: { blob: key }, textContent: texts[key] }));
        const page = readPage({
            getElementById: () => ({ textContent: data }), querySelectorAll: () => elements,
        });
        const { blobs } = page.shared;
        for (const key of keys) blobs[key] = new Uint8Array(await unpacked(blobs[key]));
        return page;
    }"""
    result = node.run(script, texts, [EVIL])
    assert result["shared"].pop("blobs")[EVIL].tobytes() == b"elevation"
    del evil["shared"]["blobs"]
    assert result == json.loads(json.dumps(evil))


def test_the_same_sketch_gives_the_same_bytes():
    first, second = (page_of(page_data([load("delaunay_flips")])) for _ in range(2))
    assert first == second


@pytest.mark.skipif(bool(browsers.MISSING), reason=browsers.MISSING)
def test_a_browser_runs_the_runtime_and_nothing_that_was_put_in(tmp_path: Path, evil: dict[str, Any]):
    path = tmp_path / "page.html"
    path.write_text(page_of(evil), encoding="utf-8")
    with browsers.Browser(tmp_path / "profile") as browser:
        browser.open(path.as_uri())
        browser.wait("document.documentElement.dataset.ran === 'yes'")
        assert browser.log() == []
        assert browser.run("return document.body.dataset.broken ?? ''") == ""
        assert browser.run("return getComputedStyle(document.body).color") == "rgb(1, 2, 3)"
        assert browser.run("return document.title").strip() == re.sub(r"\s+", " ", EVIL)
        assert browser.run("return document.getElementById('playground-poster').naturalWidth") == 1
        assert browser.run("return document.getElementById('playground-old').hidden") is True
        assert browser.run("return performance.getEntriesByType('resource').length") == 0
        browser.run(
            "const put = document.createElement('script');"
            "put.textContent = 'document.body.dataset.broken = 1'; document.body.append(put)"
        )
        assert browser.run("return document.body.dataset.broken ?? ''") == ""
        assert any("Content Security Policy" in line for line in browser.log())


@pytest.mark.slow
@pytest.mark.skipif(bool(browsers.MISSING), reason=browsers.MISSING)
def test_a_server_that_names_another_encoding_does_no_harm(tmp_path: Path, evil: dict[str, Any]):
    body = page_of(evil).encode()

    class Latin(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html; charset=iso-8859-1")
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            pass

    with (
        ThreadingHTTPServer(("127.0.0.1", 0), Latin) as server,
        browsers.Browser(tmp_path / "profile") as browser,
    ):
        Thread(target=server.serve_forever, daemon=True).start()
        browser.open(f"http://127.0.0.1:{server.server_port}/")
        browser.wait("document.readyState === 'complete'")
        ran = browser.run("return document.documentElement.dataset.ran ?? ''")
        server.shutdown()
    assert ran == "yes"


LOADED = """
async (loader, text, old, load) => {
    const shown = {}, made = [];
    const textOf = (id) => (id === "playground-packed" ? text : "");
    const element = (id) => shown[id] ??= { hidden: true, textContent: textOf(id) };
    const document = {
        getElementById: element, createElement: (kind) => ({ kind }),
        head: { append: (one) => made.push(one.kind + ":" + one.textContent) },
    };
    const world = old ? {} : { DecompressionStream };
    new Function("document", "globalThis", loader)(document, world);
    const told = () => Object.keys(shown).filter((id) => !shown[id].hidden);
    for (let wait = 0; wait < 200 && made.length < 3 && !told().length; wait++) {
        await new Promise((done) => setTimeout(done, 10));
    }
    return [made, told()];
}
"""
WHOLE = packed("a\0bé\0\ufeffc".encode())


@pytest.mark.parametrize(
    ("text", "old", "made", "names"),
    [
        (WHOLE, False, ["style:a", "script:bé", "script:\ufeffc"], []),
        (WHOLE, True, [], ["playground-old"]),
        (packed(b"a\0b"), False, [], ["playground-damaged"]),
        (WHOLE[:-4], False, [], ["playground-damaged"]),
        (WHOLE[:20] + ("A" if WHOLE[20] != "A" else "B") + WHOLE[21:], False, [], ["playground-damaged"]),
        ("", False, [], ["playground-damaged"]),
    ],
    ids=["whole", "old browser", "a part less", "cut short", "another letter", "nothing"],
)
def test_loader_tells_old_browser_from_damaged_file(
    text: str, old: bool, made: list[str], names: list[str], node: Node
):
    assert node.run(LOADED, read_bundle("loader.js"), text, old) == [made, names]
