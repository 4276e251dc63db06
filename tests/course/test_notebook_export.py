"""A lesson's notebook as HTML: live figures that need no network, widget or kernel."""

from __future__ import annotations

import base64
import gzip
import io
import json
import logging
import re

import nbformat
import numpy as np
import pytest
from PIL import Image

from playground.course.notebook import lesson as notebook_lesson
from playground.course.notebook.lesson import NotebookLesson
from playground.publish.notebook.export import LiveFigures, TerrainHTMLExporter
from playground.publish.notebook.saved import STATE

VIEW = "application/vnd.jupyter.widget-view+json"
STATES = "application/vnd.jupyter.widget-state+json"
KEPT = re.compile(r"<script type=\"application/gzip\" data-terrain-state(?:=\"\")?>([\w+/=]*)</script>")
RUNTIME = re.compile(r'data-terrain-runtime="\w')

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.fixture
def opened(lesson, engine, monkeypatch):
    monkeypatch.setattr(notebook_lesson, "on_engine", lambda work: work(engine))
    return NotebookLesson(lesson)


def notebook_of(widgets, *, saved=True):
    """Return a notebook as Jupyter saves it once cells with these widgets have run."""
    cells, states = [], {}
    for widget in widgets:
        data, _ = widget._repr_mimebundle_()
        output = nbformat.v4.new_output("execute_result", data=data, execution_count=1)
        cells.append(nbformat.v4.new_code_cell("lesson.show()", outputs=[output], execution_count=1))
        state = {name: value for name, value in widget.get_state().items() if name != "picture"}
        picture = base64.b64encode(widget.picture).decode()
        buffers = [{"encoding": "base64", "path": ["picture"], "data": picture}]
        for model_id, model in (
            (widget.model_id, state),
            (widget.layout.model_id, widget.layout.get_state()),
        ):
            states[model_id] = {"model_name": model["_model_name"], "state": model}
        states[widget.model_id]["buffers"] = buffers
    made = nbformat.v4.new_notebook(cells=cells)
    if saved:
        made.metadata["widgets"] = {STATES: {"version_major": 2, "version_minor": 0, "state": states}}
    return nbformat.from_dict(made)


def figures(nb):
    """Return the figures of a notebook without its widgets' state, and the resources."""
    result, resources = LiveFigures().preprocess(nb, {})
    return [cell.outputs[0].data for cell in result.cells], result, resources


def kept(html):
    (text,) = KEPT.findall(html)
    return json.loads(gzip.decompress(base64.b64decode(text)))


def test_a_figure_shows_itself_where_there_are_no_widgets(opened):
    """All of it, the picture first; where scripts are taken away, the picture is what is left."""
    widget = opened.show("land")
    data, _ = widget._repr_mimebundle_()
    assert {VIEW, "text/html", "image/png"} <= data.keys()
    html = data["text/html"]
    assert kept(html) == json.loads(json.dumps(widget.get_state(list(set(STATE) & {*widget.keys}))))
    left = re.sub(r"<script.*?</script>", "", html, flags=re.DOTALL)
    assert re.sub(r"<.*?>", "", left) == "" and left.count("<img") == 1
    (source,) = re.findall(r'src="data:image/webp;base64,([^"]*)"', left)
    shown = np.asarray(Image.open(io.BytesIO(base64.b64decode(source))).convert("RGB"))
    exact = np.asarray(Image.open(io.BytesIO(widget.picture)).convert("RGB"))
    assert np.abs(shown.astype(int) - exact).mean() < 4.0
    assert "http:" not in html and "https:" not in html


def test_what_no_page_can_run_is_a_picture(opened, monkeypatch):
    monkeypatch.setattr(notebook_lesson, "widget_page", lambda *_: "")
    data, _ = opened.show("land")._repr_mimebundle_()
    assert "text/html" not in data and "image/png" in data


def test_an_exported_figure_has_the_values_that_were_saved(opened):
    land, turns = opened.show("land"), opened.show("turns")
    nb = notebook_of([land, turns])
    nb.metadata["widgets"][STATES]["state"][land.model_id]["state"]["values"] = {"height.smoothing": 0.05}
    (first, second), after, resources = figures(nb)
    assert kept(first["text/html"])["values"] == {"height.smoothing": 0.05}
    assert kept(second["text/html"])["values"] == {"frame": 0.0}
    assert VIEW not in first and VIEW not in second
    assert "widgets" not in after.metadata and resources["needs_network"] is False


@pytest.mark.parametrize("saved", [True, False])
def test_the_runtime_of_many_figures_is_there_once(opened, saved):
    nb = notebook_of([opened.show(name) for name in ("land", "turns", "two")], saved=saved)
    shown, _, _ = figures(nb)
    assert [len(RUNTIME.findall(data["text/html"])) for data in shown] == [1, 0, 0]
    assert len({re.findall(r'data-terrain-saved="(\w+)"', data["text/html"])[0] for data in shown}) == 1


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (lambda model: model["state"].pop("page"), "cell 1: the saved figure is damaged: it has no 'page'"),
        (lambda model: model["buffers"][0].update(data="AAAA"), "cannot identify image file"),
    ],
)
def test_a_damaged_figure_is_named_and_stays_as_it_was_shown(opened, damage, sentence, caplog):
    widget = opened.show("land")
    nb = notebook_of([widget])
    damage(nb.metadata["widgets"][STATES]["state"][widget.model_id])
    with caplog.at_level(logging.WARNING):
        ((data,), _, _) = figures(nb)
    (message,) = caplog.messages
    assert sentence in message and message.endswith("; run the cell again") and "\n" not in message
    assert VIEW not in data and kept(data["text/html"])["values"] == widget.values


def test_other_widgets_keep_their_network_and_are_named(opened, caplog):
    nb = notebook_of([opened.show("land")])
    view = {VIEW: {"version_major": 2, "version_minor": 0, "model_id": "other"}}
    output = nbformat.v4.new_output("execute_result", data=view, execution_count=2)
    nb.cells.append(nbformat.v4.new_code_cell("slider", outputs=[output], execution_count=2))
    nb.metadata["widgets"][STATES]["state"]["other"] = {"model_name": "IntSliderModel", "state": {}}
    with caplog.at_level(logging.WARNING):
        (_, other), after, resources = figures(nb)
    assert caplog.messages == ["the outputs of cells 2 are shown by scripts that a network gives"]
    assert VIEW in other and resources["needs_network"]
    rest = after.metadata["widgets"][STATES]["state"]
    assert "other" in rest and not [item for item in rest.values() if "_esm" in item["state"]]


def test_a_figure_in_another_widget_keeps_its_state(opened):
    land, turns = opened.show("land"), opened.show("turns")
    nb = notebook_of([land, turns])
    box = {"children": [f"IPY_MODEL_{turns.model_id}"]}
    nb.metadata["widgets"][STATES]["state"]["box"] = {"model_name": "VBoxModel", "state": box}
    _, after, _ = figures(nb)
    rest = after.metadata["widgets"][STATES]["state"]
    assert {"box", turns.model_id} <= rest.keys() and land.model_id not in rest


@pytest.mark.slow
def test_page_has_script_free_formulas_and_no_requests(opened, caplog):
    nb = notebook_of([opened.show("land")])
    text = "So $\\sigma^2$ and\n\n$$h = \\sqrt{x}$$\n\nand $\\unheard{x}$."
    nb.cells.insert(0, nbformat.v4.new_markdown_cell(text))
    with caplog.at_level(logging.WARNING):
        html, _ = TerrainHTMLExporter().from_notebook_node(nb)
    (message,) = [message for message in caplog.messages if "formula" in message]
    assert message == "the formula \\unheard{x} stays LaTeX: it has no MathML here"
    assert html.count("<math") == 2 and "<msqrt>" in html and "$\\unheard{x}$" in html
    assert not re.search(r"<(?:script|link|img|iframe)[^>]*(?:src|href)=\"http", html)
    assert len(RUNTIME.findall(html)) == 1 and STATES not in html


def test_nbconvert_knows_it_by_name():
    from nbconvert.exporters import get_exporter

    assert get_exporter("terrain_html") is TerrainHTMLExporter
