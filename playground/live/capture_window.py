"""The capture's window: what to capture, how far it is, and where it went."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.capture.job import FILM, KINDS, PICTURE, PICTURES, SHEET
from playground.capture.video import QUALITIES
from playground.images.extensions import VIDEO_ENDINGS
from playground.live import theme
from playground.live.panel_rows import row
from playground.live.theme import Theme
from playground.paths import shown
from playground.workbench.actions import Actions
from playground.workbench.captures import (
    MULTIPLES,
    Capturing,
    Wish,
    open_folder,
    parts_of,
    summary,
    sweep_text,
)
from playground.workbench.parameter_list import Listing

_NAMES = {PICTURE: "Picture", PICTURES: "Numbered pictures", FILM: "Film", SHEET: "Sheet of a sweep"}
_ENDINGS = list(VIDEO_ENDINGS)


def draw_capture(state: Capturing, actions: Actions, look: Theme) -> None:
    """Draw the window, while it is asked for."""
    if not state.shown:
        return
    room = imgui.get_main_viewport().size
    imgui.set_next_window_pos(ImVec2(room.x / 2, room.y / 2), imgui.Cond_.appearing, ImVec2(0.5, 0.5))
    imgui.set_next_window_size(ImVec2(min(430 * look.scale, room.x - 16), 0))
    imgui.push_style_color(imgui.Col_.window_bg, theme.colour((0.125, 0.135, 0.145), 0.98))
    flags = imgui.WindowFlags_.no_collapse | imgui.WindowFlags_.no_resize
    flags |= imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_nav_inputs
    shows, stays = imgui.begin("Capture###capture", True, flags)
    state.shown = bool(stays)
    if shows:
        imgui.begin_disabled(state.working is not None)
        _wish(state.wish, actions)
        imgui.end_disabled()
        imgui.separator()
        if state.working is not None:
            _at_work(state, look)
        else:
            _at_rest(state, actions)
    imgui.end()
    imgui.pop_style_color()


def _wish(wish: Wish, actions: Actions) -> None:
    with row("What", "From the sketch as it stands, with all that is set by hand"):
        if imgui.begin_combo("##kind", _NAMES[wish.kind]):
            for kind in KINDS:
                if imgui.selectable(_NAMES[kind], kind == wish.kind)[0]:
                    wish.kind = kind
            imgui.end_combo()
    of = "320 pixels wide" if wish.kind == SHEET else "the window's"
    with row("Size", "A picture larger than a texture is drawn in parts"):
        named = f"{wish.multiple} × {of}" if wish.multiple else "typed"
        if imgui.begin_combo("##multiple", named):
            for multiple in (*MULTIPLES, 0):
                text = f"{multiple} × {of}" if multiple else "typed"
                if imgui.selectable(text, multiple == wish.multiple)[0]:
                    wish.multiple = multiple
            imgui.end_combo()
    if not wish.multiple:
        with row("Pixels", "Width and height"):
            changed, size = imgui.input_int2("##pixels", list(wish.size))
            if changed:
                wish.size = max(size[0], 1), max(size[1], 1)
    if wish.kind in (FILM, PICTURES):
        _film(wish)
    if wish.kind == SHEET:
        for number in range(2):
            _sweep(wish, number, actions)


def _film(wish: Wish) -> None:
    with row("From", "The time of the first picture"):
        _, start = imgui.input_float("##start", wish.start, 0.0, 0.0, "%.2f s")
        wish.start = max(start, 0.0)
    with row("Seconds", "How long; 0: to the last keyframe, or ten where there is none"):
        _, seconds = imgui.input_float("##seconds", wish.seconds, 0.0, 0.0, "%.2f s")
        wish.seconds = max(seconds, 0.0)
    with row("Pictures a second", "Picture n is that of the time n / so many, whatever drawing takes"):
        _, fps = imgui.input_int("##fps", wish.fps, 0)
        wish.fps = min(max(fps, 1), 1000)
    if wish.kind == FILM:
        with row("Format", "By PyAV"):
            if imgui.begin_combo("##ending", VIDEO_ENDINGS[wish.ending]):
                for ending in _ENDINGS:
                    if imgui.selectable(f"{ending}  {VIDEO_ENDINGS[ending]}", ending == wish.ending)[0]:
                        wish.ending = ending
                imgui.end_combo()
        with row("Quality", "The better, the larger"):
            if imgui.begin_combo("##quality", wish.quality):
                for quality in QUALITIES:
                    if imgui.selectable(quality, quality == wish.quality)[0]:
                        wish.quality = quality
                imgui.end_combo()


def _sweep(wish: Wish, number: int, actions: Actions) -> None:
    note = "A parameter and its values, as light.gain=0.5..3,9 or light.gain=1,2,4"
    with row("Sweep" if number == 0 else "And down", note):
        wide = imgui.calc_item_width() - imgui.get_frame_height()
        imgui.set_next_item_width(wide)
        hint = "a parameter" if number == 0 else "a second, for a grid"
        _, wish.sweeps[number] = imgui.input_text_with_hint(f"##sweep{number}", hint, wish.sweeps[number])
        imgui.same_line(0, 0)
        draft = actions.session.shown
        if imgui.begin_combo(f"##swept{number}", "", imgui.ComboFlags_.no_preview):
            sections = Listing().sections(draft) if draft is not None else ()
            for item in (item for section in sections for item in section.items):
                for part in parts_of(item.parameter):
                    name = f"{item.path}.{part}" if part else item.path
                    if imgui.selectable(name, False)[0]:
                        wish.sweeps[number] = sweep_text(item.path, item.parameter, part)
            imgui.end_combo()


def _at_work(state: Capturing, look: Theme) -> None:
    assert state.working is not None
    done, of = state.working.progress
    text = f"{done} of {of}" if of else "beginning …"
    imgui.progress_bar(done / of if of else 0.0, ImVec2(-90 * look.scale, 0), text)
    imgui.same_line()
    imgui.begin_disabled(state.working.stopping)
    if imgui.button("Cancel", ImVec2(-1, 0)):
        state.working.stop()
    imgui.end_disabled()


def _at_rest(state: Capturing, actions: Actions) -> None:
    if imgui.button("Capture"):
        state.start(actions)
    imgui.same_line()
    imgui.text_disabled(summary(state.wish, actions))
    if state.failed:
        imgui.push_text_wrap_pos(0)
        imgui.text_colored(theme.colour(theme.ALARM), state.failed)
        imgui.pop_text_wrap_pos()
    elif state.last is not None:
        imgui.push_text_wrap_pos(0)
        imgui.text_unformatted(f"saved {shown(state.last)}")
        imgui.pop_text_wrap_pos()
        if imgui.button("Open folder"):
            complaint = open_folder(state.last)
            if complaint:
                actions.say(complaint)
