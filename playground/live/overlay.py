"""What lies over the picture: a sentence while there is none, and notices that fade."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.live import theme
from playground.live.theme import Theme
from playground.workbench.actions import Actions
from playground.workbench.session import Session

_FADE = 1.0  # [s]
PATIENCE = 0.3
"""[s] without a new picture after which the window says what is tried."""
Area = tuple[float, float, float, float]  # x, y from above, width, height, in the window's units


def draw_waiting(text: str, look: Theme, area: Area) -> None:
    """Write a sentence in the middle of the picture, while there is none."""
    x, y, wide, high = area
    size = imgui.calc_text_size(text)
    place = ImVec2(x + (wide - size.x) / 2, y + (high - size.y) / 2)
    imgui.get_background_draw_list().add_text(place, theme.packed(theme.DIM), text)


def draw_trial(session: Session, look: Theme, area: Area) -> None:
    """Say that a trial is running, and for what, once it has taken so long that a person wonders."""
    trying = session.drafts.checking
    if trying is None or trying[1] < PATIENCE:
        return
    margin, padding = 14 * look.scale, 9 * look.scale
    text = trial_text(*trying)
    size = imgui.calc_text_size(text)
    low = ImVec2(area[0] + margin, area[1] + margin)
    high = ImVec2(low.x + size.x + 2 * padding, low.y + size.y + 2 * padding)
    draw = imgui.get_foreground_draw_list()
    draw.add_rect_filled(low, high, theme.packed(theme.GROUND, 0.92), 6 * look.scale)
    draw.add_text(ImVec2(low.x + padding, low.y + padding), theme.packed(theme.WARM), text)


def trial_text(subject: str, seconds: float) -> str:
    """Return "trying land.glsl … 3 s"."""
    return f"trying {subject} …" + (f" {int(seconds)} s" if seconds >= 1 else "")


def draw_notices(actions: Actions, look: Theme, area: Area) -> None:
    """Draw the notices in the upper right corner; each fades at its end."""
    x, y, wide, _ = area
    margin, padding = 14 * look.scale, 9 * look.scale
    room = max(min(wide - 2 * margin, 560 * look.scale) - 2 * padding, 80.0)
    top = y + margin
    draw = imgui.get_foreground_draw_list()
    for notice in reversed(actions.notices):
        alpha = min(max(notice.until - actions.now(), 0.0) / _FADE, 1.0)
        size = imgui.calc_text_size(notice.text, False, room)
        right = x + wide - margin
        low = ImVec2(right - size.x - 2 * padding, top)
        high = ImVec2(right, top + size.y + 2 * padding)
        draw.add_rect_filled(low, high, theme.packed(theme.GROUND, 0.92 * alpha), 6 * look.scale)
        draw.add_text(
            imgui.get_font(),
            imgui.get_font_size(),
            ImVec2(low.x + padding, low.y + padding),
            theme.packed(theme.INK, alpha),
            notice.text,
            room,
        )
        top = high.y + 6 * look.scale
