"""Lessons as notebooks, run by Jupyter's own client."""

from __future__ import annotations

import base64
import io
import json
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from PIL import Image

from playground.errors import SketchError
from playground.lessons.measuring import numbers_of
from playground.lessons.notebook import lesson as notebook_lesson
from playground.lessons.notebook.build import notebook_text
from playground.lessons.notebook.controls import controls_of, scene_at
from playground.lessons.notebook.lesson import NotebookLesson
from playground.lessons.pictures import broken, draw

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


def test_a_picture_is_drawn_whichever_thread_asks(lesson):
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


def test_a_value_out_of_range_is_said_and_the_picture_stays(opened):
    widget = opened.show("land")
    before = widget.picture
    widget.values = {"height.smoothing": 40.0}
    assert "height.smoothing" in widget.mistake and widget.picture == before
    widget.values = {"height.smoothing": 0.4}
    assert widget.mistake == ""


def test_a_series_is_dragged_frame_by_frame(opened, lesson, engine):
    widget = opened.show("turns")
    (control,) = widget.controls
    assert (control["high"], control["choices"][2]) == (5.0, "turn 2")
    widget.values = {"frame": 3}
    np.testing.assert_array_equal(pixels(widget.picture), draw(engine, lesson.named["turns"].scenes[3]).array)


def test_controls_of_each_kind_of_block(lesson, opened):
    kinds = {name: controls_of(lesson.named[name], "en", opened.words) for name in ("turns", "smooth", "two")}
    assert [found[0].kind for found in kinds.values()] == ["range", "range", "choice"]
    assert kinds["smooth"][0].choices == ("0.1", "0.5", "0.9")
    assert scene_at(lesson.named["two"], {"frame": 9.0}) == lesson.named["two"].scenes[1]


def test_a_saved_notebook_shows_the_picture(opened, lesson, engine):
    data, _ = opened.show("two")._repr_mimebundle_()
    shown = pixels(base64.b64decode(data["image/png"]))
    np.testing.assert_array_equal(shown, draw(engine, lesson.named["two"].scenes[0]).array)


def test_mending_the_lines_makes_the_whole_picture(opened, lesson, engine):
    from playground.lessons.faults import around

    block = lesson.named["fault"]
    whole, faulty = around(block)
    np.testing.assert_array_equal(opened.show("fault").array, draw(engine, broken(block)).array)
    still = opened.mend("fault", faulty)
    assert still.word == opened.words["not_yet"]
    np.testing.assert_array_equal(still.array, draw(engine, broken(block)).array)
    mended = opened.mend("fault", whole)
    assert mended.word == opened.words["mended"]
    np.testing.assert_array_equal(mended.array, draw(engine, block.scene).array)
    assert opened.words["mended"] in mended._repr_html_()


def test_a_name_that_is_not_there(opened):
    with pytest.raises(SketchError, match="has no block 'lan'; did you mean 'land'"):
        opened.show("lan")
    with pytest.raises(SketchError, match="measures nothing"):
        opened.measure("land")


def test_the_cells_are_the_lesson(lesson, french, engine):
    for one in (lesson, french):
        cells = json.loads(notebook_text(one, numbers_of(engine, one)))["cells"]
        code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        text = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")
        assert 'lesson.show("turns")' in code and 'lesson.measure("spread")' in code
        assert "{{" not in text and "lesson:small" not in text
        assert text.count("<details>") == 7
        assert len({cell["id"] for cell in cells}) == len(cells)
    assert "Pourquoi est-ce sombre" in text and 'language="fr"' in code[0]


@pytest.mark.slow
def test_a_notebook_runs_from_end_to_end(engine):
    """In a kernel of its own; every cell that shows a picture shows one."""
    import nbformat
    from nbclient import NotebookClient

    from playground.lessons.read import read_lesson

    for language in ("en", "fr"):
        found = read_lesson("diamond_square", language)
        notebook = nbformat.reads(notebook_text(found, numbers_of(engine, found)), as_version=4)
        NotebookClient(notebook, timeout=600, kernel_name="python3").execute()
        shows = [cell for cell in notebook.cells if cell.cell_type == "code" and "lesson.show" in cell.source]
        assert len(shows) >= 5
        for cell in shows:
            (output,) = cell.outputs
            picture = pixels(base64.b64decode(output.data["image/png"]))
            assert picture[..., :3].std() > 2.0, cell.source
