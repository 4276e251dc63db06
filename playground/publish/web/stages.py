"""Write a recipe of a shader stage as data: see ``Stage`` in schema.js."""

from __future__ import annotations

from typing import Any

from playground.shader.stage_recipe import Recipe


def stage_data(recipe: Recipe, file: str = "") -> dict[str, Any]:
    """Return a recipe as data; ``file``: the name of its lines' file where it is not the kernel's own."""
    if recipe.text:
        return {"text": recipe.text}
    before = [
        {"text": part.text, **({"names": list(part.names)} if part.names else {})} for part in recipe.before
    ]
    data: dict[str, Any] = {"before": before, "after": recipe.after.removesuffix("\n")}
    if recipe.without:
        data["without"] = recipe.without
    if recipe.replaced:
        data["replace"] = dict(recipe.replaced)
    if recipe.keeps_version:
        data["keepsVersion"] = True
    if file:
        data["file"] = file
    return data
