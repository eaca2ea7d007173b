"""Groups of the kernel that limit memory (cgroups, version 1 or 2), where this user may make them."""
import os
import pathlib

ROOT = pathlib.Path("/sys/fs/cgroup")
LIMITS = ("memory.limit_in_bytes", "memory.max")
# Limits of the swap space; without them the memory beyond the limit is swapped out.
SWAP_LIMITS = ("memory.memsw.limit_in_bytes", "memory.swap.max")


class MemoryGroup:
    """A group with a limit; `before` runs a command in it. close() removes it."""

    def __init__(self, limit):
        base = ROOT / "memory" if (ROOT / "memory").is_dir() else ROOT
        self.folder = base / f"item3d-torture-{os.getpid()}"
        self.folder.mkdir(exist_ok=True)
        try:
            self.write(LIMITS, limit)
            self.write(SWAP_LIMITS, limit if base != ROOT else 0, needed=False)
        except OSError:
            self.close()
            raise
        self.before = ("bash", "-c", f'echo $$ > {self.folder}/cgroup.procs && exec "$0" "$@"')

    def write(self, names, value, needed=True):
        for name in names:
            if (self.folder / name).exists():
                (self.folder / name).write_text(str(value))
                return
        if needed:
            raise OSError(f"{self.folder} limits no memory")

    def close(self):
        try:
            self.folder.rmdir()
        except OSError:
            pass


def can_limit():
    try:
        MemoryGroup(1 << 30).close()
    except OSError:
        return False
    return True
