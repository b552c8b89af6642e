"""The window's screens: title, list, street, table, talk, outcome, epilogue, settings."""

from game.app.screens.epilogue import EpilogueScreen
from game.app.screens.history import HistoryScreen
from game.app.screens.inspect import InspectScreen
from game.app.screens.market import MarketScreen, WalkScreen
from game.app.screens.outcome import OutcomeScreen
from game.app.screens.slots import SlotsScreen
from game.app.screens.table import TableScreen
from game.app.screens.talk import TalkScreen
from game.app.screens.title import SettingsScreen, TitleScreen
from game.app.screens.wish_list import WishListScreen
from game.app.session import Screen, Session

__all__ = [
    "EpilogueScreen",
    "HistoryScreen",
    "InspectScreen",
    "MarketScreen",
    "OutcomeScreen",
    "Screen",
    "Session",
    "SettingsScreen",
    "SlotsScreen",
    "TableScreen",
    "TalkScreen",
    "TitleScreen",
    "WalkScreen",
    "WishListScreen",
]
