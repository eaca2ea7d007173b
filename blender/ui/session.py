"""Jobs that this Blender watches, including jobs of an earlier Blender that it finds when a file is opened."""
from __future__ import annotations

import os
import secrets
import threading
from pathlib import Path

import bpy

from ..core.errors import Item3dError
from ..core.job import Job, jobs_in
from ..core.program import Program
from ..core.words import Vocabulary
from ..scene import live
from ..scene.live import LiveView, load_image
from ..scene.start import Place
from . import preferences

SECONDS = 0.5  # between two polls of the jobs
_jobs: dict[str, Job] = {}
_views: dict[str, LiveView] = {}
_vocabulary = Vocabulary()
_token = secrets.token_hex(8)  # identifies the open file
_program: Program | str | None = None  # the program, or why there is none, or None before the search has ended
_looking: threading.Thread | None = None
_wanted = ""  # the preference for which the search was started


def own_folder() -> Path:
    """Returns the folder for jobs of unsaved files, which Blender reserves for this extension."""
    try:
        return Path(bpy.utils.extension_path_user(preferences.BASE, path="jobs", create=True))
    except ValueError:
        return Path(bpy.utils.user_resource("DATAFILES", path="item3d", create=True))


def folders(context: bpy.types.Context) -> list[Path]:
    """Returns the folders where jobs may be. New jobs go into the first."""
    found = []
    wanted = preferences.preferences(context).folder
    if wanted:
        found.append(Path(bpy.path.abspath(wanted)))
    if bpy.data.filepath:
        beside = Path(bpy.data.filepath).parent
        if os.access(beside, os.W_OK):
            found.append(beside / "item3d")
    return [*found, own_folder()]


def place(context: bpy.types.Context) -> Place:
    return Place(folders(context)[0], bpy.data.filepath, _token, context.scene.name)


def add(job: Job) -> None:
    """Starts to watch a job."""
    _jobs[str(job.folder)] = job
    _views[str(job.folder)] = LiveView(job)
    if not bpy.app.timers.is_registered(poll):
        bpy.app.timers.register(poll, first_interval=SECONDS, persistent=True)


def forget(job: Job) -> None:
    _jobs.pop(str(job.folder), None)
    _views.pop(str(job.folder), None)


def get(folder: str) -> Job:
    """Returns a job by its folder. Raises Item3dError if it is not known."""
    if folder not in _jobs:
        raise Item3dError(f"{folder}: no such job; start the edit again")
    return _jobs[folder]


def jobs_of_file() -> list[Job]:
    """Returns the jobs of the open file, the newest first."""
    return [job for job in reversed(list(_jobs.values())) if _is_ours(job)]


def _is_ours(job: Job) -> bool:
    blend = job.record.get("blend", "")
    if job.record.get("token") == _token:
        return True
    return bool(blend) and bool(bpy.data.filepath) and os.path.realpath(blend) == os.path.realpath(bpy.data.filepath)


def poll() -> float | None:
    """Updates all jobs. Returns the seconds until the next poll, or None if nothing is left to wait for."""
    context = bpy.context
    for job in list(_jobs.values()):
        before = job.state
        try:
            state = job.update()
        except OSError as error:  # for example a full disk; the record is still in memory
            print(f"item3d: {job.folder}: {error}")
            state = job.state
        if not _is_ours(job):
            continue
        if state == "running":
            settings = context.scene.item3d
            try:
                _views[str(job.folder)].update(settings.live)
            except (Item3dError, RuntimeError) as error:
                print(f"item3d: no live view: {error}")
        elif before == "running" and state in ("failed", "cancelled"):
            live.clean(keep=running_folders())
        elif state == "done" and not job.message:
            _finish(job, context)
    _redraw(context)
    waiting = any(job.state == "running" or job.state == "done" and not job.message for job in _jobs.values())
    return SECONDS if waiting else None


def _finish(job: Job, context: bpy.types.Context) -> None:
    """Applies a result as one undo step, or leaves it for the Apply button."""
    preview = job.folder / "out" / "preview.png"
    if preview.is_file() and not job.record.get("seen"):
        job.record["seen"] = True
        image = load_image(preview, True)
        image.name = live.PREVIEW
        live.show_in_editors(image)
    if not context.scene.item3d.apply_when_done:
        job.mark("done", "finished; Apply shows it")
        return
    if any(thing.mode == "EDIT" for thing in context.scene.objects):
        return  # the next poll tries again; the user must leave edit mode first
    try:
        window = context.window_manager.windows[0]
        with context.temp_override(window=window, screen=window.screen):
            bpy.ops.item3d.apply_result("EXEC_DEFAULT", True, folder=str(job.folder))
    except RuntimeError as error:
        job.mark("done", str(error).strip().removeprefix("Error: "))


def running_folders() -> set[str]:
    return {folder for folder, job in _jobs.items() if job.state == "running"}


def adopt(context: bpy.types.Context) -> int:
    """Finds running and finished jobs of the file that was opened. Returns their number."""
    found = 0
    for parent in folders(context):
        for job in jobs_in(parent):
            if str(job.folder) in _jobs or job.state in ("applied", "new"):
                continue
            if _is_ours(job):
                add(job)
                found += 1
    return found


def file_opened() -> None:
    """Handles the opening of a file: finds its jobs, and removes live views of jobs that have ended."""
    global _token
    _token = secrets.token_hex(8)
    for view in _views.values():
        view.revision = 0
    adopt(bpy.context)
    live.clean(keep=running_folders())


def file_saved() -> None:
    """Handles the saving of a file: gives its path to jobs that began under another path or none."""
    for job in _jobs.values():
        if job.record.get("token") == _token and job.record.get("blend") != bpy.data.filepath:
            job.record["blend"] = bpy.data.filepath
            if job.folder.is_dir():
                job.save()


def words(context: bpy.types.Context, prior: str) -> list[str]:
    """Returns the words of a prior, or [] while they are not known yet."""
    found = program_state(context)
    return _vocabulary.ask(found, prior) if isinstance(found, Program) else []


def program_state(context: bpy.types.Context) -> Program | str | None:
    """Returns the program, why there is none, or None while a thread searches, because panels must not wait."""
    global _looking, _wanted, _program
    wanted = preferences.preferences(context).program
    if _looking is None or wanted != _wanted:
        _program, _wanted = None, wanted
        _looking = threading.Thread(target=_look, args=(wanted,), daemon=True)
        _looking.start()
    return _program


def look_again() -> None:
    """Discards the found program, so that the next call searches again."""
    global _program, _looking
    _program, _looking = None, None


def _look(wanted: str) -> None:
    global _program
    found: Program | str
    try:
        found = preferences.find(wanted, preferences.EXTENSION)
    except Item3dError as error:
        found = str(error)
    if wanted == _wanted:
        _program = found


def _redraw(context: bpy.types.Context) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in ("VIEW_3D", "IMAGE_EDITOR"):
                area.tag_redraw()
