#!/usr/bin/env python3
"""Stand-in for item3d that answers without computing, so that a test takes a second instead of a minute.

usage: fake_item3d.py BEHAVIOUR COMMAND...
    edit    writes gold as base colour and 0.2 as roughness of each requested material
    slow    rewrites progress and live textures until it is interrupted, then writes a checkpoint
    deaf    does the same as slow, but ignores interrupts
    error   fails with an error message like item3d's
    old     reports the version 0.1.0
    early   lacks some of the options that the extension needs
"""
import json
import pathlib
import signal
import struct
import sys
import time
import zlib

GOLD = [1.0, 0.75, 0.2, 1.0]


def png(width, height, color):
    """Returns the bytes of a PNG of one colour."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = (b"\0" + bytes(color) * width) * height
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def option(arguments, name, default=""):
    for at, argument in enumerate(arguments):
        if argument == name:
            return arguments[at + 1]
        if argument.startswith(name + "="):
            return argument.partition("=")[2]
    return default


def replace(path, content):
    """Replaces a file atomically, as the program does, so that no reader sees a part of it."""
    temporary = path.with_suffix(".tmp")
    temporary.write_bytes(content)
    temporary.replace(path)


def write_model(source, out, wanted):
    data = source.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    blob = data[20 + length :]
    for material in document.get("materials", []):
        if wanted and material.get("name") not in wanted:
            continue
        pbr = material.setdefault("pbrMetallicRoughness", {})
        pbr.pop("baseColorTexture", None)
        pbr |= {"baseColorFactor": GOLD, "roughnessFactor": 0.2, "metallicFactor": 1.0}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    out.write_bytes(struct.pack("<IIIII", 0x46546C67, 2, 20 + len(text) + len(blob), len(text), 0x4E4F534A) + text + blob)


def go_on(arguments, out, stops):
    progress, live = pathlib.Path(option(arguments, "--progress-file")), pathlib.Path(option(arguments, "--live"))
    interrupted = []
    signal.signal(signal.SIGINT, (lambda *_: interrupted.append(True)) if stops else signal.SIG_IGN)
    for revision in range(1, 600):
        told = {"stage": "edit", "done": revision, "total": 600, "seconds_left": 60.0}
        replace(progress, json.dumps(told).encode())
        replace(live / "0_base_color.png", png(4, 4, (revision % 256, 100, 50)))
        replace(live / "0_orm.png", png(4, 4, (255, 80, 255)))
        textures = [{"material": 0, "slot": slot, "file": f"0_{slot}.png"} for slot in ("base_color", "orm")]
        shown = {"revision": revision, "textures": textures, "direction": []}
        replace(live / "textures.json", json.dumps(shown).encode())
        time.sleep(0.1)
        if interrupted:
            (out / "checkpoint.safetensors").write_bytes(b"state")
            sys.exit(130)


def main():
    behaviour, *arguments = sys.argv[1:]
    if arguments == ["--version"]:
        print("item3d 0.1.0" if behaviour == "old" else "item3d 0.2.0")
        return
    if arguments[-1] == "--help-all":
        print("--region" if behaviour == "early" else "--live --progress-file --region")
        return
    if arguments[:2] == ["prior", "info"]:
        print(json.dumps({"words": ["a", "cube", "golden", "gold", "gray"]}))
        return
    out = pathlib.Path(option(arguments, "-o"))
    out.mkdir(exist_ok=True)
    if behaviour == "error":
        print("item3d: error: a thing: is not right; try another", file=sys.stderr)
        sys.exit(3)
    if behaviour in ("slow", "deaf") and "--resume" not in arguments:
        go_on(arguments, out, behaviour == "slow")
    wanted = [arguments[at + 1] for at, argument in enumerate(arguments) if argument == "--material"]
    time.sleep(0.2)
    write_model(pathlib.Path(arguments[1]), out / "model.glb", wanted)
    (out / "edit.json").write_text(json.dumps(
        {"from": option(arguments, "--from"), "to": option(arguments, "--to"), "seed": 2**40, "version": "0.2.0",
         "settings": {"region": [option(arguments, "--region")]}, "prior": "prior"}))


if __name__ == "__main__":
    main()
