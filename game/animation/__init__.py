"""The body in motion: from the planner's decisions to one pose per character and to the matrices that skin a mesh."""

from game.animation.body_shape import BodyShape, measure_shape
from game.animation.body_size import REGIONS, BodySize, measure_body
from game.animation.characters import PerformerState
from game.animation.fitting import NEEDED, Fitting, fit_to
from game.animation.liveliness import GAZE_AWAY, GAZE_CUSTOMER, GAZE_GOODS, LifeConfig
from game.animation.motion_bank import KnownUnits
from game.animation.performer import MODES, Mode, Performer, PerformSignal
from game.animation.pose import Pose, interpolate_pose, joint_accelerations, largest_joint_acceleration
from game.animation.skinning import EyeBones, Rig
from game.animation.springbones import SpringChain, SpringCollider, SpringState

__all__ = [
    "GAZE_AWAY",
    "GAZE_CUSTOMER",
    "GAZE_GOODS",
    "MODES",
    "NEEDED",
    "REGIONS",
    "BodyShape",
    "BodySize",
    "EyeBones",
    "Fitting",
    "KnownUnits",
    "LifeConfig",
    "Mode",
    "PerformSignal",
    "Performer",
    "PerformerState",
    "Pose",
    "Rig",
    "SpringChain",
    "SpringCollider",
    "SpringState",
    "fit_to",
    "interpolate_pose",
    "joint_accelerations",
    "largest_joint_acceleration",
    "measure_body",
    "measure_shape",
]
