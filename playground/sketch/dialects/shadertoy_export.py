"""Read a Shadertoy export, JSON: ``{"Shader": …}``, a list of such, or the shader alone.

Its passes are texts in strings. A line of one is named by the file, the pass and its own number.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from playground.errors import SketchError
from playground.json_text import read_json
from playground.paths import shown
from playground.sketch.allowed_files import leads_outside
from playground.sketch.dialects.conditions import live_source
from playground.sketch.dialects.reading import Files
from playground.sketch.dialects.shader import SAMPLING, Channel, Shader, stand_in
from playground.sketch.dialects.shadertoy import MACROS, note_not_drawn
from playground.sketch.dialects.toy_passes import (
    BUFFER,
    CUBE,
    IMAGE,
    OF_BUFFERS,
    ToyInput,
    ToyPass,
    pass_name,
    reading,
    shaders_of,
    with_common,
)
from playground.sketch.model import Sampling

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
    common = next((files.part(one.label, one.code) for one in passes if one.kind == _COMMON), None)
    for one in passes:
        if one.kind == _SOUND:
            files.note(f"{one.label} is sound, which is not drawn")
    drawn = [one for one in passes if one.kind in (IMAGE, BUFFER, CUBE)]
    if not any(one.kind == IMAGE for one in drawn):
        there = ", ".join(one.label for one in passes) or "nothing"
        raise _wrong(files, f"there is no Image pass to draw; there is {there}")
    written = {output: one for one in drawn for output in one.outputs}
    made = []
    for one in sorted(drawn, key=lambda one: one.label):
        source = files.part(one.label, one.code)
        note_not_drawn(files, live_source(source, MACROS))
        inputs = dict(_inputs(files, one, written, drawn))
        made.append(ToyPass(one.label, one.kind, with_common(common, source), inputs))
    info = shader.get("info")
    files.title = str(info.get("name") or "") if isinstance(info, dict) else ""
    return shaders_of(made, "export")


def _table(files: Files) -> Mapping[str, Any]:
    """Return the table that holds ``renderpass``."""
    try:
        found = read_json(files.text(), strict=False)
    except json.JSONDecodeError as error:
        message = f"damaged JSON: {error.msg[:1].lower()}{error.msg[1:]}"
        raise SketchError(message, file=shown(files.path), line=error.lineno, column=error.colno) from None
    except ValueError as error:
        raise _wrong(files, f"damaged JSON: {error}") from None
    several = found if isinstance(found, list) else [found]
    tables = [one.get("Shader", one) for one in several if isinstance(one, dict)]
    shaders = [one for one in tables if isinstance(one, dict) and isinstance(one.get("renderpass"), list)]
    if not shaders:
        raise _wrong(files, "an export holds a list of passes called renderpass, and none is here")
    if len(shaders) > 1:
        files.note(f"this holds {len(shaders)} shaders; the first is drawn")
    return shaders[0]


def _passes(files: Files, shader: Mapping[str, Any]) -> list[_Pass]:
    """Return the passes with their labels, each of them once."""
    found: list[_Pass] = []
    for index, given in enumerate(shader["renderpass"]):
        where = f"renderpass[{index}]"
        if given is None or given == {}:
            continue
        if not isinstance(given, dict):
            raise _wrong(files, f"{where} is not a table of a pass")
        code = given.get("code")
        name = str(given.get("name") or "")
        if not isinstance(code, str):
            raise _wrong(files, f"{name or where} has no code, a text")
        kind = given.get("type") or next((k for sign, k in _BY_NAME if sign.search(name)), IMAGE)
        if kind not in _KINDS:
            files.note(f"{name or where} is of the type '{kind}', which is not drawn")
            continue
        label = _label(kind, name, [one.label for one in found])
        if not label:
            raise _wrong(files, f"{where}: a second pass called {name or kind}")
        inputs = tuple(one for one in given.get("inputs") or () if isinstance(one, dict) and one)
        outputs = given.get("outputs") or ()
        ids = tuple(str(one["id"]) for one in outputs if isinstance(one, dict) and "id" in one)
        found.append(_Pass(label, kind, code, inputs, ids))
    return found


def _label(kind: str, name: str, taken: Sequence[str]) -> str:
    """Return what a pass is called: the site's word for its kind, and a letter; "" where it is taken."""
    one = {_COMMON: "Common", _SOUND: "Sound", IMAGE: "Image"}.get(kind)
    if one:
        return one if one not in taken else ""
    word = "Buffer" if kind == BUFFER else "Cube"
    if (match := _LETTERED.match(name)) and (named := f"{word} {match.group(1).upper()}") not in taken:
        return named
    return next((f"{word} {letter}" for letter in _LETTERS if f"{word} {letter}" not in taken), "")


def _inputs(
    files: Files, one: _Pass, written: Mapping[str, _Pass], drawn: Sequence[_Pass]
) -> list[tuple[str, ToyInput]]:
    found: dict[str, ToyInput] = {}
    for given in one.inputs:
        number = given.get("channel", 0)
        if str(number) not in _CHANNELS:
            raise _wrong(files, f"{one.label}: an input for channel {number}; there are 0 to 3")
        found[f"iChannel{int(number)}"] = _input(files, one, int(number), given, written, drawn)
    return list(found.items())


def _input(
    files: Files,
    one: _Pass,
    number: int,
    given: Mapping[str, Any],
    written: Mapping[str, _Pass],
    drawn: Sequence[_Pass],
) -> ToyInput:
    kind = str(given.get("ctype") or given.get("type") or "texture")
    source = str(given.get("src") or given.get("filepath") or "")
    sampling = _sampling(given.get("sampler"))
    target = _target(kind, str(given.get("id", "")), source, written, drawn)
    if target is not None:
        sampler = "samplerCube" if target.kind == CUBE else "sampler2D"
        return ToyInput(reading(pass_name(target.label), sampling or OF_BUFFERS), sampler)
    if kind == "buffer":
        return ToyInput(Channel(target=f"output {given.get('id', '')}".strip()))
    if kind == "texture" and _is_own(files, source):
        return ToyInput(Channel(sampling=sampling or SAMPLING), file=source)
    if kind == "keyboard":
        return ToyInput(stand_in("keys", 0, ""))
    if kind in _SOUNDS and _is_own(files, source):
        made = replace(stand_in("sound", 0, ""), use="foreign/sound", values=(("sound", source),))
        return ToyInput(replace(made, sampling=sampling or OF_BUFFERS))
    if kind in _SOUNDS:
        unfed = f"it is {_NOT_FED[kind]}, so a made-up sound stands in for it"
        return ToyInput(replace(stand_in("sound", 0, unfed), sampling=sampling or OF_BUFFERS))
    glsl, form = _TYPES.get(kind, ("sampler2D", "picture" if _PHOTO.search(source) else "noise"))
    if kind in _NOT_FED:
        unfed = f"it is {_NOT_FED[kind]}, so a stand-in is drawn"
    elif kind in (*_TYPES, "texture"):
        unfed = f"'{source or kind}' is a file of the site, which is not shipped, so a stand-in is drawn"
    else:
        unfed = f"'{kind}' is not known here, so a stand-in is drawn"
    channel = stand_in(form, number, unfed)
    return ToyInput(replace(channel, sampling=sampling) if sampling else channel, glsl)


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
    return next((one for one in drawn if one.kind == word and one.label.endswith(f" {letter}")), None)


def _is_own(files: Files, source: str) -> bool:
    """Return whether a texture is a file next to the export, not one of the site."""
    if not source or source.startswith("/") or "://" in source or "\0" in source:
        return False
    return files.is_there(files.root / source) and not leads_outside(source, files.root)


def _sampling(given: object) -> Sampling | None:
    """Return how a sampler reads; None where it does not say."""
    if not isinstance(given, dict) or not given:
        return None
    form = str(given.get("filter", "linear"))
    wrap = "repeat" if str(given.get("wrap", "repeat")) == "repeat" else "clamp"
    flip, decode = (str(given.get(word, usual)).lower() for word, usual in (("vflip", True), ("srgb", False)))
    return Sampling(
        "nearest" if form == "nearest" else "linear",
        wrap,
        form == "mipmap",
        flip=flip == "false",
        decode=decode == "true",
    )


def _wrong(files: Files, message: str) -> SketchError:
    return SketchError(message, file=shown(files.path))
