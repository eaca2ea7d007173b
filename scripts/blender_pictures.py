#!/usr/bin/env python3
"""Renders the image of docs/blender.md with Blender: four objects before and after an edit.

usage: PYTHONPATH=.deps/blender/VERSION scripts/blender_pictures.py ITEM3D SCENE [FOLDER]
       FOLDER: folder for the image, docs/images by default

The script edits Blender's cube, Suzanne without a UV map and with a modifier, the demo's mug and a rigged figure, each
with all iterations and with the extension's operator. This takes about ten minutes on two cores. SCENE is a .blend file
that is saved after each edit. If it exists, the script continues with it."""
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
    ("Suzanne", "a white monkey", "a rusty monkey"),
    ("mug", "a red mug", "a golden mug"),
    ("Figure", "a gray robot", "a golden robot"),
]
WIDTH, HEIGHT = 960, 290


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
    suzanne = support.monkey()
    modifier = suzanne.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 2
    bpy.ops.object.shade_smooth()
    bpy.ops.import_scene.gltf(filepath=str(support.MUG))
    mug = next(thing for thing in bpy.context.selected_objects if thing.type == "MESH")
    mug.name = "mug"


def place():
    """Places all objects side by side on a floor."""
    things = bpy.data.objects
    if "Figure" not in things:
        figure()
    if "Light" in things:
        things.remove(things["Light"])
    cube, suzanne, mug, rig = (things[name] for name in ("Cube", "Suzanne", "mug", "Rig"))
    cube.location, cube.scale, cube.rotation_euler = (-3.9, 0, 0.8), (0.8, 0.8, 0.8), (0, 0, 0.5)
    suzanne.location, suzanne.rotation_euler = (-1.35, 0, 0.95), (-0.35, 0, -0.2)
    size = 1.8 / max(vertex.co.z for vertex in mug.data.vertices)
    mug.location, mug.scale = (1.35, 0, 0), (size, size, size)
    rig.location, rig.scale, rig.rotation_euler = (3.8, 0, 0), (0.72, 0.72, 0.72), (0, 0, 0.3)
    bpy.context.view_layer.update()
    mug.location.z -= min((mug.matrix_world @ vertex.co).z for vertex in mug.data.vertices)
    if "Plane" not in things:
        bpy.ops.mesh.primitive_plane_add(size=200)
        floor = bpy.data.materials.new("Floor")
        floor.use_nodes = True
        floor.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.35, 0.36, 0.38, 1)
        bpy.context.object.data.materials.append(floor)
    bpy.context.view_layer.update()


def aim():
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.device, scene.cycles.use_denoising = 20, "CPU", True
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


def edit(name, source, target):
    thing = bpy.data.objects[name]
    if thing.material_slots and "item3d" in thing.material_slots[0].material:
        return
    select(thing)
    settings = bpy.context.scene.item3d
    settings.source, settings.target = source, target
    begin = time.monotonic()
    bpy.ops.item3d.edit()
    finish()
    print(f"{source} -> {target}: {time.monotonic() - begin:.0f} s", flush=True)


def main():
    program, scene = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    folder = pathlib.Path(sys.argv[3] if len(sys.argv) > 3 else ROOT / "docs/images")
    preferences.Defaults.program = program
    if scene.is_file():
        bpy.ops.wm.open_mainfile(filepath=str(scene))
    else:
        bpy.ops.wm.read_factory_settings(use_empty=False)
        make_scene()
    place()
    with tempfile.TemporaryDirectory() as work:
        preferences.Defaults.folder = f"{work}/jobs"
        aim()
        settings = bpy.context.scene.item3d
        settings.live, settings.iterations, settings.more = False, 0, "--image-size 64"
        if "item3d" not in bpy.context.scene.world:
            select(bpy.data.objects["Cube"])
            settings.relight, settings.preset = "preset", "studio"
            bpy.ops.item3d.relight()
            finish()
        for name, source, target in EDITS:
            edit(name, source, target)
            bpy.ops.wm.save_as_mainfile(filepath=str(scene))
        after = draw(f"{work}/after.png")
        for name, _, _ in EDITS:
            select(bpy.data.objects[name])
            bpy.ops.item3d.restore()
        before = draw(f"{work}/before.png")
        both = bpy.data.images.new("both", WIDTH, 2 * HEIGHT)
        both.pixels.foreach_set(np.concatenate([after, before]).astype(np.float32).ravel())
        both.file_format, both.filepath_raw = "JPEG", str(folder / "blender.jpg")
        both.save(quality=88)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
