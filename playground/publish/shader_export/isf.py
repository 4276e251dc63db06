"""Write passes as one ISF file: a target for each pass, an input for each parameter.

All passes share one text, in which no name means two things. Parameters that one export of a
technique ties together are one input.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from playground.data.image_files import read_image
from playground.errors import SketchError
from playground.publish.shader_export.declarations import Declaration, declaration_of, joined
from playground.publish.shader_export.passes import ExportPlan, ShaderPass
from playground.publish.shader_export.texts import DECODE, DECODING, Host, PassText, is_sampled, variable_of
from playground.shader.colours import linear_to_srgb
from playground.shader.parameter import label_of
from playground.shader.reserved_names import GLSL_WORDS, TOWARDS
from playground.sketch.assign import resolve, shown_parameters
from playground.sketch.model import Kernel, Parameter, Value

WORDS = frozenset(
    """TIME TIMEDELTA FRAMEINDEX PASSINDEX RENDERSIZE DATE isf_FragNormCoord vv_FragNormCoord IMG_PIXEL
    IMG_NORM_PIXEL IMG_THIS_PIXEL IMG_THIS_NORM_PIXEL IMG_SIZE inputImage main""".split()
)
_RENDER, _TEXEL = "ivec2(RENDERSIZE)", "ivec2(gl_FragCoord.xy)"
_UNIT = (
    "vec3 unit_towards(vec2 direction) {",
    "    vec2 turned = radians(direction);",
    "    return vec3(vec2(sin(turned.x), cos(turned.x)) * cos(turned.y), sin(turned.y));",
    "}",
)
_UNBOUNDED = 10.0  # times its value: how far the slider of a parameter without a range goes


@dataclass
class Inputs:
    """The inputs and the imported images of one file, as its passes come to need them."""

    paths: Mapping[str, str]  # of a pass's parameter → that under which a panel shows it
    shown: Mapping[str, Parameter]  # by that path: the parameter as a panel shows it
    words: Mapping[str, set[str]]  # name of a parameter in the texts → the paths that it stands for
    taken: set[str]
    header: list[dict[str, Any]] = field(default_factory=list)
    images: dict[str, Path] = field(default_factory=dict)  # name of an image → its file
    decoded: dict[str, PassText] = field(default_factory=dict)  # name of an image → the pass that decodes it
    unbounded: list[str] = field(default_factory=list)  # labels of inputs whose range is made up
    _known: dict[str, str] = field(default_factory=dict)  # path → the expression of its value

    def host(self) -> Host:
        """Return what ISF gives a pass."""
        return Host(_RENDER, _TEXEL, "TIME", "FRAMEINDEX", "gl_FragCoord.xy", self.parameter, self.file)

    def parameter(
        self, pass_: ShaderPass, parameter: Parameter, value: Value
    ) -> tuple[tuple[Declaration, ...], tuple[str, ...]]:
        """Return what declares a parameter of a pass, and what sets it from the file's inputs."""
        path = self.paths[f"{pass_.step.path}.{parameter.name}"]
        expression = self._input(path, parameter, value)
        declarations: list[Declaration] = []
        lines: list[str] = []
        if expression != parameter.name:
            declarations.append(variable_of(parameter.type, parameter.name))
            lines.append(f"{parameter.name} = {expression};")
        if DECODE in expression:
            declarations.append(DECODING)
        if parameter.widget.kind == "direction":
            name = f"{TOWARDS}{parameter.name}"
            declarations += [declaration_of("\n".join(_UNIT), "unit_towards"), variable_of("vec3", name)]
            lines.append(f"{name} = unit_towards({parameter.name});")
        return tuple(declarations), tuple(lines)

    def file(self, pass_: ShaderPass, parameter: Parameter, value: Value) -> str:
        """Return the pass that gives an image file's texels in linear light."""
        path = Path(str(value))
        for name, image in self.images.items():
            if image == path:
                return self.decoded[name].name
        name = self._free(parameter.name)
        self.images[name] = path
        height, width = read_image(path).pixels.shape[:2]
        result = f"vec4({DECODE}(k.rgb), k.a)".replace("k", f"texelFetch({name}, {_TEXEL}, 0)")
        text = PassText(
            self._free(f"{name}_linear"),
            (width, height),
            (DECODING,),
            (),
            (),
            result,
            title=f"{path.name} in linear light",
        )
        self.decoded[name] = text
        return text.name

    def _input(self, path: str, parameter: Parameter, value: Value) -> str:
        """Return the expression of a parameter's value, of inputs that are in the header."""
        if path in self._known:
            return self._known[path]
        widget, kind = parameter.widget, parameter.type
        base = path.rpartition(".")[2]
        alone = self.words.get(base, {path}) == {path} and base not in self.taken
        direct = base != parameter.name or kind in ("float", "bool") or widget.kind == "menu"
        if not (alone and direct):
            base = self._free(path.replace(".", "_"))
        label = _label(path, self.shown.get(path, parameter))
        low, high = self._range(parameter, value, label)

        def add(name: str, type_: str, label: str, **more: Any) -> str:
            self.header.append({"NAME": name, "TYPE": type_, "LABEL": label, **more})
            self.taken.add(name)
            return name

        if widget.kind == "button":
            expression = add(base, "event", label)
        elif kind == "bool":
            expression = add(base, "bool", label, DEFAULT=bool(value))
        elif widget.kind == "menu":
            numbers = widget.values or range(len(widget.choices))
            menu = {"VALUES": list(numbers), "LABELS": list(widget.choices)}
            expression = add(base, "long", label, **menu, DEFAULT=value)
        elif widget.kind == "colour":
            assert isinstance(value, tuple)
            encoded = value[:3] if widget.raw else linear_to_srgb(value[:3])
            name = add(base, "color", label, DEFAULT=[*map(float, encoded), *value[3:], 1.0][:4])
            expression = f"{name}.rgb" if widget.raw else f"{DECODE}({name}.rgb)"
            expression = expression if kind == "vec3" else f"vec4({expression}, {name}.a)"
        elif widget.kind == "point":
            lows, highs = zip(*map(widget.ends, range(2)), strict=True)
            expression = add(base, "point2D", label, MIN=lows, MAX=highs, DEFAULT=value)
        elif isinstance(value, tuple):
            sides = "xyzw"[: len(value)]
            parts = parameter.parts or tuple(sides)
            if widget.kind == "direction":
                parts, sides = ("azimuth", "elevation"), "xy"
            scalars = []
            for index, (part, number) in enumerate(zip(parts, value, strict=True)):
                bounds = (low, high)
                if widget.kind == "direction":
                    bounds = (-360.0, 360.0) if index == 0 else (-90.0, 90.0)
                name = self._free(f"{base}_{part if widget.kind == 'direction' else sides[index]}")
                limits = {"MIN": bounds[0], "MAX": bounds[1], "DEFAULT": float(number)}
                scalars.append(_whole(kind, add(name, "float", f"{label}: {part}", **limits)))
            expression = f"{kind}({', '.join(scalars)})"
        else:
            name = add(base, "float", label, MIN=low, MAX=high, DEFAULT=float(value))
            expression = _whole(kind, name)
        self._known[path] = expression
        return expression

    def _range(self, parameter: Parameter, value: Value, label: str) -> tuple[float, float]:
        widget = parameter.widget
        if widget.low is not None and widget.high is not None:
            return float(widget.low), float(widget.high)
        if widget.kind in ("angle", "direction"):
            return -360.0, 360.0
        numbers = value if isinstance(value, tuple) else (value,)
        far = _UNBOUNDED * max(*(abs(float(n)) for n in numbers), 0.1)
        if widget.kind == "number":
            self.unbounded.append(label)
        return (0.0 if parameter.type.startswith("u") else -far), far

    def _free(self, name: str) -> str:
        while name in self.taken or name in WORDS or name in GLSL_WORDS:
            name += "_"
        self.taken.add(name)
        return name


def _whole(kind: str, name: str) -> str:
    """Return a slider's number as one of a type: whole numbers are rounded."""
    if kind.startswith("i"):
        return f"int(floor({name} + 0.5))"
    return f"uint(floor({name} + 0.5))" if kind.startswith("u") else name


def _label(path: str, parameter: Parameter) -> str:
    head = path.partition(".")[0]
    unit = f" ({parameter.unit})" if parameter.unit else ""
    return f"{label_of(head)}: {parameter.title}{unit}"


def _paths_of(leaving: ExportPlan) -> tuple[dict[str, str], dict[str, Parameter]]:
    """Return the path under which a panel shows each parameter of each pass, and what it shows there.

    A parameter whose value differs from that of its export has its own.
    """
    sketch, values = leaving.sketch, leaving.plan.flat.values
    paths: dict[str, str] = {}
    parameters: dict[str, Parameter] = {}
    for shown in shown_parameters(sketch):
        targets = [target.path for target in resolve(sketch.graph, shown.path)]
        for target in targets:
            if shown.exported and values[target] == values[targets[0]]:
                paths.setdefault(target, shown.path)
                parameters[shown.path] = shown.parameter
    return paths, parameters


def inputs_of(leaving: ExportPlan) -> Inputs:
    """Return the inputs of a file, none of them added yet."""
    words: dict[str, set[str]] = {}
    paths, shown = _paths_of(leaving)
    taken = {pass_.name for pass_ in leaving.passes}
    declared: set[str] = set()
    for pass_ in leaving.passes:
        kernel: Kernel = pass_.step.kernel
        for parameter in kernel.parameters:
            own = f"{pass_.step.path}.{parameter.name}"
            path = paths.setdefault(own, own)
            words.setdefault(parameter.name, set()).add(path)
        declared |= kernel.source.names
    taken |= declared - words.keys()
    return Inputs(paths, shown, words, taken)


def written(
    texts: Sequence[PassText], inputs: Inputs, heading: Sequence[str], copies: Mapping[str, str]
) -> str:
    """Return the file; ``copies`` are the names of the imported images' copies, by that of the image."""
    everything = [*inputs.decoded.values(), *texts]
    targets = {text.name: text.name for text in everything}
    renames = [{read.word: targets[read.source] for read in text.reads} for text in everything]
    linear = [_with_sampling(text) for text in everything]
    prefixes = [text.name for text in everything]
    taken = {*targets, *(each["NAME"] for each in inputs.header), *inputs.images, *WORDS}
    merged = joined([text.declarations for text in linear], prefixes, renames, taken=taken)
    kept = {read.source for text in everything for read in text.reads if read.is_before}
    passes, calls, functions = [], [], []
    for index, (text, names) in enumerate(zip(linear, merged.renames, strict=True)):
        is_picture = index == len(linear) - 1
        entry: dict[str, Any] = {} if is_picture else {"TARGET": text.name}
        if not is_picture and not text.is_bytes:
            entry["FLOAT"] = True
        if text.name in kept:
            entry["PERSISTENT"] = True
        for key, side in zip(("WIDTH", "HEIGHT"), text.size, strict=True):
            if side is not None:
                entry[key] = str(side)
            elif text.size != (None, None):
                entry[key] = f"${key}"
        passes.append(entry)
        call = _free_function(f"draw_{text.name}", merged.shared)
        lines = [*text.statements, f"gl_FragColor = {text.result};"]
        body = declaration_of("\n".join(f"    {line}" for line in lines)).renamed(names).text
        functions += [f"void {call}() {{" + (f"  // {text.title}" if text.title else ""), body, "}", ""]
        calls.append(f"    if (PASSINDEX == {index}) {call}();")
    header: dict[str, Any] = {
        "ISFVSN": "2",
        "DESCRIPTION": " ".join(line.removeprefix("// ") for line in heading),
        "CREDIT": "",
        "CATEGORIES": ["Generator", "Terrain"],
        "INPUTS": inputs.header,
    }
    if len(passes) > 1:
        header["PASSES"] = passes
    else:
        calls = [calls[0].partition(") ")[2].join(("    ", ""))]
    if inputs.images:
        header["IMPORTED"] = {name: {"PATH": copies[name]} for name in inputs.images}
    top = json.dumps(header, indent=1, ensure_ascii=True).replace("*/", "*\\/")
    declarations = []
    for each in merged.shared:
        declarations += [each.text, ""] if "\n" in each.text else [each.text]
    return "\n".join([f"/*{top}*/", "", *declarations, "", *functions, "void main() {", *calls, "}"]) + "\n"


def _free_function(name: str, shared: Sequence[Declaration]) -> str:
    while any(name in each.words for each in shared):
        name += "_"
    return name


def _with_sampling(text: PassText) -> PassText:
    """Return a text that reads textures as it wants to: ISF samples all of them linear and clamped."""
    if not any(each.reads("textureLod") or each.reads("texture") for each in text.declarations):
        return text
    samplings = {(r.sampling.filter, r.sampling.wrap) for r in text.reads if is_sampled(text, r.word)}
    if samplings <= {("linear", "clamp")}:
        return text
    if len(samplings) > 1:
        ways = " and ".join(sorted(" ".join(way) for way in samplings))
        raise SketchError(
            f"pass '{text.name}' samples its textures in several ways ({ways}), which ISF has not"
        )
    way = samplings.pop()
    name = f"sampled_{'_'.join(way)}"
    swap = {"textureLod": name, "texture": name}
    changed = tuple(each.renamed(swap) for each in text.declarations)
    functions = [declaration_of("\n".join(_sampler(name, *way)), name)]
    if any(each.reads("texture") for each in text.declarations):
        call = f"vec4 {name}(sampler2D texels, vec2 place) {{ return {name}(texels, place, 0.0); }}"
        functions.append(declaration_of(call, name))
    return replace(text, declarations=(*functions, *changed))


def _sampler(name: str, filter_: str, wrap: str) -> list[str]:
    """Return a function that samples level 0 of a texture."""
    around = "clamp(texel, ivec2(0), size_of - 1)"
    if wrap == "repeat":  # of a negative number GLSL's % is undefined
        around = "texel - size_of * ivec2(floor((vec2(texel) + 0.5) / vec2(size_of)))"
    wrapped = f"{name}_texel"
    fetch = [
        f"vec4 {wrapped}(sampler2D texels, ivec2 texel) {{",
        "    ivec2 size_of = textureSize(texels, 0);",
        f"    return texelFetch(texels, {around}, 0);",
        "}",
        f"vec4 {name}(sampler2D texels, vec2 place, float level) {{",
    ]
    if filter_ == "nearest":
        return [
            *fetch,
            f"    return {wrapped}(texels, ivec2(floor(place * vec2(textureSize(texels, 0)))));",
            "}",
        ]
    corners = [f"{wrapped}(texels, corner + ivec2({x}, {y}))" for y in (0, 1) for x in (0, 1)]
    return [
        *fetch,
        "    vec2 exact = place * vec2(textureSize(texels, 0)) - 0.5;",
        "    ivec2 corner = ivec2(floor(exact));",
        "    vec2 share = exact - floor(exact);",
        f"    vec4 south = mix({corners[0]}, {corners[1]}, share.x);",
        f"    vec4 north = mix({corners[2]}, {corners[3]}, share.x);",
        "    return mix(south, north, share.y);",
        "}",
    ]
