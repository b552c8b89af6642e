"""The window's inside: actions in, fixed ticks, one frame out. Everything it does to the game is an Intent."""

from __future__ import annotations

from dataclasses import replace

from game.app.cards import Cards
from game.app.director import direct, moment_of, start_direction
from game.app.gallery import Gallery
from game.app.input import Action
from game.app.market import read_stage
from game.app.opening import AUTOSAVE, resume_game, take_up
from game.app.overlays.inspector import Inspector
from game.app.overlays.notice import draw_notice
from game.app.overlays.timings import FRAMES_SHOWN, draw_timings
from game.app.passersby import Known, Passersby, load_cast
from game.app.photo import PhotoMode, fine_factor, photo_folder, photo_path, smaller
from game.app.picking import Picker
from game.app.pictures import write_png
from game.app.reading import save_read
from game.app.saves import save_game
from game.app.screens import InspectScreen, OutcomeScreen, SlotsScreen, TableScreen, TalkScreen, TitleScreen
from game.app.session import Screen, Session, saved_game
from game.app.settings import TIMERS, user_folder
from game.app.slots import QUICK, keep
from game.app.stage import StageAssets, StageShow
from game.app.tells import Tell
from game.app.ui import Canvas
from game.app.world import TICK_S, Intent
from game.core.errors import BadInput
from game.render import (
    DEFAULT,
    DESIGN_SHARE,
    Camera,
    Device,
    FontSet,
    FrameView,
    Hud,
    ItemView,
    Level,
    MissingFont,
    Relief,
    Renderer,
    ladder,
    relieve,
)

__all__ = ["Window"]

MAX_TICKS_A_FRAME = 5
"""After a stall (a dragged window) the simulation catches up by at most this much, then lets time go."""
THUMB_SIZE = (512, 288)
TELL_SIZE = (384, 300)
TELL_CAMERA = Camera((0.0, 1.17, 3.02), (0.0, 1.02, 0.0), 21.2, aspect=TELL_SIZE[0] / TELL_SIZE[1])


class Window:
    """The window loop's body, the same with and without a real window."""

    def __init__(
        self, session: Session, device: Device, level: Level | None = None, screen: Screen | None = None
    ) -> None:
        self.session = session
        self.device = device
        self.stage = self._stage_here()
        self._stall = session.stall
        self.renderer = Renderer(
            device,
            self.stage.model,
            self.stage.stall,
            self.stage.backdrop,
            level=level or DEFAULT,
            fonts=FontSet.for_language("en"),
        )
        self.gallery = Gallery(device)
        self.cards = Cards(device, self.gallery)
        self.show = StageShow(self.stage)
        self.screen: Screen = screen or TitleScreen()
        self.inspector = Inspector()
        self.direction = start_direction(session.stall)
        self.frames_ms: list[float] = []
        self._steps, self._relief = ladder(self.renderer.level), Relief()
        self.photo: PhotoMode | None = None
        self.crowd: Passersby | None = None
        self._models: Known = {}
        self._language = _speakable(session)
        self._late_s = 0.0
        self._picker: tuple[object, Picker] | None = None
        self._tells: dict[str, Tell] = {}
        self._tick(None)

    def populate(self) -> None:
        """Passers-by from now on: they are not needed for the first picture, so they come after it."""
        assets = self.session.assets
        assert assets.performer is not None
        cast = load_cast(self.stage.model.name, known=self._models)
        self.renderer.meet(cast.looks)
        self.crowd = Passersby(cast, assets.planner, assets.performer, self.session.world.seed)

    def set_quality(self, level: Level, *, fixed: bool) -> None:
        """The level that was picked, or that the player wants (``fixed``)."""
        self.renderer.set_scale(1.0)
        if self.renderer.level is not level:
            self.renderer.set_level(level)
        self._steps, self._relief = ladder(level, fixed=fixed), Relief()

    def note_frame(self, frame_ms: float) -> None:
        """How long the last frame took: what stays too slow is drawn simpler, and at the very end smaller."""
        self.frames_ms = [*self.frames_ms[-FRAMES_SHOWN + 1 :], frame_ms]
        before = self._relief.at
        self._relief = relieve(self._relief, frame_ms, len(self._steps))
        if self._relief.at != before:
            step = self._steps[self._relief.at]
            if step.level is not self.renderer.level:
                self.renderer.set_level(step.level)
            self.renderer.set_scale(step.scale)

    def close(self) -> None:
        """Give the GL objects back."""
        self.gallery.release()
        self.renderer.release()

    def handle(self, action: Action) -> None:
        """One action of the player."""
        if action.kind == "quit":
            self.session.running = False
            self.keep()
            return
        if action.kind == "key" and action.key == "f11":
            self.session.settings = self.session.settings.next("fullscreen")
            return
        if self.photo is not None:
            if not self.photo.handle(action, self.device.size[1]):
                self.photo = None
            elif self.photo.wants_picture:
                self._photograph(self.photo)
            return
        if action.kind == "key" and action.key == "f8":
            self.renderer.times.on = not self.renderer.times.on
            return
        if action.kind == "key" and action.key == "f9":
            calm = self.session.settings.reduced_motion
            self.photo = PhotoMode(self.direction.camera(self.session.world.time_s + self._late_s), reduced_motion=calm)
            return
        if action.kind == "key" and action.key in {"f6", "f7"}:
            self._quick(save=action.key == "f6")
            return
        action = self._in_reference(action)
        if action.at is not None:
            self.session.pointed = self.picker().at(action.at, self.session.afternoon.owned(self.session.stall))
        if not self.inspector.handle(self.session, action):
            self._go(self.screen.handle(self.session, action))
        if isinstance(self.screen, SlotsScreen) and self.screen.wanted:
            self._keep(self.screen.wanted)
            self.screen = self.screen.written()

    def _keep(self, slot: str) -> None:
        """Save into a slot, with a picture of what was seen last without the interface."""
        session = self.session
        if session.designed or not session.afternoon.wishes:
            return
        try:
            keep(
                user_folder(),
                slot,
                saved_game(session),
                self.renderer.snapshot(replace(self.frame(), hud=None), THUMB_SIZE),
            )
            session.say(session.strings("saved"))
            self.gallery.drop(f"slot:{slot}")
        except BadInput as error:
            session.say(session.strings("save_failed", reason=str(error)[:160]))

    def _quick(self, *, save: bool) -> None:
        session, path = self.session, user_folder() / f"{QUICK}.json"
        if save:
            self._keep(QUICK)
        elif path.is_file():
            try:
                resume_game(session, path)
                session.say(session.strings("loaded"))
            except BadInput as error:
                session.say(session.strings("save_kept", reason=str(error)[:120]))
                return
            self._follow()
            self._go(TableScreen.where_it_was(session))

    def _photograph(self, photo: PhotoMode) -> None:
        """Take the picture without the interface and say where it is."""
        photo.wants_picture = False
        size, s = self.device.size, self.session.strings
        factor = fine_factor(size, photo.fine)
        view = replace(self.frame(), camera=photo.camera(), hud=None)
        pixels = self.renderer.snapshot(view, (size[0] * factor, size[1] * factor))
        try:
            path = photo_path(photo_folder())
            write_png(path, smaller(pixels, factor))
        except BadInput as error:
            photo.say(s("photo_failed", reason=str(error)[:160]))
        else:
            photo.say(s("photo_saved", path=str(path)))

    def _in_reference(self, action: Action) -> Action:
        if action.at is None:
            return action
        scale = min(self.device.size[0] / 1280.0, self.device.size[1] / 720.0)
        return replace(action, at=(action.at[0] / scale, action.at[1] / scale))

    def picker(self) -> Picker:
        """Where the goods are in the present picture, in reference pixels."""
        camera = self.stage.framed(self.direction.camera(self.session.world.time_s + self._late_s))
        (width, height), scale = self.device.size, min(self.device.size[0] / 1280.0, self.device.size[1] / 720.0)
        key = (self._stall, camera, self.device.size)
        if self._picker is None or self._picker[0] != key:
            size = (width / scale, height / scale)
            self._picker = (key, Picker.of(self.stage.stall, self.stage.cards, camera, size))
        return self._picker[1]

    def _go(self, screen: Screen | None) -> None:
        if screen is not None:
            self.screen = screen
            self.keep()

    def keep(self) -> None:
        """Save the game as it stands, where there is one."""
        session = self.session
        if session.designed or not session.taken_up or not session.afternoon.wishes:
            return  # nothing has begun that could be lost, and something may be saved that has
        try:
            save_game(user_folder() / AUTOSAVE, saved_game(session))
            save_read(session.read, user_folder())
        except BadInput as error:
            session.say(session.strings("save_failed", reason=str(error)[:160]))

    def _stage_here(self) -> StageAssets:
        stall = self.session.market.stalls[self.session.stall]
        if stall.stage is None:
            stall.stage = read_stage(stall, self.session.market.avatar)
        return stall.stage

    def _follow(self) -> None:
        """Take in what has been loaded, and draw the stall the player stands at."""
        session = self.session
        if session.loader is not None:
            session.loader.poll()
            if session.loader.scripts_read and not session.taken_up:
                take_up(session)
        if session.stall != self._stall:
            self._stall, self.stage = session.stall, self._stage_here()
            self.renderer.set_stage(self.stage.model, self.stage.stall, self.stage.backdrop)
            self.show = StageShow(self.stage)
            if self.crowd is not None:
                self.populate()

    def _tick(self, intent_from: Screen | None) -> None:
        session = self.session
        self._follow()
        intent = Intent() if intent_from is None else intent_from.intent()
        wanted = TIMERS[session.settings.timers]
        if session.world.timers != wanted:
            session.world = replace(session.world, timers=wanted)
        session.tick(intent)
        assert session.world.body.pose is not None
        self.show.tick(session.world.body.pose, TICK_S, session.world.body)
        if self.crowd is not None and self.renderer.level.people:
            self.crowd.tick(session.world)
        assert self.show.puppet is not None
        session.watch.tick(session.assets, session.world, self.show.puppet.after[0])
        if intent.choice is not None:
            self.keep()
        self._go(self.screen.after_tick(session))
        self._direct()

    def _direct(self) -> None:
        session, screen = self.session, self.screen
        if session.journal is not None:
            session.journal.shows(session, screen.scene)
        offering = isinstance(screen, TalkScreen) and screen.offering
        moment = moment_of(session.world, screen.scene, place=session.stall, offering=offering)
        calm, scale = session.settings.reduced_motion, session.settings.ui_scale
        self.direction = direct(self.direction, moment, reduced_motion=calm, text_scale=scale)

    def advance(self, elapsed_s: float) -> None:
        """Let the game run for some real time, in whole ticks; in photo mode time stands still.

        A clock that jumps (a suspended machine, a corrected time) is a moment without news: never back, never a flood.
        """
        if not elapsed_s > 0.0:  # nan too
            elapsed_s = 0.0
        if self.photo is not None:
            self.photo.advance(elapsed_s)
            return
        self.inspector.reloader.advance(self.session, elapsed_s)
        if self.inspector.units is not None:
            self.inspector.units.advance(self.session, elapsed_s)
            assets = self.session.assets
            if self.crowd is not None and assets.performer is not None:
                self.crowd.take_up(assets.planner, assets.performer)
        self._late_s = min(self._late_s + elapsed_s, MAX_TICKS_A_FRAME * TICK_S)
        while self._late_s >= TICK_S:
            self._late_s -= TICK_S
            self._tick(self.screen)

    def draw(self) -> None:
        """One frame of whatever is on screen."""
        session = self.session
        self._follow()
        if session.settings.language != self._language:
            self._language = _speakable(session)
        if self.show.puppet is None:
            self._tick(None)  # a stall was just reached: nobody has moved there yet
        if self.photo is None:
            self._paint_pictures()
        self.renderer.draw(self.frame())

    def frame(self) -> FrameView:
        """The present moment as the renderer wants it."""
        session = self.session
        params = session.world.body.face_params
        assert params is not None
        played = self.screen.played()
        now_s = session.world.time_s + self._late_s
        return self.show.frame(
            params if played is None else played[1],
            matrices=None if played is None else played[0],
            camera=self.direction.camera(now_s) if self.photo is None else self.photo.camera(),
            share=self._late_s / TICK_S,
            show_face=session.world.mode != "body",
            hidden_items=self.stage.gone(session.afternoon.owned(session.stall)),
            time_s=now_s,
            crowd=None if self.crowd is None else self.crowd.view(self._late_s / TICK_S),
            day_share=session.day_share if session.afternoon.wishes else DESIGN_SHARE,
            item=self._item_shown(),
            hud=self._draw_hud,
        )

    def _item_shown(self) -> ItemView | None:
        """The item in the player's hand."""
        screen = self.screen
        if not isinstance(screen, InspectScreen):
            return None
        hand, group = screen.handling, f"item:{screen.item}"
        if group not in self.stage.stall.anchors:
            return None
        yaw, pitch = hand.ahead(self._late_s, reduced_motion=self.session.settings.reduced_motion)
        return ItemView(group, yaw, pitch, hand.zoom, self.stage.cards.get(screen.item))

    def _paint_pictures(self) -> None:
        """Pictures of the stalls for the map: one a frame, where a hitch is not seen."""
        market = self.session.market
        if isinstance(self.screen, OutcomeScreen):
            self._paint_tells(self.screen)
        if self.screen.scene not in {"title", "market"} or len(market.order) < 2:
            return
        if "backdrop" not in self.gallery.names():
            self.gallery.put("backdrop", self.stage.backdrop)
        stalls = [market.stalls[name] for name in market.order if name in market.stalls]
        owned = {stall.id: self.session.afternoon.owned(stall.id) for stall in stalls}
        self.cards.paint_next(stalls, owned, self.renderer.level, self.session.afternoon.seed)

    def _paint_tells(self, screen: OutcomeScreen) -> None:
        """The moments in which the body told most, one a frame."""
        for i, tell in enumerate(screen.watch.tells):
            name = f"tell:{i}"
            if self._tells.get(name) is not tell:
                view = self.show.frame(
                    tell.params,
                    matrices=tell.matrices,
                    camera=TELL_CAMERA,
                    hidden_items=self.stage.gone(self.session.afternoon.owned(self.session.stall)),
                    day_share=self.session.day_share,
                )
                self.gallery.put(name, self.renderer.snapshot(view, TELL_SIZE))
                self._tells[name] = tell
                return

    def _draw_hud(self, hud: Hud) -> None:
        settings = self.session.settings
        canvas = Canvas(hud, settings.language, settings.ui_scale, self.gallery, settings.high_contrast)
        if self.photo is not None:
            self.photo.draw(self.session.strings, canvas)
            return
        self.screen.draw(self.session, canvas)
        draw_notice(self.session, canvas, self.screen.scene)
        self.inspector.draw(self.session, canvas)
        if self.renderer.times.on:
            draw_timings(self.renderer, self.frames_ms, canvas)


def _speakable(session: Session) -> str:
    """The language there is a font for: without a Japanese one the game says so and stays in English."""
    if session.settings.language == "ja":
        try:
            FontSet.for_language("ja")
        except MissingFont as error:
            session.say(str(error))
            session.settings = replace(session.settings, language="en")
            session.strings = session.strings.switched("en")
            session.world = replace(session.world, language="en")
    return session.settings.language
