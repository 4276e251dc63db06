"""Write a hand-out as a zip: a page, a README, and for each exercise a folder that the window opens.

    week3/README.txt             what to do, and what to hand in
    week3/exercises.html         the exercises, without answers
    week3/LESSON-EXERCISE/       what the student edits
    week3/….whl                  the playground itself, if a wheel is given
    pack.json                    which of them opens where the zip itself is opened

The same lessons give the same bytes, on the same renderer: names are sorted and dates fixed.
"""

from __future__ import annotations

import json
import re
import tempfile
import tomllib
import zipfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from playground._version import __version__
from playground.course.book.html import open_command, prose, traced_code, traced_steps
from playground.course.document import plain
from playground.course.glossary import linked_term
from playground.course.library import Labels, labels
from playground.course.measures import filled
from playground.course.model import Challenge, Exercise, Lesson, Question, Scene, Task, Trace
from playground.course.scenes import draw
from playground.course.tasks import (
    answer_text,
    path_of,
    scene_of,
    small,
    starter,
    starter_text,
    tasks_of,
    webp_of,
)
from playground.course.traces import Results, results_of, trace_of
from playground.engine.engine import Engine
from playground.errors import DataError, PlaygroundError, SketchError
from playground.extras import DISTRIBUTION
from playground.files import checked_file, reading, reason, replacing, write_file
from playground.markup import Markup, data_url, document, joined, tag
from playground.paths import GLSL, SKETCHES
from playground.publish.pack import zip_entry
from playground.shader.header import parse_kernel
from playground.shader.source import read_source, read_text
from playground.sketch.find import FORMAT, MANIFEST
from playground.sketch.load import load
from playground.sketch.model import Graph, Sketch, Technique
from playground.sketch.save import save, save_copy
from playground.sketch.toml_text import KeyPath, drop, put, text_of

_COMMENT = re.compile(r"//(?:\\\n|[^\n])*|/\*.*?(?:\*/|\Z)", re.DOTALL)
_TOKEN = re.compile(r"\w+|[^\w\s]")


def normalised(text: str) -> str:
    """Return a text as its tokens, without comments and without how it is laid out."""
    return " ".join(_TOKEN.findall(_COMMENT.sub(" ", text)))


@dataclass(frozen=True)
class Assignment:
    """One exercise that checks itself, one picture to match, or one question for a number, of one lesson."""

    lesson: Lesson
    task: Exercise | Challenge | Question
    starter: str = ""  # what is handed out in the student's file; "" where values are set
    follows: Exercise | None = None  # the student goes on from what was written there

    @property
    def name(self) -> str:
        """What it goes by in a hand-out and a table: no other exercise has the same."""
        return f"{self.lesson.name}-{self.task.name}"

    @property
    def file(self) -> str:
        """The file that the student edits: a kernel, the sketch whose values are set, or a number."""
        if isinstance(self.task, Question):
            return f"{self.name}.txt"
        return f"{self.name}.glsl" if self.task.file else f"{self.name}.toml"

    @property
    def sketch_file(self) -> str:
        """The sketch that shows it, "" for a question; a kernel next to it may not have its name."""
        if isinstance(self.task, Question):
            return ""
        return "sketch.toml" if self.task.file else self.file

    @property
    def opens(self) -> str:
        """What opens the exercise in the window, from the hand-out's folder; "" for a question."""
        if isinstance(self.task, Question):
            return ""
        return self.name if self.task.file else f"{self.name}/{self.file}"

    @property
    def points(self) -> int:
        """How many points it has: a picture to match has a score instead."""
        return 0 if isinstance(self.task, Challenge) else self.task.points

    @property
    def title(self) -> str:
        """The lesson, and the exercise's number in it, or that a picture is to be matched."""
        if isinstance(self.task, Challenge):
            challenge = labels("handout", self.lesson.language)["challenge"]
            return f"{self.lesson.title}, {challenge.lower()}"
        if isinstance(self.task, Question):
            return f"{self.lesson.title}, {question_title(self.task, self.lesson).lower()}"
        return f"{self.lesson.title}, {self.lesson.number_of(self.task)}"


def question_title(question: Question, lesson: Lesson) -> str:
    """Return what a question for a number is called: with its place among those of its lesson."""
    names = [task.name for task in tasks_of(lesson) if isinstance(task, Question)]
    return labels("handout", lesson.language)("question_n", n=names.index(question.name) + 1)


def assignments_of(lessons: Iterable[Lesson]) -> list[Assignment]:
    """List the exercises of lessons that check themselves and the challenges, in the order of the lessons.

    Where an exercise begins with the answer of an earlier one, it is handed out with what that one begins
    with: the student goes on from a kernel of their own, and no answer is given away.
    """
    assignments: list[Assignment] = []
    for lesson in lessons:
        of_lesson: list[Assignment] = []
        for task in tasks_of(lesson):
            of_lesson.append(_assignment(lesson, task, of_lesson))
        assignments += of_lesson
    return assignments


def _assignment(
    lesson: Lesson, task: Exercise | Challenge | Question, earlier: Iterable[Assignment]
) -> Assignment:
    if isinstance(task, Question):
        return Assignment(lesson, task)
    starter = starter_text(task)
    for before in earlier:
        if task.file and isinstance(before.task, Exercise) and task.file == before.task.file:
            if normalised(starter) == normalised(answer_text(before.task)):
                return Assignment(lesson, task, before.starter, before.task)
    return Assignment(lesson, task, starter)


_HEADER = re.compile(r"^\s*\[\[?\s*([A-Za-z_-]+)")
_LEFT_OUT = ("shot", "preset", "keyframe")
_INCLUDE = re.compile(r'^(\s*#\s*include\s+")([^"]+)(")', re.MULTILINE)
_NOT_IN_AN_IDENTIFIER = re.compile(r"[^A-Za-z0-9_]")


def student_files(assignment: Assignment) -> dict[str, bytes]:
    """Return the files of an exercise's folder by their names in it.

    Raises ``PlaygroundError`` where no such sketch can be made.
    """
    task = assignment.task
    if isinstance(task, Question):
        return {assignment.file: _number_file(assignment).encode()}
    scene = task.begin
    assert scene is not None
    with tempfile.TemporaryDirectory(prefix="handout-") as scratch:
        try:
            shipped = load(SKETCHES / f"{scene.sketch.name}.toml")
            first = save_copy(shipped, shipped, Path(scratch))
            text = _without_moments(read_text(first), assignment)
            first.unlink()
            path = first.with_name(assignment.sketch_file)
            write_file(path, text)
            if task.file:
                _put_kernel(assignment, task, path)
            _drop_view_settings(path, scene.sketch)
            sketch = load(path)
            save(sketch, _as_begun(sketch, scene.sketch))
            load(path)
            return {
                file.relative_to(path.parent).as_posix(): file.read_bytes()
                for file in sorted(path.parent.rglob("*"))
                if file.is_file()
            }
        except OSError as error:
            raise DataError(f"{assignment.name}: no folder could be made for it: {reason(error)}") from None


def _number_file(assignment: Assignment) -> str:
    """Return the file of a question: a student writes the number behind its last colon."""
    label = labels("handout", assignment.lesson.language)
    return f"{assignment.title}\n\n{label['number_file']}\n\n{label['number_key']}: \n"


def _without_moments(text: str, assignment: Assignment) -> str:
    """Return a sketch's text without its shots, presets and keyframes, under a heading of its own."""
    kept: list[str] = []
    waiting: list[str] = []  # comments and blank lines, which belong to the table after them
    inside = False
    for line in text.split("\n"):
        if not line.strip() or line.lstrip().startswith("#"):
            waiting.append(line)
            continue
        header = _HEADER.match(line)
        if header:
            inside = header[1] in _LEFT_OUT
        if not inside:
            kept += [*waiting, line]
        waiting = []
    while kept and (not kept[0].strip() or kept[0].lstrip().startswith("#")):
        kept.pop(0)  # what the shipped sketch says of itself
    title = assignment.title
    whole = "\n".join([f"# {title}", *kept]).rstrip() + "\n"
    return put(whole, (), "title", text_of(title))


def _drop_view_settings(path: Path, begin: Sketch) -> None:
    """Take out of a student's sketch what it sets of a view that the exercise does not set."""
    view, text = begin.graph.find("view"), read_text(path)
    set_there = tomllib.loads(text).get("view", {}).get("set", {})
    for key in set_there.keys() - dict(view.values if view else ()).keys():
        text = drop(text, ("view", "set"), key)
    write_file(path, text)


def _as_begun(sketch: Sketch, begin: Sketch) -> Sketch:
    """Return a student's sketch with the values, the view and the camera that the exercise begins with."""
    edited = sketch
    if (view := begin.graph.find("view")) != sketch.graph.find("view") and view is not None:
        passes = tuple(view if spec.name == "view" else spec for spec in sketch.graph.passes)
        edited = replace(edited, graph=replace(sketch.graph, passes=passes))
    for path, value in begin.overrides:
        try:
            edited = edited.with_values({path: value})
        except PlaygroundError:
            continue  # of the model answer's kernel, not of what the student begins with
    return edited.with_camera(begin.camera)


def _put_kernel(assignment: Assignment, task: Task, sketch_file: Path) -> None:
    """Write the starter into the folder and have the sketch use it, through the techniques around it."""
    folder, kernel = sketch_file.parent, path_of(task)
    starter = _includes_from_library(assignment.starter, kernel)
    write_file(folder / f"{assignment.name}.glsl", starter)
    own = _OwnKernel(
        kernel, assignment.name, folder, _parameters(read_text(kernel), kernel) - _parameters(starter, kernel)
    )
    graph, text = load(sketch_file).graph, read_text(sketch_file)
    text, gone = _using(own, text, graph, of_sketch=True)
    main = tomllib.loads(text).get("main", [])
    if there := [path for path in main if path not in gone]:
        text = put(text, (), "main", f"[{', '.join(map(text_of, there))}]")
    elif main:
        text = drop(text, (), "main")
    write_file(sketch_file, text)


@dataclass(frozen=True)
class _OwnKernel:
    """A student's kernel, in the place of one that ships."""

    shipped: Path
    name: str  # of its file, and of those of the techniques around it
    folder: Path
    lacks: set[str]  # parameters of the shipped one


def _using(own: _OwnKernel, text: str, graph: Graph, *, of_sketch: bool = False) -> tuple[str, set[str]]:
    """Return a graph's TOML with the student's kernel in it, and the paths of parameters that are gone.

    Techniques of several passes on the way to the kernel are written into the folder.
    """
    gone: set[str] = set()
    number = 0
    for spec in graph.passes:
        is_view = of_sketch and spec.name == "view"
        key_path: KeyPath = ("view",) if is_view else ("pass", number)
        number += not is_view
        if not _leads_to(spec.technique, own.shipped):
            if not of_sketch and spec.use.startswith("./"):
                text = put(text, key_path, "use", text_of(_from_library(spec.use, Path(graph.path))))
            continue
        lost = own.lacks
        use = own.name
        if isinstance(spec.technique, Graph):
            use, lost = _own_technique(own, spec.technique)
        text = put(text, key_path, "use", text_of(f"./{use}"))
        for key, _ in spec.values:
            if key in lost:
                text = drop(text, (*key_path, "set"), key)
        gone |= {f"{spec.name}.{path}" for path in lost}
    return text, gone


def _own_technique(own: _OwnKernel, technique: Graph) -> tuple[str, set[str]]:
    """Write a technique of several passes, with the student's kernel; return its name and what is gone."""
    source = Path(technique.path)
    name = f"{own.name}-{_NOT_IN_AN_IDENTIFIER.sub('_', source.stem)}"
    text, gone = _using(own, read_text(source), technique)
    for exported, path in tomllib.loads(text).get("parameters", {}).items():
        inner = path if isinstance(path, list) else [path]
        there = [text_of(each) for each in inner if each not in gone]
        if there and len(there) < len(inner):
            text = put(text, ("parameters",), exported, f"[{', '.join(there)}]")
        elif not there:
            text = drop(text, ("parameters",), exported)
            gone.add(exported)
    write_file(own.folder / f"{name}.toml", text)
    return name, gone


def _parameters(text: str, kernel: Path) -> set[str]:
    """Return the parameters that a text in the place of a kernel declares."""
    kernel_read = parse_kernel(kernel.stem, read_source(kernel, (GLSL,), {str(kernel): text}))
    return {parameter.name for parameter in kernel_read.parameters} if kernel_read else set()


def _from_library(use: str, source: Path) -> str:
    """Return a technique as any folder may name it; ``./x`` is next to the file that uses it."""
    if not use.startswith("./"):
        return use
    return (source.parent / use[2:]).resolve().relative_to(GLSL.resolve()).as_posix()


def _leads_to(technique: Technique, kernel: Path) -> bool:
    if isinstance(technique, Graph):
        return any(_leads_to(spec.technique, kernel) for spec in technique.passes)
    return Path(technique.path).resolve() == kernel


def _includes_from_library(text: str, kernel: Path) -> str:
    """Return a starter whose includes are named from ``glsl/``, where they were next to the kernel."""

    def named(match: re.Match[str]) -> str:
        file = (kernel.parent / match[2]).resolve()
        if not file.is_file() or not file.is_relative_to(GLSL.resolve()):
            return match[0]
        return f"{match[1]}{file.relative_to(GLSL.resolve()).as_posix()}{match[3]}"

    return _INCLUDE.sub(named, text)


_WIDTH = 480  # pixels of a picture


@dataclass(frozen=True)
class _PageContext:
    lesson: Lesson
    label: Labels
    results: Results
    engine: Engine
    hints: bool

    def text(self, markdown: str) -> Markup:
        """Return a text as paragraphs, with the numbers in it."""
        return prose(self.filled(markdown), self.anchor)

    def filled(self, markdown: str) -> str:
        """Return a text with the numbers in it."""
        return filled(markdown, self.results.numbers, self.lesson.language)

    def anchor(self, link: str) -> dict[str, str]:
        """Return the attributes of a link: the page has no other page to lead to."""
        if term := linked_term(link):
            return {"class_": "term", "title": term.definition(self.lesson.language)}
        return {"href": link} if link.startswith("https://") else {}

    def picture(self, scene: Scene, alt: str, caption: str) -> Markup:
        """Draw a picture and return it as a figure that holds it."""
        shown = small(scene, _WIDTH)
        source = data_url("image/webp", webp_of(draw(self.engine, shown).array))
        width, height = shown.pixels
        image = tag("img", src=source, alt=alt, width=width, height=height)
        return tag("figure", image, tag("figcaption", caption))


def handout_page(
    lessons: Sequence[Lesson],
    assignments: Sequence[Assignment],
    results: Mapping[str, Results],
    engine: Engine,
    *,
    hints: bool = False,
    advance: Callable[[], None] = lambda: None,
) -> str:
    """Return the page as HTML; ``results`` are those of each lesson.

    Raises as ``Engine.render`` does.
    """
    label = labels("handout", lessons[0].language)
    by_place = {(assignment.lesson.name, assignment.task.name): assignment for assignment in assignments}
    sections = [
        tag("h1", label["title"]),
        tag("p", label["name_line"], label["colon"], tag("span", Markup("&nbsp;")), class_="name"),
    ]
    for lesson in lessons:
        setting = _PageContext(lesson, label, results[lesson.name], engine, hints)
        drawn: set[str] = set()  # traces
        sections.append(tag("h2", f"{label('lesson', n=lesson.number)}{label['colon']}{lesson.title}"))
        for block in lesson.blocks:
            if isinstance(block, Question) and block.of is not None:
                trace = trace_of(lesson, block)
                if trace.name not in drawn:
                    drawn.add(trace.name)
                    sections.append(_trace(trace, _answer_lines(trace.file, assignments), setting))
                sections.append(_question(block, by_place[lesson.name, block.name], setting))
                advance()
            if isinstance(block, Task):
                sections.append(_task(block, by_place.get((lesson.name, block.name)), setting))
                advance()
    style = (Path(__file__).resolve().parent / "handout.css").read_text(encoding="utf-8")
    body = tag("body", tag("main", *sections), tag("footer", tag("p", label("made_by", version=__version__))))
    policy = "default-src 'none'; img-src data:"
    return document(lessons[0].language, _title(lessons), body, policy=policy, style=style)


def _title(lessons: Sequence[Lesson]) -> str:
    label = labels("handout", lessons[0].language)
    return f"{label['title']}{label['colon']}{', '.join(lesson.title for lesson in lessons)}"


def _points(points: int, label: Labels) -> str:
    return label("points", n=points) if points > 1 else label["point"]


def _answer_lines(file: str, assignments: Iterable[Assignment]) -> set[str]:
    """Return the lines of a file that students are to write themselves."""
    lines: set[str] = set()
    for each in assignments:
        if isinstance(each.task, Task) and each.task.file == file:
            starter = {line.strip() for line in each.starter.splitlines()}
            lines |= {line.strip() for line in answer_text(each.task).splitlines()} - starter
    return lines


def _trace(block: Trace, secret: set[str], setting: _PageContext) -> Markup:
    """Return the lines and the table that questions are about, without what these or exercises ask for."""
    lines, label = setting.results.traces[block.name], setting.label
    rows = (replace(line, code="…") if line.code.strip() in secret else line for line in lines.lines)
    lines = replace(lines, lines=tuple(rows))
    texel = label("texel_of", x=lines.texel[0], y=lines.texel[1])
    return tag(
        "figure",
        traced_code(lines, label),
        tag("figcaption", setting.text(block.caption), tag("p", f"glsl/{lines.file}, {texel}")),
        traced_steps(lines, label) if lines.steps else None,
        class_="traced",
    )


def _question(question: Question, assignment: Assignment, setting: _PageContext) -> Markup:
    label, file = setting.label, tag("code", f"{assignment.name}/{assignment.file}")
    return tag(
        "section",
        tag("h3", question_title(question, setting.lesson), tag("small", _points(question.points, label))),
        setting.text(question.ask),
        tag("div", tag("p", label["write_number_into"], label["colon"], file), class_="about"),
        class_="task",
    )


def _task(task: Task, assignment: Assignment | None, setting: _PageContext) -> Markup:
    label = setting.label
    title = label["challenge"]
    points = None
    if isinstance(task, Exercise):
        title = label("exercise", n=setting.lesson.number_of(task))
        points = label["no_points"]
        if task.points:
            points = _points(task.points, label)
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
        command = tag("code", open_command(setting.lesson))
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
        alt = plain(setting.filled(getattr(task, "alt", "")))
        figures.append(setting.picture(task.scene, alt or label["wanted"], label["wanted"]))
    return figures


_WHEEL_NAME = DISTRIBUTION.replace("-", "_")
_WHEEL = re.compile(rf"{_WHEEL_NAME}-[^-]+(-\d[^-]*)?(-[^-]+){{3}}\.whl")
_NOT_IN_A_NAME = re.compile(r"[^\w.-]+")


def count_tasks(lessons: Sequence[Lesson]) -> int:
    """Return how many tasks and questions for a number the page of these lessons has."""
    blocks = [block for lesson in lessons for block in lesson.blocks]
    return sum(isinstance(b, Task) or (isinstance(b, Question) and b.of is not None) for b in blocks)


def write_handout(
    path: Path,
    lessons: Sequence[Lesson],
    engine: Engine,
    *,
    hints: bool = False,
    install: str = "",
    wheel: Path | None = None,
    advance: Callable[[], None] = lambda: None,
) -> list[Assignment]:
    """Write the zip, whole or not at all, and return the exercises with points that are in it.

    ``install`` is how students install the playground, for their README. ``wheel`` goes into the zip.
    Raises ``SketchError`` where none of the lessons has an exercise that checks itself, ``DataError`` for
    what is no wheel of the playground, and as drawing does.
    """
    packed = {} if wheel is None else {wheel.name: read_wheel(wheel)}
    assignments = assignments_of(lessons)
    if not assignments:
        names = ", ".join(lesson.name for lesson in lessons)
        raise SketchError(f"{names}: no exercise here checks itself, so there is no file to hand in")
    top = _NOT_IN_A_NAME.sub("-", path.stem).strip("-. ") or "handout"
    results = {
        lesson.name: results_of(engine, lesson) if _needs_results(lesson) else Results() for lesson in lessons
    }
    files = {f"{top}/{name}": data for name, data in packed.items()}
    files[f"{top}/README.txt"] = _readme(lessons, assignments, install, "".join(packed)).encode()
    for assignment in assignments:
        for name, data in student_files(assignment).items():
            files[f"{top}/{assignment.name}/{name}"] = data
    page = handout_page(lessons, assignments, results, engine, hints=hints, advance=advance)
    files[f"{top}/exercises.html"] = page.encode()
    if drawn := [each for each in assignments if each.sketch_file]:
        kernels = {each.task.file for each in drawn if isinstance(each.task, Task) and each.task.file}
        manifest = {
            "format": FORMAT,
            "sketch": f"{top}/{drawn[0].name}/{drawn[0].sketch_file}",
            "version": __version__,
            "shipped": sorted(kernels),
        }
        files[MANIFEST] = (json.dumps(manifest, indent=1) + "\n").encode()
    with replacing(path) as handle, zipfile.ZipFile(handle, "w") as archive:
        for name in sorted(files):
            archive.writestr(zip_entry(name), files[name], zipfile.ZIP_DEFLATED, 9)
    return assignments


def _needs_results(lesson: Lesson) -> bool:
    """Return whether a task's text names a number, or a question is about a trace: these are computed."""
    return any(
        "{{" in f"{block.ask}{block.hint}{getattr(block, 'alt', '')}"
        for block in lesson.blocks
        if isinstance(block, Task)
    ) or any(isinstance(block, Question) and block.of is not None for block in lesson.blocks)


def read_wheel(path: Path) -> bytes:
    """Return the bytes of a wheel of the playground; raise ``DataError`` for another file."""
    checked_file(path)
    if not _WHEEL.fullmatch(path.name):
        example = f"{_WHEEL_NAME}-{__version__}-py3-none-any.whl"
        raise DataError(f"is not named as a wheel of the playground, such as {example}", file=path)
    metadata = f"{'-'.join(path.name.split('-')[:2])}.dist-info/METADATA"
    with reading(path) as handle, zipfile.ZipFile(handle) as archive:
        archive.getinfo(metadata)
        handle.seek(0)
        return handle.read()


def _readme(lessons: Sequence[Lesson], assignments: Sequence[Assignment], install: str, wheel: str) -> str:
    label = labels("handout", lessons[0].language)
    lines = install.strip().splitlines()
    if not lines:
        lines = label("install_wheel", wheel=wheel).strip().splitlines() if wheel else [label("install_open")]
    elif wheel:
        lines.append(label("wheel_here", wheel=wheel))
    return (
        label(
            "readme",
            title=_title(lessons),
            install="\n".join([lines[0], *(f"   {line.strip()}".rstrip() for line in lines[1:])]),
            commands="\n".join(f"   playground live {each.opens}" for each in assignments if each.opens),
            files="\n".join(f"   {assignment.name}/{assignment.file}" for assignment in assignments),
        ).strip()
        + "\n"
    )
