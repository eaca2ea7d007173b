"""Browser tests of the regions: chosen by a click, by words, and drawn or typed but not added before Start."""
from studio_page import check


def click_region(page):
    """Clicks the model, which must offer its material as a region, and checks the option that the page shows."""
    page.tab.click(".tools [data-value=part]")
    box = page.tab.locator(".stage canvas").bounding_box()
    page.tab.mouse.click(box["x"] + box["width"] * 0.45, box["y"] + box["height"] * 0.5)
    page.tab.get_by_role("menuitem", name="Add to the region: the material glaze").click()
    page.until("document.querySelector('.where .command code').textContent === '--region material=glaze'",
               "the region is not written out")
    check(page.run("document.querySelector('.selector span').title") == "material=glaze", "the name of a selector does not tell the selector")
    page.picture("region")
    page.tab.keyboard.press("Escape")
    page.tab.locator(".stage canvas").focus()
    page.tab.keyboard.press("Control+z")
    page.until("studio.store.state.region.include.length === 0", "the region cannot be undone")
    page.tab.keyboard.press("2")
    page.until("studio.viewer.stage.shared.view.value === 1", "the key of the base colour does nothing")
    page.tab.keyboard.press("1")


def region_by_words(page):
    """Selects a part of the model by words, and checks the share of the surface that the page shows."""
    page.tab.click(".tools [data-value=words]")
    page.tab.fill("input[aria-label='By words']", "the handle")
    page.tab.keyboard.press("Enter")
    page.until("document.querySelector('.where .command code').textContent === \"--region 'words=the handle'\"", "the words are not written out")
    page.until("/^[\\d.]+ % of the surface/.test(document.querySelector('.share').textContent)", "the words find nothing")
    share = page.run("parseFloat(document.querySelector('.share').textContent)")
    check(5 < share < 50, f"the handle is {share} % of the mug")
    page.picture("region_words")
    remove_all(page)
    page.tab.click(".tools [data-value=words]")


def remove_all(page):
    while page.run("studio.store.state.region.include.length"):
        page.tab.click(".selectors [aria-label^='Remove']")
        page.tab.wait_for_timeout(50)


def started_region(page, begun):
    """Presses Start, and returns the region of the request. The request does not reach the server."""
    begun.clear()
    page.tab.click("#start")
    page.until("document.getElementById('start').ariaDisabled !== 'true'", "Start does not end")
    return begun[0]["region"] if begun else None


def unused_regions(page):
    """Starts edits with regions that were drawn or typed, but not added to the region."""
    begun = []

    def keep(route):
        begun.append(route.request.post_data_json)
        route.fulfill(status=400, json={"error": "kept by the test"})

    page.tab.route("**/edits", keep)
    page.tab.route("**/region", lambda route: route.fulfill(json={"share": 0.5, "masks": []}))
    page.tab.fill("#from", "a red mug")
    page.tab.fill("#to", "a golden mug")
    page.tab.keyboard.press("Escape")
    paint_a_stroke(page)
    region = started_region(page, begun)
    check(region and region[0].startswith("mask="), f"Start ignores what was painted: {region}")
    remove_all(page)

    page.tab.click(".tools [data-value=words]")
    page.tab.fill("input[aria-label='By words']", "the hnadle")
    check(started_region(page, begun) is None, "Start accepts a region of unknown words")
    check("hnadle" in page.tab.locator(".edit footer .problem").inner_text(), "Start does not say what is wrong with the region")
    page.tab.locator(".where .problem button.link").click()
    region = started_region(page, begun)
    check(region == ["words=the handle"], f"a word that was corrected gives {region}")
    check(page.run("studio.store.state.highlight"), "a new region is not marked")
    page.run("studio.store.set({ region: { ...studio.store.state.region, feather: 5 } })")
    remove_all(page)
    check(page.run("studio.store.state.region.feather") == 0, "the soft edge stays without a region")

    page.tab.click(".tools [data-value=box]")
    region = started_region(page, begun)
    check(region and region[0].startswith("box="), f"Start ignores the box: {region}")
    remove_all(page)
    page.tab.unroute("**/edits")
    page.tab.unroute("**/region")


def paint_a_stroke(page):
    """Paints two strokes and undoes the second one, which must not change the sentences."""
    page.tab.click(".tools [data-value=brush]")
    box = page.tab.locator(".stage canvas").bounding_box()
    for height in 0.4, 0.6:
        page.tab.mouse.move(box["x"] + box["width"] * 0.35, box["y"] + box["height"] * height)
        page.until("document.querySelector('.brush-ring').style.display === 'block'", "the brush shows no outline")
        page.tab.mouse.down()
        page.tab.mouse.move(box["x"] + box["width"] * 0.45, box["y"] + box["height"] * height, steps=2)
        page.tab.mouse.up()
    page.until("document.querySelector('.pending').textContent !== ''", "the page does not say what Start adds")
    page.tab.keyboard.press("Control+z")
    check(page.run("document.querySelector('.pending').textContent !== ''"), "one undo removes two strokes")
    check(page.run("studio.store.state.to") == "a golden mug", "undo changes the sentence instead of the stroke")
    page.picture("region_painted")


def results_unmarked(page, result):
    """Checks that a region marks the model that will be edited and not the result that is chosen later, and which sentence then counts."""
    page.run("""(id) => {
      const { store } = studio;
      window.resultsBefore = store.state.results;
      store.set({ selected: '', from: 'a red mug', region: { include: ['material=glaze'], exclude: [], feather: 0 },
        results: store.state.results.map((one) => one.id === id ? { ...one, request: { ...one.request, region: ['words=the handle'] } } : one) });
    }""", result)
    page.until("studio.store.state.highlight", "a region is not marked")
    page.run(f"studio.store.set({{ selected: '{result}' }})")
    page.until("!studio.store.state.highlight", "a region marks a result")
    check(page.run("studio.store.state.from") == "a red mug", "an edit of a part changes the sentence for the whole")
    page.run("studio.store.set({ results: window.resultsBefore, selected: '', region: { include: [], exclude: [], feather: 0 } })")
    page.run(f"studio.store.set({{ selected: '{result}' }})")
