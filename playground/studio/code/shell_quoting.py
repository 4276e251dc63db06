"""Put a file's name into a command that may hold a shell's script, so that no shell reads the name.

A word of its own takes the name as it is: what runs is a list of words. In the script of
``sh -c '…'`` the name would be read again, its blanks, quotes and ``$(…)`` with it. So a script
refers to the name, which follows it as an argument. Any other word with blanks in it, as in
``tmux new-window 'vim {file}'``, is taken for a script too: there the name is quoted. Scripts
inside scripts, as ``sh -c 'bash -c "vim {file}"'``, are refused.
"""

from __future__ import annotations

import re
import shlex
import sys
from collections.abc import Callable, Iterator, Sequence

MARK = "{file}"
SHELLS = frozenset(("sh", "bash", "dash", "ash", "zsh", "ksh", "mksh"))
_SCRIPT = re.compile(r"-[a-z]*c")  # -c, -lc
_NESTED = re.compile(r"(^|[\s;&|(`\"'/])((ba|da|a|z|k|mk)?sh\s+-[a-z]*c|eval|su|ssh)\s")
_BARE, _SINGLE, _DOUBLE = "", "'", '"'


def with_file(words: Sequence[str], file: str, stem: Callable[[str], str]) -> list[str]:
    """Return the words with a file's name in place of each mark; ``stem`` gives a program's name.

    Raises ``ValueError`` in a message where a script hands the name to another shell.
    """
    names: list[str] = []
    for index, word in enumerate(words):
        if MARK not in word or not any(letter.isspace() for letter in word.strip()):
            names.append(word.replace(MARK, file))
            continue
        if _NESTED.search(word):
            raise ValueError(f"'{word}' hands {MARK} to a second shell; write it with one")
        if not _is_script(words, index, stem):
            names.append(
                "".join(_quoted(file, state) if text == MARK else text for text, state in _parts(word))
            )
            continue
        after = [other.replace(MARK, file) for other in words[index + 1 :]] or ["sh"]  # $0, $1 …
        number = f"${{{len(after)}}}"
        script = "".join(_named(number, state) if text == MARK else text for text, state in _parts(word))
        return [*names, script, *after, file]
    return names


def _is_script(words: Sequence[str], index: int, stem: Callable[[str], str]) -> bool:
    """Say whether a word is the argument of a shell's -c."""
    if index < 2 or not _SCRIPT.fullmatch(words[index - 1]):
        return False
    program = next((word for word in reversed(words[: index - 1]) if not word.startswith("-")), "")
    return stem(program) in SHELLS


def _parts(script: str) -> Iterator[tuple[str, str]]:
    """Yield the marks and the characters of a script, each with the quotes around it."""
    inside, at = [_BARE], 0  # quotes and parentheses that are open; those in $( ) begin again
    while at < len(script):
        state = inside[-1]
        if script.startswith(MARK, at):
            yield MARK, state
            at += len(MARK)
            continue
        letter = script[at : at + 2] if state != _SINGLE and script[at] in "\\$" else script[at]
        if letter == "$(" or (state == _BARE and letter == "("):
            inside.append(_BARE)
        elif state == _BARE and letter in (_SINGLE, _DOUBLE):
            inside.append(letter)
        elif letter == state or (state == _BARE and letter == ")" and len(inside) > 1):
            inside.pop()
        elif letter[0] == "$":
            letter = "$"
        yield letter, state
        at += len(letter)


def _named(number: str, state: str) -> str:
    """Return how a script refers to an argument."""
    return {_BARE: f'"{number}"', _DOUBLE: number, _SINGLE: f"'\"{number}\"'"}[state]


def _quoted(file: str, state: str) -> str:
    """Return a name as a shell reads it between such quotes."""
    if sys.platform == "win32":  # no name there holds a quote
        return file if state == _DOUBLE else f'"{file}"'
    if state == _BARE:
        return shlex.quote(file)
    if state == _SINGLE:
        return file.replace("'", "'\"'\"'")
    return re.sub(r'([\\"$`])', r"\\\1", file)
