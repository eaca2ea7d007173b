"""Tests of errors: each gives one clear line, and nothing is lost."""
from __future__ import annotations

import os
import shutil
import signal
import time

import bpy

from .support import BlenderTest, cube, fake_program, monkey, shown
from item3d_blender.ui import session


class BadInput(BlenderTest):
    def refuse(self, words: str, *things: bpy.types.Object) -> None:
        """Checks that an edit fails with an error that contains `words`, and leaves no folder and no data."""
        self.settings.source = self.settings.source or "a cube"
        self.settings.target = self.settings.target or "a golden cube"
        self.select(*things)
        before = {name: len(getattr(bpy.data, name)) for name in ("meshes", "objects", "materials", "scenes", "images")}
        self.fails(words, bpy.ops.item3d.edit)
        self.assertEqual({name: len(getattr(bpy.data, name)) for name in before}, before)
        self.assertEqual(session.jobs_of_file(), [])
        jobs = self.folder / "jobs"
        self.assertEqual(list(jobs.iterdir()) if jobs.exists() else [], [])

    def test_nothing_selected(self) -> None:
        self.refuse("nothing is selected")

    def test_sentences(self) -> None:
        self.settings.source, self.settings.target = "a cube", "A cube"
        self.refuse("are the same", cube())

    def test_objects_without_faces(self) -> None:
        bpy.ops.mesh.primitive_circle_add()
        circle = bpy.context.object
        self.refuse("no faces to edit", circle)
        self.refuse("no faces to edit", bpy.data.objects["Light"], bpy.data.objects["Camera"])

    def test_modifiers_that_leave_nothing(self) -> None:
        modifier = cube().modifiers.new("m", "MASK")
        modifier.vertex_group = cube().vertex_groups.new(name="empty").name
        self.refuse("no faces to edit", cube())

    def test_regions_of_nothing(self) -> None:
        for region, name, words in (
            ("FACES", "", "no face of the objects is selected"),
            ("GROUP", "Top", "in Top"),
            ("PAINT", "Mask", "in Mask"),
            ("MATERIAL", "Nothing", "they have Material"),
            ("WORDS", "", "give the part"),
            ("IMAGE", "", "give an image"),
        ):
            with self.subTest(region):
                for polygon in cube().data.polygons:
                    polygon.select = False
                self.settings.region = region
                self.settings.group = self.settings.paint = self.settings.material = name
                self.refuse(words, cube())

    def test_linked_libraries(self) -> None:
        path = self.folder / "library.blend"
        bpy.data.libraries.write(str(path), {cube()})
        with bpy.data.libraries.load(str(path), link=True) as (there, here):
            here.objects = list(there.objects)
        thing = here.objects[0]
        bpy.context.scene.collection.objects.link(thing)
        self.refuse("make it local or a library override", thing)

    def test_a_linked_mesh_without_uv_map_comes_as_an_object(self) -> None:
        path = self.folder / "library.blend"
        thing = monkey()
        bpy.data.libraries.write(str(path), {thing.data})
        with bpy.data.libraries.load(str(path), link=True) as (there, here):
            here.meshes = list(there.meshes)
        local = bpy.data.objects.new("Local", here.meshes[0])
        bpy.context.scene.collection.objects.link(local)
        self.edit([local], "a monkey", "a golden monkey")
        self.assertIn("Local - a golden monkey", bpy.data.objects)

    def test_no_program(self) -> None:
        self.use(self.folder / "nothing")
        self.refuse("no such program", cube())

    def test_a_program_that_is_too_old(self) -> None:
        self.use(fake_program(self.folder, "old"))
        self.refuse("too old, 0.2.0 or newer is needed", cube())

    def test_a_program_that_is_killed(self) -> None:
        self.use(fake_program(self.folder, "slow"))
        job = self.begin([cube()])
        while not session._views[str(job.folder)].revision:
            session.poll()
        os.kill(job.record["process"], signal.SIGKILL)
        self.finish(job)
        self.assertEqual(job.state, "failed")
        self.assertIn("ended by SIGKILL", job.message)
        self.assertEqual(shown(cube()).name, "Material")

    def test_a_folder_that_is_deleted_in_the_middle(self) -> None:
        self.use(fake_program(self.folder, "slow"))
        job = self.begin([cube()])
        while not session._views[str(job.folder)].revision:
            session.poll()
        while job.folder.exists():
            shutil.rmtree(job.folder, ignore_errors=True)
        self.finish(job)
        self.assertIn("deleted while item3d was running", job.message)
        self.assertEqual(shown(cube()).name, "Material")

    def test_a_result_that_is_deleted_before_it_is_applied(self) -> None:
        self.settings.apply_when_done = False
        job = self.begin([cube()])
        self.finish(job)
        shutil.rmtree(job.folder / "out")
        self.fails("start it again", bpy.ops.item3d.apply_result, folder=str(job.folder))
        self.assertEqual(shown(cube()).name, "Material")

    def test_a_result_that_is_broken(self) -> None:
        self.settings.apply_when_done = False
        job = self.begin([cube()])
        self.finish(job)
        (job.folder / "out/model.glb").write_bytes(b"glTF")
        self.fails("broken", bpy.ops.item3d.apply_result, folder=str(job.folder))
        self.assertEqual((shown(cube()).name, job.state), ("Material", "done"))

    def test_a_folder_that_cannot_be_written(self) -> None:
        from item3d_blender.ui import preferences

        preferences.Defaults.folder = "/proc/nowhere"
        self.refuse("cannot be written", cube())

    def test_an_unsaved_file(self) -> None:
        from item3d_blender.ui import preferences

        preferences.Defaults.folder = ""
        job = self.edit([cube()])
        self.assertTrue(job.folder.is_relative_to(session.own_folder()))
        self.assertEqual(job.record["blend"], "")

    def test_an_object_that_is_deleted_or_changed_meanwhile(self) -> None:
        self.settings.apply_when_done = False
        thing = monkey()
        job = self.begin([thing], "a monkey", "a golden monkey")
        self.finish(job)
        thing.name = "Other"
        self.fails("the object no longer exists", bpy.ops.item3d.apply_result, folder=str(job.folder))
        thing.name = "Suzanne"
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        self.fails("in edit mode", bpy.ops.item3d.apply_result, folder=str(job.folder))
        bpy.ops.mesh.subdivide()
        bpy.ops.object.mode_set(mode="OBJECT")
        self.fails("when the edit was started", bpy.ops.item3d.apply_result, folder=str(job.folder))
        self.assertEqual((len(thing.material_slots), job.state), (0, "done"))

    def test_edit_mode_is_left_and_entered_again(self) -> None:
        self.select(cube())
        bpy.ops.object.mode_set(mode="EDIT")
        job = self.begin([cube()])
        self.assertEqual(cube().mode, "EDIT")
        end = time.monotonic() + 5
        while job.state != "done" and time.monotonic() < end:
            session.poll()
        session.poll()
        self.assertEqual((job.state, shown(cube()).name), ("done", "Material"), "it waits for object mode")
        bpy.ops.object.mode_set(mode="OBJECT")
        self.finish(job)
        self.assertEqual(shown(cube()).name, "Material - a golden cube")
