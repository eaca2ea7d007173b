"""Brings the result of an edit back, as new materials in the slots of the objects."""
from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bpy

from ..core.errors import Item3dError
from ..core.glb import Glb
from ..core.job import Job
from . import live, slots
from .export import node_name
from .nodes import MaterialBuilder

SETTINGS = "item3d"  # custom property of an edited material
_CLAIMED = ("from", "to", "seed", "prior", "prior_hash", "method", "version", "date")


@dataclass
class Applied:
    """Names of what an applied result changed."""

    materials: list[str] = field(default_factory=list)
    objects: list[str] = field(default_factory=list)
    unchanged: list[str] = field(default_factory=list)


def apply(job: Job) -> Applied:
    """Creates the edited materials and shows them. If it cannot, raises Item3dError and changes nothing."""
    result = job.result()
    before, after = Glb(job.folder / job.record["model"]), Glb(job.folder / "out" / "model.glb")
    if len(before.materials()) > len(after.materials()):
        raise Item3dError(f"{after.path}: has fewer materials than were exported; start it again")
    _check_objects(job)
    live.clean(keep=_others(job))
    applied = Applied()
    pictures = _Pictures(after, job.folder / "textures")
    changed = set()
    for index, record in enumerate(job.record["materials"]):
        if before.signature(index) == after.signature(index):
            applied.unchanged.append(record["name"])
            continue
        changed.add(record["name"])
        if record["slots"]:
            _put(job, result, index, before, after, pictures, applied)
    pictures.drop_unused()
    if any(not record["back"] for record in job.record["objects"]) and changed:
        _import_objects(job, result, after.path, applied)
    return applied


def _others(job: Job) -> set[str]:
    """Returns the folders of other jobs that are shown live."""
    return {m[live.LIVE] for m in bpy.data.materials if m.get(live.LIVE)} - {str(job.folder)}


def _check_objects(job: Job) -> None:
    for record in job.record["objects"]:
        thing = bpy.data.objects.get(record["name"])
        if not record["back"]:
            continue
        if thing is None:
            raise Item3dError(f"{record['name']}: the object no longer exists; restore its name and apply again")
        if thing.mode == "EDIT":
            raise Item3dError(f"{record['name']}: in edit mode; leave edit mode and apply again")
        mesh = thing.data
        if record["uv"] is not None and (len(mesh.loops), len(mesh.polygons)) != (record["loops"], record["polygons"]):
            raise Item3dError(
                f"{record['name']}: {len(mesh.polygons)} faces now, but {record['polygons']} when the edit was started, so its "
                "new UV map does not fit; undo that change and apply again, or start again"
            )


class _Pictures:
    """Images of a result. Each is read once and packed, so that the job's folder may be deleted."""

    def __init__(self, glb: Glb, folder: Path):
        self._glb, self._folder = glb, folder
        self._loaded: dict[tuple[int, bool], bpy.types.Image] = {}

    def __call__(self, index: int, is_color: bool) -> bpy.types.Image:
        if (index, is_color) not in self._loaded:
            path = self._glb.write_image(index, self._folder)
            image = live.load_image(path, is_color)
            image.pack()
            image.filepath_raw = f"//textures/{path.name}"
            self._loaded[index, is_color] = image
        return self._loaded[index, is_color]

    def drop_unused(self) -> None:
        """Removes images that no node uses, because they have one pixel, whose value the nodes hold."""
        for image in self._loaded.values():
            if image.users == 0:
                bpy.data.images.remove(image)


def _put(
    job: Job, result: dict[str, Any], index: int, before: Glb, after: Glb, pictures: _Pictures, applied: Applied
) -> None:
    record = job.record["materials"][index]
    source = bpy.data.materials.get(record["source"])
    name = f"{record['name']} - {result.get('to', '')}"[:60]
    builder = MaterialBuilder(source, name, pictures, record["uvs"])
    material = builder.build(before.materials()[index], after.materials()[index], after)
    note_settings(material, result)
    material[slots.SOURCE] = source
    material.pop(slots.UNDO, None)
    if source is not None:
        source.use_fake_user = True
    for thing_name, slot in record["slots"]:
        thing = bpy.data.objects[thing_name]
        live.add_uv(job, thing_name, is_live=False)
        slots.assign(thing, slot, material)
        if thing_name not in applied.objects:
            applied.objects.append(thing_name)
    applied.materials.append(material.name)


def note_settings(block: bpy.types.ID, result: dict[str, Any]) -> None:
    """Writes an edit's record into custom properties: readable facts one by one, and all settings as JSON."""
    claim = result.get("claim", {})
    noted = {key: result.get(key, claim.get(key)) for key in _CLAIMED}
    noted = {key: value for key, value in noted.items() if value is not None}
    # Integers of custom properties have 32 bits, so the seed is a text.
    noted["seed"] = str(noted.get("seed", 0))
    noted["settings"] = json.dumps(result.get("settings", {}), sort_keys=True)
    block[SETTINGS] = noted


def _import_objects(job: Job, result: dict[str, Any], path: Path, applied: Applied) -> None:
    """Imports the objects to which the materials cannot go back, into a new collection."""
    others = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=str(path), merge_vertices=True)
    imported = [thing for thing in bpy.data.objects if thing not in others]
    collection = bpy.data.collections.new(f"item3d {result.get('to', '')}"[:60])
    bpy.context.scene.collection.children.link(collection)
    names = {node_name(index): record for index, record in enumerate(job.record["objects"])}
    for thing in imported:
        record = names.get(thing.name.partition(".")[0])
        if record is None or record["back"]:
            mesh = thing.data
            bpy.data.objects.remove(thing)
            if mesh is not None and mesh.users == 0:
                bpy.data.meshes.remove(mesh)
            continue
        for old in list(thing.users_collection):
            old.objects.unlink(thing)
        collection.objects.link(thing)
        thing.name = f"{record['name']} - {result.get('to', '')}"[:60]
        applied.objects.append(thing.name)
    for material in slots.materials_of(list(collection.objects)):
        note_settings(material, result)
        applied.materials.append(material.name)


def restore(things: list[bpy.types.Object]) -> list[str]:
    """Shows the source materials on objects again. Returns the names of the objects that changed."""
    changed: list[str] = []
    for material in list(slots.materials_of(things)):
        if SETTINGS in material:
            changed += slots.revert(material)
            material.use_fake_user = True
    return changed
