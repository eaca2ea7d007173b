"""Inputs with numbers that are not finite, huge or denormal. None of them may reach a result."""
import json
import math
import pathlib
import shutil
import struct
import zlib

import check
import finite
import process

FLOATS = {"NaN": math.nan, "infinity": math.inf, "-infinity": -math.inf, "3e38": 3e38, "1e30": 1e30, "1e-42": 1e-42}
ATTRIBUTES = {"POSITION": 3, "NORMAL": 3, "TEXCOORD_0": 2, "TANGENT": 4, "COLOR_0": 4}
WEIGHTS = ("unet/diffusion_pytorch_model.safetensors", "vae/diffusion_pytorch_model.safetensors",
           "text_encoder/model.safetensors")


def chunk(kind, body):
    """Returns a chunk of a PNG."""
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def png(size):
    """Returns a PNG of a checkerboard."""
    rows = b"".join(b"\0" + b"".join(b"\xc0\x40\x30" if (x // 4 + y // 4) % 2 else b"\x30\x80\x40"
                                     for x in range(size)) for y in range(size))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", size, size, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def cube():
    """Returns the values of ATTRIBUTES at the 24 vertices of a cube, and its triangles."""
    values, triangles = {name: [] for name in ATTRIBUTES}, []
    for side in range(6):
        axis, sign = side // 2, 1.0 - 2.0 * (side % 2)
        for corner in range(4):
            a, b = (1.0 if corner in (1, 2) else -1.0), (1.0 if corner >= 2 else -1.0)
            position, normal, tangent = [0.0] * 3, [0.0] * 3, [0.0] * 3 + [1.0]
            position[axis], position[(axis + 1) % 3], position[(axis + 2) % 3] = sign, a * sign, b
            normal[axis], tangent[(axis + 1) % 3] = sign, sign
            values["POSITION"].append(position)
            values["NORMAL"].append(normal)
            values["TANGENT"].append(tangent)
            values["TEXCOORD_0"].append([(side % 3 + 0.5 + 0.4 * a) / 3, (side // 3 + 0.5 + 0.4 * b) / 2])
            values["COLOR_0"].append([1.0, 0.9, 0.8, 1.0])
        triangles += [4 * side + i for i in (0, 1, 2, 0, 2, 3)]
    return values, triangles


def write_model(path, values, change=lambda described: None):
    """Writes a textured cube as a GLB. change: function that alters the JSON part."""
    binary, views, accessors = b"", [], []

    def add(data, accessor=None):
        nonlocal binary
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
        if accessor:
            accessors.append(accessor | {"bufferView": len(views) - 1})
        binary += data + bytes(-len(data) % 4)
        return len(views) - 1

    attributes = {}
    for name, width in ATTRIBUTES.items():
        rows = values[0][name]
        attributes[name] = len(accessors)
        add(b"".join(struct.pack(f"<{width}f", *row) for row in rows),
            {"componentType": 5126, "count": len(rows), "type": f"VEC{width}"})
    indices = len(accessors)
    add(struct.pack(f"<{len(values[1])}H", *values[1]),
        {"componentType": 5123, "count": len(values[1]), "type": "SCALAR"})
    accessors[0] |= {"min": [-1.0] * 3, "max": [1.0] * 3}
    image = add(png(32))
    described = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": indices, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0.1},
                       "normalTexture": {"index": 0}}],
        "textures": [{"source": 0}], "images": [{"bufferView": image, "mimeType": "image/png"}],
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(binary)}]}
    change(described)
    text = json.dumps(described).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(struct.pack("<4s2I", b"glTF", 2, 28 + len(text) + len(binary)) +
                     struct.pack("<I4s", len(text), b"JSON") + text +
                     struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def members():
    """Returns functions that put an extreme number into a member of the JSON, by the member's name."""
    def of_material(described):
        return described["materials"][0]

    def shading(name, value):
        return lambda described: of_material(described)["pbrMetallicRoughness"].update({name: value})

    def node(name, value):
        return lambda described: described["nodes"][0].update({name: value})

    def shifted(described):
        texture = of_material(described)["pbrMetallicRoughness"]["baseColorTexture"]
        texture["extensions"] = {"KHR_texture_transform": {"offset": [1e30, 0], "scale": [1e38, 1e-42]}}

    def glowing(described):
        of_material(described).update({"emissiveFactor": [1, 1, 1], "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 1e38}}})

    found = {"texture transform of 1e30": shifted, "emissive strength of 1e38": glowing,
             "normal scale of 1e38": lambda described: of_material(described)["normalTexture"].update({"scale": 1e38})}
    for value in (1e39, 1e30, -1e30, 1e-42):
        found[f"base color of {value:g}"] = shading("baseColorFactor", [value, 1, 1, 1])
        found[f"roughness of {value:g}"] = shading("roughnessFactor", value)
        found[f"metallic of {value:g}"] = shading("metallicFactor", value)
        found[f"node's scale of {value:g}"] = node("scale", [value, 1, 1])
        found[f"node's translation of {value:g}"] = node("translation", [value, 0, 0])
        found[f"node's rotation of {value:g}"] = node("rotation", [value, 0, 0, 1])
    return found


def write_light(path, values):
    """Writes an OpenEXR image of 8 x 4 pixels, 32-bit floats without compression, that repeats `values`."""
    def attribute(name, kind, body):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(body)) + body
    window = struct.pack("<4i", 0, 0, 7, 3)
    channels = b"".join(name + struct.pack("<iI2i", 2, 0, 1, 1) for name in (b"B\0", b"G\0", b"R\0")) + b"\0"
    head = (b"\x76\x2f\x31\x01\x02\0\0\0" + attribute(b"channels", b"chlist", channels) +
            attribute(b"compression", b"compression", b"\0") + attribute(b"dataWindow", b"box2i", window) +
            attribute(b"displayWindow", b"box2i", window) + attribute(b"lineOrder", b"lineOrder", b"\0") +
            attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)) +
            attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)) +
            attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0")
    row = 8 * 3 * 4
    offsets = [len(head) + 32 + y * (8 + row) for y in range(4)]
    lines = b"".join(struct.pack("<2i", y, row) +
                     struct.pack("<24f", *(values[(24 * y + i) % len(values)] for i in range(24))) for y in range(4))
    path.write_bytes(head + struct.pack("<4Q", *offsets) + lines)


def poison(path, value, every):
    """Replaces the first number of each tensor of a safetensors file by `value`, or all numbers."""
    data = bytearray(path.read_bytes())
    length = struct.unpack("<Q", data[:8])[0]
    for name, entry in json.loads(data[8:8 + length]).items():
        if name == "__metadata__" or entry["dtype"] != "F32":
            continue
        begin, end = (8 + length + offset for offset in entry["data_offsets"])
        count = (end - begin) // 4 if every else min(1, (end - begin) // 4)
        data[begin:begin + 4 * count] = struct.pack("<f", value) * count
    path.write_bytes(data)


class Numbers:
    """Runs the cases in `folder`."""

    def __init__(self, program, fixtures, folder):
        self.program, self.fixtures, self.folder = program, fixtures, folder
        self.output, self.results = folder / "out", []
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)

    def run(self, command, kind, what, arguments, environment=None, may_fail=True):
        process.clear(self.output)
        outcome = process.run([self.program, *command.split(), *arguments, "-o", self.output / "result" /
                               {"render": "views", "tensors": "model.safetensors", "layers": "model.glb"}.get(command, "")],
                              self.folder / "log", environment=environment)
        faults = process.faults_of(outcome, {0, 3} if may_fail else {0})
        if self.output.exists():
            faults += check.broken_files(self.output) + finite.faults(self.output, ("checkpoint.safetensors",))
        self.results.append({"command": command, "kind": kind, "what": what, "code": outcome.code, "faults": faults,
                             "said": (outcome.errors() or [""])[-1][:300]})

    def edit(self, kind, what, model=None, light=None, assets=None, more=()):
        inputs = self.fixtures
        self.run("edit", kind, what, [model or inputs.cube, "--from", "a red cube", "--to", "a blue cube", "--light",
                                      light or inputs.light, "--iterations", "4", "--texture-size", "32",
                                      "--image-size", "32", "--threads", "1", *more],
                 {"ITEM3D_ASSETS": str(assets)} if assets else None)

    def models(self):
        path = self.folder / "model.glb"

        def commands(kind, what):
            self.edit(kind, what, path)
            self.run("render", kind, what, [path, "--views", "2", "--size", "32x32", "--light", self.fixtures.light])
            self.run("tensors", kind, what, [path])

        for name in ATTRIBUTES:
            for word, value in FLOATS.items():
                for every in (False, True):
                    values = cube()
                    rows = values[0][name]
                    for row in rows if every else rows[:1]:
                        row[:] = [value] * len(row) if every else [value, *row[1:]]
                    write_model(path, values)
                    commands("attribute", f"{name}: {word} {'everywhere' if every else 'once'}")
        for what, change in members().items():
            write_model(path, cube(), change)
            commands("number in glTF", what)

    def lights(self):
        path = self.folder / "light.exr"
        for word, value in FLOATS.items():
            for every in (False, True):
                write_light(path, [value] if every else [1.0] * 50 + [value] + [0.5] * 45)
                what = f"{word} {'everywhere' if every else 'once'}"
                self.edit("light", what, light=path)
                self.run("render", "light", what, [self.fixtures.cube, "--views", "1", "--size", "32x32", "--light",
                                                   path])
                self.run("relight", "light", what, [self.fixtures.cube, "--from", "a cube", "--to", "a cube at sunset",
                                                    "--from-light", path, "--iterations", "3", "--views", "1", "--frames",
                                                    "1", "--size", "32", "--no-shadows"])

    def weights(self):
        for name in WEIGHTS:
            for word, value in FLOATS.items():
                for every in (False, True):
                    for precision in ("fp32", "bf16"):
                        assets = self.folder / "assets"
                        shutil.rmtree(assets, ignore_errors=True)
                        shutil.copytree(self.fixtures.assets, assets, symlinks=True)
                        poison(assets / "prior" / name, value, every)
                        self.edit("weights", f"{pathlib.Path(name).parent}: {word} "
                                  f"{'everywhere' if every else 'once a tensor'}, {precision}", assets=assets,
                                  more=("--precision", precision))

    def layers(self):
        made = self.folder / "made"
        self.edit("layer", "as written")
        self.output.rename(made)
        layer = made / "result/layer.safetensors"
        whole = layer.read_bytes()
        for word, value in FLOATS.items():
            for every in (False, True):
                layer.write_bytes(whole)
                poison(layer, value, every)
                self.run("layers", "layer", f"{word} {'everywhere' if every else 'once a tensor'}",
                         [self.fixtures.cube, made / "result"])


PARTS = ["models", "lights", "weights", "layers"]


def torture(program, fixtures, folder, parts, tell=print):
    """Runs the cases of the named parts, and returns their results."""
    numbers = Numbers(program, fixtures, folder)
    for part in parts:
        getattr(numbers, part)()
    for case in numbers.results:
        if case["faults"]:
            tell(f"  numbers {case['command']}, {case['kind']}, {case['what']}: {case['faults']} {case['said']}")
    return numbers.results
