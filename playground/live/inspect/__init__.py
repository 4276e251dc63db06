"""Draw the inspection of a picture (``workbench.inspect``): plots, pass graph, comparison, timeline."""
