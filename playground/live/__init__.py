"""The live window: the only place with a window, keys and a wall clock.

    theme.py          fonts, colours, margins
    window.py         GLFW, an OpenGL context, Dear ImGui: the one place that knows of screens
    dividers.py       the lines that part a picture, moved by the mouse
    keys.py           the table of keys, which the key map shows as well
    dome.py           the sky as a disc, for a direction
    widgets.py        one control for each row of ``sketch/widgets.py``
    panel_rows.py     a line of the panel: a label, a control
    cost_panel.py     the table of what the picture cost
    brush_panel.py    the brush's controls
    panel.py          all of that, made from the sketch's annotations
    overlay.py        errors and notices over the picture
    mouse.py          the mouse over the picture: orbit, pan, sun, dividers, brush
    inspect/          plots, graph, comparison and time on the screen
    lesson/           lessons: a panel of text, and the picture as their figure
    status.py         what the window shows, as JSON lines for another program
    app.py            opens a sketch in a window and ties everything above together

Each imports only those above it. Importing this opens nothing; a session without a window is in
``workbench``.
"""
