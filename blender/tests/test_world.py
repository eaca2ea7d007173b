"""Tests of the world that a relighting makes: its orientation is right, and the previous world is kept."""
from __future__ import annotations

import unittest

import bpy
import numpy as np

from .support import PROGRAM, BlenderTest, cube
from item3d_blender.scene.world import make_world

# Two neighbouring sides and the zenith distinguish all rotations and mirror images.
SIDES = {"north": (0, 1, 0), "east": (1, 0, 0), "up": (0, 0, 1)}


class World(BlenderTest):
    def looked_at(self, direction: tuple[float, ...]) -> np.ndarray:
        """Returns the linear colour that a camera sees in a direction, rendered by Cycles."""
        from mathutils import Vector

        scene = bpy.context.scene
        scene.render.engine = "CYCLES"
        scene.cycles.samples, scene.cycles.device = 1, "CPU"
        scene.cycles.use_denoising = False
        scene.render.resolution_x = scene.render.resolution_y = 8
        scene.render.image_settings.file_format = "OPEN_EXR"
        scene.camera.location = (0, 0, 100)
        scene.camera.data.lens = 500
        scene.camera.rotation_euler = Vector(direction).to_track_quat("-Z", "Y").to_euler()
        scene.render.filepath = str(self.folder / "seen.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        color = np.array(image.pixels[:]).reshape(-1, 4).mean(0)[:3]
        bpy.data.images.remove(image)
        return color

    def test_directions(self) -> None:
        width, height = 64, 32
        pixels = np.zeros((height, width, 4), np.float32)
        pixels[..., 3] = 1
        colors = {"north": (1, 0, 0), "east": (0, 1, 0), "south": (0, 0, 1), "west": (1, 1, 0), "up": (0, 1, 1)}
        # item3d's layout: north is in the centre and east to its right. Rows of pixels go upwards here.
        for name, left, right in (("north", 28, 36), ("east", 44, 52), ("west", 12, 20)):
            pixels[12:20, left:right, :3] = colors[name]
        pixels[12:20, :4, :3] = pixels[12:20, 60:, :3] = colors["south"]
        pixels[28:, :, :3] = colors["up"]
        image = bpy.data.images.new("light", width, height, float_buffer=True)
        image.pixels.foreach_set(pixels.ravel())
        path = self.folder / "light.exr"
        image.filepath_raw, image.file_format = str(path), "OPEN_EXR"
        image.save()
        bpy.data.objects.remove(cube())
        bpy.context.scene.world = make_world(path, "made")
        for name, direction in SIDES.items():
            with self.subTest(name):
                # At the zenith, Cycles mixes the image with its opposite edge.
                np.testing.assert_allclose(self.looked_at(direction), colors[name], atol=0.3)

    @unittest.skipUnless(PROGRAM, "ITEM3D_PROGRAM names no program")
    def test_a_light_becomes_the_world(self) -> None:
        self.use(PROGRAM)
        before = bpy.context.scene.world
        self.select(cube())
        self.settings.relight, self.settings.lit = "lit", "low in the west"
        bpy.ops.item3d.relight()
        from item3d_blender.ui import session

        job = session.jobs_of_file()[0]
        self.finish(job)
        self.assertEqual(job.state, "applied", job.message)
        world = bpy.context.scene.world
        self.assertEqual(world["item3d_source"], before)
        image = next(n.image for n in world.node_tree.nodes if n.type == "TEX_ENVIRONMENT")
        self.assertTrue(image.packed_file)
        width, height = image.size
        columns = np.array(image.pixels[:]).reshape(height, width, -1)[height // 2 :, :, :3].mean((0, 2))
        west, east = columns[: width // 2].mean(), columns[width // 2 :].mean()
        self.assertGreater(west, 1.5 * east)
        bpy.ops.item3d.restore_world()
        self.assertEqual(bpy.context.scene.world, before)
