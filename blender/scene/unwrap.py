"""UV maps for objects that have none that an edit can use."""
from __future__ import annotations

import math

import bpy
import numpy as np

from .scratch import Scratch

UV_NAME = "item3d"
# Part of the covered texels that may have two owners before a UV map counts as overlapping.
MOST_SHARED = 0.05
_GRID = 256


def uv_of(mesh: bpy.types.Mesh, layer: int) -> np.ndarray:
    """UV coordinates of a layer, [loops, 2] float32."""
    values = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers[layer].uv.foreach_get("vector", values)
    return values.reshape(-1, 2)


def set_uv(mesh: bpy.types.Mesh, name: str, values: np.ndarray) -> bpy.types.MeshUVLoopLayer:
    """Adds a UV map, or changes the one of this name. values: [loops, 2]."""
    layer = mesh.uv_layers.get(name) or mesh.uv_layers.new(name=name, do_init=False)
    layer.uv.foreach_set("vector", np.ascontiguousarray(values, np.float32).ravel())
    return layer


def overlaps(mesh: bpy.types.Mesh) -> bool:
    """Whether different places of a mesh lie on the same texels of its active UV map, or beside the picture.

    Looks at points of each triangle: a texel is shared where triangles without a common corner own it.
    """
    if not mesh.uv_layers:
        return True
    uv = uv_of(mesh, max(mesh.uv_layers.active_index, 0))
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    if count == 0 or not np.isfinite(uv).all():
        return True
    loops = np.empty(3 * count, np.int32)
    mesh.loop_triangles.foreach_get("loops", loops)
    corners = uv[loops.reshape(-1, 3)]
    if corners.min() < -1e-3 or corners.max() > 1 + 1e-3:
        return True
    edge_a, edge_b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = np.abs(edge_a[:, 0] * edge_b[:, 1] - edge_a[:, 1] * edge_b[:, 0]) / 2
    if areas.sum() <= 0 or areas.sum() > 1 + MOST_SHARED:
        return True
    return _shared_part(corners, areas) > MOST_SHARED


def _shared_part(corners: np.ndarray, areas: np.ndarray) -> float:
    """Part of the covered texels on which points of two triangles lie that do not touch in UV space."""
    random = np.random.default_rng(0)
    count = int(min(400_000, max(20_000, 4 * _GRID * _GRID * areas.sum())))
    triangle = random.choice(len(areas), size=count, p=areas / areas.sum())
    a, b = random.random((2, count))
    flip = a + b > 1
    a[flip], b[flip] = 1 - a[flip], 1 - b[flip]
    chosen = corners[triangle]
    points = chosen[:, 0] + a[:, None] * (chosen[:, 1] - chosen[:, 0]) + b[:, None] * (chosen[:, 2] - chosen[:, 0])
    texels = np.clip((points * _GRID).astype(np.int64), 0, _GRID - 1)
    at = texels[:, 1] * _GRID + texels[:, 0]
    order = np.argsort(at, kind="stable")
    at, triangle = at[order], triangle[order]
    same = (at[1:] == at[:-1]) & (triangle[1:] != triangle[:-1])
    first, second = corners[triangle[:-1][same]], corners[triangle[1:][same]]
    # Neighbours share a corner, or come within a texel of one another.
    gap = np.abs(first[:, :, None, :] - second[:, None, :, :]).max(-1).reshape(len(first), 9).min(1)
    shared = np.unique(at[1:][same][gap > 1.0 / _GRID])
    return len(shared) / max(1, len(np.unique(at)))


def unwrap(scratch: Scratch, mesh: bpy.types.Mesh, name: str) -> np.ndarray:
    """Gives a scratch mesh a UV map by Smart UV Project. Returns its coordinates, [loops, 2]."""
    scene = scratch.scene()
    thing = scratch.keep(bpy.data.objects.new("item3d unwrap", mesh))
    scene.collection.objects.link(thing)
    layer = mesh.uv_layers.get(name) or mesh.uv_layers.new(name=name)
    mesh.uv_layers.active = layer
    layer_view = scene.view_layers[0]
    layer_view.objects.active = thing
    thing.select_set(True, view_layer=layer_view)
    shown = {"scene": scene, "view_layer": layer_view, "object": thing, "active_object": thing}
    with bpy.context.temp_override(**shown, selected_objects=[thing]):
        bpy.ops.object.mode_set(mode="EDIT")
        try:
            with bpy.context.temp_override(**shown, edit_object=thing):
                bpy.ops.mesh.reveal(select=False)
                bpy.ops.mesh.select_all(action="SELECT")
                bpy.ops.uv.smart_project(angle_limit=math.radians(66), island_margin=0.01)
        finally:
            bpy.ops.object.mode_set(mode="OBJECT")
    return uv_of(mesh, mesh.uv_layers.find(name))
