"""What the editor is made of, without a page: notices, groups of files, what worked, how long."""

from __future__ import annotations

from typing import Any

import pytest

from .node import Node

HEADER = """#pragma kernel(output = "h:r32f", \\
               repeat = "4")
uniform float level = 0.5; //! slider(0, 1) How high
uniform sampler2D height;
// uniform float not_this = 1.0;
float kernel(ivec2 texel) { return level; }
"""


@pytest.mark.parametrize(
    ("old", "new", "result"),
    [
        ("return level", "return 2.0 * level", []),
        ('repeat = "4"', 'repeat = "5"', [("header", [])]),
        ("\\\n               repeat", "repeat", []),
        ("slider(0, 1)", "slider(0, 2)", [("annotation", [])]),
        ("0.5;", "0.75;", [("initial", ["level"])]),
        (
            "uniform sampler2D",
            "uniform vec2 a = vec2(1.0, 2.0), b;\nuniform sampler2D",
            [("added", ["a", "b"])],
        ),
        ("uniform float level = 0.5;", "", [("removed", ["level"])]),
        ("not_this = 1.0", "not_this = 2.0", []),
        ("uniform sampler2D height", "uniform sampler2D other", []),
    ],
)
def test_what_python_reads_is_noticed(node: Node, old: str, new: str, result: list[tuple[str, list[str]]]):
    assert old in HEADER
    said = node.call("sketch_files.js", "notices", HEADER, HEADER.replace(old, new))
    assert [(item["key"], item["names"]) for item in said] == result


def test_files_are_in_groups_own_ones_first(node: Node):
    shared = {
        "files": {
            "./a.glsl": "",
            "g/k.glsl": "",
            "n/h.glsl": "",
            "n/b.glsl": "",
            "m/map.glsl": "",
            "x.toml": "",
        },
        "includes": {"g/k.glsl": {"n/h.glsl": "n/h.glsl"}, "n/h.glsl": {"n/b.glsl": "n/b.glsl"}},
    }
    kernels = [{"file": "g/k.glsl"}, {"file": "./a.glsl"}, {"file": "m/map.glsl"}, {"file": "x.toml"}]
    nodes = [
        {"path": "a", "kernel": 0},
        {"loop": True, "body": [{"path": "l", "kernel": 1}, {"path": "s", "kernel": 3}]},
    ]
    result = node.call("sketch_files.js", "fileGroups", {"kernels": kernels, "nodes": nodes}, shared)
    assert result == [
        {"key": "ownFiles", "files": ["./a.glsl"]},
        {"key": "kernelFiles", "files": ["g/k.glsl"]},
        {"key": "libraryFiles", "files": ["n/b.glsl", "n/h.glsl"]},
    ]


GUARD = """async (steps, refuse, load) => {
    const { createGuard } = await load("recovery.js");
    const kept = new Map(), tab = { name: "" };
    const storage = refuse === "storage" || refuse === "both" ? null : {
        getItem: (key) => kept.get(key) ?? null, removeItem: (key) => kept.delete(key),
        setItem: (key, value) => { if (refuse === "writing") throw new Error("full"); kept.set(key, value); },
    };
    const open = (key = "k") => createGuard(key, { storage, tab: refuse === "both" ? null : tab });
    let guard = open();
    for (const [name, ...values] of steps) {
        if (name === "reload") guard = open(...values);
        else guard[name](...values);
    }
    return { place: guard.place, good: guard.good, left: guard.left, size: kept.size, name: tab.name };
}"""


@pytest.mark.parametrize("refuse", ["", "storage", "writing"])
def test_what_was_tried_is_known_after_a_reload(node: Node, refuse: str):
    steps: list[Any] = [
        ["trying", "a", "1", {}],
        ["worked", {"a": "1"}],
        ["trying", "a", "endless", {"a": "1"}],
        ["reload"],
    ]
    if (
        refuse == "writing"
    ):  # the first write tells that there is no room: from then on the tab's name is used
        steps[-1] = ["trying", "a", "endless", {"a": "1"}]
        result = node.run(GUARD, steps, refuse)
        assert result["place"] == "name" and "endless" in result["name"]
        return
    result = node.run(GUARD, steps, refuse)
    assert result["left"] == {"file": "a", "text": "endless"} and result["good"] == {"a": "1"}
    assert result["place"] == ("name" if refuse else "storage")
    after = node.run(GUARD, [*steps, ["forget"], ["reload"]], refuse)
    assert after["left"] is None and after["good"] == {"a": "1"}
    clean = node.run(GUARD, [*steps, ["worked", {}], ["reload"]], refuse)
    assert clean["good"] == {} and clean["size"] == 0 and clean["name"] == ""


def test_another_page_s_texts_are_left_alone(node: Node):
    result = node.run(GUARD, [["trying", "a", "1", {}], ["reload", "another"]], "storage")
    assert result["left"] is None and result["name"].startswith("playground k ")
    assert node.run(GUARD, [["worked", {"a": "1"}], ["reload"]], "both") == {
        "place": "", "good": {}, "left": None, "size": 0, "name": ""
    }  # fmt: skip


def test_a_key_follows_the_texts(node: Node):
    keys = [node.call("recovery.js", "keyOf", "s", files) for files in ({"a": "1"}, {"a": "2"}, {"b": "1"})]
    assert len(set(keys)) == 3
    assert node.call("recovery.js", "keyOf", "s", {"a": "1", "b": "2"}) == node.call(
        "recovery.js", "keyOf", "s", {"b": "2", "a": "1"}
    )


# A clock and a player whose pictures take a constant and a fraction of their pixels, the first 30 s besides.
PACED = """async (constant, perPixel, limit, load) => {
    const { estimate, smallerFrame } = await load("recovery.js");
    let clock = 0;
    const drawn = [], state = { frame: [640, 360] };
    const renderSoon = async () => {
        clock += 1000 * (constant + perPixel * state.frame[0] * state.frame[1] + (drawn.length ? 0 : 30));
        drawn.push([...state.frame]);
    };
    const player = { state, sketch: state, renderSoon };
    const seconds = await estimate(player, async () => {}, { limit, now: () => clock });
    return { seconds, drawn, state, smaller: smallerFrame(seconds, state.frame, limit) };
}"""


def test_a_time_is_told_from_smaller_pictures(node: Node):
    per_pixel = 20 / (640 * 360)
    result = node.run(PACED, 0.25, per_pixel, 4)
    assert result["seconds"] == pytest.approx(20.25, rel=0.02)
    assert result["drawn"] == [[40, 23], [80, 45], [160, 90]]
    assert result["state"] == {"frame": [640, 360]}
    width, height = result["smaller"]
    assert width / height == pytest.approx(640 / 360, rel=0.01)
    assert 0.25 + per_pixel * width * height == pytest.approx(2, rel=0.15)


def test_quick_picture_needs_no_smaller_frame_slow_stops_early(node: Node):
    assert node.run(PACED, 0.01, 1e-7, 4)["smaller"] is None
    slow = node.run(PACED, 0, 0.02, 4)
    assert len(slow["drawn"]) == 2 and slow["seconds"] > 1000
