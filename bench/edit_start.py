#!/usr/bin/env python3
"""Seconds from the command to an edit's first iteration, with a prior that is in the page cache.

    bench/edit_start.py ITEM3D PRIOR MODEL

Runs one iteration of an edit and prints, as one line of JSON, the seconds until it begins (the checkpoint that is
written right before it appears), and of those the stages of edit.json: "load" (model and light; the prior is loaded
beside that and the next) and "fit" (the neural texture).
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
    edit = subprocess.Popen(
        [item3d, "edit", model, "--prior", prior, "--from", "a mug", "--to", "a golden mug", "-o", folder,
         "--iterations", "1", "--resolution", "256", "--batch", "1", "--adjust", "off", "--texture-size", "256",
         "--quiet", "--device", "cpu"], stdout=subprocess.DEVNULL)
    checkpoint = pathlib.Path(folder) / "checkpoint.safetensors"
    while not checkpoint.exists() and edit.poll() is None:
        time.sleep(0.005)
    begins = time.monotonic() - start
    if edit.wait() != 0:
        sys.exit(f"the edit failed with exit code {edit.returncode}")
    seconds = json.loads((pathlib.Path(folder) / "edit.json").read_text())["seconds"]
print(json.dumps({"first_iteration_begins_after": begins, "load": seconds["load"], "fit": seconds["fit"]}))
