"""The start page: pictures of the shipped sketches, recent ones, new ones, search."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui
from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.paths import SKETCHES
from playground.sketch.find import shipped_sketches
from playground.studio import language
from playground.studio.language import choose_language, tr
from playground.studio.start import thumbnails as made
from playground.studio.start.page import LESSONS, TEMPLATES, Card, StartPage
from playground.studio.start.panel import StartPanel
from playground.studio.start.recent import Recent
from playground.studio.start.thumbnails import CELL, SUBJECTS, place_of, read_atlas, shrunk, thumbnails

from ..shipped import slow_but
from .panel_desk import Bare
from .screen import HILLS

FILES = {"sketch.toml": HILLS, "terrain.glsl": "float kernel(vec2 p) { return 0.5; }\n"}


def test_every_shipped_sketch_has_a_card_with_its_own_words() -> None:
    """Made anew by ``python -m playground.studio.start.thumbnails``."""
    rows = {row.name: row for row in thumbnails()}
    assert sorted(rows) == shipped_sketches()
    assert len({row.cell for row in rows.values()}) == len(rows)
    for name, row in rows.items():
        table = tomllib.loads((SKETCHES / f"{name}.toml").read_text("utf-8"))
        assert row.title == table["title"] and row.subject in SUBJECTS and row.about.endswith("."), name


@pytest.mark.parametrize("name", slow_but(shipped_sketches()))
def test_a_picture_is_that_of_the_reference(name: str) -> None:
    """Of all pictures of the atlas its own is the nearest, or one of a sketch whose reference is the same."""

    def reference_of(name: str) -> NDArray[np.float64]:
        path = made.reference_of(name)
        assert path is not None
        return np.asarray(shrunk(made.read_picture(path)), float)

    atlas, wanted = read_atlas(), reference_of(name)
    far: dict[str, float] = {}
    for row in thumbnails():
        left, top, right, bottom = np.multiply(place_of(row.cell, atlas.size), atlas.size * 2).round()
        part = np.asarray(atlas.crop((left, top, right, bottom)), float)
        assert part.shape == (CELL[1], CELL[0], 3)
        far[row.name] = np.abs(part - wanted).mean()
    nearest = min(far, key=far.__getitem__)
    assert np.abs(reference_of(nearest) - wanted).mean() < 0.5, f"{nearest}; half a level is no difference"


def test_recent_sketches_are_the_last_first_and_survive_anything(tmp_path: Path) -> None:
    recent = Recent(tmp_path / "state")
    assert recent.sketches() == []
    pixels = np.zeros((90, 200, 4), np.uint8)
    pixels[..., 0] = 200
    paths = [tmp_path / f"{number}.toml" for number in range(14)]
    for path in paths:
        path.write_text("", encoding="utf-8")
        recent.note(path, path.stem.upper(), pixels)
    listed = recent.sketches()
    assert [row.path for row in listed] == paths[:1:-1] and listed[0].title == "13"
    assert all(row.picture is not None for row in listed)
    assert len(list((tmp_path / "state" / "recent").iterdir())) == 12
    picture = np.asarray(made.read_picture(listed[0].picture or ""))
    assert picture.shape == (CELL[1], CELL[0], 3) and abs(int(picture[50, 50, 0]) - 200) < 4
    recent.note(paths[5], "again")
    paths[13].unlink()
    assert [row.path for row in recent.sketches()][:2] == [paths[5], paths[12]]
    (tmp_path / "state" / "recent.json").write_text('{"format": 1, "sketches": [3]}', encoding="utf-8")
    assert recent.sketches() == []


@pytest.fixture
def page(bare: Bare, tmp_path: Path) -> StartPage:
    """Give the page of a panel's bench, with a list of recent sketches of its own."""
    start = StartPage(bare.bench.actions, Recent(tmp_path / "state"))
    start.open()
    return start


def test_search_and_subject_choose_cards(page: StartPage) -> None:
    assert len(page.cards("shipped")) == len(shipped_sketches())
    page.search = "soft CONE"
    titles = [card.key for card in page.cards("shipped")]
    assert "shipped soft_cone" in titles and len(titles) < 5
    first = page.first()
    assert first is not None and first.key == titles[0]
    page.search, page.subject = "", "erosion"
    assert {card.subject for card in page.cards("shipped")} == {"erosion"}
    page.search = "no such thing"
    assert page.cards("shipped") == [] and page.first() is None


def test_lessons_alone_are_a_subject_where_there_are_any(page: StartPage) -> None:
    assert LESSONS not in page.subjects()
    page.more = lambda: [Card("lesson 1", "The march", "", lambda: True, "lesson")]
    page.open()
    assert LESSONS in page.subjects()
    page.subject = LESSONS
    assert [card.title for card in page.cards("lesson")] == ["The march"]
    assert page.cards("shipped") == [] and page.cards("recent") == []


def test_a_card_opens_its_sketch_and_closes_the_page(page: StartPage, bare: Bare) -> None:
    card = next(card for card in page.cards("shipped") if card.key == "shipped height_colour")
    page.choose(card)
    assert bare.session.path == SKETCHES / "height_colour.toml" and not page.shown
    page.open()
    page.choose(Card("x", "x", "", lambda: False, "lesson"))
    assert page.shown, "what could not be opened leaves the page open"


def test_new_sketches_get_names_that_are_free(page: StartPage, bare: Bare, tmp_path: Path) -> None:
    page.actions.folder = tmp_path
    hills, empty = TEMPLATES[:2]
    assert page.make(hills) and page.make(empty)
    assert bare.session.path == tmp_path / "my-land-2" / "sketch.toml"
    assert (tmp_path / "my-land" / "sketch.toml").is_file() and not page.shown


def test_the_page_is_drawn_and_its_cards_clicked(page: StartPage, bare: Bare, any_engine: Engine) -> None:
    panel = StartPanel(any_engine.ctx)
    bare.bench.start = page

    def frame() -> None:
        imgui.get_io().delta_time = 1 / 60
        imgui.new_frame()
        panel.draw(page, bare.theme, bare.bench.interface)
        imgui.render()
        for texture in imgui.get_platform_io().textures:
            texture.set_status(imgui.ImTextureStatus.ok)

    try:
        for _ in range(3):
            frame()
        x, y, wide, high = bare.places["shipped alpine"]
        assert wide >= 190 and high > 100
        imgui.get_io().add_mouse_pos_event(x + wide / 2, y + high / 2)
        frame()
        imgui.get_io().add_mouse_button_event(0, True)
        frame()
        imgui.get_io().add_mouse_button_event(0, False)
        frame()
        assert bare.session.path == SKETCHES / "alpine.toml" and not page.shown
    finally:
        panel.release()


# ── words ─────────────────────────────────────────────────────────────────────


def test_a_language_is_the_chosen_one_or_the_systems(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(language.locale, "getlocale", lambda: ("fr_CA", "UTF-8"))
    try:
        assert choose_language("") == "fr" and tr("Back") == "Retour"
        assert choose_language("en") == "en" and tr("Back") == "Back"
        assert choose_language("xx") == "en" and tr("made {folder}", folder="x") == "made x"
    finally:
        choose_language("en")
