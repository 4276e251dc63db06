"""What every plot here shares: ImPlot made ready, colours that all eyes tell apart."""

from __future__ import annotations

from imgui_bundle import ImVec4, implot

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


def begin() -> None:
    """Have ImPlot ready; it is made when the first plot is shown."""
    if implot.get_current_context() is None:
        implot.create_context()


def line(number: int, weight: float = 1.5) -> implot.Spec:
    """Return how the line of that number is drawn."""
    spec = implot.Spec()
    spec.line_color = ImVec4(*COLOURS[number % len(COLOURS)], 1.0)
    spec.line_weight = weight
    return spec
