"""Choices per second: the story engine against inkjs on the same talk, alone and with feelings and market, and whole
negotiations.

Both sides are timed by what their process took of a processor, compiling and collecting included, so that other work
on the machine weighs on neither.
"""

from __future__ import annotations

import json
import shutil
import statistics
import subprocess
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from game.app.autoplay import play_episode
from game.app.bench_rows import Row, row
from game.app.content import load_talk_assets, stall_path
from game.app.policies import Seat, seat
from game.app.talk import Choice, TalkAssets, choose, start_talk
from game.core.errors import BadInput
from game.core.paths import ASSETS
from game.story import Chose, Script, Start, advance, begin, load_script

__all__ = ["patient_talk", "rows"]

TALK = ASSETS / "bench" / "ten_choices.yaml"
INK = ASSETS / "bench" / "ten_choices.ink"
CHOICES, REPEATS, TALKS = 10, 7, 60

# The same draws, by a generator of small whole numbers that costs neither side much, and the same count: random choices
# until nothing can be chosen any more.
_NODE = """
const fs = require('fs'), load = require('module').createRequire(process.argv[2]);
const {Compiler} = load('inkjs/full'), {Story} = load('inkjs');
const story = new Story(new Compiler(fs.readFileSync(process.argv[3], 'utf8')).Compile().ToJson());
let seed = 1;
const draw = n => { seed = (seed * 75 + 74) % 65537; return Math.floor(seed * n / 65537); };
function play() {
  story.ResetState();
  for (let made = 0;; made++) {
    while (story.canContinue) story.Continue();
    if (!story.currentChoices.length) return made;
    story.ChooseChoiceIndex(draw(story.currentChoices.length));
  }
}
const talks = +process.argv[5], rates = [];
for (let i = 0; i < 10 * talks; i++) play();
for (let r = 0; r < +process.argv[4]; r++) {
  const begun = process.cpuUsage();
  let made = 0;
  for (let i = 0; i < talks; i++) made += play();
  const taken = process.cpuUsage(begun);
  rates.push(made / ((taken.user + taken.system) / 1e6));
}
console.log(JSON.stringify(rates));
"""


def inkjs_rates(folder: Path) -> list[float]:
    """Choices per second of processor time of inkjs. folder: where ``npm install inkjs`` was run.

    Raises BadInput without it or node.
    """
    node, package = shutil.which("node"), folder.resolve() / "node_modules" / "inkjs"
    if node is None:
        raise BadInput("--inkjs", expected="node on the PATH", seen="none")
    if not (package / "package.json").is_file():
        raise BadInput("--inkjs", expected="a folder where `npm install inkjs` was run", seen=str(folder))
    command = [node, "-e", _NODE, "bench", str(package / "package.json"), str(INK), str(REPEATS), str(TALKS)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    if done.returncode:
        raise BadInput("--inkjs", expected="a run of inkjs", seen=(done.stderr.strip().splitlines() or ["nothing"])[-1])
    return [float(rate) for rate in json.loads(done.stdout)]


def story_choices(script: Script, first_seed: int) -> int:
    """Play ``TALKS`` talks of the bench script, a fixed draw at every choice; how many choices were made."""
    made, draw = 0, 1
    for seed in range(first_seed, first_seed + TALKS):
        state, beat = advance(script, begin(script, "cup", seed), Start(), {})
        while beat.ended is None:
            draw = (draw * 75 + 74) % 65537
            choice = beat.choices[draw * 4 // 65537]
            state, beat = advance(script, state, Chose(choice.id), {})
            made += 1
    return made


def patient_talk() -> TalkAssets:
    """The bench talk with a shopkeeper who stays for all ten choices: nothing ends it sooner."""
    assets = load_talk_assets(TALK)
    market = replace(assets.market, rounds=2 * CHOICES, sudden_end_chance=0.0)
    return replace(assets, market=market, person=replace(assets.person, patience=10.0 * CHOICES))


def felt_choices(assets: TalkAssets, first_seed: int) -> int:
    """As ``story_choices``, each choice with what the shopkeeper feels at it and what the market makes of it."""
    made, draw = 0, 1
    for seed in range(first_seed, first_seed + TALKS):
        state = start_talk(assets, "cup", seed, purse=1000)
        while not state.ended:
            draw = (draw * 75 + 74) % 65537
            state = choose(assets, state, Choice(state.beat.choices[draw * 4 // 65537].id))
            made += 1
    return made


def _rates(play: Callable[[int], int], repeats: int) -> list[float]:
    """What ``play(repeat)`` counts per second of processor time, once warm."""
    rates = []
    play(0)
    for repeat in range(repeats):
        begun = time.process_time()
        made = play(repeat)
        rates.append(made / (time.process_time() - begun))
    return rates


def rows(inkjs: Path | None) -> list[Row]:
    """The table's rows; with a folder of inkjs the first one has it as its floor, measured in the same run, medians
    and the best of either side."""
    script = load_script(TALK)
    rates = _rates(lambda repeat: story_choices(script, repeat * TALKS), REPEATS)
    ink = None if inkjs is None else inkjs_rates(inkjs)
    floor = None if ink is None else statistics.median(ink)
    found = [
        row("autoplay: story engine, ten-choice talk (floor: inkjs), choices/s", rates, unit="/s", floor=floor,
            wanted=">= 10 x", more_is_better=True)
    ]  # fmt: skip
    if ink is not None:
        found.append(row("autoplay: inkjs, the same talk, choices/s", ink, unit="/s", more_is_better=True))
    patient = patient_talk()
    found.append(
        row("autoplay: the same talk with feelings and market, choices/s",
            _rates(lambda repeat: felt_choices(patient, repeat * TALKS), REPEATS), unit="/s", floor=floor,
            more_is_better=True)
    )  # fmt: skip
    assets = load_talk_assets(stall_path("flea"))
    for policy in ("random", "oracle"):
        found += _negotiation(policy, seat(assets, policy))
    return found


def _negotiation(policy: str, player: Seat) -> list[Row]:
    def talks(repeat: int) -> list[int]:
        return [len(list(play_episode(player, 1, repeat * TALKS + i))) for i in range(TALKS)]

    made = {
        "choices/s": _rates(lambda repeat: sum(talks(repeat)), REPEATS),
        "episodes/s": _rates(lambda repeat: len(talks(repeat)), REPEATS),
    }
    return [
        row(f"autoplay: whole negotiation, {policy}, {what}", rates, unit="/s", more_is_better=True)
        for what, rates in made.items()
    ]
