"""Files of the outside world, each reader bounded in size, depth and time: strict YAML, BVH, glTF, VRM and VRMA."""

from game.formats.yaml_source import Node, load_yaml, nearest, parse_yaml

__all__ = ["Node", "load_yaml", "nearest", "parse_yaml"]
