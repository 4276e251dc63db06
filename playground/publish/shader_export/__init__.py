"""Export a sketch's picture as a shader of another tool: ISF, Shadertoy, or a file of its own."""
