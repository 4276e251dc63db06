"""Write the whole page of results: how many failed, a list of them to filter, each failure, what passed.

Its style and script are inside, and its policy lets no others run: the browser compares
their hashes. Whatever a name or an output of a driver holds, it cannot become a script.
"""

from __future__ import annotations

import base64
import hashlib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from string import Template

from playground._version import __version__
from playground.errors import counted
from playground.markup import Markup, joined, tag
from playground.memo import INTERFACE
from playground.verify.shots.page.labels import MEANINGS, meaning
from playground.verify.shots.page.shot import (
    ShotPageContext,
    can_be_accepted,
    chip,
    failure,
    moment,
    passed_row,
    row,
)
from playground.verify.shots.results import Record

_HERE = Path(__file__).resolve().parent

_BUILD = ("renderer", "version", "cpu", "simd")  # the texts that say what drew a picture

_REVIEW_KEYS = tag(
    "tr",
    tag("th", tag("kbd", "y"), Markup(" "), tag("kbd", "u"), scope="row"),
    tag("td", "accept this shot, undo that"),
)


def page(records: Sequence[Record], setting: ShotPageContext, notes: Sequence[str] = ()) -> str:
    """Return the page as HTML; ``notes`` are sentences for its head, as on pictures left out."""
    failed = [record for record in records if not record.ok]
    passed = [record for record in records if record.ok]
    style, script = _style(), _script(setting)
    headline = _headline(failed, records)
    return Template(_read("report.html")).substitute(
        policy=policy_of(setting),
        tool=f"terrain-shader-playground {__version__}",
        title=joined(f"{'Review: ' if setting.review else ''}{headline}"),
        style=style,
        script=script,
        mode="review" if setting.review else "report",
        headline=tag("h1", headline, class_="failed" if failed else "passed"),
        facts=_facts(records, notes),
        tools=_tools(failed) if setting.review else "",
        list=_list(failed) if failed else "",
        failures=joined(*(failure(record, setting) for record in failed)),
        passed=_passed(passed, opened=not failed) if passed else "",
        keys=_REVIEW_KEYS if setting.review else "",
        dialogs=_read("review.html") if setting.review else "",
    )


def policy_of(setting: ShotPageContext) -> str:
    """Return the page's Content-Security-Policy: its style, its script, no other source than its own."""
    sources = "img-src 'self' data:; connect-src 'self'" if setting.review else "img-src data:"
    return (
        f"default-src 'none'; {sources};"
        f" style-src 'sha256-{_hash(_style())}'; script-src 'sha256-{_hash(_script(setting))}';"
        " base-uri 'none'; form-action 'none'"
    )


def _style() -> str:
    return _read("report.css")


def _script(setting: ShotPageContext) -> str:
    return "".join(
        map(_read, ["png.js", "viewer.js", "report.js", *(["review.js"] if setting.review else [])])
    )


def _hash(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


@INTERFACE.cached()
def _read(name: str) -> str:
    return (_HERE / name).read_text(encoding="utf-8")


def _headline(failed: Sequence[Record], records: Sequence[Record]) -> str:
    if not failed:
        return f"{'All ' if len(records) > 1 else ''}{counted(len(records), 'shot')} passed"
    return f"{len(failed)} of {counted(len(records), 'shot')} failed"


def _facts(records: Sequence[Record], notes: Sequence[str]) -> Markup:
    words = Counter(record.word for record in records)
    order = [*MEANINGS, *words]
    counts = [
        tag("li", chip(word), f" {words[word]}")
        for word in sorted(words, key=lambda word: (word == "same", order.index(word)))
    ]
    summary: list[Markup] = []
    builds = Counter(
        ", ".join(record.actual.texts[key] for key in _BUILD if key in record.actual.texts) or record.renderer
        for record in records
        if record.renderer
    )
    for build, number in builds.most_common():
        summary.append(tag("li", f"drawn by {build}{f' ({number})' if len(builds) > 1 else ''}"))
    checked = [record.run.when for record in records if record.run.when]
    if checked:
        summary.append(tag("li", f"checked {moment(max(checked))}"))
        latest = max(records, key=lambda record: record.run.when).run.name
        older = sum(record.run.name != latest for record in records)
        if older:
            notes = [*notes, f"{counted(older, 'shot')} of them in an earlier run."]
    taken = sum(record.run.seconds for record in records)
    if taken:
        summary.append(tag("li", f"took {taken:.3g} s"))
    return joined(
        tag("ul", *counts, class_="counts", aria_label="Results"),
        tag("ul", *summary, class_="run-summary"),
        *(tag("p", note, class_="note") for note in notes),
    )


def _list(failed: Sequence[Record]) -> Markup:
    words = Counter(record.word for record in failed)
    buttons = [
        tag("button", f"{meaning(word).label} {number}", type="button", data_word=word, aria_pressed="false")
        for word, number in words.most_common()
    ]
    parts = [
        tag("label", tag("span", "Search"), tag("input", type="search", id="search", autocomplete="off")),
        tag("div", *buttons, class_="words", role="group", aria_label="Only these results"),
        _choice("sketch", "Sketch", sorted({record.sketch for record in failed})),
        _choice("renderer", "Renderer", sorted({record.renderer for record in failed if record.renderer})),
    ]
    return tag(
        "nav",
        tag("div", tag("p", counted(len(failed), "failure"), id="shown", role="status"), class_="position"),
        tag(
            "details",
            tag("summary", "List and filters"),
            tag("div", *parts, class_="filters", hidden=True),
            tag("ol", *(row(record) for record in failed), id="rows"),
            open=True,
        ),
        class_="list",
        aria_label="Failures",
    )


def _choice(name: str, label: str, values: Sequence[str]) -> Markup | None:
    if len(values) < 2:
        return None
    options = [tag("option", "all", value=""), *(tag("option", value, value=value) for value in values)]
    return tag("label", tag("span", label), tag("select", *options, id=f"only-{name}"))


def _tools(failed: Sequence[Record]) -> Markup:
    done = tag("button", "Done", type="button", id="done")
    if not any(map(can_be_accepted, failed)):
        return done
    accept = tag("button", "Accept all shown …", type="button", id="accept-shown")
    undo = tag("button", "Undo all shown …", type="button", id="undo-shown", disabled=True)
    return joined(accept, undo, done)


def _passed(passed: Sequence[Record], *, opened: bool) -> Markup:
    heads = [tag("th", name, scope="col") for name in ("Shot", "Compared", "Found", "Took")]
    table = tag("table", tag("thead", tag("tr", *heads)), tag("tbody", *map(passed_row, passed)))
    wide = tag("div", table, class_="wide", tabindex=0, role="region", aria_label="Shots that passed")
    return tag(
        "section",
        tag("h2", f"{counted(len(passed), 'shot')} passed", id="passed-title"),
        tag("details", tag("summary", "List"), wide, open=opened),
        class_="passed",
        aria_labelledby="passed-title",
    )
