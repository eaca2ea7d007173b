"""Tests of code that needs no Blender: the program, command lines, jobs and words."""
from __future__ import annotations

import shutil
import tempfile
import time
import unittest
from pathlib import Path

from . import support
from item3d_blender.core.command import EditSettings, Machine, RelightSettings, edit_arguments, relight_arguments
from item3d_blender.core.errors import Item3dError
from item3d_blender.core.job import Job, jobs_in
from item3d_blender.core.program import candidates, find
from item3d_blender.core.words import Vocabulary, complete, unknown


class FolderTest(unittest.TestCase):
    def setUp(self) -> None:
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)


class Program(FolderTest):
    def test_finds_the_preferred_program_and_its_version(self) -> None:
        path = support.fake_program(self.folder, "edit")
        self.assertEqual(find(str(path), self.folder).version, "0.2.0")
        self.assertEqual(find(str(self.folder), Path("/nowhere")).path, path)

    def test_looks_into_the_extension_before_the_path(self) -> None:
        (self.folder / "bin").mkdir()
        path = support.fake_program(self.folder / "bin", "edit")
        self.assertEqual(next(candidates(self.folder)), path)
        self.assertEqual(find("", self.folder).path, path)

    def test_refuses_what_is_missing_old_or_no_item3d(self) -> None:
        other = self.folder / "other"
        other.mkdir()
        cases = [
            (str(self.folder / "nothing"), "no such program"),
            (str(support.fake_program(self.folder, "old")), "version 0.1.0 is too old"),
            (str(support.fake_program(other, "early")), "has no --live and no --progress-file"),
            ("/bin/true", "for --version"),
            ("/bin/false", "cannot be used"),
            ("/etc/hostname", "cannot be run"),
        ]
        for path, words in cases:
            with self.subTest(path), self.assertRaisesRegex(Item3dError, words):
                find(path, self.folder)


class Command(unittest.TestCase):
    MODEL, FOLDER = Path("/m.glb"), Path("/job")

    def arguments(self, **settings: object) -> list[str]:
        told = EditSettings(**{"source": "a mug", "target": "a golden mug"} | settings)
        return edit_arguments(told, self.MODEL, self.FOLDER, Machine(threads=2))

    def test_leaves_out_what_is_the_priors_to_say(self) -> None:
        told = self.arguments()
        for name in ("--iterations", "--texture-size", "--detail", "--metallic", "--light", "--region", "--prior"):
            self.assertNotIn(name, told)
        self.assertEqual(told[told.index("--threads") + 1], "2")

    def test_says_what_was_chosen(self) -> None:
        told = self.arguments(iterations=7, regions=["words=the handle"], materials=["a", "b"], feather=1.5, more='--cfg 3 --negative-prompt "a b"')
        for pair in (["--iterations", "7"], ["--region", "words=the handle"], ["--feather", "1.5"], ["--negative-prompt", "a b"]):
            at = told.index(pair[0])
            self.assertEqual(told[at : at + 2], pair)
        self.assertEqual([told[at + 1] for at, word in enumerate(told) if word == "--material"], ["a", "b"])

    def test_a_sentence_may_begin_with_a_dash(self) -> None:
        self.assertIn("--to=-5 degrees", self.arguments(target="-5 degrees"))

    def test_refuses_sentences_that_say_nothing_new(self) -> None:
        for source, target, words in (("", "a", "From: empty"), ("a", " ", "To: empty"), ("A mug", "a mug ", "the same")):
            with self.assertRaisesRegex(Item3dError, words):
                self.arguments(source=source, target=target)
        with self.assertRaisesRegex(Item3dError, "close the quotation mark"):
            self.arguments(more='--x "')

    def test_relights(self) -> None:
        for settings, wanted in (
            (RelightSettings(kind="preset", preset="noon"), ["--light", "noon"]),
            (RelightSettings(kind="sky", hour=7.5), ["--sky", "7.5"]),
            (RelightSettings(kind="lit", lit="low in the west"), ["--lit=low in the west"]),
            (RelightSettings(kind="words", source="a", target="b"), ["--from=a", "--to=b"]),
        ):
            told = relight_arguments(settings, self.MODEL, self.FOLDER, Machine())
            self.assertEqual([word for word in told if word in wanted], wanted)


class Jobs(FolderTest):
    def start(self, behaviour: str) -> Job:
        program = find(str(support.fake_program(self.folder, behaviour)), self.folder)
        job = Job.create(self.folder / "jobs", "A/B c", {"kind": "edit"})
        (job.folder / "m.glb").write_bytes(support.MUG.read_bytes())
        job.start(program, edit_arguments(EditSettings("a", "b"), job.folder / "m.glb", job.folder, Machine()))
        self.addCleanup(job.remove)
        return job

    def wait(self, job: Job, until: str) -> None:
        end = time.monotonic() + 30
        while job.update() != until:
            self.assertLess(time.monotonic(), end, f"{job.state}: {job.message}")
            time.sleep(0.02)

    def test_runs_to_the_end(self) -> None:
        job = self.start("edit")
        self.assertRegex(job.folder.name, r"^A_B_c-\d{8}-\d{6}$")
        self.wait(job, "done")
        self.assertEqual(job.result()["to"], "b")

    def test_passes_the_programs_complaint_on(self) -> None:
        job = self.start("error")
        self.wait(job, "failed")
        self.assertEqual(job.message, "a thing: is not right; try another")

    def test_stops_at_a_checkpoint_and_goes_on(self) -> None:
        job = self.start("slow")
        self.until_it_works(job)
        job.cancel()
        self.wait(job, "cancelled")
        job.resume(find(str(self.folder), self.folder))
        self.wait(job, "done")

    def test_says_by_what_it_was_killed(self) -> None:
        job = self.start("slow")
        self.until_it_works(job)
        job._kill()
        self.wait(job, "failed")
        self.assertIn("ended by SIGKILL", job.message)
        with self.assertRaisesRegex(Item3dError, "no checkpoint"):
            job.resume(find(str(self.folder), self.folder))

    def test_ends_a_process_that_does_not_listen(self) -> None:
        job = self.start("deaf")
        self.until_it_works(job)
        job.cancel()
        self.assertEqual(job.update(), "running")
        job._asked_to_stop -= 60
        self.wait(job, "cancelled")

    def test_a_folder_that_goes_ends_the_process(self) -> None:
        job = self.start("slow")
        self.until_it_works(job)
        number = job.record["process"]
        while job.folder.exists():  # the program writes into it meanwhile
            shutil.rmtree(job.folder, ignore_errors=True)
        self.assertEqual(job.update(), "failed")
        self.assertIn("deleted while item3d was running", job.message)
        self.assertFalse(Path(f"/proc/{number}").exists())

    def test_another_blender_finds_it(self) -> None:
        from item3d_blender.core import process

        job = self.start("slow")
        self.until_it_works(job)
        child = process._children.pop(str(job.folder))  # as if another process had started it
        found = next(jobs_in(self.folder / "jobs"))
        self.assertEqual(found.update(), "running")
        found.cancel()
        child.wait()
        self.wait(found, "cancelled")

    def test_a_record_of_something_else_is_no_job(self) -> None:
        (self.folder / "x").mkdir()
        (self.folder / "x" / "job.json").write_text("[]")
        self.assertEqual(list(jobs_in(self.folder)), [])
        with self.assertRaisesRegex(Item3dError, "cannot be written"):
            Job.create(Path("/proc/nowhere"), "x", {})

    def until_it_works(self, job: Job) -> None:
        end = time.monotonic() + 30
        while not job.read_json("live/textures.json"):
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)
        self.assertEqual(job.update(), "running")


class Words(FolderTest):
    def test_completes_the_last_word(self) -> None:
        self.assertEqual(complete("a go", ["a", "gold", "golden", "red"]), ["a gold", "a golden"])
        self.assertEqual(complete("a ", ["a"]), [])
        self.assertEqual(unknown("A golden monkey, red", ["a", "golden", "red"]), ["monkey"])
        self.assertEqual(unknown("anything", []), [])

    def test_asks_the_program(self) -> None:
        program = find(str(support.fake_program(self.folder, "edit")), self.folder)
        self.assertIn("golden", Vocabulary().wait(program, ""))
