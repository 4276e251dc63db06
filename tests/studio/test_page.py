"""The page of sliders in a browser as narrow as a phone's: it sets values, and follows the window."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.engine.engine import Engine

from ..browser import MISSING, Browser
from .remote_desk import TOKEN, Harness

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(MISSING), reason=MISSING)]

ROW = "document.querySelector('.row[data-path=\"height.{}\"]')"


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("profile"), 412, 915) as made:
        yield made


@pytest.fixture
def page(remote: Harness, browser: Browser) -> Iterator[Browser]:
    server = remote.open(port=0, token=TOKEN).server
    remote.during(lambda: browser.open(server.url))
    remote.during(lambda: browser.wait("document.querySelectorAll('.row').length > 8"))
    remote.during(lambda: browser.wait("document.getElementById('picture').naturalWidth === 48"))
    try:
        yield browser
        assert remote.during(browser.log) == [], "nothing was refused, nothing failed"
    finally:
        remote.during(lambda: browser.open("about:blank"))


def shown(remote: Harness, page: Browser, name: str, what: str) -> object:
    return remote.during(lambda: page.run(f"return {ROW.format(name)}.{what}"))


def test_a_slider_sets_a_value_and_follows_the_window(remote: Harness, page: Browser, tmp_path: Path) -> None:
    level = '.row[data-path="height.level"] input'
    remote.during(lambda: page.drag(level, (0, 0), (100, 0)))
    remote.until(lambda: remote.value("height.level") > 0.5)
    text = shown(remote, page, "level", "querySelector('.number').value")
    assert text == f"{remote.value('height.level'):.3f}"
    assert "changed" in str(shown(remote, page, "level", "className"))
    remote.during(lambda: page.click("#undo"))
    remote.until(lambda: remote.value("height.level") == 0.25)
    remote.session.drafts.set("height.level", 0.75)
    remote.during(lambda: page.wait(f"{ROW.format('level')}.querySelector('input').value == 0.75"))
    if target := os.environ.get("PAGE_PICTURE"):
        Path(target).write_bytes(remote.during(page.picture))


def test_each_widget_sets_what_the_window_has(remote: Harness, page: Browser) -> None:
    def change(name: str, script: str) -> None:
        at = f"const at = (n) => {ROW.format(name)}.querySelectorAll('input, select')[n];"
        remote.during(lambda: page.run(at + script))

    for name, script, value in (
        ("scale", "at(0).value = 0.5; at(0).oninput()", 1000**0.5),
        ("count", "at(0).value = 0.71; at(0).oninput()", 7),
        ("sun", "at(1).value = 45; at(1).onchange()", (135.0, 45.0)),
        ("kind", "at(0).value = 1; at(0).onchange()", 1),
        ("rocks", "at(0).click()", False),
        ("tint", "at(0).value = '#00ff00'; at(0).oninput()", (0.0, 1.0, 0.0)),
        ("middle", "at(0).value = 0.1; at(0).onchange()", (0.1, 0.5)),
        ("free", "at(0).value = -3.5; at(0).onchange()", -3.5),
    ):
        change(name, script)
        before, end = remote.value(f"height.{name}"), time.monotonic() + 20
        while remote.value(f"height.{name}") != pytest.approx(value, rel=1e-3):  # type: ignore[arg-type]
            assert time.monotonic() < end, f"{name} is {remote.value(f'height.{name}')}, and was {before}"
            remote.frame()
    pressed = remote.pressed()
    remote.during(lambda: page.run(f"{ROW.format('fire')}.querySelector('button').click()"))
    remote.until(lambda: pressed == ["height.fire"])
    change("place", "at(1).value = 2.5; at(1).onchange()")
    remote.until(lambda: remote.value("height.place") == (0.0, 2.5))
    change("grass", "at(0).value = '/etc/passwd'; at(0).onchange()")
    remote.during(lambda: page.wait("document.getElementById('message').textContent.includes('own folder')"))


def test_a_pad_turns_the_sun_and_a_row_goes_back_to_the_file(remote: Harness, page: Browser) -> None:
    """The rows are those of an exported page: pads, digits of a colour, what sets a row back."""
    sun = '.row[data-path="height.sun"]'
    seen = f"document.querySelector('{sun}').scrollIntoView({{ block: 'end' }})"
    remote.during(lambda: page.run(seen))
    remote.during(lambda: page.drag(f"{sun} .pad", (0, 0), (-20, 0)))
    remote.until(lambda: remote.value("height.sun")[0] == pytest.approx(270.0, abs=4.0))  # to a pixel
    assert 0 < remote.value("height.sun")[1] < 90
    remote.during(lambda: page.wait(f"document.querySelector('{sun}').className.includes('changed')"))
    remote.during(lambda: page.click(f"{sun} .reset"))
    remote.until(lambda: remote.value("height.sun") == (135.0, 25.0))
    remote.during(lambda: page.wait(f"!document.querySelector('{sun}').className.includes('changed')"))
    digits = f"{ROW.format('tint')}.querySelector('.hex')"
    remote.during(lambda: page.run(f"{digits}.value = '#0000ff'; {digits}.onchange()"))
    remote.until(lambda: remote.value("height.tint") == (0.0, 0.0, 1.0))


def test_time_presets_errors_and_the_search(remote: Harness, page: Browser, tmp_path: Path) -> None:
    remote.during(lambda: page.click("#play"))
    remote.until(lambda: not remote.session.clock.playing)
    remote.during(lambda: page.wait("document.getElementById('play').textContent === 'Play'"))
    remote.during(lambda: page.run("const t = document.getElementById('time'); t.value = 2.5; t.onchange()"))
    remote.until(lambda: remote.session.clock.time == 2.5)
    remote.during(
        lambda: page.run("const p = document.getElementById('preset'); p.value = 'high'; p.onchange()")
    )
    remote.until(lambda: remote.value("height.level") == 0.75)
    remote.during(
        lambda: page.run("const s = document.getElementById('search'); s.value = 'lev'; s.oninput()")
    )
    assert (
        remote.during(lambda: page.run("return document.querySelectorAll('.row:not([hidden])').length")) == 1
    )
    kernel = remote.session.path.parent / "hills.glsl"
    text = kernel.read_text("utf-8")
    kernel.write_text(text.replace("return level", "return nothing"), encoding="utf-8")
    remote.session.drafts.reload()
    remote.during(lambda: page.wait("document.getElementById('message').textContent.includes('hills.glsl')"))
    kernel.write_text(text, encoding="utf-8")
    remote.session.drafts.reload()
    remote.during(lambda: page.wait("document.getElementById('message').hidden"))


def test_a_channel_keeps_the_name_that_the_shader_gives_it(
    any_engine: Engine, browser: Browser, tmp_path: Path
) -> None:
    """The panel writes `iChannel0` too; a word in small letters begins with a capital."""
    toy = tmp_path / "toy.frag"
    text = (
        "uniform float gain;\nvoid mainImage(out vec4 c, in vec2 p) { c = gain * texture(iChannel0, p); }\n"
    )
    toy.write_text(text, "utf-8")
    remote = Harness(any_engine, toy)
    try:
        server = remote.open(port=0, token=TOKEN).server
        remote.during(lambda: browser.open(server.url))
        remote.during(lambda: browser.wait("document.querySelectorAll('.row').length > 1"))
        heads = "return [...document.querySelectorAll('h2')].map(head => head.innerText)"
        value = remote.during(lambda: browser.run(heads))
        assert "iChannel0" in value and "View" in value
    finally:
        remote.during(lambda: browser.open("about:blank"))
        remote.close()
