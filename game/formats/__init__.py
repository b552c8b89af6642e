"""Files of the outside world, each reader bounded in size, depth and time: strict YAML, BVH, glTF, VRM and VRMA."""

from game.formats.bvh import BvhFile, estimate_scale, read_bvh, to_metres, write_bvh
from game.formats.yaml_source import Node, load_yaml, nearest, parse_yaml

__all__ = [
    "BvhFile",
    "Node",
    "estimate_scale",
    "load_yaml",
    "nearest",
    "parse_yaml",
    "read_bvh",
    "to_metres",
    "write_bvh",
]
