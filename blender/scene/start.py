"""Starts an edit or a relighting of chosen objects."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import bpy

from ..core.command import EditSettings, Machine, RelightSettings, check_sentences, edit_arguments, relight_arguments
from ..core.errors import Item3dError
from ..core.job import Job
from ..core.program import Program
from . import region as regions
from .export import export
from .scratch import Scratch


@dataclass(frozen=True)
class Place:
    """The folder for jobs, and the file that they belong to."""

    parent: Path
    blend: str  # path of the file; "" if it was never saved
    token: str  # identifies the file while it is open
    scene: str


def start_edit(
    context: bpy.types.Context,
    chosen: list[bpy.types.Object],
    settings: EditSettings,
    region: regions.Region,
    program: Program,
    machine: Machine,
    place: Place,
) -> Job:
    """Exports the objects and starts `item3d edit`. If it cannot, raises Item3dError and leaves no files."""
    check_sentences(settings.source, settings.target)
    regions.check(region)

    def arguments(job: Job, scratch: Scratch, record: dict[str, Any]) -> list[str]:
        told = replace(
            settings,
            regions=settings.regions + regions.selectors(region, scratch, job.folder),
            materials=settings.materials + _material_names(region, record),
            feather=region.feather,
        )
        return edit_arguments(told, job.folder / record["model"], job.folder, machine)

    return _start(context, chosen, region, program, place, "edit", settings.target.strip(), arguments)


def start_relight(
    context: bpy.types.Context,
    chosen: list[bpy.types.Object],
    settings: RelightSettings,
    program: Program,
    machine: Machine,
    place: Place,
) -> Job:
    """Exports the objects and starts `item3d relight`, whose light becomes the scene's world."""
    title = {"preset": settings.preset, "sky": f"sky at {settings.hour:g}", "lit": settings.lit}.get(
        settings.kind, settings.target
    )

    def arguments(job: Job, _: Scratch, record: dict[str, Any]) -> list[str]:
        return relight_arguments(settings, job.folder / record["model"], job.folder, machine)

    return _start(context, chosen, regions.Region(), program, place, "relight", title.strip(), arguments)


def _start(
    context: bpy.types.Context,
    chosen: list[bpy.types.Object],
    region: regions.Region,
    program: Program,
    place: Place,
    kind: str,
    title: str,
    arguments: Callable[[Job, Scratch, dict[str, Any]], list[str]],
) -> Job:
    job = Job.create(
        place.parent,
        chosen[0].name if chosen else "object",
        {"kind": kind, "title": title, "blend": place.blend, "token": place.token, "scene": place.scene},
    )
    try:
        with Scratch(context) as scratch:
            record = export(scratch, chosen, region, job.folder)
            told = arguments(job, scratch, record)
        job.record |= record
        job.start(program, told)
    except BaseException:
        job.remove()
        raise
    return job


def _material_names(region: regions.Region, record: dict[str, Any]) -> list[str]:
    """Returns the chosen material's names in the exported file, where each object that shares it has its own."""
    if region.kind != "MATERIAL":
        return []
    names = [material["name"] for material in record["materials"] if material["source"] == region.name]
    if not names:
        there = ", ".join(sorted({material["source"] for material in record["materials"] if material["source"]}))
        raise Item3dError(f"{region.name}: no face of the selected objects has this material; they have {there or 'none'}")
    return names
