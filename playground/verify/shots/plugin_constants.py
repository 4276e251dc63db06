"""The names that are needed before anything heavy is loaded: folders, options' defaults, what tests report.

A test tells the summary of its run by user properties, which come along from workers of xdist.
"""

from __future__ import annotations

REPORT = "shots-report"
"""Where results go unless another folder is named: in the folder the tests were started in."""

REFERENCE_RENDERER = "llvmpipe"
"""Slug of the renderer that every shot has references of: it is the same on every machine."""

UPDATE_FAILED = "shots_update_failed"
"""Where the option ``--shots-update=failed`` is kept."""

SUMMARY_LINE = "shots-line"
"""The user property that carries a line for the summary."""

SHOT = "shot"
"""… that names a picture that was checked, as "hills/dawn"; those after it, ``shot.…``, tell of it."""

UNCHANGED = "shots-left"
"""… that says that a reference was left alone."""

CHECKED = "shots-checked"
"""… with the word of a shot that was checked."""

STOOD_IN = "shots-stood-in"
"""… that says whose references stood in for those of the renderer that drew, and how they were compared."""

UNCOMPARED = "shots-uncompared"
"""… that says why a shot was not compared."""

UNRECORDED = "shots-unrecorded"
"""… that says why a result could not be recorded."""

FIXTURE = "shot"
"""The fixture's name."""

UNCHECKED = "shots-unchecked"
"""The user property that says that a test has the fixture, and failed because it checked nothing."""

USED = "shots-used"
"""… that names a reference which a test in Python has used, as "llvmpipe/dawn"."""

TESTS = "shots-tests"
"""… that says how many tests there are in the file of a test; 0: not known."""
