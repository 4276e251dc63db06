"""Shadertoy's passes on disk: an export as JSON, or a folder of files.

The passes of an export are texts in its strings. A line of one is named by the file, the pass and its own
number.

In a folder each pass is a file, ``.glsl`` or ``.frag``, as "Buffer A", with a space, ``_`` or neither, in
any case. A line as ``#iChannel0 "file://Buffer A.glsl"`` or a comment as ``// iChannel0: Buffer A`` says
what a channel reads; without one, channel 0 reads Buffer A, 1 Buffer B and so on, of those that are there.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from playground.allowed_files import is_inside, leads_outside
from playground.errors import SketchError
from playground.json_text import read_json
from playground.paths import shown
from playground.shader.dialects.foreign import SAMPLING, Files, Shader, ShaderChannel, stand_in
from playground.shader.dialects.shadertoy import (
    BUFFER,
    CUBE,
    IMAGE,
    MACROS,
    OF_BUFFERS,
    ToyInput,
    ToyPass,
    names_reached,
    note_not_drawn,
    pass_name,
    read_directives,
    reading,
    sampler_types,
    shaders_of,
    with_common,
)
from playground.shader.dialects.vscode import Reader
from playground.shader.header import title_of
from playground.shader.parameter import Sampling
from playground.shader.preprocessor import WEBGL_2, live_code, live_source
from playground.shader.source import SourceText

_COMMON, _SOUND = "common", "sound"
_KINDS = (IMAGE, BUFFER, CUBE, _COMMON, _SOUND)
_BY_NAME = (
    (re.compile(r"^common\b", re.IGNORECASE), _COMMON),
    (re.compile(r"^sound\b", re.IGNORECASE), _SOUND),
    (re.compile(r"^cube", re.IGNORECASE), CUBE),
    (re.compile(r"^buf", re.IGNORECASE), BUFFER),
    (re.compile(r"^image\b", re.IGNORECASE), IMAGE),
)
_PREVIEW = re.compile(r"/previz/(buffer|cubemap)(\d\d)\.png$")
_PHOTO = re.compile(r"\.(?:jpe?g|webp)$", re.IGNORECASE)
_LETTERS = "ABCDEFGH"
_LETTERED = re.compile(r"\s*(?:buf(?:fer)?|cube(?:map)?)?[\s_]*([a-h])\s*$", re.IGNORECASE)
_CHANNELS = ("0", "1", "2", "3")
_TYPES = {
    "cubemap": ("samplerCube", "sky"),
    "volume": ("sampler3D", "volume"),
    "video": ("sampler2D", "picture"),
    "webcam": ("sampler2D", "picture"),
}
_SOUNDS = ("music", "musicstream", "mic")
_NOT_FED = {
    "video": "a video",
    "webcam": "a camera",
    "mic": "a microphone",
    "music": "music",
    "musicstream": "a stream of music",
}


@dataclass(frozen=True)
class _Pass:
    """One entry of ``renderpass``."""

    label: str
    kind: str
    code: str
    inputs: tuple[Mapping[str, Any], ...]
    outputs: tuple[str, ...]


def shaders(files: Files) -> Sequence[Shader]:
    """Return the passes of an export; raise ``SketchError`` for what is damaged or draws nothing."""
    shader = _table(files)
    passes = _passes(files, shader)
    common = next((files.part(pass_.label, pass_.code) for pass_ in passes if pass_.kind == _COMMON), None)
    for pass_ in passes:
        if pass_.kind == _SOUND:
            files.note(f"{pass_.label} is sound, which is not drawn")
    drawn = [pass_ for pass_ in passes if pass_.kind in (IMAGE, BUFFER, CUBE)]
    if not any(item.kind == IMAGE for item in drawn):
        there = ", ".join(pass_.label for pass_ in passes) or "nothing"
        raise _wrong(files, f"there is no Image pass to draw; there is {there}")
    written = {output: item for item in drawn for output in item.outputs}
    made = []
    for pass_ in sorted(drawn, key=lambda item: item.label):
        source = files.part(pass_.label, pass_.code)
        note_not_drawn(files, live_source(source, MACROS))
        inputs = dict(_inputs(files, pass_, written, drawn))
        made.append(ToyPass(pass_.label, pass_.kind, with_common(common, source), inputs))
    info = shader.get("info")
    files.title = str(info.get("name") or "") if isinstance(info, dict) else ""
    return shaders_of(made, "export")


def _table(files: Files) -> Mapping[str, Any]:
    """Return the table that holds ``renderpass``."""
    try:
        document = read_json(files.text(), strict=False)
    except json.JSONDecodeError as error:
        message = f"damaged JSON: {error.msg[:1].lower()}{error.msg[1:]}"
        raise SketchError(message, file=shown(files.path), line=error.lineno, column=error.colno) from None
    except ValueError as error:
        raise _wrong(files, f"damaged JSON: {error}") from None
    several = document if isinstance(document, list) else [document]
    tables = [table.get("Shader", table) for table in several if isinstance(table, dict)]
    shaders = [
        table for table in tables if isinstance(table, dict) and isinstance(table.get("renderpass"), list)
    ]
    if not shaders:
        raise _wrong(files, "an export holds a list of passes called renderpass, and none is here")
    if len(shaders) > 1:
        files.note(f"this holds {len(shaders)} shaders; the first is drawn")
    return shaders[0]


def _passes(files: Files, shader: Mapping[str, Any]) -> list[_Pass]:
    """Return the passes with their labels, each of them once."""
    passes: list[_Pass] = []
    for index, table in enumerate(shader["renderpass"]):
        where = f"renderpass[{index}]"
        if table is None or table == {}:
            continue
        if not isinstance(table, dict):
            raise _wrong(files, f"{where} is not a table of a pass")
        code = table.get("code")
        name = str(table.get("name") or "")
        if not isinstance(code, str):
            raise _wrong(files, f"{name or where} has no code, a text")
        kind = table.get("type") or next((k for sign, k in _BY_NAME if sign.search(name)), IMAGE)
        if kind not in _KINDS:
            files.note(f"{name or where} is of the type '{kind}', which is not drawn")
            continue
        label = _label(kind, name, [toy.label for toy in passes])
        if not label:
            raise _wrong(files, f"{where}: a second pass called {name or kind}")
        inputs = tuple(toy for toy in table.get("inputs") or () if isinstance(toy, dict) and toy)
        outputs = table.get("outputs") or ()
        ids = tuple(str(toy["id"]) for toy in outputs if isinstance(toy, dict) and "id" in toy)
        passes.append(_Pass(label, kind, code, inputs, ids))
    return passes


def _label(kind: str, name: str, taken: Sequence[str]) -> str:
    """Return what a pass is called: the site's word for its kind, and a letter; "" where it is taken."""
    label = {_COMMON: "Common", _SOUND: "Sound", IMAGE: "Image"}.get(kind)
    if label:
        return label if label not in taken else ""
    word = "Buffer" if kind == BUFFER else "Cube"
    if (match := _LETTERED.match(name)) and (named := f"{word} {match.group(1).upper()}") not in taken:
        return named
    return next((f"{word} {letter}" for letter in _LETTERS if f"{word} {letter}" not in taken), "")


def _inputs(
    files: Files, toy: _Pass, written: Mapping[str, _Pass], drawn: Sequence[_Pass]
) -> list[tuple[str, ToyInput]]:
    channels: dict[str, ToyInput] = {}
    for table in toy.inputs:
        number = table.get("channel", 0)
        if str(number) not in _CHANNELS:
            raise _wrong(files, f"{toy.label}: an input for channel {number}; there are 0 to 3")
        channels[f"iChannel{int(number)}"] = _input(files, toy, int(number), table, written, drawn)
    return list(channels.items())


def _input(
    files: Files,
    toy: _Pass,
    number: int,
    table: Mapping[str, Any],
    written: Mapping[str, _Pass],
    drawn: Sequence[_Pass],
) -> ToyInput:
    kind = str(table.get("ctype") or table.get("type") or "texture")
    source = str(table.get("src") or table.get("filepath") or "")
    sampling = _sampling(table.get("sampler"))
    target = _target(kind, str(table.get("id", "")), source, written, drawn)
    if target is not None:
        sampler = "samplerCube" if target.kind == CUBE else "sampler2D"
        return ToyInput(reading(pass_name(target.label), sampling or OF_BUFFERS), sampler)
    if kind == "buffer":
        return ToyInput(ShaderChannel(target=f"output {table.get('id', '')}".strip()))
    if kind == "texture" and _is_own(files, source):
        return ToyInput(ShaderChannel(sampling=sampling or SAMPLING), file=source)
    if kind == "keyboard":
        return ToyInput(stand_in("keys", 0, ""))
    if kind in _SOUNDS and _is_own(files, source):
        made = stand_in("sound", 0, "", sampling or OF_BUFFERS)
        return ToyInput(replace(made, use="foreign/sound", values=(("sound", source),)))
    if kind in _SOUNDS:
        unfed = f"it is {_NOT_FED[kind]}, so a made-up sound stands in for it"
        return ToyInput(stand_in("sound", 0, unfed, sampling or OF_BUFFERS))
    glsl, form = _TYPES.get(kind, ("sampler2D", "picture" if _PHOTO.search(source) else "noise"))
    if kind in _NOT_FED:
        unfed = f"it is {_NOT_FED[kind]}, so a stand-in is drawn"
    elif kind in (*_TYPES, "texture"):
        unfed = f"'{source or kind}' is a file of the site, which is not shipped, so a stand-in is drawn"
    else:
        unfed = f"'{kind}' is not known here, so a stand-in is drawn"
    return ToyInput(stand_in(form, number, unfed, sampling), glsl)


def _target(
    kind: str, output: str, source: str, written: Mapping[str, _Pass], drawn: Sequence[_Pass]
) -> _Pass | None:
    """Return the pass that an input reads: by the output's id, else by the picture that stands for it."""
    if kind not in ("buffer", "cubemap", "texture"):
        return None
    if output in written:
        return written[output]
    match = _PREVIEW.search(source)
    word = {"buffer": BUFFER, "cubemap": CUBE}[match.group(1)] if match else ""
    letter = _LETTERS[int(match.group(2)) : int(match.group(2)) + 1] if match else ""
    return next((toy for toy in drawn if toy.kind == word and toy.label.endswith(f" {letter}")), None)


def _is_own(files: Files, source: str) -> bool:
    """Return whether a texture is a file next to the export, not one of the site."""
    if not source or source.startswith("/") or "://" in source or "\0" in source:
        return False
    return files.is_there(files.root / source) and not leads_outside(source, files.root)


def _sampling(table: object) -> Sampling | None:
    """Return how a sampler reads; None where it does not say."""
    if not isinstance(table, dict) or not table:
        return None
    form = str(table.get("filter", "linear"))
    wrap = "repeat" if str(table.get("wrap", "repeat")) == "repeat" else "clamp"
    flip, decode = (str(table.get(word, usual)).lower() for word, usual in (("vflip", True), ("srgb", False)))
    return Sampling(
        "nearest" if form == "nearest" else "linear",
        wrap,
        form == "mipmap",
        flip=flip == "false",
        decode=decode == "true",
    )


def _wrong(files: Files, message: str) -> SketchError:
    return SketchError(message, file=shown(files.path))


_COMMON_FILE, _SOUND_FILE = "Common", "Sound"
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
    path_found = next((path for path in _places(folder, _IMAGE) if path.is_file()), None)
    if path_found is None or not is_inside(path_found, (folder,)):
        return None
    return (
        path_found
        if _MAIN_IMAGE.search(live_code(path_found.read_text("utf-8", "replace"), WEBGL_2))
        else None
    )


def is_of_folder(path: Path) -> bool:
    """Return whether a file is one of a folder's passes, its Image another or itself."""
    return _is_named(path) and image_of(path.parent) is not None


def has_more(files: Files) -> bool:
    """Return whether a file is one of a folder's passes, and others are next to it."""
    path = files.path
    if not _is_named(path):
        return False
    others = [path_there for path_there in _all_places(path.parent) if path_there != path]
    there = [
        path_there for path_there in others if files.is_there(path_there)
    ]  # all, so that one that comes is seen
    return (
        not all(_is_one_file((path, path_there)) for path_there in there)
        and image_of(path.parent) is not None
    )


def is_image(path: Path) -> bool:
    """Return whether a file is called as the Image of a folder is."""
    return path in _places(path.parent, _IMAGE)


def _is_named(path: Path) -> bool:
    return path.name in {path_there.name for path_there in _all_places(path.parent)}


def _all_places(folder: Path) -> list[Path]:
    return [path for label in (*_LABELS, _COMMON_FILE, _SOUND_FILE) for path in _places(folder, label)]


def folder_passes(files: Files) -> Sequence[Shader]:
    """Return the passes of the folder that a file is in."""
    folder = files.path.parent
    there = {label: file for label in _LABELS if (file := _file(files, folder, label))}
    if _file(files, folder, _SOUND_FILE):
        files.note(f"{_SOUND_FILE} is sound, which is not drawn")
    sources = {path: live_source(files.source(path), MACROS) for path in there.values()}
    common = _file(files, folder, _COMMON_FILE)
    if any(str(common) in source.files for source in sources.values()):
        common = None  # a pass includes it by itself
    shared = read_directives(files.source(common)).source if common else None
    kinds = {label: IMAGE if label == _IMAGE else CUBE if label in _CUBES else BUFFER for label in _LABELS}
    reader = Reader(
        files,
        labels={path: label for label, path in there.items()},
        kinds={path: kinds[label] for label, path in there.items()},
        inputs={path: _folder_inputs(files, path, source, shared, there) for path, source in sources.items()},
        common=shared,
    )
    for label, path in there.items():
        reader.add(path, kinds[label])
    files.title = title_of(files.source(there[_IMAGE])) or folder.name
    return shaders_of(sorted(reader.passes(), key=lambda item: item.label))


def _folder_inputs(
    files: Files, path: Path, source: SourceText, common: SourceText | None, there: dict[str, Path]
) -> dict[str, ToyInput]:
    """Return what the channels read that no directive names, those that only Common reads too."""
    named: dict[int, str] = {}
    whole, shared = with_common(common, source), common.code if common else ""
    for line in (*source.lines, *(common.lines if common else ())):
        for number, text in _COMMENT.findall(line.comment):
            target = pass_name(re.sub("[ _]", "", text))
            own = next(label for label, file in there.items() if file == path)
            label = next((item for item in there if pass_name(item.replace(" ", "")) == target), "")
            named.setdefault(int(number), {"self": own, _KEYBOARD: _KEYBOARD}.get(target, label))
    taken = read_directives(source).channels
    assumed, unused = {}, {}
    types, read = sampler_types(whole.code), names_reached(shared, source.names)
    for number, buffer in enumerate(_BUFFERS):
        kind = types.get(f"iChannel{number}", "sampler2D")
        label = {"samplerCube": _CUBES[0], "sampler2D": buffer}.get(kind, "")
        if number in named or number in taken:
            continue
        if f"iChannel{number}" not in read:  # what Common does with it, this pass does not call
            unused[number] = ToyInput(ShaderChannel(), kind)
        elif label in there:
            named[number] = assumed[number] = label
    if assumed:
        pairs = ", ".join(f"iChannel{number} reads {label}" for number, label in assumed.items())
        files.note(f"nothing says otherwise, so {pairs}; a comment as // iChannel0: Buffer B does", path=path)
    result = unused | {
        number: ToyInput(reading(pass_name(label)), "samplerCube" if label in _CUBES else "sampler2D")
        for number, label in named.items()
        if label in there
    }
    keys = ToyInput(stand_in("keys", 0, ""))
    result |= {number: keys for number, label in named.items() if label == _KEYBOARD}
    return {f"iChannel{number}": feeds for number, feeds in result.items()}


def _file(files: Files, folder: Path, label: str) -> Path | None:
    """Return the file of a pass; raise ``SketchError`` where there are two."""
    paths = [path for path in _places(folder, label) if files.is_there(path)]
    if len(paths) > 1 and not _is_one_file(paths):
        both = " and ".join(shown(path) for path in paths[:2])
        raise SketchError(f"{both} are both {label}; remove one", file=shown(files.path))
    if not paths:
        return None
    files.check_inside(paths[0])
    return paths[0].resolve()


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
    return all(path.samefile(places[0]) and not path.is_symlink() for path in places)
