"""Node trees of edited materials: Principled BSDF, the separated ORM texture, and the normal map."""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy

from ..core.glb import Glb, TextureUse
from .trees import OCCLUSION_GROUP, blender_transform, linear, occlusion_group, principled_of

COLUMN = 300
# glTF extensions that an edit may remove from a material, and the inputs of Principled BSDF to reset then.
RESET = {
    "KHR_materials_transmission": {"Transmission Weight": 0.0},
    "KHR_materials_sheen": {"Sheen Weight": 0.0},
    "KHR_materials_clearcoat": {"Coat Weight": 0.0},
}


class MaterialBuilder:
    """Makes an edited material from a source. It keeps the source's nodes for everything that was not edited.

    `picture` returns the image for an index of glTF's images. `uvs` has the names of the UV maps in glTF's order.
    """

    def __init__(
        self, source: bpy.types.Material | None, name: str, picture: Callable[[int, bool], bpy.types.Image], uvs: list[str]
    ):
        self._picture, self._uvs = picture, uvs
        if principled_of(source) is not None:
            self.material = source.copy()
            self.material.name = name
        else:
            self.material = bpy.data.materials.new(name)
            if self.material.node_tree is None:
                self.material.use_nodes = True
            if source is not None:
                self.material.use_backface_culling = source.use_backface_culling
        self._fresh = principled_of(source) is None
        self._tree = self.material.node_tree
        self._node = principled_of(self.material)
        self._uv_nodes: dict[str, bpy.types.Node] = {}
        self._separated: dict[int, bpy.types.Node] = {}

    def build(self, before: dict[str, Any], after: dict[str, Any], glb: Glb) -> bpy.types.Material:
        """Builds the material. `before` and `after` are the glTF material as it was exported and after the edit."""
        reached = self._reachable()
        pbr = after.get("pbrMetallicRoughness", {})
        self._color(glb.texture(pbr.get("baseColorTexture")), pbr.get("baseColorFactor", [1, 1, 1, 1]), after)
        self._orm(glb.texture(pbr.get("metallicRoughnessTexture")), pbr)
        occlusion = glb.texture(after.get("occlusionTexture"))
        if occlusion is not None:
            self._occlusion(occlusion)
        normal = glb.texture(after.get("normalTexture"))
        if normal is not None and (self._fresh or not self._node.inputs["Normal"].is_linked):
            self._normal(normal)
        self._follow(before, after)
        # Remove nodes that fed only what was replaced.
        for node in reached - self._reachable():
            self._tree.nodes.remove(node)
        return self.material

    def _color(self, use: TextureUse | None, factor: list[float], after: dict[str, Any]) -> None:
        socket = self._unlinked("Base Color")
        if use is None:
            socket.default_value = factor
            return
        plain = self._plain(use, True)
        if plain is not None:
            socket.default_value = [a * b for a, b in zip(plain, factor)]
            return
        texture = self._texture(use, True, 0)
        color = texture.outputs["Color"]
        if any(abs(value - 1) > 1e-4 for value in factor[:3]):
            mix = self._add("ShaderNodeMix", 1, 0)
            mix.data_type, mix.blend_type = "RGBA", "MULTIPLY"
            mix.inputs[0].default_value = 1
            mix.inputs[7].default_value = factor
            self._tree.links.new(color, mix.inputs[6])
            color = mix.outputs[2]
        self._tree.links.new(color, socket)
        if after.get("alphaMode", "OPAQUE") != "OPAQUE" and self._node.inputs["Alpha"].is_linked:
            self._tree.links.new(texture.outputs["Alpha"], self._unlinked("Alpha"))

    def _orm(self, use: TextureUse | None, pbr: dict[str, Any]) -> None:
        roughness, metallic = self._unlinked("Roughness"), self._unlinked("Metallic")
        roughness.default_value = pbr.get("roughnessFactor", 1.0)
        metallic.default_value = pbr.get("metallicFactor", 1.0)
        if use is None:
            return
        plain = self._plain(use, False)
        if plain is not None:
            roughness.default_value *= plain[1]
            metallic.default_value *= plain[2]
            return
        separate = self._separate(use, -320)
        self._scaled(separate.outputs["Green"], pbr.get("roughnessFactor", 1.0), roughness, -340)
        self._scaled(separate.outputs["Blue"], pbr.get("metallicFactor", 1.0), metallic, -500)

    def _separate(self, use: TextureUse, y: float) -> bpy.types.Node:
        """Returns the node that separates an image's channels. All uses of the image share it."""
        if use.image not in self._separated:
            texture = self._texture(use, False, y)
            separate = self._add("ShaderNodeSeparateColor", 1.2, y)
            separate.label = "Occlusion, Roughness, Metallic"
            self._tree.links.new(texture.outputs["Color"], separate.inputs[0])
            self._separated[use.image] = separate
        return self._separated[use.image]

    def _scaled(self, output: bpy.types.NodeSocket, factor: float, socket: bpy.types.NodeSocket, y: float) -> None:
        if abs(factor - 1) > 1e-4:
            multiply = self._add("ShaderNodeMath", 0.6, y)
            multiply.operation = "MULTIPLY"
            multiply.inputs[1].default_value = factor
            self._tree.links.new(output, multiply.inputs[0])
            output = multiply.outputs[0]
        self._tree.links.new(output, socket)

    def _occlusion(self, use: TextureUse) -> None:
        """Puts occlusion into the group that glTF exports read, because Principled BSDF has no input for it."""
        groups = [node for node in self._tree.nodes if node.type == "GROUP" and node.node_tree is not None]
        group = next((node for node in groups if node.node_tree.name.startswith(OCCLUSION_GROUP)), None)
        if group is None:
            group = self._add("ShaderNodeGroup", 0, 300)
            group.node_tree = occlusion_group()
        socket = group.inputs.get("Occlusion")
        if socket is None:
            return
        plain = self._plain(use, False)
        if plain is None:
            self._tree.links.new(self._separate(use, -480).outputs["Red"], socket)
        else:
            for link in list(socket.links):
                self._tree.links.remove(link)
            socket.default_value = plain[0]

    def _normal(self, use: TextureUse) -> None:
        texture = self._texture(use, False, -640)
        normal_map = self._add("ShaderNodeNormalMap", 1, -640)
        normal_map.inputs["Strength"].default_value = use.strength
        if use.uv < len(self._uvs):
            normal_map.uv_map = self._uvs[use.uv]
        self._tree.links.new(texture.outputs["Color"], normal_map.inputs["Color"])
        self._tree.links.new(normal_map.outputs["Normal"], self._node.inputs["Normal"])

    def _follow(self, before: dict[str, Any], after: dict[str, Any]) -> None:
        """Removes here what the edit removed from the material, because it would show the old look."""
        gone = set(before.get("extensions", {})) - set(after.get("extensions", {}))
        for extension in gone & set(RESET):
            for name, value in RESET[extension].items():
                if name in self._node.inputs:
                    self._unlinked(name).default_value = value
        glowed = any(before.get("emissiveFactor", [0, 0, 0]))
        if (glowed and not any(after.get("emissiveFactor", [0, 0, 0]))) or "KHR_materials_unlit" in gone:
            self._unlinked("Emission Strength").default_value = 0.0

    def _plain(self, use: TextureUse, is_color: bool) -> list[float] | None:
        """Returns the linear value of an image of one pixel, which needs no node, or None for a larger image."""
        image = self._picture(use.image, is_color)
        if tuple(image.size) != (1, 1):
            return None
        values = (list(image.pixels) * 4)[:4] if image.channels == 1 else list(image.pixels)[:4]
        values += [1.0] * (4 - len(values))
        return [linear(value) if is_color and at < 3 else value for at, value in enumerate(values)]

    def _texture(self, use: TextureUse, is_color: bool, y: float) -> bpy.types.Node:
        node = self._add("ShaderNodeTexImage", 2.2, y)
        node.image = self._picture(use.image, is_color)
        if use.uv >= len(self._uvs):
            return node
        vector = self._uv_node(self._uvs[use.uv]).outputs["UV"]
        if use.is_transformed:
            mapping = self._add("ShaderNodeMapping", 3.2, y)
            location, rotation, scale = blender_transform(use)
            mapping.inputs["Location"].default_value = (*location, 0)
            mapping.inputs["Rotation"].default_value = (0, 0, rotation)
            mapping.inputs["Scale"].default_value = (*scale, 1)
            self._tree.links.new(vector, mapping.inputs["Vector"])
            vector = mapping.outputs["Vector"]
        self._tree.links.new(vector, node.inputs["Vector"])
        return node

    def _uv_node(self, name: str) -> bpy.types.Node:
        if name not in self._uv_nodes:
            node = self._add("ShaderNodeUVMap", 4.2, -200 * len(self._uv_nodes))
            node.uv_map = name
            self._uv_nodes[name] = node
        return self._uv_nodes[name]

    def _add(self, kind: str, columns: float, y: float) -> bpy.types.Node:
        node = self._tree.nodes.new(kind)
        node.location = (self._node.location.x - COLUMN * columns, self._node.location.y + y)
        return node

    def _unlinked(self, name: str) -> bpy.types.NodeSocket:
        socket = self._node.inputs[name]
        for link in list(socket.links):
            self._tree.links.remove(link)
        return socket

    def _reachable(self) -> set[bpy.types.Node]:
        """Returns the nodes that feed an output or a group without outputs."""
        waiting = [n for n in self._tree.nodes if n.type.startswith("OUTPUT") or n.type == "GROUP" and not n.outputs]
        found = set(waiting)
        while waiting:
            for socket in waiting.pop().inputs:
                for link in socket.links:
                    if link.from_node not in found:
                        found.add(link.from_node)
                        waiting.append(link.from_node)
        return found
