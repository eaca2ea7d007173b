#!/usr/bin/env python3
"""The picture of docs/blender.md: four objects before and after an edit, drawn by Blender.

usage: PYTHONPATH=.deps/blender/VERSION scripts/blender_pictures.py ITEM3D [FOLDER]     FOLDER: docs/images

Edits Blender's cube, Suzanne without a UV map and under a modifier, the demo's mug and a rigged figure
with all iterations, each by the extension's own operator (about ten minutes on two cores)."""
import math
import os
import pathlib
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
os.environ["ITEM3D_PROGRAM"] = sys.argv[1]
from blender.tests import support  # noqa: E402
from blender.tests.test_whole import figure  # noqa: E402

import bpy  # noqa: E402
import numpy as np  # noqa: E402
from item3d_blender.ui import preferences, session  # noqa: E402

EDITS = [
    ("Cube", "a white cube", "a wooden cube"),
    ("Suzanne", "a white object", "a rusty object"),
    ("mug", "a red mug", "a golden mug"),
    ("Figure", "a gray robot", "a camouflage robot"),
]
WIDTH, HEIGHT = 1080, 330


def finish():
    job = session.jobs_of_file()[0]
    while session.poll() is not None:
        time.sleep(0.3)
    if job.state != "applied":
        sys.exit(f"{job.record['title']}: {job.state}, {job.message}")
    return job


def select(thing):
    for other in bpy.context.view_layer.objects:
        other.select_set(other == thing)
    bpy.context.view_layer.objects.active = thing


def make_scene():
    cube = support.cube()
    cube.location, cube.scale, cube.rotation_euler = (-3.9, 0, 0.8), (0.8, 0.8, 0.8), (0, 0, 0.5)
    suzanne = support.monkey(location=(-1.35, 0, 0.95), rotation=(-0.35, 0, -0.2))
    modifier = suzanne.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 2
    bpy.ops.object.shade_smooth()
    bpy.ops.import_scene.gltf(filepath=str(support.MUG))
    mug = next(thing for thing in bpy.context.selected_objects if thing.type == "MESH")
    mug.name, size = "mug", 1.8 / max(mug.dimensions)
    mug.location, mug.scale = (1.35, 0, 0), (size, size, size)
    bpy.context.view_layer.update()
    mug.location.z -= min((mug.matrix_world @ vertex.co).z for vertex in mug.data.vertices)
    robot, rig = figure()
    rig.location, rig.scale, rig.rotation_euler = (3.8, 0, 0), (0.72, 0.72, 0.72), (0, 0, 0.3)
    bpy.ops.mesh.primitive_plane_add(size=200)
    floor = bpy.data.materials.new("Floor")
    floor.use_nodes = True
    floor.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.35, 0.36, 0.38, 1)
    bpy.context.object.data.materials.append(floor)
    bpy.data.objects.remove(bpy.data.objects["Light"])
    bpy.context.view_layer.update()


def aim():
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.device, scene.cycles.use_denoising = 32, "CPU", True
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    camera = scene.camera
    camera.location, camera.rotation_euler = (0, -15, 4.2), (math.radians(78.5), 0, 0)
    camera.data.lens = 50


def draw(path):
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.array(image.pixels[:]).reshape(HEIGHT, WIDTH, 4)
    bpy.data.images.remove(image)
    return pixels


def main():
    folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ROOT / "docs/images")
    with tempfile.TemporaryDirectory() as work:
        bpy.ops.wm.read_factory_settings(use_empty=False)
        preferences.Defaults.folder, preferences.Defaults.program = f"{work}/jobs", sys.argv[1]
        make_scene()
        aim()
        settings = bpy.context.scene.item3d
        select(bpy.data.objects["Cube"])
        settings.relight, settings.preset = "preset", "studio"
        bpy.ops.item3d.relight()
        finish()
        before = draw(f"{work}/before.png")
        for name, source, target in EDITS:
            select(bpy.data.objects[name])
            settings.source, settings.target = source, target
            begin = time.monotonic()
            bpy.ops.item3d.edit()
            finish()
            print(f"{source} -> {target}: {time.monotonic() - begin:.0f} s", flush=True)
        after = draw(f"{work}/after.png")
        both = bpy.data.images.new("both", WIDTH, 2 * HEIGHT)
        both.pixels.foreach_set(np.concatenate([after, before]).astype(np.float32).ravel())
        bpy.context.scene.render.image_settings.file_format = "JPEG"
        bpy.context.scene.render.image_settings.quality = 88
        both.file_format, both.filepath_raw = "JPEG", str(folder / "blender.jpg")
        both.save(quality=88)
        bpy.ops.wm.save_as_mainfile(filepath=f"{work}/scene.blend")


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
