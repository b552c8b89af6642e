"""glTF: decoding, trees, skins, animation; the validator's own cases as an oracle; one line for what is broken."""

from __future__ import annotations

import base64
import json
import struct
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from game.core import BadInput
from game.formats import animation_clip, read_gltf, skeleton_of

HUGE = 2**31


def test_a_small_file_in_full(model, store):
    file = read_gltf(store(model))
    assert file.findings == []
    primitive = file.meshes[0].primitives[0]
    assert {name: (array.dtype.str, array.shape) for name, array in primitive.attributes.items()} == {
        "POSITION": ("<f4", (4, 3)),
        "NORMAL": ("<f4", (4, 3)),
        "JOINTS_0": ("<u2", (4, 4)),
        "WEIGHTS_0": ("<f4", (4, 4)),
        "_OUTLINE": ("<f4", (4,)),
    }
    np.testing.assert_allclose(primitive.attributes["WEIGHTS_0"][0], [1, 0, 0, 0])
    assert primitive.indices is not None
    assert primitive.indices.tolist() == [0, 1, 2, 0, 2, 3]
    assert primitive.targets[0]["POSITION"].shape == (4, 3)
    assert file.meshes[0].target_names == ("smile",)
    assert file.materials[0].extras == {"class": "skin"}
    assert file.nodes[3].extras == {"lod": 8000}
    assert [node.parent for node in file.nodes] == [-1, 0, 1, -1]
    np.testing.assert_allclose(file.node_model[2, :3, 3], [0, 1.75, 0])
    np.testing.assert_allclose(file.skins[0].inverse_bind[1] @ file.node_model[1], np.eye(4))
    with pytest.raises(ValueError, match="read-only"):
        primitive.attributes["POSITION"][0, 0] = 9


def test_skeleton_and_clip_stand_where_the_nodes_do(model, store):
    model.document["nodes"][0]["scale"] = [2, 2, 2]
    file = read_gltf(store(model))
    rig = skeleton_of(file, [2])
    assert rig.skeleton.names == ("hips", "spine", "tip")
    np.testing.assert_allclose(rig.skeleton.rest_model[:, :3, 3], file.node_model[:3, :3, 3], atol=1e-12)
    assert skeleton_of(file).skin_joints(file, 0).tolist() == [0, 1]
    clip = animation_clip(file, 0, fps=4.0, skeleton=rig)
    assert len(clip) == 5
    # A half turn about z in one second: after half a second the tip lies to the side, at the end it hangs.
    tip = clip.to_model()[0][:, 2]
    np.testing.assert_allclose(tip[[0, 2, 4]], [[0, 2.5, 0], [-1, 1.5, 0], [0, 0.5, 0]], atol=1e-6)
    np.testing.assert_allclose(tip[1], [-np.sqrt(0.5), 1.5 + np.sqrt(0.5), 0], atol=1e-6)


def test_cubic_and_step_interpolation(model, store):
    sampler = model.document["animations"][0]["samplers"][0]
    values = np.zeros((3, 3, 3), np.float32)
    values[:, 1, 0] = (0, 1, 0)
    model.document["animations"][0]["channels"] = [{"sampler": 0, "target": {"node": 1, "path": "translation"}}]
    sampler.update(output=model.accessor(values.reshape(-1, 3), "VEC3"), interpolation="CUBICSPLINE")
    clip = animation_clip(read_gltf(store(model)), 0, fps=8.0)
    joint = clip.skeleton.index["spine"]
    np.testing.assert_allclose(clip.translation[:, joint, 0], [0, 0.15625, 0.5, 0.84375, 1, 0.84375, 0.5, 0.15625, 0])
    sampler.update(output=model.accessor(values[:, 1], "VEC3"), interpolation="STEP")
    del model.document["buffers"]
    clip = animation_clip(read_gltf(store(model)), 0, fps=8.0)
    np.testing.assert_allclose(clip.translation[:, joint, 0], [0, 0, 0, 0, 1, 1, 1, 1, 0])


@pytest.mark.parametrize(("code", "limit"), [(5120, 127), (5121, 255), (5122, 32767), (5123, 65535)])
def test_normalised_integers(model, store, code: int, limit: int):
    dtype = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16}[code]
    index = model.accessor(np.array([0, limit, np.iinfo(dtype).min], dtype), "SCALAR", normalized=True)
    np.testing.assert_allclose(read_gltf(store(model)).accessor(index), [0, 1, -1 if code in (5120, 5122) else 0])


def test_interleaved_strided_sparse_and_padded_data(model, store):
    both = model.accessor(np.arange(24, dtype=np.float32).reshape(4, 6), "VEC3")
    accessors, views = model.document["accessors"], model.document["bufferViews"]
    views[accessors[both]["bufferView"]]["byteStride"] = 24
    accessors.append({**accessors[both], "byteOffset": 12})
    second = len(accessors) - 1
    places = model.accessor(np.array([1, 3], np.uint8), "SCALAR")
    values = model.accessor(np.array([[7, 7, 7], [9, 9, 9]], np.float32), "VEC3")
    sparse = {
        "count": 2,
        "indices": {"bufferView": accessors[places]["bufferView"], "componentType": 5121},
        "values": {"bufferView": accessors[values]["bufferView"]},
    }
    accessors.append({"componentType": 5126, "count": 5, "type": "VEC3", "sparse": sparse})
    zeros = len(accessors) - 1
    # Columns of a 3x3 matrix of bytes begin at multiples of 4.
    padded = model.accessor(np.array([[1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0]], np.uint8).reshape(-1), "MAT3")
    accessors[padded]["count"] = 1
    file = read_gltf(store(model))
    np.testing.assert_array_equal(file.accessor(both)[1], [6, 7, 8])
    np.testing.assert_array_equal(file.accessor(second)[1], [9, 10, 11])
    np.testing.assert_array_equal(file.accessor(zeros)[:, 0], [0, 7, 0, 9, 0])
    np.testing.assert_array_equal(file.accessor(padded)[0], [[1, 4, 7], [2, 5, 8], [3, 6, 9]])


def _path(document: Any, pointer: str) -> tuple[Any, Any]:
    *parts, last = [int(part) if part.isdigit() else part for part in pointer.strip("/").split("/")]
    for part in parts:
        document = document[part]
    return document, last


@pytest.mark.parametrize(
    ("pointer", "value", "message"),
    [
        ("/asset/version", "1.0", "/asset/version: expected glTF 2"),
        ("/asset/version", "2", "a version such as 2.0"),
        ("/nodes/1/children", [1], "/nodes/1/children/0"),
        ("/nodes/2/children", [0], "ancestor"),
        ("/nodes/3/children", [1], "has another parent"),
        ("/nodes/0/children", [99], "/nodes/0/children/0: expected an index into the 4 nodes but saw 99"),
        ("/nodes/0/children", [1, 1], "no item twice"),
        ("/nodes/0/children", [True], "an index into nodes"),
        ("/nodes/1/rotation", [0, 0, 0, 0], "a unit quaternion"),
        ("/nodes/0/translation", [1e300, 0, 0], "/nodes/0/translation/0"),
        ("/nodes/0/translation", [0, 0], "3 items but saw 2"),
        ("/nodes/0/translation", [], "3 items but saw 0"),
        ("/nodes/2/matrix", [], "16 items but saw 0"),
        ("/nodes/2/translation", [0, 0, 0], "/nodes/2/matrix: a matrix beside"),
        ("/nodes/2/matrix/3", 5, "not an affine matrix"),
        ("/nodes/2/matrix/4", 5, "shear"),
        ("/nodes", {}, "/nodes: expected a list"),
        ("/accessors/0/count", HUGE, "/accessors/0: needs"),
        ("/accessors/0/count", 2**60, "/accessors/0/count"),
        ("/accessors/0/count", 0, "/accessors/0/count"),
        ("/accessors/0/count", -1, "/accessors/0/count"),
        ("/accessors/0/count", 3.5, "a whole number"),
        ("/accessors/0/byteOffset", HUGE, "/accessors/0: needs"),
        ("/accessors/0/componentType", 5124, "/accessors/0/componentType"),
        ("/accessors/0/type", "VEC9", "/accessors/0/type"),
        ("/accessors/0/normalized", True, "/accessors/0/normalized"),
        ("/accessors/0/min", [0], "/accessors/0/min: expected 3 numbers"),
        ("/accessors/1/count", 3, "expected 4 vertices"),
        ("/accessors/0", {"componentType": 5126, "count": HUGE, "type": "VEC3"}, "bytes of decoded data"),
        ("/bufferViews/0/byteLength", HUGE, "/bufferViews/0: ends at byte"),
        ("/bufferViews/0/byteOffset", HUGE, "/bufferViews/0: ends at byte"),
        ("/bufferViews/0/byteStride", 4, "byteStride 4"),
        ("/buffers", [{"byteLength": HUGE}], "/buffers/0/byteLength"),
        ("/buffers", [{"byteLength": 10**300}], "/buffers/0/byteLength"),
        ("/meshes/0/primitives/0/attributes/POSITION", 4, "/attributes/POSITION: expected a format allowed"),
        ("/meshes/0/primitives/0/attributes/JOINTS_1", 2, "do not come in pairs"),
        ("/meshes/0/primitives/0/indices", 0, "/indices: expected SCALAR"),
        ("/meshes/0/primitives/0/mode", 7, "/mode"),
        ("/meshes/0/primitives/0/targets/0/POSITION", 5, "expected 4 vertices"),
        ("/meshes/0/weights", [0, 0], "/meshes/0/weights: expected 1 weights"),
        ("/skins/0/joints", [0], None),
        ("/skins/0/joints", [], "at least one joint"),
        ("/skins/0/joints", [0, 1, 2], "3 matrices"),
        ("/skins/0/inverseBindMatrices", 0, "MAT4"),
        ("/animations/0/channels/0/sampler", 5, "/channels/0/sampler"),
        ("/animations/0/channels/0/target/path", "translation", "VEC3"),
        ("/animations/0/channels/0/target/node", 2, "has a matrix"),
        ("/animations/0/samplers/0/input", 4, "4 elements"),
        ("/animations/0/samplers/0/interpolation", "CUBICSPLINE", "9 elements"),
        ("/extensionsRequired", ["KHR_draco_mesh_compression"], "extensionsUsed"),
        ("/materials/0/pbrMetallicRoughness/baseColorFactor", [2, 0, 0, 0], "from 0 to 1"),
        ("/images", [{"uri": "../secret.png"}], "inside the file's folder"),
        ("/scene", 5, "/scene: expected an index into the 1 scenes"),
    ],
)
def test_each_fault_is_one_line_with_its_pointer(model, store, pointer: str, value: Any, message: str | None):
    holder, key = _path(model.document, pointer)
    holder[key] = value
    path = store(model)
    if message is None:
        # One joint is enough: no vertex is weighted to the second.
        assert len(read_gltf(path).skins[0].joints) == 1
        return
    with pytest.raises(BadInput) as caught:
        read_gltf(path, max_bytes=10_000_000)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500


def test_data_that_cannot_be_drawn(model, store):
    nan = model.copy()
    nan.accessor(np.array([0, np.nan, 1], np.float32), "SCALAR")
    with pytest.raises(BadInput, match=r"/accessors/10: holds NaN or infinity \(element 1\)"):
        read_gltf(store(nan))
    outside = model.copy()
    attributes = outside.document["meshes"][0]["primitives"][0]
    attributes["indices"] = outside.accessor(np.array([0, 1, 4], np.uint8), "SCALAR")
    with pytest.raises(BadInput, match="expected indices below 4 but saw 4"):
        read_gltf(store(outside))
    bound = model.copy()
    joints = bound.accessor(np.array([[2, 0, 0, 0]] * 4, np.uint8), "VEC4")
    bound.document["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = joints
    with pytest.raises(BadInput, match="expected joints below 2 but saw 2"):
        read_gltf(store(bound))
    back = model.copy()
    back.document["animations"][0]["samplers"][0]["input"] = back.accessor(np.float32([0, 1, 0.5]), "SCALAR")
    with pytest.raises(BadInput, match="times that go back"):
        read_gltf(store(back))


def test_compressed_meshes_are_named(model, store):
    model.document["extensionsUsed"] = model.document["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    with pytest.raises(BadInput, match="needs KHR_draco_mesh_compression"):
        read_gltf(store(model))


@pytest.mark.parametrize(
    "uri",
    [
        "../out.bin",
        "a/../../out.bin",
        "%2e%2e/out.bin",
        "..\\out.bin",
        "/etc/passwd",
        "\\\\host\\share",
        "C:/windows/x",
        "file:///etc/passwd",
        "http://example.org/x.bin",
        "link.bin",
        "folder/out.bin",
        "a\0b",
        "",
        ".",
        "missing.bin",
        "x" * 5000,
        "data:application/octet-stream;base64,@@@@",
        "data:application/octet-stream",
    ],
)
def test_no_path_leaves_the_folder(tmp_path: Path, uri: str):
    outside = tmp_path / "out.bin"
    outside.write_bytes(b"secret")
    folder = tmp_path / "model"
    folder.mkdir()
    (folder / "link.bin").symlink_to(outside)
    (folder / "folder").symlink_to(tmp_path, target_is_directory=True)
    path = folder / "m.gltf"
    path.write_text(json.dumps({"asset": {"version": "2.0"}, "buffers": [{"uri": uri, "byteLength": 1}]}))
    with pytest.raises(BadInput) as caught:
        read_gltf(path)
    assert "/buffers/0/uri" in str(caught.value)
    assert "secret" not in str(caught.value)
    assert len(str(caught.value)) < 500


def test_files_and_data_uris_of_the_folder(tmp_path: Path):
    (tmp_path / "my data.bin").write_bytes(struct.pack("<3f", 1, 2, 3))
    inline = base64.b64encode(struct.pack("<3f", 4, 5, 6)).decode()
    document = {
        "asset": {"version": "2.0"},
        "buffers": [
            {"uri": "my%20data.bin", "byteLength": 12},
            {"uri": f"data:application/octet-stream;base64,{inline}", "byteLength": 12},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 12}, {"buffer": 1, "byteLength": 12}],
        "accessors": [{"bufferView": v, "componentType": 5126, "count": 3, "type": "SCALAR"} for v in (0, 1)],
    }
    path = tmp_path / "m.gltf"
    path.write_text(json.dumps(document))
    file = read_gltf(path)
    assert file.accessor(0).tolist() == [1, 2, 3]
    assert file.accessor(1).tolist() == [4, 5, 6]
    with pytest.raises(BadInput, match="so no skeleton"):
        skeleton_of(file)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "JSON"),
        ("[]", "expected a JSON object"),
        ("{", ":1:2: JSON"),
        ('{"asset": {"version": "2.0"},\n "asset": 1}', "stands twice"),
        ('{"asset": {"version": "2.0"}, "x": NaN}', "NaN"),
        ('{"asset": {"version": "2.0"}, "x": ' + "[" * 100_000, "JSON"),
        ('{"asset": {"version": "2.0"}, "x": ' + "[" * 500 + "]" * 500 + "}", "deep"),
        ('{"a":' * 100_000, "JSON"),
        ('{"asset": {"version": "2.0"}, "nodes": [' + "9" * 10_000 + "]}", "JSON"),
        ("[" + "0," * 1_100_000 + "0]", "too many elements"),
        ('{"asset": {"version": "2.0"}}\0', "JSON"),
        ('{"asset": {"version": "2.0"}, "extensions": {"VRM": 5}}', "expected an object"),
    ],
    ids=range(12),
)
def test_json_that_is_none(store, text: str, message: str):
    with pytest.raises(BadInput, match=message) as caught:
        read_gltf(store(text, "m.gltf"))
    assert "\n" not in str(caught.value)


def test_broken_containers(model, store):
    whole = model.to_glb()
    for cut in (3, 4, 8, 11, 12, 15, 19, 25, len(whole) // 2, len(whole) - 1):
        with pytest.raises(BadInput):
            read_gltf(store(whole[:cut]))
    for at, value, message in [
        (4, 1, "version 2"),
        (8, 2**32 - 1, "GLB length"),
        (8, 4, "GLB length"),
        (12, 2**32 - 4, "GLB chunk"),
        (12, 0, "JSON"),
        (16, 0x004E4942, "JSON chunk first"),
    ]:
        damaged = bytearray(whole)
        struct.pack_into("<I", damaged, at, value)
        with pytest.raises(BadInput, match=message):
            read_gltf(store(bytes(damaged)))
    assert read_gltf(store(whole + b"more")).findings == []


def test_a_chain_of_nodes_ends_somewhere(store):
    def chain(length: int) -> str:
        nodes: list[dict[str, Any]] = [{"children": [at + 1]} for at in range(length - 1)]
        return json.dumps({"asset": {"version": "2.0"}, "nodes": [*nodes, {}]})

    assert len(skeleton_of(read_gltf(store(chain(500), "m.gltf"))).skeleton) == 500
    with pytest.raises(BadInput, match="more than 512 levels"):
        read_gltf(store(chain(15_000), "m.gltf"))
    with pytest.raises(BadInput, match="at most 20000 nodes"):
        read_gltf(store(chain(25_000), "m.gltf"))


def test_scales_that_multiply_without_end(store):
    nodes: list[dict[str, Any]] = [
        {"scale": [1e9] * 3, "children": [at + 1], "translation": [1, 0, 0]} for at in range(100)
    ]
    file = read_gltf(store(json.dumps({"asset": {"version": "2.0"}, "nodes": [*nodes, {}]}), "m.gltf"))
    with pytest.raises(BadInput, match="beyond all bounds"):
        skeleton_of(file)


def test_overlapping_accessors_share_one_budget(model, store):
    model.document["accessors"] += [{"componentType": 5126, "count": 1_000_000, "type": "MAT4"} for _ in range(200)]
    path = store(model)
    tracemalloc.start()
    try:
        with pytest.raises(BadInput, match="bytes of decoded data"):
            read_gltf(path, max_bytes=50_000_000)
        assert tracemalloc.get_traced_memory()[1] < 400_000_000
    finally:
        tracemalloc.stop()
