"""Long runs: many edits in one worker and many requests to one studio, to detect growth of memory or open files."""
import os
import pathlib
import signal
import time

import process
import studio


def resident(process_id):
    """Returns the resident memory of a process in bytes."""
    fields = pathlib.Path(f"/proc/{process_id}/statm").read_text().split()
    return int(fields[1]) * os.sysconf("SC_PAGESIZE")


def open_files(process_id):
    return len(os.listdir(f"/proc/{process_id}/fd"))


def slope(samples):
    """Returns the slope of the least-squares line through (x, y) pairs."""
    if len(samples) < 2:
        return 0.0
    mean_x = sum(x for x, _ in samples) / len(samples)
    mean_y = sum(y for _, y in samples) / len(samples)
    spread = sum((x - mean_x) ** 2 for x, _ in samples)
    return sum((x - mean_x) * (y - mean_y) for x, y in samples) / spread if spread else 0.0


def summary(name, unit, samples):
    """Returns statistics of a long run.

    samples: tuples of the number of edits or requests so far, resident bytes and open files. The first tenth is left
    out, because caches still fill.
    """
    if not samples:
        raise SystemExit(f"torture: no time was left for {name}")
    steady = samples[len(samples) // 10:]
    return {"name": name, "unit": unit, "count": samples[-1][0],
            "first_bytes": steady[0][1], "last_bytes": steady[-1][1],
            "largest_bytes": max(memory for _, memory, _ in steady),
            "bytes_each": slope([(number, memory) for number, memory, _ in steady]),
            "files_first": steady[0][2], "files_last": steady[-1][2],
            "files_most": max(files for _, _, files in steady), "samples": samples}


def worker_of(run):
    """Returns the id of the worker process (`item3d batch work`), or None."""
    for member in run.members():
        try:
            line = pathlib.Path(f"/proc/{member}/cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if b"work" in line:
            return member
    return None


def edits_in_one_worker(program, fixtures, folder, count, until=None):
    output = folder / "long"
    process.clear(output)
    run = process.Run([program, "batch", "--models", fixtures.cube, "--from", "a red cube", "--to",
                       "a blue cube", "--seeds", f"0..{count - 1}", "--workers", "1", "--with",
                       "iterations=1", "--with", "texture-size=16", "--with", "image-size=16",
                       "--with", "detail=off", "--with", f"light={fixtures.light}", "--threads", "1",
                       "-o", output], folder / "log")
    samples, done = [], 0
    while run.process.poll() is None and not (until and time.monotonic() > until):
        time.sleep(0.2)
        worker = worker_of(run)
        now = sum(1 for _ in (output / "runs").glob("*/*/result"))
        if worker and now > done:
            done = now
            try:
                samples.append((done, resident(worker), open_files(worker)))
            except OSError:
                pass  # the worker has just ended
    if run.process.poll() is None:
        run.signal_one(run.process.pid, signal.SIGTERM)
    outcome = run.wait(120)
    result = summary("edits in one worker", "edit", samples)
    result["faults"] = process.faults_of(outcome, {0, 130})
    return result


def requests(server, project, number):
    """Sends the requests that a page sends in a few minutes of use; returns their number."""
    for path in ("", "api/about", "api/projects", f"api/projects/{project}",
                 f"api/projects/{project}/model.glb"):
        server.ask(path)
    server.json(f"api/projects/{project}/estimate", {"from": "a red cube", "to": f"a {number} cube"})
    return 6


def studio_requests(program, fixtures, folder, rounds, until=None):
    data = folder / "studio"
    process.clear(data)
    server = studio.Server(program, data)
    project = studio.open_model(server, fixtures.cube)
    samples, asked = [], 0
    for number in range(rounds):
        if until and time.monotonic() > until and samples:
            break
        asked += requests(server, project, number)
        samples.append((asked, resident(server.process.pid), open_files(server.process.pid)))
    code = server.end()
    result = summary("requests to a studio", "request", samples)
    result["faults"] = [] if code == 0 else [f"the server ended with {code}"]
    return result


def torture(program, fixtures, folder, edits, rounds, until):
    """Runs both long runs. The requests get the last third of the time until `until`."""
    found, now = [], time.monotonic()
    if edits:
        last = now + (until - now) * 2 / 3 if rounds else until
        found.append(edits_in_one_worker(program, fixtures, folder, edits, last))
    if rounds:
        found.append(studio_requests(program, fixtures, folder, rounds, until))
    return found
