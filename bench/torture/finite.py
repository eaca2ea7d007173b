"""Finds numbers in files that are not finite: glTF accessors, safetensors, OpenEXR images, JSON."""
import json
import math
import struct
import zlib

import check

FLOAT_CODES = {"F32": "f", "F16": "e", "F64": "d"}  # of the module struct


def all_finite(data, code):
    size = struct.calcsize(code)
    return all(map(math.isfinite, struct.unpack(f"<{len(data) // size}{code}", data)))


def split_glb(data):
    """Returns the JSON and the binary part of a GLB."""
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20:20 + length]), data[28 + length:]


def glb(data):
    described, binary = split_glb(data)
    views = described.get("bufferViews", [])
    for index, accessor in enumerate(described.get("accessors", [])):
        if accessor["componentType"] != 5126 or "bufferView" not in accessor:  # only floats can be infinite
            continue
        view = views[accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}[accessor["type"]]
        begin = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        step = view.get("byteStride", 4 * width)
        for i in range(accessor["count"]):
            at = begin + i * step
            if not all_finite(binary[at:at + 4 * width], "f"):
                return f"element {i} of accessor {index}"
    return None


def safetensors(data):
    length = struct.unpack("<Q", data[:8])[0]
    for name, entry in json.loads(data[8:8 + length]).items():
        if name == "__metadata__":
            continue
        begin, end = entry["data_offsets"]
        values = data[8 + length + begin:8 + length + end]
        if entry["dtype"] == "BF16":  # the upper halves of 32-bit floats
            bad = any(struct.unpack("<H", values[i:i + 2])[0] & 0x7f80 == 0x7f80 for i in range(0, len(values), 2))
        else:
            bad = entry["dtype"] in FLOAT_CODES and not all_finite(values, FLOAT_CODES[entry["dtype"]])
        if bad:
            return f"tensor '{name}'"
    return None


def unpacked(block, size):
    """Returns the bytes of a block of ZIP compression: deltas, and first all even bytes and then all odd ones."""
    if len(block) == size:
        return block
    deltas, whole = zlib.decompress(block), bytearray(size)
    value = 128
    for i, delta in enumerate(deltas):
        value = delta if i == 0 else (value + delta - 128) & 255
        whole[2 * i if i < (size + 1) // 2 else 2 * (i - (size + 1) // 2) + 1] = value
    return bytes(whole)


def openexr(data):
    """Reads images of scan lines with one type of channels, without compression or with ZIP."""
    at, attributes = 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        begin = at + len(name) + len(kind) + 2
        size = struct.unpack("<I", data[begin:begin + 4])[0]
        attributes[name.decode()] = data[begin + 4:begin + 4 + size]
        at = begin + 4 + size
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    kinds = [struct.unpack("<i", attributes["channels"][part + 1:part + 5])[0]
             for part, byte in enumerate(attributes["channels"][:-1])
             if byte == 0 and attributes["channels"][part - 1:part].isalpha()]
    code = {1: "e", 2: "f"}[kinds[0]]
    lines = {0: 1, 2: 1, 3: 16}[attributes["compression"][0]]
    row = (right - left + 1) * len(kinds) * struct.calcsize(code)
    blocks = (bottom - top + lines) // lines
    for place in struct.unpack(f"<{blocks}Q", data[at + 1:at + 1 + 8 * blocks]):
        first, size = struct.unpack("<2i", data[place:place + 8])
        count = min(lines, bottom - first + 1)
        if not all_finite(unpacked(data[place + 8:place + 8 + size], count * row), code):
            return f"lines from {first} on"
    return None


def refuse(word):
    raise ValueError(word)


def text(data):
    try:
        json.loads(data, parse_constant=refuse)
    except ValueError as error:
        return str(error)
    return None


READERS = {".glb": glb, ".safetensors": safetensors, ".exr": openexr, ".json": text}


def faults(folder, left_out=()):
    """Returns a message for each file in `folder` that has a number that is not finite."""
    found = []
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if path.suffix not in READERS or path.name in left_out or check.UNFINISHED.search(name):
            continue
        where = READERS[path.suffix](path.read_bytes())
        if where:
            found.append(f"{name}: {where} is not finite")
    return found
