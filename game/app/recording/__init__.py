"""Recordings of play: what was done and when, so that it can be done again exactly."""

from game.app.recording.content import content_hashes, content_note
from game.app.recording.digests import body_digest, game_digest, talk_digest
from game.app.recording.files import CHECK_TICKS, VERSION, Event, Header, Recording, read_recording
from game.app.recording.player import Divergence, Player
from game.app.recording.recorder import LAST_SESSION, Recorder, record_session

__all__ = [
    "CHECK_TICKS",
    "LAST_SESSION",
    "VERSION",
    "Divergence",
    "Event",
    "Header",
    "Player",
    "Recorder",
    "Recording",
    "body_digest",
    "content_hashes",
    "content_note",
    "game_digest",
    "read_recording",
    "record_session",
    "talk_digest",
]
