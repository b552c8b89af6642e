"""Finding and loading what a talk needs: the stall's script, the rules, the person behind the table."""

from __future__ import annotations

from pathlib import Path

from game.app.talk import TalkAssets
from game.core.errors import BadInput, Where
from game.core.paths import DIALOGUE
from game.emotion import feeling_rules_from
from game.formats.yaml_source import load_yaml, nearest
from game.market import market_rules_from
from game.story import load_script, shipped_stalls

__all__ = ["load_talk_assets", "stall_path"]


def stall_path(name: str) -> Path:
    """A stall's name, or the path of a dialogue file. Raises BadInput with the nearest known stall."""
    if name.endswith((".yaml", ".yml")):
        path = Path(name)
        if not path.is_file():
            raise BadInput("stall", where=Where(path), expected="a dialogue file that exists", seen="none")
        return path
    known = {path.stem: path for path in shipped_stalls()}
    if name not in known:
        raise BadInput("stall", expected=" | ".join(known), seen=name, hint=nearest(name, known))
    return known[name]


def load_talk_assets(path: Path) -> TalkAssets:
    """Script, rules and temperament. The rules lie beside the script, else the shipped ones are used."""
    script = load_script(path)
    rules_path = path.parent / "rules.yaml"
    root = load_yaml(rules_path if rules_path.is_file() else DIALOGUE / "rules.yaml")
    feelings = feeling_rules_from(root)
    name = script.person.temperament
    if name not in feelings.temperaments:
        raise BadInput(
            f"temperament of {script.person.id}",
            expected=" | ".join(feelings.temperaments),
            seen=name,
            hint=nearest(name, feelings.temperaments),
        )
    return TalkAssets(script, feelings, market_rules_from(root), feelings.temperaments[name])
