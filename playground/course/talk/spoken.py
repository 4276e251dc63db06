"""Sentences of a beat: those that are shown, how long it is read, its notes as subtitles (SubRip)."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from playground.course.model import Markdown
from playground.course.talk.beat import Beat

MAX_WORDS = 40
"""Words that are shown large at a time; only a single longer sentence is more."""

_WHOLE = re.compile(r"`[^`]*`|\$[^$]*\$|\[[^\]]*\]\([^)]*\)|\{\{[^}]*\}\}|«[^»]*»")  # never cut inside
_END = re.compile(r"[.!?…][\"”’)*_]*(?:\s+)(?=[A-ZÀ-Þ0-9«`$*\[({“\x00])")
_SHORT = re.compile(r"(?:\b(?:e\.g|i\.e|cf|p|pp|fig|vol|M|Mr|Dr|et al|env)|\b[A-Z])\.$")
_WORD = re.compile(r"[^\W_]+(?:['’.,\-][^\W_]+)*")
_BLANKS = re.compile(r"[ \t\n]+")  # a no-break space stays
_LINK = re.compile(r"\]\([^)]*\)")


def sentences(text: Markdown) -> list[Markdown]:
    """Return the sentences of one paragraph; code, formulas, links and quotations stay whole."""
    stored: list[str] = []

    def store(match: re.Match[str]) -> str:
        stored.append(match[0])
        return f"\0{len(stored) - 1}\1"

    flat = _BLANKS.sub(" ", _WHOLE.sub(store, text)).strip()
    parts, start = [], 0
    for end in _END.finditer(flat):
        part = flat[start : end.end()].strip()
        if _SHORT.search(part) or part.count("**") % 2:
            continue
        parts.append(part)
        start = end.end()
    parts.append(flat[start:].strip())
    return [re.sub("\0(\\d+)\1", lambda m: stored[int(m[1])], part) for part in parts if part]


def words(text: Markdown) -> int:
    """Count what is read of a text: its words, its numbers, the names in its formulas."""
    return len(_WORD.findall(_LINK.sub("]", text)))


def shown_of(text: Markdown, most: int = MAX_WORDS) -> Markdown:
    """Return the first sentences of a paragraph, of at most so many words; the first one always."""
    parts: list[Markdown] = []
    for sentence in sentences(text):
        if parts and words(" ".join([*parts, sentence])) > most:
            break
        parts.append(sentence)
    return " ".join(parts)


WORDS_A_MINUTE = 200
MIN_SECONDS = 3.0
"""[s] that a beat is on at least."""
LETTERS, LINES = 60, 2
"""Of a subtitle: letters a line, and lines."""

_CODE_LINE = 1.0  # [s] more for a line of code
_LATEX = {
    r"\cdot": "·", r"\times": "×", r"\Delta": "Δ", r"\alpha": "α", r"\beta": "β", r"\pi": "π",
    r"\theta": "θ", r"\lambda": "λ", r"\sum": "∑", r"\infty": "∞", r"\le": "≤", r"\ge": "≥",
    r"\approx": "≈", r"\sqrt": "√", r"\to": "→", r"\omega": "ω", r"\sigma": "σ", r"\tau": "τ",
}  # fmt: skip
_FRACTION = re.compile(r"\\t?frac\s*\{([^{}]*)\}\s*\{([^{}]*)\}")


@dataclass(frozen=True)
class Cue:
    """A subtitle: when it begins and ends [s], and what it says."""

    begin: float
    end: float
    text: str


def read_of(beat: Beat) -> Markdown:
    """Return what is read of a beat: its notes, else what is shown, and the choices."""
    return "\n".join([beat.notes or beat.shown, *([] if beat.right >= 0 else beat.choices)])


def seconds_of(beat: Beat) -> float:
    """Return how long a beat is on [s], by what there is to read."""
    lines = beat.code.text.count("\n") + 1 if beat.code is not None else 0
    return max(words(read_of(beat)) * 60 / WORDS_A_MINUTE + lines * _CODE_LINE, MIN_SECONDS)


def cues_of(beat: Beat, begin: float, seconds: float) -> list[Cue]:
    """Return the subtitles of a beat that is on from ``begin`` for some seconds."""
    texts = [part for sentence in _told(beat) for part in _parts(sentence)]
    shares = [max(len(text), 12) for text in texts]
    cues, at = [], begin
    for text, share in zip(texts, shares, strict=True):
        end = at + seconds * share / sum(shares)
        cues.append(Cue(at, end, text))
        at = end
    return cues


def srt(cues: Iterable[Cue]) -> str:
    """Return subtitles as SubRip."""
    rows = (
        f"{number}\n{_time(cue.begin)} --> {_time(cue.end)}\n{cue.text}\n"
        for number, cue in enumerate(cues, 1)
    )
    return "\n".join(rows)


def plain_text(text: Markdown) -> str:
    """Return Markdown as plain text; formulas as nearly as letters say them."""
    plain_markdown = re.sub(r"\$\$?([^$]*)\$\$?", lambda match: _plain_formula(match[1]), text)
    plain_markdown = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", plain_markdown)
    plain_markdown = re.sub(r"(?m)^\s*(?:[-*]|\d+\.)\s+", "", plain_markdown)
    plain_markdown = re.sub(r"\*\*|`|(?<!\w)\*|\*(?!\w)|\\(?=[*_])", "", plain_markdown)
    return " ".join(plain_markdown.split())


def _told(beat: Beat) -> Sequence[str]:
    text = beat.notes
    if text.lstrip().startswith("|"):
        return []  # a table is read on the picture
    paragraphs = [part for part in re.split(r"\n\s*\n|\n(?=\s*[-*] )", text) if part.strip()]
    return [plain_text(sentence) for part in paragraphs for sentence in sentences(part)]


def _parts(text: str) -> list[str]:
    """Return a sentence in parts of so many lines, as even as words allow."""
    lines = textwrap.wrap(text, LETTERS)
    count = math.ceil(len(lines) / LINES)
    if count < 2:
        return ["\n".join(lines)] if lines else []
    each = math.ceil(len(text) / count) + 8
    return [
        "\n".join(textwrap.wrap(part, LETTERS)) for part in textwrap.wrap(text, min(each, LETTERS * LINES))
    ]


def _time(seconds: float) -> str:
    whole = round(seconds * 1000)
    hours, minutes, left = whole // 3_600_000, whole // 60_000 % 60, whole % 60_000
    return f"{hours:02}:{minutes:02}:{left // 1000:02},{left % 1000:03}"


def _plain_formula(latex: str) -> str:
    plain_latex = latex
    while plain_latex != (plain_latex := _FRACTION.sub(r"\1/\2", plain_latex)):
        pass
    plain_latex = re.sub(r"\\(?:text|mathrm|operatorname|mathbf|vec)\s*\{([^{}]*)\}", r"\1", plain_latex)
    plain_latex = re.sub(r"\\[a-zA-Z]+", lambda match: _LATEX.get(match[0], match[0][1:]), plain_latex)
    return " ".join(re.sub(r"\\[,;! ]|[{}\\]", " ", plain_latex).split())
