"""Parts of the small sketches that tests write, as their TOML has them."""

from __future__ import annotations

SMALL_VIEW = """[view]
use = "view/terrain"
set = { grid = 9 }
"""
"""A view of a terrain that draws next to nothing."""


def passes(**uses: str | tuple[str, ...]) -> str:
    """Return passes by their names, each with the technique that it uses and what other lines it has."""
    text = ""
    for name, value in uses.items():
        use, *lines = (value,) if isinstance(value, str) else value
        text += f'[[pass]]\nname = "{name}"\nuse = "{use}"\n' + "".join(f"{line}\n" for line in lines)
    return text


def map_of(shown: str, channel: str = "") -> str:
    """Return the view that shows a texture from above, in grey or a channel as it is."""
    text = f'[view]\nuse = "view/map"\ninputs = {{ shown = "{shown}" }}\n'
    return text + (f'set = {{ channel = "{channel}" }}\n' if channel else "")


def map_of_height(use: str = "./terrain", channel: str = "") -> str:
    """Return a pass "height" and the view that shows it from above."""
    return passes(height=use) + map_of("height", channel)


TERRAIN_IN_3D = (
    "format = 1\nsize = 33\n" + passes(height="./terrain") + '[view]\nuse = "view/terrain"\nsamples = 1\n'
)
"""A sketch of one kernel, terrain.glsl, in the 3D view."""

LIT_NOISE = passes(height="generation/white_noise", light="lighting/l_dot_n")
"""The cheapest terrain of the library and the cheapest light."""
