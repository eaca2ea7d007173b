"""Browser tests of the sentences and settings of an edit, of deleted results, and of the list of projects."""
import time

from studio_page import MUG, Page, check

FROM = "document.getElementById('from').value"


def choose(page, result):
    """Chooses a result in the history; '': the source."""
    page.tab.click(f".node[data-id='{result}']")
    page.until(f"studio.store.state.selected === '{result}'", f"a click does not choose {result or 'the source'}")


def invalid_setting(page):
    """Types an invalid value, which must be named at its field and refuse Start."""
    page.tab.click("#tab-edit")
    page.run("document.querySelector('details.advanced').open = true")
    page.tab.fill("#from", "a red mug")
    page.tab.fill("#to", "a golden mug")
    page.tab.fill("#setting-iterations", "-5")
    page.tab.keyboard.press("Tab")
    page.until("document.getElementById('setting-iterations-problem').textContent !== ''", "an invalid value is not named at its field")
    count = len(page.results())
    page.tab.click("#start")
    page.until("document.querySelector('.edit footer .problem').textContent.includes('Iterations')", "Start does not say which value is invalid")
    check(page.run("document.getElementById('setting-iterations').value") == "-5", "the field forgot what was typed")
    page.tab.fill("#setting-iterations", "")
    page.tab.keyboard.press("Tab")
    page.until("Object.keys(studio.store.state.invalid).length === 0", "an invalid value cannot be corrected")
    check(len(page.results()) == count, "an edit began with an invalid value")
    page.run("document.querySelector('details.advanced').open = false")


def settings_stay(page):
    """Chooses a preset, which must survive a reload."""
    page.tab.click(".segments [data-value=draft]")
    page.until("studio.store.state.settings.detail === 'off'", "Draft sets nothing")
    page.tab.reload()
    page.until("document.querySelector('.stage')?.dataset.shown !== undefined && studio.store.state.about !== null", "nothing is shown after a reload")
    check(page.run("document.querySelector('.segments [data-value=draft]').ariaPressed") == "true", "a reload forgets the preset")
    page.tab.click(".segments [data-value=standard]")


def sentences_follow(page, result, sentence):
    """Switches between the source and a result; "It is" must describe the model that an edit begins with."""
    page.tab.click("#tab-edit")
    for chosen, said in ((result, sentence), ("", "a red mug"), (result, sentence)):
        choose(page, chosen)
        page.until(f"{FROM} === '{said}'", f"It is: {page.run(FROM)}, not {said}")


def ask_to_delete(page, result):
    choose(page, result)
    page.tab.click("#tab-result")
    page.tab.click("#panel-result footer button:has-text('Delete')")
    page.until("document.querySelector('dialog[open]') !== null", "nobody asks before a result is deleted")


def deletes(page, parent, child):
    """Deletes a result with an edit below it. The edit must say that its source is gone."""
    name = next(one["to"] for one in page.results() if one["id"] == parent)
    ask_to_delete(page, parent)
    said = page.run("document.querySelector('dialog[open]').textContent")
    check(f"“{name}”" in said and "The edit that began with it" in said, f"the question is: {said}")
    page.picture("delete")
    page.tab.keyboard.press("Escape")
    page.until("document.querySelector('dialog') === null", "Escape does not close the question")
    check(page.state_of(parent) == "done", "Escape deleted the result")
    ask_to_delete(page, parent)
    page.tab.click("dialog button.danger")
    page.until(f"!studio.store.state.results.some(({{ id }}) => id === '{parent}')", "the result was not deleted")
    page.tab.click("#tab-edit")
    choose(page, "")
    page.until(f"{FROM} === 'a red mug'", f"after a deletion, It is: {page.run(FROM)}")
    choose(page, child)
    page.tab.click("#tab-result")
    page.until("document.querySelector('#panel-result footer').textContent.includes('was deleted')", "an edit does not say that its source was deleted")
    check("Edit again" not in page.run("document.querySelector('#panel-result footer').textContent"), "an edit of a deleted result is offered again")
    page.tab.click("#tab-edit")


def in_menu(page, project, button):
    page.tab.click("button.project")
    page.tab.locator(".projects .list .row", has_text=project).locator(f"[aria-label^='{button}']").click()


def projects(browser, server):
    """Opens a second project, renames it and deletes it; the first project must be shown again."""
    page = Page(browser, server.address)
    first = page.run("studio.store.state.project.id")
    page.tab.locator("input[type=file][accept*='.glb']").set_input_files({"name": "cup.glb", "mimeType": "model/gltf-binary", "buffer": MUG.read_bytes()})
    page.until("studio.store.state.project.name === 'cup.glb'", "a model was not opened")
    check(page.run(FROM) == "", "a new project has the sentence of another")
    in_menu(page, "cup.glb", "Rename")
    page.tab.keyboard.type("my cup")
    page.tab.keyboard.press("Enter")
    page.until("document.querySelector('button.project').textContent === 'my cup' && document.querySelector('.node.source small').textContent === 'my cup'", "a project cannot be renamed")
    time.sleep(0.2)
    in_menu(page, "my cup", "Delete")
    page.tab.click("dialog button.danger")
    page.until(f"studio.store.state.project?.id === '{first}'", "after the deletion of a project, no other project is shown")
    page.close()
