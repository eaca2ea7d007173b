"""Tests of the panel's code. It draws into a stand-in for a layout that checks the calls, so no window is needed."""
from __future__ import annotations

import time
from types import SimpleNamespace
from typing import Any

import bpy

from .support import BlenderTest, cube, fake_program
from item3d_blender.core.program import Program
from item3d_blender.ui import panel, properties, session

ICONS = set(bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items.keys())


class Layout:
    """Stand-in for UILayout, which accepts the same calls and fails where Blender would."""

    def __init__(self, said: list[str]):
        self.said = said

    def _part(self, **_: Any) -> Layout:
        return Layout(self.said)

    box = row = column = _part

    def label(self, text: str = "", icon: str = "NONE") -> None:
        assert icon in ICONS, icon
        self.said.append(text)

    def prop(self, data: Any, name: str, **_: Any) -> None:
        getattr(data, name)
        self.said.append(f"prop {name}")

    def prop_search(self, data: Any, name: str, searched: Any, names: str) -> None:
        getattr(data, name), getattr(searched, names)
        self.said.append(f"search {name}")

    def progress(self, factor: float, text: str) -> None:
        assert 0 <= factor <= 1
        self.said.append(f"progress {text}")

    def operator(self, name: str, text: str = "", icon: str = "NONE") -> SimpleNamespace:
        group, operator = name.split(".")
        getattr(getattr(bpy.ops, group), operator).get_rna_type()
        assert icon in ICONS, icon
        self.said.append(f"operator {name}")
        return SimpleNamespace()


class Panel(BlenderTest):
    def setUp(self) -> None:
        super().setUp()
        session.look_again()
        self.addCleanup(session.look_again)

    def drawn(self, kind: type) -> list[str]:
        said: list[str] = []
        kind.draw(SimpleNamespace(layout=Layout(said)), bpy.context)
        return said

    def until_looked(self) -> None:
        session.program_state(bpy.context)
        session._looking.join()

    def test_while_it_looks_and_where_nothing_is_found(self) -> None:
        self.use(self.folder / "nothing")
        self.drawn(panel.EditPanel)
        self.until_looked()
        said = self.drawn(panel.EditPanel)
        self.assertIn("operator preferences.addon_show", said)
        self.assertNotIn("operator item3d.edit", said)
        self.assertIn("no such program", " ".join(said))
        self.assertIn("bin/item3d", " ".join(said), "how to get it")

    def test_each_kind_of_region_has_its_field(self) -> None:
        self.until_looked()
        self.assertIsInstance(session.program_state(bpy.context), Program)
        self.select(cube())
        for kind, *_ in properties.REGIONS:
            self.settings.region = kind
            said = self.drawn(panel.EditPanel)
            field = {"GROUP": "search group", "PAINT": "search paint", "MATERIAL": "search material", "IMAGE": "prop image",
                     "WORDS": "prop words", "COLOR": "prop color", "TEXT": "prop selector"}.get(kind, "prop region")  # fmt: skip
            self.assertIn(field, said)
            self.settings.chosen_region()
        for kind, *_ in properties.RELIGHTS:
            self.settings.relight = kind
            self.assertIn("operator item3d.relight", self.drawn(panel.LightPanel))
        self.assertIn("prop seed", self.drawn(panel.SettingsPanel))

    def test_words_that_the_prior_does_not_know_are_named(self) -> None:
        self.until_looked()
        self.settings.source, self.settings.target = "a gray cube", "a golden rhinoceros"
        end = time.monotonic() + 20
        while not session.words(bpy.context, "") and time.monotonic() < end:
            time.sleep(0.05)
        self.assertIn("The prior does not know: rhinoceros", self.drawn(panel.EditPanel))
        self.assertEqual(properties._complete(self.settings, bpy.context, "a gold"), ["a golden"])

    def test_a_job_while_it_runs_and_after(self) -> None:
        self.use(fake_program(self.folder, "slow"))
        self.until_looked()
        job = self.begin([cube()])
        while not job.read_json("progress.json"):
            session.poll()
        said = self.drawn(panel.EditPanel)
        self.assertTrue([line for line in said if line.startswith("progress Editing")], said)
        self.assertIn("operator item3d.cancel", said)
        bpy.ops.item3d.cancel(folder=str(job.folder))
        self.finish(job)
        said = self.drawn(panel.EditPanel)
        self.assertIn("operator item3d.resume", said)
        self.assertIn("operator item3d.discard", said)
