"""Helpers of the tests: the extension as a package, an empty file, and programs to run."""
from __future__ import annotations

import importlib.util
import os
import stat
import sys
import tempfile
import time
import unittest
from pathlib import Path

BLENDER = Path(__file__).resolve().parents[1]
ROOT = BLENDER.parent
MUG = ROOT / "assets/demo/mug.glb"
PACKAGE = "item3d_blender"
# The program for tests of whole edits, which scripts/test_blender.sh sets.
PROGRAM = os.environ.get("ITEM3D_PROGRAM", "")
THREADS = os.environ.get("ITEM3D_TEST_THREADS", "2")
os.environ.setdefault("BLENDER_USER_RESOURCES", tempfile.mkdtemp(prefix="item3d-blender-"))

import bpy  # noqa: E402


def load_package() -> None:
    """Imports the extension as Blender does, under the name PACKAGE."""
    if PACKAGE in sys.modules:
        return
    spec = importlib.util.spec_from_file_location(
        PACKAGE, BLENDER / "__init__.py", submodule_search_locations=[str(BLENDER)]
    )
    module = importlib.util.module_from_spec(spec)
    sys.modules[PACKAGE] = module
    spec.loader.exec_module(module)
    module.register()


load_package()

from item3d_blender.core.job import Job  # noqa: E402
from item3d_blender.ui import preferences, session  # noqa: E402


def fake_program(folder: Path, behaviour: str) -> Path:
    """Writes a program that runs fake_item3d.py with a behaviour. Returns its path."""
    path = folder / "item3d"
    script = Path(__file__).with_name("fake_item3d.py")
    path.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{script}" {behaviour} "$@"\n', encoding="utf-8")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


class BlenderTest(unittest.TestCase):
    """Base of the tests. Each begins with Blender's default scene, a new folder, and no jobs."""

    def setUp(self) -> None:
        bpy.ops.wm.read_factory_settings(use_empty=False)
        holder = tempfile.TemporaryDirectory(prefix="item3d-test-")
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)
        self.addCleanup(self._end_jobs)
        preferences.Defaults.folder = str(self.folder / "jobs")
        preferences.Defaults.threads = int(THREADS)
        self.use(fake_program(self.folder, "edit"))
        bpy.ops.ed.undo_push(message="begin")

    def use(self, program: Path | str) -> None:
        preferences.Defaults.program = str(program)

    def _end_jobs(self) -> None:
        for job in list(session._jobs.values()):
            job.remove()
            session.forget(job)

    @property
    def settings(self) -> bpy.types.PropertyGroup:
        return bpy.context.scene.item3d

    def select(self, *things: bpy.types.Object) -> None:
        for thing in bpy.context.view_layer.objects:
            thing.select_set(thing in things)
        bpy.context.view_layer.objects.active = things[0] if things else None

    def begin(self, things: list[bpy.types.Object], source: str = "a gray cube", target: str = "a golden cube") -> Job:
        """Starts an edit by the operator. Returns its job."""
        self.select(*things)
        self.settings.source, self.settings.target = source, target
        bpy.ops.item3d.edit()
        return session.jobs_of_file()[0]

    def finish(self, job: Job, seconds: float = 280) -> None:
        """Polls all jobs as the timer does, until they have ended."""
        end = time.monotonic() + seconds
        while session.poll() is not None:
            self.assertLess(time.monotonic(), end, f"{job.folder}: still {job.state}")
            time.sleep(0.05)

    def edit(self, things: list[bpy.types.Object], *sentences: str) -> Job:
        job = self.begin(things, *sentences)
        self.finish(job)
        self.assertEqual(job.state, "applied", job.message)
        return job

    def fails(self, words: str, call: object, *arguments: object, **named: object) -> None:
        """Checks that an operator or function fails with one line that contains `words`."""
        with self.assertRaises(Exception) as caught:
            call(*arguments, **named)  # type: ignore[operator]
        message = str(caught.exception).strip()
        self.assertIn(words, message)
        self.assertNotIn("\n", message)
        self.assertNotIn("Traceback", message)


def cube() -> bpy.types.Object:
    return bpy.data.objects["Cube"]


def monkey(**location: object) -> bpy.types.Object:
    """Adds Suzanne without a UV map and without a material."""
    bpy.ops.mesh.primitive_monkey_add(**location)
    thing = bpy.context.object
    while thing.data.uv_layers:
        thing.data.uv_layers.remove(thing.data.uv_layers[0])
    return thing


def shown(thing: bpy.types.Object, slot: int = 0) -> bpy.types.Material | None:
    return thing.material_slots[slot].material if slot < len(thing.material_slots) else None


def painted(name: str, size: int = 32, packed: bool = True) -> bpy.types.Image:
    """Returns an image of two colours."""
    image = bpy.data.images.new(name, size, size)
    pixels = [(0.8, 0.1, 0.1, 1.0) if x < size // 2 else (0.1, 0.1, 0.8, 1.0) for _ in range(size) for x in range(size)]
    image.pixels.foreach_set([value for pixel in pixels for value in pixel])
    if packed:
        image.pack()
    return image


def textured(name: str, image: bpy.types.Image) -> bpy.types.Material:
    """Returns a material whose base colour is an image. It also emits light, which no edit changes."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    return material
