"""Browser test of a history with a thousand results: the time to list them, and the scrolling of the list."""
import os
import pathlib
import sqlite3
import time

from studio_page import Page, Server, check

MANY = 1000

SCROLL = """async () => {
  const list = document.querySelector('.tree'), frames = [];
  const drawn = studio.viewer.stage.frames.count;
  let last = performance.now(), empty = 0;
  for (let i = 0; i < 120; ++i) {
    list.scrollTop = i / 119 * list.scrollHeight;
    await new Promise(requestAnimationFrame);
    const now = performance.now();
    frames.push(now - last);
    last = now;
    const area = list.getBoundingClientRect();
    if (!document.elementFromPoint(area.x + 60, area.y + area.height / 2)?.closest('.node')) ++empty;
  }
  return { longest: Math.max(...frames), mean: frames.reduce((a, b) => a + b) / frames.length, empty, drawn: studio.viewer.stage.frames.count - drawn,
           bottom: [...document.querySelectorAll('.node')].at(-1).getBoundingClientRect().bottom <= list.getBoundingClientRect().bottom };
}"""


def grow(server, folder):
    """Copies the server's folder, with a thousand results in its only project.

    The results are copies of the first edit: rows of the database, and folders with hard links to the edit's files.
    """
    os.makedirs(folder)
    with sqlite3.connect(f"{server.folder}/studio.sqlite") as before, sqlite3.connect(f"{folder}/studio.sqlite") as after:
        before.backup(after)
        after.execute("DELETE FROM results WHERE state <> 'done'")
        columns = [row[1] for row in after.execute("PRAGMA table_info(results)")]
        pattern = after.execute("SELECT * FROM results WHERE kind = 'edit' ORDER BY id LIMIT 1").fetchone()
        pattern = dict(zip(columns, pattern))
        after.execute("DELETE FROM results")
        for number in range(1, MANY + 1):
            parent = number // 2 if number % 3 == 0 and number > 3 else None
            after.execute(f"INSERT INTO results VALUES ({','.join('?' * len(columns))})",
                          list({**pattern, "id": number, "parent": parent, "note": f"number {number}"}.values()))
    project = pathlib.Path(server.folder) / f"projects/{pattern['project']}"
    for path in [*(project / "source").rglob("*"), *project.glob("model.*")]:
        link(path, folder / path.relative_to(server.folder))
    files = [path for path in (project / f"results/{pattern['id']}").rglob("*") if path.is_file()]
    for number in range(1, MANY + 1):
        for path in files:
            name = path.relative_to(project / f"results/{pattern['id']}")
            link(path, folder / f"projects/{pattern['project']}/results/{number}" / name)


def link(path, to):
    if path.is_file():
        to.parent.mkdir(parents=True, exist_ok=True)
        os.link(path, to)


def main_thread(page):
    """Returns the processor time in seconds of the page's main thread so far."""
    if not hasattr(page, "session"):
        page.session = page.context.new_cdp_session(page.tab)
        page.session.send("Performance.enable")
    return next(metric["value"] for metric in page.session.send("Performance.getMetrics")["metrics"] if metric["name"] == "ThreadTime")


def long_history(item3d, browser, server, folder):
    """Returns the seconds from the start of the server until all results are listed, and the times of scrolling."""
    grow(server, pathlib.Path(folder) / "many")
    began = time.monotonic()
    many = Server(item3d, f"{folder}/many")
    page = Page(browser, many.address, shows="studio.store.state.results.length === 1000 && document.querySelectorAll('.node').length > 10")
    seconds = time.monotonic() - began
    page.until("document.querySelector('.stage').dataset.shown !== undefined && document.querySelector('.node img')?.complete", "neither the model nor a picture is shown")
    time.sleep(1)  # the viewer loads the light again at a larger size
    worked = main_thread(page)
    scrolled = page.run(SCROLL)
    scrolled["page"] = 1000 * (main_thread(page) - worked) / 120
    rows = page.run("document.querySelectorAll('.node').length")
    check(rows < 80, f"{rows} rows are in the page, not those in sight alone")
    check(scrolled["empty"] == 0, f"{scrolled['empty']} of 120 frames of scrolling showed no row in the middle")
    check(scrolled["bottom"], "the list does not end with its last row")
    page.picture("many")
    page.tab.fill(".history input[type=search]", "number 500")
    page.until("document.querySelectorAll('.node').length === 2", "the filter does not find one of a thousand")
    page.tab.fill(".history input[type=search]", "")
    page.tab.locator(".node.source").focus()
    for key in ("End", "ArrowUp"):
        page.tab.keyboard.press(key)
    check(page.run("document.activeElement.dataset.id") == "2", "keys do not go through the list")
    page.close()
    many.end()
    return seconds, scrolled
