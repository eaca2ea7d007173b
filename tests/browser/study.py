#!/usr/bin/env python3
"""Browser test of a study in Chromium: two participants answer all pages.

usage: tests/browser/study.py ITEM3D COMPARISON [-o DIR]

ITEM3D is the program, COMPARISON a folder of `item3d compare` with at least two methods. The first participant uses a
desktop browser with a mouse. The second one uses a phone with touch and without scripts, closes the tab in the middle
of the study, and meanwhile the server is restarted. The database must contain the participants' choices, and all pages
must fit the screen. Screenshots are stored in DIR.

The test needs the Python package playwright and Chromium: the program that the environment variable CHROMIUM names, or
/usr/bin/chromium.
"""
import argparse
import json
import os
import pathlib
import random
import re
import signal
import sqlite3
import subprocess
import sys
import tempfile

from playwright.sync_api import sync_playwright

QUESTIONS = ("photorealism", "text_consistency")


class Server:
    """A process of `item3d study serve` on a free port."""

    def __init__(self, item3d, study):
        self.process = subprocess.Popen(
            [item3d, "study", "serve", study, "--participants", "2", "--port", "0", "--json", "--quiet"],
            stdout=subprocess.PIPE, text=True)
        text = ""
        for line in self.process.stdout:
            text += line
            if line == "}\n":
                break
        self.links = [entry["link"] for entry in json.loads(text)["links"]]

    def end(self):
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(timeout=10)
        assert code == 0, f"the server ended with code {code}"


def check(condition, what):
    if not condition:
        sys.exit(f"study.py: {what}")


def look_at(page, methods, output, name):
    """Takes a screenshot. Checks that the page fits the screen, has all images, and does not name a method."""
    width = page.evaluate("document.documentElement.scrollWidth")
    check(width <= page.viewport_size["width"], f"{name}: the page is {width} pixels wide")
    broken = page.evaluate("[...document.images].filter(i => !i.complete || !i.naturalWidth).length")
    check(broken == 0, f"{name}: {broken} pictures are missing")
    for method in methods:
        check(method not in page.content(), f"{name}: the page names the method {method}")
    if output:
        page.screenshot(path=output / f"{name}.png", full_page=True)


def answer(page, chosen):
    for question, value in zip(QUESTIONS, chosen):
        page.locator(f"input[name={question}][value='{value}']").check(force=True)
    page.get_by_role("button", name="Next").click()
    page.wait_for_load_state()


def take_part(context, link, size, methods, output, generator, restart=None):
    """Answers all pages. Returns the choices in the order of the pages."""
    page = context.new_page()
    page.goto(link)
    look_at(page, methods, output, f"{size}_consent")
    page.get_by_role("button", name="I agree").click()
    chosen = []
    while True:
        page.wait_for_load_state()
        place = re.search(r"Page (\d+) of (\d+)", page.content())
        if not place:
            break
        number, count = map(int, place.groups())
        check(number == len(chosen) + 1, f"page {number} came after {len(chosen)} answers")
        look_at(page, methods, output, f"{size}_page_{number}")
        if number == 2:
            # The browser does not submit a form without choices.
            page.get_by_role("button", name="Next").click()
            check(f"Page {number} of" in page.content(), "an empty answer was taken")
        asked = re.search(r"choose <b>(\d)</b> for the first question and <b>(\d)</b>", page.content())
        values = tuple(map(int, asked.groups())) if asked else (generator.randint(1, 5), generator.randint(1, 5))
        if number == count // 2:
            page.reload()
            page.close()
            if restart:
                link = restart(link)
            page = context.new_page()
            page.goto(link)
            check(f"Page {number} of" in page.content(), "the study did not go on where it was left")
        answer(page, values)
        chosen.append(values)
        if number == 3:
            # The participant goes back to an answered page and changes the answer.
            page.goto(f"{link}/{number}")
            check(page.locator("input:checked").count() == 2, "what was chosen is not shown again")
            chosen[-1] = values[::-1] if not asked else values
            answer(page, chosen[-1])
    check(len(chosen) == count, f"{len(chosen)} of {count} pages were shown")
    look_at(page, methods, output, f"{size}_thanks")
    check("Thank you" in page.content(), "no last page")
    return chosen


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("item3d", help="the program")
    parser.add_argument("comparison", help="folder of `item3d compare`")
    parser.add_argument("-o", "--output", type=pathlib.Path, help="folder for screenshots")
    options = parser.parse_args()
    if options.output:
        options.output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        study = f"{folder}/study"
        made = subprocess.run([options.item3d, "study", "make", options.comparison, "-o", study, "--json"],
                              check=True, stdout=subprocess.PIPE, text=True)
        methods = json.loads(made.stdout)["methods"]
        server = Server(options.item3d, study)
        refused = subprocess.run([options.item3d, "study", "serve", study, "--port", "0"],
                                 stderr=subprocess.PIPE, text=True)
        check(refused.returncode == 3 and "is already served" in refused.stderr, "two servers have one study")
        generator = random.Random(1)

        def restart(link):
            nonlocal server
            server.end()
            server = Server(options.item3d, study)
            return next(new for new in server.links if new.endswith(link.rsplit("/", 1)[1]))

        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(
                executable_path=os.environ.get("CHROMIUM", "/usr/bin/chromium"),
                args=["--no-sandbox", "--disable-gpu", "--disable-quic", "--disable-background-networking",
                      "--disable-component-update", "--disable-sync"])
            desk = browser.new_context(viewport={"width": 1280, "height": 800})
            first = take_part(desk, server.links[0], "desk", methods, options.output, generator)
            phone = browser.new_context(viewport={"width": 390, "height": 844}, device_scale_factor=2,
                                        is_mobile=True, has_touch=True, java_script_enabled=False)
            second = take_part(phone, server.links[1], "phone", methods, options.output, generator,
                               restart)
            small = browser.new_context(viewport={"width": 320, "height": 640}, is_mobile=True)
            narrow = small.new_page()
            narrow.goto(server.links[0] + "/1")
            look_at(narrow, methods, options.output, "narrow_page_1")
            browser.close()
        server.end()
        with sqlite3.connect(f"{study}/answers.sqlite") as database:
            for participant, chosen in ((1, first), (2, second)):
                stored = sorted(database.execute(
                    "SELECT photorealism, text_consistency FROM answers WHERE participant = ?", (participant,)))
                check(stored == sorted(chosen), f"participant {participant}: {stored} is stored, {chosen} was chosen")
        analysis = json.loads(subprocess.run([options.item3d, "study", "analyze", study, "--json"], check=True,
                                             stdout=subprocess.PIPE, text=True).stdout)
        check(analysis["participants"] == 2, f"{analysis['participants']} of two participants count")
        print(f"study.py: two participants, {len(first)} pages each: stored, resumed and analyzed")


if __name__ == "__main__":
    main()
