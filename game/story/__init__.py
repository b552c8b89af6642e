"""Dialogue: scripts in YAML, their expression language, their checks, and the state of a talk."""

from game.story.acts import ActTable, load_acts
from game.story.beat import Beat, Choice, Chose, Event, Outcome, Spoken, Start, Stimulus, Timer, Warp
from game.story.engine import advance, resume
from game.story.filling import rehearse_choice, rehearse_line
from game.story.findings import CODES, Finding, Findings
from game.story.fix import fix_file
from game.story.lint import lint_files
from game.story.model import Item, NodeDef, Person, Script
from game.story.reader import load_script, shipped_stalls
from game.story.standing import StoryState
from game.story.state import Memory, afternoon_of, begin, memory_of, restore, save
from game.story.surroundings import load_person
from game.story.text import Text, wrap
from game.story.timing import TimedText, TimedWord
from game.story.translations import write_lock
from game.story.vocabulary import ACTS, ENV, OUTCOMES, STANDING_ACTS, Environment, Value

__all__ = [
    "ACTS",
    "CODES",
    "ENV",
    "OUTCOMES",
    "STANDING_ACTS",
    "ActTable",
    "Beat",
    "Choice",
    "Chose",
    "Environment",
    "Event",
    "Finding",
    "Findings",
    "Item",
    "Memory",
    "NodeDef",
    "Outcome",
    "Person",
    "Script",
    "Spoken",
    "Start",
    "Stimulus",
    "StoryState",
    "Text",
    "TimedText",
    "TimedWord",
    "Timer",
    "Value",
    "Warp",
    "advance",
    "afternoon_of",
    "begin",
    "fix_file",
    "lint_files",
    "load_acts",
    "load_person",
    "load_script",
    "memory_of",
    "rehearse_choice",
    "rehearse_line",
    "restore",
    "resume",
    "save",
    "shipped_stalls",
    "wrap",
    "write_lock",
]
