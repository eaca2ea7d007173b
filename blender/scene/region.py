"""Regions of an edit as they are chosen in Blender: on the mesh, by images, or in words."""
from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import bpy
import numpy as np

from ..core.command import REGION_ATTRIBUTE
from ..core.errors import Item3dError
from .scratch import Scratch

# Kinds that become a vertex attribute of the exported mesh.
ON_THE_MESH = ("FACES", "GROUP", "PAINT")


@dataclass
class Region:
    """`kind`: ALL, FACES (selected ones), GROUP, PAINT (a colour attribute), IMAGE, MATERIAL, WORDS, COLOR or TEXT."""

    kind: str = "ALL"
    name: str = ""  # name of the group, attribute, image or material; or the words, the colour or the selector
    feather: float = 0.0
    materials: list[str] = field(default_factory=list)


def values(region: Region, owner: bpy.types.Object, mesh: bpy.types.Mesh) -> tuple[str, np.ndarray]:
    """Returns the domain and the weights (0 to 1) of a region on an object's own mesh. Outside, weights are 0."""
    if region.kind == "FACES":
        chosen = np.zeros(len(mesh.polygons), bool)
        mesh.polygons.foreach_get("select", chosen)
        return "FACE", chosen.astype(np.float32)
    weights = np.zeros(len(mesh.vertices), np.float32)
    if region.kind == "GROUP":
        group = owner.vertex_groups.get(region.name)
        for vertex in mesh.vertices if group else ():
            for element in vertex.groups:
                if element.group == group.index:
                    weights[vertex.index] = element.weight
        return "POINT", weights
    attribute = mesh.color_attributes.get(region.name)
    if attribute is None:
        return "POINT", weights
    colors = np.empty(4 * len(attribute.data), np.float32)
    attribute.data.foreach_get("color_srgb", colors)
    return attribute.domain, colors.reshape(-1, 4)[:, :3].mean(1).astype(np.float32)


def add_attribute(region: Region, owner: bpy.types.Object, mesh: bpy.types.Mesh) -> float:
    """Writes the region into a scratch copy of an object's mesh. Returns its largest weight."""
    domain, weights = values(region, owner, mesh)
    old = mesh.attributes.get(REGION_ATTRIBUTE)
    if old is not None:
        mesh.attributes.remove(old)
    attribute = mesh.attributes.new(REGION_ATTRIBUTE, "FLOAT", domain)
    attribute.data.foreach_set("value", np.clip(weights, 0, 1))
    return float(weights.max()) if len(weights) else 0.0


def selectors(region: Region, scratch: Scratch, folder: Path) -> list[str]:
    """Returns selectors for `item3d edit --region`. Writes a painted image into the job's folder."""
    if region.kind in ON_THE_MESH:
        return [f"attribute={REGION_ATTRIBUTE}"]
    if region.kind == "IMAGE":
        return [f"mask={_write_mask(region.name, scratch, folder)}"]
    if region.kind == "WORDS":
        return [f"words={region.name.strip()}"]
    if region.kind == "COLOR":
        return [f"named={region.name}"]
    if region.kind == "TEXT":
        return [region.name.strip()]
    return []


def check(region: Region) -> None:
    """Raises Item3dError if the region's name is missing."""
    what = {"GROUP": "a vertex group", "PAINT": "a colour attribute", "IMAGE": "an image", "WORDS": "the part in words",
            "COLOR": "a colour", "TEXT": "a selector", "MATERIAL": "a material"}
    if region.kind in what and not region.name.strip():
        raise Item3dError(f"Region: nothing chosen; give {what[region.kind]}, or edit everything")


def _write_mask(name: str, scratch: Scratch, folder: Path) -> Path:
    image = bpy.data.images.get(name)
    if image is None or not image.has_data and not image.pixels:
        raise Item3dError(f"{name}: the image is missing or empty; paint white on an image and choose it")
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    color = pixels.reshape(-1, image.channels)
    gray = color[:, : min(3, image.channels)].mean(1)
    if image.channels == 4:
        gray = gray * color[:, 3]
    mask = scratch.keep(bpy.data.images.new("item3d mask", width, height))
    mask.colorspace_settings.name = image.colorspace_settings.name
    rgba = np.ones((width * height, 4), np.float32)
    rgba[:, :3] = gray[:, None]
    mask.pixels.foreach_set(rgba.ravel())
    path = folder / "mask.png"
    mask.filepath_raw, mask.file_format = str(path), "PNG"
    mask.save()
    return path
