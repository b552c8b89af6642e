"""Autoplay's eye on the body: runs the same step between decisions and notes which units were on stage."""

from __future__ import annotations

from dataclasses import dataclass, replace

from game.app.loading import load_planner
from game.app.step import StepAssets, new_world, step
from game.app.talk import TalkAssets, TalkState
from game.app.world import Intent, World, enter_talk
from game.embos import Planner

__all__ = ["BodyObserver"]

THINKING_S = 2.0
"""How long the simulated player looks before deciding, seconds."""
MAX_TICKS = 3000


@dataclass
class BodyObserver:
    """Lets the lines of a beat be spoken at 30 Hz with the planner on; observers change nothing in the talk."""

    planner: Planner
    world: World | None = None
    seed: int = 0

    @staticmethod
    def load() -> BodyObserver:
        """With the shipped motion units."""
        return BodyObserver(load_planner())

    def begin(self, seed: int, episode: int) -> None:
        """A new talk begins."""
        self.world, self.seed = None, (seed * 1_000_003 + episode) & 0x7FFFFFFF

    def watch(self, assets: TalkAssets, talk: TalkState) -> list[str]:
        """Play the beat that a decision led to; returns the names of the units that were on stage, in order."""
        step_assets = StepAssets(assets, self.planner)
        world = self.world or new_world(step_assets, self.seed, text_speed="fast")
        world = (
            enter_talk(step_assets, world, talk)
            if world.talk is None
            else replace(world, talk=talk, queue=talk.beat.lines)
        )
        seen: dict[str, None] = {}
        quiet = 0
        for _ in range(MAX_TICKS):
            spoken = (
                world.speech is not None and world.time_s - world.speech.started_s > world.speech.timed.length_s + 0.4
            )
            world = step(step_assets, world, Intent(proceed=spoken))
            for index in world.body.decisions.unit[0]:
                unit = self.planner.library.units[index]
                if index >= 0 and not unit.is_rest:
                    seen[unit.name] = None
            quiet = quiet + 1 if world.waiting or world.over else 0
            if quiet > THINKING_S * 30:
                break
        self.world = world
        return list(seen)
