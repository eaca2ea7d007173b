"""Tests of whole edits by the real program with few iterations: they end, and the result looks as requested."""
from __future__ import annotations

import math
import unittest

import bpy
import numpy as np

from .support import MUG, PROGRAM, BlenderTest, cube, monkey, painted, shown, textured
from item3d_blender.core.job import Job
from item3d_blender.scene.trees import principled_of


@unittest.skipUnless(PROGRAM, "ITEM3D_PROGRAM names no program")
class Whole(BlenderTest):
    def setUp(self) -> None:
        super().setUp()
        self.use(PROGRAM)
        self.settings.more = "--image-size 64"
        self.settings.iterations = 25

    def values(self, material: bpy.types.Material, name: str) -> np.ndarray:
        """Returns the mean of the texture that feeds a socket of Principled BSDF, or the socket's value."""
        socket = principled_of(material).inputs[name]
        if not socket.is_linked:
            return np.atleast_1d(socket.default_value)
        node = socket.links[0].from_node
        channel = {"Red": 0, "Green": 1, "Blue": 2}.get(socket.links[0].from_socket.name)
        while node.type != "TEX_IMAGE":
            node = next(i for i in node.inputs if i.is_linked).links[0].from_node
        mean = np.array(node.image.pixels[:]).reshape(-1, node.image.channels).mean(0)
        return mean if channel is None else mean[[channel]]

    def check_golden(self, job: Job, thing: bpy.types.Object, source: str) -> None:
        material = shown(thing)
        self.assertIn("golden", material.name)
        self.assertEqual(material["item3d_source"].name if source else material.get("item3d_source"), source or None)
        self.assertGreater(self.values(material, "Metallic")[0], 0.5)
        color = self.values(material, "Base Color")
        self.assertGreater(color[0], color[2], "gold has more red than blue")
        self.assertEqual(material["item3d"]["prior_hash"], job.result()["claim"]["prior_hash"])
        bpy.ops.ed.undo()
        undone = bpy.data.objects[thing.name] if False else bpy.data.objects[job.record["objects"][0]["name"]]
        self.assertEqual(shown(undone).name if shown(undone) else "", source)

    def test_the_default_cube(self) -> None:
        job = self.edit([cube()], "a gray cube", "a golden cube")
        self.check_golden(job, cube(), "Material")

    def test_suzanne_without_uv_map(self) -> None:
        thing = monkey()
        thing.modifiers.new("s", "SUBSURF")
        bpy.ops.ed.undo_push(message="made")
        job = self.edit([thing], "a gray object", "a golden object")
        self.assertEqual(shown(thing).get("item3d", {}).get("to"), "a golden object")
        self.check_golden(job, thing, "")

    def test_the_demo_mug(self) -> None:
        bpy.ops.import_scene.gltf(filepath=str(MUG))
        thing = next(o for o in bpy.context.selected_objects if o.type == "MESH")
        bpy.ops.ed.undo_push(message="imported")
        job = self.edit([thing], "a red mug", "a golden mug")
        nodes = shown(thing).node_tree.nodes
        self.assertEqual(sorted(n.image.size[0] for n in nodes if n.type == "TEX_IMAGE"), [1024, 1024])
        self.assertTrue(all(n.image.packed_file for n in nodes if n.type == "TEX_IMAGE"))
        self.check_golden(job, thing, "glaze")

    def test_a_rigged_figure(self) -> None:
        thing, armature = figure()
        shape = [tuple(v.co) for v in thing.data.vertices]
        bpy.ops.ed.undo_push(message="made")
        job = self.edit([thing], "a gray robot", "a golden robot")
        self.assertEqual(thing.modifiers[0].object, armature)
        self.assertEqual([tuple(v.co) for v in thing.data.vertices], shape)
        self.assertEqual(len(thing.vertex_groups), len(armature.data.bones))
        self.check_golden(job, thing, "Skin")

    def test_selected_faces_alone(self) -> None:
        image = painted("p", 64)
        thing = cube()
        thing.data.materials[0] = textured("Painted", image)
        for polygon in thing.data.polygons:
            polygon.select = polygon.index == 0
        self.settings.region = "FACES"
        job = self.edit([thing], "a red cube", "a golden cube")
        outside = job.result()["region"]["outside"]
        self.assertEqual(outside["changed"], 0, outside)

    def test_a_painted_image_and_words_are_taken(self) -> None:
        """Tests that the program reads the image. Its own tests check which texels change."""
        thing = cube()
        thing.data.materials[0] = textured("Painted", painted("p", 64))
        mask = bpy.data.images.new("Mask", 64, 64)
        mask.pixels.foreach_set([1.0, 1.0, 1.0, 1.0] * (64 * 32) + [0.0, 0.0, 0.0, 1.0] * (64 * 32))
        self.settings.region, self.settings.image, self.settings.iterations = "IMAGE", mask, 2
        job = self.edit([thing], "a red cube", "a golden cube")
        self.assertEqual(job.result()["settings"]["region"], [f"mask={job.folder / 'mask.png'}"])
        self.assertEqual(job.result()["region"]["outside"]["changed"], 0)

    def test_the_programs_complaint_reaches_the_panel(self) -> None:
        self.settings.region, self.settings.words = "WORDS", "the flux capacitor"
        job = self.begin([cube()], "a gray cube", "a golden cube")
        self.finish(job)
        self.assertEqual(job.state, "failed")
        self.assertIn("flux capacitor", job.message)
        self.assertNotIn("\n", job.message)


def figure() -> tuple[bpy.types.Object, bpy.types.Object]:
    """Returns a posed figure of boxes that bones move: a body, a head, two arms and two legs."""
    parts = {"body": ((0, 0, 1.5), (0.5, 0.3, 0.7)), "head": ((0, 0, 2.6), (0.35, 0.35, 0.35)),
             "arm.L": ((0.8, 0, 1.9), (0.3, 0.15, 0.15)), "arm.R": ((-0.8, 0, 1.9), (0.3, 0.15, 0.15)),
             "leg.L": ((0.28, 0, 0.4), (0.18, 0.2, 0.4)), "leg.R": ((-0.28, 0, 0.4), (0.18, 0.2, 0.4))}  # fmt: skip
    corners, faces, groups = [], [], {}
    for name, (center, half) in parts.items():
        first = len(corners)
        corners += [[c + h * s for c, h, s in zip(center, half, (x, y, z))] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        faces += [[first + i for i in face] for face in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))]
        groups[name] = list(range(first, first + 8))
    mesh = bpy.data.meshes.new("Figure")
    mesh.from_pydata(corners, [], faces)
    mesh.materials.append(bpy.data.materials.new("Skin"))
    thing = bpy.data.objects.new("Figure", mesh)
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    for block in (thing, rig):
        bpy.context.scene.collection.objects.link(block)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, (center, half) in parts.items():
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = center, [c + (0, 0, half[2])[i] for i, c in enumerate(center)]
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, indices in groups.items():
        thing.vertex_groups.new(name=name).add(indices, 1.0, "REPLACE")
    thing.modifiers.new("Armature", "ARMATURE").object = rig
    thing.parent = rig
    rig.pose.bones["arm.L"].rotation_mode = "XYZ"
    rig.pose.bones["arm.L"].rotation_euler = (0, math.radians(40), math.radians(30))
    bpy.context.view_layer.update()
    return thing, rig
