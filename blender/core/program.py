"""Finds the item3d program and checks its version."""
from __future__ import annotations

import importlib.util
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from .errors import Item3dError

MIN_VERSION = (0, 2, 0)
# Options of `item3d edit` that an early build of this version may lack.
NEEDED_OPTIONS = ("--live", "--progress-file", "--region")
SECONDS_TO_ANSWER = 20
HOW_TO_GET_IT = (
    "unpack item3d's archive and choose bin/item3d in the extension's preferences, install its .deb, "
    "or build it (make)"
)


@dataclass(frozen=True)
class Program:
    """An item3d program that was run to find its version."""

    path: Path
    version: str


def candidates(extension: Path) -> Iterator[Path]:
    """Yields paths where a program may be, the likeliest first. `extension` is the extension's folder."""
    yield extension / "bin" / "item3d"
    # One edition of the extension contains the program as a wheel, which Blender unpacks.
    if importlib.util.find_spec("item3d_program") is not None:
        import item3d_program  # type: ignore[import-not-found]

        path = Path(item3d_program.program())
        _make_executable(path)
        yield path
    on_path = shutil.which("item3d")
    if on_path:
        yield Path(on_path)
    yield Path("/opt/item3d/bin/item3d")
    yield Path.home() / ".local" / "bin" / "item3d"


def find(preference: str, extension: Path) -> Program:
    """Returns the preferred program or, without a preference, the first that exists.

    Raises Item3dError if there is none, or if the one that was found is too old or broken.
    """
    if preference:
        path = Path(os.path.expanduser(preference))
        if path.is_dir():
            path = path / "item3d"
        if not path.is_file():
            raise Item3dError(f"{path}: no such program; choose another in the preferences, or leave it empty")
        return check(path)
    for path in candidates(extension):
        if path.is_file():
            return check(path)
    raise Item3dError(f"item3d: the program was not found; {HOW_TO_GET_IT}")


def _make_executable(program: Path) -> None:
    """Makes the programs of a wheel executable, because Blender does not when it unpacks a wheel."""
    if not program.is_file() or os.access(program, os.X_OK):
        return
    for path in program.parents[1].rglob("*"):
        if path.is_file():
            with open(path, "rb") as file:
                begin = file.read(4)
            if begin == b"\x7fELF" or begin[:2] == b"#!":
                path.chmod(path.stat().st_mode | 0o111)


def check(path: Path) -> Program:
    """Returns the program at a path. Raises Item3dError if it does not run or is too old."""
    return _check(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=8)
def _check(path: Path, _changed: int) -> Program:
    output = _ask(path, "--version")
    found = re.search(r"item3d (\d+)\.(\d+)\.(\d+)", output)
    if not found:
        raise Item3dError(f"{path}: prints {output.strip()[:60]!r} for --version; choose the item3d program")
    version = ".".join(found.groups())
    if tuple(int(part) for part in found.groups()) < MIN_VERSION:
        wanted = ".".join(map(str, MIN_VERSION))
        raise Item3dError(f"{path}: version {version} is too old, {wanted} or newer is needed; {HOW_TO_GET_IT}")
    options = _ask(path, "edit", "--help-all")
    missing = [option for option in NEEDED_OPTIONS if option not in options]
    if missing:
        raise Item3dError(f"{path}: too old, it has no {' and no '.join(missing)}; {HOW_TO_GET_IT}")
    return Program(path, version)


def _ask(path: Path, *arguments: str) -> str:
    try:
        answer = subprocess.run(
            [str(path), *arguments],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=SECONDS_TO_ANSWER,
            check=False,
        )
    except OSError as error:
        raise Item3dError(f"{path}: cannot be run, {error.strerror}; choose another program") from error
    except subprocess.TimeoutExpired as error:
        raise Item3dError(f"{path}: no answer in {SECONDS_TO_ANSWER} s; choose another program") from error
    if answer.returncode != 0:
        said = (answer.stderr or answer.stdout).strip().splitlines()
        what = said[-1] if said else f"exit code {answer.returncode}"
        raise Item3dError(f"{path}: cannot be used: {what}; {HOW_TO_GET_IT}")
    return answer.stdout
