"""Sketches in a notebook: pictures with sliders, drawn by its browser or by its kernel.

    import playground

    widget = playground.widget("jacksboro")     # the last line of a cell shows it
    widget["light.sun"] = (250.0, 12.0)         # and what was dragged is read in the same way
    playground.compare("jacksboro", widget.sketch)

Widgets need the extra ``notebook`` (anywidget). Where a browser has WebGL2 and a page can hold the sketch,
the runtime of web pages draws it there (``publish.web``); else the kernel does, and sends pictures.
Lessons as notebooks are made of the same parts.
"""
