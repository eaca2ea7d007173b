"""Runs the tests: python -m blender.tests [NAME...], where a name is like test_core.Jobs.

The program ends without the interpreter's teardown, in which bpy 4.2 crashes if classes were registered."""
import os
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).parent
NAMES = sys.argv[1:] or sorted(path.stem for path in HERE.glob("test_*.py"))


def main() -> int:
    suite = unittest.defaultTestLoader.loadTestsFromNames([f"{__package__}.{name}" for name in NAMES])
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    return 0 if result.wasSuccessful() and result.testsRun > 0 else 1


code = main()
sys.stdout.flush()
sys.stderr.flush()
os._exit(code)
