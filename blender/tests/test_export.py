"""Tests of exports: evaluated meshes, UV maps, materials, regions, and nothing else."""
from __future__ import annotations

import json
from typing import Any

import bpy
import numpy as np

from .support import BlenderTest, cube, monkey, painted, textured
from item3d_blender.core.glb import Glb
from item3d_blender.scene import unwrap
from item3d_blender.scene.export import export
from item3d_blender.scene.region import Region
from item3d_blender.scene.scratch import Scratch


class Export(BlenderTest):
    def out(self, *things: bpy.types.Object, region: Region | None = None) -> tuple[dict[str, Any], Glb]:
        before = self.blocks()
        bpy.context.view_layer.update()
        with Scratch(bpy.context) as scratch:
            record = export(scratch, list(things), region or Region(), self.folder)
        self.assertEqual(self.blocks(), before, "an export leaves data blocks")
        self.assertEqual(bpy.context.scene.name, "Scene")
        json.dumps(record)
        return record, Glb(self.folder / record["model"])

    def blocks(self) -> dict[str, int]:
        names = ("meshes", "objects", "scenes", "materials", "images", "collections", "curves")
        return {name: len(getattr(bpy.data, name)) for name in names}

    def accessor(self, glb: Glb, index: int) -> np.ndarray:
        accessor = glb.json["accessors"][index]
        view = glb.json["bufferViews"][accessor["bufferView"]]
        kinds = {5126: np.float32, 5123: np.uint16, 5125: np.uint32}
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        count = accessor["count"] * width
        return np.frombuffer(glb.blob, kinds[accessor["componentType"]], count, start).reshape(-1, width)

    def primitives(self, glb: Glb) -> list[dict[str, Any]]:
        return [primitive for mesh in glb.json["meshes"] for primitive in mesh["primitives"]]

    def test_only_the_chosen_object_goes_out(self) -> None:
        monkey(location=(3, 0, 0))
        record, glb = self.out(cube())
        self.assertEqual(len(glb.json["nodes"]), 1)
        self.assertEqual([o["name"] for o in record["objects"]], ["Cube"])
        self.assertIsNone(record["objects"][0]["uv"], "the cube's own UV map serves")

    def test_modifiers_are_evaluated_and_a_missing_uv_map_goes_through_them(self) -> None:
        thing = monkey()
        thing.modifiers.new("s", "SUBSURF")
        thing.modifiers.new("m", "MIRROR")
        record, glb = self.out(thing)
        self.assertEqual(self.accessor(glb, self.primitives(glb)[0]["indices"]).size, 2 * 6 * 1968)
        self.assertTrue(record["objects"][0]["back"])
        self.assertEqual(record["objects"][0]["uv"]["name"], "item3d")
        self.assertEqual(len(thing.data.uv_layers), 0, "the object is as it was")
        values = np.load(self.folder / record["objects"][0]["uv"]["file"])
        self.assertEqual(values.shape, (len(thing.data.loops), 2))
        self.assertTrue((values >= 0).all() and (values <= 1).all())
        self.assertGreater(values.std(), 0.1)

    def test_z_is_up_here_and_y_there_with_any_transform(self) -> None:
        thing = cube()
        thing.location, thing.scale, thing.rotation_euler = (1, 2, 3), (1, 2, 0.5), (0.3, 0.2, 0.1)
        _, glb = self.out(thing)
        node = glb.json["nodes"][0]
        np.testing.assert_allclose(node["translation"], (1, 3, -2), atol=1e-5)
        np.testing.assert_allclose(node["scale"], (1, 0.5, 2), atol=1e-5)

    def test_a_sheared_object_keeps_its_corners(self) -> None:
        parent = bpy.data.objects.new("P", None)
        bpy.context.scene.collection.objects.link(parent)
        parent.scale = (1, 3, 1)
        thing = cube()
        thing.parent, thing.rotation_euler = parent, (0, 0, 0.7)
        bpy.context.view_layer.update()
        wanted = np.array([thing.matrix_world @ vertex.co for vertex in thing.data.vertices])
        _, glb = self.out(thing)
        found = self.accessor(glb, self.primitives(glb)[0]["attributes"]["POSITION"])
        for x, y, z in wanted:
            self.assertLess(np.abs(found - (x, z, -y)).max(1).min(), 1e-4)

    def test_objects_that_share_a_plain_material_get_one_each(self) -> None:
        thing = monkey(location=(3, 0, 0))
        thing.data.materials.append(bpy.data.materials["Material"])
        record, _ = self.out(cube(), thing)
        self.assertEqual([m["name"] for m in record["materials"]], ["Material Cube", "Material Suzanne"])
        self.assertEqual([m["source"] for m in record["materials"]], ["Material"] * 2)
        self.assertEqual([m["slots"] for m in record["materials"]], [[["Cube", 0]], [["Suzanne", 0]]])

    def test_objects_that_share_a_picture_share_its_material(self) -> None:
        material = textured("Painted", painted("p"))
        other = cube().copy()
        bpy.context.scene.collection.objects.link(other)
        cube().data.materials[0] = material
        record, glb = self.out(cube(), other)
        self.assertEqual([m["slots"] for m in record["materials"]], [[["Cube", 0], ["Cube.001", 0]]])
        self.assertEqual(len(glb.json["images"]), 1, "a packed picture goes along")

    def test_instances_of_a_collection_are_one_mesh(self) -> None:
        collection = bpy.data.collections.new("C")
        thing = monkey()
        bpy.context.scene.collection.objects.unlink(thing) if thing.name in bpy.context.scene.collection.objects else None
        collection.objects.link(thing)
        empties = []
        for x in range(3):
            empty = bpy.data.objects.new("E", None)
            empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", collection, (3 * x, 0, 0)
            bpy.context.scene.collection.objects.link(empty)
            empties.append(empty)
        record, glb = self.out(*empties)
        self.assertEqual((len(glb.json["meshes"]), len(glb.json["nodes"])), (1, 3))
        self.assertEqual(record["materials"][0]["slots"], [["Suzanne", 0]])

    def test_a_text_goes_out_and_comes_back_as_an_object(self) -> None:
        bpy.ops.object.text_add()
        bpy.context.object.data.extrude = 0.1
        record, glb = self.out(bpy.context.object)
        self.assertFalse(record["objects"][0]["back"])
        self.assertIn("TEXCOORD_0", self.primitives(glb)[0]["attributes"])
        self.assertIn("a separate object", record["notes"][0])

    def test_a_second_uv_map_is_told_from_the_first(self) -> None:
        thing = cube()
        second = thing.data.uv_layers.new(name="Second")
        values = unwrap.uv_of(thing.data, 0) * 0.5
        second.uv.foreach_set("vector", values.ravel())
        material = textured("Painted", painted("p"))
        node = material.node_tree.nodes.new("ShaderNodeUVMap")
        node.uv_map = "Second"
        texture = next(n for n in material.node_tree.nodes if n.type == "TEX_IMAGE")
        material.node_tree.links.new(node.outputs["UV"], texture.inputs["Vector"])
        thing.data.materials[0] = material
        record, glb = self.out(thing)
        use = glb.texture(glb.materials()[0]["pbrMetallicRoughness"]["baseColorTexture"])
        self.assertEqual(record["materials"][0]["uvs"][use.uv], "Second")
        found = self.accessor(glb, self.primitives(glb)[0]["attributes"][f"TEXCOORD_{use.uv}"])
        self.assertLess(found[:, 0].max(), 0.51)

    def test_says_that_a_procedural_colour_stays_behind(self) -> None:
        tree = bpy.data.materials["Material"].node_tree
        noise = tree.nodes.new("ShaderNodeTexNoise")
        tree.links.new(noise.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
        record, _ = self.out(cube())
        self.assertIn("bake them", record["notes"][0])

    def test_regions_are_an_attribute(self) -> None:
        thing = cube()
        for polygon in thing.data.polygons:
            polygon.select = polygon.index < 2
        thing.modifiers.new("s", "SUBSURF").subdivision_type = "SIMPLE"
        _, glb = self.out(thing, region=Region("FACES"))
        found = self.accessor(glb, self.primitives(glb)[0]["attributes"]["_ITEM3D_REGION"])
        self.assertEqual(set(np.unique(found)), {0.0, 1.0})
        self.assertAlmostEqual(float(found.mean()), 1 / 3, places=2)
        group = thing.vertex_groups.new(name="Top")
        group.add([0, 1], 0.5, "REPLACE")
        thing.modifiers.clear()
        _, glb = self.out(thing, region=Region("GROUP", "Top"))
        found = self.accessor(glb, self.primitives(glb)[0]["attributes"]["_ITEM3D_REGION"])
        self.assertAlmostEqual(float(found.max()), 0.5)
        self.assertNotIn("_ITEM3D_REGION", thing.data.attributes)

    def test_a_painted_attribute_is_read_as_it_looks(self) -> None:
        attribute = cube().data.color_attributes.new("Mask", "BYTE_COLOR", "CORNER")
        for index, value in enumerate(attribute.data):
            value.color_srgb = (1, 1, 1, 1) if index < 4 else (0, 0, 0, 1)
        _, glb = self.out(cube(), region=Region("PAINT", "Mask"))
        found = self.accessor(glb, self.primitives(glb)[0]["attributes"]["_ITEM3D_REGION"])
        self.assertAlmostEqual(float(found.mean()), 1 / 6, places=3)

    def test_overlap(self) -> None:
        mesh = cube().data
        self.assertFalse(unwrap.overlaps(mesh))
        layer = mesh.uv_layers[0]
        for polygon in mesh.polygons:
            for corner, loop in enumerate(polygon.loop_indices):
                layer.uv[loop].vector = [(0, 0), (1, 0), (1, 1), (0, 1)][corner]
        self.assertTrue(unwrap.overlaps(mesh))
        for loop in range(len(mesh.loops)):
            layer.uv[loop].vector = [value * 0.2 for value in layer.uv[loop].vector]
        self.assertTrue(unwrap.overlaps(mesh), "faces on one another, wherever they lie")
        record, _ = self.out(cube())
        self.assertEqual(record["objects"][0]["uv"]["name"], "item3d")
        self.assertEqual(record["materials"][0]["uvs"], ["item3d"])
