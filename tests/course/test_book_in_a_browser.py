"""The book in a real browser: what one drags, presses, swipes and prints."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.course import traces
from playground.course.book import build
from playground.course.book.build import prepare, write_book
from playground.course.book.live import LiveBook
from playground.course.measures import Number
from playground.course.read import read_lessons
from playground.course.traces import Answer
from playground.engine.engine import Engine

from ..browser import MISSING, Browser
from .conftest import BODY, FRENCH, FRONT, both_languages

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(MISSING), reason=MISSING)]

RIGHT, END, HOME, ENTER = "\ue014", "\ue010", "\ue011", "\ue007"
UP, DOWN, ESCAPE = "\ue013", "\ue015", "\ue00c"
SHOWN = "document.querySelector('#turns li.now img').src.split('/').pop()"
SAID = "document.querySelector('#turns output').textContent"
AT = "document.querySelector('#two input').value"


LONG = "https://doi.org/" + "10.1145/358523.358553" * 4


@pytest.fixture(scope="module")
def book(tmp_path_factory, shared_context):
    folder = tmp_path_factory.mktemp("lesson")
    english, french = folder / "small.md", folder / "petit.md"
    english.write_text((FRONT + BODY).replace("https://doi.org/10.1145/358523.358553", LONG), "utf-8")
    french.write_text(FRENCH, "utf-8")
    lessons = both_languages(english, french)
    with Engine(shared_context) as engine:
        write_book(prepare(folder / "book", lessons, gallery=False), engine)
    return folder / "book"


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with Browser(tmp_path_factory.mktemp("profile")) as browser:
        yield browser


@pytest.fixture
def page(book, browser):
    browser.visit((book / "en/small.html").as_uri())
    browser.wait("document.querySelectorAll('.controls').length === 4")
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
    position = "document.querySelector('#smooth input').value"
    assert page.run(f"return {position}") == "0"
    assert page.run("return document.activeElement === document.querySelector('#smooth .controls button')")
    assert page.run("return document.activeElement.getAttribute('aria-disabled')") == "true"


def test_comparison_slides_by_mouse_and_keys_and_side_by_side(page):
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


BESIDE = "[...document.querySelectorAll('#height .beside span')].map((each) => each.textContent)"
CURRENT = "document.querySelector('#height tr[aria-current] th').textContent"


def test_a_trace_is_stepped_through_by_keys_and_says_its_values(page):
    assert page.run(f"return {CURRENT}") == "0" and "i = 0" in page.run(f"return {BESIDE}")
    page.run("document.querySelector('#height input').focus()")
    page.press(RIGHT, RIGHT)
    assert page.run(f"return {CURRENT}") == "2" and "count = 3" in page.run(f"return {BESIDE}")
    spoken = page.run("return document.querySelector('#height input').getAttribute('aria-valuetext')")
    assert spoken.startswith("i = 2: ") and "count = 3" in spoken
    assert page.run("return document.querySelector('#height input').getAttribute('aria-label')") == "i"
    mark = "getComputedStyle(document.querySelector('#height tr[aria-current] th'), '::before').content"
    assert "▸" in page.run(f"return {mark}")  # not by a colour alone
    page.press(END)
    assert "total = ?" in page.run(f"return {BESIDE}")
    cells = "[...document.querySelector('#height .beside tbody tr').children].map((cell) => cell.offsetWidth)"
    number, code, values = page.run(f"return {cells}")
    assert number < 80 and code > values > 200
    page.emulate("setDeviceMetricsOverride", width=360, height=700, deviceScaleFactor=1, mobile=False)
    number, code, values = page.run(f"return {cells}")
    assert number < 80 and code == values > 200  # one below the other


def test_a_right_number_puts_the_value_into_the_figure(page):
    verdict = "document.querySelector('#corners .verdict').textContent"
    cell = "document.querySelector('#height tr[data-step=\"3\"] td').textContent"
    said = []
    for text in ("two", "2.2", "2,1"):
        page.run("document.querySelector('#corners input').value = arguments[0]", text)
        page.run("document.querySelector('#corners input').focus()")
        page.press(ENTER)
        said.append(page.run(f"return {verdict}"))
        assert page.run(f"return {cell}") == ("2.1" if text == "2,1" else "?")
    assert "Write a number" in said[0] and "Not this" in said[1] and said[2] == "Right: 2.1."
    page.run("document.querySelector('#height input').focus()")
    page.press(END)
    assert "total = 2.1" in page.run(f"return {BESIDE}")


def test_a_page_reads_numbers_as_python_does(page):
    texts = [
        "2.1",
        "2,1",
        " 2.1 ",
        "+2.1",
        "2.1e0",
        "21e-1",
        "2.1001",
        "2.2",
        "−2.1",
        "0002.1",
        "2.1.",
        "2. 1",
    ]
    texts += ["", ".", "nan", "2.1 m", "1e999", "0x2", "2_1", "2.100001", "2\u202f.1", "2.10099", "2.09"]
    answer = Answer(
        float(page.run("return document.querySelector('#corners input').dataset.value")), "2.1", 1e-3
    )
    for text in texts:
        page.run(
            "const field = document.querySelector('#corners .number');"
            "field.querySelector('input').value = arguments[0]; field.querySelector('button').click()",
            text,
        )
        verdict = page.run("return document.querySelector('#corners .verdict').className")
        assert (verdict == "verdict right") == answer.accepts(text), text


def test_paper_has_the_table_and_no_answer(page):
    page.press(RIGHT)
    page.run("dispatchEvent(new Event('beforeprint'))")
    page.emulate("setEmulatedMedia", media="print")
    (total,) = (text for text in page.run(f"return {BESIDE}") if text.startswith("total = 0."))
    assert total.count("|") == 3 and total.endswith("| ?")
    assert page.run("return document.querySelector('#height .controls').offsetWidth") == 0
    assert page.run("return document.querySelector('#height thead th').offsetHeight") > 4
    boxes = (
        "[...document.querySelectorAll('#height .beside td')].map((td) => td.getBoundingClientRect().width)"
    )
    assert min(page.run(f"return {boxes}")) > 200
    page.run("dispatchEvent(new Event('afterprint'))")
    assert "i = 0" in page.run(f"return {BESIDE}")


def test_an_unfolded_answer_puts_the_value_into_the_figure(page):
    page.click("#corners details.answer summary")
    assert page.run("return document.querySelector('#height tr[data-step=\"3\"] td').textContent") == "2.1"


def test_print_opens_all_details_with_answers_at_end(page):
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
    assert count(page, "main details[open]") == 0
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


def test_code_is_copied_as_it_is_written_however_it_wraps(page):
    page.emulate("setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=1, mobile=True)
    copied, written = page.run(
        "const pre = document.querySelector('#mean pre'); getSelection().selectAllChildren(pre);"
        "return [getSelection().toString(), pre.textContent]"
    )
    assert copied.rstrip("\n") == written.rstrip("\n") and "\n    " in written
    first, last, letter = page.run(
        "const wraps = (line) => line.offsetHeight > 1.7 * parseFloat(getComputedStyle(line).lineHeight);"
        "const line = [...document.querySelectorAll('.l')].find(wraps), range = document.createRange();"
        "const walk = document.createTreeWalker(line, NodeFilter.SHOW_TEXT), boxes = [];"
        "for (let node; node = walk.nextNode();) for (let i = 0; i < node.length; i++) {"
        " range.setStart(node, i); range.setEnd(node, i + 1);"
        " if (node.data[i].trim()) boxes.push(range.getBoundingClientRect()); }"
        "const low = boxes.at(-1).top, last = boxes.filter((box) => Math.abs(box.top - low) < 3);"
        "return [boxes[0].left, last[0].left, boxes[0].width]"
    )
    assert last - first == pytest.approx(2 * letter, abs=1.0)


SEARCHED = "[...document.querySelectorAll('#found a')].map((each) => each.getAttribute('href'))"


def test_search_ignores_accents_and_works_by_keyboard(page, book):
    page.open((book / "fr/small.html").as_uri())
    page.run("document.body.focus()")
    page.press("/")
    page.wait("document.activeElement.type === 'search'")
    page.press(*"ecart DE")
    page.wait(f"{SEARCHED}.length === 1")
    assert page.run(f"return {SEARCHED}") == ["small.html#s1-une-chose"]
    assert page.run("return [...document.querySelectorAll('#found mark')].map((m) => m.textContent)")[:2] == [
        "écart",
        "de",
    ]
    page.run("document.querySelector('.find input').select()")
    page.press(*"texel")
    page.wait(f"{SEARCHED}.length > 2")
    first, second = page.run(f"return {SEARCHED}.slice(0, 2)")
    assert first == "glossary.html#texel"  # what it is named after comes first
    page.press(DOWN)
    assert page.run("return document.querySelector('[aria-selected=true]').getAttribute('href')") == second
    page.press(UP, ENTER)
    page.wait("location.hash === '#texel'")
    page.open((book / "fr/small.html").as_uri())
    page.click("#search")
    page.wait("document.querySelector('dialog[open]')")
    page.press(*"zzzz")
    page.wait("document.querySelector('.said').textContent === document.body.dataset.foundNone")
    page.press(ESCAPE)
    page.wait("!document.querySelector('dialog[open]')")


def test_a_term_is_explained_where_it_stands(page):
    said = "document.getElementById('meaning')"
    assert page.run(f"return {said}.hidden")
    page.run("document.querySelector('a.term').scrollIntoView({block: 'center', behavior: 'instant'})")
    page.drag("a.term", (0, 0), (0, 60))  # the mouse comes, and leaves
    page.wait(f"{said}.hidden")
    page.run("document.querySelector('h2').tabIndex = -1; document.querySelector('h2').focus()")
    page.press("\ue004", "\ue004")  # over the link before it
    page.wait(f"!{said}.hidden")
    term = page.run("return document.activeElement.dataset.means")
    assert page.run(f"return {said}.textContent") == term and term.startswith("texel: ")
    assert page.run("return document.activeElement.getAttribute('aria-describedby')") == "meaning"
    page.press(ESCAPE)
    page.wait(f"{said}.hidden")


def test_the_contents_at_the_side_say_where_one_is(page):
    page.emulate("setDeviceMetricsOverride", width=1300, height=500, deviceScaleFactor=1, mobile=False)
    now = "document.querySelector('.toc [aria-current]')?.textContent"
    assert page.run("return document.querySelector('.toc details').open")
    for name in ("One thing", "Exercises"):
        page.run(
            "const found = [...document.querySelectorAll('h2')].find((h) => h.textContent === arguments[0]);"
            "scrollTo({ top: found.offsetTop - 60, behavior: 'instant' })",
            name,
        )
        page.wait(f"{now} === arguments[0]", name)
    page.emulate("setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=1, mobile=True)
    page.wait("!document.querySelector('.toc details').open")


AXE = Path(build.__file__).resolve().parents[2] / "publish/web/node_modules/axe-core/axe.min.js"


@pytest.mark.skipif(not AXE.is_file(), reason="npm ci in playground/publish/web installs axe-core")
def test_book_pages_have_no_serious_accessibility_fault(page, book):
    """Of axe-core's rules, in the light and in the dark; the search is open on one."""
    result = []
    for name in ("index.html", "en/index.html", "en/small.html", "fr/small.html", "en/glossary.html"):
        for theme in ("light", "dark"):
            page.emulate("setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
            page.open((book / name).as_uri())
            page.run("for (const each of document.querySelectorAll('details')) each.open = true")
            if name == "en/small.html":
                page.click("#search")
                page.wait("document.querySelector('dialog[open]')")
                page.press(*"texel")
                page.wait(f"{SEARCHED}.length > 0")
            page.run(AXE.read_text(encoding="utf-8"))
            result += page.run(
                "return axe.run({ resultTypes: ['violations'] }).then(({ violations }) => violations"
                ".filter(({ impact }) => ['serious', 'critical'].includes(impact))"
                ".map(({ id, nodes }) => `${arguments[0]}: ${id}: ${nodes[0].html}`))",
                f"{name}, {theme}",
            )
    assert result == []
    page.log()  # axe asks for style sheets that the policy refuses


@pytest.fixture
def bare_book(tmp_path, engine, monkeypatch):
    """Give every page of the course, without its pictures and its numbers, which take minutes."""
    monkeypatch.setattr(build.Album, "draw", lambda *_: None)
    monkeypatch.setattr(build, "is_blank", lambda path: False)
    monkeypatch.setattr(
        traces,
        "numbers_of",
        lambda _, lesson: {measure.name: Number(0.25, "0.25") for measure in lesson.measures},
    )
    monkeypatch.setattr(
        build, "live_book", lambda lessons, _: LiveBook({lesson.name: frozenset() for lesson in lessons}, {})
    )
    lessons = {code: read_lessons(code) for code in ("en", "fr")}
    write_book(prepare(tmp_path / "whole", lessons), engine)
    return tmp_path / "whole"


def test_nothing_is_cut_off_on_any_page_at_any_width(bare_book, browser):
    browser.visit((bare_book / "index.html").as_uri())
    cut = []
    for path in sorted(bare_book.rglob("*.html")):
        browser.open(path.as_uri())
        browser.run("for (const each of document.querySelectorAll('details')) each.open = true")
        for width in (1200, 900, 390):
            browser.emulate(
                "setDeviceMetricsOverride",
                width=width,
                height=900,
                deviceScaleFactor=1,
                mobile=width < 500,
            )
            wide, codes = browser.run(
                "const codes = [...document.querySelectorAll('pre')];"
                "return [document.documentElement.scrollWidth > innerWidth,"
                " codes.filter((c) => c.scrollWidth > c.clientWidth).map((c) => c.textContent)]"
            )
            if wide or codes:
                cut.append((path.parent.name, path.name, width, wide, codes))
    assert cut == []
