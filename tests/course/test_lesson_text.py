"""Texts of lessons in the window: Markdown in runs, lines broken between words, formulas on the baseline."""

from __future__ import annotations

import json
import os
import random
import string
import subprocess
import sys
from dataclasses import asdict, replace
from pathlib import Path

import moderngl
import numpy as np
import pytest

from playground.course.typeset import Extent, Run, broken, can_set, label_text, parts_of, set_formula
from playground.course.window.page import Textures
from playground.course.window.progress import (
    MIN_WIDTH,
    Attempt,
    Progress,
    open_progress,
    read_progress,
    write_progress,
)

from ..cases import each

INK = 0xFFEEEEEE
ROOT = Path(__file__).resolve().parents[2]


def ruler(run: Run) -> Extent:
    """Measure as a font would whose letters are all one wide."""
    return Extent(4.0 if run.formula else float(len(run.text)), 0.8, 0.2)


def texts(lines) -> list[str]:
    return ["".join(positioned.run.text for positioned in line.runs) for line in lines]


def test_styles_links_and_formulas_are_runs_of_their_own():
    (part,) = parts_of("A **bold** *word*, `x(1)` at [a *place*](lesson:fourier) of $h^2$.")
    result = [(run.text, run.bold, run.italic, run.code, run.formula, run.link) for run in part.runs]
    assert result == [
        ("A ", False, False, False, False, ""),
        ("bold", True, False, False, False, ""),
        (" ", False, False, False, False, ""),
        ("word", False, True, False, False, ""),
        (", ", False, False, False, False, ""),
        ("x(1)", False, False, True, False, ""),
        (" at ", False, False, False, False, ""),
        ("a ", False, False, False, False, "lesson:fourier"),
        ("place", False, True, False, False, "lesson:fourier"),
        (" of ", False, False, False, False, ""),
        ("h^2", False, False, False, True, ""),
        (".", False, False, False, False, ""),
    ]


def test_lists_are_marked_and_indented_by_their_depth():
    parts = parts_of("1. one\n2. two\n   - inner\n\nafter")
    result = [(part.mark, part.indent, label_text("".join(run.text for run in part.runs))) for part in parts]
    assert result == [("1.", 1, "one"), ("2.", 1, "two"), ("•", 2, "inner"), ("", 0, "after")]


def test_a_table_keeps_its_cells_and_which_columns_are_numbers():
    (part,) = parts_of("| a | b |\n|:--|--:|\n| one | 2 |\n| three | $4$ |")
    assert part.kind == "table" and part.numbers == (False, True)
    cells = [["".join(run.text for run in cell) for cell in row] for row in part.rows]
    assert cells == [["a", "b"], ["one", "2"], ["three", "4"]]
    assert part.rows[0][0][0].bold and part.rows[2][1][0].formula


def test_a_formula_of_its_own_and_code_stand_alone():
    formula, code = parts_of("$$\n\\frac{a}{b}\n$$\n\n```\nfloat x;\n  y();\n```")
    assert (formula.kind, formula.runs[0].text, formula.runs[0].alone) == ("formula", "\\frac{a}{b}", True)
    assert (code.kind, code.runs[0].text, code.runs[0].alone) == ("code", "float x;\n  y();", True)


def test_lines_break_at_blanks_and_nowhere_else():
    assert texts(broken((Run("one two three"),), 8, ruler)) == ["one two", "three"]
    assert texts(broken((Run("45\u00a0° of arc"),), 6, ruler)) == ["45\u00a0°", "of arc"]
    assert texts(broken((Run("a "), Run("b", bold=True), Run(", c")), 4, ruler)) == ["a b,", "c"]


def test_a_formula_keeps_the_comma_behind_it():
    lines = broken((Run("so "), Run("h^2", formula=True), Run(", and")), 8, ruler)
    assert texts(lines) == ["so h^2,", "and"], "4 wide, with any source"


def test_what_is_wider_than_a_line_is_broken_inside():
    lines = broken((Run("x abcdefghij y"),), 4, ruler)
    assert all(line.width <= 4 for line in lines)
    assert "".join(texts(lines)) == "xabcdefghij y"


@each("seed", range(60))
def test_no_letter_is_lost_doubled_or_out_of_its_line(seed):
    rng = random.Random(seed)
    width = rng.randint(3, 40)
    pieces = [
        (
            "".join(rng.choices(string.ascii_letters + "     ,.", k=rng.randint(1, 12))),
            rng.random() < 0.4,
        )
        for _ in range(rng.randint(0, 8))
    ]
    runs = tuple(Run(text, bold) for text, bold in pieces)
    lines = broken(runs, width, ruler)
    assert "".join(texts(lines)).replace(" ", "") == "".join(text for text, _ in pieces).replace(" ", "")
    for line in lines:
        assert line.width <= width + 1e-6
        ends = [0.0, *(positioned.x + positioned.extent.width for positioned in line.runs)]
        assert [positioned.x for positioned in line.runs] == pytest.approx(ends[:-1])


def test_a_line_is_as_high_as_its_highest():
    def tall(run: Run) -> Extent:
        return Extent(1.0, 3.0, 2.0) if run.formula else ruler(run)

    (line,) = broken((Run("a "), Run("f", formula=True)), 20, tall)
    assert (line.ascent, line.descent) == (3.0, 2.0)


# ── formulas ─────────────────────────────────────────────────────────────────


def test_a_formula_is_set_as_one():
    fraction, letter = (set_formula(s, 40, INK, display=True) for s in (r"\frac{a}{b}", "a"))
    assert fraction is not None and letter is not None
    assert fraction.pixels.shape[0] > 1.8 * letter.pixels.shape[0], "two letters over one another"
    alpha = fraction.pixels[..., 3]
    bar = alpha.max(axis=1) > 128
    assert (alpha[bar] > 128).mean(axis=1).max() > 0.8, "and a bar between"
    assert 0 < fraction.baseline < fraction.pixels.shape[0]
    for edge in (alpha[0], alpha[-1], alpha[:, 0], alpha[:, -1]):
        assert edge.any(), "nothing empty around it"
    assert letter.baseline >= letter.pixels.shape[0] - 2, "an a is on the baseline"
    assert (fraction.pixels[alpha == 255][:, :3] == 0xEE).all()


def test_textures_are_made_once_and_given_back(ctx: moderngl.Context):
    textures, pixels = Textures(ctx, most=2), np.arange(24, dtype=np.uint8).reshape(2, 3, 4)
    first = textures.get("a", lambda: pixels)
    assert first is not None and textures.get("a", lambda: pixels) is first
    rows = np.frombuffer(first.read(alignment=1), np.uint8).reshape(2, 3, 4)
    np.testing.assert_array_equal(rows, pixels)
    again = textures.get("a", lambda: pixels, key="other")
    assert again is not first and isinstance(first.mglo, moderngl.InvalidObject)
    assert textures.get("b", lambda: None) is None
    textures.get("c", lambda: pixels)
    assert again is not None and isinstance(again.mglo, moderngl.InvalidObject), "more than two"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="locales have other homes elsewhere")
@pytest.mark.parametrize("locale", ["C", "C.UTF-8"])
def test_formulas_need_no_american_locale(locale):
    if not any((Path("/usr/lib/locale") / name).is_dir() for name in ("C.utf8", "C.UTF-8")):
        pytest.skip("no plain locale of Unicode here")
    program = "from playground.course.typeset import *; import os;"
    program += (
        "print(can_set(), set_formula('a+b', 20, 255, display=False) is not None, 'LOCPATH' in os.environ)"
    )
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("LC_", "LANG", "LOCPATH"))}
    environment |= {"LC_ALL": locale, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["True", "True", "False"]
    assert can_set()


# ── what is remembered, what is written ──────────────────────────────────────


def test_progress_comes_back_as_it_was_written(tmp_path):
    file = tmp_path / "deep" / "lessons.json"
    progress = Progress("fourier", "fr", False, 512.5, {"fourier": 3}, ["noise"])
    assert write_progress(progress, file) == ""
    assert read_progress(file) == progress


@pytest.mark.parametrize("text", ["", "{", "[]", '{"format": 2}', '{"format": 1, "lesson": 3}', "\0"])
def test_a_file_that_is_no_progress_is_the_beginning(tmp_path, text):
    file = tmp_path / "lessons.json"
    file.write_text(text, encoding="utf-8")
    assert read_progress(file) == Progress()
    assert read_progress(tmp_path / "none.json") == Progress()


def test_a_damaged_attempt_takes_no_other_with_it(tmp_path):
    file = tmp_path / "lessons.json"
    whole = Attempt("mine", {"a.b": 1.0}, None, 1.0, 2)
    progress = Progress("fourier", attempts={"fourier/one": whole, "fourier/two": whole})
    for damaged in (3, None, {"text": "lost"}, {**asdict(whole), "before": 1}, {**asdict(whole), "of": "x"}):
        write_progress(progress, file)
        table = json.loads(file.read_text(encoding="utf-8"))
        table["attempts"]["fourier/one"] = damaged
        file.write_text(json.dumps(table), encoding="utf-8")
        assert open_progress(file) == (replace(progress, attempts={"fourier/two": whole}), "")


def test_unreadable_progress_is_kept_without_overwriting_backups(tmp_path):
    file = tmp_path / "lessons.json"
    kept = []
    for text in ("{ my first kernels", '{"format": 9}', "my attempts" + " " * 2**24):
        file.write_text(text, encoding="utf-8")
        progress, said = open_progress(file)
        assert progress == Progress() and not file.exists()
        kept.append((text, said))
        assert write_progress(Progress("fourier"), file) == ""
        assert open_progress(file) == (Progress("fourier"), ""), "said once"
    for (text, said), name in zip(
        kept, ("lessons.unread", "lessons.unread-2", "lessons.unread-3"), strict=True
    ):
        aside = tmp_path / f"{name}.json"
        assert aside.read_text(encoding="utf-8") == text and str(aside) in said


def test_a_width_that_no_window_has_is_brought_into_range(tmp_path):
    file = tmp_path / "lessons.json"
    write_progress(Progress(width=1.0), file)
    assert read_progress(file).width == MIN_WIDTH


def test_what_cannot_be_written_is_reported_in_a_sentence(tmp_path):
    (tmp_path / "file").write_text("", encoding="utf-8")
    complaint = write_progress(Progress(), tmp_path / "file" / "lessons.json")
    assert complaint.startswith("where you are in the lessons cannot be remembered")
