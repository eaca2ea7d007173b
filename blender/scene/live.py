"""Shows a running edit on its objects, and removes it again."""
from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ..core.errors import Item3dError
from ..core.glb import Glb
from ..core.job import Job
from . import slots, unwrap
from .nodes import MaterialBuilder

LIVE = "item3d_live"  # custom property of materials and images that show a running job: its folder
LIVE_UV = "item3d_live_uv"  # custom property of a mesh: the UV map that it has only to show a running edit
PREVIEW = "item3d preview"
_FIRST_IMAGE = 1_000_000  # indices from here on stand for images that are not in the .glb


class LiveView:
    """Live view of one job. It looks up all data blocks each time, because an undo may have replaced them."""

    def __init__(self, job: Job):
        self.job = job
        self.revision = 0
        self._glb: Glb | None = None

    def update(self, on_objects: bool) -> bool:
        """Shows the latest textures of the process. Returns true if there were new ones."""
        found = self.job.read_json("live/textures.json")
        revision = found.get("revision", 0)
        if revision == self.revision or not found.get("textures"):
            return False
        self.revision = revision
        files: dict[int, dict[str, Path]] = {}
        for texture in found["textures"]:
            files.setdefault(texture["material"], {})[texture["slot"]] = self.job.folder / "live" / texture["file"]
        images = {}
        for index, by_slot in files.items():
            for slot, path in by_slot.items():
                image = self._image(path, slot == "base_color")
                if image is not None:
                    images[index, slot] = image
        if images:
            show_in_editors(next(iter(images.values())))
        if on_objects:
            for index in files:
                if (index, "base_color") in images:
                    self._attach(index, images)
        return True

    def _image(self, path: Path, is_color: bool) -> bpy.types.Image | None:
        if not path.is_file():
            return None
        for image in bpy.data.images:
            if image.get(LIVE) == str(path):
                image.reload()
                return image
        image = load_image(path, is_color)
        image.name = f"{PREVIEW} {path.stem}"
        image[LIVE] = str(path)
        return image

    def _attach(self, index: int, images: dict[tuple[int, str], bpy.types.Image]) -> None:
        """Puts the live version of a material into each slot that still shows the source."""
        record = self.job.record["materials"][index]
        material = next((m for m in bpy.data.materials if m.get(LIVE) == str(self.job.folder) and m["index"] == index), None)
        if material is None:
            material = self._make(index, record, images)
        source = bpy.data.materials.get(record["source"])
        for name, slot in record["slots"]:
            thing = bpy.data.objects.get(name)
            if thing is None or thing.mode == "EDIT":
                continue
            shown = thing.material_slots[slot].material if slot < len(thing.material_slots) else None
            if shown == source and add_uv(self.job, name, is_live=True):
                slots.assign(thing, slot, material)

    def _make(self, index: int, record: dict[str, Any], images: dict[tuple[int, str], bpy.types.Image]) -> bpy.types.Material:
        if self._glb is None:
            self._glb = Glb(self.job.folder / self.job.record["model"])
        before = self._glb.materials()[index]
        textures = self._glb.json.setdefault("textures", [])
        uv = before.get("pbrMetallicRoughness", {}).get("baseColorTexture", {}).get("texCoord", 0)
        after = copy.deepcopy(before)
        pbr = after.setdefault("pbrMetallicRoughness", {})
        pbr |= {"baseColorFactor": [1, 1, 1, 1], "roughnessFactor": 1, "metallicFactor": 1}
        pictures: dict[int, bpy.types.Image] = {}
        for slot, key in (("base_color", "baseColorTexture"), ("orm", "metallicRoughnessTexture")):
            if (index, slot) in images:
                number = _FIRST_IMAGE + len(textures)
                pictures[number] = images[index, slot]
                textures.append({"source": number})
                transform = before.get("pbrMetallicRoughness", {}).get("baseColorTexture", {}).get("extensions")
                pbr[key] = {"index": len(textures) - 1, "texCoord": uv} | ({"extensions": transform} if transform else {})
        # Normals and occlusion stay those of the source.
        after.pop("occlusionTexture", None)
        after.pop("normalTexture", None)
        source = bpy.data.materials.get(record["source"])
        builder = MaterialBuilder(source, f"{record['name']} (item3d runs)", lambda at, _: pictures[at], record["uvs"])
        material = builder.build(before, after, self._glb)
        material[LIVE], material["index"] = str(self.job.folder), index
        material[slots.SOURCE] = source
        material.pop(slots.UNDO, None)
        return material


def load_image(path: Path, is_color: bool) -> bpy.types.Image:
    """Loads an image with the right colour space."""
    image = bpy.data.images.load(str(path))
    if not is_color:
        image.colorspace_settings.name = "Non-Color"
    return image


def add_uv(job: Job, name: str, is_live: bool) -> bool:
    """Gives an object's mesh the UV map that it was exported with. Returns False if that is not possible."""
    thing = bpy.data.objects.get(name)
    record = next((record for record in job.record["objects"] if record["name"] == name), None)
    if thing is None or record is None or record["uv"] is None:
        return thing is not None
    mesh = thing.data
    if len(mesh.loops) != record["loops"] or mesh.library is not None:
        return False
    wanted = record["uv"]["name"]
    is_new = wanted not in mesh.uv_layers
    if is_new and len(mesh.uv_layers) >= 8:
        return False
    try:
        values = np.load(job.folder / record["uv"]["file"])
    except (OSError, ValueError) as error:
        raise Item3dError(f"{job.folder / record['uv']['file']}: cannot be read ({error}); start it again") from error
    unwrap.set_uv(mesh, wanted, values)
    if is_live and is_new:
        mesh[LIVE_UV] = wanted
    elif not is_live and LIVE_UV in mesh:
        del mesh[LIVE_UV]
    return True


def clean(keep: set[str] | None = None) -> int:
    """Removes all live materials except those of jobs whose folders are in `keep`. Returns how many were removed."""
    keep = keep or set()
    gone = 0
    for material in [m for m in bpy.data.materials if m.get(LIVE) and m[LIVE] not in keep]:
        slots.revert(material)
        bpy.data.materials.remove(material)
        gone += 1
    if not any(m.get(LIVE) for m in bpy.data.materials):
        for mesh in bpy.data.meshes:
            name = mesh.get(LIVE_UV)
            if name and name in mesh.uv_layers:
                mesh.uv_layers.remove(mesh.uv_layers[name])
            if name:
                del mesh[LIVE_UV]
    for image in [i for i in bpy.data.images if i.get(LIVE)]:
        if not any(str(image[LIVE]).startswith(folder) for folder in keep):
            bpy.data.images.remove(image)
    return gone


def show_in_editors(image: bpy.types.Image) -> None:
    """Shows an image in those image editors that show nothing or an earlier preview."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                shown = area.spaces.active.image
                if shown is None or shown.get(LIVE) or shown.name.startswith(PREVIEW):
                    area.spaces.active.image = image
