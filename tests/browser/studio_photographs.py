"""Browser tests of a reconstruction from photographs, and of a light from words."""
import json
import math
import pathlib
import struct
import subprocess
import time

from studio_page import MUG, PATIENCE, Page, Server, check, difference

VIEWS, SIZE, ANGLE = 16, 96, 0.6


def bounds(model):
    """Returns the centre and radius of a .glb, from the bounds in its POSITION accessors."""
    content = model.read_bytes()
    scene = json.loads(content[20:20 + struct.unpack("<I", content[12:16])[0]])
    accessors = [scene["accessors"][primitive["attributes"]["POSITION"]] for mesh in scene["meshes"] for primitive in mesh["primitives"]]
    low = [min(accessor["min"][axis] for accessor in accessors) for axis in range(3)]
    high = [max(accessor["max"][axis] for accessor in accessors) for axis in range(3)]
    return [(a + b) / 2 for a, b in zip(low, high)], math.dist(low, high) / 2


def pose(middle, distance, azimuth, elevation):
    """Returns the camera-to-world matrix of a camera that looks at `middle` along its -Z axis, with +Y up."""
    back = [math.cos(elevation) * math.sin(azimuth), math.sin(elevation), math.cos(elevation) * math.cos(azimuth)]
    right = [math.cos(azimuth), 0, -math.sin(azimuth)]
    up = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2], back[0] * right[1] - back[1] * right[0]]
    return [[right[i], up[i], back[i], middle[i] + distance * back[i]] for i in range(3)] + [[0, 0, 0, 1]]


def photographs(item3d, folder):
    """Renders the demo from all around, as a dataset with known cameras: transforms.json and images with alpha."""
    folder = pathlib.Path(folder)
    (folder / "images").mkdir(parents=True)
    middle, radius = bounds(MUG)
    frames = [{"file_path": f"images/{i:02}.png",
               "transform_matrix": pose(middle, 1.1 * radius / math.sin(ANGLE / 2), 2 * math.pi * i * 0.382, math.radians(-20 + 80 * i / (VIEWS - 1)))}
              for i in range(VIEWS)]
    (folder / "transforms.json").write_text(json.dumps({"camera_angle_x": ANGLE, "w": SIZE, "h": SIZE, "frames": frames}))
    subprocess.run([item3d, "render", str(MUG), "--cameras", str(folder / "transforms.json"), "--size", f"{SIZE}x{SIZE}", "-o", str(folder / "images"), "--quiet"],
                   check=True, stdout=subprocess.DEVNULL)
    return folder


def reconstruct(page, folder):
    """Chooses the folder, checks its cameras and images in the page, and reconstructs the model.

    Returns the id of the result.
    """
    page.tab.click("#photographs")
    page.tab.locator(".photographs input[type=file]").set_input_files(str(folder))
    page.until(f"document.querySelector('.cameras figcaption')?.textContent.startsWith('{VIEWS} cameras')", "the cameras are not seen")
    check(page.tab.locator(".photos img").count() == VIEWS, "not all pictures are seen")
    page.picture("photographs")
    page.tab.locator(".photographs button.primary").click()
    page.until("studio.store.state.results[0]?.kind === 'reconstruct'", "no reconstruction was begun")
    result = page.results()[0]["id"]
    check(page.run("studio.store.state.project.name") == folder.name, "the project does not have the name of its folder")
    check(page.run("document.querySelector('.node.source') === null && document.getElementById('start').disabled"), "an edit is offered before there is a model")
    page.until("document.querySelector('.reconstruction img')?.naturalWidth > 0", "no preview is shown while it runs", 10 * PATIENCE)
    page.picture("reconstructing")
    page.until(f"['done', 'failed'].includes(studio.store.state.results.find(({{ id }}) => id === '{result}')?.state)", "the reconstruction does not end", 60 * PATIENCE)
    check(page.state_of(result) == "done", f"the reconstruction failed: {page.results()[0]['message']}")
    page.until("studio.store.state.project.model?.triangles > 100 && studio.viewer.stage.shown.length === 1", "the model does not open")
    page.picture("reconstructed")
    return result


def light_by_words(page, words):
    """Finds a light for a sentence, and checks that the viewer shows it. Returns the id of the result."""
    before = page.pixels()
    page.tab.click("#tab-light")
    page.tab.fill("input[aria-label='Find a light by words']", words)
    count = len(page.results())
    page.tab.click("#panel-light button:text-is('Find')")
    page.until(f"studio.store.state.results.length > {count}", "no search was begun")
    result = page.results()[-1]["id"]
    page.wait_for(result, "done")
    page.until(f"studio.store.state.light.name === 'result-{result}'", "the light that was found is not shown")
    page.until("!studio.viewer.lighting", "the light does not come")
    changed = difference(before, page.pixels())
    check(changed > 0.5, f"the light changed nothing ({changed:.2f} of 255)")
    page.picture("light_by_words")
    page.tab.click("#tab-edit")
    return result


def from_photographs(item3d, browser, folder):
    """Reconstructs a model from photographs and edits it. Returns the seconds until the reconstructed model is open."""
    server = Server(item3d, f"{folder}/photographed")
    page = Page(browser, server.address, shows="document.querySelector('.empty') !== null && !document.querySelector('.empty').hidden")
    pictures = photographs(item3d, f"{folder}/photographs")
    began = time.monotonic()
    reconstruct(page, pictures)
    seconds = time.monotonic() - began
    result = page.edit("a golden mug")
    page.wait_for(result, "done")
    page.close()
    server.end()
    return seconds
