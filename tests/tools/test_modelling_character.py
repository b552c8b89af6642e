"""The committed shopkeepers: valid VRMs, bound well, the size they should be, and what the builder still makes."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.spatial import cKDTree

from game.core.errors import BadInput
from game.core.humanoid import HEAD_CENTRE_OFFSET, REFERENCE
from game.core.paths import ASSETS
from game.formats import GltfFile, Vrm, read_gltf, read_vrm
from game.formats.vrm_model import REQUIRED_BONES
from game.tools.modelling.character import Character
from game.tools.modelling.curls import grown
from game.tools.modelling.export import LEVELS
from game.tools.modelling.face_atlas import COLUMNS, EXPRESSIONS, ROWS, cell_of
from game.tools.modelling.mesh import Mesh
from game.tools.modelling.parts import Detail
from game.tools.modelling.spec import load_character

FOLDER = ASSETS / "characters"
NAMES = sorted(path.stem for path in FOLDER.glob("*.yaml"))
SWINGING = {
    "mira": {"bow", "scarf", "tuft", "hair"},
    "genzo": {"cord", "leftSleeve", "rightSleeve", "hair"},
    "daimon": {"leftStrap", "rightStrap", "rag", "tuft", "hair"},
}


@pytest.fixture(scope="module", params=NAMES)
def name(request) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def vrm(name) -> Vrm:
    return read_vrm(FOLDER / f"{name}.vrm")


@pytest.fixture(scope="module")
def levels(name) -> GltfFile:
    return read_gltf(FOLDER / f"{name}.lod.glb")


@pytest.fixture(scope="module")
def character(name) -> Character:
    return Character(load_character(FOLDER / f"{name}.yaml"))


def all_primitives(file: GltfFile):
    return [p for mesh in file.meshes for p in mesh.primitives]


def joint_place(character: Character, bone: str) -> np.ndarray:
    """Where a joint of the person's own skeleton stands in the T-pose."""
    return character.figure.rig.position[character.figure.rig.index[bone]]


def material_extras(file: GltfFile, primitive) -> dict:
    return file.materials[primitive.material].extras


def skinned(file: GltfFile, primitive, joint_model: np.ndarray) -> np.ndarray:
    """Vertices (V, 3) with the joints (N nodes, 4, 4) in model space."""
    skin = file.skins[0]
    matrices = joint_model[list(skin.joints)] @ skin.inverse_bind
    blended = np.einsum("vk,vkij->vij", primitive.attributes["WEIGHTS_0"], matrices[primitive.attributes["JOINTS_0"]])
    position = np.c_[primitive.attributes["POSITION"], np.ones(len(blended))]
    return np.einsum("vij,vj->vi", blended, position)[:, :3]


def test_it_is_a_vrm_with_the_humanoid_skeleton_in_t_pose(name, vrm, character):
    assert vrm.version.startswith("1.")
    assert vrm.faces == "+Z"
    assert vrm.findings == []
    assert set(REQUIRED_BONES) <= set(vrm.bones)
    assert set(vrm.bones) == set(REFERENCE.names)
    for bone in REFERENCE.names:
        node = vrm.gltf.nodes[vrm.bones[bone]]
        np.testing.assert_allclose(node.rotation, [0, 0, 0, 1])
        np.testing.assert_allclose(vrm.gltf.node_model[node.index][:3, 3], joint_place(character, bone), atol=1e-5)
    if name == "mira":
        places = [joint_place(character, bone) for bone in REFERENCE.names]
        np.testing.assert_allclose(places, REFERENCE.rest_model[:, :3, 3], atol=1e-9)


def test_meta_expressions_and_look_at_are_declared(vrm, character):
    assert vrm.authors
    assert vrm.meta["licenseUrl"] == "https://vrm.dev/licenses/1.0/"
    assert set(EXPRESSIONS) == set(vrm.expressions)
    assert all(len(vrm.expressions[name].shifts) == 1 for name in EXPRESSIONS)
    # The faces, and a tile of every pattern.
    assert [image.mime_type for image in vrm.gltf.images] == ["image/png"] * (1 + len(character.spec.weaves))
    assert vrm.look_at is not None


def test_skin_joints_come_in_the_documented_order(name, vrm, levels):
    names = [vrm.gltf.nodes[j].name for j in vrm.gltf.skins[0].joints]
    assert names[:41] == list(REFERENCE.names)
    assert names[41:43] == ["leftForearmTwist", "rightForearmTwist"]
    assert {n.split("_")[0] for n in names[43:]} == SWINGING[name]
    assert len(names) <= 64
    assert [levels.nodes[j].name for j in levels.skins[0].joints] == names


def test_spring_chains_hang_on_the_body_and_end_in_a_node_without_skin(name, vrm):
    joints = set(vrm.gltf.skins[0].joints)
    assert {c.name.split("_")[0] for c in vrm.springs} == SWINGING[name]
    for chain in vrm.springs:
        nodes = [joint.node for joint in chain.joints]
        assert len(nodes) >= 2
        for parent, child in itertools.pairwise(nodes):
            assert vrm.gltf.nodes[child].parent == parent
        assert set(nodes[:-1]) <= joints
        assert nodes[-1] not in joints
        assert vrm.gltf.nodes[vrm.gltf.nodes[nodes[0]].parent].name in REFERENCE.names
    chained = {vrm.gltf.nodes[j.node].name for c in vrm.springs for j in c.joints[:-1]}
    assert chained == {vrm.gltf.nodes[j].name for j in vrm.gltf.skins[0].joints[43:]}


def test_vertices_are_finite_unit_and_bound(vrm, levels):
    for file in (vrm.gltf, levels):
        for primitive in all_primitives(file):
            attributes = primitive.attributes
            assert np.isfinite(attributes["POSITION"]).all()
            np.testing.assert_allclose(attributes["WEIGHTS_0"].sum(1), 1.0, atol=1e-6)
            assert attributes["JOINTS_0"].max() < len(file.skins[0].joints)
            assert primitive.indices.max() < len(attributes["POSITION"])
            if "NORMAL" in attributes:
                np.testing.assert_allclose(np.linalg.norm(attributes["NORMAL"], axis=1), 1.0, atol=1e-4)
                outline = attributes["_OUTLINE"]
                assert ((outline == 0) | ((outline >= 0.4) & (outline <= 1.1001))).all()


def test_every_joint_moves_something(vrm):
    used = set()
    for primitive in all_primitives(vrm.gltf):
        joints, weights = primitive.attributes["JOINTS_0"], primitive.attributes["WEIGHTS_0"]
        used |= set(joints[weights > 0.3].tolist())
    names = [vrm.gltf.nodes[j].name for j in vrm.gltf.skins[0].joints]
    assert {names[j] for j in range(len(names))} - {names[j] for j in used} == set()


def test_levels_of_detail_keep_their_budgets(vrm, levels):
    counts = {}
    for file in (vrm.gltf, levels):
        for node in file.nodes:
            if node.mesh is not None:
                primitives = file.meshes[node.mesh].primitives
                counts[node.extras["lod"]] = sum(len(p.indices) // 3 for p in primitives)
    assert set(counts) == set(LEVELS)
    for level, count in counts.items():
        assert count == pytest.approx(level, rel=0.1)


def test_materials_carry_the_hand_picked_palette(vrm, character):
    for primitive in all_primitives(vrm.gltf):
        extras = material_extras(vrm.gltf, primitive)
        swatch = character.spec.palette[extras["palette"]]
        assert (extras["class"], extras["lit_srgb"]) == (swatch.kind, swatch.lit)
        assert "VRMC_materials_mtoon" in vrm.gltf.materials[primitive.material].extensions


def test_the_face_is_one_primitive_with_its_projection(vrm, character):
    faces = [p for p in all_primitives(vrm.gltf) if material_extras(vrm.gltf, p)["class"] == "face"]
    assert len(faces) == 1
    uv, masks = faces[0].attributes["TEXCOORD_0"], faces[0].attributes["_FACE"]
    assert ((masks >= 0) & (masks <= 1)).all()
    painted = masks[:, 0] > 0
    assert painted.sum() > 500
    assert ((uv[painted] >= 0) & (uv[painted] <= 1)).all()
    size = character.spec.proportions.head
    centre = joint_place(character, "head") + HEAD_CENTRE_OFFSET * size
    local = (faces[0].attributes["POSITION"][painted] - centre) / size
    front = (local[:, 1] > -0.12) & (local[:, 1] < 0.10)
    local, uv, painted = local[front], uv[painted][front], slice(None)
    np.testing.assert_allclose(uv[painted, 0], (local[:, 0] + 0.17) / 0.34, atol=2e-4)
    np.testing.assert_allclose(uv[painted, 1], (0.14 - local[:, 1]) / 0.34, atol=2e-4)


def test_hair_carries_the_terms_of_its_highlight(vrm):
    hair = [p for p in all_primitives(vrm.gltf) if material_extras(vrm.gltf, p)["class"] == "hair"]
    assert hair
    for primitive in hair:
        azimuth, height = primitive.attributes["_HAIR"].T
        assert np.abs(azimuth).max() < 3 * np.pi
        assert np.abs(height).max() <= 1.0001


def test_at_rest_the_skin_stands_in_a_t_pose(name, vrm, character):
    """Arms level at shoulder height, feet on the ground, the head at the person's own height."""
    by_name = {}
    for primitive in all_primitives(vrm.gltf):
        at_rest = skinned(vrm.gltf, primitive, vrm.gltf.node_model)
        by_name.setdefault(material_extras(vrm.gltf, primitive)["palette"], []).append(at_rest)
    everything = np.vstack([v for group in by_name.values() for v in group])
    assert everything[:, 1].min() == pytest.approx(0.0, abs=0.01)
    head = by_name["face"][0]
    crown = joint_place(character, "head")[1] + 0.37 * character.spec.proportions.head
    assert head[:, 1].max() == pytest.approx(crown, abs=0.02)
    assert (
        {"mira": 1.38, "genzo": 1.46, "daimon": 1.30}[name]
        < crown
        < {"mira": 1.41, "genzo": 1.50, "daimon": 1.36}[name]
    )
    wrist = joint_place(character, "leftHand")
    size = character.spec.proportions.hand
    assert np.abs(everything[:, 0]).max() == pytest.approx(wrist[0] + 0.14 * size, abs=0.015)
    hands = by_name["skin"][0]
    hands = hands[np.abs(hands[:, 0]) > wrist[0] + 0.03]
    assert len(hands) > 500
    assert np.abs(hands[:, 1] - wrist[1]).max() < 0.035 * size
    assert np.abs(hands[:, 2] - wrist[2]).max() < 0.10 * size
    assert everything[:, 0].max() == pytest.approx(-everything[:, 0].min(), abs=1e-3)


def test_arms_down_gives_back_the_modelled_surface(vrm):
    """With the arms turned 45 degrees down the skin is where it was sculpted."""
    local = np.array([node.matrix for node in vrm.gltf.nodes])
    for bone, sign in (("leftUpperArm", -1.0), ("rightUpperArm", 1.0)):
        c, s = np.cos(np.pi / 4), np.sin(np.pi / 4) * sign
        local[vrm.bones[bone]][:2, :2] = [[c, -s], [s, c]]
    model = vrm.gltf.to_model(local)
    for primitive in all_primitives(vrm.gltf):
        np.testing.assert_allclose(skinned(vrm.gltf, primitive, model), primitive.attributes["POSITION"], atol=1e-5)


def test_the_builder_still_makes_the_committed_hair(vrm, character):
    """A small part made anew lies where the committed file has it, within a tenth of a millimetre."""
    hair = next(p for p in all_primitives(vrm.gltf) if material_extras(vrm.gltf, p)["class"] == "hair")
    committed = cKDTree(hair.attributes["POSITION"])
    # The detail at which a person keeps the budget is found while building; the ends of a lock are at every detail.
    for mesh in (mesh for _, mesh in character.hair.all_clumps(Detail(LEVELS[40000]))):
        weights = character.binder.hair(mesh.position, character.hair.chains)
        made = character.figure.stretched(mesh, weights).position[-2:]
        distance, _ = committed.query(made)
        assert distance.max() < 1e-4


def test_the_builder_still_makes_the_committed_curls(vrm, character):
    """Where a lock stands out of the hair, the committed hair reaches its tip and goes no further."""
    hair = character.hair
    if not hair.spec.curls:
        return
    committed = next(p for p in all_primitives(vrm.gltf) if material_extras(vrm.gltf, p)["class"] == "hair")
    tree = cKDTree(committed.attributes["POSITION"])
    rooted = [lock.path[-1] for lock in grown(hair.spec.curls, hair.on_scalp)]
    tips = np.array(rooted + [lock.path[-1] for lock in grown(hair.spec.beard.curls, hair.on_skin)])
    standing = tips[hair.curls.field(tips) > -0.004]
    assert len(standing) >= 25
    weights = hair.curly_weights(standing, character.binder)
    distance, _ = tree.query(
        character.figure.stretched(Mesh(standing, standing, np.zeros((0, 3), int)), weights).position
    )
    assert np.percentile(distance, 90) < 0.006


def test_a_beard_leaves_the_mouth_bare_and_stays_on_the_skin(vrm, character):
    """No hair before the mouth; what grows on the jaw does not swing."""
    style, spec = character.spec.face, character.spec.hair
    if spec.beard is None:
        return
    hair = next(p for p in all_primitives(vrm.gltf) if material_extras(vrm.gltf, p)["class"] == "hair")
    size = character.spec.proportions.head
    centre = joint_place(character, "head") + HEAD_CENTRE_OFFSET * size
    x, y, z = ((hair.attributes["POSITION"] - centre) / size * 1000.0).T
    front = z > 60.0
    mouth = front & (np.abs(x) < 28.0) & (y < style.mouth_y + 3.0) & (y > style.mouth_y - 20.0)
    assert not mouth.any()
    chin = front & (y < style.mouth_y - 35.0) & (y > style.mouth_y - 90.0)
    assert chin.sum() > 50
    joint = vrm.gltf.skins[0].joints.index(vrm.bones["head"])
    on_head = (hair.attributes["WEIGHTS_0"] * (hair.attributes["JOINTS_0"] == joint)).sum(axis=1)
    np.testing.assert_allclose(on_head[chin], 1.0, atol=0.01)


def test_left_and_right_are_bound_alike(character):
    """Mirrored points have mirrored weights, in the coat and in the legs."""
    points = np.random.default_rng(3).uniform((0.02, 0.1, -0.1), (0.2, 0.95, 0.1), (300, 3))
    columns = character.rig.mirrored_columns()
    for bind in (character.binder.coat, character.binder.legs):
        weights = bind(points)
        np.testing.assert_allclose(weights.sum(1), 1.0)
        np.testing.assert_allclose(bind(points * (-1, 1, 1)), weights[:, columns], atol=1e-9)


def test_the_expression_atlas_gives_every_preset_a_cell_of_its_own():
    cells = {cell_of(name) for name in EXPRESSIONS}
    assert len(cells) == len(EXPRESSIONS) == 18
    assert all(0 <= u <= 1 - 1 / COLUMNS + 1e-9 and 0 <= v <= 1 - 1 / ROWS + 1e-9 for u, v in cells)


def test_bad_numbers_are_refused_with_their_place(tmp_path):
    text = (FOLDER / "mira.yaml").read_text(encoding="utf-8")
    slip = tmp_path / "slip.yaml"
    slip.write_text(text.replace("sock_top:", "sok_top:"), encoding="utf-8")
    with pytest.raises(BadInput, match=r"slip\.yaml:\d+:\d+.*sock_top"):
        load_character(slip)
    slip.write_text(text.replace("chin: 0.020", "chin: soft"), encoding="utf-8")
    with pytest.raises(BadInput, match=r"slip\.yaml:\d+:\d+.*number"):
        load_character(slip)
    slip.write_text(text.replace('"#E9543F"', '"#E9543"'), encoding="utf-8")
    with pytest.raises(BadInput, match="#rrggbb"):
        load_character(slip)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("kind: haori", "kind: kilt", r"coat \| haori \| dungarees.*kilt"),
        ("  shoe: shoe", "  shoe: boot", "no colours for the material 'boot'"),
        ("  neck: [1.25, 1.0]", "  neck: [1.25]", "2 numbers"),
        ("layer: crown, azimuth_deg: [182", "layer: crwon, azimuth_deg: [182", r"fringe \| accent.*crwon"),
        ("  age: 0.85", "  age: 8.5", "from 0 to 1"),
        ("eye_flat: 0.22", "eye_flap: 0.22", "did you mean 'eye_flat'"),
        ("  cord: {stiffness", "  cords: {stiffness", "did you mean 'cord'"),
    ],
)
def test_a_designers_slip_is_one_line_with_its_place(tmp_path, old, new, says):
    text = (FOLDER / "genzo.yaml").read_text(encoding="utf-8")
    assert old in text
    slip = tmp_path / "slip.yaml"
    slip.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(BadInput, match=rf"slip\.yaml:\d+:\d+.*{says}") as caught:
        load_character(slip)
    assert "\n" not in str(caught.value)


def test_stretching_keeps_soles_on_the_ground_and_the_body_symmetric(name, character):
    rig, reference = character.figure.rig, character.rig
    where = dict(zip(rig.names, rig.position, strict=True))
    scale = character.spec.proportions.foot
    assert where["leftFoot"][1] == pytest.approx(reference.position[reference.index["leftFoot"], 1] * scale)
    for bone, place in where.items():
        if bone.startswith("left") and "Sleeve" not in bone:
            np.testing.assert_allclose(where["right" + bone[4:]], place * (-1, 1, 1), atol=1e-9)
    if name == "mira":
        assert character.figure.rig is reference
    for before, after in zip(reference.chains, rig.chains, strict=True):
        assert before.joints == after.joints
        assert np.isfinite(after.points).all()


def test_clothes_stretch_with_the_body_under_them(character):
    """What touches at the reference's size touches at the person's: weights, not places, decide."""
    arm = character.anatomy.arm
    points = np.array([arm.at(d) for d in np.linspace(0.0, 0.42, 15)])
    mesh = Mesh(points, np.tile([0.0, 0.0, 1.0], (15, 1)), np.zeros((0, 3), np.int64))
    moved = character.figure.stretched(mesh, character.binder.rigid(points, "leftLowerArm"))
    figure = character.figure
    elbow, wrist = (figure.rig.bind[figure.rig.index[f"left{n}"], :3, 3] for n in ("LowerArm", "Hand"))
    want = elbow + np.outer((np.linspace(0.0, 0.42, 15) - 0.216) / 0.206, wrist - elbow)
    np.testing.assert_allclose(moved.position, want, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(moved.normal, axis=1), 1.0)


def test_the_sleeve_follows_the_arm_and_the_coats_side_stays_with_the_trunk(character):
    arm, binder = character.anatomy.arm, character.binder
    joint = binder.rig.index

    def around(distance: float, radius: float) -> np.ndarray:
        angle = np.linspace(0, 2 * np.pi, 8, endpoint=False)
        return np.array([arm.at(distance, radius * np.sin(a), radius * np.cos(a)) for a in angle])

    assert (binder.coat(around(0.115, 0.062))[:, joint["leftUpperArm"]] > 0.85).all()
    side = np.array([(0.135, y, 0.0) for y in (0.66, 0.70, 0.74)])
    for name, points in (("left", side), ("right", side * (-1, 1, 1))):
        weights = binder.coat(points)
        np.testing.assert_allclose(weights.sum(1), 1.0)
        assert (weights[:, joint[f"{name}UpperArm"]] < 0.1).all()
    over_joint = binder.coat(arm.shoulder[None] + (0.0, 0.06, 0.0))[0]
    assert over_joint[joint["leftShoulder"]] > 0.1
    assert over_joint[joint["leftUpperArm"]] > 0.1


def test_no_two_persons_have_one_silhouette():
    """The outlines from the front, laid over each other at one height and at true size, share too little to mistake."""
    shapes = {}
    for name in NAMES:
        file = read_gltf(FOLDER / f"{name}.lod.glb")
        points = np.vstack([p.attributes["POSITION"] for p in all_primitives(file) if "NORMAL" in p.attributes])
        x, y = np.digitize(points[:, 0], np.linspace(-0.5, 0.5, 51)), np.digitize(points[:, 1], np.linspace(0, 1.6, 81))
        grid = np.zeros((52, 82), bool)
        grid[x, y] = True
        shapes[name] = grid
    for a, b in itertools.combinations(NAMES, 2):
        shared = (shapes[a] & shapes[b]).sum() / (shapes[a] | shapes[b]).sum()
        assert shared < 0.80, f"{a} and {b} share {shared:.2f}"


def test_every_face_is_its_own():
    styles = [load_character(FOLDER / f"{name}.yaml").face for name in NAMES]
    for field in ("iris", "brow", "eye_x", "mouth_y"):
        assert len({getattr(style, field) for style in styles}) == len(NAMES)


def test_the_shirts_sleeve_is_bound_as_the_coat_over_it(character):
    arm, binder = character.anatomy.arm, character.binder
    points = np.array([arm.at(d, 0.045) for d in (0.05, 0.08, 0.11)])
    trunk = [binder.rig.index[n] for n in ("chest", "spine", "leftShoulder")]
    np.testing.assert_allclose(binder.left_sleeve(points)[:, trunk], binder.coat(points)[:, trunk])
