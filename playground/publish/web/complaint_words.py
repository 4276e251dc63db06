"""Write down what is known of drivers' logs as a JavaScript module: patterns and sentences, as data.

``runtime/complaint_words.js`` is what ``module`` returns, so that an error in a page has the words
that it has in a terminal. ``python -m playground.publish.web.complaint_words`` writes it again.
"""

from __future__ import annotations

import json
import re
import unicodedata
from pathlib import Path

from playground.files import write_file
from playground.shader import complaints, driver_log
from playground.shader.reserved_names import FETCHES, GIVEN, GIVEN_INSTEAD, GLSL_WORDS

FILE = Path(__file__).parent / "runtime" / "complaint_words.js"

# What comes into a text by copying it from a page or a document: blanks, quotes, dashes, signs.
_COPIED = (
    0xA0,
    0xAD,
    0x2002,
    0x2003,
    0x2007,
    0x2009,
    0x200A,
    0x200B,
    0x202F,
    0x2060,
    0x3000,
    0xFEFF,
    0x2018,
    0x2019,
    0x201A,
    0x201C,
    0x201D,
    0x201E,
    0xAB,
    0xBB,
    0x2032,
    0x2033,
    0xB4,
    0x2010,
    0x2011,
    0x2012,
    0x2013,
    0x2014,
    0x2015,
    0x2212,
    0xD7,
    0xF7,
    0xB7,
    0x2022,
    0x2026,
    0x2215,
    0x2217,
    0x37E,
    0xFF08,
    0xFF09,
    0xFF0C,
    0xFF1B,
    0xB0,
    0xB2,
    0xB3,
    0x2264,
    0x2265,
    0x2260,
    0xB1,
)

# Logs that browsers give: ANGLE's compiler, the same on Direct3D, Mesa's linker, and others'.
_IN_BROWSERS = (
    "ERROR: 0:12: 'x' : undeclared identifier",
    "C:\\fakepath(249,9-30): error X3004: undeclared identifier",
    "0:12(8): error: `x' undeclared",
    "error: too many uniforms",
)
_WIDTH = 108


def words() -> dict[str, object]:
    """Return the patterns, as ``[source, flags]`` of a JavaScript ``RegExp``, and the sentences."""
    log, patterns = driver_log, driver_log.PATTERNS
    return {
        "formats": [_pattern(item) for item in log.FORMATS if any(map(item.fullmatch, _IN_BROWSERS))],
        "benign": _pattern(patterns["benign"]),
        "frame": _pattern(patterns["frame"]),
        "summary": _pattern(patterns["summary"]),
        "unbroken": _pattern(patterns["unbroken"]),
        "hints": [[*_pattern(pattern), sentence] for pattern, sentence in log.HINTS],
        "misfit": _pattern(patterns["misfit"]),
        "call": _pattern(patterns["call"]),
        "type": _pattern(patterns["type"]),
        "bases": log.BASES,
        "misfits": log.MISFITS,
        "unknown": _pattern(patterns["unknown"]),
        "follows": _pattern(patterns["follows"]),
        "unfit": _pattern(patterns["unfit"]),
        "unread": _pattern(patterns["unread"]),
        "function": _pattern(patterns["function"]),
        "variable": _pattern(patterns["variable"]),
        "define": _pattern(patterns["define"]),
        "definition": _pattern(patterns["definition"]),
        "runs": _pattern(patterns["runs"]),
        "defined": _pattern(complaints.DEFINED),
        "chain": _pattern(complaints.CHAIN),
        "cast": _pattern(patterns["cast"]),
        "types": list(log.TYPES),
        "near": log.NEAR,
        "elsewhere": log.ELSEWHERE,
        "guesses": log.GUESSES,
        "instead": GIVEN_INSTEAD,
        "given": list(GIVEN),
        "known": " ".join(sorted(GLSL_WORDS)),
        "fetches": FETCHES,
        "foreign": complaints.FOREIGN,
        "nameless": complaints.NAMELESS,
        "characters": {c: unicodedata.name(c, complaints.NAMELESS) for c in map(chr, _COPIED)},
        "pastEnd": complaints.PAST_END,
    }


def module() -> str:
    """Return the text of the module."""
    rows = [row for name, value in words().items() for row in _rows(f"  {name}: ", value)]
    return (
        "// complaint_words.js -- what Python knows of drivers' logs: written by"
        " playground/publish/web/complaint_words.py.\n\n"
        "export const WORDS = {\n" + "\n".join(rows) + "\n};\n"
    )


def _pattern(pattern: re.Pattern[str]) -> list[str]:
    """Return a pattern as JavaScript writes it: names of groups, and case, which Python may set inside."""
    source = pattern.pattern.replace("(?P<", "(?<")
    flags = ("i" if pattern.flags & re.IGNORECASE else "") + ("m" if pattern.flags & re.MULTILINE else "")
    if source.startswith("(?-i:") and source.endswith(")"):
        source, flags = source[5:-1], flags.replace("i", "")
    if "(?-" in source or "\\Z" in source or "\\A" in source:
        raise ValueError(f"JavaScript has no such pattern: {source}")
    return [source, flags]


def _rows(head: str, value: object) -> list[str]:
    """Return a value behind its name as rows of JavaScript: parts of it, or of a long text, on each."""
    if len(row := f"{head}{json.dumps(value)},") <= _WIDTH:
        return [row]
    inside = " " * (len(head) - len(head.lstrip()) + 2)
    if isinstance(value, str):
        size = _WIDTH - len(inside) - 20  # what escapes add
        parts = [json.dumps(value[at : at + size]) for at in range(0, len(value), size)]
        return [head.rstrip(), *_texts(parts, inside)] if head.strip() else _texts(parts, inside[2:])
    if isinstance(value, dict):
        pairs = [
            row for key, element in value.items() for row in _rows(f"{inside}{json.dumps(key)}: ", element)
        ]
        return [f"{head}{{", *_together(pairs, inside), f"{inside[2:]}}},"]
    assert isinstance(value, list)
    items = [row for element in value for row in _rows(inside, element)]
    return [f"{head}[", *_together(items, inside), f"{inside[2:]}],"]


def _texts(parts: list[str], inside: str) -> list[str]:
    return [f"{inside}{part}{' +' if part is not parts[-1] else ','}" for part in parts]


def _together(rows: list[str], inside: str) -> list[str]:
    """Put short rows of the same depth on one line."""
    lines: list[str] = []
    for row in rows:
        short = row.startswith(inside) and row[len(inside)] not in " ]}" and row[-2:-1] not in "[{"
        last = lines[-1] if lines else ""
        if short and last.endswith(",") and last.startswith(inside) and last[len(inside)] not in " ]}":
            if len(last) + len(row.strip()) + 1 <= _WIDTH:
                lines[-1] = f"{last} {row.strip()}"
                continue
        lines.append(row)
    return lines


if __name__ == "__main__":
    write_file(FILE, module())
