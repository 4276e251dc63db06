"""A trace in a notebook: its lines with all values, without a script, and one iteration by a slider."""

from __future__ import annotations

import re
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.engine.trace.listing import text_of
from playground.engine.trace.model import Trace
from playground.sketch.load import load

from ..browser import MISSING, Browser
from ..sketch_texts import map_of, passes

SUMS = """// sums.glsl -- sums in two loops, and a root of less than nothing: <b>&amp;
#pragma kernel(output = "sums:rg32f")
float squared(float x) { return x * x; }
vec2 kernel(ivec2 texel) {
    float sum = 0.0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k <= i; k++) {
            sum += squared(float(k)) + float(texel.x);
        }
    }
    return vec2(sum, sqrt(-sum));
}
"""


@pytest.fixture
def trace(engine: Engine, tmp_path: Path) -> Trace:
    (tmp_path / "sums.glsl").write_text(SUMS)
    (tmp_path / "s.toml").write_text("format = 1\nsize = 9\n" + passes(sums="./sums") + map_of("sums"))
    return engine.trace(load(tmp_path / "s.toml"), "sums", texel=(2, 3))


class Cells(HTMLParser):
    """The texts of a page's table cells, and which elements it has."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.names: list[str] = []
        self._inside = False
        self.feed(html)

    def handle_starttag(self, name: str, attributes: list[tuple[str, str | None]]) -> None:
        self.names.append(name)
        if name == "tr":
            self.rows.append([])
        if name in ("td", "th"):
            self._inside = True
            self.rows[-1].append("")

    def handle_endtag(self, name: str) -> None:
        self._inside = self._inside and name not in ("td", "th")

    def handle_data(self, data: str) -> None:
        if self._inside:
            self.rows[-1][-1] += data


def test_a_notebook_shows_all_values_without_a_script(trace: Trace) -> None:
    html = trace._repr_html_()
    found = Cells(re.sub(r"<script>.*</script>", "", html, flags=re.DOTALL))
    lines = {row[1].strip(): row[2].strip() for row in found.rows if len(row) == 3 and row[1].strip()}
    sums = [text_of(event.value, short=True) for event in trace.events if event.name == "sum"][1:]
    assert len(sums) == 6
    assert lines["sum += squared(float(k)) + float(texel.x);"] == f"sum = {' '.join(sums)}"
    assert "NaN" in lines["return vec2(sum, sqrt(-sum));"] and "! 11" in [row[0] for row in found.rows]
    assert lines["float sum = 0.0;"] == "sum = 0"
    assert ["k", "sum"] in found.rows and ["i", "sum"] in found.rows  # a table for each loop
    assert html.count('class="call"') == len(trace.calls) == 7 and "b" not in found.names
    assert "http" not in html


def test_a_trace_is_a_table(trace: Trace, monkeypatch: pytest.MonkeyPatch) -> None:
    table = pytest.importorskip("pandas").DataFrame(trace.table())
    inner = table[(table.name == "sum") & (table.kind == "set") & (table.iterations.map(len) == 2)]
    expected, total = [], 0.0
    for i in range(3):
        for k in range(i + 1):
            total += k * k + 2.0
            expected.append(total)
    assert inner.value.tolist() == expected
    assert inner.iterations.tolist() == [(i, k) for i in range(3) for k in range(i + 1)]
    monkeypatch.setitem(sys.modules, "pandas", None)
    assert [row["value"] for row in trace.table()] == [event.value for event in trace.events]


ROW = """return [...document.querySelectorAll('details[open] tr')]
  .find((row) => row.innerText.includes('sum +=')).lastChild.innerText"""
MOVE = """const [line, at] = arguments;
  const slider = document.querySelector(`details[open] input[data-loop="${line}"]`);
  slider.value = at; slider.oninput()"""


@pytest.mark.slow
@pytest.mark.skipif(bool(MISSING), reason=MISSING)
def test_a_slider_chooses_an_iteration(trace: Trace, tmp_path: Path) -> None:
    page = f"<!doctype html><meta charset=utf-8>{trace._repr_html_()}"
    (tmp_path / "page.html").write_text(page, "utf-8")
    sums = [text_of(event.value, short=True) for event in trace.events if event.name == "sum"][1:]
    with Browser(tmp_path / "profile") as browser:
        browser.open((tmp_path / "page.html").as_uri())
        assert browser.run(ROW).split() == ["sum", "=", *sums]
        browser.run(MOVE, "6", "3")
        assert browser.run(ROW).split() == ["sum", "=", *sums[3:]]  # of i = 2
        browser.run(MOVE, "7", "2")
        assert browser.run(ROW).split() == ["sum", "=", sums[4]]  # of k = 1 in it
        browser.run(MOVE, "6", "0")
        browser.run(MOVE, "7", "0")
        assert browser.run(ROW).split() == ["sum", "=", *sums]
        assert not browser.log()


@pytest.mark.slow
@pytest.mark.skipif(bool(MISSING), reason=MISSING)
def test_of_many_iterations_few_are_shown_and_each_may_be(engine: Engine, tmp_path: Path) -> None:
    (tmp_path / "sums.glsl").write_text(SUMS.replace("i < 3", "i < 30").replace("k <= i", "k < 2"))
    (tmp_path / "s.toml").write_text("format = 1\nsize = 9\n" + passes(sums="./sums") + map_of("sums"))
    trace = engine.trace(load(tmp_path / "s.toml"), "sums", texel=(2, 3))
    sums = [text_of(event.value, short=True) for event in trace.events if event.name == "sum"][1:]
    page = f"<!doctype html><meta charset=utf-8>{trace._repr_html_()}"
    (tmp_path / "page.html").write_text(page, "utf-8")
    with Browser(tmp_path / "profile") as browser:
        browser.open((tmp_path / "page.html").as_uri())
        assert browser.run(ROW).split() == ["sum", "=", *sums[:6], "…", "54", "more"]
        browser.run(MOVE, "6", "26")
        assert browser.run(ROW).split() == ["sum", "=", *sums[50:52]]
        browser.run(MOVE, "6", "0")
        assert browser.run(ROW).split() == ["sum", "=", *sums[:6], "…", "54", "more"]
