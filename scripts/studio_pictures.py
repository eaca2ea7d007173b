#!/usr/bin/env python3
"""Takes the screenshots of the studio for README.md and the docs.

usage: scripts/studio_pictures.py ITEM3D [FOLDER]     FOLDER: folder for the screenshots, docs/images by default

The script edits the demo's mug three times with all iterations, which takes a few minutes.
"""
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests/browser"))
from studio_page import MUG, Page, Server, launch, sync_playwright  # noqa: E402

EDITS = ["a golden mug", "a zebra mug", "a wooden mug"]


def run(page, to):
    page.tab.click("#tab-edit")
    page.tab.fill("#from", "a red mug")
    page.tab.fill("#to", to)
    page.tab.keyboard.press("Escape")
    count = len(page.results())
    page.tab.click("#start")
    page.until(f"studio.store.state.results.length > {count}", "no edit was begun")
    return page.results()[-1]["id"]


def main():
    item3d, folder = sys.argv[1], pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ROOT / "docs/images")
    with tempfile.TemporaryDirectory() as work, sync_playwright() as playwright:
        server = Server(item3d, f"{work}/studio", str(MUG))
        browser = launch(playwright)
        page = Page(browser, server.address, viewport={"width": 1440, "height": 900}, color_scheme="dark")

        def picture(name, **options):
            page.tab.wait_for_timeout(2500)
            page.tab.screenshot(path=folder / f"studio_{name}.jpg", type="jpeg", quality=88, **options)

        results = []
        for to in EDITS:
            page.run("studio.store.set({ selected: '' })")
            results.append(run(page, to))
            if to == EDITS[1]:
                page.until(f"""(({{ state, progress }}) => state === 'done' || progress?.stage === 'edit' && progress.done > 80)(
                    studio.store.state.results.find(({{ id }}) => id === '{results[-1]}'))""", "the edit did not run", 3600)
                picture("running")
            page.until(f"studio.store.state.results.find(({{ id }}) => id === '{results[-1]}').state === 'done'", "an edit did not end", 3600)
        golden, zebra, wooden = results
        page.run(f"studio.store.set({{ selected: '{golden}', layout: 'wipe' }})")
        picture("wipe")
        page.run(f"studio.store.set({{ layout: 'side', side: ['', '{golden}', '{zebra}', '{wooden}'] }})")
        picture("side")
        page.run("""(ids) => studio.store.set({ layout: 'single', side: [], tab: 'layers', layers: [
          { id: ids[0], on: true, strength: 1, channels: ['roughness', 'metallic'] },
          { id: ids[1], on: true, strength: 0.6, channels: ['base_color'] }] })""", [golden, zebra])
        picture("layers")
        page.run(f"""studio.store.set({{ tab: 'light', selected: '{golden}', light: {{ ...studio.store.state.light, name: 'sunset', backdrop: true, rotation: 60 }} }})""")
        picture("light")
        page.run("studio.store.set({ tab: 'edit', selected: '', light: { ...studio.store.state.light, name: 'studio', backdrop: false, rotation: 0 }, region: { include: ['words=the handle'], exclude: [], feather: 1 } })")
        page.tab.wait_for_timeout(1000)
        page.until("!document.body.textContent.includes('Measuring the region')", "the region is not measured")
        picture("region")
        page.close()
        browser.close()
        server.end()


if __name__ == "__main__":
    main()
