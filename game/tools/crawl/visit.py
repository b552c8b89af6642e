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
from game.app.talk import TalkState, start_talk, talk_env, warp_talk
from game.app.world import World, enter_talk
from game.core.errors import BadInput
from game.render import FontSet
from game.story import STANDING_ACTS, Beat, Spoken, rehearse_choice, rehearse_line
from game.story import Choice as StoryChoice
from game.tools.crawl.paper import Box, Fault, PaperCanvas, PaperHud

__all__ = ["Finding", "Look", "beats_of", "crawl_stall", "session_of"]

SEEDS = 8
"""Pools are drawn: so many draws are tried to see every choice of a node."""
SCALES = (1.0, 2.0)
MOST_OFFERED = 4
"""Choices on the table at once, beside the offer, waiting and going."""


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
    nodes = {node: beats_of(assets, node) for node in assets.talk.script.nodes}
    for language in languages:
        fonts = FontSet.for_language(language)
        for scale in scales:
            look = Look(language, scale)
            session = session_of(assets, look)
            for node, screen, world in _pictures(session, nodes):
                session.world = world
                hud = PaperHud(fonts)
                screen.draw(session, PaperCanvas(hud, language, scale))
                count += 1
                for fault in hud.faults:
                    key = (fault.kind, fault.text, language, scale)
                    found.setdefault(key, Finding(node, look, fault, tuple(hud.panels), tuple(hud.texts)))
    return list(found.values()), count


def session_of(assets: StepAssets, look: Look) -> Session:
    """A day that has just begun at a stall, seen in one language and size of text; nothing of it is ever saved."""
    world = new_world(assets, 1, language=look.language)
    settings = Settings(language=look.language, ui_scale=look.scale)
    session = Session(assets, world, load_strings(look.language), settings, Afternoon(1), Market.single(assets))
    session.open_day()
    return session


def beats_of(assets: StepAssets, node: str) -> list[TalkState]:
    """A node as it may be met: with different draws of its pools, until nothing new comes; then, in the place of what
    can be said there, everything that no draw brought: lines and choices behind conditions, other wordings."""
    script = assets.talk.script
    item = next(iter(script.items))
    states: list[TalkState] = []
    seen: set[str] = set()
    begun = start_talk(assets.talk, item, 0, purse=9000)
    for seed in range(SEEDS):
        try:
            talk = warp_talk(assets.talk, replace(begun, story=begun.story.with_seed(seed)), node)
        except BadInput:
            break
        new = {choice.id for choice in talk.beat.choices} | {line.id for line in talk.beat.lines}
        if not new - seen:
            break
        seen |= new
        states.append(talk)
    base = states[0] if states else begun
    return [*states, *(replace(base, beat=beat) for beat in _hidden(assets, base, node, states))]


def _hidden(assets: StepAssets, base: TalkState, node: str, states: list[TalkState]) -> Iterator[Beat]:
    """Beats with what no draw brought: every line, every wording of every choice, as many as are offered at once."""
    script, env = assets.talk.script, talk_env(base, assets.talk)
    place = script.nodes[node]
    said = {line.id for talk in states for line in talk.beat.lines}
    lines = [
        rehearse_line(script, base.item, line, env) for say in place.says for line in say.lines if line.id not in said
    ]
    offered = {(choice.id, choice.en) for talk in states for choice in talk.beat.choices}
    wordings = [
        rehearse_choice(script, base.item, choice, line, env)
        for choice in [c for pool in place.pools for c in script.pools[pool]] + list(place.choices)
        for line in choice.texts
    ]
    hidden = [choice for choice in wordings if (choice.id, choice.en) not in offered]
    standing = tuple(choice for choice in base.beat.choices if choice.act in STANDING_ACTS)
    if lines:
        yield base.beat._replace(node=node, lines=tuple(lines))
    for at in range(0, len(hidden), MOST_OFFERED):
        yield base.beat._replace(node=node, lines=(), choices=(*hidden[at : at + MOST_OFFERED], *standing))


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
                shown = replace(talk, beat=talk.beat._replace(choices=choices))
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
