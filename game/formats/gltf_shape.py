"""The shape of a glTF 2.0 document (Khronos specification, chapter 5), as far as this project reads it."""

from __future__ import annotations

from game.formats.json_shape import Anything, Fields, Flag, Index, Items, Number, Shape, Table, Text

__all__ = ["COMPONENTS", "GLTF", "LISTS", "TYPES"]

LISTS = (
    "accessors",
    "animations",
    "buffers",
    "bufferViews",
    "cameras",
    "images",
    "materials",
    "meshes",
    "nodes",
    "samplers",
    "scenes",
    "skins",
    "textures",
)

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
TYPES = {
    "SCALAR": (1, 1),
    "VEC2": (1, 2),
    "VEC3": (1, 3),
    "VEC4": (1, 4),
    "MAT2": (2, 2),
    "MAT3": (3, 3),
    "MAT4": (4, 4),
}
"""Type name -> (columns, rows)."""

_SIZE = Number(0, 2**40, integer=True)
_COUNT = Number(1, 2**40, integer=True)
_UNIT = Number(0.0, 1.0)
_ANY_NUMBER = Number()
_OBJECT = Table(Anything())


def _object(known: dict[str, Shape], *required: str) -> Fields:
    return Fields({"extensions": Table(_OBJECT), "extras": Anything(), **known}, required)


def _named(known: dict[str, Shape], *required: str) -> Fields:
    return _object({"name": Text(), **known}, *required)


def _vector(length: int, number: Number = _ANY_NUMBER) -> Items:
    return Items(number, (length,))


_TEXTURE = _object({"index": Index("textures"), "texCoord": Number(0, 64, integer=True)}, "index")
_NORMAL_TEXTURE = _object({**_TEXTURE.known, "scale": _ANY_NUMBER}, "index")
_OCCLUSION_TEXTURE = _object({**_TEXTURE.known, "strength": _UNIT}, "index")

_ACCESSOR = _named(
    {
        "bufferView": Index("bufferViews"),
        "byteOffset": _SIZE,
        "componentType": Number(5120, 5126, integer=True),
        "normalized": Flag(),
        "count": _COUNT,
        "type": Text(tuple(TYPES), strict=True),
        "max": Items(_ANY_NUMBER),
        "min": Items(_ANY_NUMBER),
        "sparse": _object(
            {
                "count": _COUNT,
                "indices": _object(
                    {
                        "bufferView": Index("bufferViews"),
                        "byteOffset": _SIZE,
                        "componentType": Number(5121, 5125, integer=True),
                    },
                    "bufferView",
                    "componentType",
                ),
                "values": _object({"bufferView": Index("bufferViews"), "byteOffset": _SIZE}, "bufferView"),
            },
            "count",
            "indices",
            "values",
        ),
    },
    "componentType",
    "count",
    "type",
)

_ANIMATION = _named(
    {
        "channels": Items(
            _object(
                {
                    "sampler": _SIZE,
                    "target": _object(
                        {
                            "node": Index("nodes"),
                            "path": Text(("translation", "rotation", "scale", "weights", "pointer")),
                        },
                        "path",
                    ),
                },
                "sampler",
                "target",
            )
        ),
        "samplers": Items(
            _object(
                {
                    "input": Index("accessors"),
                    "output": Index("accessors"),
                    "interpolation": Text(("LINEAR", "STEP", "CUBICSPLINE")),
                },
                "input",
                "output",
            )
        ),
    },
    "channels",
    "samplers",
)

_CAMERA = _named(
    {
        "type": Text(("perspective", "orthographic")),
        "perspective": _object(
            {
                "aspectRatio": Number(0, above=True),
                "yfov": Number(0, above=True),
                "zfar": Number(0, above=True),
                "znear": Number(0, above=True),
            },
            "yfov",
            "znear",
        ),
        "orthographic": _object(
            {"xmag": _ANY_NUMBER, "ymag": _ANY_NUMBER, "zfar": Number(0, above=True), "znear": Number(0)},
            "xmag",
            "ymag",
            "zfar",
            "znear",
        ),
    },
    "type",
)

_MATERIAL = _named(
    {
        "pbrMetallicRoughness": _object(
            {
                "baseColorFactor": _vector(4, _UNIT),
                "baseColorTexture": _TEXTURE,
                "metallicFactor": _UNIT,
                "roughnessFactor": _UNIT,
                "metallicRoughnessTexture": _TEXTURE,
            }
        ),
        "normalTexture": _NORMAL_TEXTURE,
        "occlusionTexture": _OCCLUSION_TEXTURE,
        "emissiveTexture": _TEXTURE,
        # Beyond 1 in files from before KHR_materials_emissive_strength.
        "emissiveFactor": _vector(3, Number(0.0, 1e4)),
        "alphaMode": Text(("OPAQUE", "MASK", "BLEND")),
        "alphaCutoff": Number(0),
        "doubleSided": Flag(),
    }
)

_MESH = _named(
    {
        "primitives": Items(
            _object(
                {
                    "attributes": Table(Index("accessors")),
                    "indices": Index("accessors"),
                    "material": Index("materials"),
                    "mode": Number(0, 6, integer=True),
                    "targets": Items(Table(Index("accessors"))),
                },
                "attributes",
            )
        ),
        "weights": Items(_ANY_NUMBER),
    },
    "primitives",
)

_NODE = _named(
    {
        "camera": Index("cameras"),
        "children": Items(Index("nodes"), unique=True),
        "skin": Index("skins"),
        "matrix": _vector(16, Number(-1e9, 1e9)),
        "mesh": Index("meshes"),
        # Writers round 1 up to 1.0000001; that is not worth a refusal.
        "rotation": _vector(4, Number(-1.001, 1.001)),
        "scale": _vector(3, Number(-1e9, 1e9)),
        "translation": _vector(3, Number(-1e9, 1e9)),
        "weights": Items(_ANY_NUMBER),
    }
)

GLTF = _object(
    {
        "asset": _object(
            {"version": Text(), "minVersion": Text(), "generator": Text(), "copyright": Text()}, "version"
        ),
        "extensionsUsed": Items(Text(), unique=True),
        "extensionsRequired": Items(Text(), unique=True),
        "accessors": Items(_ACCESSOR),
        "animations": Items(_ANIMATION),
        "buffers": Items(_named({"uri": Text(), "byteLength": _COUNT}, "byteLength")),
        "bufferViews": Items(
            _named(
                {
                    "buffer": Index("buffers"),
                    "byteOffset": _SIZE,
                    "byteLength": _COUNT,
                    # The specification wants multiples of 4; real files have 3 and 6, and nothing depends on it.
                    "byteStride": Number(1, 252, integer=True),
                    "target": Number(integer=True),
                },
                "buffer",
                "byteLength",
            )
        ),
        "cameras": Items(_CAMERA),
        "images": Items(_named({"uri": Text(), "mimeType": Text(), "bufferView": Index("bufferViews")})),
        "materials": Items(_MATERIAL),
        "meshes": Items(_MESH),
        "nodes": Items(_NODE),
        "samplers": Items(
            _named(dict.fromkeys(("magFilter", "minFilter", "wrapS", "wrapT"), Number(0, 65535, integer=True)))
        ),
        "scene": Index("scenes"),
        "scenes": Items(_named({"nodes": Items(Index("nodes"), unique=True)})),
        "skins": Items(
            _named(
                {
                    "inverseBindMatrices": Index("accessors"),
                    "skeleton": Index("nodes"),
                    "joints": Items(Index("nodes"), unique=True),
                },
                "joints",
            )
        ),
        "textures": Items(_named({"sampler": Index("samplers"), "source": Index("images")})),
    },
    "asset",
)
