"""Materials of a foreign avatar as one kind of data: MToon (1.0 and 0.x), unlit, and PBR seen as toon.

MToon 1.0: github.com/vrm-c/vrm-specification, VRMC_materials_mtoon-1.0. Values of 0.x are carried over as UniVRM's
migration does (MigrationMToonMaterial, MigrationMToonShading). Colour factors are linear, as the specifications have
them; 0.x stores its own in sRGB.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from game.formats.gltf_model import GltfFile
from game.formats.json_shape import Fields, Flag, Index, Items, Number, Report, Table, Text, check
from game.formats.srgb import linear_light

__all__ = ["MTOON", "VRM0_MATERIAL", "ToonMaterial", "ToonTexture", "toon_materials"]

Colour = tuple[float, float, float]

_UNIT = Number(0.0, 1.0)
_COLOUR = Items(Number(0.0, 1e4), (3,))
_TEXTURE = Fields({"index": Index("textures"), "texCoord": Number(0, 64, integer=True)}, ("index",))
MTOON = Fields(
    {
        "specVersion": Text(),
        "transparentWithZWrite": Flag(),
        "renderQueueOffsetNumber": Number(-1000, 1000, integer=True),
        "shadeColorFactor": _COLOUR,
        "shadeMultiplyTexture": _TEXTURE,
        "shadingShiftFactor": Number(-10.0, 10.0),
        "shadingShiftTexture": Fields({**_TEXTURE.known, "scale": Number(-1e4, 1e4)}, ("index",)),
        "shadingToonyFactor": _UNIT,
        "matcapTexture": _TEXTURE,
        "parametricRimColorFactor": _COLOUR,
        "parametricRimFresnelPowerFactor": Number(0.0, 1e4),
        "parametricRimLiftFactor": Number(-1e4, 1e4),
        "rimMultiplyTexture": _TEXTURE,
        "outlineWidthMode": Text(("none", "worldCoordinates", "screenCoordinates")),
        "outlineWidthFactor": Number(0.0, 1e4),
        "outlineWidthMultiplyTexture": _TEXTURE,
        "outlineColorFactor": _COLOUR,
        "outlineLightingMixFactor": _UNIT,
    }
)
VRM0_MATERIAL = Fields(
    {
        "name": Text(),
        "shader": Text(),
        "renderQueue": Number(-1_000_000, 1_000_000, integer=True),
        "floatProperties": Table(Number(-1e9, 1e9)),
        "vectorProperties": Table(Items(Number(-1e6, 1e6), empty_ok=True)),
        "textureProperties": Table(Index("textures", none=True)),
    }
)
_TRANSFORM = Fields(
    {
        "offset": Items(Number(-1e6, 1e6), (2,)),
        "scale": Items(Number(-1e6, 1e6), (2,)),
        "rotation": Number(-1e6, 1e6),
        "texCoord": Number(0, 64, integer=True),
    }
)
_PBR_OUTLINE_M = 0.0016
"""PBR says nothing of outlines; the rest of the picture has them."""


@dataclass(frozen=True)
class ToonTexture:
    """image: index into the file's images. wrap: repeats along u and v; nearest: enlarged without smoothing.

    offset, scale, rotation_rad as in KHR_texture_transform; texcoord: which set of coordinates.
    """

    image: int
    texcoord: int = 0
    offset: tuple[float, float] = (0.0, 0.0)
    scale: tuple[float, float] = (1.0, 1.0)
    rotation_rad: float = 0.0
    wrap: tuple[bool, bool] = (True, True)
    nearest: bool = False


@dataclass(frozen=True)
class ToonMaterial:
    """kind: "mtoon", "unlit" or "pbr" (approximated). lit: linear RGBA; shade, emissive, rim, outline: linear RGB.

    shift, toony: where the light ends and how sharply, as in MToon 1.0. outline_mode: "none", "world" (width in
    metres) or "screen" (width as a share of half the picture's height). alpha: "opaque", "mask" or "blend".
    """

    name: str
    kind: str
    lit: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    lit_texture: ToonTexture | None = None
    shade: Colour = (1.0, 1.0, 1.0)
    shade_texture: ToonTexture | None = None
    emissive: Colour = (0.0, 0.0, 0.0)
    emissive_texture: ToonTexture | None = None
    shift: float = 0.0
    toony: float = 0.9
    rim: Colour = (0.0, 0.0, 0.0)
    rim_power: float = 5.0
    rim_lift: float = 0.0
    outline_mode: str = "none"
    outline_width: float = 0.0
    outline_texture: ToonTexture | None = None
    outline: Colour = (0.0, 0.0, 0.0)
    outline_lit: float = 1.0
    alpha: str = "opaque"
    cutoff: float = 0.5
    writes_depth: bool = True
    queue: int = 0
    double_sided: bool = False
    notes: tuple[str, ...] = ()


def toon_materials(file: GltfFile, report: Report) -> tuple[ToonMaterial, ...]:
    """All materials of a file that has been read. Raises BadInput (JSON pointer) for values out of all bounds."""
    made = []
    old = file.extensions.get("VRM", {}).get("materialProperties", [])
    for index, source in enumerate(file.json.get("materials", [])):
        material = _gltf(file, index, source, report)
        extension = source.get("extensions", {}).get("VRMC_materials_mtoon")
        if extension is not None:
            pointer = ("materials", index, "extensions", "VRMC_materials_mtoon")
            check(extension, MTOON, report, pointer)
            material = _mtoon1(file, material, extension, report)
        elif isinstance(old, list) and index < len(old):
            check(old[index], VRM0_MATERIAL, report, ("extensions", "VRM", "materialProperties", index))
            material = _vrm0(file, material, old[index])
        made.append(material)
    return tuple(made)


def _gltf(file: GltfFile, index: int, source: Mapping[str, Any], report: Report) -> ToonMaterial:
    pbr = source.get("pbrMetallicRoughness", {})
    r, g, b, a = (float(v) for v in pbr.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0)))
    unlit = "KHR_materials_unlit" in source.get("extensions", {})
    place = ("materials", index)
    notes = []
    if not unlit and "VRMC_materials_mtoon" not in source.get("extensions", {}):
        notes.append("PBR shown as toon")
        notes += [f"{name} left out" for name in ("normalTexture", "occlusionTexture") if name in source]
    texture = _texture(file, pbr.get("baseColorTexture"), report, (*place, "pbrMetallicRoughness", "baseColorTexture"))
    er, eg, eb = (float(v) for v in source.get("emissiveFactor", (0.0, 0.0, 0.0)))
    strength = source.get("extensions", {}).get("KHR_materials_emissive_strength", {})
    gain = strength.get("emissiveStrength", 1.0) if isinstance(strength, dict) else 1.0
    gain = float(gain) if isinstance(gain, int | float) and not isinstance(gain, bool) else 1.0
    # Toon shade of a surface that only has one colour: darker, a little toward blue, as under an open sky.
    return ToonMaterial(
        name=str(source.get("name", "")) or f"material_{index}",
        kind="unlit" if unlit else "pbr",
        lit=(r, g, b, a),
        lit_texture=texture,
        shade=(r, g, b) if unlit else (0.42 * r, 0.38 * g, 0.46 * b),
        shade_texture=texture,
        emissive=(er * gain, eg * gain, eb * gain),
        emissive_texture=_texture(file, source.get("emissiveTexture"), report, (*place, "emissiveTexture")),
        toony=0.0 if unlit else 0.9,
        outline_mode="none" if unlit else "world",
        outline_width=0.0 if unlit else _PBR_OUTLINE_M,
        outline=(0.25 * r, 0.16 * g, 0.20 * b),
        alpha=str(source.get("alphaMode", "OPAQUE")).lower(),
        cutoff=float(source.get("alphaCutoff", 0.5)),
        writes_depth=source.get("alphaMode") != "BLEND",
        double_sided=bool(source.get("doubleSided", False)),
        notes=tuple(notes),
    )


def _mtoon1(file: GltfFile, base: ToonMaterial, source: Mapping[str, Any], report: Report) -> ToonMaterial:
    where = ("extensions", "VRMC_materials_mtoon")
    shift_texture = source.get("shadingShiftTexture")
    left_out = [n for n in ("matcapTexture", "rimMultiplyTexture", "uvAnimationMaskTexture") if n in source]
    left_out += ["shadingShiftTexture"] if shift_texture else []
    mode = {"worldCoordinates": "world", "screenCoordinates": "screen"}.get(source.get("outlineWidthMode", ""), "none")
    # The specification's screen width is a share of the whole height.
    width = float(source.get("outlineWidthFactor", 0.0)) * (2.0 if mode == "screen" else 1.0)
    return replace(
        base,
        kind="mtoon",
        shade=_rgb(source.get("shadeColorFactor", (0.0, 0.0, 0.0))),
        shade_texture=_texture(file, source.get("shadeMultiplyTexture"), report, where),
        shift=float(source.get("shadingShiftFactor", 0.0)),
        toony=float(source.get("shadingToonyFactor", 0.9)),
        rim=_rgb(source.get("parametricRimColorFactor", (0.0, 0.0, 0.0))),
        rim_power=float(source.get("parametricRimFresnelPowerFactor", 5.0)),
        rim_lift=float(source.get("parametricRimLiftFactor", 0.0)),
        outline_mode=mode,
        outline_width=width,
        outline_texture=_texture(file, source.get("outlineWidthMultiplyTexture"), report, where),
        outline=_rgb(source.get("outlineColorFactor", (0.0, 0.0, 0.0))),
        outline_lit=float(source.get("outlineLightingMixFactor", 1.0)),
        writes_depth=base.alpha != "blend" or bool(source.get("transparentWithZWrite", False)),
        queue=int(source.get("renderQueueOffsetNumber", 0)),
        notes=tuple(f"{name} left out" for name in left_out),
    )


def _vrm0(file: GltfFile, base: ToonMaterial, source: Mapping[str, Any]) -> ToonMaterial:
    shader = source.get("shader", "")
    if shader.startswith("VRM/Unlit"):
        return replace(base, kind="unlit", shade=base.lit[:3], outline_mode="none", notes=())
    if shader != "VRM/MToon":
        return base
    floats, vectors = source.get("floatProperties", {}), source.get("vectorProperties", {})
    textures = source.get("textureProperties", {})

    def number(name: str, default: float) -> float:
        return float(floats.get(name, default))

    def colour(name: str, default: float) -> Colour:
        values = vectors.get(name, [])
        return linear_light(values[:3]) if len(values) >= 3 else (default, default, default)

    def texture(name: str) -> ToonTexture | None:
        at = textures.get(name, -1)
        made = _plain_texture(file, at) if at >= 0 else None
        # All textures of a 0.x material share the tiling of the main one, whose v runs upward.
        tiling = vectors.get("_MainTex", [0.0, 0.0, 1.0, 1.0])
        if made is None or len(tiling) != 4:
            return made
        ox, oy, sx, sy = (float(v) for v in tiling)
        return replace(made, offset=(ox, 1.0 - oy - sy), scale=(sx, sy))

    low, high = number("_ShadeShift", 0.0), number("_ShadeToony", 0.9)
    high = 1.0 + (low - 1.0) * high
    mode = {1: "world", 2: "screen"}.get(int(number("_OutlineWidthMode", 0)), "none")
    mixed = int(number("_OutlineColorMode", 0)) == 1
    blend = int(number("_BlendMode", 0))
    main = vectors.get("_Color", [])
    red, green, blue = colour("_Color", 1.0)
    left_out = [name for name in ("_SphereAdd", "_BumpMap", "_RimTexture") if textures.get(name, -1) >= 0]
    return replace(
        base,
        kind="mtoon",
        lit=(red, green, blue, float(main[3]) if len(main) == 4 else 1.0),
        lit_texture=texture("_MainTex"),
        shade=colour("_ShadeColor", 1.0),
        shade_texture=texture("_ShadeTexture"),
        emissive=_rgb(vectors["_EmissionColor"]) if len(vectors.get("_EmissionColor", [])) >= 3 else (0.0, 0.0, 0.0),
        emissive_texture=texture("_EmissionMap"),
        shift=min(max(-0.5 * (low + high), -1.0), 1.0),
        toony=min(max(0.5 * (2.0 - (high - low)), 0.0), 1.0),
        rim=colour("_RimColor", 0.0),
        rim_power=number("_RimFresnelPower", 1.0),
        rim_lift=number("_RimLift", 0.0),
        outline_mode=mode,
        outline_width=max(number("_OutlineWidth", 0.5), 0.0) * 0.01,
        outline_texture=texture("_OutlineWidthTexture"),
        outline=colour("_OutlineColor", 0.0),
        outline_lit=number("_OutlineLightingMix", 1.0) if mixed else 0.0,
        alpha=("opaque", "mask", "blend", "blend")[min(max(blend, 0), 3)],
        cutoff=number("_Cutoff", 0.5),
        writes_depth=blend != 2,
        queue=int(source.get("renderQueue", -1)),
        double_sided=int(number("_CullMode", 2)) == 0,
        notes=tuple(f"{name} left out" for name in left_out),
    )


def _texture(
    file: GltfFile, source: Mapping[str, Any] | None, report: Report, pointer: tuple[str | int, ...]
) -> ToonTexture | None:
    if source is None:
        return None
    made = _plain_texture(file, source["index"])
    if made is None:
        return None
    made = replace(made, texcoord=int(source.get("texCoord", 0)))
    transform = source.get("extensions", {}).get("KHR_texture_transform")
    if transform is None:
        return made
    check(transform, _TRANSFORM, report, (*pointer, "extensions", "KHR_texture_transform"))
    (ox, oy), (sx, sy) = transform.get("offset", (0.0, 0.0)), transform.get("scale", (1.0, 1.0))
    return replace(
        made,
        offset=(float(ox), float(oy)),
        scale=(float(sx), float(sy)),
        rotation_rad=float(transform.get("rotation", 0.0)),
        texcoord=int(transform.get("texCoord", made.texcoord)),
    )


def _plain_texture(file: GltfFile, index: int) -> ToonTexture | None:
    texture = file.json["textures"][index]
    if "source" not in texture:
        return None
    samplers = file.json.get("samplers", [])
    at = texture.get("sampler", -1)
    sampler = samplers[at] if isinstance(at, int) and 0 <= at < len(samplers) else {}
    wrap = tuple(sampler.get(key, 10497) != 33071 for key in ("wrapS", "wrapT"))
    return ToonTexture(texture["source"], wrap=(wrap[0], wrap[1]), nearest=sampler.get("magFilter") == 9728)


def _rgb(values: Any) -> Colour:
    r, g, b = (max(float(v), 0.0) for v in values[:3])
    return (r, g, b)
