"""Each kind of block of a lesson as HTML.

Everything is there without a script: all pictures of a series beside each other, both of a
comparison, answers to be unfolded. The script makes of them what one drags.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from playground.lessons.book.html import Address, code_block, line, plain, prose
from playground.lessons.bugs import around
from playground.lessons.excerpt import excerpt
from playground.lessons.figure_renders import Picture, pictures_in
from playground.lessons.library import SOURCE
from playground.lessons.measuring import Number, filled
from playground.lessons.model import (
    Block,
    Break,
    Code,
    Compare,
    Exercise,
    Figure,
    Lesson,
    Measure,
    Prose,
    Question,
    Slider,
    Steps,
)
from playground.lessons.values import spelled_value
from playground.markup import Markup, joined, tag


@dataclass(frozen=True)
class Setting:
    """What the blocks of one lesson are written with."""

    lesson: Lesson
    words: Mapping[str, str]  # around the lesson, in its language
    numbers: Mapping[str, Number]
    source: Callable[[Picture], str]  # address of a picture
    address: Address

    def line(self, words: str) -> Markup:
        """Return words within a line, with the numbers in them."""
        return line(self._filled(words), self.address)

    def prose(self, words: str) -> Markup:
        """Return words as paragraphs, with the numbers in them."""
        return prose(self._filled(words), self.address)

    def word(self, key: str, **values: object) -> str:
        """Return a word of the interface."""
        return self.words[key].format(**values)

    def image(self, picture: Picture, *, lazy: bool = True, alt: str | None = None) -> Markup:
        """Return a picture as an element with its size, so that nothing jumps when it comes."""
        width, height = picture.scene.pixels
        return tag(
            "img",
            src=self.source(picture),
            alt=plain(self._filled(picture.alt)) if alt is None else alt,
            width=width,
            height=height,
            loading="lazy" if lazy else None,
            decoding="async",
        )

    def _filled(self, words: str) -> str:
        return filled(words, dict(self.numbers), comma=self.lesson.language == "fr")


def block_html(block: Block, setting: Setting, *, first: bool = False) -> Markup:
    """Return a block as HTML; the first picture of a page is loaded at once."""
    if isinstance(block, Prose):
        return _prose(block, setting)
    if isinstance(block, Figure):
        return _figure(block, setting, first)
    return _WRITERS[type(block)](block, setting)


def _prose(block: Prose, setting: Setting) -> Markup:
    return setting.prose(block.text if block.kind in ("heading", "code") else block.words)


def _figure(block: Figure, setting: Setting, first: bool) -> Markup:
    (picture,) = pictures_in(block)
    return tag(
        "figure",
        setting.image(picture, lazy=not first),
        tag("figcaption", setting.line(block.caption), _in_window(setting) if block.sliders else None),
        id=block.name,
    )


def _in_window(setting: Setting) -> Markup:
    """Return where a figure can be dragged whose sliders a page cannot have."""
    command = tag("code", open_command(setting.lesson))
    return tag("small", setting.word("in_window"), setting.word("colon"), command, class_="in-window")


def open_command(lesson: Lesson) -> str:
    """Return the command that opens a lesson in the window."""
    language = "" if lesson.language == SOURCE else f" --lang {lesson.language}"
    return f"playground lesson open {lesson.name}{language}"


def _series(block: Steps | Slider, setting: Setting, labels: list[str], name: str) -> Markup:
    frames = []
    pictures = list(pictures_in(block))
    for index, (picture, label) in enumerate(zip(pictures, labels, strict=True)):
        caption = block.captions[index] if isinstance(block, Steps) and block.captions else ""
        # The pictures of a series are told apart by their labels; what they show is said once, above.
        frames.append(
            tag(
                "li",
                setting.image(picture, alt=f"{name}: {label}"),
                tag(
                    "p",
                    tag("b", label),
                    Markup(" "),
                    tag("span", setting.line(caption)) if caption else None,
                ),
            )
        )
    return tag(
        "figure",
        tag("p", plain(block.alt), class_="said"),
        tag("ol", *frames, class_="frames", data_name=name, tabindex=0, aria_label=plain(block.caption)),
        tag("figcaption", setting.line(block.caption)),
        id=block.name,
        class_="series",
        data_kind="step" if isinstance(block, Steps) else "slider",
    )


def _steps(block: Steps, setting: Setting) -> Markup:
    count = len(block.turns)
    labels = [setting.word("step_of", n=index + 1, m=count) for index in range(count)]
    return _series(block, setting, labels, setting.word("step"))


def _slider(block: Slider, setting: Setting) -> Markup:
    name = block.label or block.parameter
    labels = [spelled_value(block, value, setting.lesson.language) for value in block.values]
    return _series(block, setting, labels, plain(name))


def _compare(block: Compare, setting: Setting) -> Markup:
    shown = []
    for picture, label in zip(pictures_in(block), block.labels, strict=True):
        shown.append(
            tag("li", setting.image(picture, alt=f"{plain(label)}"), tag("p", tag("b", setting.line(label))))
        )
    return tag(
        "figure",
        tag("p", plain(block.alt), class_="said"),
        tag("ul", *shown, class_="variants", data_swipe=setting.word("swipe")),
        tag("figcaption", setting.line(block.caption)),
        id=block.name,
        class_="compare",
    )


def _code(block: Code, setting: Setting) -> Markup:
    found = excerpt(block.file, block.anchor)
    title = setting.word("code_of", file=f"glsl/{block.file}")
    return tag(
        "figure",
        code_block(found.text, title),
        tag(
            "figcaption",
            setting.line(block.caption) if block.caption else None,
            Markup(" "),
            tag("small", title),
        ),
        id=block.name,
        class_="listing",
    )


def _break(block: Break, setting: Setting) -> Markup:
    whole, broken = pictures_in(block)
    before, after = around(block)
    faulty, mended = setting.word("faulty_code"), setting.word("mended_code")
    return tag(
        "section",
        tag("h3", setting.word("fault"), id=f"{block.name}-title"),
        setting.prose(block.ask),
        tag(
            "figure",
            setting.image(broken),
            tag(
                "figcaption",
                tag("b", setting.word("broken")),
                Markup(" "),
                setting.line(block.caption) if block.caption else None,
            ),
        ),
        tag("p", faulty, Markup(" "), tag("small", setting.word("code_of", file=f"glsl/{block.file}"))),
        code_block(after, faulty),
        _folded(setting.word("hint"), setting.prose(block.hint)),
        _folded(
            setting.word("mend"),
            setting.prose(block.mend),
            tag("p", mended),
            code_block(before, mended),
            tag(
                "figure",
                setting.image(whole, alt=setting.word("whole")),
                tag("figcaption", tag("b", setting.word("whole"))),
            ),
        ),
        id=block.name,
        class_="break",
    )


def _question(block: Question, setting: Setting) -> Markup:
    choices = None
    if block.choices:
        rows = [
            tag(
                "label",
                tag(
                    "input",
                    type="radio",
                    name=block.name,
                    value=index,
                    data_right="yes" if index == block.right else "no",
                ),
                Markup(" "),
                tag("span", setting.line(choice)),
            )
            for index, choice in enumerate(block.choices)
        ]
        choices = tag(
            "fieldset",
            tag("legend", setting.word("question"), class_="said"),
            *rows,
            tag("p", class_="verdict", role="status"),
            data_right=setting.word("right"),
            data_wrong=setting.word("wrong"),
        )
    return tag(
        "section",
        tag("h3", setting.word("question"), id=f"{block.name}-title"),
        setting.prose(block.ask),
        choices,
        _folded(setting.word("answer"), setting.prose(block.answer)),
        id=block.name,
        class_="question",
    )


def _exercise(block: Exercise, setting: Setting) -> Markup:
    numbers = [each.name for each in setting.lesson.blocks if isinstance(each, Exercise)]
    picture = None
    for found in pictures_in(block):
        picture = tag("figure", setting.image(found))
    return tag(
        "section",
        tag("h3", f"{setting.word('exercise')} {numbers.index(block.name) + 1}", id=f"{block.name}-title"),
        setting.prose(block.ask),
        _folded(setting.word("hint"), setting.prose(block.hint)) if block.hint else None,
        _folded(setting.word("solution"), setting.prose(block.solution), picture),
        id=block.name,
        class_="exercise",
    )


def _measure(block: Measure, setting: Setting) -> Markup:
    if not block.words:
        return joined()
    return tag(
        "p",
        tag("b", setting.word("measured"), class_="chip"),
        Markup(" "),
        setting.line(block.words),
        id=block.name,
        class_="measure",
    )


def _folded(title: str, *inside: Markup | None) -> Markup:
    return tag("details", tag("summary", title), tag("div", *inside))


_WRITERS: dict[type[Block], Callable[[Any, Setting], Markup]] = {
    Steps: _steps,
    Slider: _slider,
    Compare: _compare,
    Code: _code,
    Break: _break,
    Question: _question,
    Exercise: _exercise,
    Measure: _measure,
}
