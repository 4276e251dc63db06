"""Write the blocks of a lesson as HTML: Markdown, formulas, code, and each kind of block.

Everything is there without a script: all pictures of a series side by side, both of a comparison, answers
to be unfolded. The script turns them into sliders and swipes.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from latex2mathml.converter import convert
from markdown_it.renderer import RendererHTML
from markdown_it.token import Token

from playground.course import model
from playground.course.document import parser, plain
from playground.course.library import SOURCE, Labels, decimal
from playground.course.measures import filled
from playground.course.scenes import Picture, bug_region, excerpt, pictures_in, spelled_value
from playground.course.tasks import starter_text
from playground.course.traces import Beside, Results, TracedLines, text_of
from playground.markup import Markup, joined, tag
from playground.memo import INTERFACE

Anchor = Callable[[str], dict[str, str]]
"""Maps a link to the attributes of its element: "lesson:fourier" → {"href": "fourier.html"}."""

MAX_INDENT = 24
"""Blanks of indent that book.css knows; a line with more wraps under these."""


def prose(markdown: str, anchor: Anchor) -> Markup:
    """Return blocks of Markdown as HTML."""
    return Markup(_rendered(markdown, anchor, inline=False))


def line(markdown: str, anchor: Anchor) -> Markup:
    """Return Markdown within a line as HTML; of several paragraphs, one after the other."""
    if "\n\n" in markdown:
        return prose(markdown, anchor)
    return Markup(_rendered(markdown, anchor, inline=True))


def formula(latex: str, *, alone: bool = False) -> Markup:
    """Return a formula as MathML."""
    return Markup(convert(latex, display="block" if alone else "inline"))


@INTERFACE.cached()
def code(text: str) -> Markup:
    """Return GLSL as HTML, its tokens marked with classes."""
    from pygments import highlight
    from pygments.formatters import HtmlFormatter
    from pygments.lexers.graphics import GLShaderLexer

    formatter: Any = HtmlFormatter(nowrap=True, classprefix="t-")
    return Markup(highlight(text, GLShaderLexer(stripnl=False), formatter).rstrip("\n"))


def code_block(text: str, label: str) -> Markup:
    """Return GLSL as a block whose lines wrap where they are too wide."""
    text = text.strip("\n")
    inside = wrapped_lines(text, code(text))
    return tag("pre", tag("code", inside), class_="code", role="group", aria_label=label)


def wrapped_lines(text: str, html: Markup) -> Markup:
    """Return lines of code each in an element of its own, which wraps under its own indent.

    ``html`` is the text with as many lines. A line's class says its indent, as styles in a page may not;
    its end is inside, so that what is copied is the text.
    """
    lines = zip(text.split("\n"), html.split("\n"), strict=True)
    return joined(*(_wrapped(line_text, Markup(f"{marked}\n")) for line_text, marked in lines))


def _wrapped(text: str, html: Markup) -> Markup:
    indent = min(len(text) - len(text.lstrip(" ")), MAX_INDENT)
    return tag("span", html, class_=f"l i{indent}" if indent else "l")


def _plain_block(text: str) -> Markup:
    return tag("pre", tag("code", wrapped_lines(text, joined(text))), class_="code")


class _Renderer(RendererHTML):
    """Formulas as MathML, links of our own, tables that can be scrolled."""

    def math_inline(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        return formula(tokens[idx].content)

    def math_block(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        return f'<div class="formula" tabindex="0">{formula(tokens[idx].content, alone=True)}</div>\n'

    def link_open(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        href = str(tokens[idx].attrs["href"])
        return tag("a", **env["anchor"](href)).removesuffix("</a>")

    def table_open(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        return '<div class="table" tabindex="0"><table>\n'

    def table_close(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        return "</table></div>\n"

    def code_block(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        return str(_plain_block(tokens[idx].content.rstrip("\n")))

    def fence(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        token = tokens[idx]
        text = token.content.rstrip("\n")
        return code_block(text, token.info or "code") if token.info == "glsl" else str(_plain_block(text))


def _rendered(markdown: str, anchor: Anchor, *, inline: bool) -> str:
    parser_ = parser()
    parser_.renderer = _Renderer(parser_)
    env: dict[str, Any] = {"anchor": anchor}
    return str(parser_.renderInline(markdown, env) if inline else parser_.render(markdown, env))


_MAX_QUESTION = 120  # characters of a question that are repeated over its answer

ANSWERS = ("inline", "end", "none")
"""Where answers are: folded away under their questions, and on paper at the end; at the end; nowhere."""


def image(source: str, alt: str, size: tuple[int, int], *, lazy: bool = False) -> Markup:
    """Return a picture as an element with its size, so that nothing jumps when it is loaded."""
    loading = "lazy" if lazy else None
    return tag("img", src=source, alt=alt, width=size[0], height=size[1], loading=loading, decoding="async")


@dataclass(frozen=True)
class LessonContext:
    """What the blocks of one lesson are written with."""

    lesson: model.Lesson
    label: Labels  # around the lesson, in its language
    results: Results
    source: Callable[[Picture], str]  # address of a picture
    anchor: Anchor
    live: Collection[str] = ()  # names of the blocks that a page can run
    blank: Callable[[Picture], bool] = lambda picture: False  # whether a picture shows next to nothing
    answers: str = "inline"  # one of ANSWERS
    first: bool = False  # whether no picture of the page comes before: a figure is loaded at once
    at_end: list[Markup] = field(default_factory=list)  # answers, for the end of the page

    def line(self, markdown: str) -> Markup:
        """Return a text within a line, with the numbers in it."""
        return line(self.filled(markdown), self.anchor)

    def prose(self, markdown: str) -> Markup:
        """Return a text as paragraphs, with the numbers in it."""
        return prose(self.filled(markdown), self.anchor)

    def image(self, picture: Picture, *, lazy: bool = True, alt: str | None = None) -> Markup:
        """Return a picture as an element, with its own description or another."""
        text = plain(self.filled(picture.alt)) if alt is None else alt
        return image(self.source(picture), text, picture.scene.pixels, lazy=lazy)

    def still(self, *inside: Markup | None) -> Markup:
        """Return what a live block replaces where a reader starts it."""
        return tag("div", *inside, class_="still")

    def started(self, block: model.Named) -> dict[str, str | None]:
        """Return the attribute of an element whose pictures can be started."""
        return {"data_block": block.name if block.name in self.live else None}

    def folded(self, key: str, *inside: Markup | None) -> Markup:
        """Return what is unfolded by its label."""
        return tag("details", tag("summary", self.label(key)), tag("div", *inside))

    def answer(
        self, block: model.Named, key: str, title: str, ask: str, *inside: Markup | None
    ) -> Markup | None:
        """Return an answer as it is under its question: folded away, or a link to it, or nothing."""
        if self.answers == "none":
            return None
        if self.answers == "inline":
            summary = tag("summary", self.label(key))
            return tag("details", summary, tag("div", *inside), class_="answer", data_title=title)
        text = f"answer-{block.name}"
        asked = plain(self.filled(ask).split("\n\n")[0])
        heading = tag("h3", tag("a", title, href=f"#{block.name}"))
        short = asked if len(asked) <= _MAX_QUESTION else f"{asked[:_MAX_QUESTION].rsplit(' ', 1)[0]} …"
        self.at_end.append(tag("section", heading, tag("p", short, class_="asked"), *inside, id=text))
        return tag("p", tag("a", self.label("answer_below"), href=f"#{text}"), class_="to-answer")

    def titled(
        self, block: model.Named, title: str, *inside: Markup | None, **attributes: str | None
    ) -> Markup:
        """Return the section of a block, under a heading."""
        heading, kind = tag("h3", title, id=f"{block.name}-title"), type(block).__name__.lower()
        return tag("section", heading, *inside, id=block.name, class_=kind, **attributes)

    def filled(self, markdown: str) -> str:
        """Return a text with the numbers in it."""
        return filled(markdown, self.results.numbers, self.lesson.language)


def block_html(block: model.Block, setting: LessonContext, *, first: bool = False) -> Markup:
    """Return a block as HTML; the first picture of a page is loaded at once."""
    return WRITERS[type(block)](block, replace(setting, first=first))


def open_command(lesson: model.Lesson) -> str:
    """Return the command that opens a lesson in the window."""
    language = "" if lesson.language == SOURCE else f" --lang {lesson.language}"
    return f"playground lesson open {lesson.name}{language}"


def _prose(block: model.Prose, setting: LessonContext) -> Markup:
    return setting.prose(block.text if block.kind in ("heading", "code") else block.markdown)


def _figure(block: model.Figure, setting: LessonContext) -> Markup:
    (picture,) = pictures_in(block)
    dragged = None
    if block.sliders and block.name not in setting.live:
        label, command = setting.label, tag("code", open_command(setting.lesson))
        dragged = tag("small", label("in_window"), label("colon"), command, class_="in-window")
    caption = tag("figcaption", setting.line(block.caption), dragged)
    image = setting.still(setting.image(picture, lazy=not setting.first))
    return tag("figure", image, caption, id=block.name, **setting.started(block))


def _series(
    block: model.Steps | model.Slider, setting: LessonContext, labels: list[str], name: str, opens: int
) -> Markup:
    frames = []
    captions = block.captions if isinstance(block, model.Steps) and block.captions else [""] * len(labels)
    for picture, label, caption in zip(pictures_in(block), labels, captions, strict=True):
        # The pictures of a series differ by their labels; what they show is written once, above.
        written = tag("span", setting.line(caption)) if caption else None
        below = tag("p", tag("b", label), Markup(" "), written)
        frames.append(tag("li", setting.image(picture, alt=f"{name}: {label}"), below))
    return tag(
        "figure",
        tag("p", plain(block.alt), class_="visually-hidden"),
        setting.still(
            tag("ol", *frames, class_="frames", data_name=name, tabindex=0, aria_label=plain(block.caption))
        ),
        tag("figcaption", setting.line(block.caption)),
        id=block.name,
        class_="series",
        data_kind="step" if isinstance(block, model.Steps) else "slider",
        data_opens=str(opens),
        **setting.started(block),
    )


def _steps(block: model.Steps, setting: LessonContext) -> Markup:
    count = len(block.iterations)
    labels = [setting.label("step_of", n=index + 1, m=count) for index in range(count)]
    pictures = list(pictures_in(block))
    opens = next((index for index, picture in enumerate(pictures) if not setting.blank(picture)), count - 1)
    return _series(block, setting, labels, setting.label("step"), opens)


def _slider(block: model.Slider, setting: LessonContext) -> Markup:
    name = block.label or block.parameter
    labels = [spelled_value(block, value, setting.lesson.language) for value in block.values]
    # A sweep opens in its middle, where there is something to drag towards on both sides.
    return _series(block, setting, labels, plain(name), len(labels) // 2)


def _compare(block: model.Compare, setting: LessonContext) -> Markup:
    shown = []
    for picture, label in zip(pictures_in(block), block.labels, strict=True):
        below = tag("p", tag("b", setting.line(label)))
        shown.append(tag("li", setting.image(picture, alt=plain(label)), below))
    return tag(
        "figure",
        tag("p", plain(block.alt), class_="visually-hidden"),
        setting.still(tag("ul", *shown, class_="variants", data_swipe=setting.label("swipe"))),
        tag("figcaption", setting.line(block.caption)),
        id=block.name,
        class_="compare",
        **setting.started(block),
    )


def _code(block: model.Code, setting: LessonContext) -> Markup:
    title = setting.label("code_of", file=f"glsl/{block.file}")
    caption = setting.line(block.caption) if block.caption else None
    return tag(
        "figure",
        code_block(excerpt(block.file, block.anchor).text, title),
        tag("figcaption", caption, Markup(" "), tag("small", title)),
        id=block.name,
        class_="listing",
    )


def _trace(block: model.Trace, setting: LessonContext) -> Markup:
    lines, label = setting.results.traces[block.name], setting.label
    title = label("code_of", file=f"glsl/{lines.file}")
    texel = label("texel_of", x=lines.texel[0], y=lines.texel[1])
    reveals = setting.answers != "none"
    labels_ = [lines.label(index) for index in range(len(lines.steps))]
    return tag(
        "figure",
        traced_code(lines, label, reveals=reveals),
        tag("figcaption", setting.line(block.caption), Markup(" "), tag("small", f"{title}, {texel}.")),
        traced_steps(lines, label, reveals=reveals) if lines.steps else None,
        id=block.name,
        class_="traced",
        data_steps=json.dumps(labels_, ensure_ascii=False) if lines.steps else None,
        data_name=lines.loop or None,
    )


def traced_code(lines: TracedLines, label: Labels, *, at: int | None = None, reveals: bool = False) -> Markup:
    """Return the lines of a trace as a table: number, code, and the values beside it.

    Of a loop these are the values of the table's rows, or those of the step with the index ``at``.
    ``reveals``: what a question hides is in the page, to be shown behind it.
    """
    marked = code("\n".join(line.code for line in lines.lines)).split("\n")
    rows = []
    for line, html in zip(lines.lines, map(Markup, marked), strict=True):
        values = (_beside(each, lines, at, reveals) for each in line.values)
        rows.append(
            tag(
                "tr",
                tag("th", str(line.number), scope="row"),
                tag("td", tag("code", _wrapped(line.code, html))),
                tag("td", *values),
            )
        )
    heads = (tag("th", label(key), scope="col") for key in ("trace_line", "trace_code", "trace_values"))
    head = tag("thead", tag("tr", *heads), class_="visually-hidden")
    columns = tag("colgroup", *(tag("col") for _ in range(3)))
    return tag("div", tag("table", columns, head, tag("tbody", *rows)), class_="table beside", tabindex=0)


def _beside(each: Beside, lines: TracedLines, at: int | None, reveals: bool) -> Markup:
    """Return what stands beside a line; with ``data-at`` for a value of each step."""
    indices = range(len(each.texts))
    shown = [each.text(index) for index in indices]
    full = [each.phrase(value) for value in each.texts] if each.hidden and reveals else None
    return tag(
        "span",
        each.on_paper(lines.rows) if at is None else each.text(at),
        data_at=json.dumps(shown, ensure_ascii=False) if each.is_looped else None,
        data_asked=" ".join(each.hidden.values()) or None,
        data_full=json.dumps(full, ensure_ascii=False) if full else None,
    )


def traced_steps(lines: TracedLines, label: Labels, *, reveals: bool = False) -> Markup:
    """Return the table of a loop: a row for each step, a column for each variable."""
    head = (tag("th", tag("code", name), scope="col") for name in (lines.loop, *lines.columns))
    rows = []
    for index in lines.rows:
        step, cells = lines.steps[index], []
        for name in lines.columns:
            asked = lines.hidden.get((name, step))
            full = text_of(lines.values[name, step], lines.digits) if asked and reveals else None
            cells.append(tag("td", lines.cell(name, index), data_asked=asked, data_full=full))
        rows.append(tag("tr", tag("th", str(step), scope="row"), *cells, data_step=str(index)))
    caption = tag("caption", label("trace_steps", loop=lines.loop), class_="visually-hidden")
    table = tag("table", caption, tag("thead", tag("tr", *head)), tag("tbody", *rows))
    return tag("div", table, class_="table steps", tabindex=0)


def _break(block: model.Break, setting: LessonContext) -> Markup:
    label, lines = setting.label, bug_region(block)
    correct, broken = pictures_in(block)
    caption = setting.line(block.caption) if block.caption else None
    file = tag("small", label("code_of", file=f"glsl/{block.file}"))
    fixed = tag(
        "figure",
        setting.image(correct, alt=label("correct")),
        tag("figcaption", tag("b", label("correct"))),
    )
    return setting.titled(
        block,
        label("bug"),
        setting.prose(block.ask),
        setting.still(
            tag(
                "figure",
                setting.image(broken),
                tag("figcaption", tag("b", label("broken")), Markup(" "), caption),
            ),
            tag("p", label("broken_code"), Markup(" "), file),
            code_block(lines.broken, label("broken_code")),
        ),
        setting.folded("hint", setting.prose(block.hint)),
        setting.answer(
            block,
            "fix",
            label("bug"),
            block.ask,
            setting.prose(block.fix),
            tag("p", label("fixed_code")),
            code_block(lines.correct, label("fixed_code")),
            fixed,
        ),
        **setting.started(block),
    )


def _choice(block: model.Question, index: int, setting: LessonContext) -> Markup:
    right = "yes" if index == block.right else "no"
    button = tag("input", type="radio", name=block.name, value=index, data_right=right)
    return tag("label", button, Markup(" "), tag("span", setting.line(block.choices[index])))


def _question(block: model.Question, setting: LessonContext) -> Markup:
    label, choices = setting.label, None
    if block.of is not None:
        choices = _number(block, setting)
    elif block.choices:
        choices = tag(
            "fieldset",
            tag("legend", label("question"), class_="visually-hidden"),
            *(_choice(block, index, setting) for index in range(len(block.choices))),
            tag("p", class_="verdict", role="status"),
            data_right=label("right"),
            data_wrong=label("wrong"),
        )
    answer = setting.answer(block, "answer", label("question"), block.ask, setting.prose(block.answer))
    return setting.titled(block, label("question"), setting.prose(block.ask), choices, answer)


def _number(block: model.Question, setting: LessonContext) -> Markup | None:
    """Return the field for a number, which a script checks; nothing where the page holds no answers."""
    if setting.answers == "none":
        return None
    label, expected = setting.label, setting.results.answers[block.name]
    field_ = tag(
        "input",
        type="text",
        inputmode="decimal",
        autocomplete="off",
        data_value=repr(expected.value),
        data_tolerance=repr(expected.tolerance),
    )
    return tag(
        "div",
        tag("label", label("your_number"), Markup(" "), field_),
        Markup(" "),
        tag("button", label("check_number"), type="button"),
        tag("p", class_="verdict", role="status"),
        class_="number",
        hidden=True,
        data_right=label("right_number", value=decimal(expected.text, setting.lesson.language)),
        data_wrong=label("wrong_number"),
        data_unread=label("no_number"),
    )


def _exercise(block: model.Exercise, setting: LessonContext) -> Markup:
    pictures = [tag("figure", setting.image(picture)) for picture in pictures_in(block)]
    live = block.name in setting.live
    room = setting.still() if live else None  # only what can be started has one
    title = f"{setting.label('exercise')} {setting.lesson.number_of(block)}"
    elsewhere = block.checks and not (live and any(check.measure is None for check in block.checks))
    return setting.titled(
        block,
        title,
        setting.prose(block.ask),
        _starter(block, setting),
        room,
        tag("p", tag("small", setting.line(setting.label("checked_elsewhere")))) if elsewhere else None,
        setting.folded("hint", setting.prose(block.hint)) if block.hint else None,
        setting.answer(block, "solution", title, block.ask, setting.prose(block.solution), *pictures),
        **setting.started(block),
    )


def _challenge(block: model.Challenge, setting: LessonContext) -> Markup:
    (target,) = pictures_in(block)
    title, solution = setting.label("challenge"), None
    if block.solution:
        solution = setting.answer(block, "solution", title, block.ask, setting.prose(block.solution))
    caption = setting.line(block.caption) if block.caption else setting.label("target")
    return setting.titled(
        block,
        title,
        setting.prose(block.ask),
        _starter(block, setting),
        setting.still(tag("figure", setting.image(target), tag("figcaption", caption))),
        setting.folded("hint", setting.prose(block.hint)) if block.hint else None,
        solution,
        **setting.started(block),
    )


def _starter(task: model.Task, setting: LessonContext) -> Markup | None:
    """Return the text that a reader begins from, folded away."""
    if not task.file:
        return None
    title = setting.label("code_of", file=f"glsl/{task.file}")
    return setting.folded("starter", code_block(starter_text(task), title))


def _measure(block: model.Measure, setting: LessonContext) -> Markup:
    if not block.sentence:
        return joined()
    chip = tag("b", setting.label("measured"), class_="chip")
    return tag("p", chip, Markup(" "), setting.line(block.sentence), id=block.name, class_="measure")


WRITERS: dict[type[model.Block], Callable[[Any, LessonContext], Markup]] = {
    model.Prose: _prose,
    model.Figure: _figure,
    model.Steps: _steps,
    model.Slider: _slider,
    model.Compare: _compare,
    model.Code: _code,
    model.Trace: _trace,
    model.Break: _break,
    model.Question: _question,
    model.Exercise: _exercise,
    model.Challenge: _challenge,
    model.Measure: _measure,
}
"""What writes each kind of block."""
