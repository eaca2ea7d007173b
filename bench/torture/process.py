"""Runs a program under test and judges how it ended."""
import dataclasses
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import time

# Messages that a crashed process prints.
WRECKS = re.compile(rb"terminate called|what\(\):|Segmentation|Aborted|core dumped|Assertion|"
                    rb"Sanitizer|stack smashing|double free|corrupted|a bug of item3d")

LOADER = 127  # exit code of the dynamic loader if the program cannot start


def clear(path):
    """Removes a folder, or a file or link at its place."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    elif path.exists() or path.is_symlink():
        path.unlink()


@dataclasses.dataclass
class Outcome:
    """How a run ended."""

    code: int  # exit code, or the negative number of the signal that ended the process
    out: bytes
    error: bytes
    seconds: float
    hung: bool = False

    def errors(self):
        return [line for line in self.error.decode(errors="replace").splitlines()
                if line.startswith("item3d: ")]


class Run:
    """A program that runs in its own session, so that all of its processes can be killed."""

    def __init__(self, arguments, folder, environment=None, stdout=None, limits=(), before=()):
        folder.mkdir(parents=True, exist_ok=True)
        self.log = folder
        self.out = open(stdout or folder / "stdout", "wb", buffering=0)
        self.error = open(folder / "stderr", "wb", buffering=0)
        self.begin = time.monotonic()

        def prepare():
            for what, value in limits:
                resource.setrlimit(what, (value, value))

        self.process = subprocess.Popen(
            [*before, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=self.out,
            stderr=self.error, env=os.environ | (environment or {}), start_new_session=True,
            preexec_fn=prepare if limits else None)

    def members(self):
        """Returns the ids of all processes in the program's session, in any process group."""
        found = []
        for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
            try:
                fields = path.read_text().rpartition(")")[2].split()
            except OSError:
                continue
            if fields[0] != "Z" and int(fields[3]) == self.process.pid:
                found.append(int(path.parent.name))
        return found

    @staticmethod
    def signal_one(process, number):
        try:
            os.kill(process, number)
        except ProcessLookupError:
            pass

    def end(self):
        """Kills all processes of the session, and waits until none is left."""
        while members := self.members():
            for member in members:
                self.signal_one(member, signal.SIGKILL)
            self.process.poll()
            time.sleep(0.005)

    def wait(self, seconds):
        """Returns the outcome. A program that still runs after `seconds` is killed and counts as hung."""
        hung = False
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            hung = True
        self.end()
        self.process.wait()
        self.out.close()
        self.error.close()
        path = self.log / "stdout"
        return Outcome(self.process.returncode, path.read_bytes() if path.exists() else b"",
                       (self.log / "stderr").read_bytes(), time.monotonic() - self.begin, hung)


def run(arguments, folder, seconds=120, **options):
    return Run(arguments, pathlib.Path(folder), **options).wait(seconds)


def faults_of(outcome, codes, signals=(), says=True):
    """Returns a list of sentences about what is wrong with an outcome.

    codes: allowed exit codes. signals: signals that may have ended the process. says: True if stderr was writable, so
    that a failed run must have printed one line of error.
    """
    found = []
    if outcome.hung:
        found.append(f"hung: {outcome.seconds:.0f} s")
        return found
    if outcome.code < 0:
        name = signal.Signals(-outcome.code).name
        if -outcome.code not in signals:
            found.append(f"died of {name}")
    elif outcome.code not in codes:
        found.append(f"exit code {outcome.code}, not {sorted(codes)}")
    if says and WRECKS.search(outcome.error):
        found.append("says: " + WRECKS.search(outcome.error)[0].decode())
    lines = outcome.errors()
    if outcome.code == LOADER:
        return found if b"error while loading shared libraries" in outcome.error else [*found, "127"]
    if outcome.code > 0 and len(lines) != 1 and says:
        found.append(f"{len(lines)} lines of error with exit code {outcome.code}")
    return found
