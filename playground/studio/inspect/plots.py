"""What every plot here shares: ImPlot set up, colours that all eyes tell apart."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from imgui_bundle import ImVec2, ImVec4, implot

# Okabe and Ito 2008, "Color Universal Design", without black.
COLOURS = (
    (0.90, 0.62, 0.00),
    (0.34, 0.71, 0.91),
    (0.00, 0.62, 0.45),
    (0.94, 0.89, 0.26),
    (0.00, 0.45, 0.70),
    (0.84, 0.37, 0.00),
    (0.80, 0.47, 0.65),
)
PLAIN = implot.Flags_.no_menus.value | implot.Flags_.no_box_select.value | implot.Flags_.no_mouse_text.value
"""A plot that is only looked at."""


@contextmanager
def plot(name: str, size: ImVec2, flags: int) -> Iterator[bool]:
    """Draw the block in a plot, where it is given True; ImPlot is set up by the first."""
    if implot.get_current_context() is None:
        implot.create_context()
    implot.push_style_var(implot.StyleVar_.plot_padding, ImVec2(4, 4))
    drawn = implot.begin_plot(name, size, PLAIN | flags)
    yield drawn
    if drawn:
        implot.end_plot()
    implot.pop_style_var()


def line(number: int, weight: float = 1.5) -> implot.Spec:
    """Return how the line of that number is drawn."""
    spec = implot.Spec()
    spec.line_color = ImVec4(*COLOURS[number % len(COLOURS)], 1.0)
    spec.line_weight = weight
    return spec
