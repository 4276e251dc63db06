"""What the live window shows of an inspection (``workbench.inspect``): plots, graph, comparison, time.

plots.py      ImPlot, made ready when the first plot is shown
tooltip.py    the box at the mouse that shows what the inspector found
map_panel.py  a map's legend and histogram, in the panel
ab.py         A and B on the screen
graph.py      the window of the passes
timeline.py   the bar of time under the picture
overlays.py   draws all that is on over the picture
"""
