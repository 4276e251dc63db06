"""The report: all is in one file, every picture is the one that was drawn, no name becomes markup."""

from __future__ import annotations

import base64
import hashlib
import io
import re
import shlex
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from playground.data.image_files import read_png
from playground.errors import DataError
from playground.markup import Markup, tag
from playground.verify.shots.page.document import CAPTIONS
from playground.verify.shots.report import report_html, write_report
from playground.verify.shots.results import Actual, Record, flat, read_results, record_of
from playground.verify.shots.verdicts import VERDICTS

from .pictures import BEFORE, TEXTS, picture

VOID = {"meta", "link", "img", "input", "br"}


class Page(HTMLParser):
    """The elements of a page, each (name, attributes, text inside); fails where one is not closed."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None], list[str]]] = []
        self._open: list[int] = []
        self.feed(html)
        self.close()
        assert not self._open, [self.elements[i][0] for i in self._open]

    def handle_starttag(self, name: str, attributes: list[tuple[str, str | None]]) -> None:
        assert len(dict(attributes)) == len(attributes), f"<{name}> has an attribute twice"
        self.elements.append((name, dict(attributes), []))
        if name not in VOID:
            self._open.append(len(self.elements) - 1)

    def handle_endtag(self, name: str) -> None:
        assert self.elements[self._open.pop()][0] == name

    def handle_data(self, text: str) -> None:
        for index in self._open:
            self.elements[index][2].append(text)

    def all(self, name: str, **expected: str) -> list[tuple[dict[str, str | None], str]]:
        return [
            (attributes, "".join(text))
            for result, attributes, text in self.elements
            if result == name
            and all(attributes.get(k.rstrip("_").replace("_", "-")) == v for k, v in expected.items())
        ]

    def text(self, name: str, **expected: str) -> str:
        return self.all(name, **expected)[0][1]


def made() -> Page:
    return Page(write_report(Path("results")).read_text(encoding="utf-8"))


def test_every_picture_is_inside_and_shows_what_was_drawn(leave) -> None:
    now, before = picture(1), picture(2)
    record = leave(actual=now, expected=before)
    page = made()
    difference = read_png(Path("results") / record.actual.pictures["difference"])[0]
    shown = {}
    for kind, pixels in {"actual": now, "expected": before, "difference": difference}.items():
        index = next(
            i for i, (n, a, _) in enumerate(page.elements) if n == "figure" and a["data-kind"] == kind
        )
        image = next(a for n, a, _ in page.elements[index:] if n == "img")
        start, data = image["src"].split(",")
        assert start == "data:image/png;base64"
        with PIL.Image.open(io.BytesIO(base64.b64decode(data, validate=True))) as read:
            shown[kind] = np.asarray(read)
        np.testing.assert_array_equal(shown[kind], pixels)
        assert (image["width"], image["height"]) == ("12", "8")
        assert image["alt"].startswith("hills/dawn: ")
    assert len(page.all("img")) == 3  # there is no FLIP map here, and nothing replaces it


def test_report_needs_no_network_and_runs_its_own_script_alone(leave) -> None:
    leave(actual=picture(1), expected=picture(2))
    page = made()
    policy = next(a["content"] for a, _ in page.all("meta", http_equiv="Content-Security-Policy"))
    for name in ("script", "style"):
        (attributes, text), *others = page.all(name)
        assert not others and not attributes, "one, inside"
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"{name}-src 'sha256-{digest}'" in policy
    assert "default-src 'none'" in policy and "img-src data:;" in policy and "connect" not in policy
    for _, attributes, _ in page.elements:
        assert not [name for name in attributes if name.startswith("on") or name == "style"]
        for name in ("src", "href"):
            assert (attributes.get(name) or "data:").startswith(("data:", "#")), attributes


EVIL = '<script>alert("1")</script>&amp;\'"><img src=x onerror=alert(2)>'


def test_no_text_of_a_record_becomes_markup(leave) -> None:
    """Names, messages, what a driver printed: the page shows them letter for letter."""
    record = leave(
        "a/b", picture(1), None, message=EVIL, tier=EVIL, catches=EVIL, error=EVIL, node=EVIL, command=EVIL
    )
    texts = {"renderer": EVIL, f"{EVIL}": EVIL}
    failing = replace(
        record,
        sketch=EVIL,
        shot="<b>",
        numbers={EVIL: 1.0},
        fingerprint=(EVIL,),
        renderer=EVIL,
        actual=replace(record.actual, texts=texts),
        expected=replace(record.expected, texts=texts),
    )
    for records in (
        [failing],
        [replace(failing, word=EVIL)],
        [failing, replace(failing, word="same", shot="p")],
    ):
        page = Page(report_html(records, Path("results")))
        assert len(page.all("script")) == 1 and not page.all("b")
        assert len(page.all("img")) == 1 and page.all("img")[0][0]["src"].startswith("data:image/png")
        assert EVIL in page.text("p", class_="verdict")
        assert page.text("pre") == EVIL
        assert page.text("h2").endswith("<b>")
        assert EVIL in [text for _, text in page.all("code")]


def test_text_is_escaped_unless_it_is_markup() -> None:
    assert tag("p", "a < b", tag("b", "&"), None) == "<p>a &lt; b<b>&amp;</b></p>"
    assert (
        tag("a", href='"><x>', class_="y", hidden=True, id=None)
        == '<a href="&quot;&gt;&lt;x&gt;" class="y" hidden></a>'
    )
    assert isinstance(tag("img", alt="<"), Markup) and tag("img", alt="<") == '<img alt="&lt;">'


def test_links_lead_to_the_shot_of_any_name(leave) -> None:
    record = leave(actual=picture(1))
    names = [("a b", "c"), ("<i>", "ü-1"), ("50%", "x"), ("d#1", "y")]
    records = [replace(record, sketch=sketch, shot=shot) for sketch, shot in names]
    page = Page(report_html(records, Path("results")))
    ids = [a["id"] for a, _ in page.all("article")]
    targets = [a["href"] for a, _ in page.all("a") if a["href"] != "#main"]
    assert sorted(targets) == sorted(f"#{i}" for i in ids)
    assert all(re.fullmatch(r"[!-~]+", i) for i in ids), "an id has no spaces"
    every = [a["id"] for _, a, _ in page.elements if "id" in a]
    assert len(every) == len(set(every))
    for attributes, _ in page.all("article"):
        assert attributes["aria-labelledby"] in every


def test_the_head_counts_words_and_says_what_drew_them(leave) -> None:
    leave("a/x", picture(1), picture(2))
    leave("a/y", picture(3), picture(3), when=5.0, run="2")
    leave("a/z", picture(4), picture(4), when=4.0, run="1", seconds=0.5)
    leave("b/x", word="crash", message="died", error="Segmentation fault\n")
    page = made()
    assert page.text("h1") == page.text("title") == "2 of 4 shots failed"
    counts = page.text("ul", class_="counts")
    assert all(word in counts for word in ("differs 1", "crash 1", "passed 2"))
    head = page.text("header", class_="top")
    assert "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 Mesa 22.3.6" in head
    assert "1970-01-01 00:00:05 UTC" in head
    assert "took 0.5 s" in head
    assert "3 shots of them in an earlier run" in head
    assert page.text("pre") == "Segmentation fault"


def test_without_a_failure_it_says_so_and_holds_no_picture(leave) -> None:
    leave("a/x", picture(1), picture(1))
    leave("a/y", picture(2), picture(2))
    page = made()
    assert page.text("h1") == "All 2 shots passed"
    assert not page.all("article") and not page.all("img") and not page.all("nav")
    assert [text for _, text in page.all("th", scope="row") if text.startswith("a/")] == ["a/x", "a/y"]
    assert "open" in page.all("details")[0][0]


def test_every_word_has_its_own_explanation(leave) -> None:
    leave(actual=picture(1), expected=picture(2))
    (record,) = read_results(Path("results"))
    messages = set()
    for word, verdict in VERDICTS.items():
        if verdict.passes:
            continue
        page = Page(report_html([record_of(flat(record) | {"word": word, "tier": ""})], Path("results")))
        assert page.text("p", class_="meaning") == verdict.meaning
        messages.add(verdict.meaning)
        commands = [text for _, text in page.all("code")]
        assert bool(commands) is verdict.acceptable
    assert len(messages) == len(VERDICTS) - 1
    page = Page(
        report_html(
            [record_of(flat(record) | {"tier": "same build", "catches": "Any change."})], Path("results")
        )
    )
    assert page.text("p", class_="meaning").endswith(" Any change.")
    assert page.text("span", class_="tier") == "same build"


def test_the_command_accepts_this_shot_from_this_folder(leave) -> None:
    leave("my hills/dawn", picture(1), picture(2), command="pytest --shots-update 'x'")
    commands = [shlex.split(text) for _, text in made().all("code")]
    accept = ["playground", "shots", "accept", "results", "my hills/dawn"]
    assert commands == [accept, [*accept, "--also"], ["pytest", "--shots-update", "x"]]


def test_differences_of_fingerprints_are_listed_and_marked(leave) -> None:
    leave(actual=picture(1), expected=picture(2))
    page = made()
    assert "22.3.6; the reference's: 22.3.5" in page.text("ul", class_="differences")
    table = page.text("table", class_="fingerprints")
    assert "OpenGL version differs4.5 Mesa 22.3.54.5 Mesa 22.3.6" in table
    assert "Rendererllvmpipe" in table, "what is equal is not marked"
    assert BEFORE["version"] != TEXTS["version"]


def test_passed_shots_have_no_picture_and_excess_become_links(leave, tmp_path: Path) -> None:
    for number in range(4):
        leave(f"a/shot-{number}", picture(number), picture(number + 10))
    records = read_results(Path("results"))
    item = sum((Path("results") / name).stat().st_size for name in records[0].actual.pictures.values())
    html = report_html(records, Path("results"), Path("../results"), most=int(item * 1.4 * 2.5))
    page = Page(html)
    assert len(page.all("img")) == 6
    links = [a["href"] for a, _ in page.all("a") if not a["href"].startswith("#")]
    assert links[0] == "../results/a/shot-2.expected.png" and len(links) == 6
    assert "2 failures are not in this file" in page.text("p", class_="note")


def test_three_hundred_records_stay_small(leave) -> None:
    leave("a/x", picture(1), picture(1))
    (record,) = read_results(Path("results"))
    many = [replace(record, shot=f"shot-{number}") for number in range(300)]
    assert len(report_html(many, Path("results"))) < 300 * 400 + 100_000


def test_a_picture_that_has_gone_is_reported(leave) -> None:
    record = leave(actual=picture(1), expected=picture(2))
    (Path("results") / record.actual.pictures["expected"]).unlink()
    page = made()
    assert "1 picture could not be read: hills/dawn.expected.png" in page.text("p", class_="note")
    assert len(page.all("img")) == 2


def test_the_report_goes_where_it_should_and_says_where(leave, tmp_path: Path) -> None:
    leave(actual=picture(1))
    assert write_report(Path("results")) == Path("results/index.html")
    assert write_report(Path("results"), tmp_path / "r.html") == tmp_path / "r.html"
    with pytest.raises(DataError, match="there is no folder"):
        write_report(Path("results"), tmp_path / "nowhere" / "r.html")
    with pytest.raises(DataError, match="there is no such folder"):
        write_report(Path("nowhere"))


def test_every_kind_of_picture_has_its_caption(leave) -> None:
    html = report_html(
        [
            Record(
                sketch="a",
                shot="b",
                word="differs",
                message="x",
                actual=Actual(pictures={k: f"a/b.{k}.png" for k in CAPTIONS}),
            )
        ],
        Path("results"),
    )
    assert [text for _, text in Page(html).all("figcaption")] == list(CAPTIONS.values())
