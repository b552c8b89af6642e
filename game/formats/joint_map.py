"""Which joint of a foreign skeleton plays which part: found by name and hierarchy, or read from a small YAML.

Names are compared without namespace, case, punctuation and side ("mixamorig:LeftForeArm", "LowerArm_L", "lElbow"
are one). Where a name means different bones to different programs (LeftShoulder: collar bone or upper arm; LeftHip:
pelvis spacer or thigh) the place in the chain decides.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from game.core.errors import BadInput, Where
from game.core.humanoid import FINGERS, REFERENCE
from game.core.paths import ASSETS
from game.core.skeleton import Skeleton
from game.formats.yaml_source import Node, load_yaml, nearest

__all__ = ["MAPS", "JointMap", "detect_map", "find_map", "load_map", "map_from_bones", "map_from_names"]

MAPS = ASSETS / "motion" / "maps"
SIDES = ("left", "right")
_LISTS = ("spine", "neck")
_FINGER_NAMES = ("Thumb", *FINGERS)

_ALIASES: Mapping[str, frozenset[str]] = {
    "head": frozenset({"head", "skull"}),
    "hand": frozenset({"hand", "wrist", "palm"}),
    "lowerArm": frozenset({"forearm", "forearmbend", "lowerarm", "elbow", "lowarm", "radius"}),
    "upperArm": frozenset({"arm", "upperarm", "uparm", "humerus", "shldr", "shldrbend"}),
    "foot": frozenset({"foot", "ankle"}),
    "lowerLeg": frozenset({"leg", "lowerleg", "lowleg", "shin", "knee", "calf", "tibia", "shinbend"}),
    "upperLeg": frozenset({"upleg", "upperleg", "thigh", "thighbend", "hip", "femur"}),
    "toes": frozenset({"toe", "toes", "toebase", "ball", "toe0"}),
}
_FINGER_WORDS = {"thumb": 0, "index": 1, "middle": 2, "mid": 2, "ring": 3, "pinky": 4, "little": 4, "small": 4}
_WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+")
_NAMESPACE = re.compile(r"^.*[:|]")
_PREFIXES = re.compile(r"^(bip\d*|cc_base|joint|def|org|b|jnt|j|character\d*|hum)[ _.\-]+", re.IGNORECASE)


@dataclass(frozen=True)
class JointMap:
    """Target joint name -> the foreign joints that drive it, in order from the hips outward.

    Only ``spine`` (all trunk joints below the one that carries the arms; may be empty) and ``neck`` (may be empty)
    can have other than one joint. Fingers and toes may be missing.
    """

    joints: Mapping[str, tuple[str, ...]]
    name: str = "detected"

    def one(self, target: str) -> str | None:
        """The joint that drives a target joint with a single source, None where there is none."""
        found = self.joints.get(target, ())
        return found[0] if found else None

    def has_fingers(self, side: str) -> bool:
        """Whether all four knuckles of a hand are known."""
        return all(self.one(f"{side}{finger}Proximal") for finger in FINGERS)


_NEEDED = ("hips", "chest", "head") + tuple(
    f"{side}{bone}" for side in SIDES for bone in ("UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot")
)


def _split(name: str) -> tuple[str, str]:
    """Side ("left", "right" or "") and the rest in small letters without punctuation."""
    bare = _PREFIXES.sub("", _NAMESPACE.sub("", name.strip()))
    words = [word.lower() for word in _WORDS.findall(bare)]
    side = ""
    for where in (0, -1):
        if words and words[where] in {"left", "l", "right", "r"}:
            side = "left" if words[where][0] == "l" else "right"
            words.pop(where)
            break
    rest = "".join(words)
    if not side:
        known = frozenset().union(*_ALIASES.values()) | {"shoulder", "collar", "clavicle", "thumb", "fingers"}
        for start, which in (("left", "left"), ("right", "right"), ("l", "left"), ("r", "right")):
            if rest.startswith(start) and rest[len(start) :] in known:
                return which, rest[len(start) :]
    return side, rest


class _Tree:
    """A skeleton's joints with their names taken apart."""

    def __init__(self, skeleton: Skeleton) -> None:
        self.names = skeleton.names
        self.parent = [int(p) for p in skeleton.parents]
        self.parts = [_split(name) for name in skeleton.names]
        self.depth = [0] * len(self.names)
        for joint, parent in enumerate(self.parent):
            self.depth[joint] = 0 if parent < 0 else self.depth[parent] + 1

    def path(self, joint: int) -> list[int]:
        """The joint and its ancestors up to the root."""
        chain = [joint]
        while self.parent[chain[-1]] >= 0:
            chain.append(self.parent[chain[-1]])
        return chain

    def meeting(self, a: int, b: int) -> int:
        """The lowest common ancestor, -1 where the two hang on different roots."""
        above = set(self.path(a))
        return next((joint for joint in self.path(b) if joint in above), -1)

    def topmost(self, side: str, role: str) -> int | None:
        """The joint of that role nearest the root."""
        found = [i for i, part in enumerate(self.parts) if part[0] == side and part[1] in _ALIASES[role]]
        return min(found, key=lambda i: (self.depth[i], i)) if found else None

    def below(self, joint: int) -> list[int]:
        """All descendants, parents first."""
        inside = {joint}
        found = []
        for i, parent in enumerate(self.parent):
            if parent in inside:
                inside.add(i)
                found.append(i)
        return found


def detect_map(skeleton: Skeleton, path: Path | str = "skeleton", option: str = "--map") -> JointMap:
    """Find the parts of a human skeleton. Raises BadInput that names what is missing and how to give it (option)."""
    tree = _Tree(skeleton)
    where = Where(path)
    ends: dict[str, int] = {}
    missing = []
    for role, sides in (("head", ("",)), ("hand", SIDES), ("foot", SIDES)):
        for side in sides:
            found = tree.topmost(side, role)
            if found is None:
                missing.append(f"{side} {role}".strip())
            else:
                ends[side + role] = found
    if missing:
        raise BadInput(
            "skeleton",
            where=where,
            expected="a person's joints",
            seen=f"no {', no '.join(missing)} among {len(skeleton)} joints",
            hint=f"name the joints in a map file: {option}",
        )
    hips = tree.meeting(ends["leftfoot"], ends["rightfoot"])
    # The carrier of the arms: where the two arms part.
    chest = tree.meeting(ends["lefthand"], ends["righthand"])
    trunk = tree.path(ends["head"])[1:]
    while chest in trunk[:-1] and tree.parts[chest][1].rstrip("0123456789") == "neck":
        # Some hang the collar bones on the neck; what turns the shoulders is below it.
        chest = trunk[trunk.index(chest) + 1]
    if hips < 0 or chest not in trunk or hips not in trunk or tree.depth[chest] <= tree.depth[hips]:
        raise BadInput(
            "skeleton",
            where=where,
            expected="legs that meet at the hips and arms that meet at a trunk joint above them",
            seen=f"legs at {tree.names[hips] if hips >= 0 else 'none'!r}, "
            f"arms at {tree.names[chest] if chest >= 0 else 'none'!r}",
            hint=f"name the joints in a map file: {option}",
        )
    between = trunk[trunk.index(chest) + 1 : trunk.index(hips)][::-1]
    joints: dict[str, list[int]] = {
        "hips": [hips],
        "spine": between,
        "chest": [chest],
        "neck": trunk[: trunk.index(chest)][::-1],
        "head": [ends["head"]],
    }
    for side in SIDES:
        arm = _limb(tree, ends[side + "hand"], chest, ("hand", "lowerArm", "upperArm"), where, option)
        leg = _limb(tree, ends[side + "foot"], hips, ("foot", "lowerLeg", "upperLeg"), where, option)
        for target, joint in zip(("Hand", "LowerArm", "UpperArm", "Shoulder"), arm, strict=False):
            joints[side + target] = [joint]
        for target, joint in zip(("Foot", "LowerLeg", "UpperLeg"), leg[:3], strict=True):
            joints[side + target] = [joint]
        toes = [i for i in tree.below(ends[side + "foot"]) if tree.parts[i][1] in _ALIASES["toes"]]
        toes = toes or [i for i, parent in enumerate(tree.parent) if parent == ends[side + "foot"]]
        joints[side + "Toes"] = toes[:1]
        joints |= _fingers(tree, side, ends[side + "hand"])
    return JointMap({t: tuple(tree.names[i] for i in own) for t, own in joints.items() if own or t in _LISTS})


def _limb(tree: _Tree, end: int, trunk: int, roles: tuple[str, ...], where: Where, option: str) -> list[int]:
    """End, lower bone, upper bone and, where there is one, the collar bone or pelvis spacer."""
    chain = tree.path(end)
    chain = chain[: chain.index(trunk)]
    if len(chain) < 3:
        raise BadInput(
            f"limb of {tree.names[end]!r}",
            where=where,
            expected="two bones between it and the trunk",
            seen=" < ".join(tree.names[i] for i in chain) or "none",
            hint=f"name the joints in a map file: {option}",
        )
    # Between them there may be joints that only twist: names decide where they are known, else the order.
    lower = next((i for i in chain[1:-1] if tree.parts[i][1] in _ALIASES[roles[1]]), chain[1])
    after = chain[chain.index(lower) + 1 :]
    upper = next((i for i in after if tree.parts[i][1] in _ALIASES[roles[2]]), after[0])
    rest = chain[chain.index(upper) + 1 :]
    return [end, lower, upper, *rest[:1]]


def _fingers(tree: _Tree, side: str, hand: int) -> dict[str, list[int]]:
    found: dict[int, list[int]] = {}
    for joint in tree.below(hand):
        rest = tree.parts[joint][1].removeprefix("hand")
        if "inhand" in tree.parts[joint][1] or ("metacarpal" in rest and "thumb" not in rest):
            continue
        which = next((n for word, n in _FINGER_WORDS.items() if rest.startswith(word)), None)
        numbered = re.fullmatch(r"finger([0-4])(\d?)", rest)
        if which is None and numbered:
            which = int(numbered[1])
        if which is not None and not rest.endswith(("end", "nub", "tip")):
            found.setdefault(which, []).append(joint)
    joints: dict[str, list[int]] = {}
    if any(n in found for n in range(1, 5)):
        for n, chain in found.items():
            first, second = ("Metacarpal", "Proximal") if n == 0 else ("Proximal", "Intermediate")
            for target, joint in zip((first, second), chain, strict=False):
                joints[f"{side}{_FINGER_NAMES[n]}{target}"] = [joint]
    return joints


def load_map(path: Path | str) -> JointMap:
    """Read a map file: ``joints: {leftUpperArm: L_Arm, spine: [Spine, Spine1], …}``. Raises BadInput."""
    root = load_yaml(Path(path))
    root.only("name", "joints", "note")
    joints: dict[str, tuple[str, ...]] = {"spine": (), "neck": ()}
    for key, node in root["joints"].items():
        target = key.as_str()
        if target not in REFERENCE.index:
            close = nearest(target, REFERENCE.names)
            raise key.error("unknown joint", expected="a joint of the reference humanoid",
                            hint=f"did you mean {close!r}?" if close else None)  # fmt: skip
        joints[target] = _sources(node, target)
    missing = [target for target in _NEEDED if not joints.get(target)]
    if missing:
        raise root["joints"].error("joints", expected=f"also {', '.join(missing)}")
    name = root.get("name")
    return JointMap(joints, name.as_str() if name else Path(path).stem)


def _sources(node: Node, target: str) -> tuple[str, ...]:
    if node.kind != "sequence":
        return (node.as_str(),)
    if target not in _LISTS:
        raise node.error(target, expected="one joint name (only spine and neck may have several)")
    return tuple(item.as_str() for item in node.as_list())


def map_from_bones(bones: Mapping[str, str], path: Path | str = "motion") -> JointMap:
    """The map of a skeleton whose humanoid bones are known (VRM): bone -> joint name. Raises BadInput with what is
    missing.

    The bone that carries the arms is the chest here: VRM's upperChest, chest or spine, whichever is the highest.
    """
    trunk = [bones[bone] for bone in ("spine", "chest", "upperChest") if bone in bones]
    joints: dict[str, tuple[str, ...]] = {b: (joint,) for b, joint in bones.items() if b in REFERENCE.index}
    joints["spine"], joints["chest"] = tuple(trunk[:-1]), tuple(trunk[-1:])
    joints["neck"] = (bones["neck"],) if "neck" in bones else ()
    missing = [target for target in _NEEDED if not joints.get(target)]
    if missing:
        raise BadInput("humanoid bones", where=Where(path), expected="a person's", seen=f"no {', '.join(missing)}")
    return JointMap(joints, "VRM")


def map_from_names(joint_map: JointMap, skeleton: Skeleton, path: Path | str = "skeleton") -> JointMap:
    """The map, after checking that the skeleton has every joint in it. Raises BadInput with the nearest name."""
    for target, sources in joint_map.joints.items():
        for source in sources:
            if source not in skeleton.index:
                close = nearest(source, skeleton.names)
                raise BadInput(
                    f"map {joint_map.name!r}, {target}",
                    where=Where(path),
                    expected=f"a joint {source!r}",
                    seen="none of that name",
                    hint=f"did you mean {close!r}?" if close else None,
                )
    return joint_map


def find_map(name: str, shipped: Iterable[Path] | None = None) -> Path:
    """A map file by its path, or by the name of one shipped in assets/motion/maps. Raises BadInput."""
    if Path(name).suffix in {".yaml", ".yml"} or Path(name).exists():
        return Path(name)
    paths = {path.stem: path for path in (MAPS.glob("*.yaml") if shipped is None else shipped)}
    if name not in paths:
        raise BadInput("--map", expected=f"a YAML file or one of {', '.join(sorted(paths))}", seen=name)
    return paths[name]
