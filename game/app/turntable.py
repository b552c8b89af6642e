"""Look at a person from all sides: eight views on one sheet, or the seven faces close up.

examples:
  run_game.py turntable genzo --out genzo.png
  run_game.py turntable genzo --faces --out faces.png            joy, anger, sadness … as the game draws them
  run_game.py turntable daimon --rebuild --out look.png          model it anew from its YAML first (about a minute)

--rebuild models a draft (coarse grid, one level of detail) into a folder of its own: the committed files stay as they
are until `run_game.py build characters`.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.animation import Pose
from game.app.arguments import parse_size
from game.app.film import sheet
from game.app.pictures import check_png, write_png
from game.app.stage import StageAssets, StageShow, load_stage
from game.core import quaternion as quat
from game.core.emotion_space import parse_emotion
from game.core.errors import BadInput, MissingPart, Where
from game.core.humanoid import REFERENCE
from game.core.paths import ASSETS
from game.face import face_params, load_face
from game.render import Camera, Device, Renderer, level_named

__all__ = ["FACES", "add_arguments", "run", "standing"]

FACES = ("neutral", "joy", "anger", "sadness", "fear", "disgust", "surprise")
VIEWS = 8
_ARM_RAD = 1.18
_SETTLE_TICKS = 45
_AWAY_M = 6.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``turntable``."""
    parser.add_argument("person", help="name of a file in assets/characters, as mira")
    parser.add_argument("--faces", action="store_true", help="close-ups of the seven emotions instead of eight views")
    parser.add_argument("--rebuild", action="store_true", help="model a draft from the YAML first")
    parser.add_argument("--size", type=parse_size, default=(320, 560), metavar="WxH", help="of one view (320x560)")
    parser.add_argument("--out", type=Path, required=True, help="the PNG to write")


def standing() -> Pose:
    """Upright, looking straight ahead, arms hanging a little off the body: nothing hides anything."""
    rotation = np.zeros((1, len(REFERENCE), 4), dtype=np.float32)
    rotation[..., 3] = 1.0
    for side, sign in (("left", -1.0), ("right", 1.0)):
        rotation[0, REFERENCE.index[f"{side}UpperArm"]] = quat.from_axis_angle((0.0, 0.0, 1.0), sign * _ARM_RAD)
    root = np.asarray(REFERENCE.rest_translation[:1], dtype=np.float32)
    nothing = np.zeros(1, dtype=np.float32)
    return Pose(rotation, root, np.zeros((1, 2), dtype=np.float32), nothing, nothing)


def _camera(turn_rad: float, middle_m: float, height_m: float, aspect: float) -> Camera:
    """Level with ``middle_m``, seeing ``height_m`` of the person at the origin."""
    half = height_m / 2.0 / _AWAY_M
    eye = (_AWAY_M * float(np.sin(turn_rad)), middle_m + 0.12, _AWAY_M * float(np.cos(turn_rad)))
    return Camera(eye, (0.0, middle_m, 0.0), float(np.degrees(2.0 * np.arctan(half))), aspect)


def _views(stage: StageAssets, size: tuple[int, int], faces: bool) -> Iterator[NDArray[np.uint8]]:
    device = Device.headless(*size)
    renderer = Renderer(device, stage.model, stage.stall, stage.backdrop, level=level_named("ultra"))
    try:
        show = StageShow(stage)
        for _ in range(_SETTLE_TICKS):
            show.tick(standing(), 1.0 / 30.0)
        rest = stage.rig.skeleton.rest_model
        head_m = float(rest[stage.rig.skeleton.index["head"], 1, 3])
        aspect = size[0] / size[1]
        if faces:
            face = load_face(ASSETS / "face")
            bust = _camera(0.12, head_m + 0.165, 0.82, aspect)
            for name in FACES:
                best = face.search.best(face.search.score_emotion(parse_emotion(f"{name}=1")))
                chosen = face.model.parts.params(face.search.numbers(best))
                yield _draw(renderer, show, chosen, bust)
            return
        top_m = head_m + 0.53
        for k in range(VIEWS):
            camera = _camera(2.0 * np.pi * k / VIEWS, top_m / 2.0 - 0.02, top_m * 1.12, aspect)
            yield _draw(renderer, show, face_params(), camera)
    finally:
        renderer.release()
        device.release()


def _draw(renderer: Renderer, show: StageShow, params: NDArray[np.float64], camera: Camera) -> NDArray[np.uint8]:
    # The camera follows this person's head already: nothing is raised once more.
    renderer.draw(replace(show.frame(params), camera=camera, show_stall=False))
    return renderer.read_pixels()


def _rebuilt(person: str, folder: Path) -> Path:
    """A draft of the person in ``folder``. Raises MissingPart without the builders, BadInput for a wrong YAML."""
    try:
        from game.tools.modelling import build_character
    except ModuleNotFoundError as error:
        raise MissingPart(
            f"the module {error.name} is missing; install the builders: pip install -e '.[build]'"
        ) from None
    build_character(ASSETS / "characters" / f"{person}.yaml", folder, draft=True)
    return folder


def run(args: argparse.Namespace) -> int:
    """Load or model, draw, write."""
    check_png(args.out)
    source = ASSETS / "characters" / f"{args.person}.yaml"
    if not source.is_file():
        known = " | ".join(sorted(p.stem for p in source.parent.glob("*.yaml")))
        raise BadInput("person", where=Where(source), expected=known, seen=args.person)
    with tempfile.TemporaryDirectory(prefix="turntable-") as scratch:
        models = _rebuilt(args.person, Path(scratch)) if args.rebuild else None
        stage = load_stage(args.person, models=models)
        pictures = list(_views(stage, args.size, args.faces))
    write_png(args.out, sheet(pictures, 4))
    return 0
