"""How the window looks: contrast of both palettes, places of its panes, what is remembered."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path

import pytest
from imgui_bundle import imgui

from playground.errors import Diagnostic
from playground.shader.colours import srgb_to_linear
from playground.studio import language, theme
from playground.studio.draw import Area
from playground.studio.interface import HINTS, Panes, Preferences, Tab, remembered_preferences
from playground.studio.keys import all_keys
from playground.studio.language import choose_language
from playground.studio.panes import NARROW, PaneLayout
from playground.studio.settings_panel import draw_hints

from ..sketch_texts import map_of, passes
from .panel_desk import OpenBare, errors_of
from .screen import HILLS

FILES = {"sketch.toml": HILLS, "terrain.glsl": "float kernel(vec2 p) { return 0.5; }\n"}
WRITES = ("ink", "dim", "accent", "warm", "alarm")
GROUNDS = ("ground", "popup", "field", "raised", "wrong", "mild")
PLATE = 0.92
"""How opaque what is written over the picture is at least."""


def luminance(rgb: theme.Rgb) -> float:
    """Return the relative luminance of WCAG 2.2."""
    return sum(w * float(srgb_to_linear(part)) for w, part in zip((0.2126, 0.7152, 0.0722), rgb, strict=True))


@pytest.mark.parametrize("palette", [theme.DARK, theme.LIGHT], ids=["dark", "light"])
def test_text_has_a_contrast_of_4_5(palette: theme.Palette) -> None:
    """WCAG 2.2, criterion 1.4.3: (L1 + 0.05) / (L2 + 0.05)."""
    low = {
        (ink, ground): round(contrast, 2)
        for ink in WRITES
        for ground in GROUNDS
        if (contrast := contrast_of(getattr(palette, ink), getattr(palette, ground))) < 4.5
    }
    assert low == {}
    for state in ("hover", "pressed", "grab"):
        assert contrast_of(palette.ink, getattr(palette, state)) >= 4.5, f"a button: {state}"
    for rgb in palette.channels:
        assert contrast_of(rgb, palette.ground) >= 4.5 and contrast_of(rgb, palette.popup) >= 4.5
    assert contrast_of(palette.not_finite, palette.ground) >= 4.5


@pytest.mark.parametrize("palette", [theme.DARK, theme.LIGHT], ids=["dark", "light"])
def test_words_over_any_picture_can_be_read(palette: theme.Palette) -> None:
    """The worst picture is white under a dark plate, black under a light one."""
    picture = (0.0, 0.0, 0.0) if palette.is_light else (1.0, 1.0, 1.0)
    plate = mixed(palette.ground, picture, PLATE)
    assert min(contrast_of(getattr(palette, ink), plate) for ink in WRITES) >= 4.5


@pytest.mark.parametrize("palette", [theme.DARK, theme.LIGHT], ids=["dark", "light"])
def test_controls_and_curves_have_a_contrast_of_3(palette: theme.Palette) -> None:
    """Criterion 1.4.11: edges of boxes, knobs, the frame of the focus, curves of plots."""
    for ground in ("ground", "popup", "field"):
        assert contrast_of(palette.line, getattr(palette, ground)) >= 3.0, ground
    for rgb in palette.series:
        assert contrast_of(rgb, palette.ground) >= 3.0, rgb
    assert contrast_of(palette.knob, palette.field) >= 3.0
    for ground in ("ground", "popup", "field", "raised", "hover", "pressed"):
        assert contrast_of(palette.accent, getattr(palette, ground)) >= 3.0, "the focus"


@pytest.mark.parametrize("palette", [theme.DARK, theme.LIGHT], ids=["dark", "light"])
def test_what_cannot_be_used_can_be_read(open_bare: OpenBare, folder: Path, palette: theme.Palette) -> None:
    """Though WCAG asks nothing of it: a button whose colours are thinned as imgui does."""
    open_bare(folder).theme.choose(palette)
    alpha = imgui.get_style().disabled_alpha
    button = mixed(palette.raised, palette.ground, alpha)
    assert contrast_of(mixed(palette.ink, button, alpha), button) >= 4.5


def mixed(over: theme.Rgb, under: theme.Rgb, alpha: float) -> theme.Rgb:
    red, green, blue = (a * alpha + b * (1 - alpha) for a, b in zip(over, under, strict=True))
    return red, green, blue


def contrast_of(one: theme.Rgb, other: theme.Rgb) -> float:
    lighter, darker = sorted((luminance(one), luminance(other)), reverse=True)
    return (lighter + 0.05) / (darker + 0.05)


def test_palettes_differ_in_every_colour() -> None:
    for field in fields(theme.Palette):
        assert getattr(theme.DARK, field.name) != getattr(theme.LIGHT, field.name), field.name


def test_what_is_chosen_is_remembered(tmp_path: Path) -> None:
    remembered_preferences(tmp_path).choose(is_light=True, language="fr", panes={"code": 0.0})
    again = remembered_preferences(tmp_path)
    assert (again.is_light, again.language, again.panes) == (True, "fr", {"code": 0.0})
    file = tmp_path / "interface.json"
    file.write_text(json.dumps({"format": 1, "size": 1.25, "is_light": 3, "panes": []}))
    again = remembered_preferences(tmp_path)
    assert (again.size, again.is_light, again.panes) == (1.25, False, {})
    sizes = f'{{"code": 1, "panel width": 1{"0" * 400}, "code width": NaN, "strip height": 1e999}}'
    file.write_text(f'{{"format": 1, "panes": {sizes}}}')
    assert set(remembered_preferences(tmp_path).panes) <= {"code"}


TABS = [Tab("one", "One", lambda look: None)]


@pytest.mark.parametrize("size", [(1280, 720), (900, 640)], ids=["wide", "narrow"])
def test_panes_share_the_window(open_bare: OpenBare, folder: Path, size: tuple[int, int]) -> None:
    bare = open_bare(folder, size=size)
    preferences = Preferences(panes={"code": 1.0, "strip": 1.0})
    panes = Panes(preferences, has_code=True)
    layout = PaneLayout(panes)
    bare.run_frames(1)
    places = layout.place(300.0, TABS, bare.theme)
    assert places.code is not None and places.strip is not None
    wide, high = size[0] - 300.0, float(size[1])
    assert places.picture[3] + places.strip[3] == high and places.strip[2] == wide
    if size[0] >= NARROW:
        assert places.picture[2] + places.code[2] == wide
        assert places.code[0] == 300.0 + places.picture[2]
    else:
        assert places.code == places.picture
    panes.show_code(False)
    panes.show_strip(shown=False)
    places = layout.place(300.0, TABS, bare.theme)
    assert places.picture == (300.0, 0.0, wide, high) and places.code is None and places.strip is None
    preferences.choose(panes={})
    for name in ("code", "strip"):
        assert panes.is_open(name, narrow=False) and not panes.is_open(name, narrow=True)


def test_a_key_of_a_tab_opens_it_and_closes_the_strip() -> None:
    panes = Panes(Preferences(panes={}))
    panes.tab = "passes"
    panes.toggle_strip("versions")  # the strip shows another tab
    assert panes.selects == "versions" and panes.is_open("strip", narrow=False)
    panes.tab = "versions"
    panes.toggle_strip("versions")
    assert not panes.is_open("strip", narrow=False) and not panes.shows("versions")


# ── settings and hints ────────────────────────────────────────────────────────


@pytest.fixture(autouse=True)
def _english_and_dark() -> Iterator[None]:
    yield
    choose_language("en")
    theme.palette = theme.DARK


@pytest.mark.parametrize("by", ["a click", "F10"])
def test_settings_take_effect_at_once(open_bare: OpenBare, folder: Path, by: str) -> None:
    bare = open_bare(folder)
    preferences = bare.bench.interface.preferences
    preferences.choose(panes={"code": 0.0, "strip height": 0.5})
    label = next(label for label in bare.places if label.endswith("###settings"))
    if by == "a click":
        bare.click(label)
    else:
        bare.bench.interface.panel_shown = False
        bare.key(imgui.Key.f10)
    for control in ("Français###language fr", "Clair###light", "+###larger", "as delivered"):
        bare.run_frames(2)
        bare.click(next(label for label in bare.places if control in label))
    assert bare.bench.interface.panel_shown
    assert (preferences.language, preferences.is_light, preferences.size) == ("fr", True, 1.1)
    assert preferences.panes == {}
    bare.run_frames(2)
    assert any(label.startswith("FR") for label in bare.places)


def test_a_key_is_hinted_at_until_it_is_used(tmp_path: Path) -> None:
    preferences = remembered_preferences(tmp_path)
    assert preferences.hints == list(HINTS)
    preferences.use_key("O")
    preferences.use_key("G")  # which is none of them
    assert remembered_preferences(tmp_path).hints == [key for key in HINTS if key != "O"]
    (tmp_path / "interface.json").write_text('{"format": 1, "used_keys": [3, "?", "x"]}')
    assert remembered_preferences(tmp_path).used_keys == ("?",)


def test_hints_name_keys_that_there_are() -> None:
    french = tomllib.loads((Path(language.__file__).parent / "french.toml").read_text("utf-8"))
    assert HINTS.keys() <= {key.name for key in all_keys()} and set(HINTS.values()) <= french.keys()


def test_hints_go_one_by_one_and_all_at_once(open_bare: OpenBare, folder: Path) -> None:
    bare = open_bare(folder)
    preferences = bare.bench.interface.preferences

    def frame(area: Area) -> bool:
        """Return whether the line is drawn over an area."""
        bare.places.clear()
        draw = bare.draw
        bare.draw = lambda: (draw(), draw_hints(preferences, bare.theme, area))  # type: ignore[method-assign]
        bare.run_frames(2)
        bare.draw = draw  # type: ignore[method-assign]
        return "×###close hints" in bare.places

    wide = (330.0, 0.0, 950.0, 720.0)
    assert frame(wide)
    x, y, *_ = bare.places["×###close hints"]
    assert 640 < y < 700 and 700 < x < 1100
    assert not frame((330.0, 0.0, 60.0, 720.0)) and not frame((330.0, 0.0, 950.0, 100.0))
    for key, letter in (("?", "?"), ("Ctrl+E", ""), ("O", "")):
        if letter:
            imgui.get_io().add_input_character(ord(letter))
            bare.run_frames()
        else:
            bare.key(*((imgui.Key.mod_ctrl, imgui.Key.e) if key == "Ctrl+E" else (imgui.Key.o,)))
        assert key in preferences.used_keys
    assert not frame(wide), "all were used"


# ── signs besides colours ─────────────────────────────────────────────────────


def test_a_pass_that_ran_has_a_sign_besides_its_colour(
    open_bare: OpenBare, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kernel = '#pragma kernel(output = "height:r32f")\nuniform float level = 0.5;  //! slider(0, 1)\n'
    (folder / "terrain.glsl").write_text(f"{kernel}float kernel(ivec2 texel) {{ return level; }}\n")
    sketch = "format = 1\nsize = 33\n" + passes(height="./terrain") + map_of("height")
    (folder / "sketch.toml").write_text(sketch, encoding="utf-8")
    bare = open_bare(folder)
    written: list[str] = []
    monkeypatch.setattr(imgui, "text_colored", lambda _, text: written.append(text))
    bare.bench.inspection.costs_asked = True
    bare.run_frames(2)

    bare.session.drafts.set("view.lowest", -1.0)
    written.clear()
    bare.run_frames(1)
    named = {text for text in written if text.removeprefix("• ") in ("height", "view")}
    assert named == {"height", "• view"}, "only the view was drawn anew"


def test_a_warning_and_an_error_differ_in_words(open_bare: OpenBare, folder: Path) -> None:
    bare = open_bare(folder)
    bare.watch(imgui, "input_text_multiline")
    texts: list[str] = []
    field = imgui.input_text_multiline
    imgui.input_text_multiline = lambda label, text, *rest: (texts.append(text), field(label, text, *rest))[1]
    try:
        problems = bare.bench.problems
        problems.errors = (Diagnostic("no such name"),)
        problems.warnings = (Diagnostic("never read", severity="warning"),)
        problems.open = True
        bare.run_frames(
            1, around=lambda draw: errors_of(bare.bench).draw(bare.theme, (330.0, 0.0, 600.0, 700.0))
        )
    finally:
        imgui.input_text_multiline = field
    assert texts[0] == "no such name" and "warning: never read" in texts
