"""``face fit`` and ``face simulate``: what the fits say, as text, as JSON, as plots, as YAML for the game."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from typing import Any

import numpy as np

from game.core import BadInput
from game.face import REGIONS, FaceModel, load_face
from game.formats.files import write_text
from game.tools.face.fitting import FaceFit, fit_ratings
from game.tools.face.plots import need_matplotlib, plot_errors, plot_fit
from game.tools.face.ratings_file import COLUMNS, face_code, format_rating, format_row, read_ratings
from game.tools.face.simulate import ErrorRow, errors_by_raters, simulate_ratings
from game.tools.face.sitting import single_part_faces, whole_faces
from game.tools.face.yaml_edit import check_parts, check_weights, with_gaussians, with_weights
from game.tools.yaml_lines import check_text

__all__ = ["fit", "simulate"]

AXES = ("valence", "arousal")
GROUPS = (1, 2, 4, 8, 16, 32, 64)


def fit(args: argparse.Namespace) -> int:
    """Fit, report, and write what was asked for; nothing is written unless everything can be."""
    if args.plots is not None:
        need_matplotlib()
    model = load_face(args.face_folder).model
    found = fit_ratings(
        read_ratings(args.ratings, model.parts), model, args.ratings, held_out=args.held_out, seed=args.seed
    )
    parts = weights = ""
    if args.out_parts is not None:
        if not found.parts:
            raise BadInput("--out-parts", expected="at least one rated part", seen="; ".join(found.lacking))
        parts = with_gaussians(args.face_folder / "parts.yaml", found)
    if args.out_weights is not None:
        weights = with_weights(args.face_folder / "weights.yaml", found)
    planned = [
        (path, text, check)
        for path, text, check in ((args.out_parts, parts, check_parts), (args.out_weights, weights, check_weights))
        if path is not None
    ]
    for path, text, check in planned:
        check_text(path, text, check)
    written = [] if args.plots is None else plot_fit(args.plots, found, model)
    for path, text, _ in planned:
        write_text(path, text)
        written.append(path)
    if args.json:
        print(json.dumps(fit_json(found, model) | {"written": [str(p) for p in written]}, ensure_ascii=False, indent=2))
    else:
        _print_fit(found, model)
        for path in written:
            print(f"wrote {path}")
    return 0


def fit_json(found: FaceFit, model: FaceModel) -> dict[str, Any]:
    """A fit as plain data."""
    weights: dict[str, Any] = {}
    if found.axes is not None and found.weights is not None:
        for j, (axis, name) in enumerate(zip(found.axes, AXES, strict=True)):
            weights[name] = {
                "r_squared": axis.r_squared,
                "p_value": axis.p_value,
                "faces": axis.faces,
                "regions": {
                    region: {
                        "weight": float(axis.weight[i]),
                        "error": float(axis.error[i]),
                        "p_value": float(axis.p_weight[i]),
                        "interval": axis.interval[i].tolist(),
                        "written": float(found.weights[i, j]),
                        "in_use": float(model.weights.value[i, j]),
                    }
                    for i, region in enumerate(REGIONS)
                },
            }
    held = found.held_out
    return {
        "raters": found.raters,
        "ratings": found.ratings,
        "simulated": found.simulated,
        "label": found.label,
        "parts": [
            {
                "region": p.region,
                "part": p.part,
                "ratings": p.ratings,
                "mean": p.mean.tolist(),
                "covariance": p.covariance.tolist(),
            }
            for p in found.parts
        ],
        "unrated": list(found.unrated),
        "standard_offset": None if found.standard_offset is None else found.standard_offset.tolist(),
        "whole_faces": 0 if found.whole is None else len(found.whole),
        "weights": weights or None,
        "held_out": None
        if held is None
        else {
            "faces": len(held.faces),
            "r_squared": dict(zip(AXES, held.r_squared.tolist(), strict=True)),
            "rmse": dict(zip(AXES, held.rmse.tolist(), strict=True)),
            "deviation_rmse": None
            if held.deviation_rmse is None
            else dict(zip(AXES, held.deviation_rmse.tolist(), strict=True)),
            "log_density": held.log_density,
        },
        "lacking": list(found.lacking),
    }


def _print_fit(found: FaceFit, model: FaceModel) -> None:
    print(f"{found.ratings} ratings by {found.label}")
    if found.standard_offset is not None:
        v, a = found.standard_offset
        print(f"the standard face was rated ({v:+.3f}, {a:+.3f}); the model takes it as (0, 0)")
    for p in found.parts:
        v, a = np.sqrt(np.diag(p.covariance))
        r = p.covariance[0, 1] / (v * a)
        place = f"({p.mean[0]:+.3f}, {p.mean[1]:+.3f}) ± ({v:.3f}, {a:.3f}) r {r:+.2f}"
        print(f"  {p.region + '/' + p.part:28} {place}  from {p.ratings}")
    if found.axes is not None and found.weights is not None:
        for j, (axis, name) in enumerate(zip(found.axes, AXES, strict=True)):
            print(f"{name}: R² {axis.r_squared:.3f}, p {_p(axis.p_value)}, {axis.faces} faces")
            for i, region in enumerate(REGIONS):
                low, high = axis.interval[i]
                now = f"in use {model.weights.value[i, j]:.2f} ({model.weights.source[i][j]})"
                text = f"{axis.weight[i]:6.3f}  95 % [{low:6.3f}, {high:6.3f}]  p {_p(float(axis.p_weight[i]))}  {now}"
                note = "  written as 0: a negative weight has no meaning" if found.weights[i, j] == 0 else ""
                print(f"  {region:9} {text}{note}")
    if found.held_out is not None:
        h = found.held_out
        print(
            f"held out ({len(h.faces)} faces): R² {h.r_squared[0]:.3f} and {h.r_squared[1]:.3f}, "
            f"error {h.rmse[0]:.3f} and {h.rmse[1]:.3f}, mean log-density {h.log_density:+.2f}"
        )
        if h.deviation_rmse is not None:
            print(f"  error of their predicted deviations {h.deviation_rmse[0]:.3f} and {h.deviation_rmse[1]:.3f}")
    for text in found.lacking:
        print(f"too few: {text}")


def _p(value: float) -> str:
    return "< .001" if value < 0.001 else f"{value:.3f}"


def simulate(args: argparse.Namespace) -> int:
    """Ratings by simulated people, and the error over all faces against their number."""
    if args.plots is not None:
        need_matplotlib()
    model = load_face(args.face_folder).model
    if args.out is not None:
        if args.out.exists():
            raise BadInput("--out", expected="a file that does not exist yet", seen=str(args.out))
        faces = single_part_faces(model.parts) + whole_faces(model.parts, args.faces, args.seed)
        ratings = simulate_ratings(model, faces, args.raters, np.random.default_rng([args.seed, 7]))
        write_text(args.out, format_row(COLUMNS) + "".join(format_rating(r) for r in ratings))
    rows = errors_by_raters(model, GROUPS, seed=args.seed)
    if args.json:
        listed = [asdict(row) for row in rows]
        example = face_code(single_part_faces(model.parts)[1])
        print(json.dumps({"simulated": True, "face_code": example, "errors": listed}, indent=2))
    else:
        _print_errors(rows)
    if args.plots is not None:
        plot_errors(args.plots, rows)
    return 0


def _print_errors(rows: list[ErrorRow]) -> None:
    first = rows[0]
    print(f"simulated raters: {first.predicted_faces} faces predicted from {first.rated_faces} rated ones")
    print("raters  error, weights known  error, weights fitted  error of a weight")
    for row in rows:
        print(
            f"{row.raters:6d}  {row.error_known_weights:20.3f}  {row.error_fitted_weights:21.3f}"
            f"  {row.weight_error:17.3f}"
        )
