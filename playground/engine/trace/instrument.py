"""Write a fragment shader each texel of whose target records one event of the run for one chosen texel.

Fragment k runs the shader for the chosen texel as it is, counts what it could record and keeps the k-th: its
place in the table, the type of its value, the value's bits. That takes two outputs of unsigned numbers,
which OpenGL 3.3 and WebGL 2 have, and no other feature. With ``quads`` the 2 x 2 fragments of each quad run
the four texels of the chosen one's, so that derivatives and levels of detail are those of the picture.

The operands of ``?:``, conditions of loops and vertex functions are not recorded.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from playground.engine.trace.model import LEAF_TYPES, LENGTH, MARK, MATRICES, MAX_ELEMENTS, Place, Structs
from playground.errors import ShaderError
from playground.shader.source import Line
from playground.shader.syntax.nodes import (
    Assign,
    Block,
    Call,
    Declaration,
    Do,
    Expression,
    For,
    Function,
    If,
    Index,
    InterfaceBlock,
    Jump,
    Member,
    Name,
    Node,
    Parenthesized,
    Struct,
    Switch,
    Unary,
    While,
    walk,
)
from playground.shader.syntax.symbols import Symbols, symbols_of
from playground.shader.wrap import ShaderStage

ALL = "all"
"""What ``functions`` is where every function of the author's files is recorded."""

OLD_NAMES = {
    "texture2D": "texture",
    "texture2DLod": "textureLod",
    "texture2DProj": "textureProj",
    "texture2DLodEXT": "textureLod",
    "textureCube": "texture",
    "texture3D": "texture",
    "varying": "in",
}
"""What texts before GLSL 1.30 call otherwise; they are traced as 3.30."""

_DERIVED = re.compile(r"dFd[xy](Fine|Coarse)?|fwidth(Fine|Coarse)?|texture(Proj)?(Offset)?|textureQueryLod")
_SWIZZLE = re.compile(r"[xyzw]{1,4}|[rgba]{1,4}|[stpq]{1,4}")
_VECTOR = re.compile(r"([biu]?)vec([234])")
_DIRECTIVE = re.compile(r"#\s*(version|extension)\b")
_VERSION = re.compile(r"#\s*version\s+(\d+)\s*(\w*)")
_SCALARS = {"": "float", "i": "int", "u": "uint", "b": "bool"}
_INPUTS = frozenset(("in", "varying"))


@dataclass(frozen=True, slots=True)
class Varying:
    """What a vertex stage hands a fragment, and a traced shader takes from uniforms."""

    name: str  # "place", "corners[1]", "inData.normal"
    type: str
    is_flat: bool

    @property
    def uniform(self) -> str:
        """Return the uniform with its value; of a quad an array with those of its four fragments."""
        return f"k_at_{'_'.join(re.findall(r'[A-Za-z0-9]+', self.name))}"


@dataclass(frozen=True, slots=True)
class Traced:
    """A fragment shader that records, and the table of what it records."""

    text: str
    places: tuple[Place, ...]
    structs: Structs
    outputs: tuple[str, ...]  # the shader's own, in the order of their locations: names
    quads: bool
    varyings: tuple[Varying, ...]
    declarations: tuple[str, ...]  # of the varyings, in the fragment shader
    has_mesh: bool  # then it takes gl_FragCoord.zw from k_at_depth, and gl_FrontFacing from k_is_front
    functions: tuple[str, ...]  # that are recorded
    others: tuple[str, ...]  # of the author's files, that are not


def instrument(stage: ShaderStage, functions: str = "", *, has_mesh: bool = False) -> Traced:
    """Return the fragment stage of a kernel with the recording of its functions.

    ``functions``: "" for those of the kernel's own file, ``ALL`` for those of its includes too, or the name
    of one. ``has_mesh``: what its vertex stage hands on comes from a mesh, and ``gl_FragCoord.zw`` too.

    Raises ``ShaderError`` where the text cannot be read, with the place, and ``KeyError`` for a function that
    the author's files do not define.
    """
    symbols = symbols_of(stage.text)
    tree = symbols.tree
    if tree.errors:
        error = tree.errors[0]
        line = stage.locate(tree.line(error.token) + 1) or stage.source.lines[0]
        raise line.error(f"this text cannot be traced: {error.message}")
    return _Writer(stage, symbols, functions, has_mesh).traced()


def functions_of(stage: ShaderStage) -> dict[str, str]:
    """Return the functions of a stage that can be recorded, each with the path of its file."""
    result: dict[str, str] = {}
    tree = symbols_of(stage.text).tree
    for node in tree.declarations:
        if isinstance(node, Function) and node.body is not None:
            line = stage.locate(tree.line(node.at) + 1)
            if line is not None:
                result[node.name] = line.file
    return result


@dataclass(frozen=True, slots=True)
class _Scope:
    """Where a statement is."""

    function: Function
    loops: tuple[int, ...] = ()  # the places of the iterations around it


class _Writer:
    def __init__(self, stage: ShaderStage, symbols: Symbols, functions: str, has_mesh: bool) -> None:
        self.stage, self.symbols, self.tree = stage, symbols, symbols.tree
        self.tokens = self.tree.tokens
        self.functions = functions
        self.has_mesh = has_mesh
        self.places: list[Place] = []
        self.before: dict[int, list[str]] = {}  # texts before a token
        self.after: dict[int, list[str]] = {}  # texts behind a token
        self.words: dict[int, str] = {}  # tokens that are spelled otherwise
        self.removed: set[int] = set()
        self.nodes: dict[str, Struct] = {}  # structs of the top level, by name
        self.structs: dict[str, tuple[tuple[str, str], ...]] = {}
        self.version, self.profile = self._version()
        self.is_es = self.profile == "es"
        words = {token.text for token in self.tokens}
        self.discards = "discard" in words
        self.quads = any(_DERIVED.fullmatch(word) for word in words) or bool(words & OLD_NAMES.keys())
        self.varyings: list[Varying] = []
        self.globals: list[str] = []  # variables in the place of varyings
        self.declarations: list[str] = []  # of the varyings
        self.has_old_outputs = False
        self.discard_marks: dict[int, str] = {}  # by the token of the discard

    # ── the whole text ───────────────────────────────────────────────────────

    def traced(self) -> Traced:
        own = functions_of(self.stage)
        if self.functions and self.functions != ALL and self.functions not in own:
            raise KeyError(self.functions)
        recorded: list[str] = []
        outputs: list[tuple[int, str]] = []
        main: Function | None = None
        for node in self.tree.declarations:
            if isinstance(node, Declaration):
                self._global(node, outputs)
            elif isinstance(node, InterfaceBlock) and "in" in node.qualifiers:
                self._block(node)
            elif isinstance(node, Function) and node.body is not None:
                if node.name == "main":
                    main = node
                line = self._line(node.at)
                if line is not None and self._is_recorded(node.name, line.file):
                    recorded.append(node.name)
                    self._function(node)
                self._end_at_discards(node)
        if main is None:
            raise self.stage.source.lines[0].error("this text cannot be traced: it has no function main")
        self.words[main.at] = "k_own_main"
        names = self._fragment_outputs(outputs)
        text = self._head() + self._helpers(len(names)) + self._body() + self._main()
        return Traced(
            text=text,
            places=tuple(self.places),
            structs=self.structs,
            outputs=names,
            quads=self.quads,
            varyings=tuple(self.varyings),
            declarations=tuple(self.declarations),
            has_mesh=self.has_mesh,
            functions=tuple(dict.fromkeys(recorded)),
            others=tuple(name for name in own if name not in recorded),
        )

    def _is_recorded(self, name: str, file: str) -> bool:
        if self.functions in ("", ALL):
            return self.functions == ALL or file == self.stage.source.path
        return name == self.functions

    def _global(self, node: Declaration, outputs: list[tuple[int, str]]) -> None:
        """Note what a declaration of the top level means for the trace."""
        qualifiers = node.type.qualifiers
        struct = node.type.struct
        if struct is not None and struct.name:
            self.after.setdefault(node.last - 1, []).append(self._struct(struct))
        if "out" in qualifiers:
            located = next((q for q in qualifiers if q.startswith("layout")), "")
            match = re.search(r"location=(\d+)", located)
            if not located:
                self._put_before(node.first, "layout(location = 0)")
            for name in node.names:
                first = int(match[1]) if match else 0
                outputs += [(first + i, name.name) for i in range(self._length(name.arrays))]
        elif _INPUTS & set(qualifiers):
            # What a vertex stage hands on: uniforms and a variable in its place.
            for name in node.names:
                if name.name == "k_place_at":
                    self._replace(name.name, "k_coord.xy")
                elif name.name.startswith("gl_"):
                    raise self._refusal(node, f"it declares {name.name} in its own way")
            if node.names and node.names[0].name != "k_place_at":
                self.globals += self._varying(node, qualifiers)
                words = [OLD_NAMES.get(q, q) for q in qualifiers if not q.startswith("layout")]
                names = ", ".join(self._source(name) for name in node.names)
                sizes = self._sizes(node.type.arrays)
                self.declarations.append(f"{' '.join(words)} {node.type.name}{sizes} {names};")
            self.removed.update(range(node.first, node.last))

    def _varying(self, node: Declaration, qualifiers: Sequence[str], instance: str = "") -> list[str]:
        """Note what a vertex stage hands on, and return the declarations of variables in its place."""
        type_ = node.type.name
        is_flat = "flat" in qualifiers or type_[:1] in "iu"
        result = []
        for name in node.names:
            arrays = [*node.type.arrays, *name.arrays]
            sizes = [self.tree.source(size) if size is not None else "" for size in arrays]
            if len(arrays) > 1 or not all(size.isdigit() for size in sizes) or type_ not in LEAF_TYPES:
                raise self._refusal(node, f"its vertex stage hands it {self._source(node)}")
            parts = [f"[{index}]" for index in range(int(sizes[0]))] if sizes else [""]
            path = f"{instance}.{name.name}" if instance else name.name
            self.varyings += [Varying(f"{path}{part}", type_, is_flat) for part in parts]
            result.append(f"{type_} {name.name}{self._sizes(arrays)};")
        return result

    def _block(self, node: InterfaceBlock) -> None:
        """Note a block that a vertex stage hands on, and declare a variable in its place."""
        if node.arrays:
            raise self._refusal(node, f"its vertex stage hands it {self._source(node)}")
        members = [
            text
            for member in node.members
            for text in self._varying(member, [*node.qualifiers, *member.type.qualifiers], node.instance)
        ]
        if node.instance:
            self.globals.append(
                f"struct k_{node.name} {{ {' '.join(members)} }}; k_{node.name} {node.instance};"
            )
        else:
            self.globals += members
        self.declarations.append(self._source(node))
        self.removed.update(range(node.first, node.last))

    def _length(self, arrays: Sequence[Node | None]) -> int:
        texts = [self.tree.source(size) for size in arrays if size is not None]
        return int(texts[0]) if texts and texts[0].isdigit() else 1

    def _replace(self, name: str, text: str) -> None:
        for index, token in enumerate(self.tokens):
            if token.text == name:
                self.words[index] = text

    def _fragment_outputs(self, outputs: list[tuple[int, str]]) -> tuple[str, ...]:
        """Return the names of the shader's own outputs; of an old text those of ``gl_FragColor``."""
        if outputs:
            return tuple(name for _, name in sorted(outputs))
        self.has_old_outputs = not {"gl_FragColor", "gl_FragData"}.isdisjoint(t.text for t in self.tokens)
        indices = {0}
        for node in walk(*self.tree.declarations):
            if isinstance(node, Index) and isinstance(node.base, Name) and node.base.name == "gl_FragData":
                number = self.tree.source(node.index)
                if number.isdigit():
                    indices.add(int(number))
        self._replace("gl_FragColor", "k_frag_data[0]")
        self._replace("gl_FragData", "k_frag_data")
        return tuple(f"k_frag_data[{index}]" for index in range(max(indices) + 1))

    def _version(self) -> tuple[int, str]:
        for token in self.tree.preprocessed.directives:
            if match := _VERSION.match(token.text):
                return int(match[1]), match[2] or ("es" if match[1] == "100" else "")
        return 110, ""

    def _head(self) -> str:
        texts = [token.text.strip() for token in self.tree.preprocessed.directives]
        directives = [text for text in texts if _DIRECTIVE.match(text)]
        number = max(self.version, 300 if self.is_es else 330)
        profile = self.profile if self.is_es or self.version == number else ""
        version = f"#version {number} {profile}".rstrip()
        return "\n".join([version, *(d for d in directives if not _VERSION.match(d))]) + "\n"

    def _body(self) -> str:
        is_old = self.version < 130
        parts: list[str] = []
        for index, token in enumerate(self.tokens):
            parts += self.before.get(index, ())
            if index not in self.removed:
                word = self.words.get(index) or token.text
                if word == "gl_FragCoord":
                    word = "k_coord"
                elif word == "gl_FrontFacing" and self.has_mesh:
                    word = "k_is_front"
                elif is_old:
                    word = OLD_NAMES.get(word, word)
                parts.append(word)
            parts += self.after.get(index, ())
            if token.text in (";", "{", "}"):
                parts.append("\n")
        return " ".join(parts)

    # ── places in the author's files ─────────────────────────────────────────

    def _line(self, token: int) -> Line | None:
        return self.stage.locate(self.tree.line(token) + 1)

    def _located(self, offset: int, text: str = "") -> tuple[str, int, int]:
        """Return file, line and column, from 1, of an offset of the stage's text."""
        line, column = self.tree.place(offset)
        index = line + 1 - self.stage.first
        lines = self.stage.source.lines
        index = min(max(index, 0), len(lines) - 1)
        own = lines[index]
        if column >= len(own.text.rstrip()) and text:
            # A call of a macro that spans lines stands on the first of them, see ``with_calls_joined``.
            for later in lines[index + 1 :]:
                if later.code or later.file != own.file:
                    break
                if (found := later.text.find(text)) >= 0:
                    return later.file, later.number, found + 1
        return own.file, own.number, column + 1

    def _place(self, kind: str, name: str, type_: str, scope: _Scope, node: Node) -> int:
        """Add a place to the table, and return its number."""
        first = self.tokens[node.first]
        path, line, column = self._located(first.start, first.text)
        end = self.tokens[max(node.last - 1, node.first)]
        _, end_line, end_column = self._located(end.start, end.text)
        function = scope.function.name
        self.places.append(
            Place(
                kind=kind,
                name=name,
                function=function,
                type=type_,
                path=path,
                line=line,
                column=column,
                end_line=end_line,
                end_column=end_column + end.end - end.start,
                loops=scope.loops,
            )
        )
        return len(self.places) - 1

    def _refusal(self, node: Node, reason: str) -> ShaderError:
        line = self._line(node.first) or self.stage.source.lines[0]
        return line.error(f"this text cannot be traced: {reason}")

    def _source(self, node: Node) -> str:
        return " ".join(self.tree.source(node).split())

    # ── functions and statements ─────────────────────────────────────────────

    def _put_before(self, token: int, text: str, *, outermost: bool = False) -> None:
        texts = self.before.setdefault(token, [])
        texts.insert(0 if outermost else len(texts), text)

    def _put_after(self, token: int, text: str, *, innermost: bool = False) -> None:
        texts = self.after.setdefault(token, [])
        texts.insert(0 if innermost else len(texts), text)

    def _function(self, function: Function) -> None:
        scope, body = _Scope(function), function.body
        assert body is not None
        enter = self._place("enter", function.name, "", scope, _Token(function.at))
        _, end_line, _ = self._located(self.tokens[body.last - 1].start)
        self.places[enter] = replace(self.places[enter], end_line=end_line)
        texts = [f"k_mark({enter});"]
        for parameter in function.parameters:
            kind = parameter.type.name
            if parameter.name and "out" not in parameter.type.qualifiers and "sampler" not in kind:
                arrays = [*parameter.type.arrays, *parameter.arrays]
                at = _Token(parameter.at)
                texts.append(self._record("argument", parameter.name, kind, arrays, scope, at))
        self._put_after(body.first, " ".join(texts), innermost=True)
        for statement in body.statements:
            self._statement(statement, scope, True)
        if function.type.name == "void" and not function.type.arrays:
            leave = self._place("leave", function.name, "", scope, _Token(body.last - 1))
            self._put_before(body.last - 1, f"k_mark({leave});")

    def _record(
        self, kind: str, text: str, type_: str, arrays: Sequence[Node | None], scope: _Scope, node: Node
    ) -> str:
        """Add a place, and return what records a variable there."""
        number = self._place(kind, text, type_ + self._sizes(arrays), scope, node)
        return self._put(number, text, type_, len(arrays))

    def _sizes(self, arrays: Sequence[Node | None]) -> str:
        """Return the array sizes of a type, as written: "[4]"."""
        return "".join(f"[{self._source(size) if size is not None else ''}]" for size in arrays)

    def _put(self, number: int, text: str, type_: str, arrays: int) -> str:
        if arrays > 1 or not self._has_leaves(type_):
            return f"k_mark({number});"
        if arrays == 1:
            length = f"{text}.length()"
            each = f"for (int k_i = 0; k_i < min({length}, {MAX_ELEMENTS}); ++k_i)"
            return f"k_length({number}, {length}); {each} k_put({number}, {text}[k_i]);"
        return f"k_put({number}, {text});"

    def _has_leaves(self, type_: str) -> bool:
        return type_ in LEAF_TYPES or type_ in MATRICES or type_ in self.structs

    def _statement(self, node: Node, scope: _Scope, in_block: bool) -> None:
        match node:
            case Block():
                for statement in node.statements:
                    self._statement(statement, scope, True)
            case Declaration():
                texts = []
                for name in node.names:
                    if name.value is not None:
                        texts += self._changes(name.value, scope)
                        arrays = [*node.type.arrays, *name.arrays]
                        at = _Token(name.at)
                        texts.append(self._record("set", name.name, node.type.name, arrays, scope, at))
                self._behind(node, texts, in_block)
            case Expression():
                self._behind(node, self._changes(node.value, scope), in_block)
            case If():
                self._condition(node.condition, scope)
                self._statement(node.yes, scope, False)
                if node.no is not None:
                    self._statement(node.no, scope, False)
            case For() | While() | Do():
                self._loop(node, scope)
            case Switch():
                number = self._place("condition", self._source(node.value), "int", scope, node.value)
                self._put_before(node.value.first, f"k_value({number}, (", outermost=True)
                self._put_after(node.value.last - 1, "))")
                for statement in node.body.statements:
                    self._statement(statement, scope, True)
            case Jump():
                self._jump(node, scope)

    def _loop(self, node: For | While | Do, scope: _Scope) -> None:
        variables = self._loop_variables(node) if isinstance(node, For) else []
        place = len(self.places)
        texts = []
        if not variables:
            texts.append(f"k_mark({self._place('iteration', '', '', scope, _Token(node.first))});")
        for index, (name, type_, arrays, at) in enumerate(variables):
            within = scope if index == 0 else _Scope(scope.function, (*scope.loops, place))
            kind = "iteration" if index == 0 else "set"
            texts.append(self._record(kind, name, type_, arrays, within, at))
        if self.discards:
            texts.append("if (k_is_gone) break;")
        self._statement(node.body, _Scope(scope.function, (*scope.loops, place)), False)
        body = node.body
        if isinstance(body, Block):
            self._put_after(body.first, " ".join(texts), innermost=True)
        else:
            self._put_before(body.first, "{ " + " ".join(texts), outermost=True)
            self._put_after(body.last - 1, "}")

    def _loop_variables(self, node: For) -> list[tuple[str, str, Sequence[Node | None], Node]]:
        """Return name, type, array sizes and node of the variables of a loop's head."""
        if isinstance(node.start, Declaration):
            of_type = node.start.type
            return [
                (name.name, of_type.name, [*of_type.arrays, *name.arrays], _Token(name.at))
                for name in node.start.names
            ]
        targets = self._targets(node.start.value) if isinstance(node.start, Expression) else []
        targets += self._targets(node.step) if node.step is not None else []
        names: dict[str, tuple[str, str, Sequence[Node | None], Node]] = {}
        for target in targets:
            if isinstance(target, Name):
                type_, arrays = self._type_of(target)
                if type_ and not arrays:
                    names.setdefault(target.name, (target.name, type_, [], target))
        return list(names.values())

    def _jump(self, node: Jump, scope: _Scope) -> None:
        function = scope.function
        type_, arrays = function.type.name, function.type.arrays
        if node.word == "return" and node.value is not None:
            whole = type_ + self._sizes(arrays)
            number = self._place("return", function.name, whole, scope, node.value)
            if not arrays and self._has_leaves(type_):
                cast = "" if type_ in self.structs else type_
                self._put_before(node.value.first, f"k_value({number}, {cast}(", outermost=True)
                self._put_after(node.value.last - 1, "))")
            else:
                self._put_before(node.first, f"{{ {whole} k_result =")
                self.words[node.first] = " "
                put = self._put(number, "k_result", type_, len(arrays))
                self._put_after(node.last - 1, f"{put} return k_result; }}")
        elif node.word == "return":
            number = self._place("leave", function.name, "", scope, node)
            self._put_before(node.first, f"{{ k_mark({number});")
            self._put_after(node.last - 1, "}")
        elif node.word == "discard":
            self.discard_marks[node.first] = f"k_mark({self._place('discard', '', '', scope, node)});"

    def _end_at_discards(self, function: Function) -> None:
        """End a function at a discard, after which nothing is recorded: the fragment itself must stay."""
        if not self.discards:
            return
        whole = function.type.name + self._sizes(function.type.arrays)
        ends = "return" if whole == "void" else f"{whole} k_none; return k_none"
        for node in walk(function):
            if isinstance(node, Jump) and node.word == "discard":
                mark = self.discard_marks.get(node.first, "")
                self.words[node.first] = f"{{ {mark} k_is_gone = true; {ends}"
                self._put_after(node.last - 1, "}", innermost=True)

    def _behind(self, node: Node, texts: list[str], in_block: bool) -> None:
        if not texts:
            return
        if not in_block:
            self._put_before(node.first, "{", outermost=True)
        self._put_after(node.last - 1, " ".join(texts) + ("" if in_block else " }"))

    def _condition(self, node: Node, scope: _Scope) -> None:
        """Record a condition, before it what functions in it have written to variables."""
        if isinstance(node, Declaration):
            return
        written = self._changes(node, scope, as_value=True)
        number = self._place("condition", self._source(node), "bool", scope, node)
        if written:
            changes = "".join(f"{text}, " for text in written)
            self._put_before(node.first, "(k_test = bool((", outermost=True)
            self._put_after(node.last - 1, f")), {changes}k_value({number}, k_test))")
        else:
            self._put_before(node.first, f"k_value({number}, bool((", outermost=True)
            self._put_after(node.last - 1, ")))")

    # ── what an expression changes ───────────────────────────────────────────

    def _changes(self, value: Node, scope: _Scope, *, as_value: bool = False) -> list[str]:
        """Return what records the variables that an expression changes; ``as_value``: by expressions."""
        texts: list[str] = []
        seen: set[str] = set()
        for target in self._targets(value):
            part = self._recorded_part(target)
            if part is None or self._has_effects(part):
                continue
            type_, arrays = self._type_of(part)
            text = self._printed(part)
            if not type_ or text in seen:
                continue
            if as_value and (arrays or type_ not in LEAF_TYPES):
                continue
            seen.add(text)
            sizes = "[]" * arrays
            number = self._place("set", self._source(part), type_ + sizes, scope, part)
            texts.append(f"k_value({number}, {text})" if as_value else self._put(number, text, type_, arrays))
        return texts

    def _targets(self, value: Node) -> list[Node]:
        """Return what an expression assigns to, and what it gives functions to write to."""
        result: list[Node] = []
        for node in walk(value):
            if isinstance(node, Assign):
                result.append(node.target)
            elif isinstance(node, Unary) and node.operator in ("++", "--"):
                result.append(node.operand)
            elif isinstance(node, Call):
                functions = [symbol.node for symbol in self.symbols.callees.get(node, ())]
                for index, argument in enumerate(node.arguments):
                    if any(_writes_to(function, index) for function in functions):
                        result.append(argument)
        return result

    def _recorded_part(self, target: Node) -> Node | None:
        """Return the part of a target that is recorded: without the components that it ends in."""
        while isinstance(target, Parenthesized):
            target = target.inside
        while isinstance(target, Member) and _SWIZZLE.fullmatch(target.name):
            if self._type_of(target.base)[0] in self.nodes:  # a member called "x", say
                break
            target = target.base
        return target if isinstance(target, Name | Member | Index) else None

    def _type_of(self, node: Node) -> tuple[str, int]:
        """Return the type of a variable or a part of one, and its array dimensions; "" where unknown."""
        match node:
            case Parenthesized():
                return self._type_of(node.inside)
            case Name():
                symbol = self.symbols.symbol_at.get(node.first)
                return (symbol.type, symbol.arrays) if symbol is not None else ("", 0)
            case Index():
                type_, arrays = self._type_of(node.base)
                if arrays:
                    return type_, arrays - 1
                if vector := _VECTOR.fullmatch(type_):
                    return _SCALARS[vector[1]], 0
                return (f"vec{MATRICES[type_][1]}", 0) if type_ in MATRICES else ("", 0)
            case Member():
                type_, arrays = self._type_of(node.base)
                struct = self.nodes.get(type_)
                if struct is None or arrays:
                    return "", 0
                for member in struct.members:
                    for declared in member.names:
                        if declared.name == node.name:
                            return member.type.name, len(declared.arrays) + len(member.type.arrays)
        return "", 0

    def _has_effects(self, node: Node) -> bool:
        return any(
            isinstance(part, Assign | Call) or (isinstance(part, Unary) and part.operator in ("++", "--"))
            for part in walk(node)
        )

    def _printed(self, node: Node) -> str:
        words = {"gl_FragCoord": "k_coord"}
        return " ".join(words.get(t.text, t.text) for t in self.tokens[node.first : node.last])

    # ── what is written around the text ──────────────────────────────────────

    def _struct(self, struct: Struct) -> str:
        """Return the functions that record a struct member by member, and note its members."""
        members: list[tuple[str, str]] = []
        puts = []
        for member in struct.members:
            for name in member.names:
                arrays = len(name.arrays) + len(member.type.arrays)
                if arrays <= 1 and self._has_leaves(member.type.name):
                    members.append((name.name, member.type.name + "[]" * arrays))
                    text = f"k_it.{name.name}"
                    puts.append(self._put(0, text, member.type.name, arrays).replace("(0, ", "(k_id, "))
        self.nodes[struct.name] = struct
        if not members:
            return ""
        self.structs[struct.name] = tuple(members)
        put = f"void k_put(int k_id, {struct.name} k_it) {{ {' '.join(puts)} }}"
        value = f"{struct.name} k_value(int k_id, {struct.name} k_it)"
        return f"\n{put}\n{value} {{ k_put(k_id, k_it); return k_it; }}\n"

    def _lane(self) -> str:
        """Return the texel that a fragment runs, relative to the chosen one."""
        if not self.quads:
            return "ivec2(0)"
        return "((k_trace_texel & ~1) + (ivec2(gl_FragCoord.xy) & 1) - k_trace_texel)"

    def _coordinate(self) -> str:
        depth = "k_at_depth" if self.has_mesh else "gl_FragCoord.zw"
        return f"vec4(vec2(k_trace_texel + {self._lane()}) + 0.5, {depth})"

    def _settings(self) -> dict[str, str]:
        """Return the values of the variables that the text reads in place of its inputs, by name."""
        settings = {"k_coord": self._coordinate()}
        lane = "[(int(gl_FragCoord.y) & 1) * 2 + (int(gl_FragCoord.x) & 1)]"
        for varying in self.varyings:
            settings[varying.name] = varying.uniform + (lane if self._has_lanes(varying) else "")
        return settings

    def _has_lanes(self, varying: Varying) -> bool:
        return self.quads and not varying.is_flat

    def _helpers(self, outputs: int) -> str:
        """Return the declarations and functions that the recording needs."""
        lines = []
        if self.is_es:
            lines.append("precision highp float; precision highp int; precision highp sampler2D;")
        if self.has_old_outputs:
            lines.append(f"layout(location = 0) out vec4 k_frag_data[{outputs}];")
        lines += [
            f"layout(location = {outputs}) out uvec4 k_trace_bits;",
            f"layout(location = {outputs + 1}) out uvec4 k_trace_what;",
            "uniform ivec2 k_trace_texel; uniform int k_trace_width; uniform int k_trace_from;",
            "int k_wanted; int k_count = 0; bool k_is_gone = false; bool k_test;",
            "uvec4 k_bits = uvec4(0u); uint k_what = 0u;",
        ]
        if self.has_mesh:
            lines.append("uniform vec2 k_at_depth; uniform bool k_is_front;")
        for varying in self.varyings:
            lanes = "[4]" if self._has_lanes(varying) else ""
            lines.append(f"uniform {varying.type} {varying.uniform}{lanes};")
        # Values of globals may name them, except in ES, where these are constants.
        settings = {} if self.is_es else self._settings()
        for declaration in ("vec4 k_coord;", *self.globals):
            name = declaration.split()[1].rstrip(";")
            lines.append(f"{declaration[:-1]} = {settings[name]};" if name in settings else declaration)
        is_live = " && !k_is_gone" if self.discards else ""
        counts = "if (!k_is_gone) ++k_count;" if self.discards else "++k_count;"

        def take(bits: str, code: int) -> str:
            keep = f"{bits} k_what = uint(k_id) * 32u + {code}u;"
            return f"if (k_count == k_wanted{is_live}) {{ {keep} }} {counts}"

        lines.append(f"void k_mark(int k_id) {{ {take('', MARK)} }}")
        both = "k_bits.xy = uvec2(uint(k_length), uint(min(k_length, " + f"{MAX_ELEMENTS})));"
        lines.append(f"void k_length(int k_id, int k_length) {{ {take(both, LENGTH)} }}")
        for code, type_ in enumerate(LEAF_TYPES):
            count = int(type_[-1]) if type_[-1].isdigit() else 1
            unsigned = "uint" if count == 1 else f"uvec{count}"
            bits = "floatBitsToUint(k_it)" if type_[0] in "fv" else f"{unsigned}(k_it)"
            kept = take(f"k_bits.{'xyzw'[:count]} = {bits};", code)
            lines.append(f"void k_put(int k_id, {type_} k_it) {{ {kept} }}")
            lines.append(f"{type_} k_value(int k_id, {type_} k_it) {{ {kept} return k_it; }}")
        for type_ in [f"mat{c}x{r}" if c != r else f"mat{c}" for c in (2, 3, 4) for r in (2, 3, 4)]:
            puts = " ".join(f"k_put(k_id, k_it[{column}]);" for column in range(MATRICES[type_][0]))
            lines.append(f"void k_put(int k_id, {type_} k_it) {{ {puts} }}")
            lines.append(f"{type_} k_value(int k_id, {type_} k_it) {{ {puts} return k_it; }}")
        return "\n".join(lines) + "\n"

    def _main(self) -> str:
        place = "ivec2(gl_FragCoord.xy)" + (" / 2" if self.quads else "")
        settings = self._settings().items()
        sets = "".join(f"    {name} = {value};\n" for name, value in settings)
        return f"""
void main() {{
    ivec2 k_place = {place};
    k_wanted = k_trace_from + k_place.y * k_trace_width + k_place.x;
{sets}    k_own_main();
    k_trace_bits = k_bits;
    k_trace_what = uvec4(k_what / 32u, k_what % 32u, uint(k_count), uint(k_is_gone));
}}
"""


class _Token(Node):
    """One token, as a node."""

    def __init__(self, token: int) -> None:
        super().__init__(token, token + 1)


def _writes_to(function: Node, index: int) -> bool:
    """Return whether a function may write to one of its arguments."""
    assert isinstance(function, Function)
    if index >= len(function.parameters):
        return False
    return not {"out", "inout"}.isdisjoint(function.parameters[index].type.qualifiers)
