"""The words of the window's modules: what is translated in them, and what is shown as it stands there."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import playground

ROOT = Path(playground.__file__).resolve().parent
DRAWS = re.compile(r"^from (imgui_bundle import .*\bimgui\b|playground\.studio\.language )", re.MULTILINE)
MODULES = sorted(
    {*(ROOT / "studio").rglob("*.py"), *ROOT.glob("*/window/*.py"), *ROOT.glob("*/addition.py")}
    | {path for path in ROOT.rglob("*.py") if DRAWS.search(path.read_text("utf-8"))}
)
"""The modules of the window, those that rooms add to it, and those that draw in one of their own."""

TRANSLATE = {"tr", "tr_label", "counted", "numeral", "shortcut"}
LESSONS = {"page", "self", "reader"}
"""What has a ``say`` and a ``label`` that look words up in the catalogue of lessons, by keys."""
SHOW = {
    *(
        "text",
        "text_unformatted",
        "text_disabled",
        "text_colored",
        "text_wrapped",
        "bullet_text",
        "text_link",
    ),
    *("button", "buttons", "small_button", "checkbox", "radio_button", "selectable", "menu_item_simple"),
    *("menu_item", "begin_menu", "menu", "begin_combo", "combo", "choose", "collapsing_header", "header"),
    *(
        "tree_node_ex",
        "begin_tab_item",
        "separator_text",
        "set_tooltip",
        "set_item_tooltip",
        "explain",
        "row",
    ),
    *(
        "input_text",
        "input_text_with_hint",
        "input_int",
        "input_float",
        "input_double",
        "cross",
        "slot_button",
    ),
    *("slider_int", "slider_float", "drag_int", "drag_float", "add_text", "plate", "say", "step", "set_all"),
    *(
        "plot_line",
        "plot_stairs",
        "plot_lines",
        "report_once",
        "_report",
        "_flowing",
        "_stepper",
        "draw_waiting",
        "_plate",
    ),
}
"""The functions that show the words that they are given, or remember them to be shown."""
KEY = re.compile(r"[A-Z][a-z]\w+")
"""A key in a shortcut whose name is a word."""
NAMES = {"menu": {1}, "report_once": {0}, "step": {1}, "slot_button": {0}, "cross": {0}, "_stepper": {0}}
"""Which of a function's arguments is a name that nobody sees."""
READ = {"get", "split", "partition", "rpartition", "join", "value", "getattr", "removesuffix", "replace"}
"""Functions whose own words are looked for, or stand between others."""

_EXCUSED = re.compile(
    r"([^a-zA-Z]|\b[A-Z]\b)*"  # marks, numbers, A and B
    r"|(Ctrl\+)?(F\d+|[A-Z0-9,.]|Aa)"  # keys that each keyboard calls so
    r"|[A-Z/-]{2,}[\W\d]*"  # PNG, MIDI
    r"|(glsl/|map\.)[\W\d]*"  # paths
    r"|0+-?[a-z]+"  # names of widgets, after that of their row
    r"|[^a-zA-Z]*\b(ms|fps|px|m|s|x|ft)\b[^a-zA-Z]*"  # units
)


def trees() -> Iterator[tuple[Path, ast.Module]]:
    for path in MODULES:
        yield path, ast.parse(path.read_text("utf-8"))


def room_of(path: Path) -> str:
    """Return the room that a module is of."""
    return path.relative_to(ROOT).parts[0]


def called(call: ast.Call) -> str:
    """Return the name of the function that is called, without what it is of."""
    match call.func:
        case ast.Attribute(ast.Name("notes") | ast.Attribute(attr="notes"), "append"):
            return "say"  # a note is a notice of the next frame
        case ast.Name(name) | ast.Attribute(attr=name):
            return name
    return ""


def _is_of_lessons(call: ast.Call) -> bool:
    match call.func:
        case ast.Attribute(ast.Name(owner), "say" | "_say" | "label"):
            return owner in LESSONS
    return False


def translated(tree: ast.AST, function: str = "tr") -> Iterator[str]:
    """Yield the English words that a module translates by a function, where they stand in the call."""
    for call in ast.walk(tree):
        if not isinstance(call, ast.Call) or not call.args:
            continue
        match called(call), call.args:
            case name, [ast.Constant(str(words)), *_] if name == function:
                yield words
            case "shortcut", [ast.Constant(str(keys))]:
                yield from KEY.findall(keys)
            case "counted", [_, noun]:
                nouns = [word.value for word in ast.walk(noun) if isinstance(word, ast.Constant)]
                yield from (form for word in nouns for form in (word, f"{word}s"))


def strings(tree: ast.AST) -> Iterator[str]:
    """Yield every text that stands in a module, in a shortcut word by word."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value
            yield from KEY.findall(node.value)


def shown_as_they_are(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield the lines and the words of a module that are shown and not translated.

    Looked at are the calls of ``SHOW``: what stands in their arguments, and what the names in these were
    given in the same function, or at the top of the module.
    """
    constants = dict(_assigned(tree.body))
    for function in [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]:
        local: dict[str, list[ast.expr]] = {}
        for name, value in _assigned(ast.walk(function)):
            local.setdefault(name, []).append(value)
        for call in ast.walk(function):
            if isinstance(call, ast.Call) and called(call) in SHOW and not _is_of_lessons(call):
                barred = NAMES.get(called(call), set())
                words = [word for at, word in enumerate(call.args) if at not in barred]
                for argument in [*words, *(key.value for key in call.keywords)]:
                    yield from _untranslated(argument, local, constants)


def _assigned(nodes: object) -> Iterator[tuple[str, ast.expr]]:
    for node in nodes:  # type: ignore[attr-defined]
        match node:
            case ast.Assign(targets=[ast.Name(name)], value=value):
                yield name, value
            case ast.Assign(targets=[ast.Tuple(names)], value=ast.Tuple(values)):
                yield from ((n.id, v) for n, v in zip(names, values, strict=False) if isinstance(n, ast.Name))


def _untranslated(
    node: ast.AST, local: dict[str, list[ast.expr]], constants: dict[str, ast.expr]
) -> Iterator[tuple[int, str]]:
    match node:
        case ast.Call() if called(node) in TRANSLATE | READ or _is_of_lessons(node):
            return
        case ast.Constant(str(words)) if is_english(words):
            yield node.lineno, words
        case ast.JoinedStr(parts):
            words = "".join(part.value if isinstance(part, ast.Constant) else "0" for part in parts)
            if is_english(words):
                yield node.lineno, words
            inner = [part.value for part in parts if isinstance(part, ast.FormattedValue)]
            for part in inner:
                yield from _untranslated(part, local, constants)
        case ast.Name(name):
            for value in local.get(name, [constants[name]] if name in constants else []):
                if not isinstance(value, ast.Call | ast.Lambda):
                    yield from _untranslated(value, {}, {})
        case (
            ast.Compare()
            | ast.comprehension()
            | ast.Subscript()
            | ast.Lambda()
            | ast.Attribute()
            | ast.Dict()
        ):
            return
        case ast.IfExp(body=body, orelse=other):
            yield from _untranslated(body, local, constants)
            yield from _untranslated(other, local, constants)
        case _:
            for child in ast.iter_child_nodes(node):
                yield from _untranslated(child, local, constants)


def is_english(words: str) -> bool:
    """Return whether a text, without what follows "##", has words that are to be translated."""
    seen = re.sub(r"%[-+.\d]*[a-z]", "0", words.partition("##")[0]).strip()
    return _EXCUSED.fullmatch(seen) is None
