"""Everything the running game needs, loaded once and in the order that fails clearly."""

from __future__ import annotations

from pathlib import Path

from game.animation import Performer
from game.app.content import load_talk_assets, stall_path
from game.app.step import StepAssets
from game.core.paths import ASSETS
from game.embos import Planner, UnitLibrary, check_habit, load_config
from game.face import load_face

__all__ = ["load_planner", "load_step_assets"]


def load_planner(folder: Path = ASSETS / "motion") -> Planner:
    """The motion units with their clips, and the planner's constants."""
    library = UnitLibrary.load(folder / "units.yaml")
    return Planner(library, load_config(folder / "planner.yaml"))


def load_step_assets(stall: str = "flea", *, body: bool = True) -> StepAssets:
    """What a step needs; without ``body`` only talk and planner (nobody looks)."""
    talk = load_talk_assets(stall_path(stall))
    planner = load_planner()
    check_habit(planner.library, talk.person.habit_units, talk.person.id)
    if not body:
        return StepAssets(talk, planner)
    performer = Performer(planner.library, layers=planner.tables.layers, radius=planner.config.radius)
    return StepAssets(talk, planner, performer, load_face())
