"""A page with every widget, over a player that draws without WebGL (fake_page.js): one file, as an export."""

from __future__ import annotations

import base64
import html
import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np

import playground.publish.web
from playground.data.image_files import encode_png

HERE = Path(__file__).parent
WEB = Path(playground.publish.web.__file__).parent
HOSTILE = '</script><img src=x onerror="document.title=1"><b>'


def row(path: str, type: str, widget: str, value: object, **more: Any) -> dict[str, Any]:
    """Return a row of the panel: schema.js ``Shown``."""
    pass_, _, name = path.rpartition(".")
    result = {"path": path, "pass": pass_.split(".")[0], "label": name.replace("_", " ").capitalize()}
    result |= {"type": type, "widget": widget, "unit": "", "group": "", "description": "", "parts": []}
    result |= {"ranges": [], "step": None, "choices": [], "exported": pass_.count(".") == 0, "main": 0}
    return result | {"locked": "", "value": value, "targets": [path]} | more


def rows() -> list[dict[str, Any]]:
    """Return one row of each widget, and some inside."""
    level = row("height.level", "float", "slider", 0.25, ranges=[[0, 1]], unit="m", main=1)
    level |= {"description": "How high the hills are.", "targets": ["height.level", "height.inner.level"]}
    return [
        level,
        row("height.seed", "int", "slider", 3, ranges=[[0, 10]], main=1),
        row("height.scale", "float", "log_slider", 10.0, ranges=[[1, 1000]], unit="m", main=1),
        row("height.free", "float", "number", 2.5),
        row("height.offset", "vec2", "slider", [0.25, 0.5], ranges=[[0, 1], [0, 1]], parts=["from", "to"]),
        row("height.inner.level", "float", "slider", 0.25, ranges=[[0, 1]], exported=False),
        row("height.inner.octaves", "int", "slider", 4, ranges=[[1, 12]], exported=False, group="Detail"),
        row("ground.grass", "vec3", "colour", [0.25, 0.35, 0.1], main=1),
        row("ground.haze", "vec4", "colour", [0.5, 0.5, 0.5, 1.0], raw=True, group="Far away"),
        row("ground.kind", "int", "menu", 0, choices=["soft", "sharp"], group="Far away"),
        row("ground.rocks", "bool", "checkbox", True),
        row("ground.middle", "vec2", "point", [0.5, 0.5]),
        row("ground.photo", "sampler2D", "file", "photo.jpg", locked="An image file is part of the page."),
        row("light.sun", "vec2", "direction", [120.0, 40.0], unit="degrees", main=1),
        row("light.turn", "float", "angle", 0.0, ranges=[[-360, 360]]),
        row("light.flash", "bool", "button", False),
        row("view.divide", "float", "divider", 0.5, ranges=[[0, 1]]),
    ]


def page(**more: Any) -> dict[str, Any]:
    """Return a page with two sketches: schema.js ``Page``; ``more`` of the first."""
    shown = rows()
    map_shown = [
        row("map.channel", "int", "menu", 1, choices=["colour", "red", "green", "blue", "alpha"]),
        row("map.lowest", "float", "number", 0.0, group="Range"),
        row("map.highest", "float", "number", 1.0, group="Range"),
    ]
    first = {
        "format": 1,
        "name": "hills",
        "title": "Hills at noon",
        "file": "hills.toml",
        "frame": [640, 360],
        "time": 0,
        "steps": {},
        "samples": 4,
        "terrain": {
            "size": [257, 257],
            "extent": [4096, 4096],
            "relief": 800,
            "base_elevation": 100,
            "locked": "",
        },
        "camera": {
            "azimuth": 200,
            "elevation": 30,
            "distance": 5000,
            "target": None,
            "field_of_view": 40,
        },
        "picture": {"path": "view", "output": "frame"},
        "kernels": [{"repeat": 24}],
        "nodes": [],
        "passes": {"height": {"where": ""}, "view": {"where": ""}},
        "values": {leaf: item["value"] for item in shown for leaf in item["targets"]},
        "shown": shown,
        "presets": [{"name": "high", "values": {"height.level": 0.75, "relief": 1200}}],
        "tracks": [],
        "duration": 0,
        "moves": False,
        "rules": [],
        "textures": [
            {"ref": "height:height", "path": "height", "output": "height", "label": "Height", "height": True},
            {"ref": "view:f", "path": "view", "output": "f", "label": "Picture", "height": False},
        ],
        "map": {"kernel": 0, "input": "shown", "shown": map_shown} | {"values": {"map.channel": 1}},
        "choices": [
            {
                "pass": "height",
                "label": "Height",
                "now": "Sines",
                "others": [{"use": "other", "title": "Ridges", "sketch": 1}],
            }
        ],
        "notes": ["Elevation is part of the page: its size cannot be changed."],
    } | more
    other = {**first, "name": "ridges", "title": "Ridges", "choices": [], "shown": shown[:5]}
    return {"format": 1, "sketches": [first, other], "shared": {}}


def build(folder: Path) -> Path:
    """Bundle the fake player's script; raises where esbuild cannot."""
    out = folder / "fake_page.out.js"
    subprocess.run(["node", "build.mjs", str(HERE / "fake_page.js"), str(out)], cwd=WEB, check=True)
    return out


def write(script: Path, target: Path, data: dict[str, Any]) -> Path:
    """Write the page as one file with a strict policy, as an export has."""
    green = np.full((90, 160, 3), (90, 110, 70), np.uint8)
    green[:, ::8] //= 2
    poster = base64.b64encode(encode_png(green)).decode()
    json_text = json.dumps(data).replace("<", "\\u003c")
    policy = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"
    title = html.escape(data["sketches"][0]["title"])
    target.write_text(
        f"""<!doctype html><html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1"><title>{title}</title>
<link rel="icon" href="data:,"><style>{(WEB / "bundle" / "page.css").read_text("utf-8")}</style></head>
<body><main id="playground"><img id="playground-poster" alt="{title}" src="data:image/png;base64,{poster}">
</main><script type="application/json" id="playground-page">{json_text}</script>
<script>{script.read_text("utf-8")}</script></body></html>""",
        "utf-8",
    )
    return target
