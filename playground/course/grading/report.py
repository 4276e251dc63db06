"""Marks of submissions, and their report in a folder: the table, the contact sheet, its pictures.

grades.csv    a row for each student; one that was changed since is kept as "grades (1).csv"
index.html    the contact sheet, with the hash of grades.csv as it was written
pictures/     named after their bytes: equal ones share a file
"""

from __future__ import annotations

import csv
import hashlib
import io
import re
import unicodedata
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path

from PIL import Image

from playground._version import __version__
from playground.course.library import Labels, labels
from playground.errors import DataError
from playground.files import write_file
from playground.markup import Markup, document, joined, policy_hash, tag, with_code
from playground.paths import shown

GRADED, MISSING, REFUSED, STOPPED = "graded", "missing", "refused", "stopped"
"""What may have come of an exercise: judged; not handed in; not read; ended with its process."""


@dataclass(frozen=True)
class Pair:
    """What was handed in and what was wanted, side by side."""

    mine: bytes  # WebP
    expected: bytes  # WebP


@dataclass(frozen=True)
class Mark:
    """What came of one exercise or challenge of one student; a challenge has a score and no points."""

    points: float
    of: int
    outcome: str  # GRADED, MISSING, REFUSED or STOPPED
    sentences: tuple[str, ...] = ()
    pairs: tuple[Pair, ...] = ()
    note: str = ""  # for information: it changes no points
    same_as: tuple[str, ...] = ()  # students who handed in the same text
    score: float | None = None  # of a challenge: 0..100
    goal: int = 0  # score from which a challenge is solved

    @property
    def is_full(self) -> bool:
        """Whether it has all points, or solves its challenge."""
        return self.points == self.of and (self.score is None or self.score >= self.goal)

    @property
    def spelled(self) -> str:
        """What stands in a table: points, or the score in whole steps, as the window shows it."""
        return spelled_points(self.points) if self.score is None else str(int(self.score))


@dataclass(frozen=True)
class Graded:
    """One student's marks."""

    student: str
    marks: dict[str, Mark]  # by the exercise's name, in their order

    @property
    def points(self) -> float:
        """The total."""
        return round(sum(mark.points for mark in self.marks.values()), 2)

    @property
    def of(self) -> int:
        """The points that there are."""
        return sum(mark.of for mark in self.marks.values())


def spelled_points(points: float) -> str:
    """Return points without needless digits: "2", "1.5"."""
    return f"{points:.2f}".rstrip("0").rstrip(".")


_FORMULAS = ("=", "+", "-", "@", "\t", "\r", "\n")  # also in their wide forms


def table_bytes(graded: Sequence[Graded], exercises: Sequence[str], language: str) -> bytes:
    """Return the table: a row for each student, the points of each exercise, the total, and of how many.

    A challenge has its score in its column, which counts in no total.
    """
    text, label = io.StringIO(newline=""), labels("grading", language)
    rows = csv.writer(text, delimiter=label("separator"))
    rows.writerow([label("column"), *map(as_text, exercises), label("column_total"), label("column_of")])
    for graded_submission in graded:
        numbers = [
            *(graded_submission.marks[name].spelled for name in exercises),
            spelled_points(graded_submission.points),
        ]
        decimal = [number.replace(".", label("decimal")) for number in numbers]
        rows.writerow([as_text(graded_submission.student), *decimal, graded_submission.of])
    return text.getvalue().encode("utf-8-sig", "replace")


def as_text(name: str) -> str:
    """Return a name as a spreadsheet shows it, not as a formula that it computes."""
    begins = unicodedata.normalize("NFKC", name).lstrip(" ")
    return f"'{name}" if begins.startswith(_FORMULAS) else name


_HERE = Path(__file__).resolve().parent
_HASH_NAME = "table-sha256"
_DRIVER_QUOTES = re.compile(r"`(\w+)'")
_COARSE = 100  # pixels: pictures with fewer are shown texel by texel


@dataclass(frozen=True)
class ReportContext:
    """What the page is written with."""

    language: str
    renderer: str  # that drew the pictures
    file_of: Callable[[bytes], str]  # a picture's address
    size_of: Callable[[bytes], tuple[int, int]]  # [pixels]
    table_hash: str = ""  # SHA-256 of the table that the page goes with

    @property
    def label(self) -> Labels:
        """The labels in its language."""
        return labels("grading", self.language)

    def number(self, points: float) -> str:
        """Return points as this language writes them."""
        return spelled_points(points).replace(".", self.label("decimal"))


def page(graded: Sequence[Graded], titles: dict[str, str], setting: ReportContext) -> str:
    """Return the page as HTML; ``titles`` are those of the exercises by name."""
    label, style, script = setting.label, _read("report.css"), _read("report.js")
    mean = sum(graded_submission.points for graded_submission in graded) / max(len(graded), 1)
    count = label("students", n=len(graded)) if len(graded) != 1 else label("student")
    of = graded[0].of if graded else 0
    policy = f"default-src 'none'; img-src 'self'; script-src '{policy_hash(script)}'"
    table = tag("meta", name=_HASH_NAME, content=setting.table_hash) if setting.table_hash else None
    summary = f"{count} · {label('mean', mean=setting.number(round(mean, 2)), of=of)}"
    students = (_student(graded_submission, titles, setting) for graded_submission in graded)
    body = tag(
        "body",
        tag("header", tag("h1", label["title"]), tag("p", summary)),
        _tools(label),
        tag("main", tag("ul", *students, class_="students")),
        tag("footer", tag("p", label("made_by", version=__version__, renderer=setting.renderer))),
        tag("script", Markup(script)),
    )
    return document(setting.language, label["title"], body, policy=policy, head=table, style=style)


def table_hash_of(text: str) -> str:
    """Return the hash of the table that a page was written with; "" where it has none."""
    match = re.search(f'<meta name="{_HASH_NAME}" content="([0-9a-f]{{64}})">', text)
    return match[1] if match else ""


def _tools(label: Labels) -> Markup:
    def choice(name: str, text: str, options: Sequence[tuple[str, str]]) -> Markup:
        rows = [tag("option", label[key], value=value) for value, key in options]
        return tag("label", text, tag("select", *rows, id=name))

    sorts = [("name", "by_name"), ("fewest", "by_points"), ("most", "by_most")]
    shows = [("all", "all"), ("not-full", "not_full"), ("full", "full"), ("trouble", "trouble")]
    return tag(
        "div",
        choice("sort", label["sort"], sorts),
        choice("show", label["show"], shows),
        tag("label", label["find"], tag("input", type="search", id="find")),
        tag("span", id="shown", role="status", data_text=label["of_shown"]),
        class_="tools",
        hidden=True,
    )


def _student(graded_submission: Graded, titles: dict[str, str], setting: ReportContext) -> Markup:
    states = ["full" if graded_submission.points == graded_submission.of else "not-full"]
    states += ["trouble"] if any(mark.outcome != GRADED for mark in graded_submission.marks.values()) else []
    return tag(
        "li",
        tag(
            "h2",
            tag("bdi", graded_submission.student),
            _chip(graded_submission.points, graded_submission.of, setting),
        ),
        tag(
            "div",
            *(_mark(name, titles[name], m, setting) for name, m in graded_submission.marks.items()),
            class_="marks",
        ),
        class_="student",
        data_name=graded_submission.student,
        data_points=spelled_points(graded_submission.points),
        data_states=" ".join(states),
    )


def _chip(points: float, of: int, setting: ReportContext) -> Markup:
    kind = "full" if points == of else "part" if points else "none"
    return tag("span", f"{setting.number(points)} / {of}", class_=f"chip {kind}")


def _chip_of(mark: Mark, setting: ReportContext) -> Markup:
    if mark.score is None:
        return _chip(mark.points, mark.of, setting)
    kind = "full" if mark.is_full else "part" if mark.score else "none"
    return tag("span", setting.label("score", score=mark.spelled), class_=f"chip {kind}")


def _mark(name: str, title: str, mark: Mark, setting: ReportContext) -> Markup:
    label = setting.label
    first, *others = mark.pairs or (None,)
    further = [_pair(title, pair, setting) for pair in others if pair]
    sentences = [tag("li", _with_code(sentence)) for sentence in mark.sentences]
    same = None
    if mark.same_as:
        names = _in_list(mark.same_as)
        same = tag("p", label("same", names=names), class_="note", title=label["same_hint"])
    return tag(
        "section",
        tag("h3", tag("span", title), _chip_of(mark, setting)),
        _pair(title, first, setting) if first else None,
        tag("ul", *sentences, class_="sentences") if sentences else None,
        tag("details", tag("summary", label["more"]), *further) if further else None,
        same,
        tag("p", mark.note, class_="note") if mark.note else None,
        class_="mark",
        data_exercise=name,
    )


def _with_code(sentence: str) -> Markup:
    """Return a message, escaped, what is between backticks as code, and what follows its first line too."""
    first, line_end, quoted = sentence.partition("\n")
    return joined(with_code(_DRIVER_QUOTES.sub(r"`\1`", first)), tag("pre", quoted) if line_end else None)


def _in_list(names: Sequence[str], most: int = 6) -> str:
    shown = ", ".join(names[:most])
    return shown if len(names) <= most else f"{shown}, +{len(names) - most}"


def _pair(title: str, pair: Pair, setting: ReportContext) -> Markup:
    figures = [
        _figure(title, setting.label[key], data, setting)
        for key, data in (("mine", pair.mine), ("wanted", pair.expected))
    ]
    return tag("div", *figures, class_="pair")


def _figure(title: str, text: str, data: bytes, setting: ReportContext) -> Markup:
    width, height = setting.size_of(data)
    coarse = "texels" if max(width, height) < _COARSE else None
    image = tag(
        "img",
        src=setting.file_of(data),
        alt=f"{title}: {text}",
        width=width,
        height=height,
        loading="lazy",
        class_=coarse,
    )
    return tag("figure", image, tag("figcaption", text))


def _read(name: str) -> str:
    return (_HERE / name).read_text(encoding="utf-8")


TABLE, PAGE, PICTURES = "grades.csv", "index.html", "pictures"
_PICTURE = re.compile(r"[0-9a-f]{20}\.webp")


def is_report(folder: Path) -> bool:
    """Return whether a folder holds a report of grades."""
    files = (folder / TABLE).is_file() and (folder / PAGE).is_file()
    return files and (folder / PICTURES).is_dir()


def check_folder(folder: Path) -> None:
    """Raise ``DataError`` where a report would go over what is none."""
    there = folder.exists()
    if there and (not folder.is_dir() or (any(folder.iterdir()) and not (folder / TABLE).is_file())):
        message = "there is something here that is no report of grades; name a new or empty folder"
        raise DataError(message, file=shown(folder))
    if not there and not folder.absolute().parent.is_dir():
        raise DataError(f"there is no folder '{folder.parent}' to write into", file=shown(folder))


def write_report(
    folder: Path, graded: Sequence[Graded], titles: dict[str, str], language: str, renderer: str
) -> tuple[Path, Path | None]:
    """Write the report; return its page, and what an earlier table that was changed since is now kept as.

    Pictures of an earlier report that are no longer shown are removed.
    Raises ``DataError`` where it cannot be written.
    """
    written: set[str] = set()

    def file_of(data: bytes) -> str:
        name = f"{hashlib.sha256(data).hexdigest()[:20]}.webp"
        if name not in written:
            written.add(name)
            _write(folder / PICTURES / name, data)
        return f"{PICTURES}/{name}"

    try:
        (folder / PICTURES).mkdir(parents=True, exist_ok=True)
        table = table_bytes(graded, list(titles), language)
        text = page(graded, titles, ReportContext(language, renderer, file_of, _size_of, _hash(table)))
        kept = _keep_changed(folder, table)
        _write(folder / TABLE, table)
        _write(folder / PAGE, text.encode("utf-8", "replace"))
        for old in (folder / PICTURES).iterdir():
            if _PICTURE.fullmatch(old.name) and old.name not in written:
                old.unlink()
    except OSError as error:
        raise DataError(f"cannot be written: {error.strerror}", file=shown(folder)) from None
    return folder / PAGE, kept


def _keep_changed(folder: Path, new: bytes) -> Path | None:
    """Copy a table that is not as the last report wrote it to a name that is free, and return that."""
    table, page_file = folder / TABLE, folder / PAGE
    if not table.is_file():
        return None
    data = table.read_bytes()
    written = table_hash_of(page_file.read_text("utf-8", "replace")) if page_file.is_file() else ""
    if data == new or _hash(data) == written:
        return None
    names = (table.with_stem(f"{table.stem} ({number})") for number in count(1))
    kept = next(path for path in names if not path.exists())
    _write(kept, data)
    return kept


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _size_of(data: bytes) -> tuple[int, int]:
    with Image.open(io.BytesIO(data)) as picture:
        return picture.size


def _write(path: Path, data: bytes) -> None:
    write_file(path, data)
