"""Look into a session's pictures: every pass under the mouse, costs, comparisons, the pass graph, time.

Nothing here draws the sketch, and what is not shown costs nothing. The drawing of it all on the
screen is in ``live.inspect``.
"""
