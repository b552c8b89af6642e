"""Files of the outside world, each reader bounded in size, depth and time: strict YAML, BVH, glTF, VRM and VRMA."""

from game.formats.avatar_geometry import AvatarGeometry, Morph, join_meshes
from game.formats.bvh import BvhFile, estimate_scale, read_bvh, to_metres, write_bvh
from game.formats.gltf import read_gltf
from game.formats.gltf_model import (
    GltfAnimation,
    GltfChannel,
    GltfFile,
    GltfImage,
    GltfMaterial,
    GltfMesh,
    GltfNode,
    GltfPrimitive,
    GltfSkin,
)
from game.formats.gltf_skeleton import GltfSkeleton, animation_clip, skeleton_of
from game.formats.joint_map import MAPS, JointMap, detect_map, find_map, load_map, map_from_bones, map_from_names
from game.formats.json_shape import Report
from game.formats.picture_header import picture_size
from game.formats.toon_material import ToonMaterial, ToonTexture, toon_materials
from game.formats.vrm import build_vrm, build_vrma, read_vrm, read_vrma
from game.formats.vrm_model import (
    HUMAN_BONES,
    REQUIRED_BONES,
    SpringChain,
    SpringCollider,
    SpringJoint,
    Vrm,
    VrmAnimation,
    VrmExpression,
    VrmLookAt,
)
from game.formats.yaml_source import Node, load_yaml, nearest, parse_yaml

__all__ = [
    "HUMAN_BONES",
    "MAPS",
    "REQUIRED_BONES",
    "AvatarGeometry",
    "BvhFile",
    "GltfAnimation",
    "GltfChannel",
    "GltfFile",
    "GltfImage",
    "GltfMaterial",
    "GltfMesh",
    "GltfNode",
    "GltfPrimitive",
    "GltfSkeleton",
    "GltfSkin",
    "JointMap",
    "Morph",
    "Node",
    "Report",
    "SpringChain",
    "SpringCollider",
    "SpringJoint",
    "ToonMaterial",
    "ToonTexture",
    "Vrm",
    "VrmAnimation",
    "VrmExpression",
    "VrmLookAt",
    "animation_clip",
    "build_vrm",
    "build_vrma",
    "detect_map",
    "estimate_scale",
    "find_map",
    "join_meshes",
    "load_map",
    "load_yaml",
    "map_from_bones",
    "map_from_names",
    "nearest",
    "parse_yaml",
    "picture_size",
    "read_bvh",
    "read_gltf",
    "read_vrm",
    "read_vrma",
    "skeleton_of",
    "to_metres",
    "toon_materials",
    "write_bvh",
]
