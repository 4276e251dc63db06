"""Which statements a uniform can influence, against programs that are run with several of its values."""

from __future__ import annotations

import random
from collections import defaultdict
from typing import Any

import pytest

from playground.shader.syntax import nodes as n
from playground.shader.syntax.influence import Influence, unused
from playground.shader.syntax.parser import Tree, parse
from playground.shader.syntax.symbols import Symbols, resolve

# ── running a program of whole numbers ───────────────────────────────────────


class _Jump(Exception):
    def __init__(self, word: str, value: int = 0) -> None:
        self.word, self.value = word, value


class Machine:
    """Runs the tree of a text whose numbers are whole, and notes what each statement computes, in order."""

    def __init__(self, tree: Tree, uniforms: dict[str, int]) -> None:
        self.functions = {f.name: f for f in tree.declarations if isinstance(f, n.Function) and f.body}
        self.globals = dict(uniforms)
        self.computed: dict[n.Node, list[int]] = defaultdict(list)
        for node in tree.declarations:
            if isinstance(node, n.Declaration) and "uniform" not in node.type.qualifiers:
                self.run(node, [self.globals])
        try:
            self.call(self.functions["kernel"], [], [])
        except _Jump:
            pass

    def call(self, function: n.Function, values: list[int], targets: list[dict[str, int] | None]) -> int:
        own = {p.name: v for p, v in zip(function.parameters, values, strict=True)}
        result = 0
        try:
            assert function.body is not None
            self.run(function.body, [self.globals, own])
        except _Jump as jump:
            if jump.word != "return":
                raise
            result = jump.value
        self.written = [own[p.name] for p in function.parameters]
        return result

    def run(self, node: n.Node | None, scopes: list[dict[str, int]]) -> None:
        match node:
            case n.Block():
                for each in node.statements:
                    self.run(each, scopes) if not isinstance(each, n.Block) else self.run(each, [*scopes, {}])
            case n.Declaration():
                for name in node.names:
                    scopes[-1][name.name] = self.value(name.value, scopes) if name.value else 0
                    self.computed[name].append(scopes[-1][name.name])
            case n.Expression():
                self.computed[node].append(self.value(node.value, scopes))
            case n.If():
                if self.note(node.condition, scopes):
                    self.run(node.yes, [*scopes, {}])
                else:
                    self.run(node.no, [*scopes, {}])
            case n.For():
                scopes = [*scopes, {}]
                self.run(node.start, scopes)
                while self.note(node.condition, scopes):
                    try:
                        self.run(node.body, [*scopes, {}])
                    except _Jump as jump:
                        if jump.word == "break":
                            break
                        if jump.word != "continue":
                            raise
                    self.note(node.step, scopes)
            case n.Jump():
                value = self.value(node.value, scopes) if node.value else 0
                self.computed[node].append(value)
                raise _Jump(node.word, value)

    def note(self, node: n.Node | None, scopes: list[dict[str, int]]) -> int:
        assert node is not None
        value = self.value(node, scopes)
        self.computed[node].append(value)
        return value

    def value(self, node: n.Node, scopes: list[dict[str, int]]) -> int:
        match node:
            case n.Literal():
                return int(node.text)
            case n.Name():
                return next(scope for scope in reversed(scopes) if node.name in scope)[node.name]
            case n.Parenthesized():
                return self.value(node.inside, scopes)
            case n.Conditional():
                return self.value(node.yes if self.value(node.condition, scopes) else node.no, scopes)
            case n.Unary():
                return self.set(node.operand, self.value(node.operand, scopes) + 1, scopes)
            case n.Assign():
                value = self.value(node.value, scopes)
                before = self.value(node.target, scopes) if node.operator == "+=" else 0
                return self.set(node.target, (before + value) % 11, scopes)
            case n.Call():
                function = self.functions[node.name]
                values = [self.value(argument, scopes) for argument in node.arguments]
                result = self.call(function, values, [])
                for parameter, argument, value in zip(
                    function.parameters, node.arguments, self.written, strict=True
                ):
                    if "inout" in parameter.type.qualifiers:
                        self.set(argument, value, scopes)
                return result
            case n.Binary():
                left = self.value(node.left, scopes)
                if node.operator in ("&&", "||") and bool(left) == (node.operator == "||"):
                    return left
                right = self.value(node.right, scopes)
                signs: dict[str, Any] = {"+": left + right, "*": left * right, "<": left < right}
                return int(signs.get(node.operator, right)) % 11
        raise AssertionError(node)

    def set(self, target: n.Node, value: int, scopes: list[dict[str, int]]) -> int:
        assert isinstance(target, n.Name)
        next(scope for scope in reversed(scopes) if target.name in scope)[target.name] = value
        return value


def random_program(seed: int) -> str:
    """Return a text of three functions, with loops, jumps, ``inout`` and a global, of whole numbers."""
    chance = random.Random(seed)

    def value(depth: int, calls: list[str]) -> str:
        kind = chance.randrange(9 if depth else 3)
        if kind < 2:
            return chance.choice("abcg")
        if kind == 2:
            return chance.choice("0123u") if chance.random() < 0.7 else "u"
        if kind == 3:
            return f"({value(depth - 1, calls)} < {value(depth - 1, calls)} ? {value(0, calls)} : b)"
        if kind == 4:
            return f"({value(depth - 1, calls)} && {value(depth - 1, calls)})"
        if kind < 7 and calls:
            return f"{chance.choice(calls)}({value(depth - 1, calls)}, {chance.choice('abc')})"
        return f"({value(depth - 1, calls)} {chance.choice('+*<')} {value(depth - 1, calls)})"

    def statements(depth: int, calls: list[str], in_loop: bool) -> str:
        return " ".join(statement(depth, calls, in_loop) for _ in range(chance.randrange(1, 4)))

    def statement(depth: int, calls: list[str], in_loop: bool) -> str:
        kind = chance.randrange(8 if depth else 3)
        if kind < 2:
            return f"{chance.choice('abcg')} {chance.choice(['=', '+='])} {value(2, calls)};"
        if kind == 2:
            if chance.random() < 0.7:
                return f"{chance.choice('abc')}++;"
            return f"if ({value(1, calls)}) " + (
                chance.choice(["break;", "continue;", "return b;", "discard;"]) if in_loop else "return a;"
            )
        inside = statements(depth - 1, calls, in_loop or kind > 5)
        if kind == 3:
            return f"{{ int b = {value(1, calls)}; {inside} }}"
        if kind < 6:
            other = f" else {{ {statements(depth - 1, calls, in_loop)} }}" if chance.random() < 0.5 else ""
            return f"if ({value(1, calls)}) {{ {inside} }}{other}"
        return f"for (int i = 0; i < {chance.randrange(1, 4)}; ++i) {{ {inside} }}"

    body = "int b = {0}; int c = {1};"
    text = "uniform int u; int g = 1;\n"
    for name, calls in (("first", []), ("second", ["first"])):
        head = body.format(value(0, []).replace("b", "a").replace("c", "a"), 2)
        text += (
            f"int {name}(int p, inout int a) {{ {head} c = p; {statements(2, calls, False)} return a; }}\n"
        )
    return (
        text
        + f"int kernel() {{ int a = 1; int b = 2; int c = 3; {statements(3, ['first', 'second'], False)}}}"
    )


def influenced(symbols: Symbols, *names: str) -> list[n.Node]:
    return Influence(symbols).statements(s for s in symbols.symbols if s.name in names)


@pytest.mark.parametrize("group", range(8))
def test_all_that_changes_when_a_program_runs_is_listed(group: int) -> None:
    changed = listed = 0
    for seed in range(group * 100, group * 100 + 100):
        text = random_program(seed)
        tree = parse(text)
        assert not tree.errors, text
        may = set(influenced(resolve(tree), "u"))
        runs = [Machine(tree, {"u": value}).computed for value in (0, 1, 2, 5, 10)]
        changing = {node for run in runs for node in run if any(run[node] != other[node] for other in runs)}
        assert changing <= may, [text, *(tree.source(node) for node in changing - may)]
        changed, listed = changed + len(changing), listed + len(may)
    assert 0 < changed <= listed


TEXT = """uniform float gain, sun, unread;
float shade(float height, out float rest) {
    rest = 1.0 - height;
    return height * 2.0;
}
float kernel(ivec2 texel) {
    float far = float(texel.x);
    float near = far * gain;
    float left;
    float light = shade(sun, left);
    if (light > 0.5) far = 3.0;
    return far + left;
}
"""


@pytest.mark.parametrize(
    ("names", "lines"),
    [
        (["gain"], [8]),
        (["sun"], [2, 3, 4, 8, 10, 11, 12]),
        (["unread"], []),
        (["near"], []),
        (["left"], [12]),
    ],
)
def test_lines_that_hang_on_a_name(names: list[str], lines: list[int]) -> None:
    """Line 8 reads ``far``, which line 11 changes: the order of a text is not followed."""
    tree = parse(TEXT)
    result = {tree.line(node.first) + 1 for node in influenced(resolve(tree), *names)}
    assert sorted(result) == lines


# ── what nothing names ───────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("float f(float a, float b) { float c = a, d; return a; }", ["b", "c", "d"]),
        ("float f(float a); float g() { return f(1.0); } float f(float a) { return 1.0; }", []),
        ("float kernel(ivec2 texel) { return 1.0; }", []),
        ("void mainImage(out vec4 colour, in vec2 place) { colour = vec4(1.0); }", []),
        ("void f(out float a, inout float b) {}", []),
        ("float f() {\n#ifdef FINE\nfloat e = 1.0;\n#else\nfloat e = 2.0;\n#endif\nreturn e; }", []),
        ("float f() { float e = 1.0;\n#ifdef FINE\nreturn e;\n#endif\nreturn 2.0; }", []),
        ("#define STEP (e * 2.0)\nfloat f() { float e = 1.0; return STEP; }", []),
        ("#define STEP (e * 2.0)\nfloat f() { float e = 1.0; return 3.0; }", ["e"]),
        ("float f() { for (int i = 0; i < 3; ++i) { float i = 2.0; } return 1.0; }", ["i"]),
        ("struct S { float e; }; float f(S s) { float e; return s.e; }", ["e"]),
        (
            "float f(\nfloat a) {\n#ifdef X\n if (a > 1.) {\n#else\n if (a > 2.) {\n#endif\n } return 1.; }",
            [],
        ),
    ],
)
def test_locals_and_parameters_that_nothing_names(text: str, names: list[str]) -> None:
    assert [symbol.name for symbol in unused(resolve(parse(text, all_branches=True)))] == names
