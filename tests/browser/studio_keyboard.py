"""Browser test of an edit that uses only the keyboard, and of the order and visibility of the focus."""
import struct

from studio_page import MUG, Page, check

# Describes the focused element: its name, its part of the page, and whether the element and its outline are visible.
FOCUSED = """() => {
  const one = document.activeElement;
  if (!one || one === document.body) return null;
  const outlined = (element) => { const style = getComputedStyle(element); return style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) >= 2; };
  const area = one.getBoundingClientRect();
  return {
    name: (one.getAttribute('aria-label') || one.labels?.[0]?.textContent || one.title || one.textContent).trim(),
    id: one.id, role: one.getAttribute('role') ?? one.tagName.toLowerCase(), slides: one.type === 'range',
    part: ['top', 'history', 'viewer', 'inspector'].find((part) => one.closest('.' + part)),
    outlined: [one, ...one.children].some(outlined),
    seen: area.width > 0 && area.height > 0 && area.right > 0 && area.bottom > 0 && area.left < innerWidth && area.top < innerHeight,
    clip: { x: Math.max(area.x - 3, 0), y: Math.max(area.y - 3, 0), width: area.width + 6, height: area.height + 6 },
  };
}"""
MOST_STOPS = 120


def tab_to(page, wanted, key="Tab"):
    """Presses Tab until wanted() accepts the focused element; returns its description."""
    for _ in range(MOST_STOPS):
        page.tab.keyboard.press(key)
        focused = page.run(FOCUSED)
        if focused and wanted(focused):
            return focused
    check(False, f"{key} does not reach what the keyboard needs; it ends at {page.run(FOCUSED)}")


def focus_order(page):
    """Tabs through the page. Each stop must be visible and outlined, and the parts must come in reading order.

    Returns the number of stops.
    """
    page.run("document.activeElement?.blur()")
    stops = []
    while len(stops) < MOST_STOPS:
        page.tab.keyboard.press("Tab")
        focused = page.run(FOCUSED)
        if focused is None:
            break
        check(focused["name"], f"a stop has no name: {focused}")
        check(focused["seen"], f"{focused['name']} has the focus and is not seen")
        if focused["slides"]:  # the outline is on the slider's thumb, which only a screenshot shows
            marked = page.tab.screenshot(clip=focused["clip"])
            page.tab.keyboard.press("Tab")
            focused["outlined"] = page.tab.screenshot(clip=focused["clip"]) != marked
            page.tab.keyboard.press("Shift+Tab")
        check(focused["outlined"], f"nobody sees that {focused['name']} has the focus")
        stops.append(focused)
    check(len(stops) < MOST_STOPS, "Tab never leaves the page")
    parts = [part for i, part in enumerate(stop["part"] for stop in stops) if i == 0 or stops[i - 1]["part"] != part]
    check(parts == ["top", "history", "viewer", "inspector"], f"Tab goes through the page's parts as {parts}")
    check(stops[0]["role"] == "a", "the first stop does not lead to the edit")
    return len(stops)


def write(page, text):
    page.tab.keyboard.press("Control+a")
    page.tab.keyboard.type(text)
    page.tab.keyboard.press("Escape")  # closes the list of completions


def begin_edit(page):
    """Types the sentences, chooses a preset and a setting, and starts the edit. Returns the result."""
    page.run("document.activeElement?.blur()")
    tab_to(page, lambda focused: focused["role"] == "a")
    page.tab.keyboard.press("Enter")
    page.until("document.activeElement?.id === 'from'", "the first link does not lead to the edit")
    write(page, "a red mug")
    tab_to(page, lambda focused: focused["id"] == "to")
    write(page, "a golden mug")
    tab_to(page, lambda focused: focused["name"] == "Draft")
    page.tab.keyboard.press("Space")
    tab_to(page, lambda focused: focused["role"] == "summary")
    page.tab.keyboard.press("Enter")
    tab_to(page, lambda focused: focused["name"] == "Find a setting")
    page.tab.keyboard.type("iterations")
    tab_to(page, lambda focused: focused["id"] == "setting-iterations")
    write(page, "12")
    before = len(page.results())
    tab_to(page, lambda focused: focused["id"] == "start")
    check(page.run("studio.store.state.settings.iterations") == 12, "a setting that was typed is not set")
    page.tab.keyboard.press("Enter")
    page.until(f"studio.store.state.results.length > {before}", "Enter on Start began no edit")
    check(page.run("document.activeElement.id") == "start", "Start lost the focus")
    return page.results()[-1]["id"]


def compare(page):
    """Opens the wipe and moves its bar."""
    page.tab.keyboard.press("c")
    page.until("studio.viewer.stage.layout === 'wipe' && !document.querySelector('.wipe').hidden", "C shows no wipe")
    bar = tab_to(page, lambda focused: focused["role"] == "slider", "Shift+Tab")
    check(bar["outlined"], "nobody sees that the wipe's bar has the focus")
    for _ in range(5):
        page.tab.keyboard.press("ArrowRight")
    check(page.run("document.activeElement.getAttribute('aria-valuenow')") == "60", "arrows do not move the wipe's bar")
    page.picture("keyboard_wipe")


def take_away(page):
    """Goes to the tab of the result and downloads its model."""
    tab_to(page, lambda focused: focused["role"] == "tab")
    page.tab.keyboard.press("End")
    page.until("document.activeElement.id === 'tab-result' && !document.getElementById('panel-result').hidden", "End does not lead to the last tab")
    tab_to(page, lambda focused: focused["name"].startswith("Model (glTF)"))
    with page.tab.expect_download() as download:
        page.tab.keyboard.press("Enter")
    content = download.value.path().read_bytes()
    magic, version, length = struct.unpack("<4sII", content[:12])
    check(magic == b"glTF" and version == 2 and length == len(content), "the model that was downloaded is not whole")
    check(content != MUG.read_bytes(), "the model that was downloaded is the source")


def by_keyboard_alone(browser, server):
    page = Page(browser, server.address)
    page.until("document.getElementById('setting-iterations') !== null", "the settings did not come")
    stops = focus_order(page)
    result = begin_edit(page)
    page.wait_for(result, "done")
    page.until(f"studio.viewer.stage.host.dataset.shown.startsWith('{result} single') && studio.viewer.stage.host.dataset.shown.endsWith('done')",
               "the result was not shown")
    compare(page)
    take_away(page)
    page.close()
    return stops
