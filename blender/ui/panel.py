"""The panel in the sidebar of the 3D view."""
from __future__ import annotations

import textwrap

import bpy

from ..core.job import Job
from ..core.program import HOW_TO_GET_IT
from ..core.words import unknown
from . import preferences, session

STAGES = {"load": "Reading", "fit": "Fitting", "edit": "Editing", "paint": "Painting", "detail": "Detail",
          "bake": "Writing textures", "report": "Report"}  # fmt: skip
CATEGORY = "item3d"


def lines(layout: bpy.types.UILayout, text: str, icon: str = "NONE", width: int = 42) -> None:
    """Draws a long text as several labels, because Blender does not wrap a label."""
    for number, line in enumerate(textwrap.wrap(text, width) or [""]):
        layout.label(text=line, icon=icon if number == 0 else "BLANK1")


class EditPanel(bpy.types.Panel):
    bl_idname, bl_label = "ITEM3D_PT_edit", "Edit"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", CATEGORY

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.scene.item3d
        found = session.program_state(context)
        if found is None:
            layout.label(text="Looking for the program...", icon="SORTTIME")
        elif isinstance(found, str):
            no_program(layout, found)
            return
        column = layout.column(align=True)
        column.prop(settings, "source")
        column.prop(settings, "target")
        strange = unknown(f"{settings.source} {settings.target}", session.words(context, settings.prior))
        if strange:
            lines(layout, f"The prior does not know: {', '.join(dict.fromkeys(strange))}", "INFO")
        where(layout, settings, context)
        row = layout.row()
        row.scale_y = 1.4
        row.operator("item3d.edit", icon="PLAY", text=_edit_label(context))
        for job in session.jobs_of_file()[:5]:
            draw_job(layout, job)
        layout.operator("item3d.restore", icon="LOOP_BACK")


class SettingsPanel(bpy.types.Panel):
    bl_idname, bl_label, bl_parent_id = "ITEM3D_PT_settings", "How", "ITEM3D_PT_edit"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", CATEGORY
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.scene.item3d
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in ("prior", "iterations", "seed", "texture_size", "detail", "metallic", "more", "live", "apply_when_done"):
            layout.prop(settings, name)


class LightPanel(bpy.types.Panel):
    bl_idname, bl_label = "ITEM3D_PT_light", "Light"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", CATEGORY
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.scene.item3d
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(settings, "relight")
        name = {"preset": "preset", "sky": "hour", "lit": "lit"}.get(settings.relight)
        if name:
            layout.prop(settings, name)
        else:
            lines(layout, f"{settings.source or '...'} -> {settings.target or '...'}")
        layout.operator("item3d.relight", icon="LIGHT_SUN", text="Make It the World")
        layout.operator("item3d.restore_world", icon="LOOP_BACK")


def where(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Draws the region's kind and the field that this kind needs."""
    box = layout.column()
    box.prop(settings, "region")
    thing = context.object
    data = thing.data if thing is not None and thing.type == "MESH" else None
    if settings.region == "GROUP" and thing is not None:
        box.prop_search(settings, "group", thing, "vertex_groups")
    elif settings.region == "PAINT" and data is not None:
        box.prop_search(settings, "paint", data, "color_attributes")
    elif settings.region == "MATERIAL":
        box.prop_search(settings, "material", bpy.data, "materials")
    elif settings.region in ("IMAGE", "WORDS", "COLOR", "TEXT"):
        box.prop(settings, {"IMAGE": "image", "WORDS": "words", "COLOR": "color", "TEXT": "selector"}[settings.region])
    if settings.region != "ALL":
        box.prop(settings, "feather")


def no_program(layout: bpy.types.UILayout, why: str) -> None:
    """Draws the reason why there is no program, and how to get it. Nothing is downloaded."""
    box = layout.box()
    lines(box, why, "ERROR")
    if HOW_TO_GET_IT not in why:
        lines(box, f"To get it: {HOW_TO_GET_IT}.")
    box.operator("preferences.addon_show", text="Choose the Program", icon="PREFERENCES").module = preferences.BASE
    box.operator("item3d.look_again", icon="FILE_REFRESH")


def draw_job(layout: bpy.types.UILayout, job: Job) -> None:
    """Draws a job's progress or result, and buttons for it."""
    box, folder = layout.box(), str(job.folder)
    box.label(text=job.record.get("title", ""), icon="WORLD" if job.record["kind"] == "relight" else "MATERIAL")
    if job.state == "running":
        factor, text = progress(job)
        row = box.row(align=True)
        row.progress(factor=factor, text=text)
        row.operator("item3d.cancel", text="", icon="X").folder = folder
        return
    if job.message:
        lines(box, job.message, "ERROR" if job.state == "failed" else "NONE")
    for warning in job.warnings()[:3]:
        lines(box, warning, "INFO")
    row = box.row(align=True)
    if job.state == "done":
        row.operator("item3d.apply_result", text="Apply", icon="CHECKMARK").folder = folder
    if job.state in ("failed", "cancelled") and (job.folder / "out" / "checkpoint.safetensors").is_file():
        row.operator("item3d.resume", icon="PLAY").folder = folder
    if (job.folder / "out" / "report.html").is_file():
        row.operator("item3d.report", icon="URL").folder = folder
    row.operator("item3d.discard", text="", icon="TRASH").folder = folder


def progress(job: Job) -> tuple[float, str]:
    """Returns the finished fraction of the stage, and a line of text about it."""
    found = job.read_json("progress.json")
    stage = STAGES.get(found.get("stage", ""), found.get("stage", "").capitalize() or "Starting")
    if job.record.get("cancelling"):
        stage = "Stopping"
    total, done, left = found.get("total") or 0, found.get("done") or 0, found.get("seconds_left")
    text = f"{stage} {done}/{total}" if total else stage
    if left is not None:
        text += f", {left:.0f} s"
    return (done / total if total else 0.0), text


def _edit_label(context: bpy.types.Context) -> str:
    count = len(context.selected_objects)
    return f"Edit {count} Objects" if count > 1 else "Edit"


CLASSES = (EditPanel, SettingsPanel, LightPanel)
