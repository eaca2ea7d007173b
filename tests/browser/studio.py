#!/usr/bin/env python3
"""Browser test of the studio in headless Chromium with software GL.

usage: tests/browser/studio.py ITEM3D [--all] [--measure] [--photographs]

Without options, the test opens the demo, compares the viewer with `item3d render`, clicks a region, tries the forms and
runs a short edit that must change the image. A second edit uses only the keyboard, a third one runs behind a proxy. --all tests the
rest of the page, --photographs tests a reconstruction (which takes minutes), --measure prints times. If the environment
variable STUDIO_PICTURES names a folder, screenshots are stored there.

The test needs the downloads of `scripts/setup.sh browser`. The environment variable CHROMIUM names another browser.
"""
import argparse
import base64
import json
import pathlib
import re
import resource
import shlex
import shutil
import statistics
import struct
import subprocess
import tempfile
import time

from studio_forms import forms
from studio_history import long_history
from studio_keyboard import by_keyboard_alone
from studio_page import MUG, PATIENCE, Page, Server, check, difference, launch, sync_playwright
from studio_photographs import from_photographs, light_by_words
from studio_proxy import behind_a_proxy
from studio_results import choose, deletes, invalid_setting, projects, sentences_follow, settings_stay
from studio_regions import click_region, region_by_words, results_unmarked, unused_regions

# Largest allowed mean absolute difference of the model's pixels, in units of 1/255. The viewer differs because it
# prefilters the light at half the size and antialiases edges by multisampling.
LIKE_RENDER = 2.5

COMPARE = """async ([render, url]) => {
  const { stage } = studio.viewer;
  const read = async (blob) => {
    const bitmap = await createImageBitmap(blob);
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height), context = canvas.getContext('2d');
    context.fillStyle = '#fff';
    context.fillRect(0, 0, bitmap.width, bitmap.height);
    context.drawImage(bitmap, 0, 0);
    return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
  };
  await stage.light.show(url);
  stage.frame();
  const mine = await read(await stage.picture());
  const bytes = Uint8Array.from(atob(render), (c) => c.charCodeAt(0));
  const theirs = await read(new Blob([bytes], { type: 'image/png' }));
  let sum = 0, count = 0;
  for (let i = 0; i < theirs.length; i += 4) {
    if (Math.min(theirs[i], theirs[i + 1], theirs[i + 2]) > 250) continue;
    for (let c = 0; c < 3; ++c) sum += Math.abs(mine[i + c] - theirs[i + c]);
    count += 3;
  }
  return [sum / count, count / 3, mine.length === theirs.length];
}"""


def looks_like_render(page, item3d, folder, light="studio"):
    """Compares the viewer with `item3d render`, with the same camera and light. Returns the difference."""
    width, height = page.run("[studio.viewer.stage.host.clientWidth, studio.viewer.stage.host.clientHeight]")
    subprocess.run([item3d, "render", MUG, "-o", f"{folder}/{light}.png", "--light", light, "--size",
                    f"{width}x{height}", "--background", "white", "--quiet"], check=True, stdout=subprocess.DEVNULL)
    with open(f"{folder}/{light}.png", "rb") as file:
        render = base64.b64encode(file.read()).decode()
    mean, pixels, same_size = page.run(COMPARE, [render, f"api/lights/{light}.hdr?width=512"])
    check(same_size and pixels > 1000, f"the pictures cannot be compared ({pixels} pixels)")
    check(mean < LIKE_RENDER, f"{light}: the viewer differs from item3d render by {mean:.2f} of 255 (at most {LIKE_RENDER})")
    return mean


def weigh(page):
    """Checks the size of the page's files, and returns a text about it."""
    files = page.run("""() => {
      const files = new Map();
      for (const { name, decodedBodySize, encodedBodySize } of [...performance.getEntriesByType('navigation'), ...performance.getEntriesByType('resource')])
        if (!name.includes('/api/')) files.set(name, [decodedBodySize, encodedBodySize]);
      return [...files.values()];
    }""")
    whole, sent = (sum(sizes) for sizes in zip(*files))
    check(len(files) > 20 and whole < 1.5e6, f"the page weighs {whole} bytes in {len(files)} files")
    return f"{whole} bytes, {sent} as they are sent"


def edit_to_its_end(page, to="a golden mug"):
    """Runs a short edit, which must change the image. Returns the result and the seconds."""
    before = page.pixels()
    begin = time.monotonic()
    result = page.edit(to)
    page.wait_for(result, "done")
    page.until(f"studio.viewer.stage.host.dataset.shown.startsWith('{result} single') && studio.viewer.stage.host.dataset.shown.endsWith('done')",
               "the result was not shown")
    changed = difference(before, page.pixels())
    check(changed > 0.5, f"the picture did not change ({changed:.2f} of 255)")
    page.picture("done")
    return result, time.monotonic() - begin


def wipe_and_layers(page, result):
    """Checks the two ends of the wipe, and that a layer of strength 1 shows the result and one of 0 the source."""
    after = page.pixels()
    page.tab.click(".viewer-bar [data-value=wipe]")
    page.until("studio.viewer.stage.layout === 'wipe' && !document.querySelector('.wipe').hidden", "there is no wipe")
    page.run("studio.viewer.stage.setWipe(0)")
    check(difference(after, page.pixels()) < 0.5, "at the left end the wipe does not show the result")
    page.run("studio.viewer.stage.setWipe(1)")
    before = page.pixels()
    check(difference(after, before) > 0.5, "the wipe shows no difference")
    page.run("studio.viewer.stage.setWipe(0.5)")
    page.picture("wipe")
    page.tab.click(".viewer-bar [data-value=single]")
    page.tab.click("#tab-layers")
    page.tab.click(f".layer[data-id='{result}'] input[type=checkbox]")
    page.until("studio.viewer.mix !== null && studio.viewer.stage.shown[0].look === studio.viewer.mix.look", "no layers are shown")
    check(difference(after, page.pixels()) < 0.7, "a layer of strength 1 is not the result")
    slider = page.tab.locator(f".layer[data-id='{result}'] input[type=range]")
    slider.evaluate("(input) => { input.value = 0; input.dispatchEvent(new Event('input')); }")
    time.sleep(0.5)
    check(difference(before, page.pixels()) < 0.7, "a layer of strength 0 is not the source")
    page.picture("layers")
    check(page.run("document.querySelector('.labels').textContent") == "1 layer", "no label says that layers are shown")
    choose(page, result)
    page.until("studio.viewer.stage.shown[0].look !== studio.viewer.mix.look && !document.querySelector('.unseen').hidden", "a chosen result is hidden by the layers")
    page.tab.click("#tab-edit")


def swaps_leave_nothing(page, result):
    """Checks that switching between looks does not increase the number of textures on the GPU."""
    counts = []
    for _ in range(6):
        for one in ("", result):
            page.run(f"studio.store.set({{ selected: '{one}' }})")
            page.until(f"studio.viewer.stage.host.dataset.shown.startsWith('{one} ')", "a look is not shown")
            page.run("studio.viewer.stage.draw()")
        counts.append(page.run("studio.viewer.stage.renderer.info.memory.textures"))
    check(counts[-1] == counts[1], f"textures on the GPU: {counts}")


def export(page, server, result):
    """Checks the files and the command that the page offers for a result."""
    page.tab.click("#tab-result")
    address = page.tab.locator(".exports a[download='model.glb']").get_attribute("href")
    content = server.get(address)
    magic, version, length = struct.unpack("<4sII", content[:12])
    check(magic == b"glTF" and version == 2 and length == len(content), "model.glb is not whole")
    count = struct.unpack("<I", content[12:16])[0]
    check(json.loads(content[20:20 + count])["materials"][0]["name"] == "glaze", "model.glb has other materials")
    command = page.tab.locator("pre.command").inner_text()
    check(re.match(r"item3d edit .*--from[ =].*--to[ =]", command), f"the command is {command}")
    check(b"<html" in server.get(f"api/results/{result}/files/report.html").lower(), "no report")
    page.tab.click("#tab-edit")


def pause_resume_cancel(page):
    """Pauses, resumes and cancels an edit. Returns the cancelled result."""
    result = page.edit("a silver mug", iterations=150)
    page.wait_for(result, "running")
    page.until(f"(studio.store.state.results.find(({{ id }}) => id === '{result}').progress?.done ?? 0) > 0", "no progress")
    page.picture("running")
    page.tab.locator(".job button", has_text="Pause").click()
    page.wait_for(result, "paused")
    check(page.run("document.querySelector('.job .facts').textContent !== '' && document.querySelector('.job progress').value > 0"), "a paused edit does not show how far it is")
    page.tab.locator(".job button", has_text="Resume").click()
    page.wait_for(result, "running")
    page.tab.locator(".job button", has_text="Cancel").click()
    page.wait_for(result, "cancelled")
    return result


def ended_on_the_command_line(page, item3d, server, result):
    """Finishes an edit of the studio with the command that the studio shows; the studio must not run it again."""
    project = json.loads(server.get(f"api/results/{result}"))
    folder = f"{server.folder}/projects/{project['project']}"
    command = [item3d, *shlex.split(project["command"])[1:], "--resume", "--quiet"]
    done = subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, timeout=10 * PATIENCE)
    check(done.returncode == 0, f"{shlex.join(command)} ended with {done.returncode}")
    page.tab.locator(".job button", has_text="Resume").click()
    page.wait_for(result, "done")
    seconds = json.loads(server.get(f"api/results/{result}"))["seconds"]
    check(seconds == project["seconds"], "the studio ran an edit again that the command line had ended")


def reload_in_the_middle(page, browser, server):
    """Reloads the page during an edit and opens a second tab; both must show the edit and its end. Returns the result."""
    result = page.edit("a blue mug", iterations=100)
    page.wait_for(result, "running")
    page.tab.reload()
    page.until("document.querySelector('.stage')?.dataset.shown !== undefined", "nothing is shown after a reload")
    check(page.run("studio.store.state.selected") == result, "the edit is not chosen after a reload")
    check(page.state_of(result) == "running", "after a reload, the viewer is empty until the edit has ended")
    other = Page(browser, server.address)
    check(other.state_of(result) in ("running", "done"), "a second tab does not know the edit")
    page.wait_for(result, "done")
    other.wait_for(result, "done")
    other.close()
    return result


def network_cut(page):
    """Sends a request without a network, which must show an error message; the next request must work."""
    count = len(page.results())
    page.run("studio.store.set({ selected: '', layout: 'single' })")
    page.tab.fill("#to", "a green mug")
    page.context.set_offline(True)
    page.tab.click("#start")
    page.until("document.querySelector('.edit footer .problem').textContent !== ''", "the page does not say that a request failed")
    page.context.set_offline(False)
    check(len(page.results()) == count, "an edit was begun without a network")
    result = page.edit("a green mug")
    page.wait_for(result, "done")


def server_killed(page, server, result):
    """Kills the server and starts it again; the page must report the loss, and no result may be lost."""
    known = {one["id"] for one in page.results()}
    server.kill()
    page.until("document.querySelector('.toast.bad') !== null", "the page does not say that the server is gone")
    page.picture("lost")
    server.begin(server.port)
    page.until("document.querySelector('.toast.bad')?.textContent.includes('started again')", "the page does not say that the server was started again")
    page.open(server.address)
    check(known <= {one["id"] for one in page.results()}, "results are lost")
    check(page.state_of(result) == "done", "a result that was done is not")


def refused(server, browser):
    """Checks that requests without the token are refused, and that wrong files cause an error message."""
    context = browser.new_context()
    answer = context.request.get(server.base + "api/about")
    check(answer.status == 403, f"without a token: {answer.status}")
    context.close()
    page = Page(browser, server.address)
    page.tab.locator("input[type=file][accept*='.glb']").set_input_files(
        {"name": "cat.png", "mimeType": "image/png", "buffer": b"no model"})
    page.until("document.querySelector('.toast.bad')?.textContent.includes('cat.png')", "a picture was taken for a model")
    page.tab.locator("input[type=file][accept*='.glb']").set_input_files(
        {"name": "broken.glb", "mimeType": "model/gltf-binary", "buffer": b"glTF\2\0\0\0"})
    page.until("[...document.querySelectorAll('.toast.bad')].length > 1", "a broken model was taken")
    page.close()


def other_screens(browser, server, playwright):
    """Checks that the page fits a phone and a zoom of 200 %, and that it shows rendered images without WebGL."""
    for name, options in {"phone": dict(viewport={"width": 390, "height": 844}, device_scale_factor=2, is_mobile=True, has_touch=True),
                          "zoom": dict(viewport={"width": 640, "height": 360}, device_scale_factor=2)}.items():
        page = Page(browser, server.address, **options)
        width = page.run("document.documentElement.scrollWidth")
        check(width <= options["viewport"]["width"], f"{name}: the page is {width} pixels wide")
        page.picture(name)
        page.close()
    plain = playwright.chromium.launch(executable_path=browser_path(), args=["--no-sandbox", "--disable-gpu", "--disable-3d-apis"])
    tab = plain.new_page()
    tab.goto(server.address)
    tab.locator(".no-webgl").wait_for(timeout=120000)
    tab.locator(".node[data-state=done]").first.click()
    tab.locator(".pictures img").first.wait_for(timeout=120000)
    plain.close()


def browser_path():
    import studio_page
    return studio_page.CHROMIUM


def frames(page):
    """Returns the milliseconds of a frame at 1280 x 720, and the name of the GL renderer."""
    return page.run("""() => {
      const { stage } = studio.viewer, gl = stage.renderer.getContext(), pixel = new Uint8Array(4);
      stage.renderer.setPixelRatio(1);
      stage.host.style.cssText = 'position:fixed;inset:0;width:1280px;height:720px;z-index:99';
      stage.resize();
      stage.frame();
      const begin = performance.now();
      for (let i = 0; i < 20; ++i) {
        stage.draw();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      }
      const milliseconds = (performance.now() - begin) / 20;
      stage.host.style.cssText = '';
      const info = gl.getExtension('WEBGL_debug_renderer_info');
      return [milliseconds, info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : ''];
    }""")


def first_change(page):
    """Starts an edit with the prior's settings; returns the seconds until the image has changed, and cancels it."""
    page = page_of_source(page)
    before = page.pixels()
    page.tab.click("#tab-edit")
    page.tab.fill("#from", "a red mug")
    page.tab.fill("#to", "a golden mug")
    page.tab.keyboard.press("Escape")
    page.run("studio.store.set({ settings: {} })")
    count = len(page.results())
    begin = time.monotonic()
    page.tab.click("#start")
    page.until(f"studio.store.state.results.length > {count}", "no edit was begun")
    result = page.results()[-1]["id"]
    revision = 0
    while True:
        page.until(f"(studio.viewer.gallery.live.get('{result}')?.revision ?? 0) > {revision}", "no texture came", 10 * PATIENCE)
        seconds = time.monotonic() - begin
        revision = page.run(f"studio.viewer.gallery.live.get('{result}').revision")
        if difference(before, page.pixels()) > 0.5:
            break
    page.tab.locator(".job button", has_text="Cancel").click()
    page.wait_for(result, "cancelled")
    return seconds


def streaming_cost(item3d, folder, rounds=4):
    """Returns the processor time and the wall-clock time that --live adds to an edit, in percent.

    Runs with and without --live alternate, and medians are compared.
    """
    times = {"": [], "live": []}
    for _ in range(rounds):
        for live, taken in times.items():
            shutil.rmtree(f"{folder}/cost", ignore_errors=True)
            pathlib.Path(f"{folder}/cost/live").mkdir(parents=True)
            before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
            subprocess.run([item3d, "edit", MUG, "--from", "a red mug", "--to", "a golden mug", "--iterations", "60", "--detail", "off",
                            "-o", f"{folder}/cost/edit", "--quiet", *(["--live", f"{folder}/cost/live"] if live else [])],
                           check=True, stdout=subprocess.DEVNULL)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            taken.append((after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, time.monotonic() - begin))
    middle = {live: [statistics.median(column) for column in zip(*taken)] for live, taken in times.items()}
    return [100 * (with_live / without - 1) for with_live, without in zip(middle["live"], middle[""])]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("item3d", help="the program")
    parser.add_argument("--all", action="store_true", help="test the rest of the page too")
    parser.add_argument("--measure", action="store_true", help="print times")
    parser.add_argument("--photographs", action="store_true", help="test a reconstruction too")
    options = parser.parse_args()
    options.item3d = str(pathlib.Path(options.item3d).resolve())  # absolute, because some commands run in other folders
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        began = time.monotonic()
        server = Server(options.item3d, f"{folder}/studio", str(MUG))
        served = time.monotonic() - began
        browser = launch(playwright)
        page = Page(browser, server.address)
        page.picture("open")
        said = [f"server {served:.2f} s, shown {page.seconds:.2f} s after the address, {weigh(page)}"]
        said.append(f"the viewer differs from item3d render by {looks_like_render(page, options.item3d, folder):.2f} of 255")
        click_region(page)
        invalid_setting(page)
        settings_stay(page)
        unused_regions(page)
        forms(page)
        result, seconds = edit_to_its_end(page)
        results_unmarked(page, result)
        sentences_follow(page, result, "a golden mug")
        said.append(f"a short edit took {seconds:.1f} s")
        said.append(f"{by_keyboard_alone(browser, server)} stops of the focus")
        behind_a_proxy(options.item3d, browser, folder)
        if options.all:
            region_by_words(page_of_source(page))
            said.append(f"under noon by {looks_like_render(page_of_source(page), options.item3d, folder, 'noon'):.2f}")
            page.run(f"studio.store.set({{ selected: '{result}' }})")
            page.until("studio.viewer.stage.host.dataset.shown.endsWith('done')", "the result is not shown again")
            wipe_and_layers(page, result)
            swaps_leave_nothing(page, result)
            export(page, server, result)
            light_by_words(page, "a mug at sunset, lit from the left")
            silver = pause_resume_cancel(page)
            ended_on_the_command_line(page, options.item3d, server, silver)
            deletes(page, silver, reload_in_the_middle(page, browser, server))
            projects(browser, server)
            network_cut(page)
            refused(server, browser)
            other_screens(browser, server, playwright)
            started, scrolled = long_history(options.item3d, browser, server, folder)
            said.append(f"1,000 results listed {started:.2f} s after the server's start, "
                        f"a frame of scrolling {scrolled['page']:.1f} ms of the page's thread, {scrolled['mean']:.0f} ms until it is shown, the longest {scrolled['longest']:.0f} ms")
            server_killed(page, server, result)
        if options.photographs:
            said.append(f"photographs {from_photographs(options.item3d, browser, folder):.0f} s")
        if options.measure:
            said.append(f"first visible change {first_change(page):.1f} s after Start")
            processor, clock = streaming_cost(options.item3d, folder)
            said.append(f"--live costs {processor:.1f} % of processor time, {clock:.1f} % of time")
            milliseconds, where = frames(page)
            said.append(f"{milliseconds:.1f} ms a picture at 1280 x 720 on {where}")
        page.close()
        browser.close()
        server.end()
        print("studio.py: " + "; ".join(said))


def page_of_source(page):
    """Shows the source model in the page."""
    page.run("studio.store.set({ selected: '', layout: 'single' })")
    page.until("studio.viewer.stage.host.dataset.shown.startsWith(' single')", "the source is not shown")
    return page


if __name__ == "__main__":
    main()
