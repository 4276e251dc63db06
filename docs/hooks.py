"""MkDocs hooks: put the generated pages and the pages that live elsewhere into the site.

MkDocs has this folder in its search path while it loads the file, so ``site_pages`` is found.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File
from site_pages import pages

from playground.errors import counted
from playground.paths import CHECKOUT, GLSL

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Replace each entry of the navigation that names a generated folder with the folder's pages.

    Raises ``PluginError`` where another playground than this checkout's is imported, or a picture is missing.
    """
    if CHECKOUT != pages.ROOT:
        raise PluginError(
            f"the playground of this Python is {GLSL.parent}, whose pages would not follow {pages.ROOT}:"
            " ./play add docs, then .venv/bin/mkdocs"
        )
    if lost := pages.missing_pictures():
        raise PluginError(f"{counted(len(lost), 'picture')} of the site missing: {', '.join(lost[:3])}")
    config.nav = [pages.expanded(entry) for entry in config.nav or []]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add what is generated from the code, and the texts at the top of the checkout."""
    for path, content in pages.generated().items():
        files.append(File.generated(config, path, content=content))
    return files


def on_post_build(config: MkDocsConfig) -> None:
    """Leave out the source maps of the theme: megabytes, for its own developers."""
    for path in Path(config.site_dir).rglob("*.map"):
        path.unlink()
