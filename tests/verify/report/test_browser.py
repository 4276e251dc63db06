"""The page in a browser: what its script shows is what the files hold, and a click accepts a picture."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import read_png
from playground.verify.shots.report import write_report
from playground.verify.shots.review import Review

from ...browser import MISSING, Browser
from .pictures import picture

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(MISSING), reason=MISSING)]

NAME = "<script>alert(1)<∕script>"  # a slash of its own kind: no folder can have the usual one
CANVAS = 'document.querySelector(".current canvas")'


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


@pytest.fixture
def page(leave, browser: Browser) -> Iterator[Browser]:
    """Give a report on three failures, the first of which shows two pictures of noise."""
    leave("hills/dawn", picture(1, 64, 36), picture(2, 64, 36))
    leave("hills/dusk", picture(3))
    leave(f"{NAME}/night", word="hang", message=f"stopped {NAME}", error=NAME)
    path = write_report(Path("results"))
    browser.open("about:blank")
    browser.open(f"{path.absolute().as_uri()}#hills/dawn")
    browser.wait('document.querySelector(".current .panes canvas")')
    yield browser
    assert browser.log() == [], "nothing was refused, nothing failed"


def pixel(browser: Browser, x: float, y: float) -> list[int]:
    """Return what the first pane shows at a fraction of its width and height."""
    browser.run("return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return browser.run(
        f"const c = {CANVAS}; return [...c.getContext('2d').getImageData("
        "Math.floor(arguments[0] * c.width), Math.floor(arguments[1] * c.height), 1, 1).data]",
        x,
        y,
    )


def shown(browser: Browser, selector: str) -> str:
    return browser.run("return document.querySelector(arguments[0])?.textContent ?? ''", selector)


def test_shown_values_match_files_even_with_alpha(page: Browser) -> None:
    """A canvas would give other colours back: it keeps them multiplied by alpha."""
    now, before = picture(1, 64, 36), picture(2, 64, 36)
    page.run('document.querySelector(".current .panes").focus()')
    seen = set()
    page.press("\ue014")  # → shows where one is
    for _ in range(12):
        where, *_ = shown(page, ".current .where").split("\n")
        x, y = (int(part.split(" ")[1]) for part in where.split(", "))
        values = page.run(
            'return [...document.querySelectorAll(".current .values b")].map(b => b.textContent)'
        )
        expected, actual = before[y, x].astype(int), now[y, x].astype(int)
        assert values[:2] == [" ".join(map(str, v)) for v in (expected, actual)]
        signed = [f"{'+' if d > 0 else '−' if d < 0 else ''}{abs(d)}" for d in actual - expected]
        assert values[2] == " ".join(signed)
        seen.add((x, y))
        page.press("\ue014", "\ue015")  # → ↓
    assert len(seen) == 12


def test_the_divider_parts_expected_from_actual(leave, browser: Browser) -> None:
    red, blue = np.zeros((72, 128, 4), np.uint8), np.zeros((72, 128, 4), np.uint8)
    red[..., [0, 3]], blue[..., [2, 3]] = 255, 255
    red[0, 0] = blue[0, 0] = (0, 0, 0, 255)  # or they would be blank
    leave("a/x", blue, red)
    browser.open(write_report(Path("results")).absolute().as_uri())
    browser.wait('document.querySelector(".current .panes canvas")')
    browser.press("2")
    assert pixel(browser, 0.25, 0.9) == [255, 0, 0, 255] and pixel(browser, 0.75, 0.9) == [0, 0, 255, 255]
    width = browser.run(f"return {CANVAS}.clientWidth")
    browser.drag(".current canvas", (0, 20), (int(width * 0.3), 20))
    assert pixel(browser, 0.75, 0.9) == [255, 0, 0, 255] and pixel(browser, 0.84, 0.9) == [0, 0, 255, 255]
    browser.press("a")
    assert pixel(browser, 0.2, 0.9) == [0, 0, 255, 255]
    browser.press("3", "e")
    assert pixel(browser, 0.5, 0.9) == [255, 0, 0, 255]
    browser.press("[", "]")  # none below nothing; one step of 5 % to actual
    red_now, _, blue_now, _ = pixel(browser, 0.5, 0.9)
    assert abs(red_now - 242) <= 2 and abs(blue_now - 13) <= 2
    browser.press("4", "e")
    assert pixel(browser, 0.5, 0.9) == [255, 0, 0, 255] and shown(browser, ".turn") == "Expected"
    browser.press("b")  # goes on
    browser.wait('document.querySelector(".turn").textContent === "Actual"')
    assert browser.log() == []


def test_zoomed_to_the_worst_pixel_it_is_one_square(page: Browser) -> None:
    x, y = map(int, page.run('return document.querySelector(".current").dataset.place').split(","))
    page.press("5", "w", "m")  # the difference, at the worst pixel, without its mark
    page.wait('document.querySelector(".current .level").textContent.trim() === "1600 %"')  # drawn by now
    assert shown(page, ".current .where") == f"x {x}, y {y}"
    difference = read_png(Path("results/hills/dawn.difference.png"))[0]
    result = page.run("return [viewer.x, viewer.y, viewer.zoom]")
    width, height = page.run(f"return [{CANVAS}.clientWidth, {CANVAS}.clientHeight]")
    for dx, dy in ((0.3, 0.3), (0.7, 0.7), (0.3, 0.7)):  # inside it, off the grid and the frame
        left, top = width / 2 + (x + dx - result[0]) * 16, height / 2 + (y + dy - result[1]) * 16
        assert pixel(page, left / width, top / height) == difference[y, x].tolist()


def test_the_list_is_searched_and_filtered_and_walked_by_keys(page: Browser) -> None:
    assert shown(page, "#shown") == "2 of 3 failures", "by the address; the list is by name"
    page.press("j")
    assert page.run("return location.hash") == "#hills/dusk"
    page.press("k", "k")
    assert shown(page, ".current h2").endswith("night")
    page.press("/", *"dusk")
    assert shown(page, "#shown") == "1 of 1 failure (3 in all)"
    assert shown(page, ".current h2") == "hills / dusk"
    page.run('const s = document.querySelector("#search"); s.value = ""; s.dispatchEvent(new Event("input"))')
    page.click('.words [data-word="hang"]')
    assert shown(page, "#shown") == "1 of 1 failure (3 in all)"
    assert shown(page, ".current pre") == NAME


def test_names_stay_text(page: Browser) -> None:
    """An alert would be open now, and WebDriver would say so at the next command."""
    assert page.run("return document.scripts.length") == 1
    assert page.run('return document.querySelectorAll("article script, nav script").length') == 0


def test_a_click_accepts_and_another_undoes(leave, browser: Browser) -> None:
    path = Path("screenshots/hills/llvmpipe")
    leave("hills/dawn", picture(1, 64, 36), picture(2, 64, 36))
    leave("hills/dusk", picture(3))
    before = (path / "dawn.png").read_bytes()
    with Review(Path("results")) as review:
        serving = threading.Thread(target=review.serve, daemon=True)
        serving.start()
        browser.open(review.url)
        browser.wait('document.querySelector(".current .panes canvas")')
        browser.wait('document.querySelector(".current [data-do=accept]:enabled")')
        browser.click(".current [data-do=accept]")
        browser.wait('document.querySelector(".current").dataset.state === "accepted"')
        np.testing.assert_array_equal(read_png(path / "dawn.png")[0], picture(1, 64, 36))
        assert "wrote screenshots/hills/llvmpipe/dawn.png" in shown(browser, ".current .message")
        browser.press("u")
        browser.wait('document.querySelector(".current").dataset.state === "open"')
        assert (path / "dawn.png").read_bytes() == before
        browser.click("#accept-shown")
        assert browser.run('return document.querySelector("#ask-list").innerText.split("\\n")') == [
            "hills/dawn",
            "hills/dusk",
        ]
        browser.click("#ask-also")
        browser.click("#ask-yes")
        browser.wait(
            'document.querySelectorAll(".shot[data-state=further], .shot[data-state=accepted]").length === 2'
        )
        assert sorted(path.name for path in path.iterdir()) == ["dawn.2.png", "dawn.png", "dusk.png"]
        browser.click("#done")
        serving.join(120)
        assert not serving.is_alive()
        browser.wait('document.querySelector("#banner").innerText.startsWith("Done")')
    assert browser.log() == []
