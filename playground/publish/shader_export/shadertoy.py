"""Write passes as Shadertoy has them: one text, or an export (JSON) with up to four buffers.

Every buffer has the picture's size. A pass of another size is computed in the buffer's lower left
corner, where what reads it only fetches single texels.
"""

from __future__ import annotations

import json
from collections.abc import Sequence

from playground.errors import Diagnostic, SketchError
from playground.publish.shader_export.declarations import (
    Declaration,
    declaration_of,
    literal,
    meaning,
    with_common,
)
from playground.publish.shader_export.passes import ShaderPass
from playground.publish.shader_export.texts import (
    Host,
    PassText,
    handed_on,
    size_of,
    towards,
    with_size_of,
)
from playground.sketch.model import Parameter, Value

MAX_BUFFERS, MAX_CHANNELS, MAX_CORNER = 4, 4, 256
_IDS = ("4dXGR8", "XsXGR8", "4sXGR8", "XdfGR8")
_IMAGE = "4dfGRr"
_LETTERS = "ABCD"
_SIZE = "ivec2(iResolution.xy)"


NATIVE = frozenset(
    {
        ("iResolution", "vec3"),
        ("iTime", "float"),
        ("iTimeDelta", "float"),
        ("iFrame", "int"),
        ("iMouse", "vec4"),
        ("iDate", "vec4"),
        ("iSampleRate", "float"),
        ("iFrameRate", "float"),
        ("iChannelTime", "float[4]"),
        ("iChannelResolution", "vec3[4]"),
    }
)
"""What Shadertoy gives each pass, by name and type."""


def _constant(
    pass_: ShaderPass, parameter: Parameter, value: Value
) -> tuple[tuple[Declaration, ...], tuple[str, ...]]:
    text = f"const {parameter.type} {parameter.name} = {literal(parameter.type, value)};"
    comment = meaning(parameter)
    lines = [declaration_of(f"{text}  // {comment}" if comment else text, parameter.name)]
    if parameter.widget.kind == "direction" and isinstance(value, tuple):
        lines.append(towards(parameter.name, value))
    return tuple(lines), ()


def _no_file(pass_: ShaderPass, parameter: Parameter, value: Value) -> str:
    message = (
        f"pass '{pass_.step.path}' reads the image file {value}, which Shadertoy cannot be given; .fs can"
    )
    raise SketchError(message)


HOST = Host(_SIZE, "ivec2(fragCoord)", "iTime", "iFrame", "fragCoord", _constant, _no_file, NATIVE, "iMouse")


def fitted(texts: Sequence[PassText]) -> list[PassText]:
    """Return passes that know how large a part of its buffer another pass is in."""
    sizes = {text.name: text.size for text in texts}
    result = []
    for text in texts:
        for read in text.reads:
            if sizes[read.source] != (None, None):
                text = with_size_of(text, read.word, size_of(sizes[read.source], HOST))
        result.append(text)
    return result


def check(texts: Sequence[PassText], *, one_text: bool) -> None:
    """Raise ``SketchError`` with a message for each thing that Shadertoy has not."""
    wrong = []
    if one_text and len(texts) > 1:
        names = ", ".join(text.name for text in texts)
        wrong.append(f"a Shadertoy text is one pass; these are {len(texts)} ({names}): export it as .json")
    elif len(texts) - 1 > MAX_BUFFERS:
        names = ", ".join(text.name for text in texts[:-1])
        wrong.append(f"Shadertoy has {MAX_BUFFERS} buffers, and {len(texts) - 1} are needed ({names})")
    by_name = {text.name: text for text in texts}
    for text in texts:
        sources = _sources(text)
        if len(sources) > MAX_CHANNELS:
            wrong.append(
                f"pass '{text.name}' reads {len(sources)} textures; Shadertoy has {MAX_CHANNELS} channels"
            )
        for read in text.reads:
            size = by_name[read.source].size
            if size == (None, None):
                continue
            small = all(side is None or side <= MAX_CORNER for side in size)
            if not small or handed_on(text, read.word):
                shown = " x ".join(str(side or "the picture's") for side in size)
                wrong.append(
                    f"pass '{read.source}' has {shown} texels, a Shadertoy buffer those of the picture;"
                    f" up to {MAX_CORNER} fit in its corner, and only if they are read one by one"
                )
    if wrong:
        raise SketchError(diagnostics=[Diagnostic(message) for message in dict.fromkeys(wrong)])


def one_text(text: PassText, heading: Sequence[str]) -> str:
    """Return the text of one pass that reads no other."""
    return "\n".join([*heading, "", *blocks(text.declarations), *_main(text, is_picture=True)]) + "\n"


def export(texts: Sequence[PassText], name: str, heading: Sequence[str]) -> str:
    """Return an export: the passes, and what they share once as Common."""
    renamed = []
    for text in texts:
        channels = _sources(text)
        names = {read.word: f"iChannel{channels.index(read.source)}" for read in text.reads}
        renamed.append(tuple(d.renamed(names) for d in text.declarations))
    never = (*(f"iChannel{n}" for n in range(MAX_CHANNELS)), *(name for name, _ in NATIVE))
    parted = with_common(renamed, never)
    passes = []
    if parted.shared:
        code = "\n".join(blocks(parted.shared)).rstrip("\n") + "\n"
        passes.append(_pass("Common", "common", code, [], []))
    ids = {text.name: id for text, id in zip(texts[:-1], _IDS, strict=False)}
    for index, (text, own) in enumerate(zip(texts, parted.own, strict=True)):
        is_picture = index == len(texts) - 1
        lines = [*heading, ""] if is_picture else [f"// {text.name}: {text.title}".rstrip(": "), ""]
        code = "\n".join([*lines, *blocks(own), *_main(text, is_picture=is_picture)]) + "\n"
        inputs = [_input(text, source, channel, ids) for channel, source in enumerate(_sources(text))]
        if is_picture:
            passes.append(_pass("Image", "image", code, inputs, [{"id": _IMAGE, "channel": 0}]))
        else:
            output = {"id": ids[text.name], "channel": 0}
            passes.append(_pass(f"Buffer {_LETTERS[index]}", "buffer", code, inputs, [output]))
    info = {"id": "", "date": "0", "viewed": 0, "name": name, "username": "", "likes": 0, "published": 0}
    info |= {"description": " ".join(line.removeprefix("// ") for line in heading), "flags": 0, "hasliked": 0}
    info |= {"usePreview": 0, "tags": ["terrain"]}
    opened_sketch = [{"ver": "0.1", "info": info, "renderpass": passes}]
    return json.dumps(opened_sketch, indent=1, ensure_ascii=True) + "\n"


def _sources(text: PassText) -> list[str]:
    return list(dict.fromkeys(read.source for read in text.reads))


def blocks(declarations: Sequence[Declaration]) -> list[str]:
    """Return declarations as text, a blank line around each that has several lines."""
    lines: list[str] = []
    for each in declarations:
        if "\n" in each.text and lines and lines[-1]:
            lines.append("")
        lines.append(each.text)
        if "\n" in each.text:
            lines.append("")
    return [*lines, ""] if lines and lines[-1] else lines


def _main(text: PassText, *, is_picture: bool) -> list[str]:
    channels = _sources(text)
    names = {read.word: f"iChannel{channels.index(read.source)}" for read in text.reads}
    lines = []
    if text.size != (None, None):
        inside = f"any(greaterThanEqual({HOST.texel}, {size_of(text.size, HOST)}))"
        lines += ["fragColor = vec4(0.0);", f"if ({inside}) return;"]
    lines += [*text.statements, f"fragColor = {text.result};"]
    if text.is_bytes and not is_picture:
        lines.append("fragColor = floor(clamp(fragColor, 0.0, 1.0) * 255.0 + 0.5) / 255.0;")
    body = declaration_of("\n".join(f"    {line}" for line in lines)).renamed(names).text
    return ["void mainImage(out vec4 fragColor, in vec2 fragCoord) {", body, "}"]


def _input(text: PassText, source: str, channel: int, ids: dict[str, str]) -> dict[str, object]:
    samplings = [read.sampling for read in text.reads if read.source == source]
    is_linear = any(s.filter == "linear" for s in samplings)
    how = "mipmap" if any(s.mipmap for s in samplings) else "linear" if is_linear else "nearest"
    wrap = "repeat" if any(s.wrap == "repeat" for s in samplings) else "clamp"
    number = list(ids).index(source)
    return {
        "id": ids[source],
        "src": f"/media/previz/buffer0{number}.png",
        "ctype": "buffer",
        "channel": channel,
        "sampler": {"filter": how, "wrap": wrap, "vflip": "true", "srgb": "false", "internal": "byte"},
        "published": 1,
    }


def _pass(
    name: str, kind: str, code: str, inputs: list[dict[str, object]], outputs: list[dict[str, object]]
) -> dict[str, object]:
    return {"inputs": inputs, "outputs": outputs, "code": code, "name": name, "description": "", "type": kind}
