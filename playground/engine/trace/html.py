"""A trace as HTML: values beside the code, a call at a time, with a slider on each loop.

It is what a notebook shows of a trace: one element that asks nothing of a network. Without its script, as in
a notebook that is not trusted or on paper, lines have the first values of each name, and loops a table each.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from playground.engine.trace.listing import annotated, event_text, heading, short_path, text_of
from playground.engine.trace.model import Call, Event, Loop, Trace
from playground.markup import Markup, joined, tag

MAX_CALLS = 40
"""Calls that are written; of more the first."""
MAX_SHOWN = 6
"""Values of a name in a line that are shown at once; a slider shows each."""
MAX_VALUES = 12_000
"""Values that are written, besides those that are shown at first."""
MAX_ROWS = 64
"""Rows of a loop's table."""

_STYLE = """
.terrain-trace { max-width: 100%; overflow-x: auto; font-size: 13px; }
.terrain-trace table { border-collapse: collapse; font-family: ui-monospace, Menlo, Consolas, monospace; }
.terrain-trace td, .terrain-trace th { padding: 0 8px; text-align: left; vertical-align: top; }
.terrain-trace pre { margin: 0; font: inherit; }
.terrain-trace .number { color: #888; text-align: right; }
.terrain-trace .value { padding-right: 6px; }
.terrain-trace .value:not([hidden]) ~ .value:not([hidden]) { border-left: 1px solid #888; padding-left: 6px; }
.terrain-trace .name { color: #2f7fd6; padding-left: 10px; }
.terrain-trace .bad { color: #d32f2f; font-weight: bold; }
.terrain-trace input { vertical-align: middle; }
.terrain-trace [hidden] { display: none; }
"""

_SCRIPT = """
for (const trace of document.querySelectorAll(".terrain-trace:not([data-ready])")) {
  trace.dataset.ready = "";
  for (const call of trace.querySelectorAll("details.call")) {
    const sliders = [...call.querySelectorAll("input[type=range]")];
    const show = () => {
      const at = new Map(sliders.map((slider) => [slider.dataset.loop, Number(slider.value)]));
      for (const value of call.querySelectorAll("[data-at]")) {
        const pairs = value.dataset.at.split(" ").map((pair) => pair.split("="));
        const chosen = pairs.filter(([loop]) => at.get(loop) > 0);
        const isOther = chosen.some(([loop, iteration]) => Number(iteration) !== at.get(loop) - 1);
        value.hidden = isOther || (!chosen.length && "rest" in value.dataset);
      }
      const isAll = [...at.values()].every((wanted) => wanted === 0);
      for (const more of call.querySelectorAll(".more")) more.hidden = !isAll;
      for (const slider of sliders) {
        const wanted = Number(slider.value);
        slider.nextElementSibling.textContent = wanted ? `iteration ${wanted - 1}` : "all iterations";
      }
    };
    for (const slider of sliders) {
      slider.parentElement.hidden = false;
      slider.oninput = show;
    }
  }
}
"""


def trace_html(trace: Trace) -> str:
    """Return a trace as an element: what it is of, then its calls, the first open."""
    rest = _Rest(MAX_VALUES)
    counts, seen = Counter(call.function for call in trace.calls), Counter[str]()
    calls = []
    for call in trace.calls[:MAX_CALLS]:
        seen[call.function] += 1
        several = f" ({seen[call.function]} of {counts[call.function]})" if counts[call.function] > 1 else ""
        inside = _lines(trace, call, rest), *_tables(trace, call)
        summary = tag("summary", f"{call.function}{several}, {short_path(call.path)}")
        calls.append(tag("details", summary, *inside, class_="call", open=call.index == _first(trace)))
    left = len(trace.calls) - len(calls)
    bad = trace.first_not_finite()
    return tag(
        "div",
        tag("style", Markup(_STYLE)),
        tag("p", heading(trace)),
        tag("p", f"! first NaN or infinity: {event_text(bad)}, line {bad.line}", class_="bad")
        if bad
        else None,
        *calls,
        tag("p", f"{left} calls more: see calls_of(…)") if left else None,
        tag("script", Markup(_SCRIPT)),
        class_="terrain-trace",
    )


def _first(trace: Trace) -> int:
    """Return the index of the first call of a function of the kernel's own file."""
    own = next(iter(trace.files), "")
    return next((call.index for call in trace.calls if call.path == own), 0)


@dataclass
class _Rest:
    """How many values may still be written besides those that are shown at first."""

    left: int


def _lines(trace: Trace, call: Call, rest: _Rest) -> Markup:
    """Return the lines of a call's function, with their values and the sliders of its loops."""
    heads = {loop.line: loop for loop in sorted(trace.loops(call), key=lambda loop: len(loop.rows))}
    rows = []
    for line in annotated(trace, call.path, call):
        loop = heads.get(line.number)
        values = joined(_slider(loop) if loop else None, *_values(line.events, rest))
        mark = "" if line.is_finite else "! "
        cells = tag("td", f"{mark}{line.number}", class_="number"), tag("td", tag("pre", line.code))
        rows.append(tag("tr", *cells, tag("td", values)))
    return tag("table", *rows)


def _slider(loop: Loop) -> Markup:
    """Return the slider of a loop, which a script shows: 0 for all of its iterations, else one."""
    most = str(len(loop.rows))
    slider = tag("input", type="range", min="0", max=most, value="0", data_loop=str(loop.line))
    return tag("label", slider, tag("output", "all iterations"), hidden=True)


def _values(events: Sequence[Event], rest: _Rest) -> Iterator[Markup]:
    """Yield what events of one line gave, by name: each value with the iterations that it is of."""
    by_name: dict[str, list[Event]] = {}
    for event in events:
        if event.value is not None:
            name = {"return": "→", "condition": "?"}.get(event.kind, f"{event.name} =")
            by_name.setdefault(name, []).append(event)
    for name, some in by_name.items():
        parts: list[Markup] = [tag("span", f"{name} ", class_="name")]
        written = MAX_SHOWN + min(max(len(some) - MAX_SHOWN, 0), rest.left)
        rest.left -= written - MAX_SHOWN
        for number, event in enumerate(some[:written]):
            pairs = zip(event.loops, event.iterations, strict=True)
            at = " ".join(f"{line}={iteration}" for line, iteration in pairs)
            text = text_of(event.value, short=len(some) > 1)
            kind = "value" if event.is_finite else "value bad"
            is_rest = number >= MAX_SHOWN
            value = tag("span", text, class_=kind, data_at=at or None, data_rest=is_rest, hidden=is_rest)
            parts += [value, Markup(" ")]
        if len(some) > MAX_SHOWN:
            parts.append(tag("span", f"… {len(some) - MAX_SHOWN} more", class_="value more"))
        yield tag("span", *parts)


def _tables(trace: Trace, call: Call) -> Iterator[Markup]:
    """Yield the loops of a call as tables, folded."""
    for loop in trace.loops(call):
        names = list(dict.fromkeys(name for row in loop.rows for name in row))
        if not names:
            continue
        head = tag("tr", *(tag("th", name) for name in names))
        rows = [
            tag("tr", *(tag("td", text_of(row.get(name), short=True)) for name in names))
            for row in loop.rows[:MAX_ROWS]
        ]
        more = tag("p", f"… {len(loop.rows) - MAX_ROWS} more") if len(loop.rows) > MAX_ROWS else None
        over = f"over {loop.variable}, " if loop.variable else ""
        inside = f", iteration {', '.join(map(str, loop.iterations))} around it" if loop.iterations else ""
        summary = tag("summary", f"loop {over}line {loop.line}{inside}: {len(loop.rows)} iterations")
        yield tag("details", summary, tag("table", head, *rows), more)
