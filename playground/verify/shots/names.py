"""Name the pictures of tests in Python, so that each name is a file's on every system.

A picture without a name of its own is named after its test: ``test_waves[1.0]`` gives
``waves-1-0-e775a0``. Characters other than ASCII letters, digits, _ and - become -, and six
digits of a hash then keep apart what would be one name: ``waves[1.0]`` and ``waves[1,0]``. So they
do for capitals in parameters, ``waves[a]`` and ``waves[A]``, which are one file on macOS and
Windows, and for what is long and cut. The name follows from the test's id alone, so it is
the same whichever tests run.
"""

from __future__ import annotations

import hashlib
import re
import unicodedata

MAX_NAME = 80
"""[characters] Of a name: with folders and endings a path stays below what Windows takes."""

_DEVICES = re.compile(r"(?i)(con|prn|aux|nul|com[0-9¹²³]|lpt[0-9¹²³])")
_OWN = ("references",)  # what the test of unused references is recorded as


def name_of_test(node: str) -> str:
    """Return the name of a test's picture, from its node id."""
    head, bracket, parameters = node.partition("::")[2].partition("[")
    *classes, function = head.split("::")
    short = function.removeprefix("test_")
    if not short or _reserved(short):
        short = function
    words = [*(name.removeprefix("Test") or name for name in classes), short]
    whole = "-".join(words) + (f"-{parameters.removesuffix(']')}" if bracket else "")
    safe = re.sub(r"[^A-Za-z0-9_-]+", "-", whole)
    alone = safe == whole and parameters == parameters.lower()
    if alone and len(whole) <= MAX_NAME and not _reserved(whole):
        return whole
    digest = hashlib.sha256(whole.encode("utf-8", "surrogatepass")).hexdigest()[:6]
    return f"{safe[: MAX_NAME - 7].rstrip('-')}-{digest}"


def why_no_name(name: str) -> str:
    """Return why a picture cannot have a name; "" where it can."""
    if not re.fullmatch(r"[\w-]+", name):
        return "a picture needs a name of letters, digits, _ and -"
    if len(name) > MAX_NAME:
        return f"a picture's name has at most {MAX_NAME} characters; this one has {len(name)}"
    if _DEVICES.fullmatch(name):
        return "Windows keeps that name for a device, so no file there can have it"
    return ""


def one_spelling(name: str) -> str:
    """Return what two names share that are one file on macOS or Windows."""
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name).casefold())


def _reserved(name: str) -> bool:
    return bool(_DEVICES.fullmatch(name)) or name in _OWN
