"""Tests of the extension's zip: Blender validates and installs it, and it works."""
from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

from . import support
from .support import BLENDER, ROOT

import bpy

WHEEL = "item3d_program-0.2.0-py3-none-manylinux_2_28_x86_64.whl"
MODULE = "import os\n\n\ndef program():\n    return os.path.join(os.path.dirname(__file__), 'bin', 'item3d')\n"
# Script for another Blender, which installs the zip, edits its cube, and prints which program it used.
SESSION = """
import os, sys, time
import bpy
bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True)
addon = bpy.context.preferences.addons["bl_ext.user_default.item3d"]
addon.preferences.program = sys.argv[2]
addon.preferences.threads = 1
from bl_ext.user_default.item3d.ui import preferences, session
settings = bpy.context.scene.item3d
settings.source, settings.target = "a gray cube", "a golden cube"
cube = bpy.data.objects["Cube"]
bpy.ops.item3d.edit()
job = session.jobs_of_file()[0]
while session.poll() is not None:
    time.sleep(0.05)
print("PROGRAM", preferences.program(bpy.context).path)
print("FOLDER", job.folder)
print("RESULT", job.state, cube.material_slots[0].material.name)
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.item3d")
print("DISABLED", hasattr(bpy.types.Scene, "item3d"))
sys.stdout.flush()
os._exit(0)
"""


def pack(folder: Path, *options: str) -> Path:
    command = [sys.executable, str(ROOT / "scripts/blender_extension.py"), str(folder), *options]
    return Path(subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip())


class Package(unittest.TestCase):
    def setUp(self) -> None:
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)

    def wheel(self) -> Path:
        """Returns a wheel with the layout of `make package`, whose program is a stand-in."""
        path = self.folder / WHEEL
        script = (BLENDER / "tests/fake_item3d.py").read_text().replace(
            "behaviour, *arguments = sys.argv[1:]", 'behaviour, arguments = "edit", sys.argv[1:]'
        )
        info = "item3d_program-0.2.0.dist-info"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("item3d_program/__init__.py", MODULE)
            archive.writestr("item3d_program/bin/item3d", script)
            archive.writestr(f"{info}/METADATA", "Metadata-Version: 2.1\nName: item3d-program\nVersion: 0.2.0\n")
            archive.writestr(f"{info}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
            archive.writestr(f"{info}/RECORD", "")
        return path

    def validate(self, archive: Path) -> None:
        """Runs the validation that `blender --command extension validate` runs."""
        scripts = Path(bpy.utils.resource_path("LOCAL")) / "scripts/addons_core/bl_pkg/cli/blender_ext.py"
        done = subprocess.run([sys.executable, str(scripts), "validate", str(archive)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def session(self, archive: Path, program: str) -> dict[str, str]:
        # This Blender reads no user settings.
        environment = {**os.environ, "BLENDER_USER_RESOURCES": str(self.folder / "user")}
        done = subprocess.run(
            [sys.executable, "-c", SESSION, str(archive), program],
            capture_output=True, text=True, env=environment, cwd=self.folder, timeout=240,
        )  # fmt: skip
        said = dict(line.split(" ", 1) for line in done.stdout.splitlines() if line.split(" ")[0].isupper() and " " in line)
        self.assertIn("RESULT", said, done.stdout[-2000:] + done.stderr[-2000:])
        return said

    def test_the_same_bytes_again_and_nothing_that_is_not_needed(self) -> None:
        first, second = pack(self.folder / "a"), pack(self.folder / "b")
        self.assertEqual(first.read_bytes(), second.read_bytes())
        names = zipfile.ZipFile(first).namelist()
        self.assertIn("blender_manifest.toml", names)
        self.assertFalse([name for name in names if "test" in name or "cache" in name])

    def test_no_module_asks_for_torch_or_the_network(self) -> None:
        for path in BLENDER.rglob("*.py"):
            if "tests" not in path.parts:
                for word in ("torch", "urllib", "requests", "socket", "http"):
                    self.assertNotRegex(path.read_text(), rf"\bimport {word}\b|\bfrom {word}\b")

    def test_blender_takes_it_and_it_works_from_there(self) -> None:
        archive = pack(self.folder)
        self.validate(archive)
        program = support.fake_program(self.folder, "edit")
        said = self.session(archive, str(program))
        self.assertEqual(said["RESULT"], "applied Material - a golden cube")
        self.assertIn("user", said["FOLDER"])
        self.assertEqual(said["DISABLED"], "False")

    def test_the_edition_that_brings_the_program(self) -> None:
        archive = pack(self.folder, "--wheel", str(self.wheel()))
        self.assertRegex(archive.name, r"^item3d-.*-linux_x64\.zip$")
        self.validate(archive)
        said = self.session(archive, "")
        self.assertIn("site-packages/item3d_program/bin/item3d", said["PROGRAM"])
        self.assertEqual(said["RESULT"], "applied Material - a golden cube")


