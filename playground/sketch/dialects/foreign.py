"""Make a sketch's passes of another tool's shader: its text as a plain shader, stand-ins for its channels.

What a dialect gives is a table: name → (type, meaning). A name that the text reads and does not
declare is declared before it; where the text declares one, its own type counts.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from playground.errors import Diagnostic, ShaderError
from playground.paths import GLSL, shown
from playground.sketch.allowed_files import is_file, leads_outside
from playground.sketch.dialects.declarations import Declared, is_declared, uniforms, vertex_outputs
from playground.sketch.dialects.es import Rewritten
from playground.sketch.header import title_of
from playground.sketch.model import (
    SHAPES,
    Export,
    Graph,
    Input,
    Kernel,
    Output,
    Parameter,
    PassSpec,
    Sampling,
    Technique,
    Widget,
)
from playground.sketch.source import Line, SourceText
from playground.sketch.uniforms import read_uniforms

Names = Mapping[str, tuple[str, str]]
"""Name → GLSL type and meaning: a key of ``Runner``'s values; of a sampler "noise 0", "picture 3", "none"."""

Read = Callable[[str, Path, Path], Technique]
"""Return the technique that ``use`` names: see ``Techniques.read``."""

STAND_INS = {
    "noise": ("foreign/noise", ("256", "256")),
    "picture": ("foreign/picture", ("256", "256")),
    "sky": ("foreign/sky_box", ("128", "768")),
    "volume": ("foreign/noise", ("32", "1024")),
}
"""What a channel reads that nothing feeds: the technique, and its size."""
SAMPLING = Sampling("linear", "repeat", mipmap=True)
_OF_SHAPE = {"cube": "sky", "volume": "volume"}
_COMMENTED_FILE = re.compile(r"^\s*([^\s\"'<>|*?]+\.(?:png|jpe?g|webp|tiff?))\b", re.IGNORECASE)
_PICTURE = re.compile(r"\buniform\b.*\bu_tex\d+\s*;")
_MODEL = "MODEL_"
_STANDS_IN = "a stand-in is drawn; a sketch may wire an image to it"


@dataclass(frozen=True)
class Rules:
    """What a dialect gives a shader."""

    name: str  # of its row
    names: Names
    declared_anywhere: bool = False  # a name declared in any function counts as declared
    epilogue: str = ""  # of gpu/shaders
    defines: Callable[[SourceText], tuple[str, ...]] = lambda source: ()  # lines of the prelude


def graph_of(name: str, text: Rewritten, rules: Rules, read: Read, root: Path) -> Graph:
    """Return a technique whose last pass, ``view``, is the shader; the others are stand-ins.

    Its channels are inputs, and its own uniforms parameters. ``root`` is the folder that its files stay in.
    """
    shader = _Shader(text, rules, root)
    kernel = shader.kernel(name)
    passes = [
        PassSpec(
            channel,
            STAND_INS[kind][0],
            read(STAND_INS[kind][0], GLSL, GLSL),
            values=(("number", int(number)),),
            size=STAND_INS[kind][1],
        )
        for channel, (kind, number) in shader.stand_ins.items()
    ]
    path = Path(kernel.path)
    passes.append(PassSpec("view", f"./{path.stem}", kernel, file=shown(path)))
    return Graph(
        name,
        kernel.path,
        tuple(passes),
        parameters=tuple(Export(p.name, (f"view.{p.name}",)) for p in kernel.parameters),
        inputs=tuple(Export(i.name, (f"view.{i.name}",)) for i in kernel.inputs),
        title=kernel.title,
    )


class _Shader:
    """One text, and what its dialect's table says of it."""

    def __init__(self, text: Rewritten, rules: Rules, root: Path) -> None:
        self.text = text
        self.source = text.source
        self.code = text.source.code
        self.rules = rules
        self.root = root
        self.declared = uniforms(self.code)
        self.missing = [name for name in rules.names if self._lacks(name)]
        self.commented = {(line.file, line.number): file for line, file in commented_files(self.source)}
        self.pictures = dict(self._pictures())
        self.samplers = {name: SHAPES[kind] for name, kind in self._kinds() if kind in SHAPES}
        self.stand_ins: dict[str, tuple[str, str]] = {}  # channel → kind, number
        for sampler in self.samplers:
            kind, _, number = rules.names.get(sampler, ("", ""))[1].partition(" ")
            if kind in STAND_INS and self._is_read(sampler):
                self.stand_ins[sampler] = _OF_SHAPE.get(self.samplers[sampler], kind), number

    def kernel(self, name: str) -> Kernel:
        parameters = self._parameters()
        prelude = [*self.text.prelude, *self.rules.defines(self.source)]
        prelude += [f"uniform {_declaration(self.rules.names[n][0], n)};" for n in self.missing]
        own = {p.name for p in parameters}
        meanings = [
            (n, meaning)
            for n, (kind, meaning) in self.rules.names.items()
            if (n in self.declared or n in self.missing) and n not in own and "sampler" not in kind
        ]
        return Kernel(
            name,
            "plain_fragment",
            self.source,
            (Output("frame", "rgba8"),),
            parameters,
            tuple(Input(n, SAMPLING, "black", shape=s) for n, s in self.samplers.items() if self._is_read(n)),
            title=title_of(self.source),
            dialect=self.rules.name,
            prelude=tuple(prelude),
            epilogue=self.rules.epilogue,
            vertex=vertex_outputs(self.code),
            meanings=tuple(meanings),
            unfed=tuple(self._unfed(own)),
        )

    def _lacks(self, name: str) -> bool:
        if name not in self.source.names or name in self.declared:
            return False
        read = re.search(rf"(?<![.\w]){name}\b", self.code)
        return bool(read) and not is_declared(self.code, name, anywhere=self.rules.declared_anywhere)

    def _is_read(self, name: str) -> bool:
        """Return whether a text names a sampler besides declaring it."""
        return name in self.missing or len(re.findall(rf"\b{name}\b", self.code)) > 1

    def _kinds(self) -> Iterator[tuple[str, str]]:
        """Yield each sampler that a wire may feed, with its type."""
        for name in self.missing:
            yield name, self.rules.names[name][0]
        for one in self.declared.values():
            if (
                not one.is_array
                and one.name not in self.pictures
                and not self._line(one).comment.startswith("!")
            ):
                yield one.name, one.type

    def _line(self, one: Declared) -> Line:
        return self.source.lines[one.line]

    # ── parameters ───────────────────────────────────────────────────────────

    def _parameters(self) -> tuple[Parameter, ...]:
        """Return the text's own uniforms; one that no panel can show keeps what the text gives it."""
        found: dict[str, Parameter] = {}
        for declared in self.declared.values():
            line = self._line(declared)
            line = replace(line, code=f"uniform {declared.type} {' '.join(declared.written.split())};")
            annotated = line.comment.startswith("!")  # in our own way, so that a parameter is meant
            skip = () if annotated else self.rules.names.keys()
            try:
                some, _ = read_uniforms(replace(self.source, lines=(line,)), plain=True, skip=skip)
            except ShaderError:
                if annotated:
                    raise
                continue
            found |= {one.name: one for one in some}
        return (*found.values(), *self.pictures.values())

    def _pictures(self) -> Iterator[tuple[str, Parameter]]:
        """Yield the samplers whose comment names a file that is there."""
        for one in self.declared.values():
            line, file = self._line(one), self._commented(one)
            if file and self._is_there(file, line):
                made = Parameter(
                    one.name,
                    "sampler2D",
                    file,
                    Widget("file"),
                    sampling=SAMPLING,
                    file=line.file,
                    line=line.number,
                )
                yield one.name, made

    def _commented(self, one: Declared) -> str:
        line = self._line(one)
        return self.commented.get((line.file, line.number), "") if one.type == "sampler2D" else ""

    def _is_there(self, file: str, line: Line) -> bool:
        there = any(is_file(place) for place in places_of(file, line, self.root))
        return there and not leads_outside(file, self.root, line.file)

    def _unfed(self, fed: Collection[str]) -> Iterator[tuple[str, str]]:
        """Yield what the picture lacks where nothing is wired: each name, and what is drawn instead."""
        for name in self.stand_ins:
            file = self._commented(self.declared[name]) if name in self.declared else ""
            yield name, f"there is no file '{file}', so a stand-in is drawn" if file else _STANDS_IN
        own = {one.name: one.type for one in self.declared.values()}
        own |= {name: self.rules.names[name][0] for name in self.missing}
        for name, kind in own.items():
            if "sampler" in kind and name not in self.stand_ins and name not in fed and self._is_read(name):
                yield name, "it reads black"
        for name in sorted(self.source.names):
            if name.startswith(_MODEL):
                yield name, "there is no mesh here, so it is drawn flat"


def unfed_warnings(kernel: Kernel, wired: Collection[str]) -> tuple[Diagnostic, ...]:
    """Return a warning for each thing that another tool's shader lacks; ``wired`` are inputs that are fed."""
    names: dict[str, list[str]] = {}
    for name, instead in kernel.unfed:
        if name not in wired:
            names.setdefault(instead, []).append(name)
    lines = kernel.source.lines
    found = []
    for instead, some in names.items():
        first = re.compile(rf"\b(?:{'|'.join(some)})\b")
        line = next((line for line in lines if first.search(line.code)), lines[0])
        found.append(line.diagnostic(f"nothing feeds {', '.join(some)}: {instead}", severity="warning"))
    return tuple(found)


def commented_files(source: SourceText) -> Iterator[tuple[Line, str]]:
    """Yield each line that declares ``u_tex0`` or its like with a file in its comment, and the file."""
    for line in source.lines:
        if _PICTURE.search(line.code) and (match := _COMMENTED_FILE.match(line.comment)):
            yield line, match.group(1)


def places_of(file: str, line: Line, root: Path) -> tuple[Path, ...]:
    """Return where a file is looked for that a line names."""
    return tuple(dict.fromkeys((root / file, Path(line.file).parent / file)))


def _declaration(kind: str, name: str) -> str:
    """Return "vec3 name[4]" for vec3[4]."""
    base, bracket, count = kind.partition("[")
    return f"{base} {name}{bracket}{count}"
