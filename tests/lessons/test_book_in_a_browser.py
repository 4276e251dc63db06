"""The book in a real browser: what one drags, presses, swipes and prints."""

from __future__ import annotations

import pytest

from playground.lessons.book.build import prepare, write_book

from ..report.browser import MISSING, Browser

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(MISSING), reason=MISSING)]

RIGHT, END, HOME, ENTER = "\ue014", "\ue010", "\ue011", "\ue007"
SHOWN = "document.querySelector('#turns li.now img').src.split('/').pop()"
SAID = "document.querySelector('#turns output').textContent"
AT = "document.querySelector('#two input').value"


LONG = "https://doi.org/" + "10.1145/358523.358553" * 4


@pytest.fixture
def book(tmp_path, make_lesson, french, engine):
    folder = tmp_path / "book"
    lesson = make_lesson(("https://doi.org/10.1145/358523.358553", LONG))
    write_book(prepare(folder, {"en": [lesson], "fr": [french]}, gallery=False), engine)
    return folder


@pytest.fixture
def page(book, tmp_path):
    with Browser(tmp_path / "profile") as browser:
        browser.open((book / "en/small.html").as_uri())
        browser.wait("document.querySelectorAll('.controls').length === 3")
        yield browser
        assert browser.log() == []


def count(page, selector):
    return page.run("return document.querySelectorAll(arguments[0]).length", selector)


def test_a_series_is_turned_over_by_keys_and_buttons(page):
    assert page.run(f"return {SHOWN}") == "small-turns-0.webp"
    page.run("document.querySelector('#turns input').focus()")
    page.press(RIGHT)
    assert page.run(f"return {SHOWN}") == "small-turns-1.webp"
    assert page.run(f"return {SAID}") == page.run(
        "return document.querySelector('#turns input').getAttribute('aria-valuetext')"
    )
    page.press(END)
    last = page.run(f"return {SHOWN}")
    page.press(HOME, RIGHT)
    page.click("#turns .controls button:nth-of-type(1)")
    assert page.run(f"return {SHOWN}") == "small-turns-0.webp"
    page.click("#turns .controls button:nth-of-type(3)")  # plays to its end, and stops there
    page.wait(f"{SHOWN} === arguments[0]", last)
    words = page.run("return document.body.dataset.run")
    page.wait(
        "document.querySelector('#turns .controls button:nth-of-type(3)').textContent === arguments[0]", words
    )
    assert count(page, "#turns li.now") == 1


def test_a_button_at_the_end_of_a_series_keeps_the_keys(page):
    page.run("document.querySelector('#smooth .controls button').focus()")
    page.press(ENTER, ENTER)
    place = "document.querySelector('#smooth input').value"
    assert page.run(f"return {place}") == "0"
    assert page.run("return document.activeElement === document.querySelector('#smooth .controls button')")
    assert page.run("return document.activeElement.getAttribute('aria-disabled')") == "true"


def test_a_comparison_is_swiped_by_mouse_and_keys_and_shown_side_by_side(page):
    page.run("document.querySelector('#two').scrollIntoView({block: 'center', behavior: 'instant'})")
    assert page.run(f"return {AT}") == "50"
    width = page.run("return document.querySelector('#two .variants').getBoundingClientRect().width")
    page.drag("#two .variants", (0, 0), (-round(width / 4), 0))
    assert page.run(f"return {AT}") == "25"
    page.run("document.querySelector('#two input').focus()")
    page.press(RIGHT)
    assert page.run(f"return {AT}") == "26"
    page.click("#two .controls button")
    left, right = page.run(
        "return [...document.querySelectorAll('#two img')].map((i) => i.getBoundingClientRect().toJSON())"
    )
    assert left["right"] <= right["left"] and left["top"] == right["top"]


def test_on_paper_everything_lies_open_and_answers_are_at_the_end(page):
    folded = count(page, "details:not([open])")
    page.run("dispatchEvent(new Event('beforeprint'))")
    page.emulate("setEmulatedMedia", media="print")
    assert count(page, "details:not([open])") == 0
    boxes = page.run(
        "return [...document.querySelectorAll('.frames img, .variants img')].map((i) =>"
        " i.getBoundingClientRect().toJSON())"
    )
    assert len(boxes) == count(page, ".frames li, .variants li") and all(box["width"] > 40 for box in boxes)
    places = {(round(box["left"]), round(box["top"])) for box in boxes}
    assert len(places) == len(boxes)  # none lies over another
    assert page.run("return [...document.querySelectorAll('.frames b')].every((b) => b.offsetWidth > 0)")
    assert page.run("return document.querySelector('nav.top').offsetWidth") == 0
    answers = count(page, "details.answer")
    assert answers > 1 and count(page, ".answers details.answer") == answers  # none is under its question
    assert page.run(
        "return [...document.querySelectorAll('details.answer')].every((a) => a.offsetHeight > 0)"
    )
    page.emulate("setEmulatedMedia", media="")
    page.run("dispatchEvent(new Event('afterprint'))")
    assert count(page, "details:not([open])") == folded > 0
    assert count(page, ".answers") == 0 and count(page, "details.answer") == answers


def test_a_chosen_theme_stays_on_every_page(page, book):
    paper = "getComputedStyle(document.body).backgroundColor"
    before = page.run(f"return {paper}")
    page.click("#theme")
    chosen = page.run(f"return {paper}")
    assert chosen != before
    for name in ("fr/small.html", "en/index.html", "index.html"):
        page.open((book / name).as_uri())
        page.wait(f"{paper} === arguments[0]", chosen)


@pytest.mark.parametrize("name", ["en/small.html", "fr/small.html", "fr/index.html", "index.html"])
def test_no_page_is_wider_than_a_phone(page, book, name):
    page.emulate("setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=2, mobile=True)
    page.open((book / name).as_uri())
    page.run("for (const each of document.querySelectorAll('details')) each.open = true")
    assert page.run("return [innerWidth, document.documentElement.scrollWidth]") == [390, 390]
