"""Why a thing is on the list, and what became of it in the evening: texts in both languages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from game.core.paths import ASSETS
from game.formats.yaml_source import Node, load_yaml
from game.story import Text

__all__ = ["PLAIN_WISH", "WishText", "load_wishes"]


@dataclass(frozen=True)
class WishText:
    """who: for whom; why: the reason; got, missed: a sentence of the epilogue."""

    who: Text
    why: Text
    got: Text
    missed: Text


PLAIN_WISH = WishText(
    who=Text("for yourself", "自分に"),
    why=Text("You saw it once, and have thought of it since.", "一度見かけてから、ずっと気になっている。"),
    got=Text("It stands where you can see it, and you do.", "よく見えるところに置いて、よく見ている。"),
    missed=Text("You still know exactly where it stood.", "どこに置いてあったか、まだはっきり覚えている。"),
)
"""For things that nobody has written a reason for yet."""


def load_wishes(path: Path = ASSETS / "market" / "wishes.yaml") -> Mapping[tuple[str, str], WishText]:
    """(stall, item) -> its texts. Raises BadInput with file:line:col."""
    return {
        (stall.as_str(), item.as_str()): _wish(node)
        for stall, items in load_yaml(path).items()
        for item, node in items.items()
    }


def text_of(node: Node) -> Text:
    """``{en: …, ja: …}``."""
    node.only("en", "ja")
    return Text(node["en"].as_str(), node["ja"].as_str())


def _wish(node: Node) -> WishText:
    node.only("who", "why", "got", "missed")
    return WishText(*(text_of(node[name]) for name in ("who", "why", "got", "missed")))
