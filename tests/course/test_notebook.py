"""Lessons as notebooks, run by Jupyter's own client, and as HTML with live figures."""

from __future__ import annotations

import ast
import base64
import gzip
import io
import json
import logging
import re
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import nbformat
import numpy as np
import pytest
from PIL import Image

from playground.course.book.live import widget_page
from playground.course.glossary import terms
from playground.course.library import labels, lesson_files
from playground.course.model import Figure, Prose
from playground.course.notebook import lesson as notebook_lesson
from playground.course.notebook.build import notebook_text
from playground.course.notebook.lesson import NotebookLesson, controls_of, scene_at
from playground.course.read import read_lesson
from playground.course.scenes import BugRegion, broken, draw
from playground.course.traces import Results, results_of
from playground.errors import SketchError
from playground.publish.notebook.engine_thread import release_engine
from playground.publish.notebook.export import LiveFigures, TerrainHTMLExporter
from playground.publish.notebook.saved import STATE

from ..publish.web.node import RUNTIME
from .conftest import SKETCHES

NODE = shutil.which("node")
WIDGET = RUNTIME / "notebook_picture.js"

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.fixture
def opened(lesson, engine, monkeypatch):
    monkeypatch.setattr(notebook_lesson, "on_engine", lambda work: work(engine))
    return NotebookLesson(lesson)


def pixels(png):
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGBA"))


def test_a_figure_s_sliders_act_on_its_picture(opened, lesson, engine):
    widget = opened.show("land")
    (control,) = widget.controls
    assert (control["key"], control["kind"], control["low"], control["high"]) == (
        "height.smoothing",
        "range",
        0.0,
        1.0,
    )
    before = widget.picture
    widget.values = {"height.smoothing": 0.05}
    scene = lesson.named["land"].scene
    expected = engine.render(
        scene.sketch.with_values({"height.smoothing": 0.05}), size=scene.pixels, steps=dict(scene.steps)
    )
    assert widget.picture != before
    np.testing.assert_array_equal(pixels(widget.picture), expected.array)


@pytest.fixture
def shared_engine():
    yield
    release_engine()


def test_a_picture_is_drawn_whichever_thread_asks(lesson, shared_engine):
    """Jupyter answers what is dragged in a thread of its own, while a cell runs in another."""
    opened = NotebookLesson(lesson)
    widget = opened.show("land")
    first = widget.picture

    def drag(value):
        widget.values = {"height.smoothing": value}

    with ThreadPoolExecutor(1) as other:
        other.submit(drag, 0.05).result()
        there = widget.picture
        other.submit(drag, widget.controls[0]["value"]).result()
    np.testing.assert_array_equal(pixels(widget.picture), pixels(first))
    assert there != first and pixels(there)[..., 3].min() == 255
    drag(0.05)
    np.testing.assert_array_equal(pixels(widget.picture), pixels(there))


def test_a_value_out_of_range_is_reported_and_the_picture_stays(opened):
    widget = opened.show("land")
    before = widget.picture
    widget.values = {"height.smoothing": 40.0}
    assert "height.smoothing" in widget.mistake and widget.picture == before
    widget.values = {"height.smoothing": 0.4}
    assert widget.mistake == ""


def test_a_live_figure_is_not_drawn_here_as_well(opened):
    """Its browser draws; the values are there all the same, and can be set."""
    widget = opened.show("land")
    before = widget.picture
    widget.drawn_by = "browser"
    widget.values = {"height.smoothing": 0.05}
    assert widget.picture == before and widget.values == {"height.smoothing": 0.05}


@pytest.mark.slow
def test_a_widget_holds_its_figure(opened, lesson):
    """All of it, so that it runs without a kernel; what no page can run is drawn by the kernel."""
    for name, names in (
        ("land", []),
        ("turns", 6),
        ("smooth", ["0.1", "0.5", "0.9"]),
        ("two", ["even", "uneven"]),
    ):
        widget = opened.show(name)
        held = json.loads(gzip.decompress(base64.b64decode(widget.page)))
        assert set(held) == {"block", "sketches", "library"} and held["library"]["kernels"]
        assert widget.labels == names or len(widget.labels) == names
    assert widget_page(lesson.named["count"]) == ""


def test_a_series_is_dragged_frame_by_frame(opened, lesson, engine):
    widget = opened.show("turns")
    (control,) = widget.controls
    assert (control["high"], control["choices"][2]) == (5.0, "iteration 2")
    widget.values = {"frame": 3}
    np.testing.assert_array_equal(pixels(widget.picture), draw(engine, lesson.named["turns"].scenes[3]).array)


def test_controls_of_each_kind_of_block(lesson, opened):
    kinds = {name: controls_of(lesson.named[name], "en", opened.label) for name in ("turns", "smooth", "two")}
    assert [result[0].kind for result in kinds.values()] == ["range", "range", "choice"]
    assert kinds["smooth"][0].choices == ("0.1", "0.5", "0.9")
    assert scene_at(lesson.named["two"], {"frame": 9.0}) == lesson.named["two"].scenes[1]


def test_the_sun_is_dragged_by_azimuth_and_elevation(opened):
    block = read_lesson("heightfield").named["land"]
    controls = controls_of(block, "fr", labels("book", "fr"))
    assert [(c.key, c.label, c.value, c.low, c.high, c.unit) for c in controls[:2]] == [
        ("light.sun:0", "azimut", 105.0, 0.0, 360.0, "°"),
        ("light.sun:1", "élévation", 22.0, -90.0, 90.0, "°"),
    ]
    assert dict(scene_at(block, {"light.sun:1": 40.0}).values)["light.sun"] == (105.0, 40.0)
    assert dict(scene_at(block, {"light.sun:0": 9.0, "light.sun:1": 8.0}).values)["light.sun"] == (9.0, 8.0)


@pytest.mark.slow
def test_every_slider_of_a_shipped_lesson_can_be_dragged():
    for name in lesson_files():
        for block in read_lesson(name, "en", SKETCHES).blocks:
            if isinstance(block, Figure):
                keys = {c.key.partition(":")[0] for c in controls_of(block, "en", labels("book", "en"))}
                assert keys == set(block.sliders), (name, block.name)


def test_a_saved_notebook_shows_the_picture(opened, lesson, engine):
    data, _ = opened.show("two")._repr_mimebundle_()
    shown = pixels(base64.b64decode(data["image/png"]))
    np.testing.assert_array_equal(shown, draw(engine, lesson.named["two"].scenes[0]).array)


def test_fixing_the_lines_makes_the_correct_picture(opened, lesson, engine):
    from playground.course.scenes import bug_region

    block = lesson.named["fault"]
    region = bug_region(block)
    np.testing.assert_array_equal(opened.show("fault").array, draw(engine, broken(block)).array)
    still = opened.fix("fault", region.broken)
    assert still.verdict == opened.label["not_yet"]
    np.testing.assert_array_equal(still.array, draw(engine, broken(block)).array)
    fixed = opened.fix("fault", region.correct)
    assert fixed.verdict == opened.label["fixed"]
    np.testing.assert_array_equal(fixed.array, draw(engine, block.scene).array)
    assert opened.label["fixed"] in fixed._repr_html_()


def test_a_name_that_is_not_there(opened):
    with pytest.raises(SketchError, match="has no block 'lan'; did you mean 'land'"):
        opened.show("lan")
    with pytest.raises(SketchError, match="measures nothing"):
        opened.measure("land")


def test_the_cells_are_the_lesson(lesson, french, engine):
    for item in (lesson, french):
        cells = json.loads(notebook_text(item, results_of(engine, item)))["cells"]
        code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        text = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")
        assert 'lesson.show("turns")' in code and 'lesson.measure("spread")' in code
        assert "{{" not in text and "lesson:small" not in text
        assert text.count("<details>") == 8
        definition, section = (
            terms()["texel"].definition(item.language),
            labels("book", item.language)["glossary"],
        )
        assert f'[texel](#{section} "{definition}")' in text
        assert text.endswith(f"## {section}\n\n- {definition}")
        assert len({cell["id"] for cell in cells}) == len(cells)
    assert "Pourquoi est-ce sombre" in text and 'language="fr"' in code[0]


@pytest.mark.skipif(NODE is None, reason="needs node")
@pytest.mark.parametrize(
    ("events", "sent"),
    [
        ("0.1 0.2 0.3", [0.1]),  # nothing more until it is answered
        ("0.1 0.2 0.3 picture drawn", [0.1, 0.3]),  # then the newest
        ("0.1 0.2 picture 0.3 drawn", [0.1, 0.3]),  # a picture has one answer, not two
        ("0.1 0.2 picture drawn 0.3 picture mistake 0.4", [0.1, 0.2]),
        ("0.1 0.2 0.1 drawn 0.4", [0.1, 0.4]),  # dragged back to where it was: nothing to wait for
        ("0.1 drawn 0.1 0.4", [0.1, 0.4]),
        ("0.1 0.2 mistake drawn", [0.1, 0.2]),
    ],
)
def test_one_picture_is_requested_at_a_time(events, sent):
    here = Path(__file__).parent
    command = [NODE, str(here / "widget_sends.mjs"), str(WIDGET), *events.split()]
    result = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    assert json.loads(result.stdout) == sent


def test_a_picture_that_fails_ends_the_wait_as_well(lesson, opened, monkeypatch):
    """Whatever is raised: else nothing could be dragged any more."""
    widget = opened.show("land")
    sent = []
    monkeypatch.setattr(widget, "send", sent.append)
    monkeypatch.setattr(widget, "draw", lambda _: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        widget.values = {"height.smoothing": 0.2}
    assert sent == [{"drawn": True}]


@pytest.mark.parametrize("text", ["#define A(x) \\", "b = '\\n';"])
def test_lines_to_fix_are_in_the_cell_as_they_are_in_the_file(lesson, engine, monkeypatch, text):
    """A backslash stays one."""
    region = BugRegion(correct="", broken=text, before="", after="", indent="")
    monkeypatch.setattr("playground.course.notebook.build.bug_region", lambda _: region)
    cells = json.loads(notebook_text(lesson, results_of(engine, lesson)))["cells"]
    (cell,) = [cell for cell in cells if "lesson.fix(" in "".join(cell["source"])]
    call = ast.parse("".join(cell["source"])).body[0].value
    assert ast.literal_eval(call.args[1]) == f"\n{text}\n"


def test_code_in_prose_is_the_translation_s(french, engine):
    """As it stands there: its indentation is what makes it code."""
    code = Prose(1, "    in English", "code", 0, "    en français")
    cells = json.loads(notebook_text(replace(french, blocks=(code,)), Results()))["cells"]
    assert ["".join(cell["source"]) for cell in cells[2:3]] == ["    en français"]


@pytest.mark.slow
def test_a_notebook_runs_from_end_to_end(engine):
    """In a kernel of its own; every cell that shows a picture shows one."""
    import nbformat
    from nbclient import NotebookClient

    for language in ("en", "fr"):
        lesson = read_lesson("diamond_square", language)
        notebook = nbformat.reads(notebook_text(lesson, results_of(engine, lesson)), as_version=4)
        NotebookClient(notebook, timeout=600, kernel_name="python3").execute()
        shows = [cell for cell in notebook.cells if cell.cell_type == "code" and "lesson.show" in cell.source]
        assert len(shows) >= 5
        for cell in shows:
            (output,) = cell.outputs
            picture = pixels(base64.b64decode(output.data["image/png"]))
            assert picture[..., :3].std() > 2.0, cell.source


# ── as HTML ───────────────────────────────────────────────────────────────────


VIEW = "application/vnd.jupyter.widget-view+json"
STATES = "application/vnd.jupyter.widget-state+json"
KEPT = re.compile(r"<script type=\"application/gzip\" data-terrain-state(?:=\"\")?>([\w+/=]*)</script>")
RUNTIME = re.compile(r'data-terrain-runtime="\w')


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
