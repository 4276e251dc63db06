"""Read a folder of Shadertoy's passes: ``Image``, ``Buffer A`` to ``Buffer D``, ``Cube A`` and ``Common``.

Each is a file, ``.glsl`` or ``.frag``, with a space or ``_`` in its name or without, in capitals or not. What
a channel reads says a line as ``#iChannel0 "file://Buffer A.glsl"`` or a comment as
``// iChannel0: Buffer A``; else channel 0 reads Buffer A, 1 Buffer B and so on, of those that are there.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from playground.errors import SketchError
from playground.paths import shown
from playground.sketch.allowed_files import is_inside
from playground.sketch.dialects.conditions import WEBGL_2, live_code, live_source
from playground.sketch.dialects.directives import read_directives
from playground.sketch.dialects.reading import Files
from playground.sketch.dialects.sampler_types import names_reached, sampler_types
from playground.sketch.dialects.shader import Channel, Shader, stand_in
from playground.sketch.dialects.shadertoy import MACROS
from playground.sketch.dialects.toy_passes import (
    BUFFER,
    CUBE,
    IMAGE,
    ToyInput,
    pass_name,
    reading,
    shaders_of,
    with_common,
)
from playground.sketch.dialects.vscode import Reader
from playground.sketch.header import title_of
from playground.sketch.source import SourceText

_COMMON, _SOUND = "Common", "Sound"
_IMAGE = "Image"
_BUFFERS = tuple(f"Buffer {letter}" for letter in "ABCD")
_CUBES = ("Cube A",)
_LABELS = (*_BUFFERS, *_CUBES, _IMAGE)
_ENDINGS = (".glsl", ".frag")
_COMMENT = re.compile(
    r"\biChannel([0-3])\b\s*(?:[:=]|->|→|reads|is)?\s*(Buffer[ _]?[A-D]|Cube[ _]?A|Keyboard|self)\b",
    re.IGNORECASE,
)
_KEYBOARD = "keyboard"
_MAIN_IMAGE = re.compile(r"\bmainImage\b")


def image_of(folder: Path) -> Path | None:
    """Return the file of a folder's Image; None where it has none of its own that is one."""
    found = next((place for place in _places(folder, _IMAGE) if place.is_file()), None)
    if found is None or not is_inside(found, (folder,)):
        return None
    return found if _MAIN_IMAGE.search(live_code(found.read_text("utf-8", "replace"), WEBGL_2)) else None


def is_of_folder(path: Path) -> bool:
    """Return whether a file is one of a folder's passes, its Image another or itself."""
    return _is_named(path) and image_of(path.parent) is not None


def has_more(files: Files) -> bool:
    """Return whether a file is one of a folder's passes, and others are next to it."""
    path = files.path
    if not _is_named(path):
        return False
    others = [place for place in _all_places(path.parent) if place != path]
    there = [place for place in others if files.is_there(place)]  # all, so that one that comes is seen
    return not all(_is_one_file((path, place)) for place in there) and image_of(path.parent) is not None


def is_image(path: Path) -> bool:
    """Return whether a file is called as the Image of a folder is."""
    return path in _places(path.parent, _IMAGE)


def _is_named(path: Path) -> bool:
    return path.name in {place.name for place in _all_places(path.parent)}


def _all_places(folder: Path) -> list[Path]:
    return [place for label in (*_LABELS, _COMMON, _SOUND) for place in _places(folder, label)]


def shaders(files: Files) -> Sequence[Shader]:
    """Return the passes of the folder that a file is in."""
    folder = files.path.parent
    there = {label: found for label in _LABELS if (found := _file(files, folder, label))}
    if _file(files, folder, _SOUND):
        files.note(f"{_SOUND} is sound, which is not drawn")
    sources = {path: live_source(files.source(path), MACROS) for path in there.values()}
    common = _file(files, folder, _COMMON)
    if any(str(common) in source.files for source in sources.values()):
        common = None  # a pass includes it by itself
    shared = read_directives(files.source(common)).source if common else None
    kinds = {label: IMAGE if label == _IMAGE else CUBE if label in _CUBES else BUFFER for label in _LABELS}
    reader = Reader(
        files,
        labels={path: label for label, path in there.items()},
        kinds={path: kinds[label] for label, path in there.items()},
        inputs={path: _inputs(files, path, source, shared, there) for path, source in sources.items()},
        common=shared,
    )
    for label, path in there.items():
        reader.add(path, kinds[label])
    files.title = title_of(files.source(there[_IMAGE])) or folder.name
    return shaders_of(sorted(reader.passes(), key=lambda one: one.label))


def _inputs(
    files: Files, path: Path, source: SourceText, common: SourceText | None, there: dict[str, Path]
) -> dict[str, ToyInput]:
    """Return what the channels read that no directive names, those that only Common reads too."""
    named: dict[int, str] = {}
    whole, shared = with_common(common, source), common.code if common else ""
    for line in (*source.lines, *(common.lines if common else ())):
        for number, text in _COMMENT.findall(line.comment):
            wanted = pass_name(re.sub("[ _]", "", text))
            own = next(label for label, file in there.items() if file == path)
            label = next((one for one in there if pass_name(one.replace(" ", "")) == wanted), "")
            named.setdefault(int(number), {"self": own, _KEYBOARD: _KEYBOARD}.get(wanted, label))
    taken = read_directives(source).channels
    assumed, unused = {}, {}
    types, read = sampler_types(whole.code), names_reached(shared, source.names)
    for number, buffer in enumerate(_BUFFERS):
        kind = types.get(f"iChannel{number}", "sampler2D")
        label = {"samplerCube": _CUBES[0], "sampler2D": buffer}.get(kind, "")
        if number in named or number in taken:
            continue
        if f"iChannel{number}" not in read:  # what Common does with it, this pass does not call
            unused[number] = ToyInput(Channel(), kind)
        elif label in there:
            named[number] = assumed[number] = label
    if assumed:
        pairs = ", ".join(f"iChannel{number} reads {label}" for number, label in assumed.items())
        files.note(f"nothing says otherwise, so {pairs}; a comment as // iChannel0: Buffer B does", path=path)
    found = unused | {
        number: ToyInput(reading(pass_name(label)), "samplerCube" if label in _CUBES else "sampler2D")
        for number, label in named.items()
        if label in there
    }
    keys = ToyInput(stand_in("keys", 0, ""))
    found |= {number: keys for number, label in named.items() if label == _KEYBOARD}
    return {f"iChannel{number}": feeds for number, feeds in found.items()}


def _file(files: Files, folder: Path, label: str) -> Path | None:
    """Return the file of a pass; raise ``SketchError`` where there are two."""
    found = [place for place in _places(folder, label) if files.is_there(place)]
    if len(found) > 1 and not _is_one_file(found):
        both = " and ".join(shown(place) for place in found[:2])
        raise SketchError(f"{both} are both {label}; remove one", file=shown(files.path))
    if not found:
        return None
    files.check_inside(found[0])
    return found[0].resolve()


def _places(folder: Path, label: str) -> list[Path]:
    return [folder / f"{name}{ending}" for name in _names(label) for ending in _ENDINGS]


def _names(label: str) -> Iterator[str]:
    """Yield what a pass's file may be called, without its ending; the site's own name first."""
    first, space, letter = label.partition(" ")
    for between in (" ", "", "_") if space else ("",):
        for begins in (first, first.lower()):
            yield from (f"{begins}{between}{ends}" for ends in dict.fromkeys((letter, letter.lower())))


def _is_one_file(places: Sequence[Path]) -> bool:
    """Return whether places are one file: where capitals do not count, each of its names is there."""
    return all(place.samefile(places[0]) and not place.is_symlink() for place in places)
