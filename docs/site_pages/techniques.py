"""Generate the catalogue of techniques: a page for each, an index by folder."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from playground.commands.entries import Choice, Entry
from playground.commands.entries import techniques as listed
from playground.paths import GLSL
from playground.shader.kernel import Variant
from playground.sketch.model import Graph, Kernel, Technique, kernels_of
from playground.sketch.techniques import Techniques
from playground.sketch.wiring import deciding_inputs, form_of, input_names

from .markdown import code, escaped, fenced, folded, table
from .shots import picture_of

FOLDERS = {
    "generation": "Generation: what gives heights",
    "erosion": "Erosion: what gravity, water and rivers make of heights",
    "water": "Water: where it goes on a terrain",
    "simulation": "Simulation: what goes on from frame to frame",
    "texturing": "Texturing: what gives colours and weights",
    "lighting": "Lighting: what gives light and shadows",
    "view": "Views: what gives the picture",
    "terrain": "Terrain: what reads heights",
    "lessons": "Lessons: the ideas of others, as short as they go",
    "foreign": "Channels of other tools' shaders",
}
"""The folders of the catalogue; one that is not here comes last, by its name."""

_HEAD = """# Techniques

A technique fills a pass: `use = "generation/mixed"`. This catalogue is generated from the files in
`glsl/`; `playground list` prints the same, and `playground list NAME` the parameters of one.

"""
_KEYS = ("gives", "needs", "units", "source", "tested")
_KEY = re.compile(rf"^\s*({'|'.join(_KEYS)})\s{{2,}}(\S.*)$")


@dataclass(frozen=True)
class Header:
    """What a file says of itself in the comment that it begins with."""

    sentence: str
    keys: dict[str, str]
    prose: tuple[str, ...]  # paragraphs, lines as they stand


@cache
def entries() -> dict[str, list[Entry]]:
    """Return the techniques by folder; raise ``ValueError`` for one that cannot be read."""
    result: dict[str, list[Entry]] = {folder: [] for folder in FOLDERS}
    for entry in listed():
        if entry.error:
            raise ValueError(f"{entry.name}: {entry.error}")
        result.setdefault(entry.name.partition("/")[0], []).append(entry)
    return {folder: names for folder, names in result.items() if names}


@cache
def _techniques() -> Techniques:
    return Techniques()


def path_of(entry: Entry) -> str:
    """Return the page of a technique, from the site's top."""
    return f"reference/techniques/{entry.name.replace('/', '-')}.md"


def header(file: Path) -> Header:
    """Read the comment that a GLSL or TOML file begins with."""
    mark = "#" if file.suffix == ".toml" else "//"
    lines = []
    for line in file.read_text("utf-8").splitlines():
        if not line.startswith(mark) or line.startswith("#pragma"):
            break
        lines.append(line.removeprefix(mark).removeprefix(" ").rstrip())
    keys, rest = _keys(lines)
    paragraphs = [part.strip("\n") for part in re.split(r"\n\s*\n", "\n".join(rest)) if part.strip()]
    if mark == "#":
        return Header("", keys, tuple(paragraphs))
    first = paragraphs[0] if paragraphs else ""
    sentence = " ".join(re.sub(r"^\S+\s+--\s+", "", first).split())
    return Header(sentence, keys, tuple(paragraphs[1:]))


def _keys(lines: list[str]) -> tuple[dict[str, str], list[str]]:
    """Part the rows "source  …" with the lines that go on from them from all others."""
    keys: dict[str, str] = {}
    rest = []
    key, column = "", 0
    for line in lines:
        if match := _KEY.match(line):
            key, column = match[1], match.start(2)
            keys[key] = match[2]
        elif key and line.strip() and len(line) - len(line.lstrip()) >= column:
            keys[key] += f" {line.strip()}"
        else:
            key = ""
            rest.append(line)
    return keys, rest


def description(entry: Entry) -> str:
    """Return what a technique's file says of it, as Markdown; raise ``ValueError`` where it says nothing."""
    result = header(Path(entry.file))
    text = "".join(_paragraph(p) for p in ((result.sentence,) if result.sentence else ()) + result.prose)
    if not text.strip():
        raise ValueError(f"{entry.name}: {entry.file} begins with no comment that says what it does")
    return text


def _paragraph(text: str) -> str:
    lines = text.splitlines()
    if any(re.match(r"\s{2,}", line) or re.search(r"\S\s{3,}\S", line) for line in lines):
        return fenced(text, "text")
    return escaped(text) + "\n\n"


def index() -> str:
    """Return the page that shows all techniques by folder."""
    parts = [_HEAD]
    for folder, entry in entries().items():
        parts.append(f"## {FOLDERS.get(folder, folder)} {{ #{folder} }}\n\n")
        parts.append('<div class="catalogue" markdown>\n\n')
        parts += [_card(entry) for entry in entry]
        parts.append("</div>\n\n")
    return "".join(parts)


def _card(entry: Entry) -> str:
    picture = picture_of(entry.name)
    image = f"![](../../{picture.thumbnail}){{ loading=lazy }}" if picture else ""
    link = path_of(entry).rpartition("/")[2]
    return f"[{image}<b>{escaped(entry.title)}</b> {code(entry.name)}]({link}){{ .card }}\n\n"


def page(entry: Entry) -> str:
    """Return the page of one technique."""
    technique = _techniques().read(entry.name, GLSL, GLSL)
    file = Path(entry.file)
    parts = [f"# {escaped(entry.title)}\n\n", fenced(f'use = "{entry.name}"', "toml")]
    if picture := picture_of(entry.name):
        alt = f"Shot {picture.shot} of the sketch {picture.sketch}"
        parts.append(f"![{escaped(alt)}](../../{picture.thumbnail}){{ .shot }}\n\n")
        parts.append(f"*{escaped(alt)}:* {code(picture.command)}\n\n")
    parts.append(description(entry))
    parts.append(f"A {_kind(entry, technique)}. File: {code(file.relative_to(GLSL.parent).as_posix())}\n\n")
    parts += [_wiring(entry, technique), _parameters(entry), _origin(technique), _variants(technique)]
    parts.append("## Text { data-search-exclude }\n\n")
    language = "toml" if file.suffix == ".toml" else "glsl"
    parts.append(folded(file.relative_to(GLSL).as_posix(), fenced(file.read_text("utf-8"), language)))
    for kernel in _own(technique):
        if kernel.path != entry.file:
            text = fenced(Path(kernel.path).read_text("utf-8"), "glsl")
            parts.append(folded(Path(kernel.path).relative_to(GLSL).as_posix(), text))
    return "".join(parts)


def _kind(entry: Entry, technique: Technique) -> str:
    kinds = {"several passes": "technique of several passes", "plain_fragment": "plain shader"}
    if isinstance(technique, Kernel) and technique.repeat != "1":
        return f"{kinds.get(entry.kind, entry.kind)} that repeats, {technique.repeat} steps"
    return kinds.get(entry.kind, entry.kind)


def _wiring(entry: Entry, technique: Technique) -> str:
    formats = {}
    fallbacks = {}
    if isinstance(technique, Kernel):
        formats = {output.name: output.format for output in technique.outputs}
        fallbacks = {result.name: result.fallback for result in technique.inputs}
    rows = []
    for name in entry.inputs:
        notes = f"may stay unwired; it then reads {fallbacks[name]}" if fallbacks.get(name) else ""
        if isinstance(technique, Graph) and name in deciding_inputs(technique):
            notes = _deciding(technique, name)
        rows.append(("input", code(name), notes))
    rows += [("output", code(name), code(formats.get(name, ""))) for name in entry.outputs]
    return "## Inputs and outputs\n\n" + table(("", "Name", ""), rows)


def _deciding(graph: Graph, name: str) -> str:
    """Return which passes of a technique are present by one of its inputs."""
    every = set(input_names(graph))
    present, without = ([spec.name for spec in form_of(graph, w).passes] for w in (every, every - {name}))
    parts = [
        (text, [code(item) for item in some if item not in others])
        for text, some, others in (
            ("only where it is wired", present, without),
            ("only where it is not", without, present),
        )
    ]
    listed = "; ".join(f"{text}: {', '.join(names)}" for text, names in parts if names)
    return listed or "passes inside are present only where it is wired"


def _parameters(entry: Entry) -> str:
    shown = [choice for choice in entry.parameters if choice.exported]
    inner = [choice for choice in entry.parameters if not choice.exported]
    if not entry.parameters:
        return "## Parameters\n\nNone.\n\n"
    text = "## Parameters\n\n" + (_table(shown) or "None of its own.\n\n")
    return text + (folded(f"{len(inner)} parameters of the passes inside", _table(inner)) if inner else "")


def _table(choices: list[Choice]) -> str:
    rows = [
        (
            code(choice.path),
            escaped(choice.text),
            escaped(choice.range),
            escaped(choice.parameter.unit),
            escaped(choice.parameter.tooltip or choice.parameter.title),
        )
        for choice in choices
    ]
    return table(("Parameter", "Default", "Range", "Unit", "Meaning"), rows)


def _own(technique: Technique) -> list[Kernel]:
    """List the kernels that only this technique uses; of one without any, all that it uses."""
    kernels = list({kernel.name: kernel for _, kernel in kernels_of(technique)}.values())
    own = [k for k in kernels if k.name == technique.name or k.name.startswith(f"{technique.name}/")]
    return own or kernels


def _origin(technique: Technique) -> str:
    rows = []
    for kernel in _own(technique):
        keys = header(Path(kernel.path)).keys
        rows.append((code(kernel.name), escaped(keys.get("source", "")), escaped(keys.get("tested", ""))))
    rows = [row for row in rows if any(row[1:])]
    return (
        "## Method and checks\n\n" + table(("Kernel", "Source of the method", "Checked by"), rows)
        if rows
        else ""
    )


def _variants(technique: Technique) -> str:
    rows = []
    for variant in _all_variants(technique):
        bounds = "; ".join(f"{b.output}: {b}" if b.output else str(b) for b in variant.technique.agrees)
        rows.append((code(Path(variant.path).relative_to(GLSL).as_posix()), escaped(bounds)))
    text = "Each runs while it is [known to agree](../../how-to/fast-variants.md) with its plain form.\n\n"
    return "## Fast variants\n\n" + table(("File", "Agrees to"), rows) + text if rows else ""


def _all_variants(technique: Technique) -> list[Variant]:
    """List the fast variants of a technique and of its own kernels."""
    variants = {variant.path: variant for variant in technique.variants}
    for kernel in _own(technique):
        variants |= {variant.path: variant for variant in kernel.variants}
    return list(variants.values())
