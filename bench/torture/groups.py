"""Memory limits by control groups (cgroups, version 1 or 2), if this user may create them."""
import os
import pathlib

ROOT = pathlib.Path("/sys/fs/cgroup")
LIMITS = ("memory.limit_in_bytes", "memory.max")
# Swap space must be limited too. Otherwise the kernel swaps out the memory beyond the limit.
SWAP_LIMITS = ("memory.memsw.limit_in_bytes", "memory.swap.max")


class MemoryGroup:
    """A control group with a memory limit. `before` is the command prefix that runs a command in the group.

    close() removes the group.
    """

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
