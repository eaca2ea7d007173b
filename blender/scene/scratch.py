"""Data blocks that exist only during an export."""
from __future__ import annotations

from types import TracebackType
from typing import TypeVar

import bpy

Block = TypeVar("Block", bound=bpy.types.ID)


class Scratch:
    """A context manager that removes all data blocks that were made in it."""

    def __init__(self, context: bpy.types.Context):
        self.context = context
        self._blocks: list[bpy.types.ID] = []
        self._window = context.window
        self._scene = context.window.scene if context.window else None

    def __enter__(self) -> Scratch:
        return self

    def keep(self, block: Block) -> Block:
        """Registers a data block for removal, and returns it."""
        self._blocks.append(block)
        return block

    def scene(self) -> bpy.types.Scene:
        """Returns a new empty scene, whose current frame is that of the user's scene."""
        scene = self.keep(bpy.data.scenes.new("item3d scratch"))
        scene.frame_set(self.context.scene.frame_current, subframe=self.context.scene.frame_subframe)
        return scene

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        # The glTF exporter makes the exported scene the window's scene.
        if self._window and self._scene and self._window.scene != self._scene:
            self._window.scene = self._scene
        bpy.data.batch_remove(self._blocks)
