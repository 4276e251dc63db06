"""Write the page of results: how many failed, a list of them to filter, each failure, what passed.

Its style and script are inside, and its policy lets no others run: the browser compares
their hashes. Whatever a name or an output of a driver holds, it cannot become a script.
"""

from __future__ import annotations

import base64
import hashlib
import shlex
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template
from urllib.parse import quote

from playground._version import __version__
from playground.errors import counted
from playground.markup import Markup, joined, tag
from playground.memo import INTERFACE
from playground.verify.shots.results import FOLDER, FRAMES, Record
from playground.verify.shots.verdicts import VERDICTS, verdict_on

# ── one shot ─────────────────────────────────────────────────────────────────


CAPTIONS = {
    "expected": "Expected",
    "actual": "Actual",
    "difference": "Difference ×16",
    "flip": "FLIP map",
    "masked": "Not compared",
}
"""What the pictures are called on the page, in the order in which they are shown."""

_ALT = {
    "expected": "the reference",
    "actual": "as it was drawn now",
    "difference": "the difference between the two, 16 times as strong; black is none",
    "flip": "the FLIP map: the brighter, the more an eye would see of the difference",
    "masked": "as it was drawn now, with stripes over masked areas",
}

_KEYS = {
    "renderer": "Renderer",
    "version": "OpenGL version",
    "vendor": "OpenGL vendor",
    "mesa": "Mesa",
    "llvm": "LLVM",
    "cpu": "Processor",
    "simd": "Its instructions",
    "drawn": "Hash of what was drawn",
    "fonts": "Fonts",
    "size": "Size",
    "tool": "Tool",
    "sketch": "Sketch",
    "shot": "Shot",
}


@dataclass(frozen=True)
class ShotPageContext:
    """What the page is for, as far as its parts differ."""

    folder: str  # the results, as a shell in the tests' folder names them
    source: Callable[[Record, str], str]  # URL of a picture, to show; "" where it is only linked to
    results: str = ""  # path from the page to the results, for links: "" or one that ends in "/"
    review: bool = False  # whether there are buttons that accept


def anchor(record: Record) -> str:
    """Return what a link to a shot has after its #."""
    return quote(record.name, safe="/")


def chip(word: str) -> Markup:
    """Return a word as a small mark; its colour only says again what the text says."""
    return tag("span", verdict_on(word).label, class_=f"chip {verdict_on(word).chip}")


def can_be_accepted(record: Record) -> bool:
    """Whether a reference may be made of what was drawn."""
    return not record.ok and verdict_on(record.word).acceptable and "actual" in record.actual.pictures


def accept_command(record: Record, folder: str) -> str:
    """Return what accepts just this picture, for a shell."""
    words = ["playground", "shots", "accept", *([] if folder == FOLDER else [folder]), record.name]
    return shlex.join(words)


def failure(record: Record, setting: ShotPageContext) -> Markup:
    """Return the article on a shot that failed."""
    heading = f"title-{anchor(record)}"
    explained = (verdict_on(record.word).meaning, record.rules.catches)
    return tag(
        "article",
        tag(
            "header",
            tag(
                "h2",
                tag("span", f"{record.sketch} / ", class_="of"),
                record.shot,
                id=heading,
                tabindex=-1,
            ),
            chip(record.word),
            tag("span", record.rules.tier, class_="tier") if record.rules.tier else None,
            _buttons(record) if setting.review and can_be_accepted(record) else None,
        ),
        tag("p", class_="message", role="status") if setting.review else None,
        tag("p", _verdict(record), class_="verdict"),
        tag("p", " ".join(filter(None, explained)), class_="meaning") if any(explained) else None,
        _rules(record),
        _traced(record),
        _error(record),
        tag("div", class_="viewer", hidden=True),
        _pictures(record, setting),
        _accepting(record, setting),
        tag("div", _figures(record), _fingerprints(record), class_="facts"),
        class_="shot",
        id=anchor(record),
        aria_labelledby=heading,
        data_name=record.name,
        data_sketch=record.sketch,
        data_word=record.word,
        data_renderer=record.renderer,
        data_stamp=record.stamp,
        data_place=",".join(map(str, record.place)) if record.place else None,
    )


def _verdict(record: Record) -> str:
    """Return the message without the word that it begins with, which the page shows next to it."""
    message = record.message.removeprefix(f"{record.word}: ")
    return message[:1].upper() + message[1:]


def _pictures(record: Record, setting: ShotPageContext) -> Markup | None:
    figures = []
    for kind, caption in CAPTIONS.items():
        if kind not in record.actual.pictures:
            continue
        source = setting.source(record, kind)
        size = record.expected.size if kind == "expected" else record.actual.size
        width, height = size or (None, None)
        if source:
            shown = tag(
                "img",
                src=source,
                alt=f"{record.name}: {_ALT[kind]}",
                width=width,
                height=height,
                loading="lazy",
            )
        else:
            shown = tag(
                "a", record.actual.pictures[kind], href=quote(setting.results + record.actual.pictures[kind])
            )
        figures.append(tag("figure", tag("figcaption", caption), shown, data_kind=kind))
    return tag("div", *figures, class_="pictures") if figures else None


def _error(record: Record) -> Markup | None:
    if not record.error.strip():
        return None
    return tag(
        "section",
        tag("h3", "What the process that draws printed"),
        tag("pre", record.error.strip(), tabindex=0, aria_label="What the process that draws printed"),
        class_="printed",
    )


def _buttons(record: Record) -> Markup:
    """Return what accepts a picture, and undoes that; review.js lets the right ones be pressed."""
    return tag(
        "div",
        tag("button", "Accept", type="button", data_do="accept", class_="main", disabled=True),
        tag("button", "Accept as further", type="button", data_do="also", disabled=True)
        if record.expected.references
        else None,
        tag("button", "Undo", type="button", data_do="undo", disabled=True),
        class_="buttons",
    )


def _accepting(record: Record, setting: ShotPageContext) -> Markup:
    if not can_be_accepted(record):
        why = verdict_on(record.word).refusal or "There is no picture here to accept; run the tests again."
        return tag("section", tag("p", why), class_="accepting")
    parts: list[Markup] = [tag("h3", "If this is right")]
    commands = [("accepts this very picture", accept_command(record, setting.folder))]
    if record.expected.references:
        also = f"{accept_command(record, setting.folder)} --also"
        commands.append(("accepts it in addition to those accepted so far", also))
    if record.run.command:
        commands.append(("takes it again and accepts that", record.run.command))
    rows = [
        tag(
            "li",
            tag("span", says, class_="says"),
            tag("code", command),
            tag("button", "Copy", type="button", class_="copy", hidden=True, aria_label=f"Copy: {command}"),
        )
        for says, command in commands
    ]
    parts.append(tag("ul", *rows, class_="commands"))
    return tag("section", *parts, class_="accepting")


def _figures(record: Record) -> Markup:
    rows = [(name[:1].upper() + name[1:], number(value)) for name, value in record.numbers.items()]
    if record.place:
        x, y = record.place
        whole = " of all frames" if FRAMES in record.numbers else ""
        rows.append(("Worst pixel", f"x = {x}, y = {y} from the top left{whole}"))
    for name, size in (("Size", record.actual.size), ("Expected size", record.expected.size)):
        if size and (name == "Size" or size != record.actual.size):
            rows.append((name, f"{size[0]} × {size[1]} pixels"))
    reference = f"{record.expected.home}/{record.sketch}/{record.renderer}/{record.expected.compared}"
    if record.expected.compared not in record.expected.references:  # another renderer's, or none
        other = record.expected.texts.get("renderer", "another renderer")
        reference = f"{record.expected.compared}, drawn by {other}" if record.expected.compared else "none"
    if record.renderer:
        rows.append(("Reference", reference))
    if len(record.expected.references) > 1:
        rows.append(("Accepted so far", ", ".join(record.expected.references)))
    if record.run.node:
        rows.append(("Test", record.run.node))
    if record.run.seconds:
        rows.append(("Took", f"{record.run.seconds:.2g} s"))
    if record.run.when:
        rows.append(("Checked", moment(record.run.when)))
    cells = [tag("tr", tag("th", name, scope="row"), tag("td", value)) for name, value in rows]
    return tag("section", tag("h3", "Figures"), tag("table", *cells), class_="figures")


def _rules(record: Record) -> Markup | None:
    """Return what the shot says of its comparison, with the reasons it gives."""
    said = [(name, value) for name, value in _rule(record) if value]
    items = [tag("li", tag("strong", name), f": {value}") for name, value in said]
    return tag("ul", *items, class_="rules") if items else None


def _traced(record: Record) -> Markup | None:
    """Return the first line whose value differs from the reference's run, or is no number, or why none is."""
    if not record.traced:
        return None
    lines = tag("pre", "\n".join(record.traced))
    title = "First NaN or infinity" if record.word == "nan" else "First value that differs"
    return tag("section", tag("h3", title), lines, class_="traced")


def _rule(record: Record) -> tuple[tuple[str, str], ...]:
    """Return what the shot says of its comparison, by name; "" for what it does not say."""
    return (
        ("Tolerance", record.rules.tolerance),
        ("Masked", "; ".join(record.rules.masked)),
        ("Tone", record.rules.tone),
        ("References", record.expected.stands_in),
    )


def _fingerprints(record: Record) -> Markup | None:
    if not (record.actual.texts or record.expected.texts):
        return None
    parts: list[Markup] = [tag("h3", "Fingerprints")]
    if record.fingerprint:
        parts.append(tag("ul", *(tag("li", line) for line in record.fingerprint), class_="differences"))
    elif record.expected.texts:
        alike = ", of the same sketch and shaders" if "drawn" in record.actual.texts else ""
        parts.append(tag("p", f"Both pictures were drawn by the same build{alike}."))
    rows = []
    for key in dict.fromkeys([*record.expected.texts, *record.actual.texts]):
        before, now = record.expected.texts.get(key, "–"), record.actual.texts.get(key, "–")
        differs = bool(record.expected.texts) and before != now
        cells = [tag("td", before), tag("td", now)] if record.expected.texts else [tag("td", now)]
        mark = tag("span", " differs", class_="differs") if differs else None
        rows.append(tag("tr", tag("th", _KEYS.get(key, key), mark, scope="row"), *cells))
    heads = ["", "Expected", "Actual"] if record.expected.texts else ["", "Actual"]
    head = tag("thead", tag("tr", *(tag("th", name, scope="col") if name else tag("td") for name in heads)))
    table = tag("table", head, tag("tbody", *rows), class_="fingerprints")
    parts.append(tag("div", table, class_="wide", tabindex=0, role="region", aria_label="Fingerprints"))
    return tag("section", *parts)


def number(value: float) -> str:
    """Return a number as a table shows it: whole ones whole, others with four digits that count."""
    return f"{value:,}".replace(",", " ") if isinstance(value, int) else f"{value:.4g}"


def moment(when: float) -> str:
    """Return a time as "2026-01-31 12:00:00 UTC"."""
    return time.strftime("%Y-%m-%d %H:%M:%S UTC", time.gmtime(when))


def row(record: Record) -> Markup:
    """Return the line of the list that leads to a failed shot."""
    link = tag(
        "a",
        tag("canvas", class_="thumb", width=80, height=45, aria_hidden="true"),
        tag(
            "span",
            tag("span", f"{record.sketch} / ", class_="of"),
            tag("span", record.shot, class_="name"),
            class_="title",
        ),
        chip(record.word),
        href=f"#{anchor(record)}",
    )
    return tag("li", link, data_name=record.name)


def passed_row(record: Record) -> Markup:
    """Return the line of a shot that passed."""
    rule = "".join(f"; {name.lower()}: {value}" for name, value in _rule(record) if value)
    cells = (
        record.rules.tier,
        record.message + rule,
        f"{record.run.seconds:.2g} s" if record.run.seconds else "",
    )
    return tag("tr", tag("th", record.name, scope="row"), *(tag("td", cell) for cell in cells))


# ── the whole page ───────────────────────────────────────────────────────────


_HERE = Path(__file__).resolve().parent

_BUILD = ("renderer", "version", "cpu", "simd")  # the texts that say what drew a picture

_REVIEW_KEYS = tag(
    "tr",
    tag("th", tag("kbd", "y"), Markup(" "), tag("kbd", "u"), scope="row"),
    tag("td", "accept this shot, undo that"),
)


def page(records: Sequence[Record], setting: ShotPageContext, notes: Sequence[str] = ()) -> str:
    """Return the page as HTML; ``notes`` are messages for its head, as on pictures left out."""
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
    order = [*VERDICTS, *words]
    counts = [
        tag("li", chip(word), f" {words[word]}")
        for word in sorted(words, key=lambda word: (verdict_on(word).passes, order.index(word)))
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
        tag(
            "button",
            f"{verdict_on(word).label} {number}",
            type="button",
            data_word=word,
            aria_pressed="false",
        )
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
