"""Write one HTML file of a folder of results: what failed, to look at from all sides, with no network.

Everything is inside, the pictures as data URLs, so that the file can be sent, or stored by a
continuous integration. It can be read without its script, and printed; the script adds
swiping, blinking, zooming and the values of pixels. Passed shots have a line each.

Pictures are embedded until they would make the file too large to open; the others are then
links to the files next to it, and the page says so.
"""

from __future__ import annotations

import base64
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from playground.errors import counted
from playground.files import read_regular, write_file
from playground.paths import shown
from playground.verify.shots.page.document import page
from playground.verify.shots.page.shot import ShotPageContext
from playground.verify.shots.results import FOLDER, Record, read_results

NAME = "index.html"
"""The report's file in the folder of results, unless another is named."""

EMBEDDED = 96 * 2**20
"""[bytes] Of pictures that a report holds at most: about 80 failures of 640 × 360."""


def write_report(folder: Path = Path(FOLDER), file: Path | None = None) -> Path:
    """Write the report on a folder of results, whole or not at all, and return its path.

    Raises ``DataError`` for a folder without records, a record that cannot be read, or a
    place that cannot be written to.
    """
    target = file or folder / NAME
    try:
        links = os.path.relpath(folder.absolute(), target.absolute().parent)
    except ValueError:  # on Windows, another drive
        links = str(folder.absolute())
    text = report_html(read_results(folder), folder, Path(links))
    write_file(target, text)
    return target


def report_html(records: Sequence[Record], folder: Path, links: Path = Path(), most: int = EMBEDDED) -> str:
    """Return the report on records whose pictures are in ``folder``, with at most ``most`` bytes of them.

    ``links`` is the folder of the results as links of the report name it. A picture that is not there
    any more is left out, which the page says.
    """
    pictures = _Pictures(folder, most)
    prefix = "" if links == Path() else f"{links.as_posix()}/"
    setting = ShotPageContext(shown(folder), pictures.source, prefix)
    failed = [record for record in records if not record.ok]
    for record in failed:  # in the order of the page: the first failures have their pictures
        pictures.take(record)
    return page(records, setting, pictures.notes())


@dataclass
class _Pictures:
    """The pictures of a report, as data URLs, until there are too many bytes of them."""

    folder: Path
    left: int  # [bytes]
    urls: dict[str, str] = field(default_factory=dict)
    linked: int = 0  # how many failures are linked to instead
    gone: list[str] = field(default_factory=list)

    def take(self, record: Record) -> None:
        """Embed a failure's pictures, all or none of them."""
        files: dict[str, str] = {}
        for name in record.actual.pictures.values():
            try:
                data = read_regular(self.folder / name)
            except OSError:
                self.gone.append(name)
                continue
            files[name] = "data:image/png;base64," + base64.b64encode(data).decode()
        size = sum(map(len, files.values()))
        if size > self.left:
            self.left = 0  # else smaller ones further down would have theirs, for no reason that one sees
            self.linked += 1
            return
        self.left -= size
        self.urls |= files

    def source(self, record: Record, kind: str) -> str:
        """Return a picture's data URL, or "" where the page has a link."""
        return self.urls.get(record.actual.pictures[kind], "")

    def notes(self) -> list[str]:
        """Return what is not inside, a message each."""
        notes = []
        if self.linked:
            notes.append(
                f"The pictures of {counted(self.linked, 'failure')} are not in this file, which would be too"
                " large to open; they are links to the files next to it."
            )
        if self.gone:
            notes.append(
                f"{counted(len(self.gone), 'picture')} could not be read: {', '.join(self.gone[:8])}."
            )
        return notes
