"""The panel of parameters: rows, widgets, sections, random values."""
