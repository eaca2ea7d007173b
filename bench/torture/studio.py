#!/usr/bin/env python3
"""Runs an edit in `item3d studio` as one command.

    bench/torture/studio.py build/item3d MODEL FOLDER

The script starts the server in FOLDER, opens the model, runs the edit and ends the server. If FOLDER already has a
project or an edit, the script continues with it. The exit code is that of the server. If the server ends with 0, it is
3 if the edit failed or a request was refused, and 4 if a resource was missing. If a signal has ended the server, it
also ends the script. Two environment variables are for the server alone: TORTURE_SERVER_PRELOAD becomes its LD_PRELOAD,
and TORTURE_SERVER_LIMITS has its limits as a JSON list of pairs: the number of a resource, as setrlimit() takes it, and
the limit.
"""
import json
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.parse
import urllib.request

PATIENCE = 600
LACKING = re.compile(r": 50[37]: |disk|space|memory|signal 9|No space|File too large|could be started")
EDIT = {"from": "a red cube", "to": "a blue cube",
        "settings": {"iterations": 6, "texture_size": 64, "seed": 1}}


class Refused(Exception):
    """The edit failed, or a request was refused."""


class Server:
    """A process of `item3d studio` on a free port, with its address and token."""

    def __init__(self, program, folder, environment=None):
        limits = json.loads(os.environ.get("TORTURE_SERVER_LIMITS", "[]"))

        def prepare():
            for what, value in limits:
                resource.setrlimit(what, (value, value))

        self.process = subprocess.Popen(
            [program, "studio", "--no-browser", "--folder", str(folder)], stdout=subprocess.PIPE,
            env=os.environ | (environment or {}), text=True, preexec_fn=prepare if limits else None)
        line = self.process.stdout.readline()
        found = re.match(r"(http://\S+?/)\?token=(\w+)", line)
        if not found:
            end_as(self.process.wait(PATIENCE) or 1)
        self.base, self.token = found.groups()

    def ask(self, path, body=None, method=None):
        """Sends a request and returns the bytes of the reply. body: bytes, or a value to send as JSON."""
        data = body if body is None or isinstance(body, bytes) else json.dumps(body).encode()
        kind = "application/octet-stream" if isinstance(body, bytes) else "application/json"
        request = urllib.request.Request(
            self.base + path, data, {"X-Item3d-Token": self.token, "Content-Type": kind}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
                return answer.read()
        except urllib.error.HTTPError as refusal:
            text = refusal.read().decode(errors="replace")
            raise Refused(f"{path}: {refusal.code}: {text}") from refusal

    def json(self, path, body=None):
        return json.loads(self.ask(path, body))

    def end(self):
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(PATIENCE)


def open_model(server, model):
    """Returns the id of the first project; creates it from the model if there is none."""
    projects = server.json("api/projects")
    if projects:
        return projects[0]["id"]
    name = urllib.parse.quote(model.name)
    return server.json(f"api/projects?name={name}", model.read_bytes())["id"]


def edit(server, project, request, patience=PATIENCE):
    """Starts an edit of the project, or continues with the project's first edit; returns the finished result."""
    results = server.json(f"api/projects/{project}")["results"]
    result = results[0] if results else server.json(f"api/projects/{project}/edits", request)
    last = time.monotonic() + patience
    asked = False
    while time.monotonic() < last:
        state = result["state"]
        if state == "done":
            return result
        if state in ("paused", "failed", "cancelled") and not asked:
            server.ask(f"api/results/{result['id']}/resume", {})
            asked = True
        elif state == "failed":
            raise Refused(f"the edit failed: {result.get('message')}")
        elif result.get("message"):
            raise Refused(f"the queue is blocked: {result['message']}")
        time.sleep(0.05)
        result = next(each for each in server.json(f"api/projects/{project}")["results"]
                      if each["id"] == result["id"])
    raise Refused("the edit did not end")


def main():
    program, model, folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    preload = os.environ.get("TORTURE_SERVER_PRELOAD")
    server = Server(program, folder, {"LD_PRELOAD": preload} if preload else {})
    try:
        edit(server, open_model(server, model), EDIT)
    except Refused as refusal:
        code = server.end()
        print(f"item3d: error: studio: {refusal}", file=sys.stderr)
        return code or (4 if LACKING.search(str(refusal)) else 3)
    except OSError:
        return server.process.wait(PATIENCE) or 1  # the server has ended by itself
    return server.end()


def end_as(code):
    """Ends this process with an exit code, or by the signal with the negative code."""
    if code < 0:
        os.kill(os.getpid(), -code)
    raise SystemExit(code)


if __name__ == "__main__":
    end_as(main())
