"""Browser tests of the forms: completion of words, names of settings, the tab of layers without edits, and lights."""
from studio_page import MUG, check

SUN = "document.querySelector('.dome output').textContent"


def sentences(page):
    """Types unfinished, unknown and misspelt words."""
    page.until("document.querySelector('.looks button') !== null", "the words of the prior did not come")
    page.tab.click("#from")
    page.tab.keyboard.press("Control+a")
    page.tab.keyboard.type("a re")
    check(page.run("document.querySelector('#from + .completions').innerText.split(/\\s+/).join()") == "red,colour", "not red alone completes re")
    check(page.run("document.querySelector('.unknown').textContent") == "", "a word that can be completed is called unknown")
    for word, advice in {"gloden": "golden", "eine": "", "tasse": ""}.items():
        page.tab.fill("#from", f"a {word}")
        page.tab.keyboard.press("Escape")
        near = page.run("document.querySelector('.unknown button')?.textContent ?? ''")
        check(near == (f"Use “{advice}”" if advice else ""), f"the advice for {word} is {near}")
    page.tab.fill("#from", "a red mug")
    page.tab.keyboard.press("Escape")


def settings(page):
    """Checks the names and help texts of the settings, and that a select shows its longest choice."""
    names = page.run("[...document.querySelectorAll('.setting label')].map((label) => label.firstChild.textContent)")
    check("Adjust every" in names and not any(name.startswith("-") for name in names), f"the settings are called {names}")
    said = page.run("[...document.querySelectorAll('.setting p')].map((one) => one.textContent).join(' ')")
    check("--" not in said and "`" not in said, "the help of a setting tells the user to run a command")


def layers(page):
    page.tab.click("#tab-layers")
    page.until("document.querySelector('.layers .hint')?.textContent.startsWith('Each completed edit')", "the tab of layers is empty")


def lights(page):
    """Checks the sun's place in presets, a sky and words, and files and words that are no light."""
    page.tab.click("#tab-light")
    page.until("!studio.viewer.lighting && document.querySelector('.dome.none') !== null", "the studio light has a sun")
    page.tab.click(".lights button:text-is('sunset')")
    page.until(f"{SUN}.startsWith('125° · 4° high')", "the sun is not where the sunset has it")
    page.tab.fill("input[aria-label='In words']", "gibberish")
    page.tab.keyboard.press("Enter")
    page.until("document.querySelector('.toast.bad') !== null", "the page does not say that words name no direction")
    page.tab.fill("input[aria-label='In words']", "high in the east")
    page.tab.keyboard.press("Enter")
    page.until(f"{SUN}.startsWith('90° · 60° high')", "the sun is not where the words have it")
    check(page.run("document.querySelector('.toast.bad')") is None, "a message stays after its cause is gone")
    page.tab.get_by_label("Clear sky").check()
    page.until(f"{SUN}.startsWith('180° · 45° high')", "the sun is not where noon has it")
    own = page.tab.locator("#panel-light input[type=file]")
    content = page.context.request.get(page.run("document.baseURI.split('#')[0] + 'api/lights/night.hdr?width=64'")).body()
    own.set_input_files({"name": "torn.hdr", "mimeType": "image/vnd.radiance", "buffer": content[:400]})
    page.until("document.querySelector('.lights + .problem').textContent.startsWith('torn.hdr: ')", "the page does not say that an image is damaged")
    for name in ("evening", "studio"):
        own.set_input_files({"name": f"{name}.hdr", "mimeType": "image/vnd.radiance", "buffer": content})
        page.until(f"studio.store.state.light.name.endsWith('{name}')", "an own light is not shown")
    page.until("document.querySelector('.lights').textContent.includes('eveningown studio')", "a second own light replaces the first")
    page.tab.click(".lights button:text-is('studio')")
    page.until("!studio.viewer.lighting", "the light does not come")


def bad_model(page):
    """Opens a damaged model. The message must name the file as the user does, and must not cover the tabs."""
    page.tab.locator("input[type=file][accept*='.glb']").set_input_files(
        {"name": "torn.glb", "mimeType": "model/gltf-binary", "buffer": MUG.read_bytes()[:5000]})
    page.until("document.querySelector('.toast.bad')?.textContent.startsWith('torn.glb: ')", "the message names the server's folders")
    boxes = page.run("['.toast', '.inspector', '.viewer-bar'].map((one) => document.querySelector(one).getBoundingClientRect().toJSON())")
    check(boxes[0]["right"] <= boxes[1]["left"] and boxes[0]["top"] >= boxes[2]["bottom"], "a message covers controls")
    page.tab.click(".toast button")


def forms(page):
    sentences(page)
    settings(page)
    layers(page)
    lights(page)
    bad_model(page)
    page.tab.click("#tab-edit")
