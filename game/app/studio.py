"""Drawing without a display: a world with a given feeling, stepped at the fixed dt, drawn through EGL."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from game.animation import Mode
from game.app.afternoon import Afternoon
from game.app.loading import load_step_assets
from game.app.market import Market
from game.app.overlays import draw_overlays
from game.app.passersby import Passersby, load_cast
from game.app.session import Session
from game.app.settings import Settings
from game.app.shots import ESTABLISHING, SHOTS
from game.app.stage import StageShow, load_stage
from game.app.step import new_world, step
from game.app.strings import load_strings
from game.app.ui import PALETTE, Canvas, Rect
from game.app.world import TICK_S, Intent, World
from game.render import CLOSEUP, DESIGN_SHARE, LEVELS, Camera, Device, FontSet, Hud, Renderer, level_named
from game.story import Spoken

__all__ = ["CAMERAS", "Studio", "add_studio_arguments"]

CAMERAS: dict[str, Camera] = {
    "hero": SHOTS["home"],
    "establishing": ESTABLISHING,
    **{name: camera for name, camera in SHOTS.items() if name != "home"},
    "closeup": CLOSEUP,
    "body": Camera((0.0, 1.17, 2.85), (0.0, 0.965, 0.0), 26.06, aspect=10 / 11),
}
WARM_UP_S = 1.5
"""Before the first picture the feeling has had this long to reach the body."""


def add_studio_arguments(parser: argparse.ArgumentParser) -> None:
    """What ``snapshot`` and ``film`` share."""
    from game.app.arguments import add_avatar, add_emotion, known, parse_day_share

    add_emotion(parser)
    add_avatar(parser)
    parser.add_argument("--shown", default=None, metavar="NAME=X,…", help="what the face shows, if not what is felt")
    parser.add_argument("--mode", choices=["full", "gestures", "body", "face"], default="full", help="what is acted")
    parser.add_argument("--say", default="", metavar="TEXT", help="a line to speak: its words call up gestures")
    parser.add_argument("--language", choices=["en", "ja"], default="en")
    levels = [level.name for level in LEVELS]
    parser.add_argument("--level", choices=levels, default="ultra", help="quality level (default ultra)")
    parser.add_argument("--person", choices=known("characters"), default="mira", help="who (default mira)")
    parser.add_argument("--stall", choices=known("stalls"), default="flea", help="behind which stall (default flea)")
    parser.add_argument("--camera", choices=sorted(CAMERAS), default=None, help="where from")
    parser.add_argument("--time-of-day", type=parse_day_share, default=None, metavar="HH:MM", help="13:00 to 18:00")
    parser.add_argument("--crowd", action=argparse.BooleanOptionalAction, default=True, help="passers-by")
    parser.add_argument("--overlay", action="store_true", help="feelings and active nodes, as in the paper's figure 6")
    parser.add_argument("--networks", action="store_true", help="the three networks with live factors")
    parser.add_argument("--seed", type=int, default=1, help="one seed, one picture (default 1)")


class Studio:
    """One shopkeeper with a fixed feeling in front of a headless renderer."""

    def __init__(self, args: argparse.Namespace, size: tuple[int, int], camera: str) -> None:
        from game.app.arguments import avatar_of
        from game.core.emotion_space import parse_emotion

        stage = load_stage(args.person, args.stall, avatar=avatar_of(args))
        assets = load_step_assets()
        self.session = Session(
            assets,
            self._world(args, new_world(assets, args.seed, language=args.language)),
            load_strings(args.language),
            Settings(language=args.language),
            Afternoon(seed=args.seed),
            Market.single(assets),
        )
        if args.shown:
            self.session.world = replace(self.session.world, shown_target=parse_emotion(args.shown))
        if args.overlay:
            self.session.overlays |= {"feelings", "units"}
        if args.networks:
            self.session.overlays |= {"networks"}
        self._label = ""
        self.draw_over: Callable[[Studio, Canvas], None] | None = None
        self.day_share = DESIGN_SHARE if args.time_of_day is None else float(args.time_of_day)
        self.camera = CAMERAS[args.camera or camera]
        self.device = Device.headless(*size)
        self.renderer = Renderer(
            self.device,
            stage.model,
            stage.stall,
            stage.backdrop,
            level=level_named(args.level),
            fonts=FontSet.for_language(args.language),
        )
        self.show = StageShow(stage)
        self.crowd: Passersby | None = None
        if args.crowd and self.camera is not CAMERAS["body"]:
            cast = load_cast("mira")
            self.renderer.meet(cast.looks)
            assert assets.performer is not None
            self.crowd = Passersby(cast, assets.planner, assets.performer, args.seed)
        self._run(WARM_UP_S)
        if args.say:
            line = Spoken(id="say", speaker="shopkeeper", en=args.say, ja=args.say)
            self.session.world = replace(self.session.world, queue=(line,))

    def _world(self, args: argparse.Namespace, world: World) -> World:
        felt = np.asarray(args.emotion)
        mode: Mode = args.mode
        return replace(world, felt_target=felt[:6], shown_target=felt, mode=mode)

    def _run(self, seconds: float) -> None:
        for _ in range(round(seconds / TICK_S)):
            self.tick(Intent())

    def tick(self, intent: Intent) -> None:
        """One step of the world, followed by what is seen."""
        self.session.world = step(self.session.assets, self.session.world, intent)
        body = self.session.world.body
        assert body.pose is not None
        self.show.tick(body.pose, TICK_S, body)
        if self.crowd is not None:
            self.crowd.tick(self.session.world)

    def begin(self, world: World) -> None:
        """Another world from its first tick on; nothing of the old one is left in cloth and hair."""
        self.session.world, self.show.puppet = world, None

    def picture(self, label: str = "") -> NDArray[np.uint8]:
        """(h, w, 3) of this moment."""
        world = self.session.world
        assert world.body.face_params is not None
        self._label = label
        view = self.show.frame(
            world.body.face_params,
            camera=self.camera,
            show_face=world.mode != "body",
            time_s=world.time_s,
            day_share=self.day_share,
            crowd=None if self.crowd is None else self.crowd.view(1.0),
            hud=self._draw_hud,
        )
        self.renderer.draw(view)
        return self.renderer.read_pixels()

    def pictures(self, seconds: float, every: float, labels: bool = True) -> Iterator[NDArray[np.uint8]]:
        """One picture every so many seconds, the first at 0 s, the last before ``seconds``."""
        start = self.session.world.time_s
        for i in range(max(round(seconds / every), 1)):
            due = start + i * every
            self._run(max(due - self.session.world.time_s, 0.0))
            yield self.picture(f"{i * every:.1f} s" if labels else "")

    def run(self, seconds: float) -> None:
        """Let time pass."""
        self._run(seconds)

    def close(self) -> None:
        """Give the GL objects back."""
        self.renderer.release()
        self.device.release()

    def _draw_hud(self, hud: Hud) -> None:
        canvas = Canvas(hud, self.session.settings.language)
        draw_overlays(self.session, canvas)
        if self.draw_over is not None:
            self.draw_over(self, canvas)
        if self._label:
            size = canvas.width / 26
            width = canvas.measure(self._label, size, "bold") + size
            canvas.panel(Rect(size / 2, size / 2, width, size * 1.5), PALETTE["paper"], radius=size / 2)
            canvas.text(size, size * 0.6, self._label, size, font="bold")
