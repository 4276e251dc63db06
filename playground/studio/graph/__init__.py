"""The passes as a graph."""
