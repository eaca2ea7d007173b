"""Operators of the panel's buttons. Each calls a few functions of `scene` and `core`."""
from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from ..core.errors import Item3dError
from ..core.job import Job
from ..scene import live
from ..scene.apply import apply, restore
from ..scene.start import start_edit, start_relight
from ..scene.world import apply_light, restore_world
from . import preferences, session


@contextmanager
def object_mode(context: bpy.types.Context) -> Iterator[None]:
    """Switches the active object to object mode, and restores its mode at the end."""
    active = context.view_layer.objects.active
    mode = active.mode if active is not None else "OBJECT"
    if mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    try:
        yield
    finally:
        if mode != "OBJECT" and context.view_layer.objects.active == active:
            bpy.ops.object.mode_set(mode=mode)


def chosen_objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Returns the selected objects, the active one first."""
    layer = context.view_layer
    chosen = [thing for thing in layer.objects if thing is not None and thing.select_get(view_layer=layer)]
    active = layer.objects.active
    return sorted(chosen, key=lambda thing: thing != active)


class Item3dOperator:
    """Base of the operators, which reports an Item3dError as Blender's error message."""

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            said = self.work(context)
        except Item3dError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if said:
            self.report({"INFO"}, said)
        return {"FINISHED"}

    def work(self, context: bpy.types.Context) -> str:
        raise NotImplementedError


class JobOperator(Item3dOperator):
    folder: bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})  # type: ignore[valid-type]

    def job(self) -> Job:
        return session.get(self.folder)


class Edit(Item3dOperator, bpy.types.Operator):
    """Edit the look of the selected objects"""

    bl_idname, bl_label = "item3d.edit", "Edit"

    def work(self, context: bpy.types.Context) -> str:
        settings = context.scene.item3d
        with object_mode(context):
            job = start_edit(
                context, chosen_objects(context), settings.edit_settings(), settings.chosen_region(),
                preferences.program(context), preferences.machine(context), session.place(context),
            )  # fmt: skip
        session.add(job)
        for note in job.record["notes"]:
            self.report({"WARNING"}, note)
        return ""


class Relight(Item3dOperator, bpy.types.Operator):
    """Find a light for the selected objects and use it as the world"""

    bl_idname, bl_label = "item3d.relight", "Light"

    def work(self, context: bpy.types.Context) -> str:
        with object_mode(context):
            job = start_relight(
                context, chosen_objects(context), context.scene.item3d.relight_settings(), preferences.program(context),
                preferences.machine(context), session.place(context),
            )  # fmt: skip
        session.add(job)
        return ""


class Cancel(JobOperator, bpy.types.Operator):
    """Stop the edit; it can be continued later"""

    bl_idname, bl_label = "item3d.cancel", "Cancel"

    def work(self, context: bpy.types.Context) -> str:
        self.job().cancel()
        return ""


class Continue(JobOperator, bpy.types.Operator):
    """Continue from the checkpoint"""

    bl_idname, bl_label = "item3d.resume", "Continue"

    def work(self, context: bpy.types.Context) -> str:
        job = self.job()
        job.resume(preferences.program(context))
        session.add(job)
        return ""


class ApplyResult(JobOperator, bpy.types.Operator):
    """Show the result: new materials on the objects, or a new world. The old ones are kept in the file"""

    bl_idname, bl_label, bl_options = "item3d.apply_result", "Apply item3d's Result", {"UNDO"}

    def work(self, context: bpy.types.Context) -> str:
        job = self.job()
        if job.record["kind"] == "relight":
            scene = bpy.data.scenes.get(job.record["scene"], context.scene)
            said = f"{apply_light(job, scene).name} is now the world"
        else:
            applied = apply(job)
            if not applied.materials:
                raise Item3dError(f"{job.record['title']}: no material changed; the region may be empty")
            said = f"{', '.join(applied.materials)} on {', '.join(applied.objects)}"
        job.mark("applied", said)
        for file in ("checkpoint.safetensors",):
            (job.folder / "out" / file).unlink(missing_ok=True)
        return said


class Discard(JobOperator, bpy.types.Operator):
    """Delete the folder of this edit; applied materials are kept"""

    bl_idname, bl_label = "item3d.discard", "Delete"

    def work(self, context: bpy.types.Context) -> str:
        job = self.job()
        job.remove()
        session.forget(job)
        live.clean(keep=session.running_folders())
        return ""


class Report(JobOperator, bpy.types.Operator):
    """Open the report of this edit in the browser"""

    bl_idname, bl_label = "item3d.report", "Report"

    def work(self, context: bpy.types.Context) -> str:
        page = self.job().folder / "out" / "report.html"
        if not page.is_file():
            raise Item3dError(f"{page}: no report; it is written at the end of an edit")
        bpy.ops.wm.path_open(filepath=str(page))
        return ""


class Restore(Item3dOperator, bpy.types.Operator):
    """Restore the materials that the selected objects had before their edits"""

    bl_idname, bl_label, bl_options = "item3d.restore", "Show Source", {"REGISTER", "UNDO"}

    def work(self, context: bpy.types.Context) -> str:
        changed = restore(chosen_objects(context))
        if not changed:
            raise Item3dError("the selected objects show no edited material; select objects that were edited")
        return f"the source's materials on {', '.join(changed)}"


class RestoreWorld(Item3dOperator, bpy.types.Operator):
    """Restore the world that the scene had before"""

    bl_idname, bl_label, bl_options = "item3d.restore_world", "World Before", {"REGISTER", "UNDO"}

    def work(self, context: bpy.types.Context) -> str:
        if not restore_world(context.scene):
            raise Item3dError("the world was not made by item3d, or there was no world before it")
        return ""


class LookAgain(Item3dOperator, bpy.types.Operator):
    """Look for the item3d program again"""

    bl_idname, bl_label = "item3d.look_again", "Look Again"

    def work(self, context: bpy.types.Context) -> str:
        session.look_again()
        return ""


CLASSES = (Edit, Relight, Cancel, Continue, ApplyResult, Discard, Report, Restore, RestoreWorld, LookAgain)
