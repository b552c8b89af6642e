"""The window's screens: title, table, talk, outcome, settings."""

from game.app.screens.outcome import OutcomeScreen
from game.app.screens.table import DayOverScreen, TableScreen
from game.app.screens.talk import TalkScreen
from game.app.screens.title import SettingsScreen, TitleScreen
from game.app.session import Screen, Session

__all__ = [
    "DayOverScreen",
    "OutcomeScreen",
    "Screen",
    "Session",
    "SettingsScreen",
    "TableScreen",
    "TalkScreen",
    "TitleScreen",
]
