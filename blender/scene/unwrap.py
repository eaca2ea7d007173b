"""UV maps for objects that lack a usable one."""
from __future__ import annotations

import math

import bpy
import numpy as np

from .scratch import Scratch

UV_NAME = "item3d"
# Fraction of the covered texels that may have two owners before a UV map counts as overlapping.
MOST_SHARED = 0.05
_GRID = 256


def uv_of(mesh: bpy.types.Mesh, layer: int) -> np.ndarray:
    """Returns the UV coordinates of a layer, [loops, 2] float32."""
    values = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers[layer].uv.foreach_get("vector", values)
    return values.reshape(-1, 2)


def set_uv(mesh: bpy.types.Mesh, name: str, values: np.ndarray) -> bpy.types.MeshUVLoopLayer:
    """Adds a UV map with values [loops, 2], or changes the UV map of this name."""
    layer = mesh.uv_layers.get(name) or mesh.uv_layers.new(name=name, do_init=False)
    layer.uv.foreach_set("vector", np.ascontiguousarray(values, np.float32).ravel())
    return layer


def overlaps(mesh: bpy.types.Mesh) -> bool:
    """Returns true if different places of a mesh share texels of its active UV map, or lie outside of the unit square.

    Neighbours share only edges. A texel whose centre is on an edge does not count.
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
    return _shared_part(corners) > MOST_SHARED


def _shared_part(corners: np.ndarray) -> float:
    """Returns the fraction of covered texels whose centres lie within several of the triangles `corners` [T, 3, 2]."""
    corners = corners.astype(np.float64) * _GRID - 0.5  # makes the texels' centres whole numbers
    low = np.ceil(corners.min(1)).astype(np.int64)
    size = np.maximum(np.floor(corners.max(1)).astype(np.int64) - low + 1, 0)
    counts = size[:, 0] * size[:, 1]
    triangle = np.repeat(np.arange(len(corners)), counts)
    within = np.arange(len(triangle)) - np.repeat(np.cumsum(counts) - counts, counts)
    x = low[triangle, 0] + within % size[triangle, 0]
    y = low[triangle, 1] + within // size[triangle, 0]
    sides = []
    for first, second in ((0, 1), (1, 2), (2, 0)):
        a, b = corners[triangle, first], corners[triangle, second]
        sides.append((b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (b[:, 1] - a[:, 1]) * (x - a[:, 0]))
    side = np.stack(sides)
    inside = (side > 1e-6).all(0) | (side < -1e-6).all(0)
    owners = np.bincount((y * _GRID + x)[inside].clip(0), minlength=1)
    return float((owners > 1).sum() / max(1, (owners > 0).sum()))


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
