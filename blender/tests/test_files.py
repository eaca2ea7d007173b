"""Tests of edits that continue after their file is closed, and of live views."""
from __future__ import annotations

import time

import bpy

from .support import BlenderTest, cube, fake_program, monkey, shown
from item3d_blender.scene import live
from item3d_blender.ui import panel, session


class Running(BlenderTest):
    def setUp(self) -> None:
        super().setUp()
        self.use(fake_program(self.folder, "slow"))

    def until_live(self, thing: bpy.types.Object) -> None:
        end = time.monotonic() + 30
        while not (shown(thing) and shown(thing).get(live.LIVE)):
            self.assertLess(time.monotonic(), end, "no live material")
            session.poll()
            time.sleep(0.05)

    def test_is_shown_on_the_object_and_taken_off(self) -> None:
        job = self.begin([cube()])
        self.until_live(cube())
        image = next(n.image for n in shown(cube()).node_tree.nodes if n.type == "TEX_IMAGE" and n.image.get(live.LIVE, "").endswith("color.png"))
        first = image.pixels[0]
        revision = session._views[str(job.folder)].revision
        while session._views[str(job.folder)].revision < revision + 3:
            session.poll()
        self.assertNotEqual(image.pixels[0], first, "the picture is renewed in place")
        self.assertIn("Editing", panel.progress(job)[1])
        bpy.ops.item3d.cancel(folder=str(job.folder))
        self.finish(job)
        self.assertEqual((job.state, shown(cube()).name), ("cancelled", "Material"))
        self.assertFalse([i for i in bpy.data.images if i.get(live.LIVE)] + [m for m in bpy.data.materials if m.get(live.LIVE)])
        bpy.ops.item3d.resume(folder=str(job.folder))
        self.finish(job)
        self.assertEqual(shown(cube()).name, "Material - a golden cube")

    def test_a_uv_map_that_only_shows_it_goes_too(self) -> None:
        thing = monkey()
        job = self.begin([thing])
        self.until_live(thing)
        self.assertEqual(len(thing.data.uv_layers), 1)
        bpy.ops.item3d.cancel(folder=str(job.folder))
        self.finish(job)
        self.assertEqual((len(thing.data.uv_layers), len(thing.material_slots)), (0, 0))

    def test_not_live_where_that_is_off(self) -> None:
        self.settings.live = False
        job = self.begin([cube()])
        while not session._views[str(job.folder)].revision:
            session.poll()
        self.assertEqual(shown(cube()).name, "Material")
        self.assertTrue([i for i in bpy.data.images if i.name.startswith(live.PREVIEW)])

    def test_one_undo_from_an_edit_that_was_shown_live(self) -> None:
        job = self.begin([cube()])
        self.until_live(cube())
        cube().location.x = 2
        bpy.ops.ed.undo_push(message="somebody moves it in the meantime")
        bpy.ops.item3d.cancel(folder=str(job.folder))
        self.finish(job)
        bpy.ops.item3d.resume(folder=str(job.folder))
        self.finish(job)
        self.assertEqual(shown(cube()).name, "Material - a golden cube")
        bpy.ops.ed.undo()
        self.assertEqual((shown(cube()).name, cube().location.x), ("Material", 2))

    def test_a_file_that_is_closed_and_opened_while_it_runs(self) -> None:
        path = self.folder / "scene.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        job = self.begin([cube()])
        self.until_live(cube())
        bpy.ops.wm.save_mainfile()
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.assertEqual(session.jobs_of_file(), [], "it is none of the new file's")
        self.assertEqual(job.update(), "running")
        bpy.ops.wm.open_mainfile(filepath=str(path))
        self.assertEqual(session.jobs_of_file(), [job])
        self.until_live(cube())
        job.cancel()
        self.finish(job)
        self.assertEqual(shown(cube()).name, "Material")

    def test_a_blender_that_is_closed_and_opened(self) -> None:
        path = self.folder / "scene.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        job = self.begin([cube()])
        self.until_live(cube())
        bpy.ops.wm.save_mainfile()
        session.forget(job)  # like a new Blender, which knows no jobs
        bpy.ops.wm.open_mainfile(filepath=str(path))
        found = session.jobs_of_file()
        self.assertEqual([j.folder for j in found], [job.folder])
        found[0].cancel()
        self.finish(found[0])
        self.assertEqual((found[0].state, shown(cube()).name), ("cancelled", "Material"))

    def test_a_file_that_gets_its_name_while_it_runs(self) -> None:
        job = self.begin([cube()])
        path = self.folder / "later.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        self.assertEqual(job.record["blend"], str(path))
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.wm.open_mainfile(filepath=str(path))
        self.assertEqual(session.jobs_of_file(), [job])


class Result(BlenderTest):
    def test_the_result_is_in_the_file_without_the_folder(self) -> None:
        path = self.folder / "scene.blend"
        job = self.edit([cube()])
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        bpy.ops.item3d.discard(folder=str(job.folder))
        self.assertFalse(job.folder.exists())
        bpy.ops.wm.open_mainfile(filepath=str(path))
        self.assertEqual(shown(cube()).name, "Material - a golden cube")
        self.assertEqual(session.jobs_of_file(), [])
        self.select(cube())
        bpy.ops.item3d.restore()
        self.assertEqual(shown(cube()).name, "Material")
