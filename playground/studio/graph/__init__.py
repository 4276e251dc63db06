"""The passes as a graph, with thumbnails."""
