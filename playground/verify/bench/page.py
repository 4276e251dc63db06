"""One HTML page of a run: its tables, a plot of each suite, and of each figure over time.

The latter where there are earlier runs. Everything is inside: it opens without a network. The plots
are matplotlib's, as SVG.
"""

from __future__ import annotations

import importlib.util
import io
import re
from collections.abc import Iterator, Sequence
from datetime import datetime
from hashlib import sha256
from itertools import groupby
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from playground._version import __version__
from playground.errors import DataError
from playground.extras import needs
from playground.files import write_file
from playground.markup import Markup, joined, tag
from playground.verify.bench.results import HEADINGS, Figure, Results, changes, rows_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Drawing

OURS, THEIRS = "#0b6e4f", "#9aa0a6"
_WIDTH, _ROW = 9.0, 0.27  # inches


def check_plots() -> None:
    """Raise ``DataError`` where matplotlib, which draws the plots, is not installed."""
    if importlib.util.find_spec("matplotlib") is None:
        raise DataError(needs("a page with plots", "matplotlib", "bench"))


def write_page(results: Results, earlier: Sequence[Results], path: Path, clock: str = "wall") -> None:
    """Write the page of a run, with plots over time where there are earlier ones."""
    runs = sorted((*earlier, results), key=lambda run: run.date)
    template = (Path(__file__).resolve().parent / "page.html").read_text(encoding="utf-8")
    suites = groupby(results.figures, key=lambda figure: figure.suite)
    text = Template(template).substitute(
        tool=f"terrain-shader-playground {__version__}",
        date=_moment(results.date),
        facts=_facts(results, clock),
        notes=joined(*(tag("p", note) for note in results.notes)),
        changes=_changes(results, earlier, clock),
        suites=joined(*(_suite(name, list(figures), runs, clock) for name, figures in suites)),
    )
    write_file(path, text)


def _moment(date: str) -> str:
    return datetime.fromisoformat(date).strftime("%Y-%m-%d %H:%M")


def _facts(results: Results, clock: str) -> Markup:
    facts = {**results.machine, "version": results.version, "rounds": results.rounds, "clock": clock}
    return joined(*(joined(tag("dt", name), tag("dd", str(fact))) for name, fact in facts.items()))


def _table(headings: Sequence[str], rows: Sequence[Sequence[str | Markup]]) -> Markup:
    head = tag("tr", *(tag("th", heading) for heading in headings))
    body = joined(*(tag("tr", *(tag("td", cell) for cell in row)) for row in rows))
    return tag("div", tag("table", tag("thead", head), tag("tbody", body)), class_="scroll")


def _changes(results: Results, earlier: Sequence[Results], clock: str) -> Markup:
    if not earlier:
        return Markup("")
    before = max(earlier, key=lambda run: run.date)
    changed = [change for change in changes(results, before, clock) if change.word != "alike"]
    title = tag("h2", f"Changes since {_moment(before.date)}")
    if not changed:
        return joined(title, tag("p", "None that is more than the spread of the runs."))
    rows = [
        (c.figure.key, f"{c.times:.2f} × the time", tag("span", c.word, class_=c.word), c.by_peer)
        for c in changed
    ]
    return joined(title, _table(("row", "", "", "by its ratio to"), rows))


def _suite(name: str, figures: Sequence[Figure], runs: Sequence[Results], clock: str) -> Markup:
    rows: list[list[str | Markup]] = []
    for figure in figures:
        for number, cells in enumerate(rows_of(figure, clock)):
            word = "met" if figure.met else "missed"
            goal = tag("span", cells[-1], class_=word) if figure.met is not None and cells[-1] else cells[-1]
            first = (
                joined(tag("strong", figure.name), Markup(" "), figure.what) if number == 0 else Markup("")
            )
            rows.append([first, *cells[1:-1], goal])
    plots = [_bars(figures, clock)]
    if len(runs) > 1:
        plots += [_over_time(figure, runs, clock) for figure in figures]
    return joined(tag("h2", name), _table(HEADINGS, rows), *filter(None, plots))


# ── plots ────────────────────────────────────────────────────────────────────


def _bars(figures: Sequence[Figure], clock: str) -> Markup | None:
    """Draw the times of a suite as bars with their quartiles, on a logarithmic axis."""
    bars = [bar for figure in figures if figure.unit == "ms" for bar in _bars_of(figure, clock)]
    if not bars:
        return None
    drawing, axes = _drawing(0.6 + _ROW * len(bars))
    for number, (label, median, low, high, colour) in enumerate(bars):
        error = [[median - low], [high - median]]
        axes.barh(number, median, color=colour, xerr=error, error_kw={"lw": 1}, label=label)
    axes.set_yticks(range(len(bars)), [label for label, *_ in bars])
    axes.invert_yaxis()
    axes.set_xscale("log")
    axes.set_xlabel(f"ms, {clock} (bars: medians; lines: quartiles)")
    axes.margins(y=0.01)
    return _svg(drawing, "Medians with quartiles, in milliseconds, of ours and of peers")


def _bars_of(figure: Figure, clock: str) -> Iterator[tuple[str, float, float, float, str]]:
    size = f" {figure.size}²" if figure.size else ""
    for side, colour in ((figure.ours, OURS), (figure.theirs, THEIRS)):
        for name, samples in side.items():
            low, high = samples.quartiles(clock)
            yield f"{figure.name}{size}: {name}", samples.median(clock), low, high, colour


def _over_time(figure: Figure, runs: Sequence[Results], clock: str) -> Markup | None:
    """Draw a figure of every run that has it: ours and its peers, with their quartiles."""
    history = [(run, run.by_key()[figure.key]) for run in runs if figure.key in run.by_key()]
    if len(history) < 2:
        return None
    drawing, axes = _drawing(2.6)
    for name in dict.fromkeys((*figure.ours, *figure.theirs)):
        points = [
            (run, (each.ours | each.theirs)[name]) for run, each in history if name in each.ours | each.theirs
        ]
        places = [number for number, (run, _) in enumerate(history) if any(run is p for p, _ in points)]
        used = [clock if samples.of(clock) else "wall" for _, samples in points]
        medians = [samples.median(own) for (_, samples), own in zip(points, used, strict=True)]
        spread = [samples.quartiles(own) for (_, samples), own in zip(points, used, strict=True)]
        ours = name in figure.ours
        axes.plot(places, medians, marker="o", label=name, lw=2 if ours else 1, ls="-" if ours else "--")
        axes.fill_between(places, [low for low, _ in spread], [high for _, high in spread], alpha=0.15)
    axes.set_xticks(
        range(len(history)), [f"{_moment(run.date)}\n{run.version}" for run, _ in history], fontsize=7
    )
    axes.set_ylim(bottom=0)
    axes.set_ylabel(figure.unit or "count")
    axes.set_title(f"{figure.what}{f', {figure.size}²' if figure.size else ''}", fontsize=10, loc="left")
    axes.legend(fontsize=7, frameon=False)
    return _svg(drawing, f"{figure.what}, over time")


def _drawing(tall: float) -> tuple[Drawing, Axes]:
    from matplotlib.figure import Figure as Drawing

    drawing = Drawing(figsize=(_WIDTH, tall), layout="constrained")
    axes = drawing.subplots()
    axes.tick_params(labelsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    return drawing, axes


def _svg(drawing: Drawing, words: str) -> Markup:
    """Return a drawing as SVG in a page, with words for whoever does not see it."""
    import matplotlib

    stream = io.StringIO()
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": words}):
        drawing.savefig(stream, format="svg", metadata={"Date": None})
    text = stream.getvalue()
    text = text[text.index("<svg") :]
    # Names of parts are those of one drawing: with many on a page each has its own.
    own = sha256(words.encode("utf-8")).hexdigest()[:8]
    text = re.sub(r'(id="|xlink:href="#|url\(#)', rf"\g<1>p{own}-", text)
    return tag("figure", Markup(text), role="img", aria_label=words)
