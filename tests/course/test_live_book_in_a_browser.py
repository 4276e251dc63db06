"""The book's live figures in a real browser, opened from the disk, without a network."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import ClassVar

import numpy as np
import pytest
from PIL import Image

from playground.course.book.build import prepare, write_book
from playground.course.library import labels
from playground.course.scenes import broken, bug_region, draw, with_value
from playground.course.tasks import EXERCISES
from playground.engine.engine import Engine

from ..browser import MISSING, Browser
from ..publish.web.pages import VIEW
from .conftest import BODY, FRENCH, FRONT, both_languages

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(MISSING), reason=MISSING)]

LLVMPIPE = ("--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist")
RIGHT, END = "\ue014", "\ue010"
PAGE = "en/small.html"
AWHILE = "new Promise((done) => setTimeout(() => requestAnimationFrame(done), 600))"
TRY = (
    'solution = "So."\nsketch   = "diamond_square_steps"',
    'solution = "So."\nset = { "height.smoothing" = 0.7 }\nsketch = "diamond_square_steps"',
)
SET = (
    'ask      = "Predict."\nsolution = "So."',
    'ask      = "Predict."\nsolution = "So."\nsketch = "diamond_square_steps"\n'
    'pixels = [96, 96]\nalt = "It."\n'
    'sliders = ["height.smoothing"]\nset = { "height.smoothing" = 0.7 }\npoints = 2\n'
    '[[check]]\n[[check]]\nof = "height"\ntolerance = 0.01\nat = { "height.seed" = 5 }\nhidden = true',
)
WRITE = (
    'ask      = "Change."\nsolution = "So."',
    'ask      = "Change."\nsolution = "So."\nsketch = "diamond_square_steps"\n'
    'pixels = [96, 96]\nalt = "It."\n'
    'file = "generation/diamond_square/raw.glsl"\nanswer = "diamond_square/dimension.answer.glsl"\n'
    '[[check]]\nof = "height"\ntolerance = 0.001\nat = { "height.seed" = 4 }',
)
MATCH = """
```challenge match
ask     = "Match it."
alt     = "Discs."
sketch  = "diamond_square_steps"
pixels  = [96, 96]
sliders = ["height.smoothing"]
set     = { "height.smoothing" = 0.9 }
begin   = { "height.smoothing" = 0.1 }
goal    = 90
```
"""
MATCH_FRENCH = '\n```challenge match\nask = "Retrouvez-la."\nalt = "Des disques."\n```\n'
ALT = 'ask      = "{}"\nsolution = "Ainsi."'


@pytest.fixture(scope="module")
def lessons(tmp_path_factory):
    """Give the small lesson in two languages, with an exercise that has something to set."""
    folder = tmp_path_factory.mktemp("lessons")
    english, french = folder / "small.md", folder / "petit.md"
    body, words = BODY, FRENCH
    for change in (TRY, SET, WRITE):
        assert change[0] in body
        body = body.replace(*change)
    for ask in ("Prédisez.", "Changez."):
        words = words.replace(ALT.format(ask), f'{ALT.format(ask)}\nalt = "Là."')
    english.write_text(FRONT + body + MATCH, encoding="utf-8")
    french.write_text(words + MATCH_FRENCH, encoding="utf-8")
    return both_languages(english, french)


@pytest.fixture
def lesson(lessons):
    return lessons["en"][0]


@pytest.fixture(scope="module")
def book(tmp_path_factory, lessons, shared_context):
    folder = tmp_path_factory.mktemp("live") / "book"
    with Engine(shared_context) as engine:
        write_book(prepare(folder, lessons, gallery=False), engine)
    return folder


@pytest.fixture(scope="module")
def browser(tmp_path_factory) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("profile"), flags=LLVMPIPE) as browser:
        yield browser


@pytest.fixture
def page(book, browser) -> Iterator[Browser]:
    browser.visit((book / PAGE).as_uri())
    browser.wait("document.querySelectorAll('.start').length === 9")
    yield browser
    assert browser.log() == []


def start(page, name):
    page.click(f"#{name} .start")
    page.wait(f"document.querySelector('#{name} .live canvas:not([hidden])')")


def picture(page, name, number=0):
    """Return the pixels of a live picture at rest: as many as its place has, and no other is to come.

    A figure says by ``aria-busy`` that something was asked for since it was drawn; so does a text.
    """
    canvas = f"document.querySelectorAll('#{name} .live canvas')[{number}]"
    page.run(f"{canvas}.scrollIntoView({{ block: 'center' }})")
    # Two frames: the first may find that the place has another size, or is in sight.
    page.run("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    page.wait(
        f"{canvas}.closest('.stage').getAttribute('aria-busy') === 'false'"
        f" && !document.querySelector('#{name} .live .editor[aria-busy=true]')"
        f" && {canvas}.width === {canvas}.clientWidth"
    )
    now = page.run(f"return {canvas}.toDataURL()")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(now.partition(",")[2]))).convert("RGB"))


def drawn(engine, scene, pixels):
    """Return what the engine draws in the size of a live picture."""
    height, width = pixels.shape[:2]
    made = engine.render(scene.sketch, size=(width, height), time=scene.time, steps=dict(scene.steps))
    return made.array[..., :3]


class Recorder(SimpleHTTPRequestHandler):
    """Serves a folder, and notes what is asked for."""

    asked: ClassVar[list[str]] = []

    def do_GET(self):
        self.asked.append(self.path)
        super().do_GET()

    def log_message(self, *_):
        pass


@contextmanager
def served(folder: Path, page: str, profile: Path, flags: tuple[str, ...] = LLVMPIPE) -> Iterator[Browser]:
    """Open a page of a folder from a server that notes every request: a disk keeps no list."""
    Recorder.asked.clear()
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Recorder, directory=str(folder)))
    Thread(target=server.serve_forever, daemon=True).start()
    with server, Browser(profile, flags=flags) as browser:
        browser.open(f"http://127.0.0.1:{server.server_address[1]}/{page}")
        yield browser
        server.shutdown()


def test_book_runs_nothing_until_asked_and_loads_its_own_files(book, tmp_path):
    with served(book, PAGE, tmp_path / "profile") as browser:
        browser.wait("document.querySelectorAll('.start').length === 9")
        scripts = [path for path in Recorder.asked if path.endswith(".js")]
        assert scripts == ["/book.js"]
        running = browser.run("return [typeof playground, document.querySelectorAll('canvas').length]")
        assert running == ["undefined", 0]
        for name in ("land", "two", "fault"):
            start(browser, name)
        scripts = sorted(path for path in Recorder.asked if path.endswith(".js"))
        assert scripts == ["/book.js", "/data/small.js", "/glsl.js", "/live.js"]  # each once
        assert [line for line in browser.log() if "favicon.ico" not in line] == []
        for path in Recorder.asked:
            assert (book / path.lstrip("/")).is_file() or path == "/favicon.ico", path


def test_a_live_picture_is_the_engine_s_and_follows_its_slider(page, lesson, engine):
    scene = lesson.named["land"].scene
    start(page, "land")
    first = picture(page, "land")
    np.testing.assert_array_equal(first, drawn(engine, scene, first))
    page.run("document.querySelector('#land .live input[type=range]').focus()")
    page.press(*[RIGHT] * 5)
    value = float(page.run("return document.querySelector('#land .live input[type=range]').value"))
    moved = picture(page, "land")
    assert value > 0.5 and (moved != first).any()
    changed = with_value(scene, "height.smoothing", value)  # it goes from 0 to 1
    np.testing.assert_array_equal(moved, drawn(engine, changed, moved))
    page.click("#land .reset-all")
    np.testing.assert_array_equal(picture(page, "land"), first)
    # Out of sight nothing is drawn, and the figure goes on saying that a picture is to come.
    page.run("scrollTo({ top: document.body.scrollHeight, behavior: 'instant' })")
    page.run(f"return {AWHILE}")
    page.run(
        "const range = document.querySelector('#land .live input[type=range]'); range.value = arguments[0];"
        "range.dispatchEvent(new Event('input'))",
        page.run("return document.querySelector('#land .live input[type=range]').min"),
    )
    page.run(f"return {AWHILE}")
    assert page.run("return document.querySelector('#land .stage').getAttribute('aria-busy')") == "true"
    assert (picture(page, "land") != first).any()


def test_any_iteration_can_be_shown(page, lesson, engine):
    start(page, "turns")
    page.run("document.querySelector('#turns .live input').focus()")
    for scene in lesson.named["turns"].scenes[1:4]:
        page.press(RIGHT)
        shown = picture(page, "turns")
        np.testing.assert_array_equal(shown, drawn(engine, scene, shown))
    assert "3 of 5" in page.run("return document.querySelector('#turns .live output').textContent")


def test_a_swept_parameter_has_values_between_those_listed(page, lesson, engine):
    start(page, "smooth")
    block = lesson.named["smooth"]
    page.run(
        "const range = document.querySelector('#smooth .live input'); range.value = 0.5;"
        "range.dispatchEvent(new Event('input'))"
    )
    shown = picture(page, "smooth")
    between = drawn(engine, with_value(block.scenes[0], "height.smoothing", 0.3), shown)
    np.testing.assert_allclose(shown.astype(int), between, atol=2)
    page.click("#smooth .live button:nth-of-type(2)")
    assert page.run("return document.querySelector('#smooth .live output').textContent") == "0.5"
    shown = picture(page, "smooth")
    np.testing.assert_array_equal(shown, drawn(engine, block.scenes[1], shown))


def test_variants_are_swiped_and_share_a_camera(page, lesson, engine):
    start(page, "two")
    for number, scene in enumerate(lesson.named["two"].scenes):
        shown = picture(page, "two", number)
        np.testing.assert_array_equal(shown, drawn(engine, scene, shown))
    page.run("document.querySelector('#two .live input[type=range]').focus()")
    page.press(END)
    assert page.run("return document.querySelector('#two .swiped').style.getPropertyValue('--at')") == "100%"
    assert page.run("return document.querySelectorAll('#two .side-label')[1].textContent") == "uneven"


PUT = """const view = {}, to = view.state.doc.length;
view.dispatch({{changes: {{from: 0, to, insert: arguments[0]}}}})"""


def typed(page, text, name="fault"):
    page.run(PUT.format(VIEW.format(f"#{name}")), text)


def test_a_broken_shader_is_repaired(page, lesson, engine):
    block, words = lesson.named["fault"], labels("book", "en")
    region = bug_region(block)
    verdict = "document.querySelector('#fault .verdict').textContent"
    start(page, "fault")
    page.wait("document.querySelector('#fault .editor-status').textContent === ''")
    shown = picture(page, "fault")
    np.testing.assert_array_equal(shown, drawn(engine, broken(block), shown))
    assert page.run(f"return {VIEW.format('#fault')}.state.doc.toString()") == region.broken
    typed(page, region.broken.replace("8.0", "7.0"))
    page.wait(f"{verdict} === arguments[0]", words["not_yet"])
    typed(page, region.broken.replace("total /", "totl /"))
    page.wait("document.querySelector('#fault .editor-status.wrong')")
    complaint = page.run("return document.querySelector('#fault .editor-problems').textContent")
    line = 1 + region.broken[: region.broken.index("total /")].count("\n")
    assert f"Line {line}" in complaint and "totl" in complaint
    typed(page, region.broken.replace("total / 8.0", "total * (1.0 / count)"))  # not the words of the file
    page.wait(f"{verdict} === arguments[0]", words["fixed"])
    shown = picture(page, "fault")
    np.testing.assert_allclose(shown.astype(int), drawn(engine, block.scene, shown), atol=2)


def test_exercise_reports_when_picture_matches_solution(page, lesson, engine):
    start(page, "second")
    shown = picture(page, "second")
    plain = drawn(engine, lesson.named["smooth"].scenes[1], shown)  # 0.5 is the sketch's own
    np.testing.assert_array_equal(shown, plain)
    verdict = "document.querySelector('#second .verdict').className"
    set_number(page, "second", "0.6")
    page.wait(f"{verdict} === 'verdict wrong'")
    set_number(page, "second", "0.7")
    page.wait(f"{verdict} === 'verdict right'")
    shown = picture(page, "second")
    np.testing.assert_array_equal(shown, drawn(engine, lesson.named["second"].scene, shown))


def set_number(page, name, value):
    """Set the exercise's parameter in its field."""
    page.run(
        "const field = document.querySelector(arguments[0]);"
        "field.value = arguments[1]; field.dispatchEvent(new Event('change'))",
        f'#{name} [data-path="height.smoothing"] .number',
        value,
    )


def results(page, name):
    text = f"document.querySelectorAll('#{name} .results li')"
    page.wait(f"document.querySelector('#{name} .outcome .verdict')")
    return page.run(f"return [...{text}].map((each) => [each.className, each.textContent])")


def test_value_exercise_is_checked_at_hidden_values(page):
    start(page, "first")
    page.click("#first .check")
    (seen, said), (hidden, other) = results(page, "first")
    assert (seen, hidden) == ("wrong", "wrong")
    assert "of the picture differs" in said and other.startswith("At other values") and "seed" not in other
    assert page.run("return document.querySelectorAll('#first .pictures canvas').length") == 3
    set_number(page, "first", "0.7")
    page.wait("!document.querySelector('#first .outcome .verdict')")  # what was said is of another work
    page.click("#first .check")
    assert [kind for kind, _ in results(page, "first")] == ["right", "right"]
    assert "All" in page.run("return document.querySelector('#first .outcome').textContent").title()


def test_a_kernel_that_a_reader_writes_is_checked_by_its_texture(page):
    start(page, "third")
    area = VIEW.format("#third")
    page.wait("document.querySelector('#third .editor-status').textContent === ''")
    text = page.run(f"return {area}.state.doc.toString()")
    assert "share * smoothing" in text or "share" in text
    page.click("#third .check")
    ((kind, said),) = results(page, "third")
    assert kind == "wrong" and re.fullmatch(
        r"At height\.seed = 4: height differs by up to [\d.]+, where 0\.001 is allowed"
        r"(, most of it in the [a-z-]+)?(; yours is (higher|lower) in the mean)?\.",
        said,
    )
    answer = (EXERCISES / "diamond_square/dimension.answer.glsl").read_text(encoding="utf-8")
    typed(page, answer.replace("pow(share, 0.8)", "powr(share, 0.8)"), "third")
    page.click("#third .check")
    page.wait("document.querySelector('#third .editor-status.wrong')")
    page.wait("document.querySelector('#third .outcome .verdict.wrong')")
    typed(
        page, answer.replace("pow(share, 0.8)", "exp(0.8 * log(share))"), "third"
    )  # not the words of the answer
    page.wait("document.querySelector('#third .editor-status').textContent === ''")
    page.click("#third .check")
    page.wait("document.querySelector('#third .outcome .verdict.right')")
    # Other blocks of the page still have the file as it ships.
    start(page, "land")
    assert page.run("return !document.querySelector('#land .live .alarm')")


OWN = """uniform float lift = 0.25;  //! slider(0, 0.5) step(0.05) Of all heights
"""


def test_a_uniform_that_a_reader_writes_has_a_slider(page):
    start(page, "third")
    row = "document.querySelector('#third [data-path$=\".lift\"]')"
    area = VIEW.format("#third")
    plain = picture(page, "third")
    starter = page.run(f"return {area}.state.doc.toString()")
    own = starter.replace("\nfloat kernel", f"\n{OWN}\nfloat kernel").replace(
        "return corner(texel);", "return corner(texel) + lift;"
    )
    assert own.count("lift") == 2
    typed(page, own, "third")
    page.wait(row)
    assert (picture(page, "third") != plain).any()
    ends = page.run(
        f"const {{ min, max, step }} = {row}.querySelector('[type=range]'); return [min, max, step]"
    )
    assert page.run(f"return {row}.querySelector('.number').value") == "0.25", ends
    page.run(f"{row}.querySelector('.number').value = '0'")
    page.run(f"{row}.querySelector('.number').dispatchEvent(new Event('change'))")
    np.testing.assert_array_equal(picture(page, "third"), plain)
    # What is typed further on leaves what was set; what cannot be read is said at its line.
    typed(page, own.replace("Of all heights", "Of every height"), "third")
    page.wait(f"{row}.textContent.includes('Of every height')")
    assert page.run(f"return {row}.querySelector('.number').value") in ("0", "0.00")
    typed(page, own.replace("slider(0, 0.5)", "slidr(0, 0.5)"), "third")
    problems = "document.querySelector('#third .editor-problems').textContent"
    page.wait(f"{problems}.includes(\"did you mean 'slider'\")")
    assert f"Line {1 + own[: own.index('lift = 0.25')].count(chr(10))}:" in page.run(f"return {problems}")
    typed(page, starter, "third")
    page.wait(f"!{row}")
    np.testing.assert_array_equal(picture(page, "third"), plain)


def test_a_challenge_keeps_its_best_score(page, book):
    start(page, "match")
    said = "document.querySelector('#match .score').textContent"
    page.wait(f"{said}.startsWith('Score 0 of 100')")
    set_number(page, "match", "0.6")
    page.wait(f"/Score [1-8][0-9] /.test({said})")
    set_number(page, "match", "0.9")
    page.wait(f"{said}.startsWith('Solved, with a score of 100.')")
    set_number(page, "match", "0.1")
    page.wait(f"/Score 0 .*Best so far: 100/.test({said})")
    page.open((book / PAGE).as_uri())
    start(page, "match")
    page.wait(f"/Score 0 .*Best so far: 100/.test({said})")


def test_french_and_paper_and_a_phone(page, book):
    page.open((book / "fr/small.html").as_uri())
    page.emulate("setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=1, mobile=True)
    assert "Lancer" in page.run("return document.querySelector('.start').textContent")
    for name in ("turns", "fault", "land"):
        start(page, name)
    assert "Itération 0 sur 5" in page.run("return document.querySelector('#turns output').textContent") or (
        "sur 5" in page.run("return document.querySelector('#turns .live output').textContent")
    )
    assert page.run("return [innerWidth, document.documentElement.scrollWidth]") == [390, 390]
    hidden = "[...document.querySelectorAll(arguments[0])].map((each) => each.offsetHeight === 0)"
    assert all(page.run(f"return {hidden}", ".is-live > .still"))
    page.emulate("setEmulatedMedia", media="print")
    assert all(page.run(f"return {hidden}", ".live, .start"))
    assert not any(page.run(f"return {hidden}", ".still img"))
    page.emulate("setEmulatedMedia", media="")


def test_without_scripts_everything_can_be_read(page, book):
    page.emulate("setScriptExecutionDisabled", value=True)
    page.open((book / PAGE).as_uri())
    assert page.run("return document.querySelectorAll('.start, .live').length") == 0
    counts = "[...document.querySelectorAll('.still img')].filter((image) => image.offsetHeight > 40).length"
    assert page.run(f"return {counts}") == 1 + 6 + 3 + 2 + 1 + 1
    assert "total / 8.0" in page.run("return document.querySelector('#fault .still pre').innerText")


def test_a_page_runs_nothing_but_the_book_s_scripts(page):
    script = "const one = document.createElement('script'); one.textContent = 'globalThis.ran = 1';"
    assert page.run(f"{script} document.head.append(one); return globalThis.ran ?? 0") == 0
    assert any("Content Security Policy" in line for line in page.log())


def test_without_webgl_the_picture_stays_with_a_sentence(book, tmp_path):
    flags = ("--disable-gpu", "--disable-3d-apis")
    with Browser(tmp_path / "profile", flags=flags) as browser:
        browser.open((book / PAGE).as_uri())
        browser.click("#land .start")
        browser.wait("document.querySelector('#land .live-failed')")
        assert "WebGL2" in browser.run("return document.querySelector('#land .live-failed').textContent")
        assert browser.run("return document.querySelector('#land .still img').offsetHeight") > 40
        assert browser.run("return document.querySelectorAll('.live').length") == 0


def test_one_context_serves_all_figures_of_a_page(page):
    page.run(
        "globalThis.contexts = 0; const made = HTMLCanvasElement.prototype.getContext;"
        "HTMLCanvasElement.prototype.getContext = function (kind, ...more) {"
        " if (kind === 'webgl2') contexts++; return made.call(this, kind, ...more); }"
    )
    for name in ("land", "turns", "smooth", "two", "fault", "second"):
        start(page, name)
    assert page.run("return contexts") == 1


def test_what_is_drawn_is_drawn(engine, lesson):
    """The pictures that the others compare differ from each other."""
    frames = [draw(engine, scene).array for scene in lesson.named["two"].scenes]
    assert (frames[0] != frames[1]).any()


CONTEXT = (
    "const made = HTMLCanvasElement.prototype.getContext;"
    "HTMLCanvasElement.prototype.getContext = function (kind, ...more) {"
    " const found = made.call(this, kind, ...more);"
    " if (kind === 'webgl2') globalThis.losing = found.getExtension('WEBGL_lose_context'); return found; }"
)


def test_a_lost_context_is_told_and_its_pictures_come_back(page, lesson, engine):
    page.run(CONTEXT)
    for name in ("land", "fault"):
        start(page, name)
    page.wait("document.querySelector('#fault .editor-status').textContent === ''")
    typed(page, bug_region(lesson.named["fault"]).broken.replace("8.0", "7.0"))
    verdict = "document.querySelector('#fault .verdict').textContent"
    page.wait(f"{verdict} === arguments[0]", labels("book", "en")["not_yet"])
    before = [picture(page, name) for name in ("land", "fault")]
    page.run("losing.loseContext()")
    page.wait("document.querySelectorAll('.live .recovery').length === 2")
    assert "graphics device was lost" in page.run("return document.querySelector('.recovery').textContent")
    assert all(
        page.run("return [...document.querySelectorAll('.live .stage img')].map((each) => !each.hidden)")
    )
    page.run("losing.restoreContext()")
    page.wait("document.querySelectorAll('.live .recovery').length === 0")
    page.wait("document.querySelectorAll('.live canvas:not([hidden])').length === 2")
    for name, pixels in zip(("land", "fault"), before, strict=True):
        page.run("document.getElementById(arguments[0]).scrollIntoView()", name)
        np.testing.assert_array_equal(picture(page, name), pixels)
    page.log()  # Chromium notes a context that is lost


def test_line_losing_context_is_reverted_and_hanging_not_redrawn(page, lesson):
    page.run(CONTEXT)
    start(page, "fault")
    page.wait("document.querySelector('#fault .editor-status').textContent === ''")
    before = picture(page, "fault")
    broken_lines = bug_region(lesson.named["fault"]).broken
    page.run(
        "const kind = WebGL2RenderingContext.prototype; kind.ownFenceSync = kind.fenceSync;"
        "kind.fenceSync = () => { losing.loseContext(); return null; };"
    )
    typed(page, broken_lines.replace("8.0", "7.0"))
    page.wait("document.querySelector('#fault .recovery')")
    page.run(
        "const kind = WebGL2RenderingContext.prototype; kind.fenceSync = kind.ownFenceSync;"
        "losing.restoreContext()"
    )
    said = "document.querySelector('#fault .recovery')?.textContent"
    page.wait(f"{said}.includes('does not end')")
    np.testing.assert_array_equal(picture(page, "fault"), before)
    area = f"{VIEW.format('#fault')}.state.doc.toString()"
    assert "7.0" in page.run(f"return {area}")
    # A page that is closed while lines are tried: they are offered when it is opened again.
    page.run(
        "WebGL2RenderingContext.prototype.clientWaitSync = function () { return this.TIMEOUT_EXPIRED; };"
    )
    typed(page, broken_lines.replace("8.0", "6.0"))
    page.wait("Object.values(sessionStorage).some((text) => text.includes('6.0') && text.includes('tried'))")
    page.run("location.reload()")
    page.wait("document.querySelectorAll('.start').length === 9")
    start(page, "fault")
    page.wait(f"{said}?.includes('loop without end')")
    assert page.run(f"return {area}") == broken_lines
    page.click("#fault .recovery button")
    assert "6.0" in page.run(f"return {area}")
    page.log()
