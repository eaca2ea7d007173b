"""Queries of materials' node trees, and small parts of node trees."""
from __future__ import annotations

import math
from typing import Any

import bpy

from ..core.glb import TextureUse

OCCLUSION_GROUP = "glTF Material Output"  # the name that Blender's glTF exporter looks for


def principled_of(material: bpy.types.Material | None) -> bpy.types.Node | None:
    """Returns the Principled BSDF that a material's output shows, or None if it shows anything else."""
    if material is None or material.node_tree is None:
        return None
    output = material.node_tree.get_output_node("ALL") or material.node_tree.get_output_node("CYCLES")
    if output is None or not output.inputs["Surface"].is_linked:
        return None
    node = output.inputs["Surface"].links[0].from_node
    return node if node.type == "BSDF_PRINCIPLED" else None


def has_images(material: bpy.types.Material | None) -> bool:
    """Returns true if a material's nodes, including those in groups, use an image."""
    tree = material.node_tree if material else None
    waiting, seen = [tree] if tree else [], set()
    while waiting:
        tree = waiting.pop()
        if tree.name_full in seen:
            continue
        seen.add(tree.name_full)
        for node in tree.nodes:
            if node.type == "TEX_IMAGE" and node.image is not None:
                return True
            if node.type == "GROUP" and node.node_tree is not None:
                waiting.append(node.node_tree)
    return False


def is_procedural(material: bpy.types.Material | None, exported: dict[str, Any]) -> bool:
    """Returns true if the base colour comes from nodes that the export could not write."""
    node = principled_of(material)
    if material is None or node is None:
        return material is not None and material.node_tree is not None and len(material.node_tree.nodes) > 2
    textured = "baseColorTexture" in exported.get("pbrMetallicRoughness", {})
    return bool(node.inputs["Base Color"].is_linked and not textured)


def linear(value: float) -> float:
    """Decodes an sRGB value."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def blender_transform(use: TextureUse) -> tuple[tuple[float, float], float, tuple[float, float]]:
    """Returns location, rotation and scale of a Mapping node (V up) for KHR_texture_transform (V down)."""
    sine, cosine = math.sin(use.rotation), math.cos(use.rotation)
    location = (use.offset[0] + use.scale[1] * sine, 1 - use.offset[1] - use.scale[1] * cosine)
    return location, use.rotation, use.scale


def occlusion_group() -> bpy.types.NodeTree:
    group = bpy.data.node_groups.get(OCCLUSION_GROUP)
    if group is None:
        group = bpy.data.node_groups.new(OCCLUSION_GROUP, "ShaderNodeTree")
        group.interface.new_socket("Occlusion", in_out="INPUT", socket_type="NodeSocketFloat")
        group.nodes.new("NodeGroupInput")
    return group
