"""Helpers for the browser tests of `item3d studio`: the server, the browser and the page."""
import atexit
import os
import pathlib
import re
import signal
import subprocess
import sys
import time
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / ".deps/browser"))
from playwright.sync_api import sync_playwright  # noqa: E402

MUG = ROOT / "assets/demo/mug.glb"
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
ARGUMENTS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             "--ignore-gpu-blocklist", "--disable-quic", "--disable-background-networking",
             "--disable-component-update", "--disable-sync"]
# Timeout in seconds. It is generous, because a busy machine makes the tests slower but not wrong.
PATIENCE = 120


def check(condition, what):
    if not condition:
        sys.exit(f"studio.py: {what}")


class Server:
    """A process of `item3d studio` with its own folder. port 0: a free port."""

    def __init__(self, item3d, folder, *arguments, port=0):
        self.item3d, self.folder, self.arguments = item3d, folder, arguments
        self.begin(port)

    def begin(self, port):
        self.process = subprocess.Popen(
            [self.item3d, "studio", *self.arguments, "--no-browser", "--port", str(port), "--folder", self.folder],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        atexit.register(self.process.kill)  # a test that fails leaves no server
        said = ""
        for line in self.process.stdout:
            said += line
            found = re.search(r"http://\S+", line)
            if found:
                self.address = found.group()
                break
        else:
            sys.exit(f"studio.py: the server ended: {said}")
        self.port = int(re.search(r":(\d+)/", self.address).group(1))
        self.token = (re.search(r"token=(\w+)", self.address) or ["", ""])[1]  # empty if the studio has a password
        self.base = self.address.split("?")[0]

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def end(self):
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(timeout=PATIENCE)
        check(code in (0, 130), f"the server ended with code {code}")

    def get(self, path):
        """Sends a request without the browser and returns the bytes of the reply."""
        request = urllib.request.Request(self.base + path, headers={"X-Item3d-Token": self.token})
        with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
            return answer.read()


class Page:
    """A browser tab with the studio's page."""

    SHOWN = "document.querySelector('.stage').dataset.shown !== undefined"

    def __init__(self, browser, address, context=None, shows=SHOWN, **options):
        options.setdefault("viewport", {"width": 1280, "height": 720})
        self.context = context or browser.new_context(**options)
        self.tab = self.context.new_page()
        self.tab.set_default_timeout(PATIENCE * 1000)
        self.errors = []
        self.tab.on("pageerror", lambda error: self.errors.append(str(error)))
        self.open(address, shows)

    def open(self, address, shows=SHOWN):
        begin = time.monotonic()
        self.tab.goto(address, timeout=PATIENCE * 1000)
        self.until(shows, "the page does not show what it should")
        self.seconds = time.monotonic() - begin

    def run(self, expression, argument=None):
        return self.tab.evaluate(expression, argument)

    def until(self, expression, what, seconds=PATIENCE):
        """Waits until an expression is true. Playwright's own wait needs eval(), which the page forbids."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                if self.tab.evaluate(expression):
                    return
            except Exception as error:  # evaluate() fails while the page is loading
                if "closed" in str(error):
                    raise
            time.sleep(0.1)
        if os.environ.get("STUDIO_PICTURES"):
            self.picture("failed")
        sys.exit(f"studio.py: {what}")

    def results(self):
        return self.run("studio.store.state.results")

    def state_of(self, result):
        return self.run(f"studio.store.state.results.find(({{ id }}) => id === '{result}')?.state")

    def wait_for(self, result, state):
        self.until(f"studio.store.state.results.find(({{ id }}) => id === '{result}')?.state === '{state}'",
                   f"result {result} did not become {state}")

    def edit(self, to, **settings):
        """Starts a short edit as a user does; returns the id of its result."""
        self.tab.click("#tab-edit")
        self.tab.fill("#from", "a red mug")
        self.tab.fill("#to", to)
        self.run("(settings) => studio.store.set({ settings })", SHORT | settings)
        before = len(self.results())
        self.tab.click("#start")
        self.until(f"studio.store.state.results.length > {before}", "no edit was begun")
        return self.results()[-1]["id"]

    def pixels(self):
        """Returns the viewer's image, reduced to 64 x 64 pixels, as a list of values."""
        return self.run("""async () => {
            const bitmap = await createImageBitmap(await studio.viewer.stage.picture());
            const canvas = new OffscreenCanvas(64, 64), context = canvas.getContext('2d');
            context.drawImage(bitmap, 0, 0, 64, 64);
            return [...context.getImageData(0, 0, 64, 64).data];
        }""")

    def picture(self, name):
        folder = os.environ.get("STUDIO_PICTURES")
        if folder:
            pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
            self.tab.screenshot(path=f"{folder}/{name}.png")

    def close(self):
        check(not self.errors, f"errors in the page: {self.errors}")
        self.context.close()


# Settings of an edit that takes a second or two. The tests check the page, not the quality of the edit.
SHORT = {"iterations": 12, "batch": 1, "detail": "off", "texture_size": 256}


def difference(a, b):
    """Returns the mean absolute difference of two lists of values in [0, 255]."""
    return sum(abs(x - y) for x, y in zip(a, b)) / len(a)


def launch(playwright, *arguments):
    return playwright.chromium.launch(executable_path=CHROMIUM, args=[*ARGUMENTS, *arguments])


__all__ = ["MUG", "PATIENCE", "Page", "ROOT", "Server", "check", "difference", "launch", "sync_playwright"]
