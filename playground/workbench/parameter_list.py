"""What the panel lists: a sketch's parameters by pass and group, their values, and which are changed.

What a sketch's techniques say is read once for each graph, the values once for each
draft: a panel is drawn many times a second.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import groupby

from playground.sketch.assign import Shown, resolve, shown_parameters, values_of
from playground.sketch.model import Graph, Parameter, Sketch, Value
from playground.sketch.values import write
from playground.workbench.edits import Draft


@dataclass(frozen=True)
class Item:
    """A parameter in the panel."""

    path: str  # as ``--set`` takes it
    parameter: Parameter
    leaf: str  # the first parameter inside that it represents
    exported: bool  # by its pass's technique, or the pass is a single kernel
    words: str  # in lower case: what a search looks in
    label: str  # imgui's, unique in the panel
    title: str  # its label


@dataclass(frozen=True)
class Group:
    """Parameters under one heading; "" for those that stand under none."""

    name: str
    items: tuple[Item, ...]


@dataclass(frozen=True)
class Section:
    """A pass: what its technique shows, and what is inside of that, pass by inner pass."""

    name: str
    groups: tuple[Group, ...]
    inner: tuple[tuple[str, tuple[Group, ...]], ...]  # heading → groups

    @cached_property
    def items(self) -> tuple[Item, ...]:
        """Every parameter, those inside last."""
        inside = (group for _, groups in self.inner for group in groups)
        return tuple(item for group in (*self.groups, *inside) for item in group.items)


@dataclass(frozen=True)
class Filter:
    """Which parameters are shown."""

    search: str = ""  # every word of it must be found in label, name, pass, group or description
    changed: bool = False  # only those that differ from the file

    @cached_property
    def words(self) -> list[str]:
        """What is searched for."""
        return self.search.lower().split()

    def __bool__(self) -> bool:
        return self.changed or bool(self.words)


@dataclass(frozen=True)
class Values:
    """The values of one draft, by path."""

    of: dict[str, Value]
    in_file: dict[str, Value]
    changed: frozenset[str]
    locked: frozenset[str]


@dataclass
class Listing:
    """The sections of the sketch of the moment, and its values; each worked out when it is needed."""

    _graph: Graph | None = None
    _sections: tuple[Section, ...] = ()
    _main: tuple[tuple[str, ...], tuple[Item, ...]] = ((), ())  # paths, and what they stand for
    _draft: Draft | None = None
    _base: Sketch | None = None
    _in_file: dict[str, Value] = field(default_factory=dict)
    _values: Values = field(default_factory=lambda: Values({}, {}, frozenset(), frozenset()))
    _found: tuple[object, dict[str, Section]] = (None, {})

    def sections(self, draft: Draft) -> tuple[Section, ...]:
        """Return the passes of a draft, in their order."""
        if self._graph is not draft.base.graph:
            self._graph, self._sections = draft.base.graph, tuple(_sections(draft.base))
            self._main = (), ()
        return self._sections

    def main(self, draft: Draft) -> tuple[Item, ...]:
        """Return the parameters that a draft's sketch is about, in its order: see ``Sketch.main``."""
        sections = self.sections(draft)
        if self._main[0] != draft.base.main:
            self._main = draft.base.main, tuple(_main(draft.base, sections))
        return self._main[1]

    def values(self, draft: Draft) -> Values:
        """Return what its parameters are set to."""
        if self._draft is not draft:
            items = [item for section in self.sections(draft) for item in section.items]
            if self._base is not draft.base:
                file = values_of(draft.base)
                self._base, self._in_file = draft.base, {item.path: file[item.leaf] for item in items}
            now, in_file = values_of(draft.sketch), self._in_file
            of = {item.path: now[item.leaf] for item in items}
            changed = frozenset(path for path, value in of.items() if value != in_file[path])
            self._values = Values(of, in_file, changed, frozenset(draft.edits.locked))
            self._draft = draft
        return self._values

    def filtered(self, draft: Draft, wanted: Filter) -> dict[str, Section]:
        """Return the passes with what a filter lets through, by name; none that keeps nothing."""
        changed = self.values(draft).changed
        key = (id(self.sections(draft)), wanted, changed)
        if self._found[0] != key:
            left = {s.name: _thinned(s, wanted, changed) for s in self.sections(draft)}
            self._found = key, {name: section for name, section in left.items() if section.items}
        return self._found[1]


def set_words(draft: Draft, values: Values) -> str:
    """Return what differs from the file as words of the command line: ``--set height.seed=3 --set …``."""
    found = []
    for path, value in draft.applied.items():
        targets = resolve(draft.base.graph, path) if path not in values.of and "." in path else ()
        parameter = targets[0].parameter if targets else _parameter(draft.base, path)
        text = write(parameter, value) if parameter is not None else _terrain_text(value)
        found.append(f"--set {_quoted(f'{path}={text}')}")
    return " ".join(found)


def _parameter(sketch: Sketch, path: str) -> Parameter | None:
    return resolve(sketch.graph, path)[0].parameter if "." in path else None


def _terrain_text(value: Value) -> str:
    return "x".join(f"{n:g}" for n in value) if isinstance(value, tuple) else f"{value:g}"


def _quoted(word: str) -> str:
    """Return a word as any shell takes it: in double quotes where it holds more than plain letters."""
    plain = all(c.isalnum() or c in "._,=-+/:" for c in word)
    return word if plain else f'"{word}"'


def _sections(sketch: Sketch) -> Iterator[Section]:
    by_pass = {
        name: list(found)
        for name, found in groupby(shown_parameters(sketch), lambda s: s.path.partition(".")[0])
    }
    for spec in sketch.graph.passes:
        items = [_item(sketch, shown) for shown in by_pass.get(spec.name, [])]
        outer = [item for item in items if item.exported]
        inner = groupby((i for i in items if not i.exported), lambda i: i.path.rpartition(".")[0])
        yield Section(
            spec.name,
            _groups(outer),
            tuple((path.partition(".")[2] or path, _groups(list(found))) for path, found in inner),
        )


def _item(sketch: Sketch, shown: Shown) -> Item:
    p = shown.parameter
    words = " ".join([p.title, shown.path, shown.path.replace("_", " "), p.group, p.tooltip]).lower()
    leaf = resolve(sketch.graph, shown.path)[0].path
    return Item(shown.path, p, leaf, shown.exported, words, f"##{shown.path}", p.title)


def _main(sketch: Sketch, sections: tuple[Section, ...]) -> Iterator[Item]:
    """Yield the main parameters, group or pass named where a title alone would not say what is meant."""
    items = [item for section in sections for item in section.items]
    named = {item.path: item for item in items}
    by_leaf = {item.leaf: item for item in items}  # an inner path may stand in the list of an outer one
    found = [named.get(path) or by_leaf[resolve(sketch.graph, path)[0].path] for path in sketch.main]
    titles = [_with_group(item.parameter) for item in found]
    for item, title in zip(found, titles, strict=True):
        if titles.count(title) > 1:
            title = _under(in_words(item.path.partition(".")[0]), title)
        yield replace(item, label=f"##main {item.path}", title=title)


def _with_group(parameter: Parameter) -> str:
    """Return a title as it reads outside its group: a label of one word, as "From", leans on that."""
    group, title = parameter.group, parameter.title
    leans = parameter.label and group and " " not in group + title and title != group
    return _under(group, title) if leans else title


def _under(heading: str, title: str) -> str:
    return f"{heading}: {title[0].lower()}{title[1:]}"


def in_words(name: str) -> str:
    """Return a pass's name as the panel writes it."""
    return name.replace("_", " ").capitalize()


def _groups(items: list[Item]) -> tuple[Group, ...]:
    names = dict.fromkeys(["", *(item.parameter.group for item in items)])
    found = (Group(name, tuple(i for i in items if i.parameter.group == name)) for name in names)
    return tuple(group for group in found if group.items)


def _thinned(section: Section, wanted: Filter, changed: frozenset[str]) -> Section:
    def passes(item: Item) -> bool:
        if wanted.changed and item.path not in changed:
            return False
        return all(word in item.words for word in wanted.words)

    def thinned(groups: tuple[Group, ...]) -> tuple[Group, ...]:
        found = (Group(g.name, tuple(filter(passes, g.items))) for g in groups)
        return tuple(group for group in found if group.items)

    inner = tuple((name, found) for name, groups in section.inner if (found := thinned(groups)))
    return Section(section.name, thinned(section.groups), inner)
