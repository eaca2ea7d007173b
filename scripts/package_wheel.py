#!/usr/bin/env python3
"""Writes a wheel with the program, so that pip can install it.

usage: package_wheel.py TREE VERSION OUT     TREE: the folder of scripts/package.sh with bin/, lib/ and share/

The wheel puts `item3d` on PATH. Python code gets the path of the program from item3d_program.program()."""
import base64
import hashlib
import os
import sys
import zipfile

TAG = 'py3-none-manylinux_2_28_x86_64'
MODULE = '''"""The item3d program. program() is its path; `item3d` and `python -m item3d_program` start it."""
import os
import sys


def program():
    """Returns the path of the executable."""
    return os.path.join(os.path.dirname(os.path.abspath(__file__)), "bin", "item3d")


def main():
    """Becomes the program, with this process's arguments."""
    os.execv(program(), ["item3d", *sys.argv[1:]])
'''
METADATA = '''Metadata-Version: 2.1
Name: item3d-program
Version: {version}
Summary: Edits the look of textured 3D models from two sentences
License: Apache-2.0
Requires-Python: >=3.8
'''


class Wheel:
    """A zip file that also collects the entries of the wheel's RECORD file."""

    def __init__(self, path):
        self.zip = zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED, compresslevel=9)
        self.records = []

    def add(self, name, content, executable=False):
        info = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
        info.compress_type = zipfile.ZIP_DEFLATED
        info.external_attr = (0o100755 if executable else 0o100644) << 16
        self.zip.writestr(info, content)
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b'=').decode()
        self.records.append(f'{name},sha256={digest},{len(content)}')

    def close(self, record):
        self.zip.writestr(record, '\n'.join([*self.records, f'{record},,']) + '\n')
        self.zip.close()


def main(tree, version, out):
    info = f'item3d_program-{version}.dist-info'
    wheel = Wheel(os.path.join(out, f'item3d_program-{version}-{TAG}.whl'))
    wheel.add('item3d_program/__init__.py', MODULE.encode())
    wheel.add('item3d_program/__main__.py', b'from item3d_program import main\n\nmain()\n')
    for folder, folders, names in os.walk(tree):
        folders.sort()
        for name in sorted(names):
            path = os.path.join(folder, name)
            with open(path, 'rb') as file:
                wheel.add(f'item3d_program/{os.path.relpath(path, tree)}', file.read(), os.access(path, os.X_OK))
    wheel.add(f'{info}/METADATA', METADATA.format(version=version).encode())
    wheel.add(f'{info}/WHEEL', f'Wheel-Version: 1.0\nGenerator: item3d\nRoot-Is-Purelib: false\nTag: {TAG}\n'.encode())
    wheel.add(f'{info}/entry_points.txt', b'[console_scripts]\nitem3d = item3d_program:main\n')
    wheel.close(f'{info}/RECORD')


if __name__ == '__main__':
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
