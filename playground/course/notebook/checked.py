"""What a notebook shows of a work: the verdict in words, and pictures of what differs."""

from __future__ import annotations

import io
from base64 import b64encode
from dataclasses import dataclass

from PIL import Image

from playground.course.tasks.judge import Match
from playground.course.tasks.sentences import points_of, sentences, task_labels
from playground.course.tasks.verdict import CheckResult, Picture, Verdict, difference_map
from playground.markup import Markup, joined, tag

_MARKS = {True: "✓", False: "✗"}
_COMPILERS = "list-style:none;white-space:pre-wrap;font:0.9em monospace"  # a compiler's words, as it has them
_WIDE = 200  # pixels of a picture on the page


@dataclass(frozen=True, eq=False)
class Checked:
    """A verdict that a notebook shows."""

    verdict: Verdict
    language: str

    def __str__(self) -> str:
        return "\n".join([points_of(self.verdict, self.language), *self.lines])

    @property
    def lines(self) -> list[str]:
        """A line for each check, with its mark."""
        passed = [result.passed for result in self.verdict.results] or [False] * len(self.verdict.diagnostics)
        said = sentences(self.verdict, self.language)
        return [f"{_MARKS[good]} {words}" for good, words in zip(passed, said, strict=True)]

    def _repr_html_(self) -> str:
        drawn = bool(self.verdict.results)
        style = "list-style:none" if drawn else _COMPILERS
        lines = [tag("li", _line(line) if drawn else line, style=style) for line in self.lines]
        wrong = [result for result in self.verdict.visible if not result.passed]
        return joined(
            tag("p", tag("b", points_of(self.verdict, self.language))),
            tag("ul", *lines),
            *(_compared(result, self.language) for result in wrong if result.mine is not None),
        )


@dataclass(frozen=True, eq=False)
class Matched:
    """A score that a notebook shows, with the picture to match and one's own."""

    match: Match
    best: float
    language: str

    def __str__(self) -> str:
        if self.match.diagnostics:
            return "\n".join(map(str, self.match.diagnostics))
        say, match = task_labels(self.language), self.match
        said = say("score", score=int(match.score), best=int(self.best), goal=match.goal)
        return f"{said} {say['solved']}" if match.solved else said

    def _repr_html_(self) -> str:
        pictures = (("wanted", self.match.target), ("mine", self.match.mine))
        say = task_labels(self.language)
        shown = [_picture(picture, say[key]) for key, picture in pictures if picture is not None]
        return joined(tag("p", str(self)), tag("div", *shown))


def _line(text: str) -> Markup:
    """Return a line in which what stands between backquotes is code."""
    return joined(*(tag("code", part) if odd % 2 else part for odd, part in enumerate(text.split("`"))))


def _compared(result: CheckResult, language: str) -> Markup:
    label = task_labels(language)
    mine, expected = result.mine, result.expected
    assert mine is not None and expected is not None
    shown = [_picture(mine, label["mine"]), _picture(expected, label["wanted"])]
    if mine.shape == expected.shape:
        shown.append(_picture(difference_map(mine, expected), label["differs"]))
    return tag("div", *shown)


def _picture(picture: Picture, name: str) -> Markup:
    stream = io.BytesIO()
    Image.fromarray(picture).save(stream, "PNG")
    source = f"data:image/png;base64,{b64encode(stream.getvalue()).decode()}"
    image = tag("img", src=source, alt=name, width=_WIDE)
    style = "display:inline-block;margin:0 .5em 0 0;text-align:center"
    return tag("figure", image, tag("figcaption", name), style=style)
