"""Who follows a session: a recorder that writes down what is done, or a player that does it again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from game.app.session import Session
    from game.app.world import Intent

__all__ = ["Journal"]


class Journal(Protocol):
    """Who follows a session: a recorder that writes down what is done, or a player that does it again.

    before: just before a tick, gives the intent that the tick is to have; after: just after it. begin, end: around
    everything else that changes the session, with what it was; only the outermost of nested changes is told.
    """

    def before(self, session: Session, intent: Intent) -> Intent: ...

    def after(self, session: Session) -> None: ...

    def begin(self, session: Session) -> None: ...

    def end(self, session: Session, what: str, values: dict[str, Any]) -> None: ...

    def shows(self, session: Session, scene: str) -> None: ...
