"""The book: what a browser gets, read as a browser would, without one."""

from __future__ import annotations

import json
import re
from html import escape, unescape
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import urldefrag

import numpy as np
import pytest
from PIL import Image

from playground.course.book import build
from playground.course.book import build as pictures
from playground.course.book.build import is_diagram, larger, prepare, write_book
from playground.course.book.html import MAX_INDENT, LessonContext, block_html, formula, line, prose
from playground.course.book.live import LiveBook
from playground.course.document import plain
from playground.course.figures import thesis_figures
from playground.course.glossary import terms
from playground.course.library import labels
from playground.course.model import Break, Exercise, Question
from playground.course.notebook.build import notebook_text
from playground.course.scenes import draw, pictures_of
from playground.course.traces import Results, results_of
from playground.errors import DataError

VOID = {"col", "img", "input", "br", "meta", "link", "hr", "source"}


class Page(HTMLParser):
    """What is on a page: elements with their attributes, ids, addresses; open elements must be closed."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.path = path
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.text = ""
        self.feed(path.read_text(encoding="utf-8"))
        assert not self.open, (path, self.open)

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, (self.path, tag)

    def handle_data(self, data):
        self.text += data

    def all(self, name):
        return [attributes for tag, attributes in self.elements if tag == name]

    @property
    def ids(self):
        return [attributes["id"] for _, attributes in self.elements if "id" in attributes]

    @property
    def addresses(self):
        keys = ("href", "src")
        return [value for _, attributes in self.elements for key in keys if (value := attributes.get(key))]


@pytest.fixture
def book(tmp_path, lesson, french, engine):
    folder = tmp_path / "book"
    write_book(prepare(folder, {"en": [lesson], "fr": [french]}, gallery=False), engine)
    return folder


def pages(folder):
    return [Page(path) for path in sorted(folder.rglob("*.html"))]


def test_its_files(book):
    names = sorted(
        p.relative_to(book).as_posix() for p in book.rglob("*") if p.is_file() and p.suffix != ".webp"
    )
    assert names == [
        *("book.css", "book.js", "book.json", "data/small.js", "en/glossary.html", "en/index.html"),
        *("en/small.html", "en/words.js", "find.js", "fonts/literata.txt", "fonts/math.woff2"),
        *("fonts/stix-two-math.txt", "fonts/text-italic.woff2", "fonts/text.woff2", "fr/glossary.html"),
        *("fr/index.html", "fr/small.html", "fr/words.js", "glsl.js", "index.html", "live.css", "live.js"),
    ]


def test_book_pages_need_no_network_and_links_resolve(book):
    result = pages(book)
    ids = {page.path: set(page.ids) for page in result}
    outside = []
    for page in result:
        for address in page.addresses:
            if address.startswith("https://"):
                outside.append(address)
                continue
            path, position = urldefrag(address)
            target = (page.path.parent / path).resolve() if path else page.path
            assert target.is_file(), (page.path, address)
            assert not position or position in ids[target], (page.path, address)
    assert set(outside) == {"https://doi.org/10.1145/358523.358553"}  # a paper, to be followed by hand
    for name in ("book.css", "book.js", "find.js"):
        assert "http" not in (book / name).read_text(encoding="utf-8")


def test_a_link_to_a_lesson_that_is_not_in_the_book_is_text(tmp_path, make_lesson, engine):
    linked = make_lesson(
        ("see [the last](lesson:small)", "see [the last](lesson:small), [that](lesson:fourier)")
    )
    write_book(prepare(tmp_path / "book", {"en": [linked]}, gallery=False), engine)
    page = Page(tmp_path / "book/en/small.html")
    assert "see the last, that" in page.text
    assert "small.html" in page.addresses and "fourier.html" not in page.addresses
    assert "[the last](small.ipynb), that" in notebook_text(linked, results_of(engine, linked), ["small"])


def test_the_cover_leads_into_each_language(book):
    page = Page(book / "index.html")
    (picture,) = page.all("img")
    assert (book / picture["src"]).is_file()
    links = page.all("a")
    assert [link["href"] for link in links] == ["en/index.html", "fr/index.html"]
    for language in ("en", "fr"):
        label = labels("book", language)
        assert all(label[key] in page.text for key in ("book", "book_goal", "enter"))


def test_a_lesson_s_times_are_a_phrase(book, lesson):
    times = lesson.minutes, lesson.exercise_minutes
    for name in ("index", "small"):
        for language, phrase in (
            ("en", "reading {} min, exercises {} min"),
            ("fr", "lecture {} min, exercices {} min"),
        ):
            assert phrase.format(*times) in Page(book / language / f"{name}.html").text


def test_a_term_shows_its_meaning_and_leads_to_the_glossary(book):
    texel = terms()["texel"]
    for language, title in (("en", "A small lesson"), ("fr", "Une petite leçon")):
        (link,) = [a for a in Page(book / language / "small.html").all("a") if a.get("class") == "term"]
        assert link["href"] == "glossary.html#texel" and link["data-means"] == texel.definition(language)
        page = Page(book / language / "glossary.html")
        assert set(page.ids) >= set(terms())
        entry = page.text[page.text.index(texel.meaning[language]) :]
        assert title in entry[: entry.index(".", len(texel.meaning[language]) + 1)]


def test_pages_can_be_read_by_those_who_do_not_see(book):
    for page in pages(book):
        assert page.all("html")[0]["lang"] in ("en", "fr")
        assert len(page.all("h1")) == 1 and len(page.all("main")) == 1 and page.all("title")
        assert len(page.ids) == len(set(page.ids)), page.path
        assert all("alt" in image for image in page.all("img")), page.path
        for _, attributes in page.elements:
            for key in ("aria-labelledby", "aria-describedby"):
                assert key not in attributes or attributes[key] in page.ids


def test_each_language_has_its_words_and_the_same_pictures(book):
    english, french = Page(book / "en/small.html"), Page(book / "fr/small.html")
    assert [i["src"] for i in english.all("img")] == [i["src"] for i in french.all("img")]
    assert "Why is it dark?" in english.text and "Pourquoi est-ce sombre" in french.text
    assert "A lattice of discs." in [i["alt"] for i in english.all("img")]
    for page in (english, french):
        assert "{{" not in page.text and "$" not in page.text
    number = json.dumps(english.text.split("From lowest to highest: ")[1].split(".\n")[0][:4])
    assert number.strip('"').replace(".", ",") in french.text


def test_its_pictures_are_the_engine_s(book, lesson, engine):
    for picture in pictures_of(lesson):
        path = book / "pictures" / f"small-{picture.name}.webp"
        if not path.exists():  # another block shows the same
            continue
        with Image.open(path) as image:
            stored = np.asarray(image.convert("RGB")).astype(float)
        drawn = draw(engine, larger(picture.scene)).array[..., :3]
        assert stored.shape == drawn.shape
        # Diagrams are stored as they are, terrains nearly so.
        assert np.abs(stored - drawn).mean() < (0.01 if is_diagram(drawn) else 4.0), picture.name


def test_every_stored_picture_counts_and_failure_is_reported(tmp_path, lesson, engine, monkeypatch):
    """Pictures are stored aside, while the next are drawn."""
    made = prepare(tmp_path / "book", {"en": [lesson]}, gallery=False)
    steps: list[int] = []
    made.album.draw(engine, made.names[:3], lambda: steps.append(len(steps)))
    assert len(steps) == 3 and all((made.album.folder / name).is_file() for name in made.names[:3])

    def full(path, picture):
        raise OSError("no space left")

    monkeypatch.setattr(pictures, "store", full)
    with pytest.raises(OSError, match="no space left"):
        made.album.draw(engine, made.names[:1], lambda: steps.append(len(steps)))
    assert len(steps) == 3


def test_a_picture_shown_twice_is_stored_once(book, lesson):
    """The whole picture of the fault is that of the second exercise."""
    names = {path.stem for path in (book / "pictures").glob("*.webp")}
    assert "small-fault" in names and "small-second" not in names


def test_answers_are_folded_and_readable_without_script(book):
    page = Page(book / "en/small.html")
    text = (book / "en/small.html").read_text(encoding="utf-8")
    assert (
        len(page.all("details")) == 9
    )  # contents; hint and fix of the bug, two answers, three solutions, a hint
    assert not any("open" in attributes for attributes in page.all("details"))
    assert text.count("<li") >= 6 + 3 + 2  # iterations, values, variants
    assert "total / count" in page.text and "total / 8.0" in page.text


@pytest.mark.parametrize("answers", ["end", "none"])
def test_answers_are_at_the_end_or_nowhere(answers, tmp_path, lesson, engine):
    folder = tmp_path / "book"
    write_book(prepare(folder, {"en": [lesson]}, gallery=False, answers=answers), engine)
    text = (folder / "en" / "small.html").read_text("utf-8")
    tasks = [block for block in lesson.blocks if isinstance(block, Break | Question | Exercise)]
    keys = {Break: "fix", Question: "answer", Exercise: "solution"}
    texts = [getattr(block, keys[type(block)]) for block in tasks]
    assert len(texts) > 2
    first, _, end = text.partition('class="answers"')
    assert [escape(each) in first for each in texts] == [False] * len(texts)
    assert [escape(each) in end for each in texts] == [answers == "end"] * len(texts)
    links = re.findall(r'href="#(answer-[^"]+)"', first)
    assert len(links) == (len(texts) if answers == "end" else 0)
    assert all(f'id="{link}"' in end for link in links)
    assert first.count("<summary>") and "Hint" in first


def test_figure_unsupported_in_page_tells_where_sliders_are(tmp_path, lesson, french, engine, monkeypatch):
    monkeypatch.setattr(build, "live_book", lambda *_: LiveBook({"small": frozenset()}, {}))
    book = tmp_path / "book"
    write_book(prepare(book, {"en": [lesson], "fr": [french]}, gallery=False), engine)
    for language, option in (("en", ""), ("fr", " --lang fr")):
        page = Page(book / language / "small.html")
        words = labels("book", language)
        said = f"{words['in_window']}{words['colon']}playground lesson open small{option}"
        assert page.text.count(said) == 1  # of its figures one has sliders
    assert not (book / "live.js").exists()


def test_a_page_has_few_landmarks(book):
    """Questions, exercises and code are many on a page: one finds them by their headings."""
    page = Page(book / "en/small.html")
    assert not [a for tag, a in page.elements if a.get("role") == "region"]
    named = [a["aria-labelledby"] for tag, a in page.elements if tag == "section" and "aria-labelledby" in a]
    headings = {a["id"] for tag, a in page.elements if tag == "h2" and "id" in a}
    assert set(named) <= headings and len(named) >= 3


@pytest.mark.slow
def test_a_second_build_removes_what_is_no_more_and_nothing_else(book, lesson, engine, make_lesson):
    own = book / "my-notes.txt"
    own.write_text("mine", encoding="utf-8")
    fewer = make_lesson(("frames    = 3", "frames = 2"))
    write_book(prepare(book, {"en": [fewer]}, gallery=False), engine)
    names = {p.relative_to(book).as_posix() for p in book.rglob("*") if p.is_file()}
    assert own.read_text(encoding="utf-8") == "mine"
    assert "fr/small.html" not in names and "pictures/small-smooth-2.webp" not in names
    assert "en/small.html" in names and "pictures/small-smooth-1.webp" in names


def test_a_build_that_was_stopped_begins_again(tmp_path, lesson, engine):
    class Stop(Exception):
        pass

    def stop():
        raise Stop

    folder = tmp_path / "stopped"
    with pytest.raises(Stop):
        write_book(prepare(folder, {"en": [lesson]}, gallery=False), engine, stop)
    write_book(prepare(folder, {"en": [lesson]}, gallery=False), engine)
    assert (folder / "en/small.html").is_file()


@pytest.mark.slow
def test_a_manifest_that_names_files_outside_removes_none(book, lesson, engine, tmp_path):
    victim = tmp_path / "victim.txt"
    victim.write_text("keep", encoding="utf-8")
    manifest = book / build.MANIFEST
    manifest.write_text(json.dumps({"files": ["../victim.txt", str(victim)]}), encoding="utf-8")
    write_book(prepare(book, {"en": [lesson]}, gallery=False), engine)
    assert victim.read_text(encoding="utf-8") == "keep"


def test_a_folder_of_other_things_is_refused(tmp_path, lesson):
    (tmp_path / "thesis.doc").write_text("dear", encoding="utf-8")
    with pytest.raises(DataError, match="no book"):
        prepare(tmp_path, {"en": [lesson]}, gallery=False)


# ── words ────────────────────────────────────────────────────────────────────


def test_formulas_become_mathml():
    html = prose("Let $a^2$ be\n\n$$\\frac{a}{b}$$\n", str)
    assert html.count("<math") == 2 and "<msup>" in html and "<mfrac>" in html and "$" not in html
    assert 'display="block"' in formula("x", alone=True)


def test_code_lines_wrap_under_indent_and_copy_verbatim():
    source = "float f() {\n    // all\n\n        return 1.0;  /* a\n  b */\n}"
    for words in (f"```glsl\n{source}\n```\n", f"```\n{source}\n```\n"):
        html = prose(words, str)
        lines = re.findall(r'<span class="l([^"]*)">', html)
        assert lines == ["", " i4", "", " i8", " i2", ""]
        assert unescape(re.sub(r"<[^>]+>", "", html)).strip("\n") == source
    css = (Path(build.__file__).parent / "book.css").read_text(encoding="utf-8")
    assert all(f".i{n} {{ --i: {n}; }}" in css for n in range(1, MAX_INDENT + 1))


def test_a_picture_that_is_as_good_as_black_is_known(tmp_path):
    dark = np.zeros((90, 160, 3), np.uint8)
    dark[::16, ::16] = 90  # a few faint texels
    lit = dark.copy()
    lit[:, 60:100] = 200
    for name, picture, blank in (("dark", dark, True), ("lit", lit, False), ("white", 255 - dark, False)):
        pictures.store(tmp_path / f"{name}.webp", picture)
        assert pictures.is_blank(tmp_path / f"{name}.webp") is blank, name


def test_series_opens_on_first_non_blank_picture(lesson, french):
    def opens(blank):
        setting = LessonContext(
            lesson, labels("book", "en"), Results(), lambda p: p.name, lambda link: {}, (), blank
        )
        return re.search(r'data-opens="(\d+)"', block_html(lesson.named["turns"], setting))[1]

    assert opens(lambda picture: False) == "0"
    assert opens(lambda picture: picture.name in ("turns-0", "turns-1")) == "2"
    assert opens(lambda picture: True) == str(len(lesson.named["turns"].scenes) - 1)


def test_the_search_knows_every_section_and_gives_no_answer_away(book):
    for language, words, hidden in (
        (
            "en",
            ["One thing", "Each disc is a texel", "Smoother, rougher.", "How many points has it?"],
            "Five times",
        ),
        ("fr", ["Une chose", "Chaque disque est un texel", "Plus lisse, plus rude."], "Cinq fois"),
    ):
        text = (book / language / "words.js").read_text(encoding="utf-8")
        entries = json.loads(text.removeprefix("globalThis.bookWords=").removesuffix(";\n"))
        assert all(any(word in part for entry in entries for part in entry) for word in words)
        assert hidden not in text and "{{" not in text
        ids = {page: set(Page(book / language / page).ids) for page in ("small.html", "glossary.html")}
        for address, *_ in entries:
            page, position = urldefrag(address)
            assert not position or position in ids[page], address
        assert {"glossary.html#texel"} <= {address for address, *_ in entries}


def test_html_in_a_lesson_is_text():
    assert "<script>" not in prose("<script>alert(1)</script>\n", str)
    assert "&lt;b&gt;" in line("a <b>b</b>", str)


def test_plain_words():
    assert plain("a *b* `c` $d^2$ [e](lesson:f)") == "a b c d^2 e"
    assert plain("a line\nand another\n\nand more") == "a line and another and more"


def test_every_word_is_used():
    """A word by a name that is made up would be missed: there are none."""
    package = Path(build.__file__).resolve().parent.parent
    code = "".join(path.read_text(encoding="utf-8") for path in package.rglob("*.py"))
    assert [key for key in labels("book", "en") if f'"{key}"' not in code and f"'{key}'" not in code] == []


# ── the thesis's figures ─────────────────────────────────────────────────────


@pytest.fixture(scope="module")
def figures():
    return thesis_figures()


@pytest.mark.slow
def test_every_figure_of_the_thesis_has_its_pictures(figures):
    numbers = [figure.number for figure in figures]
    chapters = {"1": 36, "2": 9, "3": 11, "4": 8, "5": 15}
    assert numbers == [f"{c}.{n}" for c, most in chapters.items() for n in range(1, most + 1)]
    for figure in figures:
        assert bool(figure.pictures) != figure.diagram, figure.number
        assert figure.captions.keys() == {"en", "fr"}


@pytest.mark.slow
def test_a_figure_says_its_parameters_and_its_command(figures):
    figure = next(figure for figure in figures if figure.number == "1.16")
    (drawn,) = figure.pictures
    assert drawn.command == "playground render diamond_square --shot figure-1-16"
    parameters = dict(drawn.parameters)
    assert parameters["height.smoothing"] == "0.9" and parameters["size"] == "513 × 513"
    assert parameters["height.corners"] == "0.22,0.55,0.9,0.4"
