"""Processes that continue after the Blender that started them is closed."""
from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

UNKNOWN = -1000  # exit code of a process that another Blender started
# Processes that this Blender started, by the folder that they work in.
_children: dict[str, subprocess.Popen[bytes]] = {}


def start(command: list[str], folder: Path) -> int:
    """Starts a process in its own session, in `folder`. Returns the process id. Raises OSError.

    The process's stdout goes to stdout.json. Its stderr is appended to stderr.txt.
    """
    with open(folder / "stdout.json", "wb") as out, open(folder / "stderr.txt", "ab") as err:
        child = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=out, stderr=err, cwd=folder, start_new_session=True
        )
    _children[str(folder)] = child
    return child.pid


def exit_code(folder: Path, process: int, began: str) -> int | None:
    """Returns the exit code, None while the process runs, or UNKNOWN if another Blender started it and it has ended."""
    child = _children.get(str(folder))
    if child is not None:
        return child.poll()
    return None if process and _is_alive(process) and beginning(process) == began else UNKNOWN


def end(folder: Path, process: int, began: str, number: int = signal.SIGKILL) -> None:
    """Sends a signal to a running process. After SIGKILL to a process of this Blender, waits for its end."""
    if exit_code(folder, process, began) is not None:
        return
    try:
        os.kill(process, number)
    except OSError:
        return
    child = _children.get(str(folder))
    if child is not None and number == signal.SIGKILL:
        child.wait()


def forget(folder: Path) -> None:
    _children.pop(str(folder), None)


def beginning(process: int) -> str:
    """Returns the start time of a process, which a later process of the same id does not share, or "" without /proc."""
    try:
        stat = Path(f"/proc/{process}/stat").read_text(encoding="utf-8", errors="replace")
        return stat.rpartition(")")[2].split()[19]
    except (OSError, IndexError):
        return ""


def _is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
