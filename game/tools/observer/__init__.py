"""An observer that is not us: what can be told from a body's visible points alone, learnt from takes."""

from game.tools.observer.features import describe
from game.tools.observer.keypoints import POINT, POINTS, keypoints, keypoints_of_clip
from game.tools.observer.learner import WINDOW_S, Observer, Training, training_windows, windows
from game.tools.observer.scenes import LINES, Scene, play_scenes
from game.tools.observer.scoring import Score, score_of, score_scenes
from game.tools.observer.transfer import SETS, Foreign, StyleSet, read_set, score_set

__all__ = [
    "LINES",
    "POINT",
    "POINTS",
    "SETS",
    "WINDOW_S",
    "Foreign",
    "Observer",
    "Scene",
    "Score",
    "StyleSet",
    "Training",
    "describe",
    "keypoints",
    "keypoints_of_clip",
    "play_scenes",
    "read_set",
    "score_of",
    "score_scenes",
    "score_set",
    "training_windows",
    "windows",
]
