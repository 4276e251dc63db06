"""Texts that are broken, unfinished or have branches: the rest is still read, and nothing raises."""

from __future__ import annotations

import random
import re

import pytest

from playground.lsp.complete import BUILTINS
from playground.paths import GLSL
from playground.shader.syntax.nodes import Call, Declaration, Function, For, If, Index, Jump, Node, walk
from playground.shader.syntax.parser import Tree, parse
from playground.shader.syntax.symbols import resolve

from ...loading import stages


def functions(tree: Tree) -> list[str]:
    return [node.name for node in tree.declarations if isinstance(node, Function) and node.body is not None]
