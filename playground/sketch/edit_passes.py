"""Edit the passes of a sketch: add, wire, delete, duplicate and move them, in its text and as it is loaded.

``wires_of`` says what feeds what, by wires that are written and by names. An edit keeps all of that but
what it is about: where another pass comes or goes, or the order changes, a wire that was found by its name
is written where it would be another one. Each edit changes the text only there: comments, order and the way
that tables are written stay.

Deleting a pass, or muting it, joins what it is made of to those that read it.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

from playground.errors import SketchError, nearest
from playground.memo import GRAPHS
from playground.paths import shown
from playground.shader.source import normalised
from playground.sketch.flatten import flatten
from playground.sketch.load import load_with
from playground.sketch.model import Graph, Kernel, PassSpec, Sketch, Technique
from playground.sketch.save import table_of, with_view, write_over
from playground.sketch.techniques import Techniques
from playground.sketch.toml_text import KeyPath, blocks, drop, key_text, newline_of, put, text_of
from playground.sketch.wiring import (
    as_wired,
    found_source,
    input_names,
    is_optional,
    output_names,
    outputs_with_formats,
    takes_input,
)

Inputs = Mapping[tuple[str, str], str]
"""What feeds each input, "pass[.inner…][:output]", by its pass and its name."""


@dataclass(frozen=True, slots=True)
class Wire:
    """What feeds an input of a pass."""

    giver: str  # the pass
    output: str  # of that pass; "" where a texture inside it is read
    reader: str
    input: str
    source: str  # as a file names it
    is_written: bool  # else it was found by its name


def wires_of(graph: Graph) -> tuple[Wire, ...]:
    """Return the wires between the passes of a sketch, reader by reader."""
    return tuple(chain.from_iterable(_wires_to(spec, graph.passes) for spec in graph.passes))


def _wires_to(spec: PassSpec, passes: Sequence[PassSpec]) -> Iterable[Wire]:
    by_name, written = {other.name: other for other in passes}, dict(spec.inputs)
    for name, source in written.items():
        where, _, output = source.partition(":")
        head, _, inner = where.partition(".")
        if head not in by_name:
            continue
        if not output and not inner:
            output = _usual_output(by_name[head].technique, name)
        yield Wire(head, "" if inner else output, spec.name, name, source, True)
    earlier = passes[: next(n for n, other in enumerate(passes) if other.name == spec.name)]
    for name in input_names(spec.technique):
        if name in written or _is_covered(spec.technique, name, written):
            continue
        found = found_source(spec.technique, name, earlier)
        if found is not None:
            giver, output = found
            yield Wire(giver.name, output, spec.name, name, source_text(giver, output, name), False)


def _is_covered(technique: Technique, name: str, written: Mapping[str, str]) -> bool:
    """Return whether wires to paths inside feed all that an input of a technique is for."""
    exports = technique.inputs if isinstance(technique, Graph) else ()
    return any(e.name == name and all(target in written for target in e.targets) for e in exports)


def _usual_output(technique: Technique, name: str) -> str:
    """Return the output that an input reads of a pass where its wire names none."""
    names = output_names(technique)
    return name.rpartition(".")[2] if name.rpartition(".")[2] in names else names[0]


def source_text(giver: PassSpec, output: str, name: str) -> str:
    """Return how a file names an output of a pass, for an input of that name."""
    return giver.name if _usual_output(giver.technique, name) == output else f"{giver.name}:{output}"


def components_of(technique: Technique) -> dict[str, int]:
    """Return how many numbers a texel of each output of a technique has, by its name."""
    outputs = technique.outputs if isinstance(technique, Kernel) else outputs_with_formats(technique)
    return {output.name: output.components for output in outputs}


def passed_on(graph: Graph, name: str, output: str) -> Wire | None:
    """Return the wire that takes the place of a pass's output where the pass is left out.

    It is that of the input of the output's name, else that of the first input whose texels have as
    many numbers; None where there is none.
    """
    spec = graph.find(name)
    if spec is None:
        return None
    mine = [wire for wire in wires_of(graph) if wire.reader == name and wire.giver != name]
    own = components_of(spec.technique)
    output = output if output in own else next(iter(own))
    fitting = [wire for wire in mine if _numbers(graph, wire) == own[output]]
    return next((wire for wire in fitting if wire.input == output), next(iter(fitting), None))


def without_muted(sketch: Sketch, names: Iterable[str]) -> Sketch:
    """Return the sketch with passes muted: those that read one read what it is made of instead."""
    graph = sketch.graph
    for name in names:
        graph = _muted(graph, name)
    return sketch if graph is sketch.graph else replace(sketch, graph=graph)


@GRAPHS.cached(identities=1)
def _muted(graph: Graph, name: str) -> Graph:
    changed: dict[tuple[str, str], str] = {}
    for wire in wires_of(graph):
        instead = passed_on(graph, name, wire.output) if wire.giver == name else None
        if instead is not None:
            changed[wire.reader, wire.input] = instead.source
    return as_wired(replace(graph, passes=_rewired(graph.passes, changed))) if changed else graph


# ── edits ─────────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class PassEdit:
    """One edit of a sketch's passes: the passes after it, and what it does to the sketch's text."""

    passes: tuple[PassSpec, ...]
    change: Callable[[str], str]
    name: str = ""  # of the pass that is new


def added(
    sketch: Sketch,
    use: str,
    after: str = "",
    output: str = "",
    *,
    between: bool = True,
    on: tuple[str, str] | None = None,
) -> PassEdit:
    """Return the edit that adds a pass behind another, wired to it; before the view without one.

    ``output``: of the pass before, which the new one reads; the one that suits it best where none is
    named. ``between``: those that read an output of a name that the new pass has as well read that of
    the new pass. ``on``: the wire to an input, reader and name, that the new pass goes on; no other changes.
    Raises ``SketchError`` for a technique that is wrong or cannot be wired, and where there is no such pass.
    """
    folder, passes = Path(sketch.folder), sketch.graph.passes
    technique = Techniques().read(use, folder, folder)
    name = _free_name(use, passes)
    wire = _wire(sketch, *on) if on is not None else None
    after = wire.giver if wire is not None else "" if after == "view" else after  # nothing is behind the view
    output = wire.output if wire is not None else output
    giver = _pass(sketch, after) if after else None
    at = _place(passes, after) + 1 if after else len(passes) - 1
    spec = PassSpec(name, use, technique, file=shown(sketch.file))
    changed: dict[tuple[str, str], str] = {}
    if giver is not None:
        spec = replace(spec, inputs=_first_wires(spec, giver, output, passes[:at]))
        outputs = output_names(technique)
        if wire is not None:
            if not spec.inputs:
                raise SketchError(_takes_none(name), file=shown(sketch.file))
            changed[wire.reader, wire.input] = _given_to(sketch, spec, wire)
        for other in wires_of(sketch.graph) if between and spec.inputs and wire is None else ():
            if other.giver == after and other.output in outputs:
                changed[other.reader, other.input] = source_text(spec, other.output, other.input)
    structure = (*passes[:at], spec, *passes[at:])
    lines = ["[[pass]]", f"name = {text_of(name)}", f"use  = {text_of(use)}"]
    if spec.inputs:
        pairs = ", ".join(f"{key_text(key)} = {text_of(source)}" for key, source in spec.inputs)
        lines = [
            lines[0],
            *(line.replace("  = ", "    = ").replace("name =", "name   =") for line in lines[1:]),
        ]
        lines.append(f"inputs = {{ {pairs} }}")
    return _edit(sketch, structure, changed, lambda text: _inserted(text, at, lines), name)


def _first_wires(
    spec: PassSpec, giver: PassSpec, output: str, earlier: Sequence[PassSpec]
) -> tuple[tuple[str, str], ...]:
    """Return how a new pass is wired to the one before it."""
    names, outputs = input_names(spec.technique), output_names(giver.technique)
    preferred = (output,) if output else outputs
    pairs = [(name, name) for name in names if name in preferred]
    if not pairs and names:
        needed = [n for n in names if not is_optional(spec.technique, n)]
        pairs = [((needed or list(names))[0], preferred[0])]
    pairs = pairs[:1] if output else pairs
    wired = {name for name, _ in pairs}
    for name in names:
        lacks = not is_optional(spec.technique, name) and not found_source(spec.technique, name, earlier)
        if name not in wired and lacks:
            pairs.append((name, preferred[0]))
    return tuple((name, source_text(giver, text, name)) for name, text in pairs)


def wired(sketch: Sketch, giver: str, output: str, reader: str, name: str) -> PassEdit:
    """Return the edit that feeds an input of a pass from an output of another.

    Raises ``SketchError`` where that closes a circle, and where there is no such pass, output or input.
    """
    source, spec = _pass(sketch, giver), _pass(sketch, reader)
    if output not in output_names(source.technique):
        hint = nearest(output, output_names(source.technique))
        raise SketchError(f"pass '{giver}' has no output '{output}'{hint}")
    if not takes_input(spec.technique, name):
        hint = nearest(name, input_names(spec.technique))
        raise SketchError(f"pass '{reader}' has no input '{name}'{hint}")
    if closes_circle(sketch.graph, giver, reader):
        message = f"'{giver}' is made from '{reader}' already: passes that read each other would never end"
        raise SketchError(message, file=shown(sketch.file))
    return _edit(sketch, sketch.graph.passes, {(reader, name): source_text(source, output, name)})


def put_on_wire(sketch: Sketch, name: str, reader: str, input_name: str) -> PassEdit:
    """Return the edit that puts a pass on the wire to an input: between what feeds it and its reader.

    Those that read it where it was read what it was made of, as where it is deleted. It stays in its place
    in the file.
    Raises ``SketchError`` where no input of it fits what the wire carries, no output its reader, where that
    closes a circle, and where there is no such wire.
    """
    spec, wire, graph = _pass(sketch, name), _wire(sketch, reader, input_name), sketch.graph
    if name in (wire.giver, reader):
        raise SketchError(f"the wire is one of '{name}' itself", file=shown(sketch.file))
    into, out = _fitting_input(graph, spec, wire), _given_to(sketch, spec, wire)
    changed: dict[tuple[str, str], str] = {}
    for other in wires_of(graph):
        instead = passed_on(graph, name, other.output) if other.giver == name else None
        if instead is not None:
            changed[other.reader, other.input] = instead.source
    giver = _pass(sketch, wire.giver)
    changed[name, into] = source_text(giver, wire.output, into) if wire.output else wire.source
    changed[reader, input_name] = out
    after = replace(graph, passes=_rewired(graph.passes, changed))
    for other in wires_of(after):
        if other.reader == name and other.giver != name and closes_circle(after, other.giver, name):
            message = (
                f"'{other.giver}' is made from '{name}' then: passes that read each other would never end"
            )
            raise SketchError(message, file=shown(sketch.file))
    return _edit(sketch, graph.passes, changed)


def _wire(sketch: Sketch, reader: str, name: str) -> Wire:
    found = next((w for w in wires_of(sketch.graph) if (w.reader, w.input) == (reader, name)), None)
    if found is None:
        raise SketchError(f"nothing feeds '{name}' of pass '{reader}'", file=shown(sketch.file))
    return found


def _takes_none(name: str) -> str:
    return f"'{name}' takes no input, so it cannot be on a wire"


def _numbers(graph: Graph, wire: Wire) -> int:
    """Return how many numbers a texel has of what a wire carries; 0 where that is not known."""
    giver = graph.find(wire.giver)
    return components_of(giver.technique).get(wire.output, 0) if giver is not None else 0


def _fitting_input(graph: Graph, spec: PassSpec, wire: Wire) -> str:
    """Return the input of a pass that takes what a wire carries; raise ``SketchError`` where none does.

    It is that of the output's name, else the first whose texels have as many numbers, else one that is free.
    """
    names, numbers = input_names(spec.technique), _numbers(graph, wire)
    if not names:
        raise SketchError(_takes_none(spec.name))
    fed = {mine.input: _numbers(graph, mine) for mine in wires_of(graph) if mine.reader == spec.name}
    like = [name for name in names if name in fed and 0 in (numbers, fed[name], numbers - fed[name])]
    carried = wire.output or wire.input
    found = [carried] * (carried in names) + like + [name for name in names if name not in fed]
    if not found:
        raise SketchError(f"no input of '{spec.name}' takes '{carried}'")
    return found[0]


def output_for(outputs: Mapping[str, int], carried: str, numbers: int) -> str:
    """Return the output that takes the place of what a wire carries; "" where there is none.

    ``outputs``: how many numbers a texel of each has. It is that of its name, else the first that has as
    many; 0 where that is not known.
    """
    like = (name for name, count in outputs.items() if 0 in (numbers, numbers - count))
    return carried if carried in outputs else next(like, "")


def carried_by(graph: Graph, wire: Wire) -> tuple[str, int]:
    """Return the name of what a wire carries, and how many numbers a texel of it has; 0: not known."""
    return wire.output or wire.input, _numbers(graph, wire)


def _given_to(sketch: Sketch, spec: PassSpec, wire: Wire) -> str:
    """Return what the reader of a wire reads once a pass is on it, as a file names it."""
    carried, numbers = carried_by(sketch.graph, wire)
    output = output_for(components_of(spec.technique), carried, numbers)
    if not output or spec.name == "view":
        raise SketchError(f"'{spec.name}' gives nothing that '{wire.reader}' reads in place of '{carried}'")
    return source_text(spec, output, wire.input)


def closes_circle(graph: Graph, giver: str, reader: str) -> bool:
    """Return whether a wire from one pass to another would close a circle."""
    edges = {(wire.giver, wire.reader) for wire in wires_of(graph)}
    reached, new = set[str](), {reader}
    while new:
        reached |= new
        new = {b for a, b in edges if a in new} - reached
    return giver in reached


def unwired(sketch: Sketch, reader: str, name: str) -> PassEdit:
    """Return the edit that takes away the wire to an input.

    Raises ``SketchError`` where none is written, or the pass cannot do without.
    """
    spec = _pass(sketch, reader)
    if name not in dict(spec.inputs):
        raise SketchError(f"'{reader}' finds its '{name}' by that name; wire another output to it instead")
    return _edit(sketch, _rewired(sketch.graph.passes, {(reader, name): ""}), {}, held=False)


def deleted(sketch: Sketch, name: str) -> PassEdit:
    """Return the edit that deletes a pass; those that read it read what it was made of instead.

    What presets, shots, keyframes and the list of main parameters set of it goes as well.
    Raises ``SketchError`` for the view, and where a pass needs what only this one gives.
    """
    spec = _pass(sketch, name)
    if name == "view":
        raise SketchError("the view stays: it makes the picture", file=shown(sketch.file))
    if len(sketch.graph.passes) == 2:
        raise SketchError(f"'{name}' stays: a sketch needs a pass", file=shown(sketch.file))
    changed: dict[tuple[str, str], str] = {}
    first = next((w for w in wires_of(sketch.graph) if w.reader == name and w.giver != name), None)
    for wire in wires_of(sketch.graph):
        if wire.giver == name and wire.reader != name:
            instead = passed_on(sketch.graph, name, wire.output) or first
            changed[wire.reader, wire.input] = instead.source if instead is not None else ""
    at = _place(sketch.graph.passes, name)
    passes = tuple(other for other in sketch.graph.passes if other is not spec)

    def change(text: str) -> str:
        return _without_values(_cut(text, at), f"{name}.")

    return _edit(sketch, passes, changed, change)


def duplicated(sketch: Sketch, name: str) -> PassEdit:
    """Return the edit that writes a pass a second time behind itself; nothing reads it yet."""
    spec = _pass(sketch, name)
    if name == "view":
        raise SketchError("there is one view", file=shown(sketch.file))
    passes, at = sketch.graph.passes, _place(sketch.graph.passes, name)
    new = _free_name(name, passes)
    copied: dict[tuple[str, str], str] = {
        (new, wire.input): wire.source for wire in wires_of(sketch.graph) if wire.reader == name
    }
    structure = (*passes[: at + 1], replace(spec, name=new), *passes[at + 1 :])

    def change(text: str) -> str:
        start, end = _pass_blocks(text)[at]
        lines = text[start:end].splitlines()
        while lines and lines[0].lstrip().startswith("#"):  # said of the other
            del lines[0]
        return put(_inserted(text, at + 1, lines), ("pass", at + 1), "name", text_of(new))

    return _edit(sketch, structure, copied, change, new)


def moved(sketch: Sketch, name: str, by: int) -> PassEdit:
    """Return the edit that writes a pass one place earlier (-1) or later (1); the wires stay.

    Raises ``SketchError`` where there is no such place.
    """
    _pass(sketch, name)
    passes, at = list(sketch.graph.passes), _place(sketch.graph.passes, name)
    if name == "view" or not 0 <= at + by < len(passes) - 1:
        last = "last, before the view" if by > 0 else "first"
        raise SketchError(f"'{name}' is the {last}" if name != "view" else "the view comes last")
    passes[at], passes[at + by] = passes[at + by], passes[at]
    low = min(at, at + by)

    def change(text: str) -> str:
        (a, b), (c, d) = _pass_blocks(text)[low : low + 2]
        newline = newline_of(text)
        second = text[c:d] if text[c:d].endswith("\n") else text[c:d] + newline
        return text[:a] + second + text[b:c] + text[a:b] + text[d:]

    return _edit(sketch, tuple(passes), {}, change)


def save_passes(file: Sketch, edit: PassEdit) -> None:
    """Write an edit into the file that ``file`` was loaded from.

    Raises as ``save`` does, and what is wrong with the text that the edit would leave.
    """

    def change(text: str) -> str:
        new = edit.change(text)
        load_with(Techniques(), Path(file.file), normalised(new))
        return new

    names = [spec.name for spec in edit.passes]

    def is_right(reloaded: Sketch) -> bool:
        if [spec.name for spec in reloaded.graph.passes] != names:
            return False
        expected = replace(file, graph=replace(file.graph, passes=edit.passes)).graph
        return _joined(reloaded.graph) == _joined(expected)

    write_over(Path(file.file), file, change, is_right)


def _joined(graph: Graph) -> set[tuple[str, str, str, str]]:
    return {(w.giver, w.output, w.reader, w.input) for w in wires_of(graph)}


def _edit(
    sketch: Sketch,
    passes: tuple[PassSpec, ...],
    changed: Inputs,
    change: Callable[[str], str] = lambda text: text,
    name: str = "",
    *,
    held: bool = True,
) -> PassEdit:
    """Return an edit: passes in their order, and what feeds their inputs where that is another than before.

    ``change`` makes the same of the text, without the wires. Unless ``held``, what is no longer wired may
    be found by its name. Raises ``SketchError`` where the passes cannot be wired so.
    """
    wanted = dict(changed)
    there = {spec.name for spec in passes}
    for wire in wires_of(sketch.graph) if held else ():
        if wire.giver in there and wire.reader in there:
            wanted.setdefault((wire.reader, wire.input), wire.source)
    now = {(w.reader, w.input): w.source for w in wires_of(replace(sketch.graph, passes=passes))}
    made = _rewired(passes, {key: source for key, source in wanted.items() if now.get(key, "") != source})
    flatten(replace(sketch, graph=replace(sketch.graph, passes=made), main=(), overrides=()))
    had_view = sketch.graph.passes[-2].name == passes[-2].name if len(passes) > 1 else True
    before = {spec.name: dict(spec.inputs) for spec in sketch.graph.passes}
    before |= {name: dict(passes[_place(passes, name)].inputs)} if name else {}

    def whole(text: str) -> str:
        after = replace(sketch, graph=replace(sketch.graph, passes=made))
        text = change(text)
        for spec in made:
            inputs, old = dict(spec.inputs), before[spec.name]
            if inputs == old and (spec.name != "view" or had_view):
                continue
            if spec.name == "view" and "view" not in tomllib.loads(normalised(text)):
                text = with_view(text, after, "view")
                continue
            table: KeyPath = (*table_of(after, spec.name), "inputs")
            for key in old.keys() - inputs.keys():
                text = drop(text, table, key)
            for key, source in inputs.items():
                if old.get(key) != source:
                    text = put(text, table, key, text_of(source))
        return text

    return PassEdit(made, whole, name)


def _rewired(passes: Sequence[PassSpec], changed: Inputs) -> tuple[PassSpec, ...]:
    """Return passes with inputs fed from elsewhere; "" takes a wire away."""
    result = []
    for spec in passes:
        mine = {key: source for (reader, key), source in changed.items() if reader == spec.name}
        inputs = tuple((key, source) for key, source in (dict(spec.inputs) | mine).items() if source)
        result.append(replace(spec, inputs=inputs) if mine else spec)
    return tuple(result)


def _pass(sketch: Sketch, name: str) -> PassSpec:
    spec = sketch.graph.find(name)
    if spec is None:
        hint = nearest(name, [p.name for p in sketch.graph.passes])
        raise SketchError(f"no pass '{name}' in the file of sketch {sketch.name}{hint}")
    return spec


def _place(passes: Sequence[PassSpec], name: str) -> int:
    return next(number for number, spec in enumerate(passes) if spec.name == name)


def _free_name(text: str, passes: Sequence[PassSpec]) -> str:
    """Return a name for a new pass, after a technique or another pass."""
    base = re.sub(r"\W", "_", text.rpartition("/")[2])
    base = base if base.isidentifier() else f"pass_{base}"
    base = re.sub(r"_\d+$", "", base) if any(spec.name == base for spec in passes) else base
    taken = {"view", *(spec.name for spec in passes)}
    return next(n for n in (base, *(f"{base}_{k}" for k in range(2, 10_000))) if n not in taken)


# ── the text ──────────────────────────────────────────────────────────────────


def _pass_blocks(text: str) -> list[tuple[int, int]]:
    """Return where each pass's block is; raise ``SketchError`` where they are no blocks."""
    spans = blocks(text, "pass")
    if len(spans) != len(tomllib.loads(normalised(text)).get("pass", [])):
        raise SketchError("its passes are written as one list; write each as a [[pass]] to change them here")
    return spans


def _inserted(text: str, at: int, lines: Sequence[str]) -> str:
    """Return the text with a block more among those of the passes, after an empty line."""
    newline, spans = newline_of(text), _pass_blocks(text)
    block = "".join(line + newline for line in lines)
    if not spans:
        head = text if text.endswith("\n") else text + newline
        return head + newline + block
    position = spans[at - 1][1] if at else spans[0][0]
    head = text[:position]
    if at == 0:
        return head + block + newline + text[position:]
    return (head if head.endswith("\n") else head + newline) + newline + block + text[position:]


def _cut(text: str, at: int) -> str:
    """Return the text without a pass's block, and without two empty lines where it was."""
    start, end = _pass_blocks(text)[at]
    newline = newline_of(text)
    head, rest = text[:start], text[end:]
    if rest.startswith(newline) and (head.endswith(newline * 2) or not head):
        rest = rest[len(newline) :]
    elif not rest.strip() and head.endswith(newline * 2):
        head = head[: -len(newline)]
    return head + rest


def _without_values(text: str, prefix: str) -> str:
    """Return the text without what presets, shots, keyframes and ``main`` say of the parameters of a pass."""
    for kind in ("preset", "shot", "keyframe"):
        for index, table in enumerate(tomllib.loads(normalised(text)).get(kind, [])):
            for part in ("set", "steps"):
                for path in _paths(table.get(part, {})):
                    if path.startswith(prefix) or f"{path}." == prefix:
                        text = drop(text, (kind, index, part), path)
    main = tomllib.loads(normalised(text)).get("main", [])
    left = [path for path in main if not path.startswith(prefix)]
    return put(text, (), "main", f"[{', '.join(map(text_of, left))}]") if left != main else text


def _paths(table: Mapping[str, object], prefix: str = "") -> list[str]:
    """Return the dotted keys of a table, those of tables inside too."""
    found: list[str] = []
    for key, value in table.items():
        inside = _paths(value, f"{prefix}{key}.") if isinstance(value, Mapping) else []
        found += [f"{prefix}{key}", *inside]
    return found
