"""Compile the programs that draw a flight; their functions are in ``glsl/flight/scene.glsl``, with tests."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from playground.paths import GLSL
from playground.shader.source import read_source

if TYPE_CHECKING:
    import moderngl

AIR_DIRECTIONS = 64
"""Directions that the air's colour is computed for."""

_SHADERS = Path(__file__).resolve().parent / "shaders"
_BEGINNING = f"#version 330\nconst float AIR_DIRECTIONS = {AIR_DIRECTIONS}.0;\n"


def terrain_program(ctx: moderngl.Context) -> moderngl.Program:
    """Compile the program that draws a part."""
    return ctx.program(vertex_shader=read_shader("terrain.vert"), fragment_shader=read_shader("terrain.frag"))


def trees_program(ctx: moderngl.Context) -> moderngl.Program:
    """Compile the program that draws trees."""
    return ctx.program(vertex_shader=read_shader("trees.vert"), fragment_shader=read_shader("trees.frag"))


def screen_program(ctx: moderngl.Context, name: str) -> moderngl.Program:
    """Compile a program that fills its target, by the name of its fragment shader."""
    return ctx.program(vertex_shader=read_shader("screen.vert"), fragment_shader=read_shader(f"{name}.frag"))


def read_shader(name: str) -> str:
    """Read a shader of the flight, its includes resolved."""
    return _BEGINNING + read_source(_SHADERS / name, (_SHADERS, GLSL)).code
