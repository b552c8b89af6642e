"""Visiting everything a stall can say: every node, every line and every choice of it, in both languages and sizes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from game.app.afternoon import Afternoon
from game.app.loading import load_step_assets
from game.app.market import Market
from game.app.screens import SettingsScreen, TableScreen, TalkScreen, TitleScreen
from game.app.session import Screen, Session
from game.app.settings import Settings
from game.app.step import StepAssets, new_world
from game.app.strings import load_strings
from game.app.talk import TalkState, start_talk, warp_talk
from game.app.world import World, enter_talk
from game.core.errors import BadInput
from game.render import FontSet
from game.story import Choice as StoryChoice
from game.story import Spoken
from game.tools.crawl.paper import Box, Fault, PaperCanvas, PaperHud

__all__ = ["Finding", "Look", "crawl_stall"]

SEEDS = 8
"""Pools are drawn: so many draws are tried to see every choice of a node."""
SCALES = (1.0, 2.0)


@dataclass(frozen=True)
class Look:
    """How something is looked at."""

    language: str
    scale: float


@dataclass(frozen=True)
class Finding:
    """A fault with its place. panels, texts: the whole picture, for a thumbnail."""

    node: str
    look: Look
    fault: Fault
    panels: tuple[Box, ...]
    texts: tuple[Box, ...]


def crawl_stall(stall: str, languages: Iterable[str], scales: Iterable[float] = SCALES) -> tuple[list[Finding], int]:
    """The findings of a stall, and how many pictures were measured. Raises BadInput for a stall with errors."""
    assets = load_step_assets(stall, body=False)
    found: dict[tuple[str, str, str, float], Finding] = {}
    count = 0
    nodes = {node: _beats(assets, node) for node in assets.talk.script.nodes}
    for language in languages:
        fonts = FontSet.for_language(language)
        for scale in scales:
            look = Look(language, scale)
            session = _session(assets, look)
            for node, screen, world in _pictures(session, nodes):
                session.world = world
                hud = PaperHud(fonts)
                screen.draw(session, PaperCanvas(hud, language, scale))
                count += 1
                for fault in hud.faults:
                    key = (fault.kind, fault.text, language, scale)
                    found.setdefault(key, Finding(node, look, fault, tuple(hud.panels), tuple(hud.texts)))
    return list(found.values()), count


def _session(assets: StepAssets, look: Look) -> Session:
    world = new_world(assets, 1, language=look.language)
    settings = Settings(language=look.language, ui_scale=look.scale)
    session = Session(assets, world, load_strings(look.language), settings, Afternoon(1), Market.single(assets))
    session.open_day()
    return session


def _beats(assets: StepAssets, node: str) -> list[TalkState]:
    """A node as it may be met: with different draws of its pools, until nothing new comes."""
    script = assets.talk.script
    item = next(iter(script.items))
    states: list[TalkState] = []
    seen: set[str] = set()
    for seed in range(SEEDS):
        try:
            talk = warp_talk(assets.talk, start_talk(assets.talk, item, seed, purse=9000), node)
        except BadInput:
            return states
        new = {choice.id for choice in talk.beat.choices} | {line.id for line in talk.beat.lines}
        if not new - seen:
            break
        seen |= new
        states.append(talk)
    return states


def _pictures(session: Session, nodes: dict[str, list[TalkState]]) -> Iterator[tuple[str, Screen, World]]:
    yield "the title", TitleScreen(), session.world
    yield "the settings", SettingsScreen(TitleScreen()), session.world
    yield "the table", TableScreen(), session.world
    said: set[tuple[str, ...]] = set()
    for node, talks in nodes.items():
        for talk in talks:
            for lines, choices in _portions(talk):
                key = tuple([line.id for line in lines] + [choice.id for choice in choices])
                if key in said:
                    continue
                said.add(key)
                shown = replace(talk, beat=replace(talk.beat, choices=choices))
                world = enter_talk(session.assets, session.world, shown)
                screen = TalkScreen()
                world = replace(world, queue=(), backlog=lines)
                session.world = world
                screen.after_tick(session)
                yield node, screen, world


def _portions(talk: TalkState) -> Iterator[tuple[tuple[Spoken, ...], tuple[StoryChoice, ...]]]:
    """Every line by itself, over the choices there are."""
    for line in talk.beat.lines:
        yield (line,), talk.beat.choices
    if not talk.beat.lines:
        yield (), talk.beat.choices
