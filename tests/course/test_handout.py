"""Hand-outs: what students get opens, begins as the exercise does, and holds no answer."""

from __future__ import annotations

import io
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

from playground.cli import main
from playground.course.handout import assignments_of, student_files
from playground.course.read import read_lesson, read_lessons
from playground.course.tasks import Work, answer_text, scene_of
from playground.sketch.find import unpacked_beside

from ..loading import load

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def handed_out(tmp_path_factory):
    """Write the hand-out of a lesson, with its hints, and return its path."""
    path = tmp_path_factory.mktemp("handout") / "week3.zip"
    assert main(["lesson", "handout", "diamond_square", "--hints", "-o", str(path)]) == 0
    return path


@pytest.fixture(scope="module")
def one():
    return drawn_assignments("diamond_square")[0]


def drawn_assignments(lesson):
    return [each for each in assignments_of([read_lesson(lesson)]) if each.sketch_file]


def test_the_zip_opens_in_the_window_as_the_exercise_begins(handed_out, one, tmp_path, engine):
    zipped = tmp_path / "week3.zip"
    zipped.write_bytes(handed_out.read_bytes())
    sketch_file, _ = unpacked_beside(zipped)
    folder = tmp_path / "week3"
    first = drawn_assignments("diamond_square")[0]
    assert sketch_file == folder / first.name / first.sketch_file
    sketch_file = folder / one.name / "sketch.toml"
    assert load(folder / one.opens).file == str(sketch_file)
    kernel = folder / one.name / one.file
    assert one.starter.splitlines()[0] in kernel.read_text()
    begin = scene_of(one.task, Work(one.starter))
    shown = engine.render(load(sketch_file), size=(160, 90)).array
    expected = engine.render(begin.sketch, size=(160, 90)).array
    np.testing.assert_array_equal(shown, expected)
    kernel.write_text(answer_text(one.task))  # its includes are found from there, too
    changed = engine.render(load(sketch_file), size=(160, 90)).array
    assert (changed != shown).any()


def test_every_exercise_of_the_course_has_a_sketch_that_loads(tmp_path):
    assignments = assignments_of(read_lessons())
    assert len({item.name for item in assignments}) == len(assignments) > 0
    for item in assignments:
        folder = tmp_path / item.name
        for name, data in student_files(item).items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(data)
        assert (folder / item.file).is_file()
        if item.opens:
            sketch = load(tmp_path / item.opens)
            assert sketch.shots == () and sketch.presets == ()


@pytest.mark.parametrize("lesson", ["diamond_square", "first_height"])
def test_no_answer_is_in_the_zip(lesson, handed_out, tmp_path):
    """Neither a line of a model answer that its starter lacks, nor of a solution, nor of an earlier step."""
    path = handed_out
    if lesson != "diamond_square":
        path = tmp_path / "week0.zip"
        assert main(["lesson", "handout", lesson, "-o", str(path)]) == 0
    with zipfile.ZipFile(path) as archive:
        data = path.read_bytes() + b"\n".join(archive.read(name) for name in archive.namelist())
    spaceless = re.sub(r"\s+", "", re.sub(r"<[^>]+>", "", data.decode("utf-8", "replace")))
    assignments = drawn_assignments(lesson)
    value = re.sub(r"\s+", "", "\n".join(item.task.ask for item in assignments))
    for item in assignments:
        answer = set(answer_text(item.task).splitlines()) - set(item.starter.splitlines())
        secrets = [line for line in answer if not line.startswith("//")]
        secrets += re.split(r"[.`$*\[\]]+", item.task.solution)
        secrets = [re.sub(r"\s+", "", secret) for secret in secrets]
        secrets = [x for x in secrets if len(x) > 15 and x not in value and not re.fullmatch(r"[\w/.]+", x)]
        assert secrets
        assert [secret for secret in secrets if secret in spaceless] == [], item.name
    asked = re.sub(r"\s+", "", assignments[0].task.ask)
    assert max(re.split(r"[`$*\[\]\\]+", asked), key=len) in spaceless  # the search finds what is there


def test_the_page_has_every_exercise_and_needs_no_network(handed_out):
    with zipfile.ZipFile(handed_out) as archive:
        page = archive.read("week3/exercises.html").decode()
        readme = archive.read("week3/README.txt").decode()
    tasks = [block for block in read_lesson("diamond_square").blocks if hasattr(block, "ask")]
    asked = sum(hasattr(block, "sliders") or bool(getattr(block, "of", None)) for block in tasks)
    assert page.count('class="task"') == asked
    assert "data:image/webp" in page and "Hint" in page
    assert not re.search(r'(?:src|href)="(?!data:|https://|#)', page) and "<script" not in page
    assert "playground live diamond_square-dimension" in readme


def test_the_same_lessons_give_the_same_bytes(handed_out, tmp_path):
    again = tmp_path / "week3.zip"
    assert main(["lesson", "handout", "diamond_square", "--hints", "-o", str(again)]) == 0
    assert again.read_bytes() == handed_out.read_bytes()


def test_in_french_without_hints(tmp_path):
    path = tmp_path / "semaine 3 (été).zip"
    assert main(["lesson", "handout", "diamond_square", "--lang", "fr", "-o", str(path)]) == 0
    with zipfile.ZipFile(io.BytesIO(path.read_bytes())) as archive:
        page = archive.read("semaine-3-été/exercises.html").decode()
    assert 'lang="fr"' in page and "Exercices" in page and "Indice" not in page


WHEEL = "terrain_shader_playground-2.5.0-py3-none-any.whl"


@pytest.fixture
def wheel(tmp_path):
    with zipfile.ZipFile(tmp_path / WHEEL, "w") as archive:
        archive.writestr(
            "terrain_shader_playground-2.5.0.dist-info/METADATA", "Name: terrain-shader-playground"
        )
    return tmp_path / WHEEL


@pytest.mark.parametrize(("lang", "line"), [("en", ""), ("fr", "In room 3, or: pip install {me} \\n")])
def test_a_wheel_and_the_line_of_the_teacher_are_in_the_readme(tmp_path, wheel, line, lang):
    path, more = tmp_path / "a.zip", ["--wheel", str(wheel), "--install", line, "--lang", lang]
    assert main(["lesson", "handout", "first_height", "-o", str(path), *more]) == 0
    with zipfile.ZipFile(path) as archive:
        assert archive.read(f"a/{WHEEL}") == wheel.read_bytes()
        step = re.search(r"^1\. (.*?)^2\. ", archive.read("a/README.txt").decode(), re.DOTALL | re.MULTILINE)[
            1
        ]
    assert WHEEL in step and (f"python -m pip install {WHEEL}" in step) == (not line)
    assert line.strip() in step


def test_a_damaged_wheel_is_refused_before_anything_is_drawn(tmp_path, wheel, capsys):
    for data in (b"no zip", wheel.read_bytes().replace(b"METADATA", b"metadata")):
        wheel.write_bytes(data)
        output = tmp_path / "a.zip"
        assert main(["lesson", "handout", "diamond_square", "--wheel", str(wheel), "-o", str(output)]) == 2
        assert f"{WHEEL}: the file is damaged" in capsys.readouterr().err and not output.exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["diamond_sqare"], "did you mean 'diamond_square'"),
        (["diamond_square", "-o", "week3.tar"], "ending in .zip"),
        (["diamond_square", "-o", "nowhere/week3.zip"], "no folder 'nowhere'"),
        (["diamond_square", "--wheel", "playground.whl"], "there is no such file"),
        (["diamond_square", "--wheel", __file__], "is not named as a wheel of the playground"),
    ],
)
def test_mistakes_are_sentences(arguments, sentence, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["lesson", "handout", *arguments]) == 2
    assert sentence in capsys.readouterr().err
    assert list(Path().iterdir()) == []
