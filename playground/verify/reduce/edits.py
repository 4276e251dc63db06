"""GLSL as tokens, as text with one statement a line, and small edits of it that may make it smaller.

A preprocessor line and a uniform with its annotation are one token each: the header's
grammar reads them line by line. Everything else is split as GLSL splits it, comments left
out. ``tidy`` prints any tokens in one form, so that two candidates that differ in blanks
alone are one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

# ── tokens ───────────────────────────────────────────────────────────────────


_TOKEN = re.compile(
    r"(?P<line>^[ \t]*(?:\#[^\n]*|uniform\b[^\n]*))"
    r"|(?P<comment>//[^\n]*|/\*.*?(?:\*/|\Z))"
    r"|(?P<number>(?:0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)[uUfF]*)"
    r"|(?P<word>[A-Za-z_]\w*)"
    r"|(?P<mark><<=|>>=|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||\^\^|[-+*/%&|^]=|[^\s\w])",
    re.MULTILINE | re.DOTALL,
)
_WORD = re.compile(r"[A-Za-z_]\w*")
_NUMBER = re.compile(r"\.?\d")

PAIRS = {"(": ")", "[": "]", "{": "}"}
ASSIGNS = frozenset("= += -= *= /= %= &= |= ^= <<= >>=".split())
OPERATORS = frozenset("+ - * / % << >> < > <= >= == != && || ^^ & | ^".split())
CONTROL = frozenset("if else for while do switch return case default break continue discard".split())
_NO_SPACE_BEFORE = frozenset(") ] , ; . ++ --".split())
_NO_SPACE_AFTER = frozenset("( [ . ! ~".split())


def tokens_of(text: str) -> list[str]:
    """Split a text into tokens; a whole-line token keeps its inner blanks."""
    tokens = []
    for match in _TOKEN.finditer(text):
        if match.lastgroup != "comment":
            tokens.append(match.group().strip())
    return tokens


def is_word(token: str) -> bool:
    """Return whether a token is an identifier or a keyword."""
    return bool(_WORD.fullmatch(token))


def is_number(token: str) -> bool:
    """Return whether a token is a literal number."""
    return bool(_NUMBER.match(token))


def is_line(token: str) -> bool:
    """Return whether a token is a whole line: of the preprocessor, or a uniform."""
    return token.startswith("#") or token.startswith("uniform ")


def partners(tokens: Sequence[str]) -> dict[int, int]:
    """Map each bracket's index to that of its partner, both ways; unpaired ones are left out."""
    partners_by_index: dict[int, int] = {}
    open_: list[int] = []
    for index, token in enumerate(tokens):
        if token in PAIRS:
            open_.append(index)
        elif token in PAIRS.values() and open_ and PAIRS[tokens[open_[-1]]] == token:
            start = open_.pop()
            partners_by_index[start], partners_by_index[index] = index, start
    return partners_by_index


def print_tokens(tokens: Sequence[str]) -> str:
    """Return tokens as text: one statement a line, four blanks a depth, one blank where it reads well."""
    lines: list[str] = []
    words: list[str] = []
    depth = brackets = 0
    unary = False  # whether the last token was a sign

    def end() -> None:
        nonlocal words
        if words:
            shift = depth - 1 if words[0] == "}" else depth
            lines.append("    " * max(shift, 0) + "".join(words))
        words = []

    last = ""
    for index, token in enumerate(tokens):
        if is_line(token):
            end()
            lines.append(token)
            last = ""
            continue
        sign = token in ("-", "+") and (
            last in ("", "(", "[", ",", "?", ":", "return", "{", "}", ";") or last in ASSIGNS | OPERATORS
        )
        if words and _parted(last, token, unary):
            words.append(" ")
        words.append(token)
        unary = sign
        brackets += {"(": 1, "[": 1, ")": -1, "]": -1}.get(token, 0)
        following = tokens[index + 1] if index + 1 < len(tokens) else ""
        last = token
        if token == "{":
            end()
            depth += 1
        elif token == "}":
            shift = depth
            if following not in (";", ",") and not (is_word(following) and _names_block(tokens, index)):
                end()
            depth = max(shift - 1, 0)
        elif token == ";" and brackets <= 0:
            end()
            brackets = 0
    end()
    return "\n".join(lines) + "\n" if lines else ""


def tidy(text: str) -> str:
    """Return a text without comments, one statement a line."""
    return print_tokens(tokens_of(text))


def _parted(last: str, token: str, unary: bool) -> bool:
    if token in _NO_SPACE_BEFORE or last in _NO_SPACE_AFTER or unary:
        return False
    if token == "[":
        return False
    if token == "(":
        return not (is_word(last) and last not in CONTROL)
    if last in ("++", "--"):
        return token in OPERATORS or token in ASSIGNS
    return True


def _names_block(tokens: Sequence[str], index: int) -> bool:
    """Return whether the word after a closing brace names what the block declared, as ``} light;``."""
    return index + 2 < len(tokens) and tokens[index + 2] in (";", "[") and tokens[index + 1] not in CONTROL


# ── edits: each gives a whole new text, with fewer tokens, or a literal for a name


LITERALS = ("0.0", "1.0", "0", "1", "true", "false")
"""What may take the place of an expression."""

LITERALS_WITHOUT_ZERO = ("1.0", "1", "true", "false")
"""The same where a zero could itself bring about what is looked for: a whole 0 becomes 0.0 in a division."""

Edit = tuple[int, int, tuple[str, ...]]
"""From which token to which, and what takes their place."""

_ENTRY_POINTS = frozenset("kernel visit vertex fragment main".split())
_TYPES = frozenset(
    "void bool int uint float vec2 vec3 vec4 ivec2 ivec3 ivec4 uvec2 uvec3 uvec4 bvec2 bvec3 bvec4"
    " mat2 mat3 mat4 const in out inout struct sampler2D flat highp mediump lowp precise".split()
)
_OPENERS = frozenset({"(", "[", ",", "?", ":", "return", *ASSIGNS, *OPERATORS, "!", "~"})
_OPTION = re.compile(r',?\s*\b(\w+)\s*=\s*("[^"]*"|\d+)')
_UNIFORM = re.compile(r"uniform\s+(\w+)\s+(\w+)\s*(?:=\s*([^;]*?)\s*)?;(.*)")


def expressions(text: str, literals: Sequence[str] = LITERALS) -> Iterator[str]:
    """Yield the text with one expression made simpler, the largest first."""
    tokens = tokens_of(text)
    for low, high, instead in _in_order(tokens, literals):
        yield print_tokens([*tokens[:low], *instead, *tokens[high:]])


def in_both(text: str, other: str, literals: Sequence[str] = LITERALS) -> Iterator[tuple[str, str]]:
    """Yield two texts with the same expression made simpler in each, where both have it once.

    A kernel and the compute shader that replaces it agree only as long as both change.
    """
    tokens, others = tokens_of(text), tokens_of(other)
    for low, high, instead in _in_order(tokens, literals):
        index = _only_place(others, tokens[low:high])
        if index is not None and _only_place(tokens, tokens[low:high]) == low:
            changed = [*others[:index], *instead, *others[index + high - low :]]
            yield print_tokens([*tokens[:low], *instead, *tokens[high:]]), print_tokens(changed)


def _only_place(tokens: list[str], part: list[str]) -> int | None:
    """Return where some tokens occur in others, if they do so once."""
    indices = [i for i in range(len(tokens) - len(part) + 1) if tokens[i : i + len(part)] == part]
    return indices[0] if len(indices) == 1 else None


def _in_order(tokens: list[str], literals: Sequence[str]) -> list[Edit]:
    """Return the edits of some tokens, those that take the most away first."""
    return sorted(set(_edits(tokens, literals)), key=lambda e: (e[0] - e[1] + len(e[2]), -e[0], e[2]))


def _edits(tokens: list[str], literals: Sequence[str]) -> Iterator[Edit]:
    pairs = partners(tokens)
    depth = 0
    for index, token in enumerate(tokens):
        depth += (token == "{") - (token == "}")
        if is_line(token):
            continue
        if token in _OPENERS and index + 1 < len(tokens) and (depth or token in ASSIGNS):
            yield from _of_region(tokens, index + 1, pairs, literals)
        if depth and _begins_primary(tokens, index):
            yield from _of_primary(tokens, index, pairs, literals)
        if token in ASSIGNS and token != "=":
            yield index, index + 1, ("=",)
        if token in ("-", "+", "!", "~") and depth and _is_sign(tokens, index):
            yield index, index + 1, ()


def inlined(text: str) -> Iterator[str]:
    """Yield the text with one variable less: its value in its place, if it is one token or used once."""
    tokens = tokens_of(text)
    pairs = partners(tokens)
    for index in range(1, len(tokens) - 1):
        name = tokens[index]
        if tokens[index + 1] != "=" or not is_word(name) or not is_word(tokens[index - 1]):
            continue
        end = _end_of_region(tokens, index + 2, pairs)
        if tokens[end : end + 1] != [";"]:
            continue
        if tokens[end + 1 : end + 3] == [name, "="]:
            yield print_tokens([*tokens[:index], *tokens[end + 1 :]])  # what is overwritten at once
        first = index - 2 if index > 1 and tokens[index - 2] == "const" else index - 1
        uses = [i for i in range(end, len(tokens)) if tokens[i] == name and tokens[i - 1] != "."]
        value = tokens[index + 2 : end]
        if not uses or (len(uses) > 1 and len(value) > 1):
            continue
        bare = len(value) == 1 or _end_of_primary(tokens, index + 2, pairs)[-1] == end
        instead = value if bare else ["(", *value, ")"]
        rest: list[str] = []
        for position, token in enumerate(tokens):
            if position in uses:
                rest += instead
            elif not first <= position <= end:
                rest.append(token)
        yield print_tokens(rest)


def _is_sign(tokens: list[str], index: int) -> bool:
    return tokens[index] in ("!", "~") or (index > 0 and tokens[index - 1] in _OPENERS)


def _end_of_region(tokens: list[str], start: int, pairs: dict[int, int]) -> int:
    """Return where an expression ends: before the bracket, comma, colon or semicolon that closes it."""
    index = start
    while index < len(tokens):
        token = tokens[index]
        if token in PAIRS and index in pairs:
            index = pairs[index]
        elif token in (")", "]", "}", ",", ";", "?", ":", "{") or is_line(token) or token in ASSIGNS:
            return index
        index += 1
    return index


def _of_region(
    tokens: list[str], start: int, pairs: dict[int, int], literals: Sequence[str]
) -> Iterator[Edit]:
    end = _end_of_region(tokens, start, pairs)
    if end <= start:
        return
    whole = tokens[start:end]
    for literal in literals:
        if len(whole) > 1 or not (is_number(whole[0]) or whole[0] in ("true", "false")):
            yield start, end, (literal,)
    index = start
    while index < end:
        if tokens[index] in PAIRS and index in pairs:
            index = pairs[index]
        elif tokens[index] in OPERATORS and index > start and not _is_sign(tokens, index):
            yield start, index + 1, ()
            yield index, end, ()
        index += 1
    if end < len(tokens) and tokens[end] == "?":
        yes = _end_of_region(tokens, end + 1, pairs)
        if yes < len(tokens) and tokens[yes] == ":":
            no = _end_of_region(tokens, yes + 1, pairs)
            yield start, no, tuple(tokens[end + 1 : yes])
            yield start, no, tuple(tokens[yes + 1 : no])


def _begins_primary(tokens: list[str], index: int) -> bool:
    """Return whether a token begins an operand: not a declared name, a type, or what is assigned to."""
    token = tokens[index]
    before = tokens[index - 1] if index else ""
    if token == "(":
        return not is_word(before) or before == "return"
    if not (is_word(token) or is_number(token)) or token in CONTROL or before == ".":
        return False
    following = tokens[index + 1] if index + 1 < len(tokens) else ""
    if token in _TYPES and following != "(":
        return False
    return not (is_word(before) and before not in CONTROL) and following not in ASSIGNS


def _end_of_primary(tokens: list[str], index: int, pairs: dict[int, int]) -> list[int]:
    """Return where an operand could end: after its name, then after each postfix."""
    ends = [pairs.get(index, index) + 1]
    while ends[-1] < len(tokens):
        end = ends[-1]
        if tokens[end] in ("(", "[") and end in pairs:
            ends.append(pairs[end] + 1)
        elif tokens[end] == "." and end + 1 < len(tokens):
            ends.append(end + 2)
        else:
            break
    return ends


def _of_primary(
    tokens: list[str], start: int, pairs: dict[int, int], literals: Sequence[str]
) -> Iterator[Edit]:
    ends = _end_of_primary(tokens, start, pairs)
    end = ends[-1]
    if end - start > 1:
        for literal in literals:
            yield start, end, (literal,)
    for shorter in ends[:-1]:
        if shorter > start + 1 or tokens[shorter] != "(":
            yield shorter, end, ()
    bracket = start if tokens[start] == "(" else start + 1
    if bracket in pairs and tokens[bracket] == "(":
        close = pairs[bracket]
        arguments = _arguments(tokens, bracket, pairs)
        for low, high in arguments:
            inner = tuple(tokens[low:high])
            bare = len(inner) == 1 or _end_of_primary(tokens, low, pairs)[-1] == high
            yield start, close + 1, inner if bare else ("(", *inner, ")")
            if bracket == start:
                yield start, close + 1, inner
        if bracket != start:
            for number, (low, high) in enumerate(arguments):
                yield low - (number > 0), high + (number == 0 and len(arguments) > 1), ()


def _arguments(tokens: list[str], bracket: int, pairs: dict[int, int]) -> list[tuple[int, int]]:
    """Return from which token to which each argument in a pair of brackets goes."""
    close = pairs[bracket]
    arguments: list[tuple[int, int]] = []
    low = index = bracket + 1
    while index < close:
        if index in pairs and pairs[index] > index:
            index = pairs[index]
        elif tokens[index] == ",":
            arguments.append((low, index))
            low = index + 1
        index += 1
    if close > low:
        arguments.append((low, close))
    return arguments


def stubs(text: str, number: str = "0.0") -> Iterator[str]:
    """Yield the text with one function's body replaced by a constant, the last function first."""
    tokens = tokens_of(text)
    pairs = partners(tokens)
    for index in reversed(range(1, len(tokens) - 1)):
        close = pairs.get(index + 1, -1)
        body = close + 1
        if tokens[index + 1] != "(" or tokens[body : body + 1] != ["{"] or body not in pairs:
            continue
        kind, name = tokens[index - 1], tokens[index]
        if not is_word(kind) or kind in CONTROL or name in CONTROL:
            continue
        if kind in ("float", "int", "uint", "bool"):
            value = {"int": "0", "uint": "0u", "bool": "false"}.get(kind, number)
        elif re.fullmatch(r"[iu]?vec[234]", kind):
            value = f"{kind}({number})"
        else:
            continue
        stub = tokens_of(f"return {value};")
        if len(stub) < pairs[body] - body - 1:
            yield print_tokens([*tokens[: body + 1], *stub, *tokens[pairs[body] :]])


def parameters_of_functions(text: str) -> Iterator[str]:
    """Yield the text without one parameter of one function, nor the argument of any call of it."""
    tokens = tokens_of(text)
    pairs = partners(tokens)
    for index in range(1, len(tokens) - 1):
        name, close = tokens[index], pairs.get(index + 1, -1)
        defined = tokens[index + 1] == "(" and close > 0 and tokens[close + 1 : close + 2] == ["{"]
        if (
            not defined
            or not is_word(name)
            or not is_word(tokens[index - 1])
            or name in _ENTRY_POINTS | CONTROL
        ):
            continue
        count = len(_arguments(tokens, index + 1, pairs))
        places = [i for i in range(len(tokens) - 1) if tokens[i] == name and tokens[i + 1] == "("]
        lists = [_arguments(tokens, index + 1, pairs) for index in places if index + 1 in pairs]
        if any(len(argument_list) != count for argument_list in lists):
            continue  # overloaded
        for number in range(count):
            gone = set()
            for argument_list in lists:
                low, high = argument_list[number]
                gone |= set(range(low - (number > 0), high + (number == 0 and count > 1)))
            yield print_tokens([token for i, token in enumerate(tokens) if i not in gone])


def headers(text: str) -> Iterator[str]:
    """Yield the text with one option less in its pragma, one step in place of many, or less annotation."""
    lines = text.split("\n")
    for number, line in enumerate(lines):
        for shorter in _shorter_header(line):
            yield "\n".join([*lines[:number], shorter, *lines[number + 1 :]])


def _shorter_header(line: str) -> Iterator[str]:
    if line.startswith("#pragma"):
        for match in _OPTION.finditer(line):
            if match.group(1) not in ("output", "mesh"):
                yield line[: match.start()] + line[match.end() :]
            if match.group(1) == "repeat" and match.group(2) not in ('"1"', '"2"'):
                for steps in ("1", "2"):
                    yield f'{line[: match.start(2)]}"{steps}"{line[match.end(2) :]}'
    result = _UNIFORM.match(line)
    if result is None:
        return
    declared, note = line[: result.start(4)], result.group(4).strip().removeprefix("//!").strip()
    if not note:
        return
    yield declared
    role = re.match(r"\w+(?:\([^)]*\))?", note)
    if role and role.group() != note:
        yield f"{declared}  //! {role.group()}"
    words = re.match(r"(input|file)\b.*", note)
    if words and note != words.group(1):
        yield f"{declared}  //! {words.group(1)}"


def constants(text: str, values: dict[str, str]) -> Iterator[str]:
    """Yield the text with one parameter folded in as a constant; ``values`` are GLSL, by name.

    A parameter that is not among them has its default.
    """
    lines = text.split("\n")
    for number, line in enumerate(lines):
        match = _UNIFORM.match(line)
        if match is None or match.group(1).startswith("sampler"):
            continue
        kind, name, default = match.group(1), match.group(2), match.group(3)
        value = values.get(name, default)
        if value:
            yield tidy("\n".join([*lines[:number], f"const {kind} {name} = {value};", *lines[number + 1 :]]))


def undefined(text: str) -> frozenset[str]:
    """Return the variables that are read but never given a value, and the functions that return none.

    What GLSL leaves undefined, drivers fill in as they like, and no failure of it is a
    driver's. A variable passed to a function may be given its value there.
    """
    tokens = tokens_of(text)
    pairs = partners(tokens)
    names: set[str] = set()
    depth = 0
    for index, token in enumerate(tokens[:-2]):
        depth += (token == "{") - (token == "}")
        name, following = tokens[index + 1], tokens[index + 2]
        if is_line(token) or not is_word(token) or token in CONTROL or not is_word(name):
            continue
        if depth and following in (";", ",") and not _is_set(tokens, name, index + 2, pairs):
            names.add(name)
        close = pairs.get(index + 2, -1)
        if not depth and following == "(" and tokens[close + 1 : close + 2] == ["{"]:
            body = tokens[close + 1 : pairs.get(close + 1, len(tokens))]
            if token != "void" and not _returns(body):
                names.add(f"{name}()")
            arguments = tokens[index + 3 : close]
            for position, word in enumerate(arguments[:-2]):
                called = arguments[position + 2]
                if word == "out" and not _is_set(tokens, called, close + 1, pairs):
                    names.add(called)
    return frozenset(names)


def _is_outermost(tokens: list[str], index: int) -> bool:
    """Return whether a closing brace ends what is at the text's outermost level."""
    return tokens[: index + 1].count("{") == tokens[: index + 1].count("}")


def _returns(body: list[str]) -> bool:
    """Return whether a function's own level has a return that hangs on nothing."""
    depth = 0
    for index, token in enumerate(body):
        depth += (token == "{") - (token == "}")
        if token == "return" and depth == 1 and body[index - 1] in ("{", "}", ";"):
            return True
    return False


def _is_set(tokens: list[str], name: str, start: int, pairs: dict[int, int]) -> bool:
    """Return whether a name is assigned to from a token on, within its function, or given to another."""
    brackets: list[int] = []
    for index in range(start, len(tokens)):
        token = tokens[index]
        if token == "}" and tokens[pairs.get(index, 0) - 1] == ")" and _is_outermost(tokens, index):
            return False
        if token == "(":
            brackets.append(index)
        elif token == ")" and brackets:
            brackets.pop()
        if token != name or tokens[index - 1] == ".":
            continue
        end = _end_of_primary(tokens, index, pairs)[-1]
        if tokens[end : end + 1] == ["="]:
            return True
        if brackets and tokens[end : end + 1] in ([","], [")"]) and tokens[index - 1] in ("(", ","):
            called = tokens[brackets[-1] - 1]
            if is_word(called) and called not in CONTROL and called not in _TYPES:
                return True
    return False
