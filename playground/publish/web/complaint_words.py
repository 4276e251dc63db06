"""Write down what is known of drivers' logs for the page runtime: patterns and sentences, as JSON.

``runtime/complaint_words.json`` is what ``text`` returns, so that an error in a page has the words
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

FILE = Path(__file__).parent / "runtime" / "complaint_words.json"

# What comes into a text by copying it from a page or a document: blanks, quotes, dashes, signs.
_COPIED = """
A0 AD 2002 2003 2007 2009 200A 200B 202F 2060 3000 FEFF 2018 2019 201A 201C 201D 201E
AB BB 2032 2033 B4 2010 2011 2012 2013 2014 2015 2212 D7 F7 B7 2022 2026 2215
2217 37E FF08 FF09 FF0C FF1B B0 B2 B3 2264 2265 2260 B1
""".split()

# Logs that browsers give: ANGLE's compiler, the same on Direct3D, Mesa's linker, and others'.
_IN_BROWSERS = (
    "ERROR: 0:12: 'x' : undeclared identifier",
    "C:\\fakepath(249,9-30): error X3004: undeclared identifier",
    "0:12(8): error: `x' undeclared",
    "error: too many uniforms",
)


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
        "characters": {
            c: unicodedata.name(c, complaints.NAMELESS) for c in (chr(int(code, 16)) for code in _COPIED)
        },
        "pastEnd": complaints.PAST_END,
    }


def text() -> str:
    """Return the file's text, a name a line."""
    rows = [f" {json.dumps(name)}: {json.dumps(value)}" for name, value in words().items()]
    return "{\n" + ",\n".join(rows) + "\n}\n"


def _pattern(pattern: re.Pattern[str]) -> list[str]:
    """Return a pattern as JavaScript writes it: names of groups, and case, which Python may set inside."""
    source = pattern.pattern.replace("(?P<", "(?<")
    flags = ("i" if pattern.flags & re.IGNORECASE else "") + ("m" if pattern.flags & re.MULTILINE else "")
    if source.startswith("(?-i:") and source.endswith(")"):
        source, flags = source[5:-1], flags.replace("i", "")
    if "(?-" in source or "\\Z" in source or "\\A" in source:
        raise ValueError(f"JavaScript has no such pattern: {source}")
    return [source, flags]


if __name__ == "__main__":
    write_file(FILE, text())
