"""The capture's window: what to capture, how far it is, and where it went."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.capture.job import FILM, KINDS, PICTURE, PICTURES, SHEET, JobProcess
from playground.capture.video import QUALITIES
from playground.data.image_files import VIDEO_ENDINGS
from playground.live import theme
from playground.live.draw import POPUP_COLOUR, QUIET, button, choose, disabled, styled, wrapped
from playground.live.panel_rows import row
from playground.live.theme import Theme
from playground.paths import shown
from playground.workbench.captures import MULTIPLES, Captures, Wish, open_folder, parts_of, sweep_text
from playground.workbench.edits import Draft
from playground.workbench.parameter_list import Listing

_NAMES = {PICTURE: "Picture", PICTURES: "Numbered pictures", FILM: "Film", SHEET: "Sheet of a sweep"}


def draw_capture(captures: Captures, look: Theme) -> None:
    """Draw the window, while it is open."""
    if not captures.shown:
        return
    room = imgui.get_main_viewport().size
    imgui.set_next_window_pos(ImVec2(room.x / 2, room.y / 2), imgui.Cond_.appearing, ImVec2(0.5, 0.5))
    imgui.set_next_window_size(ImVec2(min(430 * look.scale, room.x - 16), 0))
    flags = QUIET | imgui.WindowFlags_.no_collapse | imgui.WindowFlags_.no_resize
    with styled({imgui.Col_.window_bg: POPUP_COLOUR}):
        visible, stays = imgui.begin("Capture###capture", True, flags)
        captures.shown = bool(stays)
        if visible:
            with disabled(captures.working is not None):
                _wish(captures.wish, captures.session.shown)
            imgui.separator()
            if captures.working is not None:
                _progress(captures.working, look)
            else:
                _result(captures)
        imgui.end()


def _wish(wish: Wish, draft: Draft | None) -> None:
    with row("What", "From the sketch as it is now, with all edits"):
        kind = choose("##kind", _NAMES[wish.kind], KINDS, wish.kind, name=_NAMES.__getitem__)
        wish.kind = kind or wish.kind
    of = "320 pixels wide" if wish.kind == SHEET else "the window's"

    def named(multiple: int) -> str:
        return f"{multiple} × {of}" if multiple else "typed"

    with row("Size", "A picture larger than a texture is drawn in parts"):
        multiple = choose("##multiple", named(wish.multiple), (*MULTIPLES, 0), wish.multiple, name=named)
        wish.multiple = wish.multiple if multiple is None else multiple
    if not wish.multiple:
        with row("Pixels", "Width and height"):
            changed, size = imgui.input_int2("##pixels", list(wish.size))
            if changed:
                wish.size = max(size[0], 1), max(size[1], 1)
    if wish.kind in (FILM, PICTURES):
        _film(wish)
    if wish.kind == SHEET:
        for number in range(2):
            _sweep(wish, number, draft)


def _film(wish: Wish) -> None:
    with row("From", "The time of the first picture"):
        _, start = imgui.input_float("##start", wish.start, 0.0, 0.0, "%.2f s")
        wish.start = max(start, 0.0)
    with row("Seconds", "How long; 0: to the last keyframe, or ten where there is none"):
        _, seconds = imgui.input_float("##seconds", wish.seconds, 0.0, 0.0, "%.2f s")
        wish.seconds = max(seconds, 0.0)
    with row("Pictures a second", "Picture n is that of the time n / so many, however long drawing takes"):
        _, fps = imgui.input_int("##fps", wish.fps, 0)
        wish.fps = min(max(fps, 1), 1000)
    if wish.kind == FILM:
        with row("Format", "By FFmpeg"):
            shown_ending, endings = VIDEO_ENDINGS[wish.ending], list(VIDEO_ENDINGS)
            ending = choose(
                "##ending", shown_ending, endings, wish.ending, name=lambda e: f"{e}  {VIDEO_ENDINGS[e]}"
            )
            wish.ending = ending or wish.ending
        with row("Quality", "The better, the larger"):
            wish.quality = choose("##quality", wish.quality, QUALITIES, wish.quality) or wish.quality


def _sweep(wish: Wish, number: int, draft: Draft | None) -> None:
    note = "A parameter and its values, as light.gain=0.5..3,9 or light.gain=1,2,4"
    with row("Sweep" if number == 0 else "And down", note):
        imgui.set_next_item_width(imgui.calc_item_width() - imgui.get_frame_height())
        hint = "a parameter" if number == 0 else "a second, for a grid"
        _, wish.sweeps[number] = imgui.input_text_with_hint(f"##sweep{number}", hint, wish.sweeps[number])
        imgui.same_line(0, 0)
        if imgui.begin_combo(f"##swept{number}", "", imgui.ComboFlags_.no_preview):
            sections = Listing().sections(draft) if draft is not None else ()
            for item in (item for section in sections for item in section.items):
                for part in parts_of(item.parameter):
                    name = f"{item.path}.{part}" if part else item.path
                    if imgui.selectable(name, False)[0]:
                        wish.sweeps[number] = sweep_text(item.path, item.parameter, part)
            imgui.end_combo()


def _progress(working: JobProcess, look: Theme) -> None:
    done, of = working.progress
    text = f"{done} of {of}" if of else "beginning …"
    imgui.progress_bar(done / of if of else 0.0, ImVec2(-90 * look.scale, 0), text)
    imgui.same_line()
    if button("Cancel", enabled=not working.stopping, wide=-1):
        working.stop()


def _result(captures: Captures) -> None:
    if button("Capture"):
        captures.start()
    imgui.same_line()
    imgui.text_disabled(captures.summary())
    if captures.failed:
        with wrapped():
            imgui.text_colored(theme.colour(theme.ALARM), captures.failed)
    elif captures.made is not None:
        with wrapped():
            imgui.text_unformatted(f"saved {shown(captures.made)}")
        if button("Open folder") and (complaint := open_folder(captures.made)):
            captures.notices.say(complaint)
