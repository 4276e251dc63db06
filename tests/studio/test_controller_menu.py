"""A right click on a parameter's row: learn a MIDI controller, stop, forget it."""

from __future__ import annotations

from playground.studio.remote.controllers import SETTLES, Source, file_of, read_bindings

from ..sketch_texts import map_of, passes
from .panel_desk import Bare

TERRAIN = """#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1)
uniform vec2 sun = vec2(135.0, 40.0); //! direction
float kernel(ivec2 texel) { return level + 0.0 * sun.x; }
"""
FILES = {
    "terrain.glsl": TERRAIN,
    "sketch.toml": "format = 1\nsize = 9\n" + passes(height="./terrain") + map_of("height"),
}
LEVEL, SUN = "##height.level", "##height.sun-azimuth"
KNOB = Source(2, "control", 7)


def test_a_controller_is_learned_and_forgotten_by_the_menu(bare: Bare) -> None:
    controllers = bare.bench.controllers
    bare.click(LEVEL, 0.2, button=1)
    bare.click("Learn MIDI")
    assert controllers.learning is None, "nothing listens here"
    assert "MIDI cannot be received here" in bare.bench.notices.items[-1].text

    controllers.listen = lambda: ""
    bare.click(LEVEL, 0.2, button=1)
    assert "Unlearn MIDI" not in bare.places
    bare.click("Learn MIDI")
    assert controllers.learning is not None and controllers.learning.path == "height.level"
    bare.click(LEVEL, 0.2, button=1)
    bare.click("Stop learning MIDI")
    assert controllers.learning is None

    bare.click(LEVEL, 0.2, button=1)
    bare.click("Learn MIDI")
    controllers.take([(KNOB, 3)])
    bare.run_frames(1, step=SETTLES + 0.01)
    controllers.update()
    (binding,) = read_bindings(file_of(bare.session.path))
    assert (binding.path, binding.source) == ("height.level", KNOB)

    bare.click(LEVEL, 0.2, button=1)
    bare.click("Unlearn MIDI")
    assert controllers.bindings == () and not file_of(bare.session.path).exists()


def test_each_part_of_a_vector_is_learned_by_itself(bare: Bare) -> None:
    controllers = bare.bench.controllers
    controllers.listen = lambda: ""
    bare.click(SUN, 0.2, button=1)
    bare.click("Learn MIDI: elevation")
    assert controllers.learning is not None
    assert (controllers.learning.path, controllers.learning.part) == ("height.sun", "elevation")
