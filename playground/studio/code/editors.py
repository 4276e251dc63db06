"""Open a file at a line in the editor that its user likes: which one, and how each takes the line.

In this order: ``$PLAYGROUND_EDITOR``, ``$VISUAL``, ``$EDITOR``, then the known editors that
are installed. ``builtin`` names the editor in the window itself, which is also what is left
where there is no other. What runs is a list of words: a command that would have a shell read
the file's name is refused.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from playground.studio.language import tr

VARIABLES = ("PLAYGROUND_EDITOR", "VISUAL", "EDITOR")
BUILT_IN = "builtin"
MARK = "{file}"
_TAIL_BYTES = 4000  # last bytes of a failing editor's messages that are read
_SHELLS = frozenset(("sh", "bash", "dash", "ash", "zsh", "ksh", "mksh"))
_SCRIPT = re.compile(r"-[a-z]*c")  # the options -c and -lc of a shell, which a script follows

_COLON = ("{file}:{line}:{column}",)
_PLUS = ("+{line}", "{file}")
_PLUS_COLON = ("+{line}:{column}", "{file}")
_LINE_COLUMN = ("--line", "{line}", "--column", "{column}", "{file}")
_CURSOR = ("+call cursor({line},{column})", "{file}")

PLACES: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("code", "code-insiders", "codium", "vscodium", "cursor", "windsurf"), ("-g", *_COLON)),
    **dict.fromkeys(("subl", "sublime_text", "zed", "zeditor", "hx", "helix", "lapce"), _COLON),
    **dict.fromkeys(("gedit", "emacs", "emacsclient", "kak", "micro"), _PLUS_COLON),
    **dict.fromkeys(("vim", "nvim", "gvim", "mvim", "nvim-qt"), _CURSOR),
    **dict.fromkeys(("vi", "joe", "mg", "ne", "pluma", "bbedit"), _PLUS),
    **dict.fromkeys(("kate", "kwrite", "geany", "idea", "pycharm", "clion", "rider"), _LINE_COLUMN),
    "nano": ("+{line},{column}", "{file}"),
    "notepad++": ("-n{line}", "-c{column}", "{file}"),
    "mate": ("--line", "{line}:{column}", "{file}"),
    "xed": ("--line", "{line}", "{file}") if sys.platform == "darwin" else _PLUS,
}
"""How each editor, by its program's name, takes the place; any other gets the file alone."""

IN_A_TERMINAL = frozenset(
    ("vim", "nvim", "vi", "nano", "hx", "helix", "kak", "micro", "joe", "mg", "ne", "ed")
)
"""Editors that need a terminal to run in; so does emacs when it gets ``-nw``."""

TERMINALS: dict[str, tuple[str, ...]] = {
    "x-terminal-emulator": ("-e",),
    "gnome-terminal": ("--",),
    "kgx": ("--",),
    "ptyxis": ("--",),
    "konsole": ("-e",),
    "xfce4-terminal": ("-x",),
    "kitty": (),
    "foot": (),
    "alacritty": ("-e",),
    "wezterm": ("start", "--"),
    "xterm": ("-e",),
}
"""What comes between each terminal and the command that runs in it; ``-e`` for any other."""

_WINDOWED = ("code", "codium", "cursor", "zed", "subl", "kate", "gedit", "geany", "notepad++")
_ON_A_MAC = ("bbedit", "mate", "xed")
_IN_TERMINALS = (("nvim",), ("vim",), ("nano",), ("emacs", "-nw"))

Which = Callable[[str], str | None]


@dataclass(frozen=True, slots=True)
class Editor:
    """An editor that can be started."""

    words: tuple[str, ...]  # the program, and its fixed arguments
    terminal: tuple[str, ...] = ()  # what it runs in, if it needs that

    @property
    def name(self) -> str:
        """Return the program's name: "code", "vim"."""
        return _stem(self.words[0])

    def command(self, file: Path, line: int = 0, column: int = 0) -> list[str]:
        """Return the words that open a file at a line and a column, both from 1; 0 where unknown.

        Raises ``ValueError`` where a shell would read the file's name.
        """
        words, template = list(self.words), PLACES.get(self.name, ("{file}",))
        if any(MARK in word for word in words):
            words, template = [], tuple(self.words)
        if self.name == "emacsclient" and "-t" not in words and "-nw" not in words and "-n" not in words:
            words.append("-n")  # or it waits until the file is closed
        row, place_in_row = str(max(line, 1)), str(max(column, 1))
        words += [word.replace("{line}", row).replace("{column}", place_in_row) for word in template]
        _check_marks(words)
        return [*self.terminal, *(word.replace(MARK, str(file.absolute())) for word in words)]


def find_editor(
    environ: Mapping[str, str] | None = None, which: Which = shutil.which, platform: str = sys.platform
) -> tuple[Editor | None, str]:
    """Return (the editor to use, a message on a requested one that cannot be used).

    None: the one in the window. The message is ``""`` where there is nothing to say.
    """
    environ = os.environ if environ is None else environ
    complaint = ""
    for variable in VARIABLES:
        command = environ.get(variable, "").strip()
        if not command:
            continue
        if command == BUILT_IN:
            return None, complaint
        editor, why = _named_by(command, environ, which, platform)
        if editor is not None:
            return editor, complaint
        complaint = complaint or f"${variable} {why}"
    names = [*_WINDOWED, *(_ON_A_MAC if platform == "darwin" else ())]
    if platform == "win32":
        folders = filter(None, (environ.get(name) for name in ("ProgramFiles", "ProgramFiles(x86)")))
        names += [rf"{folder}\Notepad++\notepad++.exe" for folder in folders]
    for name in names:
        if path := which(name):
            return Editor((path,)), complaint
    if platform == "darwin" and which("open"):
        return Editor(("open", "-t")), complaint
    terminal = find_terminal(environ, which)
    for words in _IN_TERMINALS if terminal else ():
        if path := which(words[0]):
            return Editor((path, *words[1:]), terminal), complaint
    return None, complaint


def find_terminal(environ: Mapping[str, str], which: Which = shutil.which) -> tuple[str, ...]:
    """Return the words that run a command in a new terminal; none where there is no terminal."""
    try:
        words = shlex.split(environ.get("TERMINAL", ""))
    except ValueError:
        words = []
    if words and (path := which(words[0])):
        return (path, *words[1:], *TERMINALS.get(_stem(words[0]), ("-e",)))
    for name, between in TERMINALS.items():
        if path := which(name):
            return (path, *between)
    return ()


def _named_by(
    command: str, environ: Mapping[str, str], which: Which, platform: str
) -> tuple[Editor | None, str]:
    """Return the editor that a variable names, or why it cannot be used."""
    if path := which(command):  # a path with blanks in it, as on Windows
        words = [path]
    else:
        try:
            words = [word.strip('"') for word in shlex.split(command, posix=platform != "win32")]
        except ValueError as error:
            return None, tr("is not a command: {error}", error=error)
        if not words:
            return None, tr("names no program")
        result = which(words[0])
        if result is None:
            return None, tr("names {program}, which is not installed", program=words[0])
        words[0] = result
    name = _stem(words[0])
    if name in IN_A_TERMINAL or (name in ("emacs", "emacsclient") and {"-nw", "-t"} & set(words)):
        terminal = find_terminal(environ, which)
        if not terminal:
            return None, tr(
                "names {program}, and there is no terminal to open it in; $TERMINAL can name one",
                program=name,
            )
        return Editor(tuple(words), terminal), ""
    return Editor(tuple(words)), ""


def _stem(program: str) -> str:
    """Return a program's name without its folder and without .exe, .cmd or .bat."""
    name = program.replace("\\", "/").rpartition("/")[2].lower()
    stem, dot, ending = name.rpartition(".")
    return stem if dot and ending in ("exe", "cmd", "bat", "com") else name


def _check_marks(words: list[str]) -> None:
    """Raise ``ValueError`` for a file's name inside a script, where a shell would read it."""
    is_shell = any(_stem(word) in _SHELLS for word in words)
    for option, word in pairwise(words):
        has_blanks = any(letter.isspace() for letter in word.strip())
        if MARK in word and (has_blanks or (is_shell and _SCRIPT.fullmatch(option))):
            raise ValueError(f"a shell would read the file's name in '{word}'; make {MARK} a word of its own")


class Opener:
    """Starts editors and waits for them in the background; what went wrong is in ``notes``."""

    def __init__(self, wake: Callable[[], None] = lambda: None) -> None:
        self.notes: deque[str] = deque(maxlen=8)  # messages; removed when they are shown
        self.threads: list[threading.Thread] = []
        self._wake = wake

    def open(self, editor: Editor, file: Path, line: int = 0, column: int = 0) -> bool:
        """Start an editor on a file; return whether it started. Does not wait for it."""
        try:
            command = editor.command(file, line, column)
        except ValueError as error:
            self.notes.append(tr("{editor} was not started: {error}", editor=editor.name, error=error))
            return False
        errors = tempfile.TemporaryFile()
        try:
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=errors,
                cwd=file.absolute().parent if file.parent.is_dir() else None,
                start_new_session=True,  # a Ctrl-C in our terminal is not the editor's
            )
        except (OSError, ValueError) as error:
            errors.close()
            reason = getattr(error, "strerror", None) or str(error)
            self.notes.append(
                tr("{editor} could not be started: {reason}", editor=editor.name, reason=reason)
            )
            return False

        def wait() -> None:
            status = process.wait()
            if status != 0:
                errors.seek(max(errors.seek(0, os.SEEK_END) - _TAIL_BYTES, 0))
                text = errors.read().decode("utf-8", "replace").strip()
                last = text.splitlines()[-1].strip()[:200] if text else tr("it gave no reason")
                self.notes.append(
                    tr(
                        "{editor} ended with status {status}: {last}",
                        editor=editor.name,
                        status=status,
                        last=last,
                    )
                )
                self._wake()
            errors.close()

        self.threads = [thread for thread in self.threads if thread.is_alive()]
        self.threads.append(threading.Thread(target=wait, daemon=True, name=f"waits for {editor.name}"))
        self.threads[-1].start()
        return True
