"""What stands over the land in flight: speed, heights, heading, time of day; and the help."""

from __future__ import annotations

import math

from imgui_bundle import ImVec2, imgui

from playground.errors import PlaygroundError, counted
from playground.flight.flight import Flight
from playground.live.theme import ALARM, DIM, INK, WARM, Theme, packed

_MARGIN = 14.0
_ERRORS = 6  # lines of what is wrong that are shown
_WINDS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")

HELP: tuple[tuple[str, str], ...] = (
    ("S or Down,  W or Up", "nose up, nose down"),
    ("A or Left,  D or Right", "bank left, bank right"),
    ("Q,  E", "turn left, turn right"),
    ("Shift,  Ctrl", "faster, slower (also Page Up, Page Down)"),
    ("mouse, left button held", "the stick; the wheel is the throttle"),
    ("gamepad", "left stick, right stick to turn, triggers for speed"),
    ("[,  ]", "half an hour earlier, later (gamepad: bumpers)"),
    ("P or Space", "pause (gamepad: Start)"),
    ("R", "back to the start (gamepad: Back)"),
    ("?", "this help (also F1)"),
    ("Ctrl +,  Ctrl -,  Ctrl 0", "text larger, smaller, at its first size"),
    ("Esc", "close this help; pause"),
    ("Ctrl+Q", "quit, while it is paused"),
)


class Instruments:
    """Text over the picture, drawn by imgui."""

    def __init__(self, *, recording: bool, replaying: bool) -> None:
        self.help = False
        self.recording = recording
        self.replaying = replaying
        self.ended = False  # a replay has come to its end
        self.trouble = ""  # why nothing is recorded any more
        self.error: PlaygroundError | None = None  # of what was saved
        self.changing = False  # what was saved is being made

    def draw(self, flight: Flight, theme: Theme, *, ready: bool, paused: bool) -> None:
        """Draw everything for this turn."""
        room = imgui.get_main_viewport().size
        if not ready:
            there = len(flight.parts.wanted) - flight.parts.missing
            text = f"making the land: {there} of {len(flight.parts.wanted)} parts"
            self._box(text, theme, room.x / 2, room.y / 2, centred=True)
            return
        self._box(self._reading(flight), theme, _MARGIN, room.y - _MARGIN, from_below=True)
        hint = "?  help"
        state = [word for word, so in self._states(paused) if so]
        self._box(
            "   ".join([*state, hint]), theme, room.x - _MARGIN, room.y - _MARGIN, right=True, from_below=True
        )
        if self.error is not None:
            self._draw_error(self.error, theme, room)
        elif self.changing:
            self._box("taking in what was saved", theme, room.x / 2, _MARGIN, centred=True)
        if self.help:
            self._draw_help(theme, room)

    def _states(self, paused: bool) -> tuple[tuple[str, bool], ...]:
        return (
            (self.trouble, bool(self.trouble)),
            ("recording", self.recording),
            ("end of the replay: Ctrl+Q quits", self.ended),
            ("replay", self.replaying and not self.ended),
            ("paused: P flies on, Ctrl+Q quits", paused and not self.ended),
        )

    def _reading(self, flight: Flight) -> str:
        craft = flight.craft
        degrees = round(math.degrees(craft.heading)) % 360
        wind = _WINDS[round(degrees / 45) % 8]
        lines = [
            f"{craft.speed * 3.6:4.0f} km/h   throttle {craft.throttle * 100:3.0f} %",
            f"{flight.above_ground:4.0f} m over ground   {flight.above_sea:4.0f} m over sea",
            f"heading {degrees:03d}° {wind}",
        ]
        if flight.plot.hour:
            lines[-1] += f"   {clock(flight.hour)}"
        return "\n".join(lines)

    def _box(
        self,
        text: str,
        theme: Theme,
        x: float,
        y: float,
        *,
        right: bool = False,
        from_below: bool = False,
        centred: bool = False,
    ) -> None:
        """Write text on a dark plate; x and y are the corner that the flags say."""
        with theme.font(theme.code):
            size, pad = imgui.calc_text_size(text), 8.0
            wide, high = size.x + 2 * pad, size.y + 2 * pad
            left = x - wide / 2 if centred else x - wide if right else x
            top = y - high / 2 if centred else y - high if from_below else y
            over = imgui.get_foreground_draw_list()
            plate = packed((0.04, 0.05, 0.06), 0.55)
            over.add_rect_filled(ImVec2(left, top), ImVec2(left + wide, top + high), plate, 6.0)
            colour = ALARM if text.startswith("end") else INK
            over.add_text(ImVec2(left + pad, top + pad), packed(colour), text)

    def _draw_error(self, error: PlaygroundError, theme: Theme, room: ImVec2) -> None:
        """Write what is wrong in what was saved along the upper edge, its first lines."""
        lines = str(error).split("\n")
        more = f"\n… and {counted(len(lines) - _ERRORS, 'more line')}" if len(lines) > _ERRORS else ""
        text = "\n".join(lines[:_ERRORS]) + more + "\nthe last good save is flown over"
        with theme.font(theme.code):
            pad = 8.0
            wide = max(room.x - 2 * (_MARGIN + pad), 80.0)
            size = imgui.calc_text_size(text, False, wide)
            low = ImVec2(_MARGIN, _MARGIN)
            corner = ImVec2(low.x + size.x + 2 * pad, low.y + size.y + 2 * pad)
            over = imgui.get_foreground_draw_list()
            over.add_rect_filled(low, corner, packed((0.04, 0.05, 0.06), 0.85), 6.0)
            place, font, points = ImVec2(low.x + pad, low.y + pad), imgui.get_font(), imgui.get_font_size()
            over.add_text(font, points, place, packed(ALARM), text, wide)

    def _draw_help(self, theme: Theme, room: ImVec2) -> None:
        with theme.font(theme.text):
            line, pad, gap = imgui.get_text_line_height() * 1.45, 18.0, 24.0
            keys = max(imgui.calc_text_size(k).x for k, _ in HELP)
            wide = keys + gap + max(imgui.calc_text_size(m).x for _, m in HELP) + 2 * pad
            high = line * len(HELP) + 2 * pad
            left, top = max((room.x - wide) / 2, 0.0), max((room.y - high) / 2, 0.0)
            over = imgui.get_foreground_draw_list()
            corner = ImVec2(left + wide, top + high)
            over.add_rect_filled(ImVec2(left, top), corner, packed((0.06, 0.07, 0.08), 0.88), 8.0)
            for number, (key, meaning) in enumerate(HELP):
                y = top + pad + number * line
                over.add_text(ImVec2(left + pad, y), packed(WARM), key)
                over.add_text(ImVec2(left + pad + keys + gap, y), packed(INK if meaning else DIM), meaning)


def clock(hour: float) -> str:
    """Return a time of day as a clock shows it."""
    minutes = round(hour * 60) % (24 * 60)
    return f"{minutes // 60:02d}:{minutes % 60:02d}"
