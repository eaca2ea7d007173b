#!/usr/bin/env python3
"""Runs a batch undisturbed, then the same batch with workers killed at random, and compares the results.

    bench/torture/batch.py build/item3d OUT [--jobs 200] [--iterations 10] [--every 4] [--workers 2]

Every few seconds the script sends SIGKILL to a random worker. In the end every job must have exactly one result, whose
model and textures have the same bytes as in the undisturbed batch. The script prints a summary. Its exit code is 1 if
this condition is not met.
"""
import argparse
import json
import os
import pathlib
import random
import signal
import subprocess
import time


def command(options, output):
    seeds = f"0..{options.jobs - 1}"
    return [options.program, "batch", "--models", options.model, "--from", "a red mug", "--to",
            "a golden mug", "--seeds", seeds, "-o", str(output), "--workers", str(options.workers),
            "--deaths", "100000", "--with", f"iterations={options.iterations}", "--with",
            "texture-size=128", "--with", "image-size=64", *options.extra]


def living_workers(output):
    found = []
    for path in (output / "workers").glob("*.json"):
        try:
            heart = json.loads(path.read_text())
            pid = heart["process"]["pid"]
            line = pathlib.Path(f"/proc/{pid}/cmdline").read_bytes()
        except (OSError, ValueError, KeyError):
            continue
        if not heart["ended"] and str(output).encode() in line and b"work" in line:
            found.append(pid)
    return found


def products(output):
    """Returns the bytes of each job's model and textures, by file name."""
    files = {}
    for result in (output / "runs").glob("*/*/result"):
        job = result.parent.name
        for path in [result / "model.glb", *sorted((result / "textures").iterdir())]:
            files[f"{job}/{path.relative_to(result)}"] = path.read_bytes()
    return files


def journal(output):
    done = {}
    for path in (output / "workers").glob("*.jsonl"):
        for line in path.read_text().splitlines():
            event = json.loads(line)
            if event["state"] == "done":
                done[event["job"]] = event
    return done


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", help="the item3d program")
    parser.add_argument("output", type=pathlib.Path, help="folder of both batches")
    parser.add_argument("--model", default="assets/demo/mug.glb", help="model to edit")
    parser.add_argument("--jobs", type=int, default=200, help="number of jobs")
    parser.add_argument("--iterations", type=int, default=10, help="number of iterations of a job")
    parser.add_argument("--every", type=float, default=4, help="mean number of seconds between kills")
    parser.add_argument("--workers", type=int, default=2, help="number of workers")
    parser.add_argument("--extra", nargs=argparse.REMAINDER, default=[], help="further options of `item3d batch`")
    options = parser.parse_args()
    os.environ.setdefault("SOURCE_DATE_EPOCH", "0")
    output = options.output.absolute()
    output.mkdir(parents=True, exist_ok=True)

    begin = time.monotonic()
    subprocess.run(command(options, output / "quiet"), check=True)
    quiet_seconds = time.monotonic() - begin

    begin = time.monotonic()
    kills = 0
    batch = subprocess.Popen(command(options, output / "killed"))
    while batch.poll() is None:
        time.sleep(random.uniform(0.5, 1.5) * options.every)
        workers = living_workers(output / "killed")
        if batch.poll() is None and workers:
            try:
                os.kill(random.choice(workers), signal.SIGKILL)
                kills += 1
            except ProcessLookupError:
                pass
    killed_seconds = time.monotonic() - begin

    quiet, killed = products(output / "quiet"), products(output / "killed")
    events = journal(output / "killed")
    different = [name for name in sorted(quiet.keys() | killed.keys())
                 if quiet.get(name) != killed.get(name)]
    results = len(list((output / "killed" / "runs").glob("*/*/result")))
    left = [str(path) for kind in ("attempt-*", "waiting-*", "failed")
            for path in (output / "killed" / "runs").glob(f"*/*/{kind}")]
    print(f"undisturbed: {quiet_seconds:.0f} s; with {kills} kills: {killed_seconds:.0f} s")
    print(f"{results} of {options.jobs} jobs have a result; {len(left)} other folders are left")
    attempts = [event["attempt"] for event in events.values()]
    print(f"attempts: {sum(attempts)}, at most {max(attempts)} of a job; "
          f"jobs whose worker died: {sum(event['deaths'] > 0 for event in events.values())}")
    print(f"{len(quiet)} files compared, {len(different)} differ {different[:3]}")
    good = batch.returncode == 0 and results == options.jobs and not left and not different
    print("passed" if good else "FAILED")
    return 0 if good else 1


if __name__ == "__main__":
    raise SystemExit(main())
