"""A market stall from its YAML: the pieces it is made of, the goods where they stand, and the painted backdrop.

The file written is plain glTF 2.0, world coordinates, one node per group:

* ``scene``, ``table``, ``awning``: what stands still; ``extras.group`` repeats the name.
* ``item:<id>``: an item with its contact shadow and price card; ``extras.anchor`` is the centre of its foot,
  ``extras.on`` the item it stands on.
* ``sway:<name>`` and ``spin:<name>``: things that move by themselves (bulbs, flags, lanterns, balloons, cloth,
  pinwheels). They carry ``extras.sway = {"axis": [x, y, z], "amplitude_deg": a, "period_s": s}`` or
  ``extras.spin = {"axis": [x, y, z], "period_s": s}`` and a vertex attribute ``_PIVOT`` (VEC3, world metres): the
  point about which the vertex turns. One group holds many things, each with a pivot of its own; their phase is
  meant to follow the pivot, so that a breeze runs along: angle = a · sin(2π · (t/s + 0.31·pivot.x + 0.17·pivot.z)).
  A program that knows nothing of it draws the group at rest.

Vertex attribute ``_OUTLINE``: width of the ink line, 0 = none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from game.core.errors import BadInput, Where
from game.core.humanoid import TABLE_TOP_M
from game.formats import Node, load_yaml
from game.tools.modelling.backdrop import BACKDROPS, paint_backdrop
from game.tools.modelling.fields import Floats
from game.tools.modelling.gltf import Gltf, material_json, unit_normals
from game.tools.modelling.goods import GOODS
from game.tools.modelling.goods_shapes import stroke
from game.tools.modelling.lofts import rounded_box
from game.tools.modelling.mesh import Mesh, joined
from game.tools.modelling.parts import Part
from game.tools.modelling.pieces import Moving, Piece, read_piece
from game.tools.modelling.spec import Swatch, read_palette
from game.tools.modelling.stall_back import FoldingScreen, Shelf
from game.tools.modelling.stall_fair import Balloons, ChalkBoard, Crates, Pinwheels
from game.tools.modelling.stall_front import Boards, Front, Runner, Tray
from game.tools.modelling.stall_roof import Awning, Bulbs, Bunting, Lanterns, Noren

__all__ = ["PIECES", "StallSpec", "build_stall", "load_stall", "stall_parts"]

PIECES: Mapping[str, type[Any]] = {
    "front": Front,
    "boards": Boards,
    "runner": Runner,
    "tray": Tray,
    "awning": Awning,
    "bulbs": Bulbs,
    "bunting": Bunting,
    "noren": Noren,
    "lanterns": Lanterns,
    "folding_screen": FoldingScreen,
    "shelf": Shelf,
    "crates": Crates,
    "balloons": Balloons,
    "pinwheels": Pinwheels,
    "chalk_board": ChalkBoard,
}
"""What ``piece`` may name in a stall's YAML."""

_TOP = TABLE_TOP_M


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
    path: Path
    id: str
    palette: dict[str, Swatch]
    pieces: tuple[Piece, ...]
    goods: tuple[Placing, ...]
    cards: tuple[str, str, str]
    shade: str
    backdrop: str
    backdrop_seed: int


def load_stall(path: Path) -> StallSpec:
    """Read ``assets/stalls/<id>.yaml``. Raises BadInput with file:line:col."""
    node = load_yaml(path)
    node.only("id", "backdrop", "mood", "palette", "pieces", "goods", "cards", "contact_shadow")
    palette = read_palette(node["palette"])
    backdrop = node["backdrop"].only("recipe", "seed")
    if backdrop["recipe"].as_str() not in BACKDROPS:
        raise backdrop["recipe"].error(expected=" | ".join(BACKDROPS))
    cards = node["cards"].only("paper", "price", "ink")
    colours = [cards[key] for key in ("paper", "price", "ink")] + [node["contact_shadow"]]
    for colour in colours:
        if colour.as_str() not in palette:
            raise colour.error(expected="an entry of the palette")
    goods = tuple(_placing(row) for row in node["goods"])
    names = [placing.item for placing in goods]
    for row, placing in zip(node["goods"], goods, strict=True):
        if names.count(placing.item) > 1:
            raise row["item"].error(f"{placing.item} stands on the table twice")
        if placing.on is not None and placing.on not in names:
            raise row["on"].error(expected=" | ".join(names))
    return StallSpec(
        path=path,
        id=node["id"].as_str(),
        palette=palette,
        pieces=tuple(read_piece(row, PIECES, palette) for row in node["pieces"]),
        goods=goods,
        cards=(colours[0].as_str(), colours[1].as_str(), colours[2].as_str()),
        shade=colours[3].as_str(),
        backdrop=backdrop["recipe"].as_str(),
        backdrop_seed=backdrop["seed"].as_int(0, 1_000_000),
    )


def _placing(row: Node) -> Placing:
    row.only("item", "at", "height", "turn_deg", "shadow", "card", "on")
    item = row["item"]
    if item.as_str() not in GOODS:
        raise item.error(expected=" | ".join(GOODS))
    numbers = {key: [n.as_float(-360, 360) for n in row[key]] for key in ("at", "shadow", "card") if row.get(key)}
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
    """Group name -> parts that stand still, in world coordinates; the item groups carry shadow and price card."""
    groups: dict[str, list[Part]] = {"scene": [], "table": [], "awning": []}
    for piece in spec.pieces:
        for group, parts in piece.still().items():
            groups[group] += parts
    for placing in spec.goods:
        place = np.array([placing.at[0], _TOP + placing.height, placing.at[1]])
        parts = [
            Part(p.name, p.material, p.mesh.placed(place, placing.turn_rad), None, p.outline)
            for p in GOODS[placing.item]()
        ]
        if placing.shadow[0] > 0:
            parts.append(_contact_shadow(placing.at, placing.shadow, spec.shade))
        if placing.card:
            parts += _price_card(*placing.card, spec)
        groups[f"item:{placing.item}"] = parts
    return {group: parts for group, parts in groups.items() if parts}


class _Writer:
    """Collects groups of parts as meshes and nodes; one material per palette entry used."""

    def __init__(self, spec: StallSpec) -> None:
        self.gltf = Gltf()
        self._spec = spec
        self._material_of: dict[str, int] = {}

    def group(self, name: str, parts: Sequence[Part], extras: dict[str, object], pivots: Floats | None = None) -> None:
        """``pivots``: (len(parts), 3) for parts that move."""
        primitives = []
        for material in dict.fromkeys(part.material for part in parts):
            members = [i for i, part in enumerate(parts) if part.material == material]
            mesh = joined([parts[i].mesh for i in members])
            sizes = [len(parts[i].mesh.position) for i in members]
            outline = np.repeat([parts[i].outline for i in members], sizes)
            attributes = {
                "POSITION": self.gltf.vertices(mesh.position.astype(np.float32), bounds=True),
                "NORMAL": self.gltf.vertices(unit_normals(mesh.normal)),
                "_OUTLINE": self.gltf.vertices(outline.astype(np.float32)),
            }
            if pivots is not None:
                attributes["_PIVOT"] = self.gltf.vertices(np.repeat(pivots[members], sizes, axis=0).astype(np.float32))
            indices = self.gltf.indices(mesh.triangle, len(mesh.position))
            number = self._material(material, name)
            primitives.append({"attributes": attributes, "indices": indices, "material": number})
        self.gltf.meshes.append({"name": name, "primitives": primitives})
        self.gltf.node(name=name, mesh=len(self.gltf.meshes) - 1, extras={"group": name, **extras})

    def _material(self, name: str, group: str) -> int:
        if name not in self._spec.palette:
            raise BadInput("palette", where=Where(self._spec.path), expected=f"an entry {name} (for {group})")
        if name not in self._material_of:
            self._material_of[name] = len(self.gltf.materials)
            self.gltf.materials.append(material_json(name, self._spec.palette[name], toon=False))
        return self._material_of[name]

    def moving(self, thing: Moving) -> None:
        motion: dict[str, object] = {"axis": list(thing.axis)}
        if thing.motion == "sway":
            motion["amplitude_deg"] = thing.amplitude_deg
        motion["period_s"] = thing.period_s
        pivots = np.array([hanging.pivot for hanging in thing.hanging for _ in hanging.parts])
        parts = [part for hanging in thing.hanging for part in hanging.parts]
        self.group(f"{thing.motion}:{thing.group}", parts, {thing.motion: motion}, pivots)


def build_stall(yaml_path: Path, out_dir: Path) -> list[Path]:
    """Model the stall of ``yaml_path``; write ``<id>.glb`` and ``<id>_backdrop.png``. -> the files written."""
    spec = load_stall(yaml_path)
    writer = _Writer(spec)
    placings = {f"item:{p.item}": p for p in spec.goods}
    for group, parts in stall_parts(spec).items():
        extras: dict[str, object] = {}
        if group in placings:
            placing = placings[group]
            extras["anchor"] = [placing.at[0], round(_TOP + placing.height, 6), placing.at[1]]
            if placing.on:
                extras["on"] = placing.on
        writer.group(group, parts, extras)
    for number, thing in enumerate(thing for piece in spec.pieces for thing in piece.moving()):
        writer.moving(replace(thing, group=f"{thing.group}_{number}"))
    gltf = writer.gltf
    gltf.root["scenes"] = [{"name": spec.id, "nodes": list(range(len(gltf.nodes)))}]
    model, picture = out_dir / f"{spec.id}.glb", out_dir / f"{spec.id}_backdrop.png"
    gltf.save(model)
    paint_backdrop(picture, spec.backdrop, np.random.default_rng(spec.backdrop_seed))
    return [model, picture]


def _contact_shadow(at: tuple[float, float], radii: tuple[float, float], colour: str) -> Part:
    """A flat disc of shaded wood, a little away from the light."""
    angle = np.linspace(0.0, 2 * np.pi, 32, endpoint=False)
    rim = np.stack([radii[0] * np.cos(angle), np.zeros(32), radii[1] * np.sin(angle)], 1)
    position = np.vstack([rim, np.zeros((1, 3))]) + (at[0] + 0.020, _TOP + 0.0016, at[1] - 0.012)
    k = np.arange(32)
    triangle = np.stack([np.full(32, 32), (k + 1) % 32, k], 1)
    return Part("contact_shadow", colour, Mesh(position, np.tile([0.0, 1, 0], (33, 1)), triangle), None, 0.0)


def _price_card(x: float, z: float, turn_rad: float, spec: StallSpec) -> list[Part]:
    """A folded card with a coloured line and a dark one."""
    paper, price, ink = spec.cards
    card = rounded_box((0, 0.030, 0), (0.040, 0.028, 0.003), 0.002, cuts=4)
    lines = ((price, -0.005, 0.010, 0.022), (ink, 0.0, -0.006, 0.014))
    marks = [
        (
            colour,
            stroke(
                [(dx - w, 0.030 + dy, 0.0035), (dx, 0.030 + dy, 0.0035), (dx + w, 0.030 + dy, 0.0035)],
                0.0035,
                0.0008,
                4,
            ),
        )
        for colour, dx, dy, w in lines
    ]
    place = (x, _TOP, z)
    parts = [Part("card", paper, card.placed(place, turn_rad), None, 0.7)]
    parts += [Part("card_line", colour, mesh.placed(place, turn_rad), None, 0.0) for colour, mesh in marks]
    return [*parts, _contact_shadow((x, z), (0.052, 0.014), spec.shade)]
