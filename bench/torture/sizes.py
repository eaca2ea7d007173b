"""Edits of very small and very large models: their memory, their time, and how they end."""
import array
import json
import math
import struct
import zlib

import check
import extreme_numbers
import finite
import process

MODELS = ["one triangle", "a million triangles without UVs", "10 million triangles", "textures of 8192 x 8192"]


def write_glb(path, parts, described):
    """Writes a GLB with the byte strings `parts` as buffer views."""
    views, offset = [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": offset, "byteLength": len(part)})
        offset += len(part) + -len(part) % 4
    described |= {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                  "bufferViews": views, "buffers": [{"byteLength": offset}]}
    text = json.dumps(described).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4s2I", b"glTF", 2, 28 + len(text) + offset))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", offset, b"BIN\0"))
        for part in parts:
            file.write(part + bytes(-len(part) % 4))


def write_grid(path, cells, with_uvs=True, images=()):
    """Writes a bulging square of 2 * cells^2 triangles. images: PNGs of base colour, ORM and normal map."""
    rows = range(cells + 1)
    positions, uvs, indices = array.array("f"), array.array("f"), array.array("I")
    for y in rows:
        v = y / cells
        for x in rows:
            u = x / cells
            positions.extend((2 * u - 1, 2 * v - 1, math.sin(3 * u) * math.sin(3 * v)))
            uvs.extend((u, v))
    for y in rows[:-1]:
        for x in rows[:-1]:
            a = y * (cells + 1) + x
            indices.extend((a, a + 1, a + cells + 2, a, a + cells + 2, a + cells + 1))
    count = (cells + 1) ** 2
    accessors = [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3",
                  "min": [-1, -1, -1], "max": [1, 1, 1]},
                 {"bufferView": 1, "componentType": 5125, "count": len(indices), "type": "SCALAR"}]
    parts, attributes = [positions.tobytes(), indices.tobytes()], {"POSITION": 0}
    if with_uvs:
        accessors.append({"bufferView": 2, "componentType": 5126, "count": count, "type": "VEC2"})
        parts.append(uvs.tobytes())
        attributes["TEXCOORD_0"] = 2
    material = {"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.1, 0.1, 1], "metallicFactor": 0}}
    described = {"accessors": accessors, "materials": [material],
                 "meshes": [{"primitives": [{"attributes": attributes, "indices": 1, "material": 0}]}]}
    if images:
        described["images"] = [{"bufferView": len(parts) + i, "mimeType": "image/png"} for i in range(len(images))]
        described["textures"] = [{"source": i} for i in range(len(images))]
        material["pbrMetallicRoughness"] = {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 1}}
        material["normalTexture"] = {"index": 2}
        parts += images
    write_glb(path, parts, described)


def large_png(size, color):
    """Returns a PNG of stripes with fine detail. size: a multiple of 512."""
    packer = zlib.compressobj(1)
    tile = bytes(max(0, min(255, color[i % 3] + i * 7919 % 13)) for i in range(3 * 512))
    body = []
    for y in range(size):
        shade = int(40 * math.sin(y / 37))
        row = tile.translate(bytes(max(0, min(255, value + shade)) for value in range(256)))
        body.append(packer.compress(b"\0" + row * (size // 512)))
    body.append(packer.flush())
    return (b"\x89PNG\r\n\x1a\n" + extreme_numbers.chunk(b"IHDR", struct.pack(">2I5B", size, size, 8, 2, 0, 0, 0)) +
            extreme_numbers.chunk(b"IDAT", b"".join(body)) + extreme_numbers.chunk(b"IEND", b""))


def write_model(name, path):
    if name == "one triangle":
        path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    elif name == "10 million triangles":
        write_grid(path, 2237)
    elif name == "a million triangles without UVs":
        write_grid(path, 708, with_uvs=False)
    else:
        write_grid(path, 40, images=[large_png(8192, color) for color in ((200, 60, 50), (255, 128, 20), (128, 128, 230))])


def torture(program, fixtures, folder, names, tell=print):
    """Edits each named model, and returns how the edits ended, with their memory in bytes."""
    results = []
    process.clear(folder)
    folder.mkdir(parents=True)
    for name in names:
        model = folder / ("model.obj" if name == "one triangle" else "model.glb")
        write_model(name, model)
        output = folder / "out"
        process.clear(output)
        outcome = process.run([program, "edit", model, "--from", "a red cloth", "--to", "a blue cloth", "--light",
                               fixtures.light, "--iterations", "10", "-o", output], folder / "log", seconds=3600)
        faults = process.faults_of(outcome, {0})
        faults += check.broken_files(output) if output.exists() else []
        faults += finite.faults(output, ("checkpoint.safetensors",)) if model.stat().st_size < 1 << 20 else []
        summary = json.loads((output / "edit.json").read_text()) if outcome.code == 0 else {}
        results.append({"name": name, "code": outcome.code, "seconds": outcome.seconds, "faults": faults,
                        "bytes": summary.get("peak_memory_bytes", 0), "model_bytes": model.stat().st_size,
                        "said": (outcome.errors() or [""])[-1][:300]})
        tell(f"  size {name}: {outcome.seconds:.0f} s, {summary.get('peak_memory_bytes', 0) / 1e9:.2f} GB {faults}")
        model.unlink()
    return results
