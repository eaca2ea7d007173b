"""Writes chosen objects, and nothing else, as a .glb. Collects the data with which an edit is brought back."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from ..core.errors import Item3dError
from ..core.glb import Glb
from . import trees
from .collect import MOST_INSTANCES, Shape, collect
from .region import Region
from .scratch import Scratch


def export(scratch: Scratch, chosen: list[bpy.types.Object], region: Region, folder: Path) -> dict[str, Any]:
    """Writes a .glb into a folder, named after the first object. Returns the export's part of the job's record:

        model       the file's name
        objects     for each shape: name, loops and polygons of the mesh, uv (name and file of a UV map to add), back
                    (true if slots can show the result)
        materials   by glTF's index: name, source, uvs (names of UV maps), slots ([object, slot])
        notes       lines for the user
    """
    shapes = collect(scratch, chosen, region)
    scene = scratch.scene()
    owners = _own_materials(scratch, shapes)
    for index, shape in enumerate(shapes):
        _place(scratch, scene, shape, node_name(index))
    path = folder / (_file_name(chosen) + ".glb")
    _write(scratch, scene, path)
    glb = Glb(path)
    record = {
        "model": path.name,
        "objects": [_object_record(shape, index, folder) for index, shape in enumerate(shapes)],
        "materials": [_material_record(material, owners) for material in glb.materials()],
    }
    return record | {"notes": _notes(shapes, glb, owners)}


def _file_name(chosen: list[bpy.types.Object]) -> str:
    name = "".join(c if c.isalnum() or c in "-_" else "_" for c in chosen[0].name).strip("_")
    return name or "model"


def _own_materials(scratch: Scratch, shapes: list[Shape]) -> dict[str, dict[str, Any]]:
    """Gives each shape materials that an edit can tell apart. Returns them by their names in the file.

    If several shapes share a material without images, all of them would use the same texels, so each shape gets a
    copy. A slot without a material gets a gray one.
    """
    users: dict[str, int] = {}
    for shape in shapes:
        for name in {material.name_full for material in shape.mesh.materials if material}:
            users[name] = users.get(name, 0) + 1
    owners: dict[str, dict[str, Any]] = {}
    for shape in shapes:
        if not shape.mesh.materials:
            shape.mesh.materials.append(None)
        for index, source in enumerate(shape.mesh.materials):
            material = source
            if material is None:
                material = scratch.keep(bpy.data.materials.new(shape.source.name))
            elif users[material.name_full] > 1 and not trees.has_images(material):
                material = scratch.keep(material.copy())
                material.name = f"{source.name} {shape.source.name}"
            shape.mesh.materials[index] = material
            uvs = [layer.name for layer in shape.mesh.uv_layers]
            owner = owners.setdefault(material.name, {"source": source.name if source else "", "uvs": uvs, "slots": []})
            if shape.goes_back:
                owner["slots"].append([shape.source.name, index])
    return owners


def node_name(index: int) -> str:
    """Returns the name of a shape's nodes. Blender appends a number for further instances."""
    return f"shape {index}"


def _place(scratch: Scratch, scene: bpy.types.Scene, shape: Shape, name: str) -> None:
    for matrix in shape.matrices:
        mesh = shape.mesh
        composed = Matrix.LocRotScale(*matrix.decompose())
        if max(abs(a - b) for row, other in zip(matrix, composed) for a, b in zip(row, other)) > 1e-4:
            # A glTF node has only translation, rotation and scale, so a sheared matrix goes into the mesh.
            mesh = scratch.keep(shape.mesh.copy())
            mesh.transform(matrix)
            if matrix.is_negative:
                mesh.flip_normals()
            matrix = Matrix.Identity(4)
        thing = scratch.keep(bpy.data.objects.new(name, mesh))
        scene.collection.objects.link(thing)
        thing.matrix_world = matrix


def _write(scratch: Scratch, scene: bpy.types.Scene, path: Path) -> None:
    if not hasattr(bpy.types, "EXPORT_SCENE_OT_gltf"):
        raise Item3dError("the add-on glTF 2.0 is disabled; enable it in Blender's preferences")
    try:
        with scratch.context.temp_override(scene=scene, view_layer=scene.view_layers[0]):
            bpy.ops.export_scene.gltf(
                filepath=str(path),
                export_format="GLB",
                use_active_scene=True,
                export_yup=True,
                export_apply=False,
                export_attributes=True,
                export_animations=False,
                export_cameras=False,
                export_lights=False,
                export_extras=False,
            )
    except RuntimeError as error:
        raise Item3dError(f"{path}: the glTF exporter failed: {str(error).strip().splitlines()[-1]}") from error
    if not path.is_file():
        raise Item3dError(f"{path}: the glTF exporter wrote nothing; check the objects' meshes")


def _object_record(shape: Shape, index: int, folder: Path) -> dict[str, Any]:
    record: dict[str, Any] = {"name": shape.source.name, "back": shape.goes_back, "uv": None}
    if shape.goes_back:
        mesh = shape.source.data
        record |= {"loops": len(mesh.loops), "polygons": len(mesh.polygons)}
        if shape.uv is not None:
            file = f"uv_{index}.npy"
            np.save(folder / file, shape.uv)
            record["uv"] = {"name": shape.mesh.uv_layers[0].name, "file": file}
    return record


def _material_record(material: dict[str, Any], owners: dict[str, dict[str, Any]]) -> dict[str, Any]:
    owner = owners.get(material.get("name", ""), {"source": "", "uvs": [], "slots": []})
    return {"name": material.get("name", ""), **owner}


def _notes(shapes: list[Shape], glb: Glb, owners: dict[str, dict[str, Any]]) -> list[str]:
    notes = []
    for material in glb.materials():
        source = owners.get(material.get("name", ""), {}).get("source", "")
        if trees.is_procedural(bpy.data.materials.get(source), material):
            notes.append(f"{source}: its nodes were exported as a plain colour; bake them to an image to keep them")
    for shape in shapes:
        if not shape.goes_back:
            notes.append(f"{shape.source.name}: {shape.obstacle}; the result becomes a separate object")
        if len(shape.matrices) >= MOST_INSTANCES:
            notes.append(f"{shape.source.name}: only the first {MOST_INSTANCES} instances are exported")
    return list(dict.fromkeys(notes))

