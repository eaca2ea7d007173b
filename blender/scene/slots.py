"""Puts materials into slots in a way that can be reverted."""
from __future__ import annotations

import json
from collections.abc import Iterator

import bpy

SOURCE = "item3d_source"  # custom property of an edited material: the source material
UNDO = "item3d_undo"  # custom property, JSON: [[object, slot, "append", "link" or ""]]


def assign(thing: bpy.types.Object, index: int, material: bpy.types.Material) -> None:
    """Shows a material in a slot of this object only, and stores in the material how to revert that."""
    what = ""
    if index >= len(thing.material_slots):
        thing.data.materials.append(None)
        what = "append"
        index = len(thing.material_slots) - 1
    slot = thing.material_slots[index]
    if slot.link == "DATA" and thing.data.users > 1:
        slot.link = "OBJECT"
        what = what or "link"
    slot.material = material
    done = json.loads(material.get(UNDO, "[]"))
    material[UNDO] = json.dumps([*done, [thing.name, index, what]])


def revert(material: bpy.types.Material) -> list[str]:
    """Shows the source again in all slots of a material. Returns the names of the objects."""
    changed = []
    for name, index, what in json.loads(material.get(UNDO, "[]")):
        thing = bpy.data.objects.get(name)
        if thing is None or index >= len(thing.material_slots) or thing.material_slots[index].material != material:
            continue
        slot = thing.material_slots[index]
        slot.material = None if what == "link" else material.get(SOURCE)
        if what == "link":
            slot.link = "DATA"
        elif what == "append" and index == len(thing.material_slots) - 1:
            slot.link = "DATA"
            if thing.data.users == 1:
                thing.data.materials.pop(index=index)
                thing.data = thing.data  # updates the number of slots
        changed.append(name)
    material[UNDO] = "[]"
    return changed


def materials_of(things: list[bpy.types.Object]) -> Iterator[bpy.types.Material]:
    """Yields each material that objects show once."""
    seen = set()
    for thing in things:
        for slot in thing.material_slots:
            if slot.material is not None and slot.material.name_full not in seen:
                seen.add(slot.material.name_full)
                yield slot.material
