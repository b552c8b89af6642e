"""The shapes of the VRM family's glTF extensions: VRM 0.x, VRMC_vrm and VRMC_springBone 1.0, VRMC_vrm_animation 1.0."""

from __future__ import annotations

from game.formats.json_shape import Fields, Flag, Index, Items, Number, Shape, Table, Text

__all__ = ["VRM0", "VRMA", "VRMC_SPRING", "VRMC_VRM"]

_NUMBER = Number(-1e6, 1e6)
_NOT_NEGATIVE = Number(0, 1e6)
_VECTOR = Items(_NUMBER, (3,))
_NODE = Index("nodes")


def _list(of: Shape) -> Items:
    return Items(of, empty_ok=True)


def _table_of_nodes() -> Fields:
    return Fields({"humanBones": Table(Fields({"node": _NODE}, ("node",)))}, ("humanBones",))


# --- 1.0 -----------------------------------------------------------------------------------------------------
_EXPRESSION = Fields(
    {
        "morphTargetBinds": _list(
            Fields(
                {"node": _NODE, "index": Number(0, 1e6, integer=True), "weight": _NUMBER}, ("node", "index", "weight")
            )
        ),
        "materialColorBinds": _list(
            Fields(
                {"material": Index("materials"), "type": Text(), "targetValue": Items(_NUMBER, (3, 4))}, ("material",)
            )
        ),
        "textureTransformBinds": _list(
            Fields(
                {"material": Index("materials"), "scale": Items(_NUMBER, (2,)), "offset": Items(_NUMBER, (2,))},
                ("material",),
            )
        ),
        "isBinary": Flag(),
        "overrideBlink": Text(("none", "block", "blend")),
        "overrideLookAt": Text(("none", "block", "blend")),
        "overrideMouth": Text(("none", "block", "blend")),
    }
)
_RANGE_1 = Fields({"inputMaxValue": _NUMBER, "outputScale": _NUMBER})
VRMC_VRM = Fields(
    {
        "specVersion": Text(),
        "meta": Fields(
            {"name": Text(), "authors": _list(Text()), "licenseUrl": Text(), "thumbnailImage": Index("images")}
        ),
        "humanoid": _table_of_nodes(),
        "expressions": Fields({"preset": Table(_EXPRESSION), "custom": Table(_EXPRESSION)}),
        "lookAt": Fields(
            {
                "type": Text(("bone", "expression")),
                "offsetFromHeadBone": _VECTOR,
                **dict.fromkeys(
                    (f"rangeMap{n}" for n in ("HorizontalInner", "HorizontalOuter", "VerticalDown", "VerticalUp")),
                    _RANGE_1,
                ),
            }
        ),
        "firstPerson": Fields(
            {
                "meshAnnotations": _list(
                    Fields(
                        {"node": _NODE, "type": Text(("auto", "both", "thirdPersonOnly", "firstPersonOnly"))}, ("node",)
                    )
                )
            }
        ),
    },
    ("meta", "humanoid"),
)

_JOINT: Shape = Fields(
    {
        "node": _NODE,
        "hitRadius": _NOT_NEGATIVE,
        "stiffness": _NOT_NEGATIVE,
        "gravityPower": _NUMBER,
        "gravityDir": _VECTOR,
        "dragForce": _NUMBER,
    },
    ("node",),
)
VRMC_SPRING = Fields(
    {
        "specVersion": Text(),
        "colliders": _list(
            Fields(
                {
                    "node": _NODE,
                    "shape": Fields(
                        {
                            "sphere": Fields({"offset": _VECTOR, "radius": _NOT_NEGATIVE}),
                            "capsule": Fields({"offset": _VECTOR, "radius": _NOT_NEGATIVE, "tail": _VECTOR}),
                        }
                    ),
                },
                ("node", "shape"),
            )
        ),
        "colliderGroups": _list(Fields({"name": Text(), "colliders": _list(Index("springColliders"))}, ("colliders",))),
        "springs": _list(
            Fields(
                {
                    "name": Text(),
                    "joints": _list(_JOINT),
                    "colliderGroups": _list(Index("springColliderGroups")),
                    "center": _NODE,
                },
                ("joints",),
            )
        ),
    }
)

VRMA = Fields(
    {
        "specVersion": Text(),
        "humanoid": _table_of_nodes(),
        "expressions": Fields(
            {
                "preset": Table(Fields({"node": _NODE}, ("node",))),
                "custom": Table(Fields({"node": _NODE}, ("node",))),
            }
        ),
        "lookAt": Fields({"node": _NODE, "offsetFromHeadBone": _VECTOR}, ("node",)),
    }
)

# --- 0.x (UniVRM writes every field, with -1 for "none") --------------------------------------------------------
_XYZ = Fields(dict.fromkeys("xyz", _NUMBER))
_OPTIONAL_NODE = Index("nodes", none=True)
_RANGE_0 = Fields({"xRange": _NUMBER, "yRange": _NUMBER})
VRM0 = Fields(
    {
        "meta": Fields({"title": Text(), "author": Text(), "version": Text(), "licenseName": Text()}),
        "humanoid": Fields(
            {"humanBones": _list(Fields({"bone": Text(), "node": _OPTIONAL_NODE}, ("bone", "node")))}, ("humanBones",)
        ),
        "firstPerson": Fields(
            {
                "firstPersonBone": _OPTIONAL_NODE,
                "firstPersonBoneOffset": _XYZ,
                "lookAtTypeName": Text(),
                "meshAnnotations": _list(Fields({"mesh": Index("meshes", none=True), "firstPersonFlag": Text()})),
                **dict.fromkeys(
                    (f"lookAt{n}" for n in ("HorizontalInner", "HorizontalOuter", "VerticalDown", "VerticalUp")),
                    _RANGE_0,
                ),
            }
        ),
        "blendShapeMaster": Fields(
            {
                "blendShapeGroups": _list(
                    Fields(
                        {
                            "name": Text(),
                            "presetName": Text(),
                            "isBinary": Flag(),
                            "binds": _list(
                                Fields(
                                    {
                                        "mesh": Index("meshes", none=True),
                                        "index": Number(-1, 1e6, integer=True),
                                        "weight": _NUMBER,
                                    }
                                )
                            ),
                            "materialValues": _list(
                                Fields(
                                    {
                                        "materialName": Text(),
                                        "propertyName": Text(),
                                        "targetValue": _list(_NUMBER),
                                    }
                                )
                            ),
                        }
                    )
                )
            }
        ),
        "secondaryAnimation": Fields(
            {
                "boneGroups": _list(
                    Fields(
                        {
                            "comment": Text(),
                            # The specification's own spelling.
                            "stiffiness": _NUMBER,
                            "gravityPower": _NUMBER,
                            "gravityDir": _XYZ,
                            "dragForce": _NUMBER,
                            "hitRadius": _NUMBER,
                            "center": _OPTIONAL_NODE,
                            "bones": _list(_OPTIONAL_NODE),
                            "colliderGroups": _list(Index("springColliderGroups")),
                        }
                    )
                ),
                "colliderGroups": _list(
                    Fields(
                        {
                            "node": _OPTIONAL_NODE,
                            "colliders": _list(Fields({"offset": _XYZ, "radius": _NOT_NEGATIVE})),
                        }
                    )
                ),
            }
        ),
    },
    ("humanoid",),
)
