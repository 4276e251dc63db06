"""Read the runtime's bundles: what esbuild makes of ``runtime/``, committed and shipped.

``npm ci && npm run build`` in this folder makes them again (build.mjs), after any change of a source.
"""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

from playground.errors import PlaygroundError

_HERE = Path(__file__).resolve().parent
_FIRST_LINE = re.compile(r"/\* sources ([0-9a-f]{16}) \*/")

BUNDLES = _HERE / "bundle"
"""The folder of the bundles."""


def read_bundle(name: str) -> str:
    """Return the text of a bundle, as ``page.js``, for a script element of a page.

    Raises ``PlaygroundError`` where it is not there or has an end of a script element in it.
    """
    try:
        text = (BUNDLES / name).read_text(encoding="utf-8")
    except FileNotFoundError:
        advice = "run 'npm ci' and 'npm run build' in playground/publish/web"
        raise PlaygroundError(f"the page runtime {name} is not built; {advice}") from None
    if re.search(r"</(?:script|style)|<!--", text, re.IGNORECASE):
        raise PlaygroundError(f"the page runtime {name} cannot stand in a page: it has the end of an element")
    return text


def sources_in(text: str) -> str:
    """Return the hash of the sources that a bundle was made of, as its first line has it; "": none."""
    match = _FIRST_LINE.match(text)
    return match[1] if match else ""


def hash_of_sources(folder: Path = _HERE) -> str:
    """Return the hash of the sources as they are in a checkout, as build.mjs works it out."""
    names = sorted(p.name for p in (folder / "runtime").iterdir() if p.suffix in (".js", ".css", ".json"))
    digest = hashlib.sha256()
    others = ("build.mjs", "package-lock.json", "../../shader/widgets.json")
    for name in (*others, *(f"runtime/{name}" for name in names)):
        digest.update(f"{name}\0".encode() + (folder / name).read_bytes() + b"\0")
    return digest.hexdigest()[:16]
