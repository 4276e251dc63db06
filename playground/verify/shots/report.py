"""Write what a run came to: an HTML file of a folder of results, and a step's summary of GitHub Actions.

In the file everything is inside, the pictures as data URLs, so that it can be sent, or stored by a
continuous integration. It can be read without its script, and printed; the script adds
swiping, blinking, zooming and the values of pixels. Passed shots have a line each.

Pictures are embedded until they would make the file too large to open; the others are then
links to the files next to it, and the page says so.

GitHub shows a step's summary, Markdown of at most 1 MiB, on the page of the workflow's run. It takes out
images that are data URLs, and files of an artifact have no address, so a thumbnail is a link:
the reference as it is in the commit, and the pictures of this run from where
``--shots-pictures-url`` says that the results will be (the action of this project puts them into a
branch). Without that, the summary says where the pictures are.

https://docs.github.com/actions/reference/workflows-and-actions/workflow-commands#adding-a-job-summary
"""

from __future__ import annotations

import base64
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from urllib.parse import quote

from playground.errors import counted
from playground.files import read_regular, write_file
from playground.paths import shown
from playground.verify.shots.page.document import ShotPageContext, page
from playground.verify.shots.plugin_constants import REPORT
from playground.verify.shots.results import FOLDER, Record, read_results
from playground.verify.shots.verdicts import verdict_on

# ── the file ─────────────────────────────────────────────────────────────────


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


# ── the step's summary ───────────────────────────────────────────────────────


FILE = "GITHUB_STEP_SUMMARY"
URL = "SHOTS_PICTURES_URL"
MAX_BYTES = 1_000_000  # of GitHub's 1 MiB, above which it shows nothing at all
WIDTH = 200  # [CSS pixels] of a thumbnail

ShotProperties = Mapping[str, str]
"""What a checked shot tells: see `playground.verify.shots.results`."""

_SHOWN = (("expected", "Reference"), ("actual", "Now"), ("difference", "Difference × 16"))


def summarise(
    shots: Sequence[ShotProperties], folder: Path, url: str = "", environment: Mapping[str, str] | None = None
) -> str:
    """Append the summary to the file that ``GITHUB_STEP_SUMMARY`` names, if that is set.

    ``folder`` has the results, ``url`` is where that will be in the web, "" for ``SHOTS_PICTURES_URL``.
    Returns why it could not be written, a message; else "".
    """
    environment = os.environ if environment is None else environment
    name = environment.get(FILE, "")
    if not name or not shots:
        return ""
    path = Path(name)
    try:
        there = path.stat().st_size if path.exists() else 0
        text = text_of(shots, folder, url or environment.get(URL, ""), environment, MAX_BYTES - there)
        with path.open("a", encoding="utf-8", newline="\n") as handle:
            handle.write(text)
    except OSError as error:
        return f"no step summary: {path}: {error.strerror or error}"
    return ""


def text_of(
    shots: Sequence[ShotProperties],
    folder: Path,
    url: str,
    environment: Mapping[str, str],
    room: int = MAX_BYTES,
) -> str:
    """Return the summary as Markdown, of at most ``room`` bytes."""
    failed = [shot for shot in shots if not verdict_on(shot["shot.result"]).passes]
    others = sorted({shot["shot.stands-in"] for shot in shots if "shot.stands-in" in shot})
    lines = [f"## {_heading(len(failed), len(shots))}", ""]
    lines += [f"- {escape(how)}" for how in others] + [""] * bool(others)
    if not failed:
        return "\n".join(lines) + "\n"
    titles = ["Shot", *(title for _, title in _SHOWN)]
    rows = ["| " + " | ".join(titles) + " |", "|" + " --- |" * len(titles)]
    last = ["", _where(folder, bool(url)), ""]
    room -= sum(len(line.encode()) + 1 for line in (*lines, *rows, *last)) + 100  # for what is left out
    for number, shot in enumerate(failed):
        row = _row(shot, folder, url.rstrip("/"), environment)
        room -= len(row.encode()) + 1
        if room < 0:
            last[:0] = [
                "",
                f"{counted(len(failed) - number, 'failed shot')} more: GitHub shows no more text.",
            ]
            break
        rows.append(row)
    return "\n".join([*lines, *rows, *last])


def _heading(failed: int, all_of_them: int) -> str:
    if not failed:
        return f"{counted(all_of_them, 'shot')}: all as expected"
    return f"{failed} of {counted(all_of_them, 'shot')} failed"


def _where(folder: Path, shown: bool) -> str:
    more = "" if shown else "The new pictures have no address that this page could show. "
    suffix = "" if folder.name == REPORT else f" {folder.name}"
    return f"{more}The report is in `{folder.name}`; to accept pictures: `playground shots review{suffix}`"


def _row(shot: ShotProperties, folder: Path, url: str, environment: Mapping[str, str]) -> str:
    scores = [
        f"{name.removeprefix('shot.score.')}: {value}"
        for name, value in shot.items()
        if name.startswith("shot.score.")
    ]
    said = [f"**{_plain(shot['shot'])}**", _plain(shot["shot.result"]), _plain(shot.get("shot.renderer", ""))]
    cells = ["<br>".join(text for text in (*said, *map(_plain, scores)) if text)]
    for word, title in _SHOWN:
        source = _reference(shot, environment) if word == "expected" else ""
        name = shot.get(f"shot.picture.{word}", "")
        if not source and url and name:
            inside = Path(name).parts[-2:]  # folder of the sketch, file
            source = f"{url}/{quote('/'.join(inside))}"
        image = f'<img src="{escape(source)}" width="{WIDTH}" alt="{escape(title)}">'
        cells.append(f'<a href="{escape(source)}">{image}</a>' if source else "")
    return "| " + " | ".join(cells) + " |"


def _reference(shot: ShotProperties, environment: Mapping[str, str]) -> str:
    """Return where the reference is in the commit that is tested; "" where that is not known."""
    needed = [environment.get(f"GITHUB_{word}", "") for word in ("SERVER_URL", "REPOSITORY", "SHA")]
    workspace, reference = environment.get("GITHUB_WORKSPACE", ""), shot.get("shot.reference", "")
    if not (all(needed) and workspace and reference):
        return ""
    path = Path.cwd() / reference
    if not path.is_relative_to(workspace):
        return ""
    server, repository, commit = needed
    return f"{server}/{repository}/raw/{commit}/{quote(path.relative_to(workspace).as_posix())}"


def _plain(text: str) -> str:
    """Return a text as it is to be read, in a cell of a table in Markdown."""
    return escape(text).replace("|", "&#124;").replace("\n", " ").replace("*", "&#42;").replace("`", "&#96;")
