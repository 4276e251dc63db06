"""Write the page of a hand-out: what is to be done, with pictures, and no answer.

It is one file that needs no network: its pictures are in it.
"""

from __future__ import annotations

import base64
import hashlib
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from PIL import Image

from playground._version import __version__
from playground.course.book.html import plain, prose
from playground.course.figure_renders import draw
from playground.course.glossary import linked_term
from playground.course.handout.exercise_files import Assignment
from playground.course.handout.labels import handout_labels
from playground.course.library import SOURCE, Labels
from playground.course.measuring import Number, filled
from playground.course.model import Challenge, Exercise, Lesson, Scene, Task
from playground.course.tasks.work import scene_of, starter
from playground.engine.engine import Engine
from playground.markup import Markup, joined, tag

_WIDTH = 480  # pixels of a picture
_QUALITY = 80  # of WebP


@dataclass(frozen=True)
class _PageContext:
    lesson: Lesson
    label: Labels
    numbers: Mapping[str, Number]
    engine: Engine
    hints: bool

    def text(self, markdown: str) -> Markup:
        """Return a text as paragraphs, with the numbers in it."""
        return prose(filled(markdown, self.numbers, comma=self.lesson.language == "fr"), self.anchor)

    def anchor(self, link: str) -> dict[str, str]:
        """Return the attributes of a link: the page has no other page to lead to."""
        if term := linked_term(link):
            return {"class_": "term", "title": term.definition(self.lesson.language)}
        return {"href": link} if link.startswith("https://") else {}

    def picture(self, scene: Scene, alt: str, caption: str) -> Markup:
        """Draw a picture and return it as a figure that holds it."""
        times = max(scene.pixels[0] / _WIDTH, 1.0)
        width, height = (max(round(side / times), 16) for side in scene.pixels)
        array = draw(self.engine, replace(scene, pixels=(width, height))).array
        stream = io.BytesIO()
        Image.fromarray(np.ascontiguousarray(array[..., :3])).save(stream, "WEBP", quality=_QUALITY, method=4)
        source = f"data:image/webp;base64,{base64.b64encode(stream.getvalue()).decode()}"
        image = tag("img", src=source, alt=alt, width=width, height=height)
        return tag("figure", image, tag("figcaption", caption))


def handout_page(
    lessons: Sequence[Lesson],
    assignments: Sequence[Assignment],
    numbers: Mapping[str, Mapping[str, Number]],
    engine: Engine,
    *,
    hints: bool = False,
    advance: Callable[[], None] = lambda: None,
) -> str:
    """Return the page as HTML; ``numbers`` are those of each lesson.

    Raises as ``Engine.render`` does.
    """
    label = handout_labels(lessons[0].language)
    by_place = {(assignment.lesson.name, assignment.task.name): assignment for assignment in assignments}
    body = [
        tag("h1", label["title"]),
        tag("p", label["name_line"], label["colon"], tag("span", Markup("&nbsp;")), class_="name"),
    ]
    for lesson in lessons:
        setting = _PageContext(lesson, label, numbers[lesson.name], engine, hints)
        body.append(tag("h2", f"{label('lesson', n=lesson.number)}{label['colon']}{lesson.title}"))
        for block in lesson.blocks:
            if isinstance(block, Task):
                body.append(_task(block, by_place.get((lesson.name, block.name)), setting))
                advance()
    style = (Path(__file__).resolve().parent / "handout.css").read_text(encoding="utf-8")
    digest = base64.b64encode(hashlib.sha256(style.encode()).digest()).decode()
    policy = (
        f"default-src 'none'; img-src data:; style-src 'sha256-{digest}'; base-uri 'none'; form-action 'none'"
    )
    head = joined(
        Markup('<meta charset="utf-8">'),
        tag("meta", http_equiv="Content-Security-Policy", content=policy),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("title", f"{label['title']}{label['colon']}{', '.join(lesson.title for lesson in lessons)}"),
        tag("style", Markup(style)),
    )
    footer = tag("footer", tag("p", label("made_by", version=__version__)))
    whole = tag("html", tag("head", head), tag("body", tag("main", *body), footer), lang=lessons[0].language)
    return f"<!doctype html>\n{whole}\n"


def _task(task: Task, assignment: Assignment | None, setting: _PageContext) -> Markup:
    label = setting.label
    title = label["challenge"]
    points = None
    if isinstance(task, Exercise):
        title = label("exercise", n=setting.lesson.number_of(task))
        points = label["no_points"]
        if task.points:
            points = label("points", n=task.points) if task.points > 1 else label["point"]
    hint = None
    if setting.hints and task.hint:
        hint = joined(tag("p", tag("b", label["hint"])), setting.text(task.hint))
    pictures = _pictures(task, setting)
    return tag(
        "section",
        tag("h3", title, tag("small", points) if points else None),
        setting.text(task.ask),
        tag("div", *pictures, class_="pictures") if pictures else None,
        _about(task, assignment, setting),
        hint,
        class_="task",
    )


def _about(task: Task, assignment: Assignment | None, setting: _PageContext) -> Markup | None:
    """Return which file is to be edited, and how it is opened."""
    label = setting.label
    if assignment is None:
        return None
    lines = [
        tag("p", label["edit"], label["colon"], tag("code", f"{assignment.name}/{assignment.file}")),
        tag("p", label["open"], label["colon"], tag("code", f"playground live {assignment.opens}")),
    ]
    if assignment.follows:
        lines.append(tag("p", label("go_on", n=setting.lesson.number_of(assignment.follows))))
    if task.file:
        lines.append(tag("p", label("kernel", file=task.file)))
    else:
        paths = joined(*(joined(Markup(" "), tag("code", path)) for path in task.sliders))
        lines.append(tag("p", label["values"], label["colon"], paths))
    if isinstance(task, Challenge):
        language = "" if setting.lesson.language == SOURCE else f" --lang {setting.lesson.language}"
        command = tag("code", f"playground lesson open {setting.lesson.name}{language}")
        lines.append(tag("p", label["in_lesson"], label["colon"], command))
    return tag("div", *lines, class_="about")


def _pictures(task: Task, setting: _PageContext) -> list[Markup]:
    """Return what a student begins with, and what the picture is to be, where the picture is judged."""
    label = setting.label
    works = isinstance(task, Challenge) or (isinstance(task, Exercise) and task.checks)
    if not works or task.scene is None:
        return []
    figures = [setting.picture(scene_of(task, starter(task)), label["begin"], label["begin"])]
    # Where only a measure is judged, many pictures are right.
    if isinstance(task, Challenge) or any(check.measure is None for check in getattr(task, "checks", ())):
        alt = plain(filled(getattr(task, "alt", ""), setting.numbers))
        figures.append(setting.picture(task.scene, alt or label["wanted"], label["wanted"]))
    return figures
