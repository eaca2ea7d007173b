"""Creates the inputs of the commands under test, small enough for rounds of a few seconds."""
import json
import math
import os
import pathlib
import shutil
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
PRIOR = ROOT / "tests/data/models/pipeline_sd"
# Settings of the prior that make an edit short.
DEFAULTS = {"fit_steps": 20, "light_augment": "off", "detail": "always", "detail_views": 1, "resolution": 32,
            "batch": 1}


def write_cube(path):
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    sides = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    path.write_text("".join("v %d %d %d\n" % corner for corner in corners) +
                    "".join("f %d %d %d %d\n" % side for side in sides))


def write_light(path):
    """Writes a Radiance HDR image of 8 x 4 pixels that is bright on one side."""
    bright, dim = b"\xff\xf0\xe0\x82", b"\x50\x60\x70\x80"
    rows = b"".join(bright if column % 8 < 3 else dim for column in range(32))
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n" + rows)


def camera_at(turn, height):
    """Returns the camera-to-world matrix, with OpenGL's axes, of a camera at distance 7 from the origin."""
    back = [math.cos(height) * math.sin(turn), math.sin(height),
            math.cos(height) * math.cos(turn)]
    right = [math.cos(turn), 0.0, -math.sin(turn)]
    up = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2],
          back[0] * right[1] - back[1] * right[0]]
    rows = [[right[i], up[i], back[i], 7 * back[i]] for i in range(3)]
    return rows + [[0.0, 0.0, 0.0, 1.0]]


def write_photographs(program, folder, model, light, size=32):
    """Renders a dataset of the model with `item3d render`, in the format of NeRF-synthetic."""
    folder.mkdir()
    for split, count in (("train", 9), ("test", 2)):
        frames = [{"file_path": f"./{split}/r_{i}",
                   "transform_matrix": camera_at(2.4 * i, 0.7 * math.sin(1.7 * i))}
                  for i in range(count)]
        cameras = folder / f"transforms_{split}.json"
        cameras.write_text(json.dumps({"camera_angle_x": 0.7, "frames": frames}))
        subprocess.run([program, "render", model, "--cameras", cameras, "--light", light, "--exposure",
                        "-2", "--size", f"{size}x{size}", "-o", folder / split, "--quiet"], check=True,
                       stdout=subprocess.DEVNULL)


def write_comparison(program, folder, model):
    """Writes a comparison's table and images, of two methods on one case."""
    rows = ["case,model,from,to,method,prior,seed,folder"]
    for method, after in (("plain", "studio"), ("texture", "noon")):
        run = folder / "runs" / method
        run.mkdir(parents=True)
        for name, light in (("before", "overcast"), ("after", after)):
            subprocess.run([program, "render", model, "--light", light, "--size", "64x96", "-o", run / f"{name}.png",
                            "--background", "white", "--quiet"], check=True, stdout=subprocess.DEVNULL)
        (run / "turntable.webp").write_bytes(b"RIFF\x04\0\0\0WEBP")
        rows.append(f"cube,cube.obj,a red cube,a blue cube,{method},embedded,0,runs/{method}")
    (folder / "table.csv").write_text("\n".join(rows) + "\n")


class Fixtures:
    """The folder of the inputs: cube.obj, small.hdr, photographs/, comparison/, and assets/ with a prior of random
    weights.
    """

    def __init__(self, program, folder):
        self.folder = folder
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        self.cube, self.light = folder / "cube.obj", folder / "small.hdr"
        write_cube(self.cube)
        write_light(self.light)
        self.assets = folder / "assets"
        self.prior = self.assets / "prior"
        shutil.copytree(PRIOR, self.prior)
        (self.prior / "prior.json").write_text(json.dumps({"defaults": DEFAULTS}))
        (self.assets / "demo").mkdir()
        (self.assets / "web").symlink_to(ROOT / "web")
        self.photographs = folder / "photographs"
        # With a fixed date, runs that are compared write the same bytes.
        os.environ.update(SOURCE_DATE_EPOCH="1700000000", ITEM3D_ASSETS=str(self.assets))
        write_photographs(program, self.photographs, self.cube, self.light)
        self.comparison = folder / "comparison"
        write_comparison(program, self.comparison, self.cube)
        self.before = self.state()

    def state(self):
        """Returns the contents of all input files, by name."""
        return {str(path.relative_to(self.folder)): path.read_bytes()
                for path in sorted(self.folder.rglob("*")) if path.is_file()
                and "web" not in path.parts}

    def changes(self):
        """Returns the names of input files that have changed since they were created."""
        now = self.state()
        return [name for name in sorted(self.before.keys() | now.keys())
                if self.before.get(name) != now.get(name)]
