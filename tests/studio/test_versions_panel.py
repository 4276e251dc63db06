"""The filmstrip of versions under a mouse and keys: a menu on each picture, and its name typed."""

from __future__ import annotations

import time

import pytest
from imgui_bundle import imgui

from playground.studio.versions.panel import VersionsPanel

from ..sketch_texts import SMALL_VIEW, passes
from .panel_desk import Bare

FILES = {
    "hills.glsl": """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return float(texel.x) / float(size.x - 1); }
""",
    "sketch.toml": "format = 1\nsize = 33\nextent = 640.0\n" + passes(height="./hills") + SMALL_VIEW,
}


@pytest.mark.parametrize("by_keys", [False, True])
def test_a_version_is_named_from_its_menu(bare: Bare, by_keys: bool) -> None:
    versions = bare.bench.versions
    panel = VersionsPanel(bare.session.engine.ctx, versions)
    bare.bench.tabs.append(panel.tab)
    bare.bench.panes.show_strip("versions")
    end = time.monotonic() + 20.0  # a preview is drawn in full first
    while not versions.items and time.monotonic() < end:
        bare.run_frames(5)
        versions.update(idle=True)
    bare.run_frames(5)
    (version,) = versions.items
    if by_keys:
        bare.click(f"version {version.key}")
        bare.run_frames(30)
        for key in (imgui.Key.tab, imgui.Key.menu, imgui.Key.down_arrow, imgui.Key.enter):
            bare.key(key)
            bare.run_frames(3)
    else:
        bare.click(f"version {version.key}", button=1)
        bare.run_frames(3)
        bare.click("Name###Name")
    bare.run_frames(3)
    bare.type("peak")
    bare.key(imgui.Key.enter)
    bare.run_frames(3)
    assert [item.name for item in versions.items] == ["peak"]
    panel.release()
