"""Write what the page says of one failed shot: verdict, pictures, what accepts it, figures, fingerprints."""

from __future__ import annotations

import shlex
import time
from collections.abc import Callable
from dataclasses import dataclass
from urllib.parse import quote

from playground.markup import Markup, tag
from playground.verify.shots.page.labels import meaning
from playground.verify.shots.results import FOLDER, FRAMES, NEVER_ACCEPTED, Record

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
    return tag("span", meaning(word).label, class_="chip", data_word=word)


def can_be_accepted(record: Record) -> bool:
    """Whether a reference may be made of what was drawn."""
    return not record.ok and record.word not in NEVER_ACCEPTED and "actual" in record.actual.pictures


def accept_command(record: Record, folder: str) -> str:
    """Return what accepts just this picture, for a shell."""
    words = ["playground", "shots", "accept", *([] if folder == FOLDER else [folder]), record.name]
    return shlex.join(words)


def failure(record: Record, setting: ShotPageContext) -> Markup:
    """Return the article on a shot that failed."""
    heading = f"title-{anchor(record)}"
    explained = (meaning(record.word).sentence, record.rules.catches)
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
    """Return the sentence without the word that it begins with, which the page shows next to it."""
    sentence = record.sentence.removeprefix(f"{record.word}: ")
    return sentence[:1].upper() + sentence[1:]


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
        why = "No reference can be made of it: fix the sketch or the shader, then run the tests again."
        if record.word not in NEVER_ACCEPTED:
            why = "There is no picture here to accept; run the tests again."
        elif record.word == "blank":
            why = "No reference can be made of it, unless the shot says allow_blank."
        elif record.word == "error":
            why = "Nothing to accept: fix the reported error, then run the tests again."
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
        record.sentence + rule,
        f"{record.run.seconds:.2g} s" if record.run.seconds else "",
    )
    return tag("tr", tag("th", record.name, scope="row"), *(tag("td", cell) for cell in cells))
