"""Makes the light of a relighting the world's environment."""
from __future__ import annotations

import math
from pathlib import Path

import bpy

from ..core.errors import Item3dError
from ..core.job import Job
from . import slots
from .apply import note_settings

# The centre of an equirectangular image is north in item3d (glTF's -Z, Blender's +Y), but +X in Blender. The
# difference is a quarter turn.
TURN = -math.pi / 2


def apply_light(job: Job, scene: bpy.types.Scene) -> bpy.types.World:
    """Gives a scene a world with the light of a job. The previous world stays in the file."""
    path = job.folder / "out" / "light.exr"
    if not path.is_file():
        raise Item3dError(f"{path}: no light there; start it again")
    world = make_world(path, f"item3d {job.record.get('title', 'light')}"[:60])
    result = job.result()
    note_settings(world, result)
    if scene.world is not None:
        scene.world.use_fake_user = True
        world[slots.SOURCE] = scene.world
    scene.world = world
    return world


def make_world(path: Path, name: str) -> bpy.types.World:
    """Returns a new world that shows an equirectangular image of item3d, with north at Blender's +Y."""
    image = bpy.data.images.load(str(path))
    image.pack()
    image.filepath_raw = f"//textures/{path.name}"
    world = bpy.data.worlds.new(name)
    if world.node_tree is None:
        world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputWorld")
    background = tree.nodes.new("ShaderNodeBackground")
    environment = tree.nodes.new("ShaderNodeTexEnvironment")
    mapping = tree.nodes.new("ShaderNodeMapping")
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    for column, node in enumerate((output, background, environment, mapping, coordinates)):
        node.location = (-280 * column, 0)
    environment.image = image
    mapping.inputs["Rotation"].default_value = (0, 0, TURN)
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], environment.inputs["Vector"])
    tree.links.new(environment.outputs["Color"], background.inputs["Color"])
    tree.links.new(background.outputs["Background"], output.inputs["Surface"])
    return world


def restore_world(scene: bpy.types.Scene) -> bool:
    """Restores the previous world. Returns true if there was one."""
    source = scene.world.get(slots.SOURCE) if scene.world else None
    if source is None:
        return False
    scene.world.use_fake_user = True
    scene.world = source
    return True
