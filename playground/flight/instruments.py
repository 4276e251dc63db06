"""What is drawn over the terrain in flight: speed, heights, heading, time of day; and the help."""

from __future__ import annotations

import math

from imgui_bundle import ImVec2, imgui

from playground.errors import PlaygroundError, counted
from playground.flight.flight import Flight
from playground.studio.draw import plate
from playground.studio.theme import ALARM, DIM, INK, WARM, Rgb, Theme, packed

_MARGIN, _PADDING = 14.0, 8.0
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
        """Draw everything for this frame."""
        room = imgui.get_main_viewport().size
        if not ready:
            there = len(flight.parts.visible) - flight.parts.missing
            text = f"making the terrain: {there} of {len(flight.parts.visible)} parts"
            _plate(text, theme, (room.x / 2, room.y / 2), align=(0.5, 0.5))
            return
        low = room.y - _MARGIN
        _plate(self._values(flight), theme, (_MARGIN, low), align=(0.0, 1.0))
        state = "   ".join([*(label for label, on in self._states(paused) if on), "?  help"])
        ink = ALARM if state.startswith("end") else INK
        _plate(state, theme, (room.x - _MARGIN, low), align=(1.0, 1.0), ink=ink)
        if self.error is not None:
            self._draw_error(self.error, theme, room)
        elif self.changing:
            _plate("taking in what was saved", theme, (room.x / 2, _MARGIN), align=(0.5, 0.5))
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

    def _values(self, flight: Flight) -> str:
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

    def _draw_error(self, error: PlaygroundError, theme: Theme, room: ImVec2) -> None:
        """Write the first lines of a save's error along the upper edge."""
        lines = str(error).split("\n")
        more = f"\n… and {counted(len(lines) - _ERRORS, 'more line')}" if len(lines) > _ERRORS else ""
        text = "\n".join(lines[:_ERRORS]) + more + "\nthe last good save is flown over"
        wide = max(room.x - 2 * (_MARGIN + _PADDING), 80.0)
        _plate(text, theme, (_MARGIN, _MARGIN), ink=ALARM, alpha=0.85, wrap=wide)

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


def _plate(
    text: str,
    theme: Theme,
    corner: tuple[float, float],
    *,
    align: tuple[float, float] = (0.0, 0.0),
    ink: Rgb = INK,
    alpha: float = 0.55,
    wrap: float = -1.0,
) -> None:
    """Write text on a dark plate, as ``draw.plate`` places it."""
    with theme.font(theme.code):
        plate(
            imgui.get_foreground_draw_list(),
            text,
            corner,
            ink=packed(ink),
            ground=packed((0.04, 0.05, 0.06), alpha),
            padding=_PADDING,
            rounding=6.0,
            wrap=wrap,
            align=align,
        )


def clock(hour: float) -> str:
    """Return a time of day as a clock shows it."""
    minutes = round(hour * 60) % (24 * 60)
    return f"{minutes // 60:02d}:{minutes % 60:02d}"
