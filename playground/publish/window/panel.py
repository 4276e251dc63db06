"""The dialog that shows what is here to others: what is going to be written, how far it is, where it went."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.publish.capture_job import FILM, MESH, MOVING, PAGE, SHEET, TURNTABLE, JobProcess
from playground.publish.sweep import parts_of, sweep_text
from playground.publish.video import QUALITIES
from playground.publish.window.show import (
    FORMS,
    SCREENS,
    Show,
    ShowSettings,
    duration_text,
    form_title,
    kind_title,
    open_folder,
)
from playground.studio import theme
from playground.studio.draw import (
    QUIET,
    button,
    choose,
    disabled,
    fitting_choice,
    inked,
    row,
    styled,
    wrapped,
)
from playground.studio.edits.edits import Draft
from playground.studio.language import numeral, tr
from playground.studio.panel.parameter_list import items_of
from playground.studio.theme import Theme

_WIDE = 470.0  # [units of scale 1]
_COLUMNS = 3  # of kinds
_DIALOG = QUIET | imgui.WindowFlags_.no_collapse | imgui.WindowFlags_.no_resize
_DIALOG &= ~imgui.WindowFlags_.no_nav_inputs
_FOCUSED = imgui.FocusedFlags_.child_windows | imgui.FocusedFlags_.no_popup_hierarchy


def draw_show(show: Show, look: Theme) -> None:
    """Draw the dialog, while it is open."""
    if not show.shown:
        if show.has_keys:
            _give_keys_back(show)
        return
    room = imgui.get_main_viewport().size
    imgui.set_next_window_pos(ImVec2(room.x / 2, room.y / 2), imgui.Cond_.appearing, ImVec2(0.5, 0.5))
    wide = min(_WIDE * look.scale, room.x - 16)
    imgui.set_next_window_size(ImVec2(wide, 0))
    imgui.set_next_window_size_constraints(ImVec2(wide, 0), ImVec2(wide, room.y - 16))
    with styled({imgui.Col_.window_bg: theme.colour(theme.palette.popup, 0.98)}):
        visible, stays = imgui.begin(f"{tr('Show to others')}###show", True, _DIALOG)
        enters = _takes_keys(show)
        if visible:
            with disabled(show.working is not None):
                _choices(show)
            imgui.separator()
            if show.working is not None:
                _progress(show, show.working, look)
            else:
                _prospect(show, look, enters=enters)
        imgui.end()
    if not stays:
        show.toggle()


def _takes_keys(show: Show) -> bool:
    """Take the keyboard while the dialog has the focus; return whether Enter was pressed in it.

    Tab and arrows go from choice to choice, Space presses; Enter is the dialog's wherever the focus is.
    """
    if not imgui.is_window_focused(_FOCUSED):  # a list that is open in it has Enter for itself
        if show.has_keys and not imgui.is_popup_open("", imgui.PopupFlags_.any_popup):
            _give_keys_back(show)
        return False
    show.has_keys = True
    imgui.get_io().config_flags |= imgui.ConfigFlags_.nav_enable_keyboard.value
    enters = False
    for key in (imgui.Key.enter, imgui.Key.keypad_enter):
        imgui.internal.set_key_owner(key, imgui.get_id("enter"))
        enters |= imgui.is_key_pressed(key, False)
    return enters and not imgui.is_window_appearing()


def _give_keys_back(show: Show) -> None:
    show.has_keys = False
    imgui.get_io().config_flags &= ~imgui.ConfigFlags_.nav_enable_keyboard.value


# ── what is chosen ───────────────────────────────────────────────────────────


def _choices(show: Show) -> None:
    settings = show.settings
    _kinds(show)
    imgui.spacing()
    if len(FORMS[settings.kind]) > 1:
        with row(tr("Format"), tr("What kind of file it is")):
            _formats(show)
    if settings.kind not in (PAGE, MESH):
        _sizes(settings)
    if settings.kind in MOVING:
        _film(settings)
    if settings.kind == SHEET:
        for number in range(2):
            _sweep(settings, number, show.session.shown)
    if settings.kind == MESH:
        _mesh(show)


def _kinds(show: Show) -> None:
    settings, room = show.settings, imgui.get_content_region_avail().x
    for number, kind in enumerate(FORMS):
        if number % _COLUMNS:
            imgui.same_line(imgui.get_style().window_padding.x + number % _COLUMNS * room / _COLUMNS)
        reason = show.refusal(kind)
        with disabled(bool(reason)):
            if imgui.radio_button(f"{kind_title(kind)}###kind {kind}", settings.kind == kind):
                settings.kind = kind
        if reason:
            imgui.set_item_tooltip(reason)


def _formats(show: Show) -> None:
    settings = show.settings
    if not imgui.begin_combo("###form", fitting_choice(form_title(settings.form))):
        return
    for form in FORMS[settings.kind]:
        reason = show.form_refusal(settings.kind, form)
        with disabled(bool(reason)):
            if imgui.selectable(f"{form_title(form)}###form {form}", form == settings.form)[0]:
                show.choose_form(form)
        if reason:
            imgui.set_item_tooltip(reason)
        if form == settings.form:
            imgui.set_item_default_focus()
    imgui.end_combo()


def _sizes(settings: ShowSettings) -> None:
    window = tr("320 pixels wide") if settings.kind == SHEET else tr("the window's")
    names = {
        "1": f"1 × {window}",
        "2": f"2 × {window}",
        **{name: f"{name}, {wide} × {high}" for name, (wide, high) in SCREENS.items()},
        "typed": tr("typed"),
    }
    if settings.kind == SHEET:
        names = {size: name for size, name in names.items() if size not in SCREENS}
    with row(tr("Size"), tr("A picture larger than a texture is drawn in parts")):
        current = settings.size if settings.size in names else "1"
        size = choose("###size", fitting_choice(names[current]), names, current, name=names.__getitem__)
        settings.size = size or settings.size
    if settings.size == "typed":
        with row(tr("Pixels"), tr("Width and height")):
            changed, typed = imgui.input_int2("###pixels", list(settings.typed))
            if changed:
                settings.typed = max(typed[0], 1), max(typed[1], 1)


def _film(settings: ShowSettings) -> None:
    if settings.kind == FILM:
        with row(tr("From"), tr("The time of the first picture")):
            _, start = imgui.input_float("###start", settings.start, 0.0, 0.0, "%.2f s")
            settings.start = max(start, 0.0)
        with row(tr("Seconds"), tr("How long; 0: to the last keyframe, or ten where there is none")):
            _, seconds = imgui.input_float("###seconds", settings.seconds, 0.0, 0.0, "%.2f s")
            settings.seconds = max(seconds, 0.0)
    else:
        with row(tr("Seconds"), tr("Once around the terrain; it repeats without a jump")):
            _, around = imgui.input_float("###around", settings.around, 0.0, 0.0, "%.2f s")
            settings.around = max(around, 0.1)
    note = tr("Picture n is that of the time n / rate, however long drawing takes")
    with row(tr("Pictures a second"), note):
        _, fps = imgui.input_int("###fps", settings.fps, 0)
        settings.fps = min(max(fps, 1), 1000)
    if settings.form in ("mp4", "webm"):
        with row(tr("Quality"), tr("The better, the larger")):
            quality = choose(
                "###quality", quality_title(settings.quality), QUALITIES, settings.quality, name=quality_title
            )
            settings.quality = quality or settings.quality


def quality_title(quality: str) -> str:
    """Return what a film's quality is called."""
    titles = {"low": tr("low"), "medium": tr("medium"), "high": tr("high"), "best": tr("best")}
    return titles[quality]


def _sweep(settings: ShowSettings, number: int, draft: Draft | None) -> None:
    note = tr("A parameter and its values, as light.gain=0.5..3,9 or light.gain=1,2,4")
    with row(tr("Sweep") if number == 0 else tr("And down"), note):
        imgui.set_next_item_width(imgui.calc_item_width() - imgui.get_frame_height())
        hint = tr("a parameter") if number == 0 else tr("a second, for a grid")
        _, settings.sweeps[number] = imgui.input_text_with_hint(
            f"###sweep{number}", hint, settings.sweeps[number]
        )
        imgui.same_line(0, 0)
        if imgui.begin_combo(f"###swept{number}", "", imgui.ComboFlags_.no_preview):
            for item in items_of(draft).values():
                for part in parts_of(item.parameter):
                    name = f"{item.path}.{part}" if part else item.path
                    if imgui.selectable(name, False)[0]:
                        settings.sweeps[number] = sweep_text(item.path, item.parameter, part)
            imgui.end_combo()


def _mesh(show: Show) -> None:
    settings, factor = show.settings, show.session.exaggeration
    label = tr("Exaggerated ×{factor}, as shown", factor=numeral(factor))
    with disabled(factor == 1.0):
        _, settings.exaggerated = imgui.checkbox(f"{label}###exaggerated", settings.exaggerated)
    imgui.set_item_tooltip(
        tr("Without it, heights are true metres")
        if factor != 1.0
        else tr("The window shows true heights: nothing is exaggerated")
    )
    reason = show.light_refusal
    with disabled(bool(reason)):
        _, settings.light = imgui.checkbox(f"{tr('Bake the light in')}###light", settings.light)
    imgui.set_item_tooltip(reason or tr("Other programs show it as bright as it is here, and add no light"))


# ── what is going to be, what is, what was ───────────────────────────────────


def _prospect(show: Show, look: Theme, *, enters: bool) -> None:
    prospect = show.prospect
    with wrapped():
        if prospect.error:
            with inked(theme.palette.alarm):
                imgui.text_unformatted(f"! {prospect.error}")
        else:
            imgui.text_unformatted(prospect.sentence)
            imgui.text_unformatted(f"→ {prospect.path}")
            with inked(theme.palette.dim):
                imgui.text_unformatted(prospect.cost)
                for note in prospect.notes:
                    imgui.text_unformatted(note)
    imgui.spacing()
    if prospect.is_still and not show.refusal(TURNTABLE):
        note = tr("The camera goes once around the terrain, and time stands still")
        if button(f"{tr('Make a turntable instead')}###instead", note):
            show.settings.kind = TURNTABLE
        imgui.same_line()
    writes = button(f"{tr('Write it (Enter)')}###write", enabled=not prospect.error)
    imgui.same_line()
    if button(f"{tr('Close (Esc)')}###close"):
        show.toggle()
    if writes or (enters and not prospect.error):
        show.start()
    _result(show, look)


def _progress(show: Show, working: JobProcess, look: Theme) -> None:
    done, of = working.progress
    parts = [tr("{done} of {of}", done=done, of=of) if of else tr("beginning …")]
    left = working.seconds_left
    if left is not None and done < of:
        parts.append(tr("{time} left", time=duration_text(left)))
    keeps = working.job.kind in MOVING
    with wrapped():
        imgui.text_unformatted(tr("The window goes on meanwhile; Esc closes this alone."))
    imgui.progress_bar(done / of if of else 0.0, ImVec2(-1, 0), ", ".join(parts))
    if working.stopping:
        text = tr("It stops when the picture at work is done.") if keeps else tr("It stops.")
        with wrapped():
            imgui.text_unformatted(text)
        if keeps and button(
            f"{tr('Stop at once')}###now", tr("What is at work is lost: of a film all of it")
        ):
            working.stop()
        return
    label = tr("Stop, and keep what is done") if keeps else tr("Stop, and keep nothing")
    if button(f"{label}###stop"):
        working.stop()


def _result(show: Show, look: Theme) -> None:
    if show.failed:
        with wrapped(), inked(theme.palette.alarm):
            imgui.text_unformatted(f"! {show.failed}")
    elif show.result:
        imgui.separator()
        with wrapped():
            imgui.text_unformatted(show.result)
        if show.made is None:
            return
        path = str(show.made.absolute())
        if button(f"{tr('Open the folder')}###folder", path) and (complaint := open_folder(show.made)):
            show.notices.say(complaint)
        imgui.same_line()
        if button(f"{tr('Copy the path')}###copy", path):
            imgui.set_clipboard_text(path)
