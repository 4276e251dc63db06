"""Channels in a real window: chosen in the panel, fed from a dropped image, saved as a sketch."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.sketch.load import load
from playground.studio.channels.channels import channels

from .screen import ON_LINUX, Program, Screen

pytestmark = [*ON_LINUX, pytest.mark.slow, pytest.mark.room("dialects")]

SCREEN = 900, 640  # [pixels]
SHADER = """void mainImage(out vec4 c, in vec2 p) {
    c = p.x < 0.5 * iResolution.x ? texture(iChannel0, p) : texture(iChannel1, p);
}
"""
FILES = {"halves.frag": SHADER}
RUN = """
import sys
from pathlib import Path
from playground.studio import app
draw_frame = app.Live._draw_frame
def with_drop(live):
    drop = Path(sys.argv[2])
    if drop.exists() and live.session.plan is not None:
        live.place._dropped.append(Path(drop.read_text()))
        drop.unlink()
    draw_frame(live)
app.Live._draw_frame = with_drop
sys.exit(app.run(sys.argv[1], size=(900, 640), time_limit=300))
"""
CHOOSER, BLACK = (200, 313), (150, 342)  # of the first channel, at scale 1
LATER = 412, 341  # the second channel in the menu of a drop
LEFT, RIGHT = (500, 420), (500, 760)  # row, column of a pixel in each half


@pytest.fixture
def program(screen: Screen, folder: Path) -> Iterator[Program]:
    command = [sys.executable, "-c", RUN, str(folder / "halves.frag"), str(folder / "drop.txt")]
    made = Program(screen, folder, command, folder)
    yield made
    made.close()


def pixel(screen: Screen, position: tuple[int, int]) -> tuple[int, ...]:
    return tuple(int(n) for n in screen.pixels()[position])


def test_a_channel_is_chosen_and_a_dropped_image_feeds_the_other(
    screen: Screen, folder: Path, program: Program
) -> None:
    first = program.wait(lambda now: now["draws"] > 0)["picture"]
    assert pixel(screen, LEFT) != (0, 0, 0)
    screen.do("mousemove", *CHOOSER, "sleep", 0.5, "click", 1)
    program.wait(lambda now: "popup" in now["layers"])
    screen.do("mousemove", *BLACK, "sleep", 0.5, "click", 1)
    black = program.wait(lambda now: now["picture"] != first and now["stage"] == "NONE")["picture"]
    assert pixel(screen, LEFT) == (0, 0, 0) and pixel(screen, RIGHT) != (0, 0, 0)

    write_png(folder / "green.png", np.full((6, 5, 4), (0, 255, 0, 255), np.uint8))
    (folder / "drop.txt").write_text(str(folder / "green.png"), "utf-8")
    screen.do("mousemove", 700, 600)
    program.wait(lambda now: "popup" in now["layers"])
    screen.do("mousemove", *LATER, "sleep", 0.5, "click", 1)
    program.wait(lambda now: now["picture"] != black and now["stage"] == "NONE")
    assert pixel(screen, LEFT) == (0, 0, 0) and pixel(screen, RIGHT) == (0, 255, 0)

    screen.do("mousemove", 700, 500, "key", "ctrl+z")
    program.wait(lambda now: now["picture"] == black)
    screen.do("key", "ctrl+z")
    program.wait(lambda now: now["picture"] == first)
    screen.do("key", "ctrl+q")
    assert program.ended() == 0, program.complaint()


def test_ctrl_s_makes_a_sketch_of_a_shader_alone(screen: Screen, folder: Path, program: Program) -> None:
    first = program.wait(lambda now: now["draws"] > 0)["picture"]
    screen.do("mousemove", *CHOOSER, "sleep", 0.5, "click", 1)
    program.wait(lambda now: "popup" in now["layers"])
    screen.do("mousemove", *BLACK, "sleep", 0.5, "click", 1)
    black = program.wait(lambda now: now["picture"] != first and now["stage"] == "NONE")["picture"]
    screen.do("mousemove", 560, 450, "key", "ctrl+s")
    program.wait(lambda now: any("saved halves_sketch.toml" in text for text in now["notices"]))
    now = program.wait(lambda now: now["stage"] == "NONE")
    assert now["picture"] == black and not now["error"]
    assert (folder / "halves.frag").read_text("utf-8") == SHADER
    assert [c.source for c in channels(load(folder / "halves_sketch.toml"))] == [
        "foreign/black",
        "foreign/noise",
    ]
