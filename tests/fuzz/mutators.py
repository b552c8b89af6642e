"""Structure-aware mutation: a file is taken apart, something in it is changed, and it is put together again.

Bytes changed at random rarely get past the first bracket of a JSON or the first indent of a YAML file. Here values are
swapped for others of the same file (so that references go astray), for numbers at the edges, for nothing, for too much;
keys are lost, doubled or given to others; lines and words of plain text change places.
"""

from __future__ import annotations

import json
import random
import re
import struct
from collections.abc import Callable
from typing import Any

import yaml

__all__ = ["STRUCTURED", "mutate_structure"]

Take = Callable[[bytes], Any]
Put = Callable[[Any], bytes]

JSON_CHUNK = 0x4E4F534A
EDGES: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 2, 255, 65536, 2**31 - 1, 2**31, 2**32, 2**53 + 1, 2**63, -(2**63), 10**400, 0.5, -0.0,
    1e-320, 1e308, float("inf"), float("nan"), "", " ", "0", "nan", "\x00", "\ud7ff", "\u202e", "../../etc/passwd",
    "/dev/zero", "data:;base64,AA==", "{{", "{x}", "__class__", "a" * 5000, [], {}, [[]], {"": ""},
)  # fmt: skip
MULTIPLIED = 2000
"""Only what is written in fewer characters is repeated: what is repeated again and again has no end."""
WORD = re.compile(r"\S+")


def _nested(depth: int) -> Any:
    value: Any = 0
    for _ in range(depth):
        value = [value]
    return value


def _places(tree: Any, found: list[tuple[Any, Any]]) -> list[tuple[Any, Any]]:
    """Every (container, key or index) of a tree; the most a file may have keeps it quick."""
    if len(found) < 20_000 and isinstance(tree, dict | list):
        for key, value in list(tree.items() if isinstance(tree, dict) else enumerate(tree)):
            found.append((tree, key))
            _places(value, found)
    return found


def _copy(value: Any) -> Any:
    """Of its own, so that no later change reaches the original."""
    return json.loads(json.dumps(value)) if isinstance(value, dict | list) else value


def _small(value: Any) -> bool:
    return len(json.dumps(value)) < MULTIPLIED


def _change_tree(tree: Any, rng: random.Random) -> Any:
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        places = _places(tree, [])
        if not places:
            return _copy(rng.choice(EDGES))
        holder, key = rng.choice(places)
        value = holder[key]
        kind = rng.randrange(8)
        if kind == 0:
            holder[key] = _copy(rng.choice(EDGES))
        elif kind == 1:  # a reference that goes elsewhere, a part in another's place
            other, at = rng.choice(places)
            same = [(h, k) for h, k in places if type(h[k]) is type(value)]
            other, at = rng.choice(same) if rng.random() < 0.7 else (other, at)
            holder[key] = _copy(other[at])
        elif kind == 2:
            del holder[key]
        elif kind == 3 and isinstance(value, int | float) and not isinstance(value, bool):
            holder[key] = rng.choice((value + 1, value - 1, -value, value * 2, value * 1e9, value * 2**40))
        elif kind == 4 and isinstance(value, str) and value and _small(value):
            at = rng.randrange(len(value))
            holder[key] = rng.choice((value[:at], value[at:], value * 3, value[:at] + value, value.swapcase()))
        elif kind == 5 and isinstance(holder, dict):
            names = [k for h, k in places if isinstance(h, dict)]
            holder[rng.choice(names)] = holder.pop(key)
        elif kind == 6 and isinstance(value, list) and value and _small(value):
            holder[key] = _copy(rng.choice((value * 3, value[::-1], value[:1] * 200, value[: len(value) // 2])))
        else:
            holder[key] = _nested(rng.choice((1, 3, 70, 300)))
    return tree


def _take_glb(data: bytes) -> tuple[Any, bytes]:
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[20 + length :]


def _put_glb(parts: tuple[Any, bytes]) -> bytes:
    tree, rest = parts
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<II", len(text), JSON_CHUNK) + text + rest
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def _take_lines(data: bytes) -> Any:
    return [json.loads(line) for line in data.splitlines() if line.strip()]


def _put_lines(rows: Any) -> bytes:
    rows = rows if isinstance(rows, list) else [rows]
    return b"".join(json.dumps(row).encode() + b"\n" for row in rows)


def _change_text(data: bytes, rng: random.Random) -> bytes:
    """Lines and words of a text change places, double, vanish, or are given another's value."""
    lines = data.decode("utf-8", "surrogateescape").split("\n")
    for _ in range(rng.choice((1, 1, 2, 5))):
        at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
        kind = rng.randrange(5)
        if kind == 0:
            lines[at], lines[other] = lines[other], lines[at]
        elif kind == 1:
            lines.insert(at, lines[other])
        elif kind == 2 and len(lines) > 1:
            del lines[at]
        else:
            words, others = list(WORD.finditer(lines[at])), WORD.findall(lines[other])
            if words:
                word = rng.choice(words)
                new = rng.choice(others) if others and kind == 3 else str(rng.choice(EDGES))
                lines[at] = lines[at][: word.start()] + new + lines[at][word.end() :]
    return "\n".join(lines).encode("utf-8", "surrogateescape")


def _put_yaml(tree: Any) -> bytes:
    return yaml.safe_dump(tree, allow_unicode=True, sort_keys=False).encode()


def _take_yaml(data: bytes) -> Any:
    if len(data) > 60_000:
        raise ValueError("taking it apart would take longer than trying it")
    return yaml.safe_load(data)


JSON: tuple[Take, Put] = (json.loads, lambda tree: json.dumps(tree).encode())
YAML: tuple[Take, Put] = (_take_yaml, _put_yaml)
GLB: tuple[Take, Put] = (_take_glb, _put_glb)
STRUCTURED: dict[str, tuple[Take, Put] | None] = {
    "yaml": YAML, "script": YAML, "annotation": YAML, "map": YAML, "moves": YAML, "save": JSON, "gltf": GLB, "vrm": GLB,
    "vrma": GLB, "recording": (_take_lines, _put_lines), "bvh": None, "ratings": None, "eaf": None,
}  # fmt: skip
"""Reader -> how its files are taken apart and put together; None: as lines of words."""


def mutate_structure(name: str, data: bytes, max_size: int, seed: int) -> bytes | None:
    """A changed file of at most ``max_size`` bytes; None where this one cannot be taken apart."""
    rng, parts = random.Random(seed), STRUCTURED[name]
    try:
        if parts is None or rng.random() < 0.15:
            made = _change_text(data, rng)
        else:
            take, put = parts
            tree = take(data)
            if name in {"gltf", "vrm", "vrma"}:
                made = put((_change_tree(tree[0], rng), tree[1]))
            else:
                made = put(_change_tree(tree, rng))
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError, struct.error, yaml.YAMLError):
        return None
    return made if len(made) <= max_size else None
