#!/usr/bin/env python3
"""Measures two properties of edits that change one colour into another.

    nice python3 bench/region_colors.py PROGRAM OUT --real DIR --spot spot.obj --mug mug.glb [--only N,N]

The properties are:

    away    how much an edit without --region changes surfaces of other colours: the mean CIELAB distance (CIE 1976)
            between the base colours before and after the edit. The mean is over all pixels of six views whose colour
            clearly differs from the colour in the --from sentence: the hue differs by more than 45 degrees or the pixel
            is grey, or, if the sentence says black, white or gray, the lightness differs by more than 30.
            docs/benchmarks.md calls it "moved elsewhere".
    right   whether the region gets the colour of the --to sentence: among the eleven basic colours, this one is nearest
            to the region's mean base colour (edit.json)

DIR has the example models of three.js and Khronos that the list EDITS names. All edits have the default settings and
seed 0. docs/benchmarks.md has the results. The script writes OUT/region_colors.json after each edit and does not repeat
edits whose results are in OUT. It needs numpy and pillow.
"""
import argparse
import json
import pathlib
import subprocess
import time

import numpy as np
from PIL import Image

# The colours of basic_colors() in src/item3d/metrics/color.cpp, in sRGB.
BASIC = {"black": (0.05, 0.05, 0.05), "white": (0.95, 0.95, 0.95), "gray": (0.5, 0.5, 0.5), "red": (0.78, 0.09, 0.08),
         "green": (0.10, 0.55, 0.16), "blue": (0.09, 0.20, 0.75), "yellow": (0.95, 0.82, 0.10),
         "orange": (0.95, 0.48, 0.06), "purple": (0.45, 0.12, 0.60), "pink": (0.95, 0.55, 0.70),
         "brown": (0.40, 0.24, 0.12)}

# Each entry has the model, the sentences --from and --to, the target colour and further options. The first six
# (REGIONLESS) have no --region; their --from sentence names the colour to change.
EDITS = [
    ("ExplodingBarrel.glb", "a red barrel", "a blue barrel", "blue", []),
    ("seagulf.glb", "an orange bird", "a green bird", "green", []),
    ("low-poly-tree.glb", "a green tree", "an orange tree", "orange", []),
    ("spot", "a black cow", "a red cow", "red", []),
    ("cannon.glb", "a brown cannon", "a green cannon", "green", []),
    ("lumberjack.glb", "a red man", "a blue man", "blue", []),
    ("spot", "a cow", "a blue cow", "blue", ["--region", "named=black"]),
    ("spot", "a cow", "a black cow", "black", ["--region", "sphere=0,0.45,-0.68,0.3"]),
    ("spot", "a cow", "a green cow", "green", ["--region", "box=-1,-1,-1,1,-0.3,1"]),
    ("spot", "a cow", "a yellow cow", "yellow", ["--region", "named=white"]),
    ("spot", "a cow", "a purple cow", "purple", ["--region", "words=the horns"]),
    ("mug", "a mug", "a blue mug", "blue", ["--region", "box=0.042,-1,-1,1,1,1"]),
    ("mug", "a mug", "a yellow mug", "yellow", ["--region", "box=-1,-1,-1,1,0.04,1"]),
    ("ExplodingBarrel.glb", "a barrel", "a green barrel", "green", ["--region", "named=red"]),
    ("ExplodingBarrel.glb", "a barrel", "a pink barrel", "pink", ["--region", "named=white"]),
    ("ExplodingBarrel.glb", "a barrel", "a black barrel", "black", ["--region", "color=#7b1f22~20"]),
    ("cannon.glb", "a cannon", "a red cannon", "red", ["--region", "mesh=cannonMount"]),
    ("seagulf.glb", "a bird", "a red bird", "red", ["--region", "named=gray"]),
    ("bitmoji.glb", "a person", "an orange person", "orange", ["--region", "material=main_group_MAT"]),
    ("cat.glb", "a cat", "a white cat", "white", ["--region", "box=-100,-100,-100,100,0,100"]),
]
REGIONLESS = 6


def linear(srgb):
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def lab(rgb_linear):
    """Converts linear Rec. 709 RGB [..., 3] to CIELAB."""
    matrix = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
                       [0.0193339, 0.1191920, 0.9503041]])
    xyz = rgb_linear @ matrix.T / np.array([0.95047, 1, 1.08883])
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz * (29 / 6) ** 2 / 3 + 4 / 29)
    return np.stack([116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], -1)


def of_basic(name):
    return lab(linear(np.array(BASIC[name])))


def nearest(color):
    return min(BASIC, key=lambda name: np.linalg.norm(of_basic(name) - color))


def is_clearly_other(pixels, name):
    source = of_basic(name)
    chroma = np.hypot(pixels[:, 1], pixels[:, 2])
    if name in ("black", "white", "gray"):
        return np.abs(pixels[:, 0] - source[0]) > 30
    angle = np.arctan2(pixels[:, 2], pixels[:, 1]) - np.arctan2(source[2], source[1])
    apart = np.abs((np.degrees(angle) + 180) % 360 - 180)
    return (apart > 45) | (chroma < 8)


class Bench:
    def __init__(self, arguments):
        self.program, self.out = arguments.program, pathlib.Path(arguments.out)
        self.files = {"spot": arguments.spot, "mug": arguments.mug}
        self.real = pathlib.Path(arguments.real)

    def run(self, *words):
        result = subprocess.run([self.program, *map(str, words)], capture_output=True, text=True)
        if result.returncode:
            raise SystemExit(f"{' '.join(map(str, words))}: {result.stderr}")
        return result.stderr

    def views(self, model, folder):
        """Returns the base colour of six views in CIELAB, and the mask of the pixels that the model covers."""
        folder.mkdir(parents=True, exist_ok=True)
        if len(list(folder.glob("*.png"))) < 6:
            self.run("render", model, "--views", 6, "--size", "192x192", "--channel", "base_color", "--quiet", "-o",
                     folder)
        pictures = np.stack([np.asarray(Image.open(f).convert("RGBA")) for f in sorted(folder.glob("*.png"))])
        return lab(linear(pictures[..., :3] / 255.0)), pictures[..., 3] == 255

    def edit(self, index):
        name, source, target, color, options = EDITS[index]
        model = self.files.get(name) or self.real / name
        folder = self.out / str(index)
        begin = time.time()
        if not (folder / "edit.json").exists():
            notes = self.run("edit", model, "--from", source, "--to", target, *options, "--image-size", 96,
                             "-o", folder)
            (folder / "notes.txt").write_text(notes)
        record = json.loads((folder / "edit.json").read_text())
        after = lab(np.array(record["scores"]["after"]["base_color_linear"]))
        row = {"model": name, "from": source, "to": target, "options": options, "nearest": nearest(after),
               "right": nearest(after) == color, "lab": [round(float(v), 1) for v in after],
               "share": record.get("region", {}).get("share", 1.0),
               "outside": record.get("region", {}).get("outside"), "seconds": round(time.time() - begin, 1)}
        if index < REGIONLESS:
            before_lab, covered = self.views(model, folder / "views_before")
            after_lab, covered_after = self.views(folder / "model.glb", folder / "views_after")
            both = covered & covered_after
            pixels, changed = before_lab[both], after_lab[both]
            other = is_clearly_other(pixels, source.split()[1])
            distance = np.linalg.norm(changed - pixels, axis=1)
            row["other_share"] = float(other.mean())
            row["away"] = float(distance[other].mean()) if other.any() else None
            row["away_over_10"] = float((distance[other] > 10).mean()) if other.any() else None
            row["moved"] = float(distance[~other].mean())
        return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the item3d program")
    parser.add_argument("out", help="folder for all results")
    for option, description in (("--real", "folder of the example models"), ("--spot", "file of the model spot"),
                                ("--mug", "file of the demo's mug")):
        parser.add_argument(option, required=True, help=description)
    parser.add_argument("--only", help="numbers of the edits to run, from 0, separated by commas")
    arguments = parser.parse_args()
    bench = Bench(arguments)
    chosen = [int(n) for n in arguments.only.split(",")] if arguments.only else range(len(EDITS))
    rows = []
    for index in chosen:
        rows.append(bench.edit(index))
        print(json.dumps(rows[-1]), flush=True)
        (bench.out / "region_colors.json").write_text(json.dumps(rows, indent=1))
    away = [row["away"] for row in rows if row.get("away") is not None]
    right = [row["right"] for row in rows]
    print(f"moved elsewhere: {['%.2f' % a for a in away]}, below 3 in {sum(a < 3 for a in away)} of {len(away)}; "
          f"colour inside: {sum(right)} of {len(right)} nearest to the target")


if __name__ == "__main__":
    main()
