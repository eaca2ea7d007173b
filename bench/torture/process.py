"""One run of a program under test, and what is wrong with how it ended."""
import dataclasses
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import time

# Messages of a process that crashed.
WRECKS = re.compile(rb"terminate called|what\(\):|Segmentation|Aborted|core dumped|Assertion|"
                    rb"Sanitizer|stack smashing|double free|corrupted|a bug of item3d")

LOADER = 127  # exit code of the system's loader if the program cannot start


def clear(path):
    """Removes a folder, or what took its place."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    elif path.exists() or path.is_symlink():
        path.unlink()


@dataclasses.dataclass
class Outcome:
    code: int  # exit code; negative: number of the signal that ended the process
    out: bytes
    error: bytes
    seconds: float
    hung: bool = False

    def errors(self):
        return [line for line in self.error.decode(errors="replace").splitlines()
                if line.startswith("item3d: ")]


class Run:
    """A program that runs in a session of its own, so that all of it can be ended."""

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
        """Ids of the processes of its session; what it starts may have groups of their own."""
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
        """Kills all of its session, and waits until nothing of it is left."""
        while members := self.members():
            for member in members:
                self.signal_one(member, signal.SIGKILL)
            self.process.poll()
            time.sleep(0.005)

    def wait(self, seconds):
        """The outcome; a program that is still there after so long is killed and has hung."""
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
    """What is wrong with an outcome: a list of sentences. codes: exit codes that may be; says: whether
    its stderr could be written, so that a line is demanded."""
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
