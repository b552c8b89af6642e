"""The paper's figure 6: one dialogue in three rows, gestures only, success and failure, at the same moments.

One visit at one stall from one seed. The two lower rows differ only in what the player says: one answers what is
felt, the other says what is wrong and offers an insult. The upper row is the lower success again with posture and
mannerism held and the face at rest. Each picture carries the feeling (top left) and the active nodes (bottom left).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from game.animation import Mode
from game.app.policies import money
from game.app.step import StepAssets, new_world, step
from game.app.studio import Studio
from game.app.talk import Choice, TalkAssets, TalkState, ask_money, choose, start_talk
from game.app.ui import FEELING_COLOURS, INK, PALETTE, Canvas, Rect, fade
from game.app.world import Intent, World, enter_talk
from game.core.emotion_space import EMOTIONS, with_neutral
from game.core.errors import BadInput
from game.emotion import appraise, felt_label
from game.render import Camera, FontSet

__all__ = [
    "COLUMNS", "ROWS", "SIZE_PX", "draw_figure6", "film_talk", "insulting_policy", "listening_policy", "moments_of",
    "moves_of", "play_moves",
]  # fmt: skip

Pixels = NDArray[np.uint8]

COLUMNS = ("greeting", "first", "second", "third", "last")
ROWS: tuple[tuple[str, Mode, str], ...] = (
    ("gestures", "gestures", "success"), ("success", "full", "success"), ("failure", "full", "failure")
)  # fmt: skip
LABELS = {
    "en": {
        "gestures": "gestures only", "success": "success", "failure": "failure", "greeting": "the greeting",
        "first": "first answer", "second": "second answer", "third": "third answer", "last": "the end",
        "right": "taken well", "neutral": "taken calmly", "wrong": "taken ill", "": "",
    },
    "ja": {
        "gestures": "ジェスチャのみ", "success": "成功", "failure": "失敗", "greeting": "あいさつ",
        "first": "一つ目の返事", "second": "二つ目の返事", "third": "三つ目の返事", "last": "結末",
        "right": "好感", "neutral": "平静", "wrong": "反感", "": "",
    },
}  # fmt: skip
AFTER_S = 1.3
"""A picture is taken this long after the shopkeeper begins to answer: the reaction has reached the body."""
FIRST_S = 0.6
"""… or on the stroke of a gesture that comes no sooner than this."""
HOLD_S = 6.0
"""The player's next move comes this long after the answer has begun, and when all is said."""
PAUSE_S = 0.5
"""Between two lines."""
PATIENT_MOVES = 3
INSULT_SHARE = 0.3
MAX_TICKS = 30 * 300
SIZE_PX = (500, 440)
CAMERA = Camera((-0.09, 1.17, 2.85), (-0.09, 0.995, 0.0), 23.5, aspect=SIZE_PX[0] / SIZE_PX[1])
"""She stands right of the middle and leaves the left to the overlays."""
SIDE_PX = 60
Policy = Callable[[TalkAssets, TalkState, np.random.Generator], Choice]
_PAPER = np.array([250, 244, 232], dtype=np.float64)


def listening_policy(assets: TalkAssets, state: TalkState, rng: np.random.Generator) -> Choice:
    """The good player: answers what is felt with a line that will be taken well, and raises in small steps."""
    worth = {"right": 2.0, "neutral": 1.0, "wrong": 0.0}
    best, best_score = None, -1.0
    for option in state.beat.choices:
        if not option.available or option.act in {"offer", "leave"}:
            continue
        score = worth[appraise(assets.feelings, assets.person, state.feeling, option.act)]
        score += 0.01 * float(rng.random()) - (0.3 if option.act in {"wait", "press"} else 0.0)
        if score > best_score:
            best, best_score = option, score
    if best is None:
        best = next(option for option in state.beat.choices if option.act == "leave")
    ask = ask_money(state.list_price, state.bargain.ask)
    last = state.bargain.round >= assets.market.rounds - 1 or state.bargain.patience < 2.0
    if last and state.purse >= ask:
        return Choice(best.id, ask)
    if felt_label(assets.feelings, state.feeling) == "disgust":
        return Choice(best.id)
    opening = 0.5 if state.bargain.offer == 0 else state.bargain.offer + 0.06
    return Choice(best.id, money(opening * state.list_price, min(ask, state.purse)))


def insulting_policy(assets: TalkAssets, state: TalkState, rng: np.random.Generator) -> Choice:
    """The bad player: indifferent twice, then what will be taken ill, with offers that insult."""
    rude = state.bargain.round >= PATIENT_MOVES
    worth = {"wrong": 2.0 if rude else 1.0, "neutral": 1.0 if rude else 2.0, "right": 0.0}
    options = [o for o in state.beat.choices if o.available and o.act not in {"offer", "leave", "wait", "press"}]
    options = options or [o for o in state.beat.choices if o.available and o.act == "leave"]
    scores = [
        worth[appraise(assets.feelings, assets.person, state.feeling, "turn_to_go" if o.act == "leave" else o.act)]
        + 0.01 * float(rng.random())
        for o in options
    ]
    best = options[int(np.argmax(scores))]
    offer = max(int(state.list_price * INSULT_SHARE) // 10 * 10, 10) if rude and best.act != "leave" else None
    return Choice(best.id, offer)


def moves_of(assets: TalkAssets, item: str, seed: int, policy: Policy) -> list[Choice]:
    """All moves of one talk under a policy."""
    state, rng, moves = _start(assets, item, seed), np.random.default_rng([seed, 6]), list[Choice]()
    while not state.ended:
        moves.append(policy(assets, state, rng))
        state = choose(assets, state, moves[-1])
    return moves


def _start(assets: TalkAssets, item: str, seed: int) -> TalkState:
    return start_talk(assets, item, seed, purse=int(assets.script.items[item].list_price * 1.5))


def beats_of(moves: int) -> list[int]:
    """The columns of a talk of so many moves: the number of moves made before each picture, the last one at its end."""
    return [min(i, moves) for i in range(len(COLUMNS) - 1)] + [moves]


def play_moves(
    world: World, moves: Sequence[Choice], tick: Callable[[Intent], World]
) -> Iterator[tuple[int, float, World]]:
    """Play a talk through the step; for every tick (moves made, seconds since the answer began, world after it).

    The player decides HOLD_S after an answer began, so that two runs of the same moves keep the same time. Raises
    BadInput for a talk that does not end.
    """
    made, answered_s = 0, -1.0
    for _ in range(MAX_TICKS):
        speech, intent = world.speech, Intent()
        since_s = world.time_s - answered_s
        if speech is not None:
            intent = Intent(proceed=world.time_s - speech.started_s > speech.timed.length_s + PAUSE_S)
        elif world.waiting and answered_s >= 0.0 and since_s >= HOLD_S:
            intent, made, answered_s = Intent(choice=moves[made]), made + 1, -1.0
        elif world.over and answered_s >= 0.0 and since_s >= HOLD_S:
            return
        world = tick(intent)
        theirs = world.speech is not None and world.speech.line.speaker == "shopkeeper"
        if answered_s < 0.0 and (theirs or world.waiting or world.over):
            answered_s = world.time_s  # the answer begins, or there is none in words
        if answered_s >= 0.0:
            yield made, world.time_s - answered_s, world
    raise BadInput("figure 6", expected=f"a talk of at most {MAX_TICKS // 30} s", seen=f"seed {world.seed}")


def moments_of(assets: StepAssets, world: World, moves: Sequence[Choice]) -> list[float]:
    """When the columns' pictures are taken, seconds after each answer begins: on a gesture's stroke where there is one.

    Found by playing the talk without a body to look at.
    """
    blind = replace(assets, performer=None, face=None)
    layer = assets.planner.tables.gesture_layer
    now = [world]

    def tick(intent: Intent) -> World:
        now[0] = step(blind, now[0], intent)
        return now[0]

    strokes: dict[int, list[float]] = {}
    for made, since_s, seen in play_moves(world, moves, tick):
        decisions = seen.body.decisions
        if decisions.started[0, layer] and float(decisions.stroke_s[0, layer]) > 0.0:
            stroke_s = since_s + float(decisions.stroke_s[0, layer])
            if FIRST_S <= stroke_s <= HOLD_S - FIRST_S:
                strokes.setdefault(made, []).append(stroke_s)
    result: list[float] = []
    for i, beat in enumerate(beats := beats_of(len(moves))):
        again = beats[:i].count(beat)
        left = strokes.get(beat, [])[again:]
        result.append(left[0] if left else AFTER_S + 0.9 * again)
    return result


def film_talk(studio: Studio, world: World, moves: Sequence[Choice], moments_s: Sequence[float]) -> Iterator[World]:
    """Play the moves before the camera; yields at each column's moment, when its picture can be taken.

    With fewer moments than columns the film ends after the last of them.
    """
    studio.begin(world)

    def tick(intent: Intent) -> World:
        studio.tick(intent)
        return studio.session.world

    due = sorted(zip(beats_of(len(moves)), moments_s, strict=False))
    for made, since_s, seen in play_moves(world, moves, tick):
        while due and due[0][0] == made and due[0][1] <= since_s:
            due.pop(0)
            yield seen
        if not due:
            return


def draw_figure6(studio: Studio, seed: int, item: str) -> Pixels:
    """(h, w, 3): the three rows with their labels."""
    talk, language = studio.session.assets.talk, studio.session.settings.language
    labels, fonts = LABELS[language], FontSet.for_language(language)
    moves = {
        "success": moves_of(talk, item, seed, listening_policy),
        "failure": moves_of(talk, item, seed, insulting_policy),
    }
    studio.draw_over, studio.camera = _draw_state, CAMERA
    assets = studio.session.assets
    begun = enter_talk(assets, new_world(assets, seed, language=language), _start(talk, item, seed))
    moments_s = moments_of(assets, begun, moves["success"])
    rows: list[Pixels] = []
    for name, mode, story in ROWS:
        pictures: list[Pixels] = []
        for world in film_talk(studio, replace(begun, mode=mode), moves[story], moments_s):
            caption = ""
            if len(world.marks) > 1:
                mark = world.marks[-1]
                caption = f"{_short(mark.text_ja if language == 'ja' else mark.text_en)} · {labels[mark.quality]}"
            pictures.append(_captioned(studio.picture(), caption, fonts))
        rows.append(np.concatenate([_side(labels[name], pictures[0].shape[0], fonts), *pictures], axis=1))
    width = studio.device.size[0]
    heads = (_strip(labels[name], 44, width, fonts, 24, "bold") for name in COLUMNS)
    head = np.concatenate([_blank(44, SIDE_PX), *heads], axis=1)
    return np.concatenate([head, *rows], axis=0)


def _draw_state(studio: Studio, canvas: Canvas) -> None:
    """The feeling's bars at the top left and the active nodes at the bottom left, large enough for a small picture."""
    world, s = studio.session.world, studio.session.strings
    felt = with_neutral(world.felt)
    canvas.panel(Rect(16, 16, 420, 352), PALETTE["shade"], radius=26)
    for i, name in enumerate(EMOTIONS):
        y = 30 + i * 48
        canvas.text(34, y - 8, s(name), 36, PALETTE["white"])
        canvas.bar(Rect(196, y + 6, 222, 22), float(felt[i]), FEELING_COLOURS[name], (1, 1, 1, 0.16))
    library, decisions = studio.session.assets.planner.library, world.body.decisions
    layers, held = studio.session.assets.planner.tables.layers, world.mode == "gestures"
    top = canvas.height - 20 - 56 * len(layers) - 16
    canvas.panel(Rect(20, top, 700, 56 * len(layers) + 16), PALETTE["shade"], radius=26)
    for row, layer in enumerate(layers):
        at_y, index = top + 8 + row * 56, int(decisions.unit[0, row])
        unit = library.units[index]
        title = "—" if unit.is_rest or (held and layer != "gesture") else f"{index}  {unit.title(s.language)}"
        canvas.text(40, at_y + 2, s(layer), 34, fade(PALETTE["white"], 0.66))
        size = 38.0 * min(1.0, 450.0 / max(canvas.measure(title, 38, "bold"), 1.0))
        canvas.text(250, at_y + (38.0 - size) / 2, title, size, PALETTE["white"], font="bold")


def _blank(height: int, width: int) -> Pixels:
    return np.broadcast_to(_PAPER.astype(np.uint8), (height, width, 3)).copy()


def _strip(text: str, height: int, width: int, fonts: FontSet, size_px: int, role: str) -> Pixels:
    """A strip of paper with a line in its middle."""
    out = _blank(height, width)
    if not text:
        return out
    while size_px > 8 and fonts.width(text, role, size_px) > width - 8:
        size_px -= 1
    coverage = fonts.draw(text, role, size_px).coverage[:height, :width]
    h, w = coverage.shape
    y, x = (height - h) // 2, (width - w) // 2
    share = coverage[..., None] / 255.0
    ink = 255.0 * np.array(INK[:3])
    out[y : y + h, x : x + w] = (_PAPER * (1.0 - share) + ink * share).round().astype(np.uint8)
    return out


def _side(text: str, height: int, fonts: FontSet) -> Pixels:
    """The row's name, read from below."""
    return np.ascontiguousarray(np.rot90(_strip(text, SIDE_PX, height, fonts, 30, "title")))


def _short(text: str, most: int = 34) -> str:
    """What was said, cut at a word where it is long."""
    if len(text) <= most:
        return f"“{text}”"
    cut = text[:most]
    return f"“{cut[: cut.rindex(' ')] if ' ' in cut else cut}…”"


def _captioned(picture: Pixels, caption: str, fonts: FontSet) -> Pixels:
    picture = picture.copy()
    picture[:, -4:] = _PAPER.astype(np.uint8)
    return np.concatenate([picture, _strip(caption, 34, picture.shape[1], fonts, 19, "body")], axis=0)
