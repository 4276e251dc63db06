"""Name the pictures of tests in Python: each name is a file's on every system, and one test's of a run.

A picture without a name of its own is named after its test: ``test_waves[1.0]`` gives
``waves-1-0-e775a0``. Characters other than ASCII letters, digits, _ and - become -, and six
digits of a hash then keep apart what would be one name: ``waves[1.0]`` and ``waves[1,0]``. So they
do for capitals in parameters, ``waves[a]`` and ``waves[A]``, which are one file on macOS and
Windows, and for what is long and cut. The name follows from the test's id alone, so it is
the same whichever tests run.

The first test to check a picture of a name claims it, with a file in the folder of results that
only one process can make:

    <folder>/<sketch>/.names/<run>/<renderer>.<hash of the name>.json

Names that are one file on macOS or Windows are one name here. Two tests may share a reference
that both of them name, and name alike; if both write it, the pictures must be the same, and
none may write it once another has found that it matches. A name that comes from a test's own is
that test's alone.
"""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import unicodedata
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.files import make_folder
from playground.verify.shots.results import claim_file

# ── names ────────────────────────────────────────────────────────────────────


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


# ── claims: each name is one test's in all processes of the run ──────────────


_FOLDER = ".names"

KEPT = "kept"


@dataclass(frozen=True)
class Claim:
    """Who checks which picture under a name."""

    name: str
    node: str  # pytest's id of the test
    own: bool  # whether the name is the test's own, and not given
    # Of the reference: SHA-256 of the picture that is written as it, KEPT where it matches; "" before that.
    digest: str = ""


def writing(name: str, node: str, pixels: NDArray[np.uint8]) -> Claim:
    """Return the claim of a test that writes a picture as a reference."""
    digest = hashlib.sha256(str(pixels.shape).encode() + pixels.tobytes()).hexdigest()
    return Claim(name, node, False, digest)


def keeping(name: str, node: str) -> Claim:
    """Return the claim of a test that leaves the reference as it is, for it matches."""
    return Claim(name, node, False, KEPT)


class Claims:
    """The names that this process knows of, and those in a folder of results."""

    def __init__(self, run: str) -> None:
        self._run = run
        self._known: dict[tuple[str, str, bool], Claim] = {}  # by folder of references, name, whether written

    def refusal(self, claim: Claim, references: Path, folder: Path | None) -> str:
        """Return why a test may not check, or write, a picture under a name; "" once it has claimed it.

        ``references`` is the folder of the references, one for each renderer; ``folder`` that of the
        records in the results, None where nothing can be written there.
        """
        key = (str(references), one_spelling(claim.name), bool(claim.digest))
        first = self._known.get(key)
        if first is None:
            first = self._known[key] = self._first(claim, references.name, folder)
        return _refusal(claim, first)

    def _first(self, claim: Claim, renderer: str, folder: Path | None) -> Claim:
        """Claim a name in all processes, or return the claim that was there before."""
        if folder is None:
            return claim
        key = hashlib.sha256(one_spelling(claim.name).encode()).hexdigest()[:24]
        file = folder / _FOLDER / self._run / f"{renderer}.{key}{'.written' if claim.digest else ''}.json"
        try:
            make_folder(file.parent)
            return Claim(**json.loads(claim_file(file, json.dumps(asdict(claim)))))
        except (OSError, ValueError):
            return claim  # within this process, names are kept apart all the same


def _refusal(claim: Claim, first: Claim) -> str:
    if first.node == claim.node:
        return ""
    if first.name != claim.name:
        return (
            f"{first.node} has a picture named {first.name!r}, which is the same file as {claim.name!r} on "
            "macOS and Windows: give one of them another name"
        )
    if first.own or claim.own:
        return f"{first.node} has a picture of that name, {claim.name!r}: give one of them another name"
    if first.digest != claim.digest and first.digest == KEPT:
        return f"{first.node} has a picture of that name that matches: give one of them another name"
    if first.digest != claim.digest:
        return f"{first.node} has just written another picture of that name"
    return ""


def forget_claims(folder: Path) -> None:
    """Remove all claims from a folder of results, when its run is over."""
    for folder_path in folder.glob(f"*/{_FOLDER}"):
        shutil.rmtree(folder_path, ignore_errors=True)
