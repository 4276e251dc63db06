"""Show over the picture which pass made the first number that is not finite, and lead to its texture."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.engine.non_finite import NotFinite
from playground.studio import theme
from playground.studio.draw import OVERLAY, Area, button, window, wrapped
from playground.studio.problems.non_finite import FiniteWatch, summary
from playground.studio.session import Session
from playground.studio.theme import Theme

_MAGENTA = (1.0, 0.42, 1.0)  # readable on dark ground; the texels themselves are as the map has them
_RING = 14.0  # [units of scale 1] radius of the mark around the first texel


def ref_of(first: NotFinite) -> str:
    """Return the texture that it is in, as a map takes it."""
    return f"{first.path}:{first.output}"


def place_in(first: NotFinite, area: Area) -> tuple[float, float]:
    """Return where a map over an area shows the first texel, in the window's units, y from above."""
    x, y, wide, high = area
    across, up = first.size
    worst = max(across / wide, up / high)
    east = (first.texel[0] + 0.5 - across / 2) / worst + wide / 2
    north = (first.texel[1] + 0.5 - up / 2) / worst + high / 2
    return x + east, y + high - north


def draw_not_finite(watch: FiniteWatch, session: Session, look: Theme, area: Area) -> None:
    """Draw the sentence in the picture's upper left corner; a click goes to the texture and back."""
    if not watch.non_finite:
        return
    first, shown = watch.non_finite[0], session.view.map
    ref = ref_of(first)
    shows = shown is not None and shown.ref == ref
    if shows:
        centre = ImVec2(*place_in(first, area))
        draw = imgui.get_background_draw_list()
        draw.add_circle(centre, _RING * look.scale, theme.packed((0, 0, 0), 0.8), 0, 4 * look.scale)
        draw.add_circle(centre, _RING * look.scale, theme.packed(_MAGENTA), 0, 2 * look.scale)
    margin = 14 * look.scale
    imgui.set_next_window_pos(ImVec2(area[0] + margin, area[1] + margin))
    widest = max(min(area[2] - 2 * margin, 460 * look.scale), 80.0)
    imgui.set_next_window_size_constraints(ImVec2(0, 0), ImVec2(widest, area[3]))
    ground = theme.colour(theme.GROUND, 0.92)
    with window("not finite", OVERLAY, ground=ground, rounding=6 * look.scale):
        with wrapped(widest - 2 * imgui.get_style().window_padding.x):
            imgui.text_colored(theme.colour(_MAGENTA), summary(watch.non_finite))
        imgui.set_item_tooltip("\n".join(map(str, watch.non_finite)))
        if shows:
            if button("Back to the picture", small=True):
                session.show(None)
        elif session.can_show(ref):
            if button("Show it", "That texture from above, those texels in magenta", small=True):
                session.show(ref)
