"""What the panel lists: a sketch's parameters by pass and group, their values, and which are changed.

What a sketch's techniques say is read once for each sketch, the values once for each
draft: a panel is drawn many times a second.
Also what the panel remembers between two frames.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import groupby

from playground.memo import INTERFACE
from playground.shader.parameter import label_of, write
from playground.sketch.assign import Shown, resolve, shown_parameters, values_of
from playground.sketch.model import Parameter, Sketch, Value
from playground.studio.edits.edits import Draft
from playground.studio.language import labels_of, language, tr, tr_label


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
    """Parameters under one heading; "" for those that have none."""

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


def filtered(draft: Draft, filter_: Filter) -> dict[str, Section]:
    """Return the passes with what a filter lets through, by name; none that keeps nothing."""
    return _filtered(draft.base, filter_, shown_values(draft).changed)


def items_of(draft: Draft | None) -> Mapping[str, Item]:
    """Return every parameter of a draft by its path, in the panel's order; none of no draft."""
    return _items(draft.base) if draft is not None else {}


@INTERFACE.cached(identities=1, weight=128)
def _items(sketch: Sketch) -> dict[str, Item]:
    return {item.path: item for section in sections_of(sketch) for item in section.items}


@INTERFACE.cached(identities=1, weight=128)
def shown_values(draft: Draft) -> Values:
    """Return what the parameters of a draft are set to."""
    now, in_file = values_of(draft.sketch), _values_in_file(draft.base)
    of = {path: now[item.leaf] for path, item in _items(draft.base).items()}
    changed = frozenset(path for path, value in of.items() if value != in_file[path])
    return Values(of, in_file, changed, frozenset(draft.edits.locked))


@INTERFACE.cached(identities=1, weight=128)
def _values_in_file(sketch: Sketch) -> dict[str, Value]:
    file = values_of(sketch)
    return {path: file[item.leaf] for path, item in _items(sketch).items()}


@INTERFACE.cached(identities=1, weight=128)
def _filtered(sketch: Sketch, filter_: Filter, changed: frozenset[str]) -> dict[str, Section]:
    left = {section.name: _thinned(section, filter_, changed) for section in sections_of(sketch)}
    return {name: section for name, section in left.items() if section.items}


def set_words(draft: Draft) -> str:
    """Return what differs from the file as words of the command line: ``--set height.seed=3 --set …``."""
    words = []
    for path, value in draft.applied.items():
        parameter = resolve(draft.base.graph, path)[0].parameter if "." in path else None
        text = write(parameter, value) if parameter is not None else _terrain_text(value)
        words.append(f"--set {_quoted(f'{path}={text}')}")
    return " ".join(words)


def _terrain_text(value: Value) -> str:
    return "x".join(f"{n:g}" for n in value) if isinstance(value, tuple) else f"{value:g}"


def _quoted(word: str) -> str:
    """Return a word as any shell takes it: in double quotes where it holds more than plain letters."""
    plain = all(c.isalnum() or c in "._,=-+/:" for c in word)
    return word if plain else f'"{word}"'


@INTERFACE.cached(identities=1, weight=128)
def sections_of(sketch: Sketch) -> tuple[Section, ...]:
    """Return the passes of a sketch, in their order."""
    sections = []
    by_pass = {
        name: list(mine)
        for name, mine in groupby(shown_parameters(sketch), lambda s: s.path.partition(".")[0])
    }
    for spec in sketch.graph.passes:
        items = [_item(sketch, shown) for shown in by_pass.get(spec.name, [])]
        outer = [item for item in items if item.exported]
        inner = groupby((i for i in items if not i.exported), lambda i: i.path.rpartition(".")[0])
        inside = tuple((path.partition(".")[2] or path, _groups(list(mine))) for path, mine in inner)
        sections.append(Section(spec.name, _groups(outer), inside))
    return tuple(sections)


def _item(sketch: Sketch, shown: Shown) -> Item:
    p = shown.parameter
    names = p.title, p.group, label_of(shown.path.partition(".")[0])
    labels = [label for name in names for label in labels_of(name)]
    words = " ".join([*labels, shown.path, shown.path.replace("_", " "), p.tooltip]).lower()
    leaf = resolve(sketch.graph, shown.path)[0].path
    return Item(shown.path, p, leaf, shown.exported, words, f"##{shown.path}", p.title)


def main_items(sketch: Sketch) -> tuple[Item, ...]:
    """Return the parameters that a sketch is about, in its order: see ``Sketch.main``.

    Group or pass are named where a title alone would not say what is meant.
    """
    return _main_items(sketch, language())


@INTERFACE.cached(identities=1, weight=128)
def _main_items(sketch: Sketch, _: str) -> tuple[Item, ...]:
    made = []
    named = _items(sketch)
    by_leaf = {item.leaf: item for item in named.values()}  # an inner path may be in the list of an outer one
    result = [named.get(path) or by_leaf[resolve(sketch.graph, path)[0].path] for path in sketch.main]
    titles = [_with_group(item.parameter) for item in result]
    for item, title in zip(result, titles, strict=True):
        if titles.count(title) > 1:
            title = _under(tr_label(label_of(item.path.partition(".")[0])), title)
        made.append(replace(item, label=f"##main {item.path}", title=title))
    return tuple(made)


def _with_group(parameter: Parameter) -> str:
    """Return a title as it reads outside its group: a label of one word, as "From", leans on that."""
    group, title = tr_label(parameter.group), tr_label(parameter.title)
    leans = parameter.label and group and " " not in group + title and title != group
    return _under(group, title) if leans else title


def _under(heading: str, title: str) -> str:
    return tr("{heading}: {title}", heading=heading, title=f"{title[0].lower()}{title[1:]}")


def _groups(items: list[Item]) -> tuple[Group, ...]:
    names = dict.fromkeys(["", *(item.parameter.group for item in items)])
    groups = (Group(name, tuple(i for i in items if i.parameter.group == name)) for name in names)
    return tuple(group for group in groups if group.items)


def _thinned(section: Section, filter_: Filter, changed: frozenset[str]) -> Section:
    def passes(item: Item) -> bool:
        if filter_.changed and item.path not in changed:
            return False
        return all(word in item.words for word in filter_.words)

    def thinned(groups: tuple[Group, ...]) -> tuple[Group, ...]:
        groups_left = (Group(g.name, tuple(filter(passes, g.items))) for g in groups)
        return tuple(group for group in groups_left if group.items)

    inner = tuple((name, groups_left) for name, groups in section.inner if (groups_left := thinned(groups)))
    return Section(section.name, thinned(section.groups), inner)


@dataclass
class PanelState:
    """The state of one panel between frames."""

    filter: Filter = field(default_factory=Filter)
    focus_search: bool = False  # the search gets the keys in the next frame
    entry: str = ""  # the label of the parameter whose value is typed
    entry_text: str = ""
    entry_opens: bool = False  # its field is to get the keys
    clicked: tuple[str, bool, Value] = ("", False, 0)  # last clicked on: path, edited, value before
    menu: str = ""  # the label of the parameter whose menu is open
    menu_opens: bool = False
    heights: dict[tuple[str, float], float] = field(default_factory=dict)  # of each row, by path and scale
    seed: int = 1  # of the next random values
    strength: float = 0.1  # of a mutation
    everything: bool = False  # random values are for every parameter, not the shape's alone
    preset: str = ""  # the one last chosen
    preset_name: str = ""  # of one to be saved
    unfolded: str = ""  # the file whose words on itself are shown whole
