"""GLSL as tokens, and as text with one statement a line.

A preprocessor line and a uniform with its annotation are one token each: the header's
grammar reads them line by line. Everything else is split as GLSL splits it, comments left
out. ``tidy`` prints any tokens in one form, so that two candidates that differ in blanks
alone are one.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

_TOKEN = re.compile(
    r"(?P<line>^[ \t]*(?:\#[^\n]*|uniform\b[^\n]*))"
    r"|(?P<comment>//[^\n]*|/\*.*?(?:\*/|\Z))"
    r"|(?P<number>(?:0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)[uUfF]*)"
    r"|(?P<word>[A-Za-z_]\w*)"
    r"|(?P<mark><<=|>>=|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||\^\^|[-+*/%&|^]=|[^\s\w])",
    re.MULTILINE | re.DOTALL,
)
_WORD = re.compile(r"[A-Za-z_]\w*")
_NUMBER = re.compile(r"\.?\d")

PAIRS = {"(": ")", "[": "]", "{": "}"}
ASSIGNS = frozenset("= += -= *= /= %= &= |= ^= <<= >>=".split())
OPERATORS = frozenset("+ - * / % << >> < > <= >= == != && || ^^ & | ^".split())
CONTROL = frozenset("if else for while do switch return case default break continue discard".split())
_NO_SPACE_BEFORE = frozenset(") ] , ; . ++ --".split())
_NO_SPACE_AFTER = frozenset("( [ . ! ~".split())


def tokens_of(text: str) -> list[str]:
    """Split a text into tokens; a whole-line token keeps its inner blanks."""
    tokens = []
    for match in _TOKEN.finditer(text):
        if match.lastgroup != "comment":
            tokens.append(match.group().strip())
    return tokens


def is_word(token: str) -> bool:
    """Return whether a token is an identifier or a keyword."""
    return bool(_WORD.fullmatch(token))


def is_number(token: str) -> bool:
    """Return whether a token is a literal number."""
    return bool(_NUMBER.match(token))


def is_line(token: str) -> bool:
    """Return whether a token is a whole line: of the preprocessor, or a uniform."""
    return token.startswith("#") or token.startswith("uniform ")


def partners(tokens: Sequence[str]) -> dict[int, int]:
    """Map each bracket's index to that of its partner, both ways; unpaired ones are left out."""
    partners_by_index: dict[int, int] = {}
    open_: list[int] = []
    for index, token in enumerate(tokens):
        if token in PAIRS:
            open_.append(index)
        elif token in PAIRS.values() and open_ and PAIRS[tokens[open_[-1]]] == token:
            start = open_.pop()
            partners_by_index[start], partners_by_index[index] = index, start
    return partners_by_index


def print_tokens(tokens: Sequence[str]) -> str:
    """Return tokens as text: one statement a line, four blanks a depth, one blank where it reads well."""
    lines: list[str] = []
    words: list[str] = []
    depth = brackets = 0
    unary = False  # whether the last token was a sign

    def end() -> None:
        nonlocal words
        if words:
            shift = depth - 1 if words[0] == "}" else depth
            lines.append("    " * max(shift, 0) + "".join(words))
        words = []

    last = ""
    for index, token in enumerate(tokens):
        if is_line(token):
            end()
            lines.append(token)
            last = ""
            continue
        sign = token in ("-", "+") and (
            last in ("", "(", "[", ",", "?", ":", "return", "{", "}", ";") or last in ASSIGNS | OPERATORS
        )
        if words and _parted(last, token, unary):
            words.append(" ")
        words.append(token)
        unary = sign
        brackets += {"(": 1, "[": 1, ")": -1, "]": -1}.get(token, 0)
        following = tokens[index + 1] if index + 1 < len(tokens) else ""
        last = token
        if token == "{":
            end()
            depth += 1
        elif token == "}":
            shift = depth
            if following not in (";", ",") and not (is_word(following) and _names_block(tokens, index)):
                end()
            depth = max(shift - 1, 0)
        elif token == ";" and brackets <= 0:
            end()
            brackets = 0
    end()
    return "\n".join(lines) + "\n" if lines else ""


def tidy(text: str) -> str:
    """Return a text without comments, one statement a line."""
    return print_tokens(tokens_of(text))


def _parted(last: str, token: str, unary: bool) -> bool:
    if token in _NO_SPACE_BEFORE or last in _NO_SPACE_AFTER or unary:
        return False
    if token == "[":
        return False
    if token == "(":
        return not (is_word(last) and last not in CONTROL)
    if last in ("++", "--"):
        return token in OPERATORS or token in ASSIGNS
    return True


def _names_block(tokens: Sequence[str], index: int) -> bool:
    """Return whether the word after a closing brace names what the block declared, as ``} light;``."""
    return index + 2 < len(tokens) and tokens[index + 2] in (";", "[") and tokens[index + 1] not in CONTROL
