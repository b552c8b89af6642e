"""Drawing every node of a stall through the game's own window, headless, and judging what came out."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import cast
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from game.animation import Pose
from game.app.market import has_pictures
from game.app.screens import SettingsScreen, TableScreen, TalkScreen, TitleScreen
from game.app.session import Screen
from game.app.stage import StageShow
from game.app.step import StepAssets, new_world, targets_of
from game.app.window import Window
from game.app.world import TICK_S, World, enter_talk
from game.core.emotion_space import EMOTIONS
from game.core.humanoid import REFERENCE
from game.render import Device, FontSet, FrameView, Hud, Level
from game.tools.crawl.hands import Hands, on_picture
from game.tools.crawl.moments import Moment, moments_of
from game.tools.crawl.paper import Box, Fault
from game.tools.crawl.pixels import Photographs, Seen, judge, whole_box
from game.tools.crawl.probe import ProbeHud
from game.tools.crawl.visit import Look, session_of

__all__ = ["Darkroom", "Print", "develop"]

SETTLE_TICKS = 30
"""Before a picture the body has had so long to come into the feeling."""
ASKS_TICKS = 30
LINE_SHARE, LINE_MOST_S = 0.6, 1.6
"""A line is caught when so much of it has been spoken, or after so long."""
MOST_TICKS = 200
HANDS_SHOWN = frozenset({"home", "talk", "side", "glance", "offer"})
"""Shots that show the hands; a close-up is the face's."""
HEAD_M, HEAD_UP_M = 0.09, 0.1
"""The head: a ball of this radius, so far above its joint."""
AWAY_M = 60.0


@dataclass(frozen=True, eq=False)
class Print:
    """A finished picture (h, w, 3) and what is wrong with it.

    shown, felt: the strongest feeling; shot: the camera's name; scale: device pixels of a design pixel."""

    node: str
    kind: str
    look: Look
    picture: NDArray[np.uint8]
    faults: tuple[Fault, ...]
    scale: float
    shown: str = ""
    felt: str = ""
    shot: str = ""
    units: str = ""
    words: str = ""
    met: bool = True


class Darkroom:
    """A window nobody sees, at one stall. ``close`` gives its GL objects back."""

    def __init__(self, assets: StepAssets, look: Look, size: tuple[int, int], level: Level) -> None:
        self.assets, self.look = assets, look
        self.session = session_of(assets, look)
        stall = self.session.market.stalls[assets.talk.script.stall]
        stall.stand_in = not has_pictures(assets.talk.script.person.id, stall.id)
        self.device = Device.headless(*size)
        self.window = Window(self.session, self.device, level=level)
        self.fonts = FontSet.for_language("en")
        self._calm = self.session.world

    def close(self) -> None:
        """Give the GL objects back."""
        self.window.close()
        self.device.release()

    def screens(self) -> Iterator[Print]:
        """The screens around the talks."""
        for name, screen in (
            ("the title", TitleScreen()),
            ("the settings", SettingsScreen(TitleScreen())),
            ("the table", TableScreen()),
        ):
            self._begin(self._calm, screen)
            self._pass(2)
            yield self._take(name, "screen", None)

    def node(self, moment: Moment) -> Iterator[Print]:
        """A node while it speaks and when it asks, as the window shows it when the camera has come to rest."""
        felt, shown = moment.feelings(self.assets)
        fresh = new_world(self.assets, crc32(moment.node.encode()), language=self.look.language)
        world = enter_talk(self.assets, fresh, moment.talk)
        world = replace(world, felt=felt, shown=shown, felt_target=felt, shown_target=shown, queue=())
        self._begin(world, TalkScreen())
        self._pass(SETTLE_TICKS)
        if moment.lines:
            self.session.world = replace(self.session.world, queue=(moment.spoken,))
            self._hear()
            yield self._take(moment.node, "says", moment)
        if moment.asks:
            felt, shown = targets_of(self.assets, moment.talk)
            self.session.world = replace(
                self.session.world,
                felt_target=felt, shown_target=shown, speech=None, backlog=moment.lines or moment.talk.beat.lines[-1:],
            )  # fmt: skip
            self._pass(ASKS_TICKS)
            yield self._take(moment.node, "asks", moment)

    def _begin(self, world: World, screen: Screen) -> None:
        window = self.window
        self.session.world, window.screen = world, screen
        window.show = StageShow(window.stage)  # nothing of the last picture is left in cloth and hair

    def _pass(self, ticks: int) -> None:
        for _ in range(ticks):
            self.window.advance(TICK_S)

    def _hear(self) -> None:
        """Until the line is well under way; then it stands there whole, as for a player who has pressed a key."""
        for _ in range(MOST_TICKS):
            self._pass(1)
            world = self.session.world
            if world.speech is None:
                continue
            if world.time_s - world.speech.started_s >= min(LINE_SHARE * world.speech.timed.length_s, LINE_MOST_S):
                self.session.world = replace(world, speech=replace(world.speech, hurried=True))
                return

    def _take(self, node: str, kind: str, moment: Moment | None) -> Print:
        window, renderer = self.window, self.window.renderer
        goal = window.direction.glide
        window.direction = replace(window.direction, glide=replace(goal, length_s=0.0))
        view = window.frame()
        assert view.hud is not None
        probe = ProbeHud(renderer.hud)
        with_letters = self._draw(replace(view, hud=_through(view, probe)))
        scale = renderer.hud.scale
        letterless = self._draw(replace(view, hud=_through(view, ProbeHud(renderer.hud, letters=False))))
        scene = self._draw(replace(view, hud=None))
        gone = view.skin_matrices.copy()
        gone[..., 1, 3] -= np.float32(AWAY_M)
        empty = self._draw(replace(view, hud=None, skin_matrices=gone))
        photographs = Photographs(with_letters, letterless, scene, empty)
        seen = None if moment is None else self._seen(view)
        faults = [
            *self._broken(view, whole_box(with_letters, scale)),
            *judge(photographs, probe.written, seen, self.fonts, scale),
        ]
        if moment is None:
            return Print(node, kind, self.look, with_letters, tuple(faults), scale, shot=window.direction.shot)
        world = self.session.world
        library = self.assets.planner.library
        units = [library.units[i] for i in world.body.decisions.unit[0] if i >= 0]
        return Print(
            node, kind, self.look, with_letters, tuple(faults), scale,
            shown=_strongest(world.shown), felt=_strongest(world.felt), shot=window.direction.shot,
            units=", ".join(unit.name for unit in units if not unit.is_rest),
            words=moment.spoken.text(self.look.language) if moment.lines else "", met=moment.met,
        )  # fmt: skip

    def _draw(self, view: FrameView) -> NDArray[np.uint8]:
        self.window.renderer.draw(view)
        return self.window.renderer.read_pixels()

    def _broken(self, view: FrameView, whole: Box) -> Iterator[Fault]:
        """What GL complains of, and bodies that are nowhere."""
        error = self.device.context.error
        if error != "GL_NO_ERROR":
            yield Fault("gl", error, "the graphics driver refused something", whole)
        if not np.isfinite(view.skin_matrices).all():
            yield Fault("person", "the body", "a joint is nowhere (not a number)", whole)

    def _seen(self, view: FrameView) -> Seen:
        """Where head and hands are in the picture."""
        pose = self.session.world.body.pose
        assert isinstance(pose, Pose)
        rig, (width, height) = self.window.stage.rig, self.device.size
        hands = Hands.of(rig)
        head_joint = rig.driven[rig.source == REFERENCE.index["head"]]
        head = rig.joint_matrices(pose)[0, head_joint, :3, 3].astype(np.float64)
        around = np.array([(x, y) for x in np.linspace(-1, 1, 9) for y in np.linspace(-1, 1, 9) if x * x + y * y <= 1])
        ball = head + np.array([0.0, HEAD_UP_M, HEAD_M]) + np.pad(around * HEAD_M, ((0, 0), (0, 1)))

        def pixels(points: NDArray[np.float64]) -> NDArray[np.float64]:
            place = on_picture(view.camera, points, width / height)
            return (place * [0.5, -0.5] + 0.5) * [width, height]

        left, right = hands.places(pose)
        wanted = self.window.direction.shot in HANDS_SHOWN
        return Seen(pixels(ball), {"left": pixels(left), "right": pixels(right)}, wanted)


def _through(view: FrameView, probe: ProbeHud) -> Callable[[Hud], None]:
    drawn = view.hud
    assert drawn is not None

    def draw(hud: Hud) -> None:
        drawn(cast(Hud, probe))

    return draw


def _strongest(values: NDArray[np.float64]) -> str:
    at = int(np.argmax(values[:6]))
    return f"{EMOTIONS[at]} {values[at]:.2f}" if values[at] >= 0.1 else "calm"


def develop(assets: StepAssets, look: Look, size: tuple[int, int], level: Level, seed: int = 1) -> Iterator[Print]:
    """Every node of a stall, and the screens around it. ``assets`` with a performer and a face."""
    room = Darkroom(assets, look, size, level)
    try:
        yield from room.screens()
        for moment in moments_of(assets, seed):
            yield from room.node(moment)
    finally:
        room.close()
