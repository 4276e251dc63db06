"""What a user makes of a sketch in a page: edits by leaf, undo, presets, links that do no harm."""

from __future__ import annotations

import re
import tomllib
from typing import Any

import pytest

from playground.engine.engine import Engine
from playground.publish.web.page_data import page_data
from playground.sketch.find import shipped_sketches
from tests.publish.web import fake_page

from ...loading import load
from .node import Node

BEGIN = """async (page, steps, load) => {
    const { createSession, terrainRows } = await load("session.js"), address = await load("address.js");
    const session = createSession(page.sketches), news = [];
    session.follow((one) => news.push(one));
    const link = () => address.fragmentOf(session, { time: true });
    const read = (text) => {
        const rowsOf = (sketch) => [...sketch.shown, ...terrainRows(sketch)];
        const found = address.readFragment(text, page.sketches, rowsOf);
        session.begin(found);
        return found;
    };
    const leaves = () => session.state().values, terrain = () => session.state().terrain;
"""


def run(node: Node, body: str, page: dict[str, Any] | None = None, steps: Any = None) -> Any:
    """Return what the body of a function returns, which has a session."""
    return node.run(BEGIN + body + "}", page or fake_page.page(), steps)


def test_a_value_reaches_every_leaf_that_its_row_stands_for(node: Node):
    result = run(node, "session.set('height.level', 0.5); return leaves()")
    assert result == {"height.level": 0.5, "height.inner.level": 0.5}


def test_an_inner_row_may_differ_until_the_outer_is_set_again(node: Node):
    result = run(
        node,
        """session.set("height.level", 0.5); session.set("height.inner.level", 0.75);
        const before = leaves(); session.set("height.level", 1);
        return [before, leaves(), [...session.edits]]""",
    )
    assert result[0] == {"height.level": 0.5, "height.inner.level": 0.75}
    assert result[1] == {"height.level": 1, "height.inner.level": 1}
    assert result[2] == [["height.level", 1]]


def test_reset_takes_a_row_back_and_leaves_others(node: Node):
    body = """session.set("height.seed", 4);
        session.set("height.level", 0.5); session.set("height.inner.level", 0.9);
        session.reset("height.inner.level"); return [leaves(), session.changed("height.inner.level")]"""
    assert run(node, body) == [{"height.seed": 4, "height.level": 0.5, "height.inner.level": 0.25}, False]
    assert (
        run(node, "session.set('height.seed', 4); session.reset('height.seed'); return [...session.edits]")
        == []
    )


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("height.level", 1.5), ("height.level", "x"), ("height.level", None), ("height.seed", 1.5),
        ("ground.kind", 2), ("ground.kind", -1), ("light.sun", [0, 91]), ("light.sun", [0]),
        ("size", [0.5, 3]),
        ("ground.photo", "other.jpg"), ("nothing", 1), ("__proto__", 1), ("relief", 1e300),
    ],
)  # fmt: skip
def test_what_does_not_fit_changes_nothing(node: Node, path: str, value: object):
    body = "session.set(steps[0], steps[1]); return [leaves(), session.edits.size, terrain().relief]"
    assert run(node, body, steps=[path, value]) == [{}, 0, 800]


def test_undo_and_redo_go_through_every_step_and_a_drag_is_one(node: Node):
    body = """for (let n = 1; n < 9; n++) session.set("height.level", n / 10);
        session.set("height.seed", 7); session.setAll([["relief", 900], ["light.turn", 30]]);
        const seen = [];
        const now = () => seen.push([leaves()["height.level"], leaves()["height.seed"], terrain().relief]);
        now(); while (session.undo()) now(); while (session.redo()) now();
        session.undo(); session.set("height.seed", 1); seen.push(session.redo()); return seen"""
    result = run(node, body)
    steps = [[0.8, 7, 900], [0.8, 7, 800], [0.8, None, 800], [None, None, 800]]
    assert [[a, b, c] for a, b, c in result[:-1]] == steps + steps[-2::-1]
    assert result[-1] is False, "a new change ends what was undone"


def test_a_pause_ends_a_step(node: Node):
    body = """session.set("height.level", 0.3); session.settle(); session.set("height.level", 0.4);
        session.undo(); return leaves()["height.level"]"""
    assert run(node, body) == 0.3


def test_a_preset_sets_values_and_the_terrain_as_one_step(node: Node):
    body = """session.set("height.seed", 9);
        session.setAll(Object.entries(page.sketches[0].presets[0].values));
        const there = [leaves(), terrain().relief]; session.undo(); return [there, leaves()]"""
    there, back = run(node, body)
    assert there == [{"height.seed": 9, "height.level": 0.75, "height.inner.level": 0.75}, 1200]
    assert back == {"height.seed": 9}


def test_another_technique_keeps_what_it_has_as_well(node: Node):
    body = """session.set("height.level", 0.5); session.set("light.turn", 30); session.set("relief", 900);
        session.stop("height", 3); session.choose(1);
        const there = [session.sketch.name, leaves(), terrain().relief, session.steps.size];
        session.undo(); return [there, [session.sketch.name, leaves()], news]"""
    there, back, news = run(node, body)
    assert there == ["ridges", {"height.level": 0.5, "height.inner.level": 0.5}, 900, 0]
    assert back == ["hills", {"height.level": 0.5, "height.inner.level": 0.5, "light.turn": 30}]
    assert news.count("sketch") == 2


def test_a_button_is_true_for_a_frame_at_least(node: Node):
    body = """session.press("light.flash", true); session.press("light.flash", false);
        const seen = [leaves()["light.flash"], session.drawn(), leaves()["light.flash"]];
        session.press("light.flash", true); seen.push(session.drawn(), leaves()["light.flash"]);
        return seen"""
    assert run(node, body) == [True, True, None, False, True]


def test_button_pressed_during_draw_is_seen_by_next_picture(node: Node):
    body = """leaves(); session.press("light.flash", true); session.press("light.flash", false);
        return [session.drawn(), leaves()["light.flash"], session.drawn(), leaves()["light.flash"]]"""
    assert run(node, body) == [False, True, True, None]


# ── links ────────────────────────────────────────────────────────────────────


def test_a_link_brings_everything_back(node: Node):
    body = """session.choose(1); session.choose(0);
        session.set("height.level", 0.123456789); session.set("ground.grass", [1, 0.5, 0]);
        session.set("ground.kind", 1); session.set("ground.rocks", false);
        session.set("light.sun", [10, -5.5]); session.set("extent", [2000, 3000]);
        const camera = { azimuth: 12.345, elevation: -3, distance: 99, target: [1, 2, 3], field_of_view: 50 };
        session.setCamera(camera);
        session.setTime(2.5);
        const text = link(), before = session.state(); session.resetAll(); const found = read("#" + text);
        return [text, before, session.state(), found.refused, link()]"""
    text, before, after, refused, again = run(node, body)
    assert refused == [] and text == again
    assert re.fullmatch(r"[\w.,=&%+/#-]+", text) and "#" not in text
    assert after == before | {"camera": before["camera"] | {"azimuth": 12.35}}


def test_what_is_as_in_the_sketch_is_not_in_the_link(node: Node):
    assert run(node, "session.set('height.level', 0.3); session.reset('height.level'); return link()") == ""


HOSTILE = [
    "height.level=<img src=x onerror=alert(1)>", "height.level=1e999", "height.level=NaN", "height.level=5",
    "__proto__=1", "constructor=1", "__proto__.polluted=1", "toString=1", "height.seed=1.5", "ground.kind=7",
    "light.sun=1", "ground.photo=http://example.com/", "camera=1,2", "camera=1,999,3,40", "camera=a,b,c,d",
    "camera=1,2,3,Infinity,1,1,40", "time=-1", "time=x", "time=", "size=99999,3", "size=-1,-1",
    "%E0%A4%A", "&&&===", "=", "sketch=99", "sketch=-1", "relief=-1", "height.level=" + "9" * 100000,
    "&".join(["a=b"] * 20000),
]  # fmt: skip


@pytest.mark.always
@pytest.mark.parametrize("text", HOSTILE, ids=[text[:24] for text in HOSTILE])
def test_a_hostile_link_does_no_harm(node: Node, text: str):
    body = """const before = session.state(); const found = read("#" + steps + "&height.seed=4");
        const { "height.seed": seed, ...rest } = leaves();
        return [seed ?? null, rest, session.state().camera, terrain(), {}.polluted ?? null,
                before.time === session.time, found.refused.every((name) => name.length <= 80)]"""
    seed, rest, camera, terrain, polluted, same_time, short = run(node, body, steps=text)
    assert seed == (4 if len(text) < 30000 else None), "what is right beside it is taken"
    assert rest == {} and camera is None and polluted is None and same_time and short
    assert terrain == {"size": [257, 257], "extent": [4096, 4096], "relief": 800, "base_elevation": 100}


@pytest.mark.slow
@pytest.mark.parametrize("step", [18, pytest.param(6, marks=pytest.mark.slow)])
def test_what_is_copied_is_what_python_takes(node: Node, exporting: Engine, step: int):
    """Three parameters of some shipped sketches, changed: as --set, and as a preset of the file."""
    at: dict[str, Any] = {"frame": (320, 180), "engine": exporting}
    pages = {name: page_data([load(name)], **at) for name in shipped_sketches()[::step]}
    body = """const isRanged = (one) => !one.locked && one.exported && one.targets.length
            && one.ranges[0]?.[1] > one.ranges[0]?.[0] && typeof one.value === "number";
        const rows = session.rows().filter(isRanged).slice(0, 3);
        for (const one of rows) { session.set(one.path, one.ranges[0][1]); session.settle(); }
        session.set("relief", 123.5);
        return [address.asWords(session), address.asToml(session, 'mine "1"'), rows.length]"""
    seen = 0
    for name, page in pages.items():
        words, toml, count = run(node, body, page)
        sketch = load(name)
        names = dict(word.partition("=")[::2] for word in re.findall(r'--set "?([^" ]+)', words))
        preset = tomllib.loads(toml)["preset"][0]
        assert preset["name"] == 'mine "1"'
        for values in (names, preset["set"]):
            assert len(values) == len(set(values)) and (count == 0 or len(values) >= 1)
            made = sketch.with_values(values)
            assert made.terrain.relief == 123.5
        seen += count
    assert seen > 60 // step
