#!/usr/bin/env python3
"""Packs the folder blender/ as a Blender extension. Needs neither Blender nor the network.

usage: scripts/blender_extension.py OUT [--wheel FILE]     OUT: folder for the extension

    item3d-VERSION.zip               extension without the program, which it looks for on the machine
    item3d-VERSION-linux_x64.zip     with --wheel: extension with the program, from the wheel of `make package`

Equal inputs give equal bytes."""
import argparse
import pathlib
import re
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
SOURCE = ROOT / "blender"
LEFT_OUT = {"tests", "__pycache__"}


def files():
    """Yields the name and contents of each file of the extension, in a fixed order."""
    for path in sorted(SOURCE.rglob("*")):
        parts = path.relative_to(SOURCE).parts
        if path.is_file() and not LEFT_OUT & set(parts) and not any(part.startswith(".") for part in parts):
            yield "/".join(parts), path.read_bytes()
    yield "LICENSE", (ROOT / "LICENSE").read_bytes()


def with_wheel(manifest, wheel):
    """Returns the manifest of an extension with the program's wheel."""
    lines = f'platforms = ["linux-x64"]\nwheels = ["./wheels/{wheel.name}"]\n\n[permissions]'
    changed = manifest.replace("[permissions]", lines, 1)
    if changed == manifest:
        raise SystemExit("blender_manifest.toml: has no [permissions] to put wheels before")
    return changed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=pathlib.Path, help="folder for the extension")
    parser.add_argument("--wheel", type=pathlib.Path,
                        help="wheel of the program, item3d_program-....whl from `make package`")
    options = parser.parse_args()
    manifest = (SOURCE / "blender_manifest.toml").read_text()
    version = re.search(r'^version = "(.*)"', manifest, re.MULTILINE).group(1)
    if options.wheel and not options.wheel.is_file():
        raise SystemExit(f"{options.wheel}: no such file; make package writes it")
    options.out.mkdir(parents=True, exist_ok=True)
    path = options.out / f"item3d-{version}{'-linux_x64' if options.wheel else ''}.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:

        def add(name, content, method=zipfile.ZIP_DEFLATED):
            info = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            info.compress_type, info.external_attr = method, 0o100644 << 16
            archive.writestr(info, content)

        for name, content in files():
            if name == "blender_manifest.toml" and options.wheel:
                content = with_wheel(manifest, options.wheel).encode()
            add(name, content)
        if options.wheel:
            add(f"wheels/{options.wheel.name}", options.wheel.read_bytes(), zipfile.ZIP_STORED)
    print(path)


main()
