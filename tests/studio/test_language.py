"""The window in French: no word of it is forgotten, and none is left over."""

from __future__ import annotations

import ast
import re
import string
import tomllib
from collections.abc import Callable, Iterable, Iterator

import pytest
from imgui_bundle import imgui

from playground import rooms
from playground.engine.gl_calls import QUERY, WALL
from playground.paths import GLSL
from playground.shader.kernel import kernels_of
from playground.shader.parameter import label_of
from playground.shader.widgets import WIDGETS
from playground.sketch.find import shipped_sketches
from playground.sketch.keyframes import EASES
from playground.sketch.load import load
from playground.sketch.techniques import read_technique, shipped_techniques
from playground.studio import language
from playground.studio.addition import Addition
from playground.studio.compare.compare import Mode
from playground.studio.keys import GESTURES, Key, all_keys
from playground.studio.language import LANGUAGES, choose_language, counted, numeral, shortcut, tr
from playground.studio.paint.brush import TOOLS
from playground.studio.panel.parameter_list import Filter, filtered
from playground.studio.remote.controllers import KINDS
from playground.studio.start.page import TEMPLATES
from playground.studio.theme import PANEL_WIDTH
from playground.studio.trace.tracing import Beside

from ..sketch_texts import map_of, passes
from . import words
from .panel_desk import Bare

WORDS: dict[str, dict[str, str]] = {
    path.parent.name: tomllib.loads(path.read_text("utf-8")) for path in words.ROOT.glob("*/french.toml")
}
"""The lines of each room that shows words; those of the studio are the window's, and may be any room's."""
FRENCH = {english: french for lines in WORDS.values() for english, french in lines.items()}
PARAMETER = ast.parse((words.ROOT / "shader" / "parameter.py").read_text("utf-8"))
"""It says what a parameter takes, in the window's words."""


def of_keys(keys: Iterable[Key]) -> set[str]:
    return {word for k in keys for word in (*words.KEY.findall(k.name), k.meaning, k.brief)}


def tables() -> dict[str, set[str]]:
    """Return the words that stand in tables, and are translated where they are shown, by room."""
    found: dict[str, set[str]] = {}
    others: set[Key] = set()
    for module in rooms.modules("addition"):
        kinds = (kind for kind in vars(module).values() if isinstance(kind, type))
        added = [kind for kind in kinds if issubclass(kind, Addition)]
        buttons = {word for kind in added for word in (kind.button, kind.button_note)}
        found[module.__name__.split(".")[1]] = (buttons | of_keys(module.KEYS)) - {""}
        others |= {*module.KEYS}
    own = of_keys({*all_keys()} - others) | {word for gesture in GESTURES for word in gesture}
    own |= {*TOOLS, *KINDS, WALL, QUERY, *(mode.value for mode in (*Mode, *Beside))}
    own |= {word for template in TEMPLATES for word in (template.title, template.note)}
    own |= {facts.expects for facts in WIDGETS.values()}
    own |= {*words.translated(PARAMETER, "say")}
    return {**found, "studio": own - {""}}


@pytest.fixture(autouse=True)
def in_english() -> Iterator[None]:
    yield
    choose_language("en")


def test_each_translated_word_has_a_french_line() -> None:
    said = tables()
    for path, tree in words.trees():
        said.setdefault(words.room_of(path), set()).update(words.translated(tree))
    assert len(said["studio"]) > 600
    lines = {room: WORDS["studio"].keys() | WORDS.get(room, {}).keys() for room in said}
    assert {room: lacking for room in said if (lacking := sorted(said[room] - lines[room]))} == {}


def test_no_french_line_is_left_over_or_is_another_room_s() -> None:
    there = tables()
    there["studio"].update(words.strings(PARAMETER))
    for path, tree in words.trees():
        texts = {*words.strings(tree), *words.translated(tree)}
        there.setdefault(words.room_of(path), set()).update(texts)
    assert {room: over for room in WORDS if (over := sorted(WORDS[room].keys() - there[room]))} == {}
    assert len(FRENCH) == sum(map(len, WORDS.values())), "a line is in two files"


def test_no_word_is_shown_as_it_stands() -> None:
    shown = [(path, each) for path, tree in words.trees() for each in words.shown_as_they_are(tree)]
    places = [f"{path.relative_to(words.ROOT)}:{line}: {text!r}" for path, (line, text) in shown]
    assert sorted(set(places)) == [], "put them into tr(...)"


@pytest.mark.parametrize(
    "line",
    [
        'imgui.button("Go on")',
        'imgui.button("Go on##it")',
        'button(f"Go to {place}", "")',
        'button("A/B", "Compare")',
        'label = "Go" if on else "Stop"; imgui.small_button(label)',
        "imgui.checkbox(LABEL, on)",
        'bench.notices.say(f"saved {path}")',
        'imgui.text_disabled(fitting("of all texels", 3))',
        'with row(tr("Sun"), "Where it is"): pass',
    ],
)
def test_a_forgotten_word_is_found(line: str) -> None:
    tree = ast.parse(f'LABEL = "On and off"\ndef draw():\n    {line}\n')
    assert list(words.shown_as_they_are(tree))


@pytest.mark.parametrize(
    "line",
    [
        'imgui.button(tr("Go on"))',
        """imgui.button(f"{tr('Go on')}##go on")""",
        'imgui.drag_float("##seconds", 1.0, 0.1, 0.0, 1.0, "%.2f s")',
        'imgui.text_unformatted(f"{width} x {height}")',
        'button("PNG", tr("Save it"))',
        'notices.say(tr("saved {file}", file="sketch.toml"))',
    ],
)
def test_what_is_translated_or_no_word_is_let_through(line: str) -> None:
    assert list(words.shown_as_they_are(ast.parse(f"def draw():\n    {line}\n"))) == []


def test_templates_have_the_same_names_in_both() -> None:
    def names(text: str) -> list[str]:
        return sorted({name for _, name, _, _ in string.Formatter().parse(text) if name is not None})

    assert {english for english, french in FRENCH.items() if names(english) != names(french)} == set()


def test_french_lines_are_written_as_french() -> None:
    straight = {english for english, french in FRENCH.items() if "'" in french or "\xa0" in french}
    glued = {english for english, french in FRENCH.items() if re.search(r"\w[;?!»]|«\w|[a-zé]: ", french)}
    thou = {english for english, french in FRENCH.items() if re.search(r"\b(tu|ton|tes|toi)\b", french)}
    sketch = {english for english, french in FRENCH.items() if re.search(r"\bsketch", french, re.I)}
    assert (straight, glued, thou, sketch) == (set(), set(), set(), set())


def test_no_french_line_breaks_before_its_colon() -> None:
    choose_language("fr")
    assert tr("functions: {name}", name="a") == "fonctions\xa0: a"
    assert tr("pass '{path}'", path="a") == "pass 'a'", "which has no line"


def test_numbers_have_their_plural_in_both() -> None:
    assert [counted(n, "parameter") for n in (0, 1, 3)] == ["0 parameters", "1 parameter", "3 parameters"]
    choose_language("fr")
    assert [counted(n, "parameter") for n in (0, 1, 3)] == ["0 paramètre", "1 paramètre", "3 paramètres"]
    assert counted(2, "locked parameter") == "2 paramètres verrouillés"


def test_numbers_have_the_marks_of_the_language() -> None:
    written = [(1234567, ","), (0.25, "g"), (-31.415, ".1f"), (1.25, ".0%")]
    assert [numeral(*each) for each in written] == ["1,234,567", "0.25", "-31.4", "125%"]
    choose_language("fr")
    assert [numeral(*each) for each in written] == ["1\xa0234\xa0567", "0,25", "-31,4", "125\xa0%"]


def test_keys_are_called_as_the_keyboard_calls_them() -> None:
    assert shortcut("Ctrl+Shift+Z, Ctrl+Y") == "Ctrl+Shift+Z, Ctrl+Y"
    choose_language("fr")
    assert shortcut("Ctrl+Shift+Z, Ctrl+Y") == "Ctrl+Maj+Z, Ctrl+Y"
    assert shortcut("Space") == "Espace" and shortcut("/") == "/"


def test_an_unknown_language_is_english() -> None:
    assert choose_language("xx") == "en" and language.language() == "en"


FILES = {
    "sketch.toml": """format = 1
title = "Diamond-square"
size = 17
main = ["height.octaves"]
"""
    + passes(height=("./height", "set = { left = 1 }"))
    + map_of("height")
    + """[[preset]]
name = "one with a long name of its own"
set = { "height.octaves" = 3 }
""",
    "height.glsl": """// height.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform int octaves = 5; //! slider(1, 9) group("Detail") How many
uniform int left = 0; //! menu("smooth", "ridged") What they are like
float kernel(ivec2 texel) { return float(octaves + left) / 10.0; }
""",
}


def labels_drawn(bare: Bare) -> set[str]:
    bare.places.clear()
    bare.run_frames()
    return {label.partition("##")[0] for label in bare.places}


def test_a_language_takes_effect_at_once(bare: Bare) -> None:
    assert {"Undo", "Save", "Main parameters"} <= labels_drawn(bare)
    choose_language("fr")
    assert {"Annuler", "Enregistrer", "Paramètres principaux"} <= labels_drawn(bare)
    assert not {"Undo", "Save", "Main parameters"} & labels_drawn(bare)
    choose_language("en")
    assert "Undo" in labels_drawn(bare)


@pytest.mark.parametrize("code", LANGUAGES)
@pytest.mark.parametrize("wide", [240.0, PANEL_WIDTH])
def test_no_button_of_the_panel_is_cut_off(bare: Bare, code: str, wide: float) -> None:
    choose_language(code)
    bare.bench.panes.remember("panel width", wide)
    sizes: dict[str, float] = {}

    def measure(draw: Callable[[], object]) -> None:
        draw()
        sizes.update((label, imgui.calc_text_size(label, True).x) for label in bare.places)

    bare.run_frames(2)
    bare.places.clear()
    bare.run_frames(1, measure)
    drawn = {label: place for label, place in bare.places.items() if place[0] < wide}
    assert tr("Random") in drawn and tr("Trace") in drawn
    assert {label for label, (x, _, width, _) in drawn.items() if x + width > wide} == set()
    buttons = [tr(label) for label in ("Undo", "History", "Save", "Graph", "Trace")]
    assert all(sizes[label] <= drawn[label][2] for label in buttons)


def test_a_parameter_is_found_by_its_label_in_both(bare: Bare) -> None:
    draft = bare.session.shown
    assert draft is not None
    for search in ("octaves", "gauche", "left", "détail", "hauteur", "height"):
        found = {item.path for section in filtered(draft, Filter(search)).values() for item in section.items}
        assert found, search
    assert {i.path for s in filtered(draft, Filter("gauche")).values() for i in s.items} == {"height.left"}
    assert not filtered(draft, Filter("droite"))


def shipped_words() -> dict[str, set[str]]:
    """Return what is shipped in words, by what they are: labels of parameters, titles of techniques, …"""
    sketches = [load(name) for name in shipped_sketches()]
    techniques = [read_technique(use, GLSL, GLSL) for use in shipped_techniques()]
    used = [spec.technique for sketch in sketches for spec in sketch.graph.passes]
    parameters = {
        p for each in (*techniques, *used) for _, kernel in kernels_of(each) for p in kernel.parameters
    }
    return {
        "parameters": {p.title for p in parameters},
        "groups": {p.group for p in parameters},
        "choices": {choice for p in parameters for choice in p.widget.choices},
        "parts": {part for p in parameters for part in p.parts},
        "eases": set(EASES),
        "passes": {label_of(spec.name) for sketch in sketches for spec in sketch.graph.passes},
        "sketches": {sketch.title for sketch in sketches},
        "techniques": {technique.title for technique in techniques},
        "units": {
            unit
            for p in parameters
            if re.search(r"[a-z]{3}|yr|\bd\b", unit := p.unit or p.widget.facts.unit) and unit != "degrees"
        },
        "brush": {"Radius", "Strength", "Softness"},
    }


def test_all_that_is_shipped_has_a_french_label() -> None:
    shipped = {kind: found - {""} for kind, found in shipped_words().items()}
    french = tomllib.loads((words.ROOT / "studio" / "french_labels.toml").read_text("utf-8"))
    lacking = {kind: sorted(found - french.keys()) for kind, found in shipped.items()}
    shares = {kind: f"{len(found) - len(lacking[kind])} of {len(found)}" for kind, found in shipped.items()}
    assert not any(lacking.values()), (shares, lacking)
    assert sorted(french.keys() - set().union(*shipped.values())) == [], "of nothing that is shipped"
    assert not [label for label, text in french.items() if "'" in text or not text.strip()]
