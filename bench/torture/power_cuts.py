"""Simulates power cuts at random moments, and resumes the command afterwards.

A run is killed, and its folder becomes what the disk would contain after a power cut (cut.py has three models of a
disk). The command with --resume must then end with the products of an undisturbed run. It may instead refuse to resume,
with one line of error; in this case the command without --resume must end with these products.
"""
import random
import time

import check
import cut
import kills
import process


class Cutter(kills.Killer):
    """Runs the rounds of one command. In every fourth round the power is cut just after the command has ended."""

    def round(self, seed):
        draw = random.Random(f"cut {self.command.name} {seed}")
        model = cut.MODELS[seed % len(cut.MODELS)]
        output, record = self.folder / "out", self.folder / "record"
        for folder in (output, record):
            process.clear(folder)
            folder.mkdir(parents=True)
        begin = time.monotonic()
        before = cut.read_tree(output)
        settings = {"rate": self.command.rate} if self.command.rate > 1 else {}
        journal = self.shims.journal(output, record, **settings)
        if "TORTURE_SERVER_PRELOAD" in self.command.environment(output):
            journal["TORTURE_SERVER_PRELOAD"] = journal.pop("LD_PRELOAD")
        run = process.Run(self.command.arguments(output), self.folder / "log",
                          environment=self.command.environment(output) | journal)
        after_its_end = seed % 4 == 3
        moment = draw.uniform(0.1, 1.0) * self.seconds
        if after_its_end:
            run.process.wait(self.patience)
        else:
            time.sleep(moment)
        run.end()
        run.wait(self.patience)
        lost = cut.cut(output, record, before, model, draw)
        faults, lacking = [], 0
        if after_its_end and self.command.durable:
            here = self.command.products(output) if output.exists() else {}
            lacking = len(check.differences(self.quiet, here))
            if lacking:
                faults.append(f"ended, and {lacking} products are not on the disk")
        process.clear(record)
        outcome, again = self.go_on_or_begin(output)
        faults += process.faults_of(outcome, self.command.done)
        if not faults:
            different = check.differences(self.quiet, self.command.products(output))
            faults += [f"{len(different)} products differ: {different[:3]}"] if different else []
            faults += check.broken_files(output)
        if faults:
            faults.append(outcome.error.decode(errors="replace")[-300:])
        return {"command": self.command.name, "seed": seed, "model": model,
                "after_its_end": after_its_end, "moment": round(moment, 3), "names_lost": lost,
                "begun_anew": again, "faults": faults, "seconds": time.monotonic() - begin}

    def go_on_or_begin(self, output):
        """Resumes the command; if it refuses with one line of error, starts it again without --resume.

        Returns the outcome, and whether the command was started again.
        """
        outcome = self.go_on(output)
        refused = outcome.code == 3 and not process.faults_of(outcome, {3})
        if not refused:
            return outcome, False
        return self.begin(output, False).wait(self.patience), True


def torture(command, shims, folder, count, until=None, patience=300, tell=print):
    cutter = Cutter(command, shims, folder, patience)
    cutter.undisturbed()
    rounds = []
    for seed in range(count):
        if until and time.monotonic() > until:
            break
        rounds.append(cutter.round(seed))
        if rounds[-1]["faults"]:
            tell(f"  cut {command.name} {seed} ({rounds[-1]['model']}): {rounds[-1]['faults']}")
    return rounds
