"""Pages of the documentation that are made from the sources: one for each effect of the catalogue."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

sys.path.insert(0, str(Path(__file__).parents[1]))  # mkdocs loads this file alone
from tools.effect_pages import named_effects, page_of, picture_of, table_of_all

OUTSIDE = re.compile(r"\[([^\]]*)\]\(\.\./[^)]*\)")
"""A link out of docs/ into the checkout, which the site does not hold."""


def on_config(config: Any) -> Any:
    """Put the catalogue's pages into the navigation."""
    catalogue = _section(config["nav"], "Catalogue of effects")
    catalogue += [f"catalogue/{effect.id}.md" for effect in named_effects()]
    return config


def on_files(files: Files, config: Any) -> Files:
    """Add the catalogue's pages and pictures."""
    files.append(File.generated(config, "catalogue/index.md", content=table_of_all()))
    for effect in named_effects():
        files.append(File.generated(config, f"catalogue/{effect.id}.md", content=page_of(effect)))
        files.append(File.generated(config, f"catalogue/{effect.id}.png", content=picture_of(effect)))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Leave a link into the checkout as its words."""
    return OUTSIDE.sub(r"\1", markdown)


def _section(nav: list[Any], name: str) -> list[Any]:
    """The list of pages under a title, however deep it stands."""
    for entry in nav:
        for title, content in entry.items() if isinstance(entry, dict) else ():
            if title == name:
                found: list[Any] = content
                return found
            if isinstance(content, list) and (inside := _section(content, name)):
                return inside
    return []
