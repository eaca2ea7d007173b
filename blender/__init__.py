"""Extension that runs item3d in Blender and edits the look of selected objects by two sentences.

The package `core` needs no Blender, and `scene` needs no user interface. `ui` has panels, operators and the timer."""
from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from .scene import live
from .ui import operators, panel, preferences, properties, session

CLASSES = (preferences.Item3dPreferences, properties.Item3dSettings, *operators.CLASSES, *panel.CLASSES)


@persistent
def _opened(*_: object) -> None:
    session.file_opened()


@persistent
def _saved(*_: object) -> None:
    session.file_saved()


@persistent
def _undone(*_: object) -> None:
    """Removes live materials whose edits have ended, because an undo may bring them back."""
    live.clean(keep=session.running_folders())


HANDLERS = (
    (bpy.app.handlers.load_post, _opened),
    (bpy.app.handlers.save_post, _saved),
    (bpy.app.handlers.undo_post, _undone),
    (bpy.app.handlers.redo_post, _undone),
)


def register() -> None:
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.item3d = bpy.props.PointerProperty(type=properties.Item3dSettings)
    for handlers, handler in HANDLERS:
        handlers.append(handler)


def unregister() -> None:
    """Unregisters the extension. Running processes continue, and a later registration finds their jobs."""
    if bpy.app.timers.is_registered(session.poll):
        bpy.app.timers.unregister(session.poll)
    for handlers, handler in HANDLERS:
        handlers.remove(handler)
    del bpy.types.Scene.item3d
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
