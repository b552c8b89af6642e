"""Files of the outside world, each reader bounded in size, depth and time: strict YAML, BVH, glTF, VRM and VRMA."""

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
from game.formats.vrm import build_vrm, build_vrma, read_vrm, read_vrma
from game.formats.vrm_model import SpringChain, SpringCollider, SpringJoint, Vrm, VrmAnimation, VrmExpression, VrmLookAt
from game.formats.yaml_source import Node, load_yaml, nearest, parse_yaml

__all__ = [
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
    "Node",
    "SpringChain",
    "SpringCollider",
    "SpringJoint",
    "Vrm",
    "VrmAnimation",
    "VrmExpression",
    "VrmLookAt",
    "animation_clip",
    "build_vrm",
    "build_vrma",
    "estimate_scale",
    "load_yaml",
    "nearest",
    "parse_yaml",
    "read_bvh",
    "read_gltf",
    "read_vrm",
    "read_vrma",
    "skeleton_of",
    "to_metres",
    "write_bvh",
]
