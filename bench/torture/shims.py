"""Builds the two LD_PRELOAD libraries for programs under test, and makes their settings."""
import mmap
import pathlib
import struct
import subprocess

HERE = pathlib.Path(__file__).resolve().parent


def build(folder):
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("faults", "journal"):
        subprocess.run(["cc", "-std=c11", "-O1", "-Wall", "-Wextra", "-shared", "-fPIC", "-o",
                        str(folder / f"{name}.so"), str(HERE / f"{name}.c"), "-ldl", "-pthread"],
                       check=True)
    return folder


class Shims:
    """The built libraries. The methods return the environment variables that load them into a program."""

    def __init__(self, folder):
        self.folder = build(folder)

    def faults(self, counter=None, **settings):
        """Loads faults.c. settings: its variables in lower case, without TORTURE_. counter: file that counts calls."""
        variables = {"LD_PRELOAD": str(self.folder / "faults.so")}
        if counter:
            counter.write_bytes(bytes(8))
            variables["TORTURE_COUNTER"] = str(counter)
        variables.update({f"TORTURE_{name.upper()}": str(value) for name, value in settings.items()})
        return variables

    def journal(self, root, folder, **settings):
        """Loads journal.c, which records `root` in `folder`; with settings, also loads faults.c."""
        variables = self.faults(**settings) if settings else {}
        objects = [str(self.folder / "journal.so")] + ([variables["LD_PRELOAD"]] if settings else [])
        return variables | {"LD_PRELOAD": ":".join(objects), "TORTURE_ROOT": str(root),
                            "TORTURE_JOURNAL": str(folder)}


def count_of(counter):
    """Returns the number of calls in a counter's file."""
    with open(counter, "r+b") as file, mmap.mmap(file.fileno(), 8) as memory:
        return struct.unpack("q", memory[:8])[0]
