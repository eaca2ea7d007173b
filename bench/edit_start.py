#!/usr/bin/env python3
"""Seconds from the command to an edit's first iteration, with a prior that is in the page cache.

    bench/edit_start.py ITEM3D PRIOR MODEL

Runs one iteration of an edit and prints, as one line of JSON, the stages before it of edit.json ("load": model, light,
prior, text; "fit": the neural texture), what the process took beyond all stages (it starts and ends), and their sum.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

item3d, prior, model = sys.argv[1:4]
for part in pathlib.Path(prior).rglob("*.safetensors"):
    part.read_bytes()
with tempfile.TemporaryDirectory() as folder:
    start = time.monotonic()
    subprocess.run([item3d, "edit", model, "--prior", prior, "--from", "a mug", "--to", "a golden mug", "-o", folder,
                    "--iterations", "1", "--resolution", "256", "--batch", "1", "--adjust", "off", "--texture-size",
                    "256", "--quiet", "--device", "cpu"], check=True, stdout=subprocess.DEVNULL)
    wall = time.monotonic() - start
    seconds = json.loads((pathlib.Path(folder) / "edit.json").read_text())["seconds"]
process = wall - seconds["total"]
print(json.dumps({"process": process, "load": seconds["load"], "fit": seconds["fit"],
                  "first_iteration_begins_after": process + seconds["load"] + seconds["fit"]}))
