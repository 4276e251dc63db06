"""The page of a sketch in Chromium, driven by mouse, fingers and keys at 1280 and 390 pixels.

The player is one that draws without WebGL what its state says, so that it is the page which is tested.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.publish.web import fake_page

from ...browser import MISSING, Browser
from .firefox import Firefox
from .node import MISSING as NO_NODE

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(MISSING or NO_NODE), reason=MISSING or NO_NODE)]

STATE = "probe.states[probe.states.length - 1]"
KEYS = {
    "left": "\ue012",
    "up": "\ue013",
    "right": "\ue014",
    "down": "\ue015",
    "escape": "\ue00c",
    "tab": "\ue004",
}
CTRL, SHIFT = "\ue009", "\ue008"
FILM = {
    "moves": True,
    "duration": 8,
    "tracks": [
        {"of": "camera", "name": "azimuth", "targets": [], "times": [0, 3, 8], "values": [200, 220, 300]}
        | {"eases": ["smooth"] * 3, "holds": False, "angles": [0]}
    ],
}


class Page:
    """One page in the browser."""

    def __init__(self, browser: Browser | Firefox, url: str) -> None:
        self.browser, self.url = browser, url

    def open(self, fragment: str = "") -> None:
        self.browser.open("about:blank")
        self.browser.open(self.url + fragment)
        self.browser.wait("window.probe && probe.states.length > 0")
        self.at_rest()

    def run(self, script: str, *arguments: object) -> Any:
        return self.browser.run(script, *arguments)

    def state(self, what: str = "") -> Any:
        """Return what the player's state was when it rendered last."""
        return self.run(f"return {STATE}{what}")

    def value(self, path: str) -> Any:
        return self.run(f"return {STATE}.values[arguments[0]] ?? null", path)

    def at_rest(self) -> None:
        """Wait until no other picture is to come."""
        self.browser.wait("document.querySelector('.stage').getAttribute('aria-busy') === 'false'")

    def keys(self, *names: str, held: str = "") -> None:
        """Press keys, others held meanwhile."""
        actions = [{"type": "keyDown", "value": key} for key in held]
        for name in names:
            key = KEYS.get(name, name)
            actions += [{"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}]
        actions += [{"type": "keyUp", "value": key} for key in held]
        self.act({"type": "key", "id": "keys", "actions": actions})

    def act(self, *sources: dict[str, Any]) -> None:
        self.browser.act(*sources)
        self.at_rest()

    def drag(self, *path: tuple[int, int], button: int = 0, finger: bool = False, held: str = "") -> None:
        """Drag through places of the window."""
        pointer: list[dict[str, Any]] = [move(path[0]), {"type": "pointerDown", "button": button}]
        pointer += [*(move(position) for position in path[1:]), {"type": "pointerUp", "button": button}]
        hand = {"type": "pointer", "id": "finger" if finger else "hand", "actions": pointer}
        hand |= {"parameters": {"pointerType": "touch" if finger else "mouse"}}
        if not held:
            return self.act(hand)
        wait = [{"type": "pause"} for _ in pointer]
        keys = [
            {"type": "keyDown", "value": held},
            *wait[2:],
            {"type": "pause"},
            {"type": "keyUp", "value": held},
        ]
        return self.act(hand, {"type": "key", "id": "keys", "actions": keys})

    def wheel(self, position: tuple[int, int], down: int) -> None:
        scroll = {"type": "scroll", "x": position[0], "y": position[1], "deltaX": 0, "deltaY": down}
        self.act({"type": "wheel", "id": "wheel", "actions": [scroll]})

    def two_fingers(self, *paths: list[tuple[int, int]]) -> None:
        """Move two fingers along two paths."""
        sources = []
        for number, path in enumerate(paths):
            actions: list[dict[str, Any]] = [move(path[0]), {"type": "pointerDown", "button": 0}]
            actions += [*(move(position) for position in path[1:]), {"type": "pointerUp", "button": 0}]
            source = {"type": "pointer", "id": f"finger {number}", "actions": actions}
            sources.append(source | {"parameters": {"pointerType": "touch"}})
        self.act(*sources)

    def middle(self, selector: str) -> tuple[int, int]:
        box = f"const box = document.querySelector({selector!r}).getBoundingClientRect();"
        x, y = self.run(box + "return [box.x + box.width / 2, box.y + box.height / 2]")
        return round(x), round(y)

    def keep(self, name: str) -> None:
        """Keep a picture of the window where one is asked for, to be looked at."""
        if folder := os.environ.get("PAGE_PICTURES"):
            Path(folder, f"{name}.png").write_bytes(self.browser.picture())


def move(position: tuple[int, int]) -> dict[str, Any]:
    return {"type": "pointerMove", "duration": 0, "x": position[0], "y": position[1]}


@pytest.fixture(scope="module")
def script(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if not (fake_page.WEB / "node_modules").is_dir():
        pytest.skip("needs 'npm ci' in playground/publish/web")
    return fake_page.build(tmp_path_factory.mktemp("script"))


@pytest.fixture(scope="module")
def wide(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("wide"), 1280, 900) as made:
        yield made


@pytest.fixture(scope="module")
def phone(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("phone"), 500, 844) as made:
        made.emulate("setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=2, mobile=True)
        made.emulate("setTouchEmulationEnabled", enabled=True)
        yield made


@pytest.fixture
def page(wide: Browser, script: Path, tmp_path: Path) -> Iterator[Page]:
    made = Page(wide, fake_page.write(script, tmp_path / "page.html", fake_page.page()).as_uri())
    made.open()
    yield made
    no_complaint(made)


@pytest.fixture
def film(wide: Browser, script: Path, tmp_path: Path) -> Iterator[Page]:
    made = Page(wide, fake_page.write(script, tmp_path / "film.html", fake_page.page(**FILM)).as_uri())
    wide.emulate("setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    made.open()
    yield made
    wide.emulate("setEmulatedMedia", features=[])
    no_complaint(made)


@pytest.fixture
def small(phone: Browser, script: Path, tmp_path: Path) -> Iterator[Page]:
    made = Page(phone, fake_page.write(script, tmp_path / "page.html", fake_page.page()).as_uri())
    made.open()
    yield made
    no_complaint(made)


def no_complaint(page: Page) -> None:
    """Nothing failed, nothing was refused, nothing but the page itself was asked for."""
    assert page.browser.log() == []
    asked = page.run("return performance.getEntriesByType('resource').map((one) => one.name)")
    assert [name for name in asked if not name.startswith(("data:", "blob:"))] == []


# ── the picture ──────────────────────────────────────────────────────────────


def test_a_drag_of_the_pictures_height_turns_half_around(page: Page):
    height = page.run("return document.querySelector('canvas').clientHeight")
    page.drag((300, 600), (300 + height // 4, 600))
    assert page.state(".camera.azimuth") == pytest.approx((200 + 180 * (height // 4) / height) % 360)
    page.drag((300, 600), (300, 600 - height // 4))
    assert page.state(".camera.elevation") == pytest.approx(30 - 180 * (height // 4) / height)


def test_right_and_shift_drags_move_the_target_alike(page: Page):
    page.drag((300, 400), (360, 440), button=2)
    target = page.state(".camera.target")
    assert target != [2048, 2048, 400] and page.state(".camera.azimuth") == 200
    page.keys("r")
    page.drag((300, 400), (360, 440), held=SHIFT)
    assert page.state(".camera.target") == pytest.approx(target)


def test_wheel_zooms_by_window_notch_and_double_click_resets(page: Page):
    page.wheel((300, 400), -100)
    assert page.state(".camera.distance") == pytest.approx(5000 * 0.88)
    page.wheel((300, 400), 200)
    assert page.state(".camera.distance") == pytest.approx(5000 / 0.88)
    down, up = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}
    page.act({"type": "pointer", "id": "hand", "actions": [move((300, 400)), down, up, down, up]})
    assert page.state(".camera.distance") == 5000


def test_ctrl_drag_moves_sun_and_divider_follows_its_drag(page: Page):
    page.drag((300, 400), (360, 400), held=CTRL)
    height, width = page.run(
        "const c = document.querySelector('canvas'); return [c.clientHeight, c.clientWidth]"
    )
    assert page.value("light.sun")[0] == pytest.approx(120 + 60 / height * 180, abs=0.01)
    page.drag((width // 2, 400), (width // 4, 400))
    assert page.value("view.divide") == pytest.approx(0.25, abs=0.01)
    assert page.state(".camera.azimuth") == 200


def test_keys_orbit_zoom_and_reset(page: Page):
    page.run("document.querySelector('canvas').focus()")
    page.keys("right", "right", "up", "+")
    camera = page.state(".camera")
    assert camera["azimuth"] == pytest.approx(210) and camera["elevation"] == pytest.approx(25)
    assert camera["distance"] == pytest.approx(5000 * 0.88)
    page.keys("r")
    assert page.state(".camera.azimuth") == 200
    page.keys("?")
    assert page.run("return document.querySelector('dialog').open")
    page.keep("keys")
    page.keys("escape")
    assert not page.run("return document.querySelector('dialog').open")


def test_slow_picture_drops_pixels_in_motion_and_is_full_at_rest(page: Page):
    whole = page.run("return probe.frames[probe.frames.length - 1]")
    page.run("probe.slow = 250")
    page.drag(*((300 + 12 * n, 600) for n in range(16)))
    page.browser.wait("Math.min(...probe.frames.map(([width]) => width)) <= arguments[0] / 2", whole[0])
    page.browser.wait(
        "probe.frames[probe.frames.length - 1][0] === arguments[0]", whole[0]
    )  # sharp again at rest
    box = page.run("const c = document.querySelector('canvas'); return [c.clientWidth, c.clientHeight]")
    assert box == page.run(
        "const s = document.querySelector('.stage'); return [s.clientWidth, s.clientHeight]"
    )


def test_a_setting_that_cannot_be_shown_leaves_the_last_picture(page: Page):
    page.run("probe.error = 'height takes 2^n + 1 texels'; probe.page.session.set('height.seed', 4)")
    page.at_rest()
    text = page.run("return document.querySelector('.alarm').textContent")
    assert "height takes 2^n + 1 texels" in text and "the last picture stays" in text
    page.keep("error")
    page.run("probe.error = ''; probe.page.session.set('height.seed', 5)")
    page.at_rest()
    assert page.run("return document.querySelector('.notes').textContent") == ""


# ── the panel ────────────────────────────────────────────────────────────────

ROW = "document.querySelector('[data-path=\"{}\"]')"
FOLDS = "document.querySelectorAll('.panel details.section, .panel details.inner')"
OPEN_ALL = f"""for (const one of {FOLDS}) one.open = true;
    return new Promise((done) => setTimeout(done, 100))"""


def test_each_widget_sets_its_value(page: Page):
    page.run(OPEN_ALL)
    page.keep("panel")

    def enter(path: str, text: str, at: str = "input[type=text]") -> None:
        script = f"const input = {ROW.format(path)}.querySelector(arguments[0]); input.value = arguments[1];"
        page.run(script + "input.dispatchEvent(new Event('change'))", at, text)
        page.at_rest()

    for path, text, value in (
        ("height.level", "0.5 m", 0.5), ("height.level", "7", 1), ("height.seed", "4", 4),
        ("height.scale", "500", 500), ("height.free", "-3,25", -3.25), ("height.offset", "0.75", [0.75, 0.5]),
        ("ground.grass", "#ff0000", [1, 0, 0]), ("light.sun", "45°", [45, 40]),
        ("ground.middle", "0.25", [0.25, 0.5]), ("light.turn", "30", 30),
    ):  # fmt: skip
        enter(path, text)
        assert page.value(path) == value, path
        assert page.run(f"return {ROW.format(path)}.classList.contains('changed')")
    enter("ground.haze", "#00ff0080"[:7])
    assert page.value("ground.haze") == [0, 1, 0, 1]
    enter("ground.kind", "1", "select")
    assert page.value("ground.kind") == 1
    slid = ("height.level", 0.3, 0.3), ("height.scale", 0.5, 31.62), ("height.seed", 0.72, 7)
    for path, share, value in slid:
        slider = f"const slider = {ROW.format(path)}.querySelector('[type=range]');"
        page.run(f"{slider} slider.value = arguments[0]; slider.oninput()", share)
        page.at_rest()
        assert page.value(path) == pytest.approx(value, rel=1e-3)
    page.browser.click('[data-path="ground.rocks"] input')
    page.at_rest()
    assert page.value("ground.rocks") is False
    assert page.run(f"return {ROW.format('ground.photo')}.querySelector('input').disabled")
    assert "part of the page" in page.run(f"return {ROW.format('ground.photo')}.textContent")


def test_a_button_is_pressed_while_it_is_held(page: Page):
    page.run(OPEN_ALL)
    page.run("probe.states.length = 0")
    page.run("document.querySelector('.press').scrollIntoView({ block: 'center' })")
    page.drag(page.middle(".press"))
    pressed = page.run("return probe.states.map((one) => one.values['light.flash'] === true)")
    assert True in pressed and pressed[-1] is False


def test_pads_are_dragged(page: Page):
    page.run(OPEN_ALL)
    for path, away, value in (("light.sun", (40, 0), [90, 0]), ("ground.middle", (-60, -60), [0, 1])):
        page.run(f"{ROW.format(path)}.scrollIntoView({{ block: 'center' }})")
        x, y = page.middle(f'[data-path="{path}"] .pad')
        page.drag((x, y), (x + away[0], y + away[1]))
        assert page.value(path) == pytest.approx(value, abs=6)


def test_resets_and_undo(page: Page):
    page.run("probe.page.session.set('height.level', 0.75); probe.page.session.set('height.seed', 9)")
    page.at_rest()
    page.browser.click('[data-path="height.seed"] .reset')
    page.at_rest()
    assert page.value("height.seed") is None and page.value("height.level") == 0.75
    x, y = page.middle('[data-path="height.level"] .name')
    down, up = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}
    page.act({"type": "pointer", "id": "hand", "actions": [move((x, y)), down, up, down, up]})
    assert page.value("height.level") is None
    page.keys("z", held=CTRL)
    assert page.value("height.level") == 0.75
    page.keys("z", held=CTRL)
    assert page.value("height.seed") == 9
    page.keys("z", held=CTRL + SHIFT)
    assert page.value("height.seed") is None
    page.browser.click(".head-line:first-child button:nth-child(3)")
    page.at_rest()
    assert page.state(".values") == {}


def test_search_presets_techniques_iterations(page: Page):
    page.keys("/")
    page.keys(*"octav")
    assert page.run(
        "return [...document.querySelectorAll('.list:last-child .row')].map((r) => r.dataset.path)"
    ) == ["height.inner.octaves"]
    page.keep("search")
    page.run("const s = document.querySelector('[type=search]'); s.value = ''; s.oninput()")
    page.run("const p = document.querySelector('.panel-head select'); p.value = 'high'; p.onchange()")
    page.at_rest()
    assert page.value("height.level") == 0.75 and page.state(".terrain.relief") == 1200
    page.run(OPEN_ALL)
    page.run("const r = document.querySelector('.is-steps [type=range]'); r.value = 5; r.oninput()")
    page.at_rest()
    assert page.state(".steps") == {"height": 5}
    page.run("const s = document.querySelector('[aria-label^=Technique]'); s.value = '1'; s.onchange()")
    page.browser.wait("probe.opened.length === 2")
    page.at_rest()
    assert page.run("return document.title") == "Ridges" and page.value("height.level") == 0.75


def test_iterations_that_change_nothing_are_locked(wide: Browser, script: Path, tmp_path: Path):
    repeated = {"base": "#terrain", "where": "", "locked": MADE}
    data = fake_page.page(passes={"height": repeated}, choices=[])
    page = Page(wide, fake_page.write(script, tmp_path / "page.html", data).as_uri())
    page.open()
    page.run(OPEN_ALL)
    row = "const row = document.querySelector('.is-steps'), range = row.querySelector('input');"
    result = "range.disabled, range.ariaDescription, row.previousSibling.textContent"
    assert page.run(f"{row} return [{result}]") == [True, MADE, MADE]
    page.run(f"{row} range.value = 5; range.oninput(); row.ondblclick()")
    page.at_rest()
    assert page.state(".steps") == {}
    page.run(f"{row} row.scrollIntoView()")
    page.keep("locked-iterations")
    no_complaint(page)


# ── time, maps, address ──────────────────────────────────────────────────────


def test_reduced_motion_pauses_time_until_played(film: Page):
    assert film.state(".time") == 0
    assert film.run("return document.querySelectorAll('.marks span').length") == 3
    film.run("document.querySelector('canvas').focus()")
    film.keys(".")
    assert film.state(".time") == pytest.approx(1 / 30)
    film.run("const r = document.querySelector('.timeline [type=range]'); r.value = 3.02; r.oninput()")
    film.at_rest()
    assert film.state(".time") == 3, "a keyframe that is near"
    assert film.state(".camera.azimuth") == 220
    film.drag((300, 400), (360, 400))
    turned = film.state(".camera.azimuth")
    film.browser.click(".timeline .run")
    film.browser.wait(f"{STATE}.time > 3.2")
    assert film.state(".camera.azimuth") == turned, "a user's camera stays"
    film.keep("film")
    film.browser.click(".timeline .run")
    film.at_rest()
    film.keys("0")
    assert film.state(".time") == 0


def test_a_map_is_moved_enlarged_and_read(page: Page):
    page.run("const s = document.querySelector('.textures'); s.value = '0'; s.onchange()")
    page.at_rest()
    assert page.state(".frame") == [257, 257], "a pixel for each texel"
    lowest, highest = page.state(".map.values['map.lowest']"), page.state(".map.values['map.highest']")
    assert 0 < lowest < 0.1 and 0.9 < highest < 1, "fitted to the values"
    x, y = page.middle("canvas")
    page.act({"type": "pointer", "id": "hand", "actions": [move((x, y))]})
    lines = page.run("return document.querySelector('.readout').textContent").split("\n")
    assert lines[0] == "Texel 128, 128" and lines[1] == "2048 m east, 2048 m north"
    value = float(lines[3])
    assert lines[2] == f"{800 * value:.2f} m high, {800 * value + 100:.2f} m above the sea"
    frames = page.run("return probe.frames.length")
    page.wheel((x, y), -300)
    page.drag((x, y), (x + 120, y))
    moved = page.run("return document.querySelector('.readout').textContent").split("\n")[0]
    assert moved == lines[0], "what was under the pointer goes with it"
    assert page.run("return probe.frames.length") == frames, "moving a map renders nothing"
    page.keep("map")
    page.keys("m", "m")
    assert page.state(".map") is None


def test_the_picture_stays_while_a_maps_programs_are_compiled(page: Page):
    page.open()
    page.run("probe.compiling = 150")
    before = page.run("return document.querySelector('canvas').toDataURL()")
    page.run("const menu = document.querySelector('.textures'); menu.value = '0'; menu.onchange()")
    page.browser.wait("/\\d+ of 3/.test(document.querySelector('.notes').textContent)")
    page.browser.drag("canvas", (-60, 0), (60, 20))  # nothing is there yet to be moved
    assert page.run("return document.querySelector('canvas').toDataURL()") == before
    page.at_rest()
    load = page.run("return probe.loads.find(({ map }) => map)")
    assert load["before"] == load["after"], "nothing is drawn that would wait for a compiler"
    assert page.state(".map.path") == "height"
    assert page.run("return document.querySelector('canvas').toDataURL()") != before


def test_the_address_holds_the_state_and_brings_it_back(page: Page):
    page.run("probe.page.session.set('height.level', 0.75); probe.page.session.set('light.sun', [10, 20])")
    page.drag((300, 400), (360, 400))
    page.browser.wait("location.hash.includes('camera=')")
    state, fragment = page.state(), page.run("return location.hash")
    page.open(fragment)
    assert page.state(".values") == state["values"]
    assert page.state(".camera.azimuth") == pytest.approx(state["camera"]["azimuth"], abs=0.01)
    page.open(
        "#height.level=%3Cimg%20src%3Dx%20onerror%3D%22document.title%3D1%22%3E&%3Cb%3E=1&height.seed=4"
    )
    assert page.value("height.seed") == 4
    text = page.run("return document.querySelector('.message').textContent")
    assert (
        "<b>" in text and page.run("return document.querySelectorAll('.message b, img[src=x]').length") == 0
    )


def test_hostile_texts_stay_texts(wide: Browser, script: Path, tmp_path: Path):
    bad = fake_page.HOSTILE
    data = fake_page.page(title=bad, name=bad, notes=[bad], presets=[{"name": bad, "values": {}}])
    for item in data["sketches"][0]["shown"]:
        item |= {
            "label": bad,
            "description": bad,
            "group": bad,
            "unit": bad,
            "parts": [bad] * 2 if item["parts"] else [],
        }
        item["choices"] = [bad, bad] if item["choices"] else []
    data["sketches"][0]["textures"][0]["label"] = bad
    page = Page(wide, fake_page.write(script, tmp_path / "page.html", data).as_uri())
    page.open()
    page.run(OPEN_ALL)
    page.run("const s = document.querySelector('.textures'); s.value = '0'; s.onchange()")
    page.keys("/", "i")
    assert page.run("return [document.querySelectorAll('img[src=x]').length, document.title]") == [0, bad]
    no_complaint(page)


MADE = "The triangulation was made when the page was exported."
WHY = """const visible = (one) => one.checkVisibility();
const reads = (one) => one.matches("h2, h3, summary") ? "# " + one.textContent
    : one.matches(".row") ? one.querySelector(".name").textContent : one.textContent;
const all = "h2, h3, summary, .row, .why-locked, .row .note";
const list = [...document.querySelectorAll(".panel .list")].find(visible);
return [...list.querySelectorAll(all)].filter(visible).map(reads)"""


def test_why_rows_are_locked_is_said_once_in_each_group(wide: Browser, script: Path, tmp_path: Path):
    def row(name: str, group: str = "", locked: str = "") -> dict[str, Any]:
        return fake_page.row(name, "float", "slider", 0.5, ranges=[[0, 1]], group=group, locked=locked)

    shown = [row("mesh.a", locked=MADE), row("mesh.b", "Points", MADE), row("mesh.c", "Points", MADE)]
    shown += [row("land.d"), row("land.e", locked="Alone."), row("land.f", locked=MADE)]
    shown += [row("land.g", locked=MADE), row("land.h", "Points", MADE), row("land.i", "Points", MADE)]
    for number in (0, 2):
        shown[number]["main"] = 1 + number
    data = fake_page.page(shown=shown, choices=[])
    page = Page(wide, fake_page.write(script, tmp_path / "page.html", data).as_uri())
    page.open()
    page.run(OPEN_ALL)
    main, mesh = ["# Main parameters", MADE, "A", "C"], ["# Mesh", MADE, "A", "# Points", "B", "C"]
    land = ["# Land", "D", "E", "Alone.", MADE, "F", "G", "# Points", MADE, "H", "I"]
    assert page.run(WHY)[: len(main + mesh + land)] == main + mesh + land
    message = (
        "[...document.querySelectorAll('.panel .locked [type=range]')].map((one) => one.ariaDescription)"
    )
    assert page.run(f"return {message}") == [MADE] * 5 + ["Alone."] + [MADE] * 4
    page.run("const field = document.querySelector('[type=search]'); field.value = 'mesh'; field.oninput()")
    assert page.run(WHY) == ["# Mesh", MADE, "A", "B", "C"]
    page.keep("locked")
    no_complaint(page)


# ── a phone ──────────────────────────────────────────────────────────────────


def test_fingers_on_the_picture_of_a_phone(small: Page):
    small.keep("phone")
    height = small.run("return document.querySelector('canvas').clientHeight")
    small.drag((100, 150), (140, 150), finger=True)
    assert small.state(".camera.azimuth") == pytest.approx((200 + 40 / height * 180) % 360, abs=0.5)
    assert small.run("return scrollY") == 0
    small.drag((100, 150), (100, 60), finger=True)
    assert small.run("return scrollY") == 0, "the page stays where it is"
    small.two_fingers([(150, 120), (100, 120)], [(250, 120), (300, 120)])
    assert small.state(".camera.distance") == pytest.approx(2500, rel=0.02), (
        "twice as far apart: twice as near"
    )
    target = small.state(".camera.target")
    small.two_fingers([(150, 120), (180, 120)], [(250, 120), (280, 120)])
    assert small.state(".camera.target") != target
    pixels = small.run("return probe.frames[probe.frames.length - 1]")
    assert pixels[0] == 780, "sharp on a dense screen"


def test_a_phone_has_everything_within_its_width(small: Page):
    small.run(OPEN_ALL)
    wide = (
        "[...document.querySelectorAll('#playground *')].filter((e) => e.getBoundingClientRect().right > 391)"
    )
    assert small.run(f"return {wide}.map((e) => e.outerHTML.slice(0, 80))") == []
    assert small.run("return document.documentElement.scrollWidth") == 390
    little = """const all = document.querySelectorAll('button, select, input:not([type=checkbox])');
        return [...all].filter((e) => e.offsetParent && e.getBoundingClientRect().height < 24)
            .map((e) => e.outerHTML.slice(0, 80))"""
    assert small.run(little) == [], "large enough for a finger"
    small.run("scrollTo(0, 700)")
    small.keep("phone scrolled")
    top = small.run("return document.querySelector('canvas').getBoundingClientRect().top")
    assert top == 0, "the picture stays above while its sliders are moved"


# ── for everybody ────────────────────────────────────────────────────────────


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_texts_have_contrast_and_controls_have_names(page: Page, theme: str):
    page.run("document.documentElement.dataset.theme = arguments[0]", theme)
    page.run(OPEN_ALL)
    page.keep(f"panel {theme}")
    assert page.run(CONTRAST) == []
    nameless = """const all = document.querySelectorAll('button, input, select, canvas, summary');
        return [...all].filter((e) => !(e.getAttribute('aria-label') || e.textContent.trim()))
            .map((e) => e.outerHTML.slice(0, 90))"""
    assert page.run(nameless) == []


CONTRAST = """
const linear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
const light = (text) => {
    const [r, g, b] = text.match(/[\\d.]+/g).map((n) => linear(n / 255));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const ground = (e) => {
    for (let at = e; at; at = at.parentElement) {
        const colour = getComputedStyle(at).backgroundColor;
        if (!/, 0\\)$|transparent/.test(colour)) return colour;
    }
    return "rgb(255, 255, 255)";
};
const noText = "[type=range], [type=color], [type=checkbox]";
const isField = (e) => e.matches("input, select") && !e.matches(noText);
const hasText = (e) => isField(e)
    || [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim());
return [...document.querySelectorAll(".side *")].filter((e) => {
    if (!e.offsetParent || e.closest(":disabled, .locked") || !hasText(e)) return false;
    const [a, b] = [light(getComputedStyle(e).color), light(ground(e))].sort((x, y) => y - x);
    return (a + 0.05) / (b + 0.05) < 4.5;
}).map((e) => e.outerHTML.slice(0, 90));
"""


def test_tab_order_is_picture_tools_time_panel(film: Page):
    film.run("document.body.focus()")
    order = []
    for _ in range(14):
        film.browser.press(KEYS["tab"])
        order.append(
            film.run("const e = document.activeElement; return e.className || e.tagName.toLowerCase()")
        )
    assert order[0] == "canvas"
    assert order[1] == "textures" and order[7].startswith("tool") and "run" in order
    assert order.index("run") < order.index("button"), "the panel comes last"


def test_paper_has_the_picture_and_what_differs(page: Page):
    page.run("probe.page.session.set('height.level', 0.75)")
    page.at_rest()
    page.run("dispatchEvent(new Event('beforeprint'))")
    page.browser.emulate("setEmulatedMedia", media="print")
    try:
        shown = """return ['.side .panel', '.tools', '.timeline', '.stage canvas', '.on-paper', 'h1'].map(
            (one) => getComputedStyle(document.querySelector(one)).display !== 'none')"""
        assert page.run(shown) == [False, False, False, True, True, True]
        assert '"height.level" = 0.75' in page.run("return document.querySelector('.on-paper').textContent")
        page.keep("paper")
    finally:
        page.browser.emulate("setEmulatedMedia", media="")


def test_a_picture_is_saved_as_it_is(page: Page):
    page.run(
        """HTMLAnchorElement.prototype.click = async function () {
            const image = new Image();
            image.src = this.href;
            await image.decode();
            window.saved = [this.download, image.naturalWidth, image.naturalHeight]; }"""
    )
    page.run("document.querySelector('canvas').focus()")
    size = page.run("return probe.frames[probe.frames.length - 1]")
    page.keys("s")
    assert page.browser.wait("window.saved") == ["hills.png", *size]


def test_the_panel_hides_and_the_code_has_its_tab(page: Page):
    page.keys("p")
    assert page.run("return document.querySelector('.side').offsetParent === null")
    page.keys("p")
    page.browser.click("[role=tab]:last-child")
    assert page.run("return document.querySelector('#playground-code textarea').offsetParent !== null")
    assert page.run("return document.querySelector('#playground-panel').hidden")
