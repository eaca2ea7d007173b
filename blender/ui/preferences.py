"""Preferences of the extension: the program's path, and its folder, threads and device."""
from __future__ import annotations

from pathlib import Path

import bpy

from ..core.command import Machine
from ..core.program import HOW_TO_GET_IT, Program, find

BASE = __package__.rpartition(".")[0]
EXTENSION = Path(__file__).resolve().parents[1]


class Item3dPreferences(bpy.types.AddonPreferences):
    bl_idname = BASE

    program: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Program", subtype="FILE_PATH", description="The item3d program; empty: search for it on this machine"
    )
    folder: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Folder", subtype="DIR_PATH",
        description="Folder for running edits; empty: a folder item3d next to the file, or Blender's own folder for unsaved files",
    )
    threads: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Threads", min=0, max=1024, default=0, description="CPU threads of item3d; 0: one per core"
    )
    device: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Device",
        items=[("auto", "Automatic", "A CUDA device if item3d finds one"), ("cpu", "CPU", ""), ("cuda", "CUDA", "")],
    )

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.prop(self, "program")
        column.prop(self, "folder")
        column.prop(self, "threads")
        column.prop(self, "device")
        column.label(text=f"To get the program: {HOW_TO_GET_IT}.")


class Defaults:
    """Preferences if the extension is used without being enabled, as in tests."""

    program, folder, threads, device = "", "", 0, "auto"


def preferences(context: bpy.types.Context) -> Item3dPreferences | type[Defaults]:
    addon = context.preferences.addons.get(BASE)
    return addon.preferences if addon is not None and addon.preferences is not None else Defaults


def machine(context: bpy.types.Context) -> Machine:
    wanted = preferences(context)
    return Machine(threads=wanted.threads, device=wanted.device)


def program(context: bpy.types.Context) -> Program:
    """Returns the program. Raises Item3dError if it is missing or too old."""
    return find(preferences(context).program, EXTENSION)
