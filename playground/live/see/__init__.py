"""What the live window shows beside the picture: numbers, costs, comparisons, time.

    ground.py     the place of the land under a pixel, found by the graphics card
    inspector.py  what every pass has under the mouse
    beside.py     two pictures painted over one another
    compare.py    a state that is kept as A beside what is worked on
    histogram.py  how a texture's numbers are spread, counted a piece a turn
    legend.py     the colours of a map's ramp
    record.py     what the last pictures cost
    wiring.py     the passes as a graph, and where each stands
    thumbnails.py small pictures of textures, drawn when stale
    time.py       how long a sketch's time is, and its frames
    state.py      all of it that a key or a button switches
    plots.py      ImPlot, made ready when the first plot is shown
    glass.py      the box at the mouse that shows what the inspector found
    spread.py     a map's legend and histogram, in the panel
    ab.py         A and B on the screen
    graph.py      the window of the passes
    timeline.py   the bar of time under the picture
    view.py       draws all that is on over the picture

Nothing here draws the sketch, and what is not shown costs nothing.
"""
