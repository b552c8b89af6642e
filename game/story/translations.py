"""Which English each Japanese line was written for: a lock file beside the stalls, so that a changed line is noticed.

``translations.lock.yaml`` keeps a digest of both texts of every line. Where the English has another digest now and
the Japanese has not, the Japanese is stale: it still says what the line used to say.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path

from game.core.errors import BadInput, Where
from game.formats.files import write_text
from game.formats.yaml_source import load_yaml
from game.story.findings import Findings
from game.story.model import Script
from game.story.text import Text

__all__ = ["LOCK_NAME", "check_translations", "read_lock", "texts_of", "write_lock"]

LOCK_NAME = "translations.lock.yaml"
_DIGESTS = re.compile(r"[0-9a-f]{8}-[0-9a-f]{8}")
_HEADER = """\
# Which English each Japanese line was written for (digests of both); written by `run_game.py lint --fix`. A line whose
# English changed alone is reported as stale until its Japanese changes too, or `lint --accept` says that it still fits.
locked:
"""

Lock = Mapping[str, Mapping[str, str]]


def texts_of(script: Script) -> Iterator[tuple[str, Text, Where]]:
    """(key, words, place) of everything that is translated: lines by their id, the rest by where it stands."""
    yield "title/stall", script.title, script.where
    for item in script.items.values():
        yield f"item/{item.id}", item.name, item.where
        if item.about is not None:
            yield f"about/{item.id}", item.about, item.where
    for ending in script.endings.values():
        yield f"ending/{ending.id}", ending.caption, ending.where
    for line in script.all_lines():
        yield line.id, line.text, line.where
    for choice in script.all_choices():
        if choice.reason is not None:
            yield f"needs/{choice.id}", choice.reason, choice.where


def check_translations(script: Script, findings: Findings) -> None:
    """Note lines whose English was changed after their Japanese was written."""
    path = Path(script.path).parent / LOCK_NAME
    if not path.is_file():
        return
    try:
        locked = read_lock(path).get(script.stall)
    except BadInput as error:
        findings.take("E_BAD_VALUE", error)
        return
    if locked is None:
        findings.add(
            "I_NOT_LOCKED", script.where, f"{LOCK_NAME} does not know {script.stall!r}", "run_game.py lint --fix"
        )
        return
    new = [key for key, text, _ in texts_of(script) if key not in locked and text.en and text.ja]
    if new:
        message = f"{LOCK_NAME} does not know {len(new)} of its lines yet, {new[0]!r} first"
        findings.add("I_NOT_LOCKED", script.where, message, "run_game.py lint --fix")
    for key, text, where in texts_of(script):
        if _stale(text, locked.get(key)):
            findings.add(
                "W_STALE_TRANSLATION",
                where,
                f"the English of {key!r} changed, the Japanese did not",
                "write it anew, or run_game.py lint --accept",
            )


def read_lock(path: Path) -> Lock:
    """stall -> key -> digests. Raises BadInput with file:line:col."""
    out: dict[str, dict[str, str]] = {}
    for stall, lines in load_yaml(path).only("locked")["locked"].items():
        out[stall.as_str()] = {}
        for key, value in lines.items():
            if not _DIGESTS.fullmatch(value.as_str()):
                raise value.error(expected="two digests", hint="run_game.py lint --fix writes them")
            out[stall.as_str()][key.as_str()] = value.as_str()
    return out


def write_lock(path: Path, scripts: Iterable[Script], *, accept: Collection[str] = ()) -> int:
    """Bring the lock up to date with some scripts; how many lines are new or changed.

    A stale line keeps its old digests, and is reported again, unless its stall is among those to ``accept``.
    """
    lock = {stall: dict(lines) for stall, lines in read_lock(path).items()} if path.is_file() else {}
    changed = 0
    for script in scripts:
        old = lock.get(script.stall, {})
        new = {}
        for key, text, _ in texts_of(script):
            if text.en and text.ja:
                keep = _stale(text, old.get(key)) and script.stall not in accept
                new[key] = old[key] if keep else _digests(text)
        changed += sum(old.get(key) != value for key, value in new.items()) + len(old.keys() - new.keys())
        lock[script.stall] = new
    if changed or not path.is_file():
        rows = [_HEADER]
        for stall, lines in sorted(lock.items()):
            rows.append(f"  {stall}:\n")
            rows += [f"    {key}: {value}\n" for key, value in sorted(lines.items())]
        write_text(path, "".join(rows))
    return changed


def _stale(text: Text, locked: str | None) -> bool:
    if locked is None or not (text.en and text.ja):
        return False
    en, ja = _digests(text).split("-")
    return locked.split("-")[0] != en and locked.split("-")[1] == ja


def _digests(text: Text) -> str:
    return "-".join(hashlib.sha256(" ".join(words.split()).encode()).hexdigest()[:8] for words in (text.en, text.ja))
