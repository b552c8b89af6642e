"""``face rate --avatar`` and ``face fit --avatar``: what people see in a foreign avatar's expressions.

Each expression gets a Gaussian over (valence, arousal) of its own, and an affinity to the seven from the names that
raters gave. The game then chooses the avatar's expressions by these, as it chooses parts of the painted face.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from game.app.arguments import avatar_of
from game.app.avatar import RATED_SUFFIX, Avatar
from game.core import EMOTION_INDEX, EMOTIONS, BadInput
from game.face import RatedExpression, emotion_recipes, fit_gaussian, load_face, load_rated, rated_text
from game.formats.files import write_text
from game.render.avatar_model import AvatarLook
from game.tools.face.ratings_file import Rating, read_ratings
from game.tools.yaml_lines import check_text

__all__ = ["expressions_to_rate", "fit_avatar", "fit_expressions", "look_of"]

_HELPERS = ("blink", "look", "aa", "ih", "ou", "ee", "oh")
LEAST = 3
"""Ratings that an expression's Gaussian needs."""


def expressions_to_rate(avatar: Avatar) -> list[str]:
    """Everything but blinks, looks and mouth shapes, which the game uses by itself. Raises BadInput where none is
    left."""
    found = [n for n in avatar.expressions if not (n in _HELPERS or n.startswith(("blink", "look")))]
    if not found:
        raise BadInput("--avatar", expected="an avatar with expressions", seen=f"none in {avatar.path.name}")
    return found


def look_of(avatar: Avatar, name: str) -> AvatarLook:
    """One expression alone, in full."""
    weight = np.array([float(known == name) for known in avatar.expressions])
    return avatar.looks.at(weight)


def fit_expressions(ratings: list[Rating], names: list[str]) -> tuple[dict[str, RatedExpression], list[str]]:
    """Rated expressions, and one line for each that has too few ratings, or ratings on one line.

    affinity: the share of an expression's ratings that named an emotion; where nobody named one, its own name counts.
    """
    found: dict[str, RatedExpression] = {}
    lacking: list[str] = []
    called = {parts[0][0]: emotion for emotion, parts in emotion_recipes(names).items() if len(parts) == 1}
    for name in names:
        own = [r for r in ratings if r.face == name]
        try:
            mean, covariance = fit_gaussian([(r.valence, r.arousal) for r in own])
        except BadInput as error:
            need = f"{len(own)} ratings of {LEAST}" if len(own) < LEAST else str(error)
            lacking.append(f"{name}: {need}")
            continue
        affinity = np.zeros(len(EMOTIONS))
        named = [r.name for r in own if r.name]
        for emotion in named:
            affinity[EMOTION_INDEX[emotion]] += 1.0 / len(named)
        if not named and name in called:
            affinity[EMOTION_INDEX[called[name]]] = 0.5
        found[name] = RatedExpression(name, mean, covariance, len(own), affinity)
    return found, lacking


def fit_avatar(args: argparse.Namespace) -> int:
    """Fit an avatar's expressions to ratings and write what the game reads."""
    if args.out_parts is not None or args.out_weights is not None or args.plots is not None:
        raise BadInput("--avatar", expected="--out-faces; parts and weights belong to the painted face", seen="others")
    avatar = avatar_of(args, quiet=args.json)
    assert avatar is not None
    names = expressions_to_rate(avatar)
    ratings = read_ratings(args.ratings, tuple(avatar.expressions))
    found, lacking = fit_expressions(ratings, names)
    if not found:
        raise BadInput("ratings", expected=f"an expression with {LEAST} ratings or more", seen="; ".join(lacking[:3]))
    out = args.out_faces or args.ratings.with_name(args.ratings.stem + RATED_SUFFIX)
    raters = len({r.rater for r in ratings})
    places = load_face(args.face_folder).model.parts.places
    text = rated_text(avatar.path.name, found, places, f"rated by {raters} {'person' if raters == 1 else 'people'}")
    check_text(out, text, load_rated)
    write_text(out, text)
    if args.json:
        print(json.dumps(_as_json(found, lacking, out), ensure_ascii=False))
        return 0
    for row in found.values():
        v, a = np.sqrt(np.diag(row.covariance))
        print(f"  {row.name:20} ({row.mean[0]:+.3f}, {row.mean[1]:+.3f}) ± ({v:.3f}, {a:.3f})  from {row.ratings}")
    for line in lacking:
        print(f"too few: {line}")
    print(f"wrote {out}; run_game.py play --avatar {avatar.path.name} --avatar-faces {out.name}")
    return 0


def _as_json(found: Mapping[str, RatedExpression], lacking: list[str], out: Path) -> dict[str, object]:
    rows = [
        {
            "expression": row.name,
            "mean": row.mean.tolist(),
            "covariance": row.covariance.tolist(),
            "ratings": row.ratings,
            "affinity": dict(zip(EMOTIONS, row.affinity.tolist(), strict=True)),
        }
        for row in found.values()
    ]
    return {"expressions": rows, "lacking": lacking, "written": [str(out)]}
