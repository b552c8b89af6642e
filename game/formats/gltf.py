"""Reading glTF 2.0 (.gltf, .glb and the VRM family that builds on it).

A hardened reader of our own: everything later code relies on is checked at load (indices, extents, tree shape,
attribute formats, joint indices), and refused with byte offset or JSON pointer; harmless faults are `findings`.
Compressed meshes (Draco, meshopt) are refused by name.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from game.core.errors import BadInput
from game.formats.gltf_animation import build_animations
from game.formats.gltf_buffers import Buffers
from game.formats.gltf_container import Container, read_container, resolve_uri
from game.formats.gltf_mesh import build_meshes
from game.formats.gltf_model import GltfFile, GltfImage, GltfMaterial
from game.formats.gltf_node import build_nodes, build_skins, check_scenes
from game.formats.gltf_shape import GLTF, LISTS
from game.formats.json_shape import Anything, Items, Report, check

__all__ = ["read_gltf"]

_MAX_ITEMS = 50_000

# Understood, or changing only looks that this project does not draw.
_KNOWN_EXTENSIONS = (
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_materials_",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
    "EXT_texture_webp",
    "VRM",
)


def read_gltf(path: Path | str, *, max_bytes: int = 256_000_000) -> GltfFile:
    """Read and check a glTF file of any flavour. Raises BadInput (byte offset or JSON pointer)."""
    path = Path(path)
    container = read_container(path, max_bytes=max_bytes)
    document = container.document
    report = Report(path)
    for name in LISTS:
        # First of all, since every index is held against the length of its list.
        check(document.get(name, []), Items(Anything(), empty_ok=True), report, (name,))
        if len(document.get(name, [])) > _MAX_ITEMS:
            report.refuse((name,), expected=f"at most {_MAX_ITEMS} items", seen=len(document[name]))
    report.lengths = {name: len(document.get(name, [])) for name in LISTS}
    check(document, GLTF, report)
    _check_version(document, report)
    _check_extensions(document, report)
    buffers = Buffers(container, report, max_bytes=max_bytes)
    buffers.decode_all()
    nodes = build_nodes(document, report)
    check_scenes(document, nodes, report)
    meshes = build_meshes(document, buffers, report)
    return GltfFile(
        path=path,
        json=document,
        nodes=nodes,
        meshes=meshes,
        skins=build_skins(document, nodes, meshes, buffers, report),
        animations=build_animations(document, nodes, meshes, buffers, report),
        materials=tuple(_material(material) for material in document.get("materials", [])),
        images=_images(container, buffers, report, max_bytes),
        findings=report.findings,
        buffers=buffers,
    )


def _material(material: Mapping[str, Any]) -> GltfMaterial:
    pbr = material.get("pbrMetallicRoughness", {})
    return GltfMaterial(
        material.get("name", ""),
        tuple(pbr.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0))),
        material.get("alphaMode", "OPAQUE"),
        material.get("doubleSided", False),
        material.get("extras"),
        material.get("extensions", {}),
    )


def _check_version(document: Mapping[str, Any], report: Report) -> None:
    versions = []
    for key in ("version", "minVersion"):
        text = document["asset"].get(key, "2.0")
        major, dot, minor = text.partition(".")
        if not (dot and major.isdecimal() and minor.isdecimal() and len(text) < 12):
            report.refuse(("asset", key), expected="a version such as 2.0", seen=text)
        versions.append((int(major), int(minor)))
    version, least = versions
    if version[0] != 2:
        report.refuse(("asset", "version"), expected="glTF 2", seen=document["asset"]["version"])
    if least > version or least > (2, 0):
        report.refuse(("asset", "minVersion"), expected="at most 2.0", seen=document["asset"]["minVersion"])


def _check_extensions(document: Mapping[str, Any], report: Report) -> None:
    used = document.get("extensionsUsed", [])
    undeclared = _extension_names(document) - set(used)
    for name in sorted(undeclared):
        report.note((), f"the extension {name[:60]!r} is used but not declared in extensionsUsed")
    for index, name in enumerate(document.get("extensionsRequired", [])):
        if name not in used:
            report.refuse(("extensionsRequired", index), f"{name[:60]!r} is not among extensionsUsed")
        if not name.startswith(_KNOWN_EXTENSIONS):
            hint = "save it without mesh compression" if "compression" in name else None
            report.refuse(
                ("extensionsRequired", index), f"the file needs {name[:60]}, which is not supported", hint=hint
            )


def _extension_names(document: Mapping[str, Any]) -> set[str]:
    """Names of all extension objects of the document (extras are nobody's business)."""
    names: set[str] = set()
    stack: list[Any] = [document]
    while stack:
        value = stack.pop()
        if isinstance(value, dict):
            extensions = value.get("extensions")
            names.update(extensions if isinstance(extensions, dict) else ())
            stack.extend(inner for key, inner in value.items() if key not in ("extras", "extensions"))
        elif isinstance(value, list):
            stack.extend(value)
    return names


def _images(container: Container, buffers: Buffers, report: Report, max_bytes: int) -> tuple[GltfImage | None, ...]:
    images: list[GltfImage | None] = []
    budget = max_bytes
    for index, image in enumerate(container.document.get("images", [])):
        data = b""
        if "uri" in image:
            where = report.where("images", index, "uri")
            try:
                data = resolve_uri(container.path, image["uri"], where, max_bytes=max(budget, 0), what="image")
            except BadInput as error:
                if "cannot read" not in str(error):
                    raise
                report.note(("images", index, "uri"), "the image file is missing")
        elif "bufferView" in image:
            data = buffers.view_bytes(image["bufferView"])
        else:
            report.note(("images", index), "an image without uri and bufferView")
        budget -= len(data)
        if budget < 0:
            report.refuse(("images", index), f"more than {max_bytes} bytes of images")
        if "uri" in image and "bufferView" in image:
            report.note(("images", index), "an image with both uri and bufferView")
        images.append(GltfImage(image.get("name", ""), image.get("mimeType", ""), data) if data else None)
    return tuple(images)
