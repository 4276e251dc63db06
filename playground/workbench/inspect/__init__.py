"""Look into a session's pictures: every pass under the mouse, costs, comparisons, the pass graph, time.

    surface_point.py  the point of the terrain under a pixel, found on the GPU
    inspector.py      what every pass has under the mouse
    blend.py          two pictures painted over one another
    compare.py        a stored state A against the current one, B
    histogram.py      how a texture's numbers are spread, counted a piece a frame
    legend.py         the colours of a map's ramp
    frame_costs.py    what the last pictures cost
    pass_graph.py     the passes as a graph, and where each is drawn
    thumbnails.py     small pictures of textures, drawn when stale
    time_range.py     how long a sketch's time is, and its frames
    toggles.py        all of it that a key or a button switches

Nothing here draws the sketch, and what is not shown costs nothing. The drawing of it all on the
screen is in ``live.inspect``.
"""
