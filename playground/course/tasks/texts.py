"""The texts of a task that is a kernel: what a student begins from, and the model answer."""

from __future__ import annotations

from pathlib import Path

from playground.course.library import HERE
from playground.course.model import Task
from playground.paths import GLSL
from playground.shader.source import read_text

EXERCISES = HERE / "exercises"
"""Starters and model answers, in a folder for each lesson."""


def path_of(task: Task) -> Path:
    """Return the absolute path of the file that the student's text replaces."""
    return (GLSL / task.file).resolve()


def starter_text(task: Task) -> str:
    """Return what a student begins from; "" for a task of values."""
    return _text(task, task.start)


def answer_text(task: Task) -> str:
    """Return the model answer; "" for a task of values."""
    return _text(task, task.answer)


def _text(task: Task, own: str) -> str:
    if not task.file:
        return ""
    return read_text(EXERCISES / own if own else path_of(task))
