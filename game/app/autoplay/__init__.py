"""Playing many talks without a window: by policies, on all cores or a cluster, logged, counted and judged."""

from game.app.autoplay.command import add_arguments, run
from game.app.autoplay.episodes import Decision, play_episode, play_with_bodies
from game.app.autoplay.runs import Plan, Run, play
from game.app.autoplay.tally import Coverage, Tally

__all__ = [
    "Coverage",
    "Decision",
    "Plan",
    "Run",
    "Tally",
    "add_arguments",
    "play",
    "play_episode",
    "play_with_bodies",
    "run",
]
