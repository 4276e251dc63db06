"""Write the marks as a table: CSV (RFC 4180), UTF-8 with the byte order mark that Excel needs to see it.

A French spreadsheet opens what has semicolons between its columns and commas in its numbers.

A name such as ``=1+1`` would be computed by a spreadsheet; behind an apostrophe it stays a text.
"""

from __future__ import annotations

import csv
import io
import unicodedata
from collections.abc import Sequence

from playground.course.grading.labels import report_labels
from playground.course.grading.marks import Graded, spelled_points

_FORMULAS = ("=", "+", "-", "@", "\t", "\r", "\n")  # also in their wide forms


def table_bytes(graded: Sequence[Graded], exercises: Sequence[str], language: str) -> bytes:
    """Return the table: a row for each student, the points of each exercise, the total, and of how many.

    A challenge has its score in its column, which counts in no total.
    """
    text, label = io.StringIO(newline=""), report_labels(language)
    rows = csv.writer(text, delimiter=label("separator"))
    rows.writerow([label("column"), *map(as_text, exercises), label("column_total"), label("column_of")])
    for graded_submission in graded:
        numbers = [
            *(graded_submission.marks[name].spelled for name in exercises),
            spelled_points(graded_submission.points),
        ]
        decimal = [number.replace(".", label("decimal")) for number in numbers]
        rows.writerow([as_text(graded_submission.student), *decimal, graded_submission.of])
    return text.getvalue().encode("utf-8-sig", "replace")


def as_text(name: str) -> str:
    """Return a name as a spreadsheet shows it, not as a formula that it computes."""
    begins = unicodedata.normalize("NFKC", name).lstrip(" ")
    return f"'{name}" if begins.startswith(_FORMULAS) else name
