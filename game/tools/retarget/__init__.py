"""Anyone's humanoid motion (BVH) onto the project's skeleton: joint maps, T-pose corrections, feet and hands."""

from game.formats.joint_map import MAPS, JointMap, detect_map, find_map, load_map, map_from_names
from game.tools.retarget.retarget import FPS, Options, Report, Retargeted, retarget

__all__ = [
    "FPS",
    "MAPS",
    "JointMap",
    "Options",
    "Report",
    "Retargeted",
    "detect_map",
    "find_map",
    "load_map",
    "map_from_names",
    "retarget",
]
