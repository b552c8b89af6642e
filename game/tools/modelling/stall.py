"""The flea-market stall: table, runner, valance, posts, awning, lights, and the goods where the YAML puts them."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from game.core.humanoid import TABLE_FRONT_Z_M, TABLE_TOP_M
from game.formats import Node, load_yaml
from game.tools.modelling.backdrop import paint_backdrop
from game.tools.modelling.fields import Floats
from game.tools.modelling.gltf import Gltf, material_json, unit_normals
from game.tools.modelling.goods import GOODS, stroke, turned
from game.tools.modelling.lofts import lathe, loft, rounded_box, sheet
from game.tools.modelling.mesh import Mesh, joined
from game.tools.modelling.parts import Part
from game.tools.modelling.spec import Swatch, read_palette

__all__ = ["StallSpec", "build_stall", "load_stall", "stall_parts"]

_TOP = TABLE_TOP_M
_HALF_WIDTH_M = 1.5

Surface = tuple[Floats, Floats, Floats]


@dataclass(frozen=True)
class Placing:
    """One item: where it stands (x, z), how high above the table, its turn, shadow radii and price card."""

    item: str
    at: tuple[float, float]
    height: float
    turn_rad: float
    shadow: tuple[float, float]
    card: tuple[float, float, float] | None
    on: str | None


@dataclass(frozen=True)
class StallSpec:
    id: str
    palette: dict[str, Swatch]
    goods: tuple[Placing, ...]
    backdrop_seed: int


def load_stall(path: Path) -> StallSpec:
    """Read ``assets/stalls/<id>.yaml``. Raises BadInput with file:line:col."""
    node = load_yaml(path)
    node.only("id", "palette", "goods", "backdrop_seed")
    return StallSpec(
        id=node["id"].as_str(),
        palette=read_palette(node["palette"]),
        goods=tuple(_placing(row) for row in node["goods"]),
        backdrop_seed=node["backdrop_seed"].as_int(0, 1_000_000),
    )


def _placing(row: Node) -> Placing:
    row.only("item", "at", "height", "turn_deg", "shadow", "card", "on")
    item = row["item"]
    if item.as_str() not in GOODS:
        raise item.error(expected=" | ".join(GOODS))
    numbers = {key: [n.as_float(-10, 360) for n in row[key]] for key in ("at", "shadow", "card") if row.get(key)}
    for key, count in (("at", 2), ("shadow", 2), ("card", 3)):
        if key in numbers and len(numbers[key]) != count:
            raise row[key].error(expected=f"{count} numbers")
    height, turn, on = row.get("height"), row.get("turn_deg"), row.get("on")
    card = numbers.get("card")
    return Placing(
        item=item.as_str(),
        at=(numbers["at"][0], numbers["at"][1]),
        height=height.as_float(0, 1) if height else 0.0,
        turn_rad=float(np.radians(turn.as_float(-360, 360))) if turn else 0.0,
        shadow=(numbers["shadow"][0], numbers["shadow"][1]),
        card=(card[0], card[1], float(np.radians(card[2]))) if card else None,
        on=on.as_str() if on else None,
    )


def stall_parts(spec: StallSpec) -> dict[str, list[Part]]:
    """Group name -> parts in world coordinates; the item groups carry their contact shadow."""
    groups = {"scene": _frame_and_front(), "table": _table() + _runner() + _tray(), "awning": _awning() + _lights()}
    for placing in spec.goods:
        place = np.array([placing.at[0], _TOP + placing.height, placing.at[1]])
        parts = [
            Part(p.name, p.material, p.mesh.placed(place, placing.turn_rad), None, p.outline)
            for p in GOODS[placing.item]()
        ]
        if placing.shadow[0] > 0:
            parts.append(_contact_shadow(placing.at, placing.shadow))
        if placing.card:
            parts += _price_card(*placing.card)
        groups[f"item:{placing.item}"] = parts
    return groups


def build_stall(yaml_path: Path, out_dir: Path) -> list[Path]:
    """Model the stall of ``yaml_path``; write ``<id>.glb`` and ``<id>_backdrop.png``. -> the files written."""
    spec = load_stall(yaml_path)
    gltf = Gltf()
    material_of: dict[str, int] = {}
    placings = {f"item:{p.item}": p for p in spec.goods}
    for group, parts in stall_parts(spec).items():
        primitives = []
        for material in dict.fromkeys(part.material for part in parts):
            if material not in material_of:
                material_of[material] = len(gltf.materials)
                gltf.materials.append(material_json(material, spec.palette[material], toon=False))
            members = [part for part in parts if part.material == material]
            mesh = joined([part.mesh for part in members])
            outline = np.concatenate([np.full(len(part.mesh.position), part.outline) for part in members])
            attributes = {
                "POSITION": gltf.vertices(mesh.position.astype(np.float32), bounds=True),
                "NORMAL": gltf.vertices(unit_normals(mesh.normal)),
                "_OUTLINE": gltf.vertices(outline.astype(np.float32)),
            }
            indices = gltf.indices(mesh.triangle, len(mesh.position))
            primitives.append({"attributes": attributes, "indices": indices, "material": material_of[material]})
        gltf.meshes.append({"name": group, "primitives": primitives})
        extras: dict[str, object] = {"group": group}
        if group in placings:
            placing = placings[group]
            extras["anchor"] = [placing.at[0], round(_TOP + placing.height, 6), placing.at[1]]
            if placing.on:
                extras["on"] = placing.on
        gltf.node(name=group, mesh=len(gltf.meshes) - 1, extras=extras)
    gltf.root["scenes"] = [{"name": spec.id, "nodes": list(range(len(gltf.nodes)))}]
    model, picture = out_dir / f"{spec.id}.glb", out_dir / f"{spec.id}_backdrop.png"
    gltf.save(model)
    paint_backdrop(picture, np.random.default_rng(spec.backdrop_seed))
    return [model, picture]


def _table() -> list[Part]:
    """Three boards of uneven length in each of five rows."""
    parts = []
    rows = np.linspace(0.16, TABLE_FRONT_Z_M, 6)
    for i in range(5):
        cuts = (-_HALF_WIDTH_M, -0.42 + 0.17 * (i % 3), 0.62 - 0.2 * (i % 2), _HALF_WIDTH_M)
        for k in range(3):
            x0, x1, z0, z1 = cuts[k], cuts[k + 1], rows[i], rows[i + 1]
            centre = ((x0 + x1) / 2, _TOP - 0.016 - 0.0015 * ((i + k) % 2), (z0 + z1) / 2)
            board = rounded_box(centre, ((x1 - x0) / 2 - 0.0012, 0.016, (z1 - z0) / 2 - 0.0012), 0.005)
            parts.append(Part("board", ("wood", "wood2", "wood")[(i * 2 + k) % 3], board, None, 0.6))
            # a few grain lines, painted flat
            for line in range(3):
                z = z0 + (z1 - z0) * (0.25 + 0.25 * line)
                start = x0 + 0.1 + 0.13 * ((i * 3 + k * 2 + line * 5) % 4)
                end = min(start + 0.22 + 0.1 * ((i + line) % 3), x1 - 0.06)
                if end > start + 0.05:
                    parts.append(_grain(start, end, z, _TOP - 0.0015 * ((i + k) % 2) + 0.0004))
    return parts


def _grain(x0: float, x1: float, z: float, y: float) -> Part:
    mesh = sheet(
        lambda u, v: (
            x0 + (x1 - x0) * u,
            np.full_like(u, y),
            z + 0.003 * np.sin(u * 5 + z * 90) + (v - 0.5) * 0.0030 * np.sin(np.pi * u),
        ),
        12,
        2,
        (0, 1, 0),
    )
    return Part("grain", "grain", mesh, None, 0.0)


def _cloth(half: float, front: float, depth: float, height: float, u: Floats, v: Floats) -> Surface:
    return half * (2 * u - 1), np.full_like(u, _TOP + height), front - depth * v


def _runner() -> list[Part]:
    """The bargaining spot: a teal cloth with two cream borders and gold diamonds."""
    parts = []
    layers = (
        ("paper", 0.360, 0.755, 0.360, 0.0030, 0.6),
        ("runner", 0.335, 0.750, 0.330, 0.0045, 0.0),
        ("paper", 0.320, 0.748, 0.312, 0.0055, 0.0),
        ("runner", 0.312, 0.748, 0.304, 0.0065, 0.0),
    )
    for material, half, front, depth, height, outline in layers:
        cloth = sheet(partial(_cloth, half, front, depth, height), 12, 6, (0, 1, 0))
        parts.append(Part("runner", material, cloth, None, outline))
    for k in range(9):
        x = -0.26 + k * 0.065
        for z in (0.723, 0.460):
            corner = np.array([(x - 0.014, z), (x, z + 0.012), (x + 0.014, z), (x, z - 0.012)])
            position = np.stack([corner[:, 0], np.full(4, _TOP + 0.0075), corner[:, 1]], 1)
            normal = np.tile([0.0, 1.0, 0.0], (4, 1))
            parts.append(Part("diamond", "gold", Mesh(position, normal, np.array([[0, 1, 2], [0, 2, 3]])), None, 0.0))
    return parts


def _tray() -> list[Part]:
    """A saucer with coins, on the right of the runner."""
    outline = [(0.001, 0.004), (0.060, 0.004), (0.066, 0.014), (0.070, 0.014), (0.068, 0.001), (0.001, 0.001)]
    at = np.array([0.30, _TOP + 0.006, 0.60])
    parts = [Part("tray", "dark_wood", turned(outline, 40, 4).placed(at), None, 0.8)]
    coin = lathe([(0.001, 0), (0.014, 0), (0.0155, 0.001), (0.0155, 0.0035), (0.014, 0.0045), (0.001, 0.0045)], 18)
    for k in range(9):
        radius, angle = 0.034 * np.sqrt(k / 9), k * 2.4
        place = at + (radius * np.cos(angle), 0.004 + 0.0045 * (k % 3), radius * np.sin(angle))
        parts.append(Part("coin", "gold", coin.placed(place), None, 0.5))
    return parts


def _valance(x0: float, u: Floats, v: Floats) -> Surface:
    """One scallop of 15 cm along the table's front edge."""
    y = _TOP + 0.004 - (0.045 + 0.060 * np.sin(np.pi * u) ** 0.7) * v
    return x0 + 0.15 * u, y, 0.764 + 0.006 * np.sin(u * np.pi) + 0.002 * v


def _frame_and_front() -> list[Part]:
    """Front rail, pleated skirt, scalloped valance, four posts."""
    parts = [Part("rail", "dark_wood", rounded_box((0, _TOP - 0.075, 0.725), (_HALF_WIDTH_M, 0.045, 0.018)), None)]
    skirt = sheet(
        lambda u, v: (
            _HALF_WIDTH_M * (2 * u - 1),
            _TOP - 0.045 - 0.54 * v,
            0.756 + (0.006 + 0.022 * v) * np.sin(u * 92 + 1.3 * np.sin(u * 23)),
        ),
        320,
        6,
    )
    parts.append(Part("skirt", "teal_cloth", skirt, None, 0.0))
    for k in range(20):
        x0 = -_HALF_WIDTH_M + k * 0.15
        scallop = sheet(partial(_valance, x0), 16, 6)
        parts.append(Part("valance", "cream" if k % 2 else "red_cloth", scallop, None, 0.6))
    for side in (-1.0, 1.0):
        for z, height in ((0.70, 1.75), (-0.42, 1.90)):
            post = lathe([(0.001, 0), (0.030, 0), (0.030, 0.4), (0.030, 1.0), (0.030, height), (0.001, height)], 24)
            parts.append(Part("post", "dark_wood", _flat_ends(post).placed((side * 1.08, 0, z)), None))
    return parts


def _flat_ends(post: Mesh) -> Mesh:
    """Sideways normals for a cylinder whose caps nobody sees."""
    normal = post.normal * (1.0, 0.0, 1.0)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return Mesh(post.position, np.where(length > 0.1, normal / np.maximum(length, 0.1), post.normal), post.triangle)


def _roof(x0: float, width: float, u: Floats, v: Floats) -> Surface:
    return x0 + width * u, 1.86 - 0.34 * v - 0.07 * v * (1 - v), -0.45 + 1.35 * v


def _roof_edge(x0: float, width: float, u: Floats, v: Floats) -> Surface:
    y = 1.525 - (0.055 + 0.050 * np.sin(np.pi * u) ** 0.6) * v
    return x0 + width * u, y, 0.905 + 0.010 * np.sin(np.pi * u) + 0.006 * v


def _awning() -> list[Part]:
    """Striped roof, sagging a little, with a scalloped edge toward the customer."""
    parts = []
    edges = np.linspace(-1.35, 1.35, 19)
    for k, (x0, x1) in enumerate(itertools.pairwise(edges)):
        material = "red_cloth" if k % 2 else "cream"
        width = x1 - x0
        roof = sheet(partial(_roof, x0, width), 4, 12, (0, 1, 0))
        edge = sheet(partial(_roof_edge, x0, width), 14, 6)
        parts += [Part("roof", material, roof, None, 0.0), Part("scallop", material, edge, None, 0.8)]
    return parts


def _string_height(x: Floats) -> Floats:
    return np.asarray(1.66 - 0.13 * np.abs(np.sin((x + 1.2) / 0.8 * np.pi)))


def _lights() -> list[Part]:
    """A sagging string of bulbs behind the shopkeeper's head."""
    x = np.linspace(-1.2, 1.2, 60)
    path = np.stack([x, _string_height(x), np.full(60, -0.40)], 1)
    parts = [Part("string", "dark", loft(path, np.tile([0.0, 0, 1], (60, 1)), 0.0035, 0.0035, 6, "round"), None, 0.4)]
    glass = turned([(0.0005, -0.058), (0.014, -0.052), (0.020, -0.036), (0.014, -0.018), (0.008, -0.012)], 14, 2)
    cap = turned([(0.009, -0.016), (0.009, 0.002), (0.001, 0.003)], 8, 1)
    for k in range(15):
        place = np.array([-1.12 + k * 0.16, 0.0, -0.40])
        place[1] = _string_height(place[:1])[0]
        parts.append(Part("bulb", "glass", glass.placed(place), None, 0.6))
        parts.append(Part("socket", "dark", cap.placed(place), None, 0.5))
    return parts


def _contact_shadow(at: tuple[float, float], radii: tuple[float, float]) -> Part:
    """A flat disc of shaded wood, a little away from the light."""
    angle = np.linspace(0.0, 2 * np.pi, 32, endpoint=False)
    rim = np.stack([radii[0] * np.cos(angle), np.zeros(32), radii[1] * np.sin(angle)], 1)
    position = np.vstack([rim, np.zeros((1, 3))]) + (at[0] + 0.020, _TOP + 0.0016, at[1] - 0.012)
    k = np.arange(32)
    triangle = np.stack([np.full(32, 32), (k + 1) % 32, k], 1)
    return Part("contact_shadow", "wood_shadow", Mesh(position, np.tile([0.0, 1, 0], (33, 1)), triangle), None, 0.0)


def _price_card(x: float, z: float, turn_rad: float) -> list[Part]:
    """A folded card with a red line and a dark one."""
    card = rounded_box((0, 0.030, 0), (0.040, 0.028, 0.003), 0.002, cuts=4)
    lines = (("red_cloth", -0.005, 0.010, 0.022), ("dark", 0.0, -0.006, 0.014))
    marks = [
        (
            material,
            stroke(
                [(dx - w, 0.030 + dy, 0.0035), (dx, 0.030 + dy, 0.0035), (dx + w, 0.030 + dy, 0.0035)],
                0.0035,
                0.0008,
                4,
            ),
        )
        for material, dx, dy, w in lines
    ]
    place = (x, _TOP, z)
    parts = [Part("card", "paper", card.placed(place, turn_rad), None, 0.7)]
    parts += [Part("card_line", material, mesh.placed(place, turn_rad), None, 0.0) for material, mesh in marks]
    return [*parts, _contact_shadow((x, z), (0.052, 0.014))]
