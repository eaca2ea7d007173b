"""Jobs: item3d processes with folders of their own, which continue after the Blender that started them is closed."""
from __future__ import annotations

import json
import shutil
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from . import process
from .errors import Item3dError
from .program import Program

RECORD = "job.json"
FORMAT = "item3d blender job 1"
SECONDS_TO_STOP = 15


class Job:
    """A job's folder with its state, and its process.

    `record` has all that must be known after Blender is closed: `kind` (edit or relight), `state` (running, done,
    failed, cancelled, applied), `message`, `blend`, `scene`, `process`, `began` (the start of the process),
    `arguments`, and the exporter's data, from which the result finds its objects again.
    """

    def __init__(self, folder: Path, record: dict[str, Any]):
        self.folder = folder
        self.record = record
        self._asked_to_stop = 0.0

    @classmethod
    def create(cls, parent: Path, name: str, record: dict[str, Any]) -> Job:
        """Creates a job with a new folder. Raises Item3dError if the folder cannot be written."""
        stem = "".join(c if c.isalnum() or c in "-_" else "_" for c in name)[:40] or "object"
        stamp = time.strftime("%Y%m%d-%H%M%S")
        try:
            parent.mkdir(parents=True, exist_ok=True)
            for attempt in range(1000):
                folder = parent / (f"{stem}-{stamp}" + (f"-{attempt}" if attempt else ""))
                try:
                    folder.mkdir()
                    break
                except FileExistsError:
                    continue
            job = cls(folder, {"format": FORMAT, "state": "new", "message": "", **record})
            job.save()
            return job
        except OSError as error:
            raise Item3dError(
                f"{parent}: cannot be written, {error.strerror}; choose a folder in the preferences"
            ) from error

    @classmethod
    def load(cls, folder: Path) -> Job:
        """Reads a job's record. Raises Item3dError if there is none."""
        try:
            record = json.loads((folder / RECORD).read_text(encoding="utf-8"))
            if not isinstance(record, dict) or record.get("format") != FORMAT:
                raise ValueError(f"not a {FORMAT}")
        except (OSError, ValueError) as error:
            raise Item3dError(f"{folder / RECORD}: cannot be read ({error}); start the edit again") from error
        return cls(folder, record)

    def save(self) -> None:
        """Replaces the record's file atomically."""
        temporary = self.folder / (RECORD + ".tmp")
        temporary.write_text(json.dumps(self.record, indent=1), encoding="utf-8")
        temporary.replace(self.folder / RECORD)

    @property
    def state(self) -> str:
        return str(self.record["state"])

    @property
    def message(self) -> str:
        return str(self.record["message"])

    def start(self, program: Program, arguments: list[str]) -> None:
        """Starts the process in its own session, so that closing Blender does not end it."""
        (self.folder / "live").mkdir(exist_ok=True)
        try:
            number = process.start([str(program.path), *arguments], self.folder)
        except OSError as error:
            raise Item3dError(f"{program.path}: cannot be started, {error.strerror}; check the program") from error
        self._asked_to_stop = 0.0
        self.record |= {
            "state": "running",
            "message": "",
            "program": str(program.path),
            "program_version": program.version,
            "arguments": arguments,
            "process": number,
            "began": process.beginning(number),
        }
        self.save()

    def update(self) -> str:
        """Updates the record from the process and the folder. Returns the state."""
        if self.state != "running":
            return self.state
        if not (self.folder / RECORD).is_file():
            self._kill()
            self.record |= {"state": "failed", "message": f"{self.folder}: deleted while item3d was running; start it again"}
            return self.state
        code = self._exit_code()
        if code is None:
            if self._asked_to_stop and time.monotonic() - self._asked_to_stop > SECONDS_TO_STOP:
                self._kill()
            return self.state
        if self.has_result() and code in (0, process.UNKNOWN):
            self._end("done", "")
        elif self.record.get("cancelling"):
            self._end("cancelled", "cancelled")
        else:
            self._end("failed", self._complaint(code))
        return self.state

    def cancel(self) -> None:
        """Asks the process to write its checkpoint and to stop. If it does not, update() ends it."""
        if self.state != "running":
            return
        self.record["cancelling"] = True
        self._asked_to_stop = time.monotonic()
        self._signal(signal.SIGINT)

    def resume(self, program: Program) -> None:
        """Continues from the checkpoint. Raises Item3dError if there is none."""
        if not (self.folder / "out" / "checkpoint.safetensors").is_file():
            raise Item3dError(f"{self.folder}: no checkpoint to continue from; start it again")
        self.record.pop("cancelling", None)
        arguments = [argument for argument in self.record["arguments"] if argument != "--resume"]
        self.start(program, [*arguments, "--resume"])

    def mark(self, state: str, message: str = "") -> None:
        """Records a state that does not follow from the process, such as applied."""
        self._end(state, message)

    def remove(self) -> None:
        """Ends the process and deletes the folder."""
        if self.state == "running":
            self._kill()
        process.forget(self.folder)
        shutil.rmtree(self.folder, ignore_errors=True)

    def has_result(self) -> bool:
        out = self.folder / "out"
        return (out / f"{self.record['kind']}.json").is_file() and (out / "model.glb").is_file()

    def result(self) -> dict[str, Any]:
        """Returns the result's record (edit.json or relight.json). Raises Item3dError if it cannot be read."""
        path = self.folder / "out" / f"{self.record['kind']}.json"
        try:
            found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
            return found
        except (OSError, ValueError) as error:
            raise Item3dError(f"{path}: cannot be read ({error}); start it again") from error

    def read_json(self, name: str) -> dict[str, Any]:
        """Returns the content of a file that the process rewrites, or {} while there is none."""
        try:
            found = json.loads((self.folder / name).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return found if isinstance(found, dict) else {}

    def warnings(self) -> list[str]:
        """Returns the program's warnings."""
        lines = self._said()
        return [line.removeprefix("warning: ") for line in lines if line.startswith("warning: ")]

    def _said(self) -> list[str]:
        try:
            text = (self.folder / "stderr.txt").read_text(encoding="utf-8", errors="replace")
        except OSError:
            return []
        return [line.strip() for line in text.replace("\r", "\n").splitlines() if line.strip()]

    def _complaint(self, code: int) -> str:
        errors = [line for line in self._said() if "error: " in line]
        if errors:
            return errors[-1].removeprefix("item3d: error: ")
        if code < 0 and code != process.UNKNOWN:
            name = signal.Signals(-code).name
            return f"item3d was ended by {name}; continue it, or see {self.folder / 'stderr.txt'}"
        said = self._said()
        return f"item3d wrote no result ({said[-1] if said else 'no message'}); see {self.folder / 'stderr.txt'}"

    def _exit_code(self) -> int | None:
        return process.exit_code(self.folder, self.record.get("process", 0), self.record.get("began", ""))

    def _signal(self, number: int) -> None:
        process.end(self.folder, self.record.get("process", 0), self.record.get("began", ""), number)

    def _kill(self) -> None:
        self._signal(signal.SIGKILL)

    def _end(self, state: str, message: str) -> None:
        self.record |= {"state": state, "message": message}
        if self.folder.is_dir():
            self.save()


def jobs_in(parent: Path) -> Iterator[Job]:
    """Yields the jobs whose folders are in `parent`, ordered by the folders' names."""
    if not parent.is_dir():
        return
    for folder in sorted(parent.iterdir(), key=lambda path: path.name):
        if (folder / RECORD).is_file():
            try:
                yield Job.load(folder)
            except Item3dError:
                continue
