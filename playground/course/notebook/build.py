"""Write a lesson as a Jupyter notebook: its texts as Markdown, a cell of code for each picture."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator
from typing import Any

from playground.course import model
from playground.course.glossary import linked_term, terms_of
from playground.course.library import SOURCE, THESIS, labels
from playground.course.measures import filled
from playground.course.scenes import bug_region, excerpt
from playground.course.tasks import checks_itself, starter_text
from playground.course.traces import Results
from playground.errors import DataError
from playground.extras import needs
from playground.sketch.assign import value_of, values_of

_LINK = re.compile(r"\[([^\]]*)\]\((lesson|sketch|thesis|term):([^)]*)\)")


def notebook_text(lesson: model.Lesson, results: Results, lessons: Collection[str] = ()) -> str:
    """Return a lesson's notebook, not run yet, with its results and with links to ``lessons``, by name.

    Raises ``DataError`` without nbformat.
    """
    try:
        import nbformat
    except ModuleNotFoundError:
        raise DataError(needs("a notebook", "nbformat", "notebook")) from None
    form: Any = nbformat  # its functions have no types
    make: Any = {"markdown": form.v4.new_markdown_cell, "code": form.v4.new_code_cell}
    cells = []
    for number, (kind, text) in enumerate(_Writer(lesson, results, lessons).cells()):
        cell: Any = make[kind](text)
        cell["id"] = f"{lesson.name.replace('_', '-')[:40]}-{number}"  # the same at every build
        cells.append(cell)
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook: Any = form.v4.new_notebook(
        cells=cells, metadata={"kernelspec": kernel, "language_info": {"name": "python"}}
    )
    form.validate(notebook)
    return str(form.writes(notebook)) + "\n"


Cell = tuple[str, str]
"""Its kind, "markdown" or "code", and its text."""


class _Writer:
    """Writes the cells of one lesson."""

    def __init__(self, lesson: model.Lesson, results: Results, lessons: Collection[str]) -> None:
        self.lesson = lesson
        self.lessons = lessons
        self.results = results
        self.label = labels("book", lesson.language)

    def cells(self) -> Iterator[Cell]:
        """Yield all cells."""
        lesson, label = self.lesson, self.label
        minutes = label("minutes", reading=lesson.minutes, exercises=lesson.exercise_minutes)
        head = f"{label('lesson')} {lesson.number} · {minutes}\n\n# {lesson.title}"
        goal = f"**{label('goal')}**{label('colon')}{lesson.goal}"
        yield "markdown", f"{head}\n\n{goal}\n\n{label('run_first')}"
        language = "" if lesson.language == SOURCE else f', language="{lesson.language}"'
        opening = f'lesson = open_lesson("{lesson.name}"{language})'
        yield "code", f"from playground.course.notebook import open_lesson\n\n{opening}"
        for block in lesson.blocks:
            yield from WRITERS[type(block)](self, block)
        sections = ", ".join(label("section", n=number) for number in lesson.thesis)
        papers = "\n".join(f"- {paper}" for paper in lesson.papers)
        thesis = f"## {label('thesis')}\n\n{THESIS}{label('colon')}{sections}."
        yield "markdown", f"{thesis}\n\n## {label('papers')}\n\n{papers}"
        if terms := terms_of(lesson):
            entries = "\n".join(f"- {term.definition(lesson.language)}" for term in terms)
            yield "markdown", f"## {label('glossary')}\n\n{entries}"

    def prose(self, block: model.Prose) -> Iterator[Cell]:
        """Yield a text."""
        mark = f"{'#' * block.level} " if block.kind == "heading" else ""
        yield "markdown", self.text(f"{mark}{block.markdown}")

    def figure(self, block: model.Figure | model.Steps | model.Slider | model.Compare) -> Iterator[Cell]:
        """Yield a caption, then the code that draws the picture or the series."""
        yield "markdown", f"*{self.text(block.caption)}*"
        yield "code", f'lesson.show("{block.name}")'

    def code(self, block: model.Code) -> Iterator[Cell]:
        """Yield lines of a shader."""
        title = self.label("code_of", file=f"glsl/{block.file}")
        caption = f"{self.text(block.caption)} " if block.caption else ""
        yield "markdown", f"```glsl\n{excerpt(block.file, block.anchor).text}\n```\n\n{caption}({title})"

    def trace(self, block: model.Trace) -> Iterator[Cell]:
        """Yield lines of a shader with a texel's values, the table of their loop, the code that traces it."""
        lines = self.results.traces[block.name]
        texel = self.label("texel_of", x=lines.texel[0], y=lines.texel[1])
        title = f"{self.label('code_of', file=f'glsl/{lines.file}')}, {texel}"
        caption = f"{self.text(block.caption)} ({title})"
        parts = (f"```glsl\n{lines.text()}\n```", lines.markdown(), caption)
        yield "markdown", "\n\n".join(filter(None, parts))
        yield "code", f'lesson.trace("{block.name}")'

    def bug(self, block: model.Break) -> Iterator[Cell]:
        """Yield a bug: its picture, its lines to be fixed, hint and fix folded away."""
        yield "markdown", f"### {self.label('bug')}\n\n{self.text(block.ask)}"
        yield "code", f'lesson.show("{block.name}")'
        yield "markdown", self.label("your_task")
        yield "code", f'lesson.fix("{block.name}", r"""\n{bug_region(block).broken}\n""")'
        yield "markdown", "\n\n".join((self.folded("hint", block.hint), self.folded("fix", block.fix)))

    def question(self, block: model.Question) -> Iterator[Cell]:
        """Yield a question, its answer folded away."""
        choices = "".join(f"\n- {self.text(choice)}" for choice in block.choices)
        question = f"### {self.label('question')}\n\n{self.text(block.ask)}\n{choices}".rstrip()
        folded = self.folded("answer", block.answer)
        if block.of is None:
            yield "markdown", f"{question}\n\n{folded}"
            return
        yield "markdown", f"{question}\n\n{self.label('write_number')}"
        yield "code", f'lesson.answer("{block.name}", "")'
        yield "markdown", folded

    def measure(self, block: model.Measure) -> Iterator[Cell]:
        """Yield a number with its sentence; nothing where only prose names it."""
        if block.sentence:
            yield "markdown", self.text(block.sentence)
            yield "code", f'lesson.measure("{block.name}")'

    def task(self, block: model.Exercise | model.Challenge) -> Iterator[Cell]:
        """Yield an exercise, its solution folded away; one that checks itself has a cell that does."""
        say, folded = labels("tasks", self.lesson.language), []
        if isinstance(block, model.Exercise):
            head = f"{self.label('exercise')} {self.lesson.number_of(block)}"
        else:
            head = say["challenge"]
        if block.hint:
            folded.append(self.folded("hint", block.hint))
        if block.solution:
            folded.append(self.folded("solution", block.solution))
        asked = f"### {head}\n\n{self.text(block.ask)}"
        if not checks_itself(block):
            yield "markdown", "\n\n".join([asked, *folded])
            return
        matches = isinstance(block, model.Challenge)
        here = say["match_here" if matches else "write_here" if block.file else "set_here"]
        yield "markdown", asked
        yield "code", f'lesson.exercise("{block.name}")'
        yield "markdown", here
        yield "code", f'lesson.{"match" if matches else "check"}("{block.name}", {_begun(block)})'
        if folded:
            yield "markdown", "\n\n".join(folded)

    def folded(self, key: str, markdown: str) -> str:
        """Return a text that is unfolded by its label."""
        return f"<details><summary>{self.label(key)}</summary>\n\n{self.text(markdown)}\n\n</details>"

    def text(self, markdown: str) -> str:
        """Return a text with its numbers, and with links that a notebook can follow."""
        return _LINK.sub(self.linked, filled(markdown, self.results.numbers, self.lesson.language))

    def linked(self, link: re.Match[str]) -> str:
        """Return a link that a notebook can follow: of a term, to the list at its end."""
        text, kind, what = link.groups()
        if term := linked_term(f"{kind}:{what}"):
            name = f'[{text}](#{self.label("glossary")} "{term.definition(self.lesson.language)}")'
            bold = link.string[: link.start()].endswith("**") and link.string[link.end() :].startswith("**")
            return name if bold else f"**{name}**"
        return f"[{text}]({what}.ipynb)" if kind == "lesson" and what in self.lessons else text


WRITERS: dict[type[model.Block], Callable[[_Writer, Any], Iterator[Cell]]] = {
    model.Prose: _Writer.prose,
    model.Figure: _Writer.figure,
    model.Steps: _Writer.figure,
    model.Slider: _Writer.figure,
    model.Compare: _Writer.figure,
    model.Code: _Writer.code,
    model.Trace: _Writer.trace,
    model.Break: _Writer.bug,
    model.Question: _Writer.question,
    model.Exercise: _Writer.task,
    model.Challenge: _Writer.task,
    model.Measure: _Writer.measure,
}
"""What writes each kind of block."""


def _begun(task: model.Exercise | model.Challenge) -> str:
    """Return what a student begins from, as Python."""
    if task.file:
        return f'r"""\n{starter_text(task).rstrip()}\n"""'
    assert task.begin is not None
    values = values_of(task.begin.sketch)
    value = {path: value_of(task.begin.sketch, path, values) for path in task.sliders}
    return repr(value)
