"""Tests of applied results: materials, nodes, UV maps, properties, and restoring the source."""
from __future__ import annotations

import json

import bpy
import numpy as np

from .fake_item3d import GOLD
from .support import MUG, BlenderTest, cube, monkey, painted, shown, textured
from item3d_blender.core.glb import Glb, TextureUse
from item3d_blender.scene import slots
from item3d_blender.scene.nodes import MaterialBuilder
from item3d_blender.scene.trees import blender_transform, principled_of


def rgba(socket: bpy.types.NodeSocket) -> list[float]:
    return [round(value, 3) for value in socket.default_value]


class Apply(BlenderTest):
    def test_a_new_material_and_the_source_kept(self) -> None:
        source = shown(cube())
        job = self.edit([cube()])
        material = shown(cube())
        node = principled_of(material)
        self.assertEqual(material.name, "Material - a golden cube")
        self.assertEqual(rgba(node.inputs["Base Color"]), GOLD)
        self.assertAlmostEqual(node.inputs["Roughness"].default_value, 0.2, places=5)
        self.assertEqual(material[slots.SOURCE], source)
        self.assertTrue(source.use_fake_user)
        self.assertAlmostEqual(principled_of(source).inputs["Base Color"].default_value[0], 0.8, places=5)
        self.assertEqual(material["item3d"]["to"], "a golden cube")
        self.assertEqual(material["item3d"]["seed"], str(2**40))
        self.assertIn("region", json.loads(material["item3d"]["settings"]))
        self.assertFalse((job.folder / "out/checkpoint.safetensors").exists())

    def test_one_step_to_undo_and_to_redo(self) -> None:
        self.edit([cube()])
        bpy.ops.ed.undo()
        self.assertEqual(shown(cube()).name, "Material")
        self.assertEqual([m.name for m in bpy.data.materials if "golden" in m.name], [])
        bpy.ops.ed.redo()
        self.assertEqual(shown(cube()).name, "Material - a golden cube")

    def test_the_source_is_shown_again(self) -> None:
        self.edit([cube()])
        self.select(cube())
        bpy.ops.item3d.restore()
        self.assertEqual(shown(cube()).name, "Material")
        self.fails("show no edited material", bpy.ops.item3d.restore)

    def test_what_was_not_edited_stays(self) -> None:
        material = textured("Painted", painted("p"))
        tree = material.node_tree
        node = tree.nodes["Principled BSDF"]
        node.inputs["Coat Weight"].default_value = 0.7
        bump = tree.nodes.new("ShaderNodeBump")
        noise = tree.nodes.new("ShaderNodeTexNoise")
        tree.links.new(noise.outputs[0], bump.inputs["Height"])
        tree.links.new(bump.outputs["Normal"], node.inputs["Normal"])
        cube().data.materials[0] = material
        self.edit([cube()])
        edited = shown(cube())
        kinds = [n.type for n in edited.node_tree.nodes]
        self.assertIn("BUMP", kinds)
        self.assertIn("TEX_NOISE", kinds)
        self.assertNotIn("TEX_IMAGE", kinds, "nodes that fed what was replaced are gone")
        self.assertAlmostEqual(principled_of(edited).inputs["Coat Weight"].default_value, 0.7, places=5)

    def test_an_object_without_uv_map_and_material(self) -> None:
        thing = monkey()
        thing.modifiers.new("s", "SUBSURF")
        self.edit([thing], "a monkey", "a golden monkey")
        self.assertEqual([layer.name for layer in thing.data.uv_layers], ["item3d"])
        self.assertEqual(len(thing.material_slots), 1)
        self.select(thing)
        bpy.ops.item3d.restore()
        self.assertEqual(len(thing.material_slots), 0)

    def test_of_linked_duplicates_only_the_chosen_changes(self) -> None:
        other = cube().copy()
        bpy.context.scene.collection.objects.link(other)
        self.edit([cube()])
        self.assertEqual(shown(cube()).name, "Material - a golden cube")
        self.assertEqual(shown(other).name, "Material")
        self.select(cube())
        bpy.ops.item3d.restore()
        self.assertEqual((shown(cube()).name, cube().material_slots[0].link), ("Material", "DATA"))

    def test_one_material_of_several(self) -> None:
        thing = cube()
        thing.data.materials.append(bpy.data.materials.new("Second"))
        thing.data.polygons[0].material_index = 1
        self.settings.region, self.settings.material = "MATERIAL", "Second"
        self.edit([thing])
        self.assertEqual([slot.material.name for slot in thing.material_slots], ["Material", "Second - a golden cube"])

    def test_several_objects_at_once(self) -> None:
        thing = monkey(location=(3, 0, 0))
        thing.data.materials.append(bpy.data.materials["Material"])
        self.edit([cube(), thing])
        self.assertEqual(shown(cube()).name, "Material Cube - a golden cube")
        self.assertEqual(shown(thing).name, "Material Suzanne - a golden cube")
        self.assertEqual(shown(thing)[slots.SOURCE].name, "Material")

    def test_what_has_no_slots_comes_as_an_object(self) -> None:
        bpy.ops.object.text_add()
        text = bpy.context.object
        text.data.extrude = 0.1
        self.edit([text, cube()], "a text", "a golden text")
        made = bpy.data.objects["Text - a golden text"]
        self.assertEqual(rgba(principled_of(shown(made)).inputs["Base Color"]), GOLD)
        self.assertIn("item3d", shown(made))
        self.assertEqual([c.name for c in made.users_collection], ["item3d a golden text"])
        self.assertEqual(len(bpy.data.collections["item3d a golden text"].objects), 1, "the cube was no part of it")
        self.assertEqual(shown(cube()).name, "Material - a golden text")

    def test_edits_of_an_edit(self) -> None:
        self.edit([cube()])
        first = shown(cube())
        self.edit([cube()], "a golden cube", "a red cube")
        self.assertEqual(shown(cube())[slots.SOURCE], first) if shown(cube()) != first else None

    def test_nothing_is_applied_unasked(self) -> None:
        self.settings.apply_when_done = False
        job = self.begin([cube()])
        self.finish(job)
        self.assertEqual((job.state, shown(cube()).name), ("done", "Material"))
        bpy.ops.item3d.apply_result(folder=str(job.folder))
        self.assertEqual(shown(cube()).name, "Material - a golden cube")


class Nodes(BlenderTest):
    def test_pictures_become_an_orm_split(self) -> None:
        glb = Glb(MUG)
        image = painted("p")
        material = glb.materials()[0]
        made = MaterialBuilder(None, "Made", lambda *_: image, ["UVMap"]).build({}, material, glb)
        node = principled_of(made)
        fed = {name: node.inputs[name].links[0] for name in ("Base Color", "Roughness", "Metallic")}
        self.assertEqual(fed["Base Color"].from_node.type, "TEX_IMAGE")
        self.assertEqual((fed["Roughness"].from_socket.name, fed["Metallic"].from_socket.name), ("Green", "Blue"))
        self.assertEqual(fed["Roughness"].from_node, fed["Metallic"].from_node)
        group = next(n for n in made.node_tree.nodes if n.type == "GROUP")
        self.assertEqual(group.inputs["Occlusion"].links[0].from_socket.name, "Red")
        self.assertEqual({n.uv_map for n in made.node_tree.nodes if n.type == "UVMAP"}, {"UVMap"})
        places = [tuple(n.location) for n in made.node_tree.nodes]
        self.assertEqual(len(places), len(set(places)), "no node hides another")

    def test_a_normal_map(self) -> None:
        glb = Glb(MUG)
        image = painted("p")
        material = glb.materials()[0] | {"normalTexture": {"index": 0, "scale": 0.5}}
        made = MaterialBuilder(None, "Made", lambda *_: image, ["UVMap"]).build({}, material, glb)
        normal = principled_of(made).inputs["Normal"].links[0].from_node
        self.assertEqual((normal.type, normal.inputs["Strength"].default_value, normal.uv_map), ("NORMAL_MAP", 0.5, "UVMap"))

    def test_what_the_edit_took_out_goes_here_too(self) -> None:
        source = textured("Glass", painted("p"))
        node = principled_of(source)
        node.inputs["Transmission Weight"].default_value = 1
        node.inputs["Emission Strength"].default_value = 3
        before = {"extensions": {"KHR_materials_transmission": {}}, "emissiveFactor": [1, 1, 1]}
        made = MaterialBuilder(source, "Made", lambda *_: painted("q"), ["UVMap"]).build(before, {}, Glb(MUG))
        self.assertEqual(principled_of(made).inputs["Transmission Weight"].default_value, 0)
        self.assertEqual(principled_of(made).inputs["Emission Strength"].default_value, 0)
        self.assertEqual(node.inputs["Transmission Weight"].default_value, 1)

    def test_transforms_of_textures(self) -> None:
        use = TextureUse(0, 0, (0.1, 0.2), 0.5, (2.0, 3.0), 1.0)
        location, angle, scale = blender_transform(use)
        uv = np.array([0.3, 0.6])  # V up
        sine, cosine = np.sin(0.5), np.cos(0.5)
        down = np.array([uv[0], 1 - uv[1]]) * use.scale
        there = np.array([cosine * down[0] + sine * down[1], -sine * down[0] + cosine * down[1]]) + use.offset
        scaled = uv * scale
        here = np.array([np.cos(angle) * scaled[0] - np.sin(angle) * scaled[1],
                         np.sin(angle) * scaled[0] + np.cos(angle) * scaled[1]]) + location
        np.testing.assert_allclose(here, [there[0], 1 - there[1]], atol=1e-9)
