"""The capture's window: what to capture, how far it is, and where it went."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.data.image_files import VIDEO_ENDINGS
from playground.paths import shown
from playground.publish.capture_job import FILM, KINDS, PICTURE, PICTURES, SHEET, JobProcess
from playground.publish.sweep import parts_of, sweep_text
from playground.publish.video import QUALITIES
from playground.publish.window.captures import MULTIPLES, Captures, CaptureSettings, open_folder
from playground.studio import theme
from playground.studio.draw import QUIET, button, choose, disabled, row, styled, wrapped
from playground.studio.edits.edits import Draft
from playground.studio.panel.parameter_list import items_of
from playground.studio.theme import Theme

_NAMES = {PICTURE: "Picture", PICTURES: "Numbered pictures", FILM: "Film", SHEET: "Sheet of a sweep"}


def draw_capture(captures: Captures, look: Theme) -> None:
    """Draw the window, while it is open."""
    if not captures.shown:
        return
    room = imgui.get_main_viewport().size
    imgui.set_next_window_pos(ImVec2(room.x / 2, room.y / 2), imgui.Cond_.appearing, ImVec2(0.5, 0.5))
    imgui.set_next_window_size(ImVec2(min(430 * look.scale, room.x - 16), 0))
    flags = QUIET | imgui.WindowFlags_.no_collapse | imgui.WindowFlags_.no_resize
    with styled({imgui.Col_.window_bg: theme.colour(theme.palette.popup, 0.98)}):
        visible, stays = imgui.begin("Capture###capture", True, flags)
        captures.shown = bool(stays)
        if visible:
            with disabled(captures.working is not None):
                _wish(captures.settings, captures.session.shown)
            imgui.separator()
            if captures.working is not None:
                _progress(captures.working, look)
            else:
                _result(captures)
        imgui.end()


def _wish(settings: CaptureSettings, draft: Draft | None) -> None:
    with row("What", "From the sketch as it is now, with all edits"):
        kind = choose("##kind", _NAMES[settings.kind], KINDS, settings.kind, name=_NAMES.__getitem__)
        settings.kind = kind or settings.kind
    of = "320 pixels wide" if settings.kind == SHEET else "the window's"

    def named(multiple: int) -> str:
        return f"{multiple} × {of}" if multiple else "typed"

    with row("Size", "A picture larger than a texture is drawn in parts"):
        multiple = choose(
            "##multiple",
            named(settings.multiple),
            (*MULTIPLES, 0),
            settings.multiple,
            name=named,
        )
        settings.multiple = settings.multiple if multiple is None else multiple
    if not settings.multiple:
        with row("Pixels", "Width and height"):
            changed, size = imgui.input_int2("##pixels", list(settings.size))
            if changed:
                settings.size = max(size[0], 1), max(size[1], 1)
    if settings.kind in (FILM, PICTURES):
        _film(settings)
    if settings.kind == SHEET:
        for number in range(2):
            _sweep(settings, number, draft)


def _film(settings: CaptureSettings) -> None:
    with row("From", "The time of the first picture"):
        _, start = imgui.input_float("##start", settings.start, 0.0, 0.0, "%.2f s")
        settings.start = max(start, 0.0)
    with row("Seconds", "How long; 0: to the last keyframe, or ten where there is none"):
        _, seconds = imgui.input_float("##seconds", settings.seconds, 0.0, 0.0, "%.2f s")
        settings.seconds = max(seconds, 0.0)
    with row("Pictures a second", "Picture n is that of the time n / rate, however long drawing takes"):
        _, fps = imgui.input_int("##fps", settings.fps, 0)
        settings.fps = min(max(fps, 1), 1000)
    if settings.kind == FILM:
        with row("Format", "By FFmpeg"):
            shown_ending, endings = VIDEO_ENDINGS[settings.ending], list(VIDEO_ENDINGS)
            ending = choose(
                "##ending",
                shown_ending,
                endings,
                settings.ending,
                name=lambda e: f"{e}  {VIDEO_ENDINGS[e]}",
            )
            settings.ending = ending or settings.ending
        with row("Quality", "The better, the larger"):
            settings.quality = (
                choose("##quality", settings.quality, QUALITIES, settings.quality) or settings.quality
            )


def _sweep(settings: CaptureSettings, number: int, draft: Draft | None) -> None:
    note = "A parameter and its values, as light.gain=0.5..3,9 or light.gain=1,2,4"
    with row("Sweep" if number == 0 else "And down", note):
        imgui.set_next_item_width(imgui.calc_item_width() - imgui.get_frame_height())
        hint = "a parameter" if number == 0 else "a second, for a grid"
        _, settings.sweeps[number] = imgui.input_text_with_hint(
            f"##sweep{number}", hint, settings.sweeps[number]
        )
        imgui.same_line(0, 0)
        if imgui.begin_combo(f"##swept{number}", "", imgui.ComboFlags_.no_preview):
            for item in items_of(draft).values():
                for part in parts_of(item.parameter):
                    name = f"{item.path}.{part}" if part else item.path
                    if imgui.selectable(name, False)[0]:
                        settings.sweeps[number] = sweep_text(item.path, item.parameter, part)
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
            imgui.text_colored(theme.colour(theme.palette.alarm), captures.failed)
    elif captures.made is not None:
        with wrapped():
            imgui.text_unformatted(f"saved {shown(captures.made)}")
        if button("Open folder") and (complaint := open_folder(captures.made)):
            captures.notices.say(complaint)
