"""Read shaders of other tools, unchanged, as sketches: Shadertoy, ISF, glslViewer and their like."""
