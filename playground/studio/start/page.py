"""What the start page offers: cards by heading, what is searched for, what a click on a card does."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from playground.errors import PlaygroundError
from playground.paths import SKETCHES, shown
from playground.sketch.templates import make_sketch
from playground.studio.actions import Actions
from playground.studio.language import labels_of, language, tr
from playground.studio.start.recent import Recent
from playground.studio.start.thumbnails import SUBJECTS, thumbnails


@dataclass(frozen=True)
class Card:
    """One thing to open."""

    key: str  # of its own among all cards
    title: str
    note: str  # a sentence, shown where the mouse rests
    act: Callable[[], object]
    group: str  # recent | shipped | lesson
    subject: str = ""  # of a shipped sketch
    cell: int = -1  # its picture in the atlas
    picture: Path | None = None  # its picture in a file of its own
    words: str = ""  # what is searched besides the title


@dataclass(frozen=True)
class Template:
    """One way to begin a sketch of one's own."""

    key: str
    title: str  # English
    note: str
    needs: str = ""  # "file": asks for a file first


TEMPLATES = (
    Template("hills", "Hills", "A terrain of noise with a kernel of yours, lit and in colour"),
    Template("empty", "Empty kernel", "One kernel of heights, 0 everywhere, to be written"),
    Template(
        "elevation", "From an elevation file…", "A GeoTIFF, an HGT, a PNG of heights: lit, in metres", "file"
    ),
    Template("shader", "From a shader of another tool…", "From Shadertoy, ISF or with its own main", "file"),
    Template("clipboard", "From the clipboard", "A shader's text that was copied"),
    Template("lesson", "From a lesson…", "Its terrain, explained step by step while you change it"),
)
LESSONS = "lessons"
"""The subject under which lessons alone are shown."""


@dataclass
class StartPage:
    """The start page of one window."""

    actions: Actions
    recent: Recent = field(default_factory=Recent)
    shown: bool = False
    search: str = ""
    subject: str = ""  # one of ``subjects()``; "": all
    more: Callable[[], Iterable[Card]] = lambda: ()  # the cards of rooms, as lessons
    _cards: list[Card] = field(default_factory=list)
    _language: str = ""  # of the cards

    def open(self) -> None:
        """Show the page, with what is recent now."""
        self.shown, self.search = True, ""
        self._read_cards()

    def _read_cards(self) -> None:
        self._language = language()
        self._cards = [*self._recent_cards(), *self._shipped_cards(), *self.more()]

    def close(self) -> None:
        """Go to the sketch that is open."""
        self.shown = False

    def toggle(self) -> None:
        """Show the page, or go back to the sketch."""
        if self.shown:
            self.close()
        else:
            self.open()

    def cards(self, group: str) -> list[Card]:
        """Return the cards of a group that fit the search and the subject."""
        if self._language != language():
            self._read_cards()
        words = self.search.casefold().split()
        return [
            card
            for card in self._cards
            if card.group == group
            and self._is_of_subject(card)
            and all(
                word in f"{' '.join(labels_of(card.title))} {card.words} {card.note}".casefold()
                for word in words
            )
        ]

    def _is_of_subject(self, card: Card) -> bool:
        if self.subject == LESSONS:
            return card.group == "lesson"
        return not self.subject or not card.subject or card.subject == self.subject

    def subjects(self) -> Sequence[str]:
        """Return the subjects of shipped sketches, and lessons where there are any."""
        return (*SUBJECTS, LESSONS) if any(card.group == "lesson" for card in self._cards) else SUBJECTS

    def choose(self, card: Card) -> None:
        """Do what a card is for, and close the page where that worked."""
        if card.act() is not False:
            self.close()

    def first(self) -> Card | None:
        """Return the card that Enter chooses while something is searched for."""
        for group in ("shipped", "recent", "lesson"):
            for card in self.cards(group) if self.search.strip() else ():
                return card
        return None

    def make(self, template: Template, file: Path | None = None) -> bool:
        """Make a new sketch in the current folder and open it; return whether that worked."""
        if template.needs and file is not None:
            opened = self.actions.open(file)
        elif template.key == "clipboard":
            return False  # the panel has the clipboard
        else:
            try:
                folder = make_sketch(self._free_name(), empty=template.key == "empty")
            except PlaygroundError as error:
                self.actions.notices.say(str(error))
                return False
            opened = self.actions.open(folder / "sketch.toml")
            if opened:
                self.actions.notices.say(tr("made {folder}", folder=shown(folder)))
        if opened:
            self.close()
        return opened

    def _free_name(self) -> Path:
        """Return a folder for a new sketch that is not there yet."""
        for number in range(1, 1000):
            folder = self.actions.folder / ("my-land" if number == 1 else f"my-land-{number}")
            if not folder.exists():
                return folder
        return self.actions.folder / "my-land"  # whose error says that it is there

    # ── cards ────────────────────────────────────────────────────────────────

    def _recent_cards(self) -> Iterable[Card]:
        shipped = {row.name: row for row in thumbnails()}
        for row in self.recent.sketches():
            known = shipped.get(row.path.stem) if row.path.parent == SKETCHES else None
            picture = row.picture
            yield Card(
                f"recent {row.path}",
                row.title or row.path.stem,
                shown(row.path),
                lambda path=row.path: self.actions.open(path),  # type: ignore[misc]
                "recent",
                cell=known.cell if known is not None and picture is None else -1,
                picture=picture,
            )

    def _shipped_cards(self) -> Iterable[Card]:
        for row in thumbnails():
            path = SKETCHES / f"{row.name}.toml"
            yield Card(
                f"shipped {row.name}",
                row.title,
                row.about,
                lambda path=path: self.actions.open(path),  # type: ignore[misc]
                "shipped",
                row.subject,
                row.cell,
                words=row.name.replace("_", " "),
            )


def has_file_dialogs() -> bool:
    """Return whether this system can show a dialog for files: on Linux a program does."""
    if not sys.platform.startswith("linux"):
        return True
    return any(shutil.which(name) for name in ("zenity", "kdialog", "matedialog", "qarma"))
