"""Data blocks for an export, which are gone after it."""
from __future__ import annotations

from types import TracebackType
from typing import TypeVar

import bpy

Block = TypeVar("Block", bound=bpy.types.ID)


class Scratch:
    """A context in which data blocks are made; all of them are removed where it ends."""

    def __init__(self, context: bpy.types.Context):
        self.context = context
        self._blocks: list[bpy.types.ID] = []
        self._window = context.window
        self._scene = context.window.scene if context.window else None

    def __enter__(self) -> Scratch:
        return self

    def keep(self, block: Block) -> Block:
        """Notes a data block for removal. Returns it."""
        self._blocks.append(block)
        return block

    def scene(self) -> bpy.types.Scene:
        """An empty scene with the frame of the one that is worked in."""
        scene = self.keep(bpy.data.scenes.new("item3d scratch"))
        scene.frame_set(self.context.scene.frame_current, subframe=self.context.scene.frame_subframe)
        return scene

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        # The glTF exporter shows the scene that it exports.
        if self._window and self._scene and self._window.scene != self._scene:
            self._window.scene = self._scene
        bpy.data.batch_remove(self._blocks)
