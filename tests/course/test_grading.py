"""Grading: what a class has handed in is read with care, judged fairly, and shown as it is."""

from __future__ import annotations

import ast
import csv
import io
import json
import os
import pickle
import struct
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.cli import main
from playground.course.grading import grade as handler
from playground.course.grading.grade import alike, read_all, values_in_toml
from playground.course.grading.report import (
    GRADED,
    MISSING,
    REFUSED,
    STOPPED,
    Graded,
    Mark,
    Pair,
    ReportContext,
    page,
    table_bytes,
    write_report,
)
from playground.course.grading.submissions import TOO_MANY, find_submissions, lessons_in, read_submission
from playground.course.handout import assignments_of, normalised
from playground.course.library import HERE, in_language, patterns
from playground.course.model import Challenge
from playground.course.read import read_lesson
from playground.course.tasks import answer_text
from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.errors import DataError
from playground.sketch.assign import values_of

from ..browser import MISSING as NO_BROWSER
from ..browser import Browser
from . import handed_in_class as students

FILE = "diamond_square-dimension.glsl"
TEXT = "float kernel(ivec2 texel) { return 0.0; }\n"


def read(path):
    return read_submission(path, [FILE])[FILE]


def zipped(path, *entries, compression=zipfile.ZIP_STORED):
    with zipfile.ZipFile(path, "w", compression) as archive:
        for name, data in entries:
            archive.writestr(name, data)
    return path


# ── reading what was handed in ───────────────────────────────────────────────


@pytest.mark.parametrize(
    "name",
    [
        FILE,
        f"week3/diamond_square-dimension/{FILE}",
        f"Week 3 (my work)/week3/x/{FILE}",
        "diamond_square-dimension (1).glsl",
        "Diamond_Square-Dimension.GLSL.txt",
    ],
)
@pytest.mark.parametrize("as_zip", [False, True], ids=["folder", "zip"])
def test_a_file_is_found_wherever_it_lies(tmp_path, name, as_zip):
    students.write(tmp_path, "Zoë", {name: TEXT, "__MACOSX/._x": "", ".DS_Store": b"\0"}, zipped=as_zip)
    path = tmp_path / ("Zoë.zip" if as_zip else "Zoë")
    assert read(path).text == TEXT
    assert lessons_in(path, ["diamond_square", "fourier"]) == {"diamond_square"}


def test_a_zip_in_the_folder_is_looked_into(tmp_path):
    (tmp_path / "Ana").mkdir()
    zipped(tmp_path / "Ana" / "week3.zip", (f"week3/x/{FILE}", TEXT))
    assert read(tmp_path / "Ana").text == TEXT


@pytest.mark.parametrize("name", ["ana.zip", "ANA.ZIP", "ana.zip.zip"])
def test_a_folder_named_like_a_zip_is_a_folder(tmp_path, name):
    students.write(tmp_path, name, {f"week3.zip/{FILE}": TEXT})
    ((result,), others) = find_submissions(tmp_path, tmp_path / "report")
    assert result.student == name[:-4] and not others
    assert read(result.path).text == TEXT


@pytest.mark.parametrize("name", ["ana", "ana.zip.1", "ana.zip (1)", "ana.txt", "ana.cbz"])
def test_a_zip_by_another_name_is_a_zip(tmp_path, name):
    zipped(tmp_path / name, (FILE, TEXT))
    ((result,), others) = find_submissions(tmp_path, tmp_path / "report")
    assert result.student == name and not others and read(result.path).text == TEXT
    (tmp_path / "class" / "Bea").mkdir(parents=True)
    result.path.rename(tmp_path / "class" / "Bea" / name)
    assert read(tmp_path / "class" / "Bea").text == TEXT


def test_an_unreadable_zip_takes_no_points_from_other_files(tmp_path):
    students.write(tmp_path, "Ana", {FILE: TEXT, "old.zip": "cut short"})
    submission = read_submission(tmp_path / "Ana", [FILE, "other.glsl"])
    assert submission[FILE].text == TEXT and submission[FILE].problem == ""
    assert submission["other.glsl"].problem.startswith("old.zip is no zip that can be read")
    assert not submission["other.glsl"].missing


def test_a_zip_in_a_zip_is_named(tmp_path):
    inner = zipped(tmp_path / "week3.zip", (FILE, TEXT)).read_bytes()
    path = zipped(tmp_path / "Ana.zip", ("week3.zip", inner))
    assert read(path).problem == "week3.zip is a zip in a zip, which is not looked into; hand in its folder"


def test_outermost_of_several_files_is_graded_and_others_noted(tmp_path):
    students.write(tmp_path, "Ana", {FILE: TEXT, f"old/{FILE}": TEXT})
    assert read(tmp_path / "Ana").note == ""
    students.write(tmp_path, "Ana", {f"old/{FILE}": "// earlier"})
    result = read(tmp_path / "Ana")
    assert result.text == TEXT and result.note == f"2 files of this name were handed in; graded: {FILE}"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_texts_as_editors_write_them(tmp_path, encoding):
    data = "// été\r\nfloat x;\r\n".encode(encoding)
    students.write(tmp_path, "Ana", {FILE: data})
    assert read(tmp_path / "Ana").text == "// été\nfloat x;\n"


def link(info):
    info.external_attr = 0o120777 << 16
    return info


@pytest.mark.always
@pytest.mark.parametrize(
    ("entries", "sentence"),
    [
        ([(f"../{FILE}", TEXT)], "leads out of its folder"),
        ([(FILE, TEXT), ("/etc/x", "")], "leads out of its folder"),
        ([(link(zipfile.ZipInfo(FILE)), "/etc/passwd")], "is a link or a device"),
        ([(FILE, TEXT), ("b", bytes(2**27))], "as a zip bomb does"),
        ([(FILE, bytes(2**21))], "a text of at most 1 is read"),
        ([(FILE, b"\xff\x00")], "is not UTF-8 text"),
        ([(FILE, b"a\0b")], "holds zero bytes"),
        ([(f"{n}.txt", "") for n in range(4001)], "more than 4000 files"),
    ],
)
def test_a_zip_that_does_harm_is_refused_in_a_sentence(tmp_path, entries, sentence):
    result = read(zipped(tmp_path / "Ana.zip", *entries, compression=zipfile.ZIP_DEFLATED))
    assert sentence in result.problem and not result.text and not result.missing


def test_a_zip_that_lies_about_a_size_is_not_believed(tmp_path):
    path = zipped(tmp_path / "Ana.zip", (FILE, b"x" * 2**21), compression=zipfile.ZIP_DEFLATED)
    data = path.read_bytes()
    assert data.count((2**21).to_bytes(4, "little")) == 2  # in the entry, and in the list
    path.write_bytes(data.replace((2**21).to_bytes(4, "little"), (9).to_bytes(4, "little")))
    assert read(path).problem


def test_oversized_zip64_directory_is_refused_before_reading(tmp_path):
    path = tmp_path / "Ana.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for number in range(40):
            (info := zipfile.ZipInfo(f"{number}.txt")).comment = bytes(60_000)
            archive.writestr(info, "")
    data = path.read_bytes()
    body, (length, start) = data[:-22], struct.unpack("<LL", data[-10:-2])
    assert length > 2**21 and len(data) == start + length + 22
    large = struct.pack("<4sQHHLLQQQQ", b"PK\6\6", 44, 45, 45, 0, 0, 40, 40, length, start)
    locator = struct.pack("<4sLQL", b"PK\6\7", 0, len(body), 1)
    end = struct.pack("<4sHHHHLLH", b"PK\5\6", 0, 0, 1, 1, 46, start, 0)
    path.write_bytes(body + large + locator + end)
    assert len(zipfile.ZipFile(path).namelist()) == 40  # Python believes zip64, not the end record
    assert "more than 4000 files" in read(path).problem


def test_what_is_no_zip(tmp_path):
    (tmp_path / "Ana.zip").write_bytes(b"not a zip")
    assert "is no zip that can be read" in read(tmp_path / "Ana.zip").problem
    (tmp_path / "Bea").mkdir()
    assert read(tmp_path / "Bea").missing


@pytest.mark.skipif(os.name != "posix", reason="links, pipes and devices are POSIX's")
def test_links_and_pipes_are_not_read(tmp_path):
    (tmp_path / "secret.glsl").write_text("secret")
    (tmp_path / "Ana").mkdir()
    (tmp_path / "Ana" / FILE).symlink_to(tmp_path / "secret.glsl")
    assert "is a link" in read(tmp_path / "Ana").problem
    (tmp_path / "Bea").symlink_to(tmp_path / "Ana", target_is_directory=True)
    (tmp_path / "Cem").mkdir()
    os.mkfifo(tmp_path / "Cem" / FILE)
    assert "a pipe" in read(tmp_path / "Cem").problem
    (tmp_path / "Dan").mkdir()
    (tmp_path / "Dan" / "out").symlink_to(tmp_path / "Cem", target_is_directory=True)
    assert read(tmp_path / "Dan").missing
    result, others = find_submissions(tmp_path, tmp_path / "report")
    assert [item.student for item in result] == ["Ana", "Cem", "Dan"]
    assert others == ["'Bea' is no folder and no zip", "'secret.glsl' is no folder and no zip"]


@pytest.mark.skipif(os.name != "posix", reason="a file of a gigabyte takes no room")
def test_a_text_of_a_gigabyte_is_not_read(tmp_path):
    (tmp_path / "Ana").mkdir()
    with (tmp_path / "Ana" / FILE).open("wb") as file:
        file.truncate(2**30)
    assert "has 1024 MiB" in read(tmp_path / "Ana").problem


def test_students_go_by_the_names_of_what_they_handed_in(tmp_path):
    for name in ("李雷", "Zoë", "A & B"):
        (tmp_path / name).mkdir()
    zipped(tmp_path / "Zoë.zip", ("x", ""))
    (tmp_path / "report").mkdir()
    result, _ = find_submissions(tmp_path, tmp_path / "report")
    assert {item.student for item in result} == {"李雷", "Zoë", "Zoë.zip", result[0].student}
    with pytest.raises(DataError, match="no such folder"):
        find_submissions(tmp_path / "nowhere", tmp_path)


def test_no_two_students_have_one_name(tmp_path):
    for name in ("Anna", "Ben (2)"):
        (tmp_path / name).mkdir()
    for name in ("Anna.zip", "Anna.zip.zip", "Ben (2).zip"):
        zipped(tmp_path / name, (FILE, name))
    result, _ = find_submissions(tmp_path, tmp_path / "report")
    names = {item.path.name: item.student for item in result}
    assert names == {
        "Anna": "Anna",
        "Anna.zip": "Anna.zip",
        "Anna.zip.zip": "Anna.zip (2)",
        "Ben (2)": "Ben (2)",
        "Ben (2).zip": "Ben (2).zip",
    }
    assert len(read_all(result, [])) == 5


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a name is always text")
def test_names_whose_wrong_bytes_look_the_same_are_numbered(tmp_path):
    for name in (b"Zo\xeb", b"Zo\xec"):
        (tmp_path / os.fsdecode(name)).mkdir()
    (tmp_path / "Zo\ufffd (2)").mkdir()
    result, _ = find_submissions(tmp_path, tmp_path / "report")
    assert sorted(item.student for item in result) == ["Zo\ufffd", "Zo\ufffd (2)", "Zo\ufffd (3)"]


def test_an_earlier_report_is_no_student(tmp_path):
    (tmp_path / "Ana").mkdir()
    write_report(tmp_path / "last week", [graded_as("Ana")], {"x-y": "y"}, "en", "llvmpipe")
    result, others = find_submissions(tmp_path, tmp_path / "report")
    assert [item.student for item in result] == ["Ana"]
    assert others == ["'last week' is an earlier report of grades"]


# ── values ───────────────────────────────────────────────────────────────────

TOML = """[[pass]]
name = "height"
set  = { smoothing = 0.3, "raw.seed" = 4 }
[view.set]
sun = { azimuth = 3 }
"""


def test_only_the_values_that_are_asked_for_are_taken():
    sliders = ["height.smoothing", "height.raw.seed", "view.sun", "height.corners", "size"]
    values = values_in_toml(TOML, sliders)
    assert values == {"height.smoothing": 0.3, "height.raw.seed": 4, "view.sun": {"azimuth": 3}}
    assert values_in_toml(TOML.replace('"raw.seed"', "raw.seed"), ["height.raw.seed"]) == {
        "height.raw.seed": 4
    }


@pytest.mark.always
@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ('x = "../../other/y"', "a file outside of its folder"),
        ('x = "/dev/zero"', "a file outside of its folder"),
        ('[a]\nx = ["C:\\\\secret.png"]', "a file outside of its folder"),
        ("x = ", "is no TOML"),
        ("a = " + "[" * 9000, "TOML|nest"),
        (TOML.replace("0.3", "nan"), "is not a number"),
        (TOML.replace("0.3", "[[1]]"), "is not a number"),
        ("#" * 200_000, "longer than any sketch"),
    ],
)
def test_a_toml_that_is_wrong_or_does_harm_is_refused(text, sentence):
    with pytest.raises(DataError, match=sentence):
        values_in_toml(text, ["height.smoothing"])


# ── what is alike ────────────────────────────────────────────────────────────


def test_texts_are_alike_but_for_white_space_and_comments():
    text = "float a = 1.0; // mine\n/* of\nmine */ float b=a;"
    assert normalised(text) == normalised("float  a=1.0;\nfloat b = a ;\n")
    assert normalised("int ab;") != normalised("int a b;")
    names = alike({"Ana": text, "Bea": "float a=1.0; float b=a;", "Cem": "x", "Dan": "y", "Eva": "y"}, "y")
    assert names == {"Ana": ("Bea",), "Bea": ("Ana",)}


# ── the table and the page ───────────────────────────────────────────────────

NAMES = ["=1+1", "+SUM(A1)", "@x", "-2", "\tx", '"quoted", with; marks', "<script>alert(1)</script>", "Zoë"]


def graded(name, points=1.5):
    mark = Mark(points, 2, GRADED, ("`a` is <b>.\n  quoted <i>",), (Pair(b"m", b"w"),), same_as=("<u>",))
    return Graded(name, {"x-y": mark})


def test_no_name_becomes_csv_formula_and_all_names_round_trip():
    data = table_bytes([graded(name) for name in NAMES], ["x-y"], "en")
    assert data.startswith(b"\xef\xbb\xbf")
    rows = list(csv.reader(io.StringIO(data.decode("utf-8-sig"), newline="")))
    assert rows[0] == ["student", "x-y", "total", "of"]
    assert [row[1:] for row in rows[1:]] == [["1.5", "1.5", "2"]] * len(NAMES)
    assert [row[0].removeprefix("'") for row in rows[1:]] == NAMES
    assert not any(row[0].startswith(("=", "+", "-", "@", "\t")) for row in rows)


def test_a_french_table_is_what_a_french_spreadsheet_opens():
    data = table_bytes([graded(name) for name in NAMES], ["x-y"], "fr")
    assert data.startswith(b"\xef\xbb\xbf")
    rows = list(csv.reader(io.StringIO(data.decode("utf-8-sig"), newline=""), delimiter=";"))
    assert rows[0] == ["élève", "x-y", "total", "sur"]
    assert [row[1:] for row in rows[1:]] == [["1,5", "1,5", "2"]] * len(NAMES)
    assert [row[0].removeprefix("'") for row in rows[1:]] == NAMES


def test_all_text_of_the_page_is_escaped():
    text = page([graded(name) for name in NAMES], {"x-y": "<em>"}, setting())
    for markup in ("<script>alert", "<b>.", "<i>", "<u>", "<em>"):
        assert markup not in text
    assert "<code>a</code> is &lt;b&gt;." in text and "&lt;script&gt;alert(1)" in text
    assert "1,5 / 2" in page([graded("x")], {"x-y": "y"}, replace(setting(), language="fr"))


def graded_as(name, points=1.5):
    return Graded(name, {"x-y": Mark(points, 2, GRADED)})


def test_a_driver_s_quotes_end_where_they_end():
    said = "1:2: `hieght' undeclared; `hieght` is not declared"
    text = page([Graded("Ana", {"x": Mark(0.0, 1, GRADED, (said,))})], {"x": "Lesson, 1"}, setting())
    assert "1:2: <code>hieght</code> undeclared; <code>hieght</code> is not declared" in text


def test_grading_problems_are_french_in_french_report(tmp_path):
    students.write(tmp_path, "Ana", {FILE: b"\xff\x00"})
    problem = read(tmp_path / "Ana").problem
    assert problem == f"{FILE} is not UTF-8 text; save the file as UTF-8" == in_language(problem, "en")
    french = f"{FILE} n’est pas un texte UTF-8\xa0; enregistrez le fichier en UTF-8"
    assert in_language(problem, "fr") == in_language(pickle.loads(pickle.dumps(problem)), "fr") == french
    (tmp_path / "Cem.zip").write_bytes(b"none")
    short = in_language(read(tmp_path / "Cem.zip").problem, "fr")
    assert short.startswith("Cem.zip n’est pas un zip lisible"), "a sentence in a sentence"


def test_every_grading_message_has_a_french_one():
    names = patterns("fr")
    used = set()
    for file in HERE.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Said":
                (said,) = node.args
                used.add(TOO_MANY if isinstance(said, ast.Name) else ast.literal_eval(said))
    assert used - {"{name} {what}"} == set(names)


def test_corrected_grades_are_kept_when_report_is_rewritten(tmp_path):
    def write(points):
        return write_report(tmp_path, [graded_as("Ana", points)], {"x-y": "y"}, "en", "llvmpipe")[1]

    table, first, second = (tmp_path / name for name in ("grades.csv", "grades (1).csv", "grades (2).csv"))
    assert write(1.5) is None and write(0.5) is None and not first.exists()
    table.write_text("corrected")
    assert write(1.0) == first and first.read_text() == "corrected"
    assert "Ana,1,1,2" in table.read_text("utf-8-sig")
    assert write(2.0) is None and not second.exists()
    table.write_text("corrected again")
    assert write(2.0) == second and first.read_text() == "corrected"


def setting():
    return ReportContext(
        "en", "llvmpipe", lambda data: f"pictures/{data.decode()}.webp", lambda data: (160, 90)
    )


# ── a whole class ────────────────────────────────────────────────────────────


def run(*arguments):
    return main(["lesson", "grade", *map(str, arguments)])


def test_mistakes_of_the_teacher_are_sentences(tmp_path, capsys):
    assert run(tmp_path / "nowhere") == 2
    assert "there is no such folder" in capsys.readouterr().err
    (tmp_path / "in" / "Ana").mkdir(parents=True)
    assert run(tmp_path / "in", "-o", tmp_path / "report") == 2
    assert "name the lessons" in capsys.readouterr().err
    assert run(tmp_path / "in", "--lesson", "diamond_sqare") == 2
    assert "did you mean 'diamond_square'" in capsys.readouterr().err
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("mine")
    assert run(tmp_path / "in", "--lesson", "diamond_square", "-o", tmp_path / "mine") == 2
    assert "is no report of grades" in capsys.readouterr().err


@pytest.fixture(scope="module")
def one():
    return next(x for x in assignments_of([read_lesson("diamond_square")]) if x.task.name == "dimension")


@pytest.fixture(scope="module")
def class_of_20(tmp_path_factory, one):
    """Write a class of twenty, grade it, and return its report's folder and what was printed."""
    folder = tmp_path_factory.mktemp("class")
    handed, report = folder / "in", folder / "report"
    (handed / "Nothing").mkdir(parents=True)
    secret = handed / "Right 1" / "secret.glsl"
    harm = students.hostile(one, secret)
    texts = {
        "Right 1": students.right(one),
        "Right 2": students.right(one).replace("// by myself", "/* copied */\n\n"),
        "Right 3": students.right(one) + "float own() { return 1.0; }\n",
        "=1+1": students.right(one) + "int x;",
        "Nearly 1": students.nearly(one),
        "Nearly 2": students.nearly(one).replace("0.97", "1.001"),
        "Handed back": students.untouched(one),
        "Visible only": students.around(students.right(one), "return seed == 18 ? given() : 0.0;"),
        "Wrong": students.wrong(one),
        "Endless": students.endless(one),
        **{f"Hostile {name}": text for name, text in harm.items()},
        "<img src=x> 李雷": "",
        "Zoë": students.right(one).replace("by myself", "moi-même"),
    }
    for number, (name, text) in enumerate(texts.items()):
        zipped_ = number % 2 == 1
        path = f"week3/{one.name}/{one.file}"
        students.write(handed, name, {path: text}, zipped=zipped_)
    secret.parent.mkdir(exist_ok=True)
    secret.write_text(students.right(one))
    write_png(secret.with_suffix(".png"), np.full((4, 4, 3), 255, np.uint8))
    zipped(handed / "Bomb.zip", (one.file, TEXT), ("b", bytes(2**27)), compression=zipfile.ZIP_DEFLATED)
    stdout, sys.stdout = sys.stdout, io.StringIO()
    try:
        assert run(handed, "-o", report, "--json") == 0
        printed = json.loads(sys.stdout.getvalue())
    finally:
        sys.stdout = stdout
    return handed, report, {row["student"]: row for row in printed}


@pytest.mark.slow
def test_a_class_of_twenty_gets_the_points_that_it_deserves(class_of_20, one):
    _, report, rows = class_of_20
    marks = {student: row["exercises"][one.name] for student, row in rows.items()}
    points = {student: mark["points"] for student, mark in marks.items()}
    assert len(rows) == 20
    rights = ("Right 1", "Right 2", "Right 3")
    assert {student for student, of in points.items() if of == 2} == {*rights, "=1+1", "Zoë"}
    assert points["Visible only"] == 1  # the check whose values are hidden is not deceived
    assert all(of == 0 for student, of in points.items() if student.startswith(("Hostile", "Nearly")))
    assert marks["Right 1"]["same_as"] == ["Right 2", "Zoë"] and marks["Right 3"]["same_as"] == []
    assert marks["Handed back"]["same_as"] == []
    assert marks["Nothing"]["outcome"] == MISSING
    assert marks["Endless"]["outcome"] == STOPPED and "endless loop" in marks["Endless"]["sentences"][0]
    assert marks["Bomb"]["outcome"] == REFUSED and "zip bomb" in marks["Bomb"]["sentences"][0]
    assert (
        marks["Wrong"]["sentences"][0].startswith(f"{one.file}:")
        and "hieght" in marks["Wrong"]["sentences"][0]
    )
    outside = marks["Hostile model"], marks["Hostile other"]
    assert all("lies outside" in mark["sentences"][0] for mark in outside)
    assert "a file outside of its folder" in marks["Hostile picture"]["sentences"][0]
    assert all(mark["sentences"] for mark in marks.values())
    table = csv.DictReader((report / "grades.csv").read_text("utf-8-sig").splitlines())
    assert {row["student"]: row[one.name] for row in table}["'=1+1"] == "2"


@pytest.mark.slow
def test_the_same_class_in_another_order_gets_the_same_points(class_of_20, one, tmp_path, capsys):
    handed, _, rows = class_of_20
    again = tmp_path / "in"
    again.mkdir()
    some = ["Right 1", "Nearly 2", "Visible only", "Hostile macros", "Handed back", "Wrong"]
    for number, name in enumerate(some):
        path = handed / name if (handed / name).is_dir() else handed / f"{name}.zip"
        path.copy(again / f"{9 - number}") if hasattr(path, "copy") else copied(path, again / f"{9 - number}")
    assert run(again, "-o", tmp_path / "report", "--json") == 0
    result = {row["student"]: row["points"] for row in json.loads(capsys.readouterr().out)}
    assert {name: result[str(9 - n)] for n, name in enumerate(some)} == {
        name: rows[name]["points"] for name in some
    }


@pytest.mark.slow
def test_no_texel_of_another_s_work_is_left_in_a_picture(ctx, monkeypatch):
    """A kernel that writes nothing has no points, however right what was drawn before it is.

    Kernels may not discard; a word that the preprocessor puts together is not seen by that rule.
    """
    assignment = next(x for x in assignments_of([read_lesson("first_height")]) if x.task.name == "wave")
    made = []

    def engine(*, software, device, cache_bytes, notice):
        made.append(Engine(ctx, cache_bytes=2**21, notice=notice))  # full after two works
        made[0].runner.pool.limit = 2**26
        return made[0]

    monkeypatch.setattr(handler, "open_engine", engine)
    judge = handler.open_service(Silent(), handler.Options(("first_height",), "en")).answer
    right = answer_text(assignment.task)
    for number in range(3):
        assert judge(handler.Request(assignment.name, f"{right}\n// {number}\n")).is_full
        varied = students.around(right, f"return given() + 1e-9 * {number}.0;")
        assert judge(handler.Request(assignment.name, varied)).is_full
    assert len(made[0].runner.pool) > 0, "there are textures to be used again, with right heights in them"
    nothing = students.around(
        right, "if (texel.x >= 0) JOINED(dis, card); return given();", "#define JOINED(a, b) a##b"
    )
    mark = judge(handler.Request(assignment.name, nothing))
    made[0].release()
    assert mark.points == 0.0 and "differs by" in mark.sentences[0]


@pytest.mark.slow
def test_a_challenge_has_a_score_in_its_column_and_no_points(any_engine, monkeypatch):
    """Its picture has 100, what is handed out 0, between them it grows with the slider that was moved."""
    assignment = next(
        x for x in assignments_of([read_lesson("slopes", "fr")]) if isinstance(x.task, Challenge)
    )
    monkeypatch.setattr(handler, "open_engine", lambda **choice: any_engine)
    judge = handler.open_service(Silent(), handler.Options(("slopes",), "fr")).answer
    begin, expected = (
        values_of(scene.sketch)["light.sun"] for scene in (assignment.task.begin, assignment.task.scene)
    )
    half = tuple((a + b) / 2 for a, b in zip(begin, expected, strict=True))
    nearer = students.with_values(assignment, {"light.sun": half})
    texts = [None, students.right(assignment), nearer, students.untouched(assignment), "set = {"]
    marks = [judge(handler.Request(assignment.name, text)) for text in texts]
    answer, solved, near, started, wrong = marks
    assert answer.score == solved.score == 100.0 and started.score == wrong.score == 0.0
    assert 0.0 < near.score < 100.0
    assert [mark.is_full for mark in marks] == [True, True, near.score >= assignment.task.goal, False, False]
    assert {(mark.points, mark.of) for mark in marks} == {(0.0, 0)} and wrong.outcome == REFUSED
    assert solved.sentences == (f"Score 100 sur 100\xa0; réussi à partir de {assignment.task.goal}.",)
    row = Graded("Ana", {"lesson-exercise": Mark(1.5, 2, GRADED), assignment.name: replace(near, pairs=())})
    table = table_bytes([row], list(row.marks), "en").decode("utf-8-sig").splitlines()
    assert table[1] == f"Ana,1.5,{int(near.score)},1.5,2"
    assert f"score {int(near.score)} sur 100" in page(
        [row], dict.fromkeys(row.marks, "x"), replace(setting(), language="fr")
    )


class Silent:
    """A parent that is told nothing."""

    def report(self, progress):
        pass


def copied(source, target):
    import shutil

    if source.is_dir():
        shutil.copytree(source, target)
    else:
        shutil.copyfile(source, target.with_name(f"{target.name}.zip"))


@pytest.mark.slow
@pytest.mark.skipif(bool(NO_BROWSER), reason=NO_BROWSER or "there is one")
def test_the_report_in_a_browser(class_of_20, tmp_path):
    _, report, rows = class_of_20
    with Browser(tmp_path) as browser:
        browser.open((report / "index.html").as_uri())
        browser.wait("document.getElementById('shown').textContent === '20 of 20 shown'")
        assert browser.run("return [...document.images].every(i => (i.loading = 'eager', true))")
        browser.wait("[...document.images].every(i => i.complete && i.naturalWidth > 0)")
        assert browser.run("return document.documentElement.scrollWidth <= innerWidth")
        first = "document.querySelector('.student:not([hidden]) h2 bdi').textContent"
        choose = "const tool = document.getElementById(arguments[0]); tool.value = arguments[1];"
        choose += " tool.dispatchEvent(new Event('input'))"
        browser.run(choose, "sort", "most")
        assert rows[browser.run(f"return {first}")]["points"] == 2
        browser.run(choose, "find", "IMG")
        assert browser.run(f"return {first}") == "<img src=x> 李雷"
        assert browser.log() == []
        Path(os.environ.get("REPORT_PICTURE", tmp_path / "report.png")).write_bytes(browser.picture())
