"""Collects the evaluated meshes of chosen objects, and finds out whether a new material can go back to them."""
from __future__ import annotations

from dataclasses import dataclass, field

import bpy
import numpy as np
from mathutils import Matrix

from ..core.errors import Item3dError
from . import region as regions, trees, unwrap
from .scratch import Scratch

WITH_FACES = {"MESH", "CURVE", "SURFACE", "META", "FONT"}
MOST_INSTANCES = 200  # of one mesh; further ones would show the prior nothing new


@dataclass
class Shape:
    """A mesh and its places. `source` is the mesh's object. `own` is true if this is the object's whole mesh."""

    source: bpy.types.Object
    own: bool
    mesh: bpy.types.Mesh
    matrices: list[Matrix] = field(default_factory=list)
    uv: np.ndarray | None = None  # a UV map to be added to the source's mesh, [loops, 2]

    @property
    def goes_back(self) -> bool:
        """True if slots of the source can show the result. Otherwise the result becomes new objects."""
        return not self.obstacle

    @property
    def obstacle(self) -> str:
        """The reason why no slot of the source can show the result, or "" if one can."""
        if self.source.type != "MESH":
            return "it is not a mesh"
        if not self.own:
            return "its modifiers change the mesh"
        if self.source.library is not None or (self.uv is not None and self.source.data.library is not None):
            return "it is linked from another file"
        return ""


def collect(scratch: Scratch, chosen: list[bpy.types.Object], region: regions.Region) -> list[Shape]:
    """Returns the shapes of objects and of their instances, with the region as an attribute.

    Raises Item3dError if there is no face, if the region is empty, or if an object is linked.
    """
    _check(chosen)
    shapes = _evaluate(scratch, chosen)
    shapes = [shape for shape in shapes if len(shape.mesh.polygons)]
    if not shapes:
        names = ", ".join(thing.name for thing in chosen)
        raise Item3dError(f"{names}: no faces to edit; choose an object with faces, and check its modifiers")
    on_mesh = region.kind in regions.ON_THE_MESH
    largest = 0.0
    for shape in shapes:
        _prepare(scratch, shape)
        missing = _misses_uv(shape)
        if shape.own and shape.source.type == "MESH" and (missing or on_mesh):
            largest = max(largest, _evaluate_changed(scratch, shape, missing, region if on_mesh else None))
        if not shape.mesh.uv_layers:
            # The modifiers left no UV map, so their result gets one, which the source does not have.
            unwrap.unwrap(scratch, shape.mesh, unwrap.UV_NAME)
            shape.own, shape.uv = False, None
        if missing and shape.own:
            _keep_first(shape)
    if on_mesh and largest <= 0:
        raise Item3dError(f"Region: {_empty(region)}; select a part, or edit everything")
    return shapes


def _check(chosen: list[bpy.types.Object]) -> None:
    if not chosen:
        raise Item3dError("nothing is selected; select the objects to edit")
    for thing in chosen:
        if thing.library is not None:
            raise Item3dError(
                f"{thing.name}: linked from {thing.library.filepath}; make it local or a library override first"
            )


def _empty(region: regions.Region) -> str:
    if region.kind == "FACES":
        return "no face of the objects is selected"
    return f"no part of the objects is in {region.name}"


def _evaluate(scratch: Scratch, chosen: list[bpy.types.Object]) -> list[Shape]:
    """Returns the evaluated meshes of objects and of all their instances, with the places of each."""
    graph = scratch.context.evaluated_depsgraph_get()
    places: dict[tuple[bpy.types.Object, str], list[Matrix]] = {}
    generated: dict[str, bpy.types.Mesh] = {}
    for instance in graph.object_instances:
        owner = instance.parent if instance.is_instance else instance.object
        source = instance.object.original
        if owner is None or owner.original not in chosen or source.type not in WITH_FACES:
            continue
        # Geometry nodes instance meshes that belong to no object. A curve is listed beside the mesh that it becomes.
        name = ""
        if instance.is_instance and instance.object.type == "MESH" and source.type == "MESH":
            data = instance.object.data
            if data != source.evaluated_get(graph).data:
                name = data.name_full
                if name not in generated:
                    generated[name] = scratch.keep(data.copy())
        matrices = places.setdefault((source, name), [])
        matrix = instance.matrix_world.copy()
        if len(matrices) < MOST_INSTANCES and (not matrices or matrices[-1] != matrix):
            matrices.append(matrix)
    shapes = []
    for (source, name), matrices in places.items():
        mesh = generated.get(name)
        if mesh is None:
            evaluated = source.evaluated_get(graph)
            mesh = scratch.keep(bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=graph))
        shapes.append(Shape(source, not name, mesh, matrices))
    return shapes


def _prepare(scratch: Scratch, shape: Shape) -> None:
    """Gives the mesh the materials that the source's slots show."""
    slots, materials = shape.source.material_slots, shape.mesh.materials
    if not shape.own:
        return
    if len(materials) > max(1, len(slots)) or any(
        index < len(slots) and slots[index].material is None and material is not None
        for index, material in enumerate(materials)
    ):
        shape.own = False  # geometry nodes added materials that are in no slot
        return
    while len(materials) < len(slots):
        materials.append(None)
    for index, slot in enumerate(slots):
        materials[index] = slot.material


def _misses_uv(shape: Shape) -> bool:
    """Returns true if an edit needs a new UV map: there is none, or it overlaps and no image uses it."""
    base = shape.source.data if shape.own and shape.source.type == "MESH" else shape.mesh
    if not base.uv_layers:
        return True
    if any(trees.has_images(material) for material in shape.mesh.materials):
        return False
    return unwrap.overlaps(base)


def _evaluate_changed(
    scratch: Scratch, shape: Shape, needs_uv: bool, region: regions.Region | None
) -> float:
    """Evaluates a copy of the source with a UV map and the region added. Returns the region's largest weight."""
    source = shape.source
    mesh = scratch.keep(source.data.copy())
    if needs_uv:
        if len(mesh.uv_layers) >= 8:
            raise Item3dError(f"{source.name}: eight UV maps, but none that an edit can use; remove one")
        shape.uv = unwrap.unwrap(scratch, mesh, _free_name(mesh))
    largest = regions.add_attribute(region, source, mesh) if region else 0.0
    copy = scratch.keep(source.copy())
    copy.data = mesh
    scene = scratch.scene()
    scene.collection.objects.link(copy)
    with scratch.context.temp_override(scene=scene, view_layer=scene.view_layers[0]):
        graph = scratch.context.evaluated_depsgraph_get()
        changed = bpy.data.meshes.new_from_object(
            copy.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph
        )
    materials = list(shape.mesh.materials)
    shape.mesh = scratch.keep(changed)
    shape.mesh.materials.clear()
    for material in materials:
        shape.mesh.materials.append(material)
    return largest


def _free_name(mesh: bpy.types.Mesh) -> str:
    number, name = 0, unwrap.UV_NAME
    while name in mesh.uv_layers:
        number += 1
        name = f"{unwrap.UV_NAME} {number}"
    return name


def _keep_first(shape: Shape) -> None:
    """Removes all UV maps except the new one from the exported mesh, so that it becomes glTF's first."""
    wanted = shape.mesh.uv_layers[-1].name
    for layer in [layer.name for layer in shape.mesh.uv_layers if layer.name != wanted]:
        shape.mesh.uv_layers.remove(shape.mesh.uv_layers[layer])
